//! The words of a BVH file, with their lines.

use super::MotionProblem;

/// Lines of a file, read word by word or whole.
#[derive(Debug, Clone)]
pub(super) struct Lines<'a> {
    rest: &'a str,
    line: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        let rest = text.strip_prefix('\u{feff}').unwrap_or(text);
        Self { rest, line: 1 }
    }

    /// The line of what was read last, from 1.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    fn skip_spaces(&mut self) {
        while let Some(first) = self
            .rest
            .chars()
            .next()
            .filter(|c| c.is_whitespace() || *c == '\0')
        {
            if first == '\n' {
                self.line += 1;
            }
            self.rest = &self.rest[first.len_utf8()..];
        }
    }

    /// The next word, in whatever line; braces are words of their own.
    pub(super) fn word(&mut self) -> Option<&'a str> {
        self.skip_spaces();
        let is_end = |c: char| c.is_whitespace() || c == '{' || c == '}';
        let length = match self.rest.find(is_end) {
            Some(0) => 1,
            Some(length) => length,
            None => self.rest.len(),
        };
        let (word, rest) = self.rest.split_at(length);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    pub(super) fn expect(&mut self, expected: &'static str) -> Result<&'a str, MotionProblem> {
        let line = self.line;
        self.word().ok_or(MotionProblem::Ends { line, expected })
    }

    /// The next word, which must be `word` in small or capital letters.
    pub(super) fn expect_word(
        &mut self,
        word: &str,
        expected: &'static str,
    ) -> Result<(), MotionProblem> {
        let found = self.expect(expected)?;
        if found.eq_ignore_ascii_case(word) {
            return Ok(());
        }
        Err(self.unexpected(found, expected))
    }

    /// Whether the next word is `word`, in small or capital letters; it is then read.
    pub(super) fn takes_word(&mut self, word: &str) -> bool {
        let mut ahead = self.clone();
        let is_there = (ahead.word()).is_some_and(|found| found.eq_ignore_ascii_case(word));
        if is_there {
            *self = ahead;
        }
        is_there
    }

    /// The rest of the line, up to a brace, without spaces around it.
    pub(super) fn rest_of_line(&mut self) -> &'a str {
        let length = self.rest.find(['\n', '{']).unwrap_or(self.rest.len());
        let (text, rest) = self.rest.split_at(length);
        self.rest = rest;
        text.trim()
    }

    /// The next line that is not blank, and its number.
    pub(super) fn next_line(&mut self) -> Option<(usize, &'a str)> {
        self.skip_spaces();
        if self.rest.is_empty() {
            return None;
        }
        let (text, rest) = self
            .rest
            .split_at(self.rest.find('\n').unwrap_or(self.rest.len()));
        self.rest = rest;
        Some((self.line, text.trim()))
    }

    /// The value in a line `Name: value`, with or without blanks round the colon.
    pub(super) fn header(
        &mut self,
        name: &str,
        expected: &'static str,
        value: &'static str,
    ) -> Result<&'a str, MotionProblem> {
        let line = self.line;
        let Some((line, text)) = self.next_line() else {
            return Err(MotionProblem::Ends { line, expected });
        };
        let refused = |found: &str| unexpected(line, found, expected);
        let (start, rest) = text.split_once(':').ok_or_else(|| refused(text))?;
        let words: Vec<&str> = start.split_whitespace().collect();
        if !words.join(" ").eq_ignore_ascii_case(name) {
            return Err(refused(start));
        }
        let mut words = rest.split_whitespace();
        let Some(found) = words.next() else {
            return Err(unexpected(line, "", value));
        };
        match words.next() {
            // What stands behind the value in its own line belongs to no frame.
            Some(behind) => Err(unexpected(line, behind, "the end of the line")),
            None => Ok(found),
        }
    }

    pub(super) fn number(&mut self, expected: &'static str) -> Result<f64, MotionProblem> {
        let word = self.expect(expected)?;
        number(word).ok_or_else(|| self.unexpected(word, decimal(word, expected)))
    }

    pub(super) fn unexpected(&self, found: &str, expected: &'static str) -> MotionProblem {
        unexpected(self.line, found, expected)
    }
}

pub(super) fn unexpected(line: usize, found: &str, expected: &'static str) -> MotionProblem {
    let found = found.chars().take(40).collect();
    MotionProblem::Unexpected {
        line,
        found,
        expected,
    }
}

/// What is expected in place of a word that is no number: of a comma between digits, a point.
pub(super) fn decimal(word: &str, expected: &'static str) -> &'static str {
    if number(&word.replacen(',', ".", 1)).is_some() {
        "numbers with a decimal point, not a comma"
    } else {
        expected
    }
}

/// A finite number that `f32` holds.
pub(super) fn number(word: &str) -> Option<f64> {
    let value: f64 = word.parse().ok()?;
    (value as f32).is_finite().then_some(value)
}
