//! Files with random damage end with 0 or 2, never with a panic.

use crate::fixtures::{Fixture, stderr};

/// Runs for each kind of file.
const NUM_RUNS: u64 = 24;

/// A sequence of numbers that look random (Steele et al. 2014, splitmix64).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % limit.max(1) as u64) as usize
    }
}

/// Changes a few bytes, mostly near the start, and sometimes cuts the end off.
fn damaged(bytes: &[u8], numbers: &mut Numbers) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    if numbers.below(3) == 0 {
        bytes.truncate(numbers.below(bytes.len()));
    }
    for _ in 0..=numbers.below(6) {
        let reach = if numbers.below(2) == 0 {
            400
        } else {
            bytes.len()
        };
        let place = numbers.below(reach.min(bytes.len()));
        let replacements = b"0129-.e/ \n\xff\x00fv{[";
        if let Some(byte) = bytes.get_mut(place) {
            *byte = replacements[numbers.below(replacements.len())];
        }
    }
    bytes
}

#[test]
fn damaged_files_never_panic() {
    let fixture = Fixture::new();
    let run = |name: &str, copy: &str, arguments: &str| {
        let bytes = fixture.read(name);
        for seed in 0..NUM_RUNS {
            fixture.bytes(copy, &damaged(&bytes, &mut Numbers(seed)));
            let output = fixture.garnet(arguments);
            let code = output.status.code();
            let is_fine = code == Some(0) || code == Some(2);
            assert!(
                is_fine,
                "{arguments}, seed {seed}: {code:?} {}",
                stderr(&output)
            );
        }
    };
    run(
        "sleeve.obj",
        "bad.obj",
        "drape bad.obj bent.obj --rest-body body.obj -o out.obj",
    );
    run(
        "bent.obj",
        "bad.obj",
        "drape sleeve.obj bad.obj --rest-body body.obj -o out.obj",
    );
    run(
        "body.rig.npz",
        "bad.npz",
        "drape sleeve.obj body.obj --rig bad.npz -o out.obj",
    );
    run(
        "bend.json",
        "bad.json",
        "drape sleeve.obj body.obj --pose bad.json -o out.obj",
    );
    run("bend.json", "bad.json", "info bad.json");
    run(
        "sleeve.obj",
        "bad.obj",
        "render bad.obj -o out.png --size 60x60",
    );
}
