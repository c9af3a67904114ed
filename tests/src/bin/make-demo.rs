//! Writes the files of `models/demo` anew: `cargo run -p garnet-tests --bin make-demo`.
//!
//! With a folder, it writes there the same scene at the size that the bars are stated for, a tunic of
//! 10 000 vertices on a mannequin of 13 000: `… --bin make-demo -- FOLDER`.

use std::path::Path;

use garnet_tests::demo::Demo;

/// Spacing of the vertices of a mannequin of 13 000, in metres.
const FINE_SPACING: f32 = 0.0132;

/// About how many vertices the tunic on it has.
const FINE_TUNIC: usize = 10_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    match std::env::args_os().nth(1) {
        None => Demo::new().write(&Demo::folder()),
        Some(folder) => {
            std::fs::create_dir_all(&folder)?;
            Demo::of_size(FINE_SPACING, FINE_TUNIC).write(Path::new(&folder))
        }
    }
}
