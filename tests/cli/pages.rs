//! The commands of README.md and of the guides do what the pages show.
//!
//! A page is followed literally, in an empty folder beside `models`: a block ```` ```json NAME ````
//! (or `toml`, or `csv`) is saved as that file, and each `$` line of a `console` block runs in a
//! shell. The lines below it are what it prints, stdout before stderr: numbers and times are those
//! of some machine and match any, a line `...` matches any lines, `? 2` is the exit status. Where
//! nothing is shown, the command has to succeed, and no more.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

#[test]
fn the_readme_does_what_it_says() {
    follow("README.md");
}

#[test]
fn the_guide_to_an_own_garment_holds() {
    follow("docs/guide/own-garment.md");
}

#[test]
fn the_guide_to_an_own_body_holds() {
    follow("docs/guide/own-body.md");
}

#[test]
fn the_guide_to_motions_holds() {
    follow("docs/guide/motions.md");
}

#[test]
fn the_guide_to_patterns_holds() {
    follow("docs/guide/patterns.md");
}

#[test]
fn the_guide_to_fit_and_outfits_holds() {
    follow("docs/guide/outfits.md");
}

#[test]
fn the_guide_to_data_sets_holds() {
    follow("docs/guide/datasets.md");
}

#[test]
fn the_guide_to_training_holds() {
    follow("docs/guide/training.md");
}

#[test]
fn the_guide_to_imports_holds() {
    follow("docs/guide/import.md");
}

#[test]
fn the_guide_to_many_machines_holds() {
    follow("docs/guide/many-machines.md");
}

#[test]
fn the_guide_to_looking_holds() {
    follow("docs/guide/looking.md");
}

#[test]
fn the_guide_to_python_holds() {
    follow("docs/guide/python.md");
}

#[test]
fn the_guide_to_pytorch_holds() {
    follow("docs/guide/pytorch.md");
}

#[test]
fn the_options_are_those_of_the_help() {
    follow("docs/reference/options.md");
}

#[test]
fn every_guide_has_a_test() {
    let source = include_str!("pages.rs");
    let mut num_guides = 0;
    for entry in fs::read_dir(root().join("docs/guide")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name != "README.md" {
            let call = format!("follow(\"docs/guide/{name}\")");
            assert!(source.contains(&call), "nothing follows {name}");
            num_guides += 1;
        }
    }
    assert!(num_guides > 0);
}

/// Runs all commands of a page in one new folder; with `PAGES=overwrite` the page shows what they
/// print from then on.
fn follow(page: &str) {
    let path = root().join(page);
    let text = fs::read_to_string(&path).unwrap();
    let overwrites = std::env::var_os("PAGES").is_some_and(|value| value == "overwrite");
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink(root().join("models"), folder.path().join("models")).unwrap();
    let mut renewed = text.clone();
    let mut num_commands = 0;
    for block in blocks(&text) {
        if let Some(name) = block.file {
            fs::write(folder.path().join(name), block.lines.join("\n")).unwrap();
        }
        for step in steps(&block) {
            num_commands += 1;
            let printed = step.run(folder.path());
            if !overwrites {
                step.check(&printed, page);
            } else if !step.agrees(&printed) {
                renewed = renewed.replacen(&step.text(), &printed.after(&step.command), 1);
            }
        }
    }
    assert!(num_commands > 0, "{page} has no command");
    if renewed != text {
        fs::write(path, renewed).unwrap();
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A fenced block.
struct Block<'a> {
    is_console: bool,
    /// The file that it is saved as.
    file: Option<&'a str>,
    lines: Vec<&'a str>,
}

fn blocks(text: &str) -> Vec<Block<'_>> {
    let mut blocks = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let Some(info) = line.strip_prefix("```") else {
            continue;
        };
        let words = info.split_once(' ');
        blocks.push(Block {
            is_console: info == "console",
            file: words
                .and_then(|(kind, name)| ["csv", "json", "toml"].contains(&kind).then_some(name)),
            lines: lines.by_ref().take_while(|&line| line != "```").collect(),
        });
    }
    blocks
}

/// A command and what it prints.
struct Step<'a> {
    /// With its continuation lines.
    command: String,
    status: i32,
    /// Its lines in the page, with the exit status.
    lines: Vec<&'a str>,
}

/// The steps of a console block; none of another one.
fn steps<'a>(block: &Block<'a>) -> Vec<Step<'a>> {
    let mut steps: Vec<Step<'a>> = Vec::new();
    for &line in block.lines.iter().filter(|_| block.is_console) {
        if let Some(command) = line.strip_prefix("$ ") {
            steps.push(Step {
                command: command.to_owned(),
                status: 0,
                lines: Vec::new(),
            });
            continue;
        }
        let step = steps.last_mut().unwrap();
        if step.command.ends_with('\\') {
            step.command.push('\n');
            step.command.push_str(line);
            continue;
        }
        if let Some(status) = line.strip_prefix("? ") {
            step.status = status.parse().unwrap();
        }
        if !line.is_empty() {
            step.lines.push(line);
        }
    }
    steps
}

