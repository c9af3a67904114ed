//! The README's first commands do what they say.

use std::path::Path;
use std::process::Command;

/// The first `sh` block of the README, run line by line in an empty folder beside the models.
#[test]
fn the_first_commands_of_the_readme_drape_and_draw() {
    let root = std::path::absolute(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).unwrap();
    let readme = std::fs::read_to_string(root.join("README.md")).unwrap();
    let block = readme.split("```sh\n").nth(1).unwrap();
    let block = block.split("```").next().unwrap().replace("\\\n", " ");
    let folder = tempfile::tempdir().unwrap();
    let mut written = Vec::new();
    for line in block.lines() {
        let arguments = line.strip_prefix("cargo run --release -- ").unwrap();
        let arguments = arguments.split_whitespace().map(|word| {
            if word.starts_with("models/") {
                return root.join(word).into_os_string();
            }
            word.into()
        });
        let mut command = Command::new(env!("CARGO_BIN_EXE_garnet"));
        let status = command.args(arguments).current_dir(folder.path()).status();
        assert!(status.unwrap().success(), "{line}");
        let outputs = line.split_whitespace().filter(|word| is_output(word));
        written.extend(outputs.map(|word| folder.path().join(word)));
    }
    assert!(written.len() >= 2);
    for path in written {
        assert!(
            std::fs::metadata(&path).unwrap().len() > 1_000,
            "{}",
            path.display()
        );
    }
}

fn is_output(word: &str) -> bool {
    let is_file = Path::new(word).extension().is_some();
    is_file && !word.starts_with("models/")
}
