//! Writes the files of `models/demo` anew: `cargo run -p garnet-tests --bin make-demo`.
//!
//! With a folder, it writes there the scene that the times of the command are stated for, a tunic of
//! 10 000 vertices on a mannequin of 13 000: `… --bin make-demo -- FOLDER`.

use std::path::Path;

use garnet_tests::demo::{Demo, write_fine};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    match std::env::args_os().nth(1) {
        None => Demo::new()?.write(),
        Some(folder) => {
            std::fs::create_dir_all(&folder)?;
            write_fine(Path::new(&folder))
        }
    }
}
