//! The warp and the simulator put cloth where they did: data sets and weights stand on that.

use garnet_data::GENERATOR;
use garnet_tests::golden::{Golden, Stored, TOLERANCE};

fn is_where_it_was(golden: Golden) {
    let name = golden.name();
    let stored = Stored::read(golden).unwrap();
    assert_eq!(
        stored.generator, GENERATOR,
        "{name} is of another generator: cargo run -p garnet-tests --bin make-golden"
    );
    let moved = stored.farthest(&golden.draped().unwrap());
    println!("{name}: {:.4} mm", 1e3 * moved);
    let advice = if golden.is_of_generator() {
        "whoever changes where scenes put cloth raises garnet_data::GENERATOR"
    } else {
        "other weights: cargo run -p garnet-tests --bin make-golden; another simulator: raise \
         garnet_data::GENERATOR first"
    };
    assert!(moved <= TOLERANCE, "{name} moved by {moved} m: {advice}");
}

#[test]
fn the_warp_puts_a_tunic_where_it_did() {
    is_where_it_was(Golden::Warp);
}

#[test]
fn the_simulator_puts_a_tunic_where_it_did() {
    is_where_it_was(Golden::Simulation);
}

#[test]
fn the_shipped_shirt_comes_from_midway_to_where_it_did() {
    is_where_it_was(Golden::Accurate);
}
