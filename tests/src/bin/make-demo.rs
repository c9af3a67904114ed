//! Writes the files of `models/demo` anew: `cargo run -p garnet-tests --bin make-demo`.
//!
//! - `… -- fine FOLDER` writes the scene that the times of the command are stated for, a tunic of
//!   10 000 vertices on a mannequin of 13 000.
//! - `… -- people FILE` writes ten bodies side by side, at rest and in poses.

use std::path::Path;

use garnet::io::write_atomically;
use garnet_tests::demo::{Demo, people_obj, write_fine};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        [] => Demo::new()?.write(),
        ["fine", folder] => {
            std::fs::create_dir_all(folder)?;
            write_fine(Path::new(folder))
        }
        ["people", file] => {
            let text = people_obj()?;
            write_atomically(file, |out| out.write_all(text.as_bytes()))?;
            Ok(())
        }
        _ => Err("expected nothing, `fine FOLDER` or `people FILE`".into()),
    }
}