/// What a command printed.
struct Printed {
    status: i32,
    lines: Vec<String>,
}

impl Printed {
    /// As a page shows it.
    fn after(&self, command: &str) -> String {
        let status = format!("? {}\n", self.status);
        let status = if self.status == 0 { "" } else { &status };
        let lines = self.lines.iter().map(|line| format!("{line}\n"));
        format!("$ {command}\n{status}{}", lines.collect::<String>())
    }
}

impl Step<'_> {
    /// As it stands in the page.
    fn text(&self) -> String {
        let lines = self.lines.iter().map(|line| format!("{line}\n"));
        format!("$ {}\n{}", self.command, lines.collect::<String>())
    }

    fn run(&self, folder: &Path) -> Printed {
        let program = Path::new(env!("CARGO_BIN_EXE_garnet"));
        let programs = program.parent().unwrap().to_str().unwrap();
        let path = std::env::var("PATH").unwrap();
        let output = Command::new("sh")
            .args(["-c", &self.command])
            .current_dir(folder)
            .env("PATH", format!("{programs}:{path}"))
            .env_remove("NO_COLOR")
            // Pages are followed side by side.
            .env("RAYON_NUM_THREADS", "1")
            .output()
            .unwrap();
        let texts = [output.stdout, output.stderr];
        let texts = texts.map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        let lines = texts.iter().flat_map(|text| text.lines());
        let lines = lines.filter(|line| !line.trim().is_empty());
        Printed {
            status: output.status.code().unwrap(),
            lines: lines.map(|line| line.trim_end().to_owned()).collect(),
        }
    }

    /// Whether the page shows what was printed, or nothing of what a command prints that succeeds.
    fn agrees(&self, printed: &Printed) -> bool {
        let shown = self.lines.iter().filter(|line| !line.starts_with("? "));
        let shown: Vec<&str> = shown.copied().collect();
        let lines: Vec<&str> = printed.lines.iter().map(String::as_str).collect();
        printed.status == self.status && (shown.is_empty() || is_shown(&shown, &lines))
    }

    fn check(&self, printed: &Printed, page: &str) {
        let (asked, found) = (self.text(), printed.after(&self.command));
        assert!(
            self.agrees(printed),
            "{page} shows\n{asked}\nwhere this is printed:\n{found}"
        );
    }
}

/// Whether lines are those that are shown, but for numbers and times.
fn is_shown(shown: &[&str], printed: &[&str]) -> bool {
    match shown.split_first() {
        None => printed.is_empty(),
        Some((&"...", rest)) => {
            (0..=printed.len()).any(|skipped| is_shown(rest, &printed[skipped..]))
        }
        Some((line, rest)) => printed.split_first().is_some_and(|(found, others)| {
            without_numbers(line) == without_numbers(found) && is_shown(rest, others)
        }),
    }
}

/// A line with `#` for each number, `# t` for each time, and single spaces.
fn without_numbers(line: &str) -> String {
    let mut text = String::new();
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        if !letter.is_ascii_digit() {
            text.push(letter);
            continue;
        }
        text.push('#');
        let mut before = letter;
        while let Some(&next) = letters.peek() {
            let is_sign = matches!(next, '+' | '-') && before == 'e';
            if !is_sign && !next.is_ascii_digit() && !matches!(next, '.' | ',' | 'e') {
                break;
            }
            before = next;
            letters.next();
        }
    }
    let mut words: Vec<&str> = Vec::new();
    for word in text.split_whitespace() {
        let (unit, comma) = match word.strip_suffix(',') {
            Some(unit) => (unit, ","),
            None => (word, ""),
        };
        let is_time = ["ms", "s", "min"].contains(&unit)
            && words.last().is_some_and(|last| last.ends_with('#'));
        match words[..] {
            _ if !is_time => words.push(word),
            // Minutes and seconds are one time.
            [.., "t", "#"] => _ = words.pop(),
            _ => words.push("t"),
        }
        if is_time && !comma.is_empty() {
            words.push(comma);
        }
    }
    words.join(" ")
}

#[test]
fn numbers_and_times_match_any() {
    let shown = [
        "draped in 12.5 ms, 80 a second",
        "...",
        "  mean  1.0e-3, 2 faces",
    ];
    let printed = [
        "draped in 1 min 20 s, 2 a second",
        "note: more",
        "  mean 17, 3 faces",
    ];
    assert!(is_shown(&shown, &printed));
    assert!(!is_shown(&shown, &printed[..2]));
    assert!(!is_shown(&["2 faces"], &["2 edges"]));
}
