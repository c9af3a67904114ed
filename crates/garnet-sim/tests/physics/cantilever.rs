//! A strip clamped at one end that bends under its own weight: the heavy elastica.

use garnet_mesh::TriMesh;
use garnet_sim::reference::{Nothing, Reference, ReferenceOptions};
use garnet_sim::Fabric;
use nalgebra::Vector3;

use crate::row::{Bound, Row, assert_all};
use crate::sheets::{Cut, cloth_of, equilateral, jittered, sheet};

/// Gravito-bending number Γ = ρ g L³ / B and drop of the tip H / L, from θ'' = −Γ (1 − s) cos θ,
/// θ(0) = 0, θ'(1) = 0.
const ELASTICA: [(f64, f64); 6] = [
    (1.0, 0.12347),
    (2.0, 0.23851),
    (5.0, 0.49591),
    (10.0, 0.70020),
    (30.0, 0.87309),
    (100.0, 0.93752),
];

/// Squares along and across the strip, the clamped one included.
const CELLS: [usize; 2] = [21, 6];

/// Side of a square, in metres; the free length is 20 of them.
const SIDE: f64 = 0.005;

const REGULAR: Bound = Bound::Relative(0.03);
const JITTERED: Bound = Bound::Relative(0.05);

/// Where the tip of the strip hangs: its drop and its reach from the clamp, over the length.
fn hang(mesh: &TriMesh, gamma: f64) -> [f64; 2] {
    let length = (CELLS[0] - 1) as f64 * SIDE;
    let density = 0.2;
    let fabric = Fabric {
        density: density as f32,
        membrane: 1000.0,
        bending: (density * 9.81 * length.powi(3) / gamma) as f32,
        ..Fabric::default()
    };
    let across = CELLS[1] as u32 + 1;
    let clamped: Vec<u32> = (0..2 * across).collect();
    let cloth = cloth_of(mesh, &fabric, &clamped);
    let options = ReferenceOptions::default();
    let mut strip = Reference::new(&cloth, mesh.positions(), &Nothing, options).unwrap();
    let settled = strip.settle().unwrap();
    assert!(settled.is_settled, "{settled:?}");
    let tip = &strip.positions()[mesh.num_vertices() - across as usize..];
    let mean = tip.iter().sum::<Vector3<f64>>() / f64::from(across);
    [-mean.y / length, (mean.x - SIDE) / length]
}

fn rows(name: &str, mesh: &TriMesh, bound: Bound) -> Vec<Row> {
    let row = |(gamma, expected): (f64, f64)| Row {
        name: format!("cantilever H/L, {name}, gamma {gamma}"),
        expected,
        measured: hang(mesh, gamma)[0],
        bound,
    };
    ELASTICA.into_iter().map(row).collect()
}

pub fn regular() -> Vec<Row> {
    let mut all = rows("alternating", &sheet(CELLS, SIDE, Cut::Alternating), REGULAR);
    all.extend(rows("one way", &sheet(CELLS, SIDE, Cut::OneWay), REGULAR));
    all.extend(rows("equilateral", &equilateral(CELLS, SIDE), REGULAR));
    all
}

pub fn jitter() -> Vec<Row> {
    let mesh = sheet(CELLS, SIDE, Cut::Alternating);
    rows("jittered", &jittered(&mesh, CELLS, SIDE, std::env::var("J").unwrap().parse().unwrap()), JITTERED)
}

/// The tip of a heavy elastica (planar rod under its own weight; master curve of Romero et al. 2021,
/// "Physical validation of simulators in computer graphics", recomputed from the equation above).
#[test]
fn a_heavy_strip_hangs_as_the_elastica_does() {
    assert_all(&regular());
}

/// The same on a mesh whose vertices lie anywhere within 0.4 of a cell.
#[test]
fn so_it_does_on_a_jittered_mesh() {
    assert_all(&jitter());
}

/// Length of bending from the angle θ of the chord, over the length of the strip (Peirce 1930, "The
/// handle of cloth as a measurable quantity"): c / l = (cos(θ/2) / (8 tan θ))^(1/3).
fn peirce_length(angle: f64) -> f64 {
    ((0.5 * angle).cos() / (8.0 * angle.tan())).cbrt()
}

pub fn peirce() -> Vec<Row> {
    let mesh = sheet(CELLS, SIDE, Cut::Alternating);
    // Γ = (l / c)³: chords of 7, 20 and 41.5 degrees.
    let row = |gamma: f64| {
        let [drop, reach] = hang(&mesh, gamma);
        Row {
            name: format!("Peirce's bending length over length, gamma {gamma}"),
            expected: gamma.cbrt().recip(),
            measured: peirce_length((drop / reach).atan()),
            bound: REGULAR,
        }
    };
    [1.0, 3.0, 8.0].map(row).into()
}

/// The bending length c = (B / (ρ g))^(1/3) read off a strip as a bending tester does.
#[test]
fn the_bending_length_read_off_a_strip_is_that_of_the_fabric() {
    assert_all(&peirce());
}
