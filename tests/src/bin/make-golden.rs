//! Writes the golden drapes of `tests/it/golden` anew:
//! `cargo run -p garnet-tests --bin make-golden`.
//!
//! Drapes of the warp and of the simulator that moved are written only under a new version of
//! [`GENERATOR`]: data sets that exist were made by the old one. For whoever chooses other scenes
//! it says how far noise at the start moves each drape.

#![allow(clippy::print_stdout, reason = "a program that reports")]

use garnet_data::GENERATOR;
use garnet_tests::golden::{Golden, Stored, TOLERANCE};

/// Noise on the start of a drape, in metres: the first is about the rounding of a coordinate.
const NOISES: [f32; 2] = [1e-7, 1e-6];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for golden in Golden::ALL {
        let name = golden.name();
        let positions = golden.draped()?;
        if let Ok(stored) = Stored::read(golden) {
            let moved = stored.farthest(&positions);
            let is_kept = stored.generator == GENERATOR && golden.is_of_generator();
            if moved > TOLERANCE && is_kept {
                let moved = 1e3 * moved;
                return Err(format!(
                    "{name} moved by {moved:.2} mm: raise garnet_data::GENERATOR first"
                )
                .into());
            }
        }
        let stored = Stored::of(&positions);
        stored.write(golden)?;
        for noise in NOISES {
            let moved = 1e3 * stored.farthest(&golden.draped_from(noise)?);
            println!("{name}: {moved:.4} mm for noise of {noise:e} m");
        }
    }
    Ok(())
}
