//! The command as its users meet it: transcripts, bad input, outputs.

#![expect(
    clippy::unwrap_used,
    reason = "in a test that is a failure as good as any other"
)]

mod bad_input;
mod batch;
mod body;
mod caches;
mod chart;
mod dataset;
mod drape;
mod exported;
mod fixtures;
mod garbage;
mod garment;
mod glb;
#[cfg(unix)]
mod interrupts;
mod lists;
mod mistyped;
mod outfit;
mod outputs;
#[cfg(unix)]
mod pages;
mod readme;
mod refit;
mod render;
mod simulate;
mod stress;
mod tailored;
mod train;
mod view;

use fixtures::Fixture;

/// Every console block of `tests/cli/*.md`, in a folder with the small scene.
#[test]
fn transcripts_hold() {
    let fixture = Fixture::new();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/cli");
    let transcripts = std::path::absolute(folder).unwrap().join("*.md");
    std::env::set_current_dir(fixture.folder()).unwrap();
    trycmd::TestCases::new()
        .register_bin("garnet", std::path::Path::new(env!("CARGO_BIN_EXE_garnet")))
        .case(transcripts.to_str().unwrap())
        .run();
}
