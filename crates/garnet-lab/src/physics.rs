//! Prints what the physics tests measure, beside what theory says.

#[allow(
    clippy::unwrap_used,
    dead_code,
    reason = "the scenes are those of the tests, which use what the table does not"
)]
#[path = "../../garnet-sim/tests/physics/cantilever.rs"]
mod cantilever;
#[allow(
    clippy::unwrap_used,
    dead_code,
    reason = "the scenes are those of the tests, which use what the table does not"
)]
#[path = "../../garnet-sim/tests/physics/drapes.rs"]
mod drapes;
#[allow(
    clippy::unwrap_used,
    dead_code,
    reason = "the scenes are those of the tests, which use what the table does not"
)]
#[path = "../../garnet-sim/tests/physics/friction.rs"]
mod friction;
#[allow(
    clippy::unwrap_used,
    dead_code,
    reason = "the scenes are those of the tests, which use what the table does not"
)]
#[path = "../../garnet-sim/tests/physics/hanging.rs"]
mod hanging;
#[allow(
    clippy::unwrap_used,
    dead_code,
    reason = "the scenes are those of the tests, which use what the table does not"
)]
#[path = "../../garnet-sim/tests/physics/refinement.rs"]
mod refinement;
#[allow(
    clippy::unwrap_used,
    dead_code,
    reason = "the scenes are those of the tests, which use what the table does not"
)]
#[path = "../../garnet-sim/tests/physics/row.rs"]
mod row;
#[allow(
    clippy::unwrap_used,
    dead_code,
    reason = "the scenes are those of the tests, which use what the table does not"
)]
#[path = "../../garnet-sim/tests/physics/sheets.rs"]
mod sheets;

use row::{Bound, Row};

pub(crate) fn run() {
    println!(
        "{:<66}{:>12}{:>12}{:>12}",
        "", "expected", "measured", "off by"
    );
    let families: [fn() -> Vec<Row>; 11] = [
        hanging::strips,
        hanging::catenaries,
        cantilever::material,
        cantilever::jittered_material,
        cantilever::hinges,
        cantilever::peirce,
        friction::plane,
        friction::capstan,
        drapes::ball,
        cantilever::hinges_elsewhere,
        cantilever::material_elsewhere,
    ];
    for family in families {
        family().iter().for_each(print_row);
    }
    println!("\ndrape tester      B (N m)   coefficient (%)   folds");
    for rings in [15, 22, 30] {
        for bending in drapes::RIGIDITIES {
            let drape = drapes::cusick(bending, rings);
            let [coefficient, folds] =
                [format!("{:.1}", drape.coefficient), drape.folds.to_string()];
            println!("  {rings:>2} rings    {bending:>12.0e}{coefficient:>18}{folds:>8}");
        }
    }
    println!("\nrefinement: mean distance to the next finer mesh");
    let cells = [24, 34, 50, 70, 100, 142];
    for (pair, distance) in cells.windows(2).zip(refinement::distances(&cells)) {
        let [coarse, fine] = [pair[0], pair[1]].map(|cells| (cells + 1) * (cells + 1));
        println!(
            "  {coarse:>6} to {fine:>6} vertices {:>9.4} mm",
            1e3 * distance
        );
    }
}

fn print_row(row: &Row) {
    let off = match row.bound {
        Bound::Relative(_) => format!("{:+.2} %", 100.0 * row.error()),
        Bound::Absolute(_) => format!("{:+.4}", row.error()),
    };
    let verdict = if row.holds() { "" } else { "   FAILS" };
    println!(
        "{:<66}{:>12.5}{:>12.5}{off:>12}{verdict}",
        row.name, row.expected, row.measured
    );
}
