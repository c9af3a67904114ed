//! The words of an OBJ line, and where they stand in the file.
//!
//! Blanks separate words, `#` ends a line early, and a backslash before the line break continues
//! the line. Line breaks are LF, CRLF or CR.

use std::ops::Range;

/// Walks over the words of one logical line.
#[derive(Debug, Clone)]
pub(crate) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    /// Starts at byte `at`.
    pub(crate) fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    /// The span of the next word, or nothing at the end of the line.
    pub(crate) fn next_span(&mut self) -> Option<Range<usize>> {
        let bytes = self.bytes;
        loop {
            match bytes.get(self.at)? {
                b' ' | b'\t' | 0x0b | 0x0c => self.at += 1,
                b'\n' | b'\r' | b'#' => return None,
                b'\\' => match continuation_len(bytes, self.at) {
                    0 => break,
                    len => self.at += len,
                },
                _ => break,
            }
        }
        let start = self.at;
        self.at += 1;
        while let Some(&byte) = bytes.get(self.at) {
            match byte {
                b' ' | b'\t' | 0x0b | 0x0c | b'\n' | b'\r' | b'#' => break,
                b'\\' if continuation_len(bytes, self.at) > 0 => break,
                _ => self.at += 1,
            }
        }
        Some(start..self.at)
    }

    /// The next word.
    pub(crate) fn next_word(&mut self) -> Option<&'a [u8]> {
        let span = self.next_span()?;
        Some(&self.bytes[span])
    }

    /// The byte where the walk stands.
    pub(crate) fn position(&self) -> usize {
        self.at
    }

    /// Passes over the other words and gives the start of the next line.
    pub(crate) fn next_line(mut self) -> usize {
        while self.next_span().is_some() {}
        self.next_raw_line()
    }

    /// Passes over the rest of the physical line and gives the start of the next one.
    pub(crate) fn next_raw_line(self) -> usize {
        let is_break = |byte: &u8| matches!(byte, b'\n' | b'\r');
        match self.bytes[self.at..].iter().position(is_break) {
            Some(distance) => self.at + distance + 1,
            None => self.bytes.len(),
        }
    }
}

/// The length of a backslash and the line break after it, or 0 if there is none at `at`.
fn continuation_len(bytes: &[u8], at: usize) -> usize {
    match (bytes.get(at), bytes.get(at + 1), bytes.get(at + 2)) {
        (Some(b'\\'), Some(b'\r'), Some(b'\n')) => 3,
        (Some(b'\\'), Some(b'\r' | b'\n'), _) => 2,
        _ => 0,
    }
}

/// The number, from 1, of the line that holds byte `at`.
pub(crate) fn line_number(bytes: &[u8], at: usize) -> usize {
    let before = &bytes[..at.min(bytes.len())];
    let breaks = before.iter().enumerate().filter(|&(index, &byte)| {
        byte == b'\n' || (byte == b'\r' && bytes.get(index + 1) != Some(&b'\n'))
    });
    1 + breaks.count()
}

/// Reads a whole number with an optional sign.
pub(crate) fn parse_index(word: &[u8]) -> Option<i64> {
    let (sign, digits) = match word {
        [b'-', digits @ ..] => (-1, digits),
        [b'+', digits @ ..] | digits => (1, digits),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0_i64;
    for &digit in digits {
        match digit {
            b'0'..=b'9' => value = 10 * value + i64::from(digit - b'0'),
            _ => return None,
        }
    }
    Some(sign * value)
}

/// The bytes as text, with a mark where they are not UTF-8.
pub(crate) fn text_of(word: &[u8]) -> String {
    const MAX_CHARS: usize = 40;
    let text = String::from_utf8_lossy(word);
    match text.char_indices().nth(MAX_CHARS) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.into_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words_of(line: &str) -> Vec<&[u8]> {
        let mut words = Words::new(line.as_bytes(), 0);
        std::iter::from_fn(move || words.next_word()).collect()
    }

    #[test]
    fn a_backslash_continues_the_line_and_a_hash_ends_it() {
        let words = words_of("v\t1 \\\r\n 2\\\n3 4# note 5\n6");
        assert_eq!(words, [b"v", b"1", b"2", b"3", b"4"]);
    }

    #[test]
    fn a_backslash_within_a_line_belongs_to_its_word() {
        assert_eq!(words_of("g C:\\cloth"), [&b"g"[..], b"C:\\cloth"]);
    }

    #[test]
    fn lines_are_counted_over_all_three_line_breaks() {
        let bytes = b"a\nb\r\nc\rd";
        let numbers: Vec<usize> = [0, 2, 5, 7].map(|at| line_number(bytes, at)).to_vec();
        assert_eq!(numbers, [1, 2, 3, 4]);
    }

    #[test]
    fn an_index_is_digits_with_a_sign() {
        assert_eq!(parse_index(b"-12"), Some(-12));
        assert_eq!(parse_index(b"+7"), Some(7));
        for word in [&b""[..], b"-", b"1.0", b"1e3", b"9999999999999999999"] {
            assert_eq!(parse_index(word), None);
        }
    }
}
