//! A strip clamped at one end that bends under its own weight: the heavy elastica.

use garnet_mesh::TriMesh;
use garnet_sim::reference::{Nothing, Reference, ReferenceOptions};
use garnet_sim::{BENDING_FACTOR, Fabric};
use nalgebra::Vector3;

#[cfg(test)]
use super::row::assert_all;
use super::row::{Bound, Row};
use super::sheets::{Cut, cloth_of, equilateral, jittered, rest_of, sheet};

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
const CELLS: [usize; 2] = [21, 12];

/// Free length of a strip, in metres. It begins in the middle of the clamped squares: the hinges at
/// their end stand for the curvature from there on, and to begin it at the end makes a strip of 20
/// squares seem a tenth too soft.
const LENGTH: f64 = 0.1;

/// The coefficient of hinges on equilateral faces: 1 bends a cylinder with its true energy, 9/8 a
/// narrow strip that is free to curl across (the hinges have a Poisson's ratio of −1/3). This strip
/// is in between.
const EQUILATERAL_FACTOR: f32 = 1.05;

/// How far vertices of a jittered mesh lie from their places, over the side of a square.
const JITTER: f64 = 0.2;

const REGULAR: Bound = Bound::Relative(0.03);
const JITTERED: Bound = Bound::Relative(0.05);

/// What resists stretching and bending.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Model {
    /// Springs and hinges with a coefficient, as in the production solver.
    Hinges(f32),
    /// An isotropic material of Poisson's ratio 0: a strip of it is a rod, however wide.
    Material,
}

/// Side of the squares of a strip, in metres.
fn side() -> f64 {
    LENGTH / (CELLS[0] as f64 - 0.5)
}

/// Where the tip of the strip hangs: its drop and its reach from the clamp, over the length.
fn hang(mesh: &TriMesh, model: Model, gamma: f64) -> [f64; 2] {
    let density = 0.2;
    let bending = (density * 9.81 * LENGTH.powi(3) / gamma) as f32;
    let fabric = Fabric {
        density: density as f32,
        membrane: 1000.0,
        compression: 1.0,
        bending: match model {
            Model::Hinges(factor) => bending * factor / BENDING_FACTOR,
            Model::Material => bending,
        },
        ..Fabric::default()
    };
    let across = CELLS[1] as u32 + 1;
    let clamped: Vec<u32> = (0..2 * across).collect();
    let cloth = cloth_of(mesh, &fabric, &clamped);
    let options = ReferenceOptions::default();
    let mut strip = Reference::new(&cloth, mesh.positions(), &Nothing, options).unwrap();
    if model == Model::Material {
        strip = strip.with_material(&cloth, &rest_of(mesh), 0.0).unwrap();
    }
    let settled = strip.settle().unwrap();
    assert!(settled.is_settled, "{settled:?}");
    let tip = &strip.positions()[mesh.num_vertices() - across as usize..];
    let mean = tip.iter().sum::<Vector3<f64>>() / f64::from(across);
    [-mean.y / LENGTH, (mean.x - 0.5 * side()) / LENGTH]
}

fn rows(name: &str, mesh: &TriMesh, model: Model, bound: Bound) -> Vec<Row> {
    let row = |(gamma, expected): (f64, f64)| Row {
        name: format!("cantilever H/L, {name}, gamma {gamma}"),
        expected,
        measured: hang(mesh, model, gamma)[0],
        bound,
    };
    ELASTICA.into_iter().map(row).collect()
}

fn meshes() -> [(&'static str, TriMesh); 2] {
    [
        ("equilateral", equilateral(CELLS, side())),
        ("one way", sheet(CELLS, side(), Cut::OneWay)),
    ]
}

fn rough(mesh: &TriMesh, share: f64) -> TriMesh {
    jittered(mesh, CELLS, side(), share)
}

/// Hinges on the mesh for which their coefficient is known.
pub(crate) fn hinges() -> Vec<Row> {
    let mesh = equilateral(CELLS, side());
    let model = Model::Hinges(EQUILATERAL_FACTOR);
    rows("hinges, equilateral, c = 1.05", &mesh, model, REGULAR)
}

/// Hinges with the coefficient of the production solver, on all meshes; no test.
pub(crate) fn hinges_elsewhere() -> Vec<Row> {
    let alternating = ("alternating", sheet(CELLS, side(), Cut::Alternating));
    let mut all = Vec::new();
    for (name, mesh) in meshes().into_iter().chain([alternating]) {
        let model = Model::Hinges(BENDING_FACTOR);
        let name = format!("hinges, {name}, c = {BENDING_FACTOR}");
        all.extend(rows(&name, &mesh, model, REGULAR));
        let name = format!("{name}, jittered {JITTER}");
        all.extend(rows(&name, &rough(&mesh, JITTER), model, JITTERED));
    }
    all
}

/// The isotropic material where it fails: on squares cut alternately, and on rough meshes; no test.
pub(crate) fn material_elsewhere() -> Vec<Row> {
    let alternating = sheet(CELLS, side(), Cut::Alternating);
    let mut all = rows(
        "material, alternating",
        &alternating,
        Model::Material,
        REGULAR,
    );
    for (name, mesh) in meshes() {
        let name = format!("material, {name}, jittered 0.4");
        all.extend(rows(&name, &rough(&mesh, 0.4), Model::Material, JITTERED));
    }
    all
}

pub(crate) fn material() -> Vec<Row> {
    let of = |(name, mesh): (&str, TriMesh)| {
        rows(
            &format!("material, {name}"),
            &mesh,
            Model::Material,
            REGULAR,
        )
    };
    meshes().into_iter().flat_map(of).collect()
}

pub(crate) fn jittered_material() -> Vec<Row> {
    let of = |(name, mesh): (&str, TriMesh)| {
        let name = format!("material, {name}, jittered {JITTER}");
        rows(&name, &rough(&mesh, JITTER), Model::Material, JITTERED)
    };
    meshes().into_iter().flat_map(of).collect()
}

/// The tip of a heavy elastica (planar rod under its own weight; master curve of Romero et al.
/// 2021, "Physical validation of simulators in computer graphics", recomputed from the equation
/// above).
#[test]
fn a_heavy_strip_hangs_as_the_elastica_does() {
    assert_all(&material());
}

/// The same on meshes whose vertices lie anywhere within 0.2 of a square along each axis.
#[test]
fn so_it_does_on_jittered_meshes() {
    assert_all(&jittered_material());
}

/// The same with the hinges of the production solver, on equilateral faces, for which their
/// coefficient is known.
#[test]
fn so_do_hinges_on_equilateral_faces() {
    assert_all(&hinges());
}

/// Length of bending from the angle θ of the chord, over the length of the strip (Peirce 1930, "The
/// handle of cloth as a measurable quantity"): c / l = (cos(θ/2) / (8 tan θ))^(1/3).
fn peirce_length(angle: f64) -> f64 {
    ((0.5 * angle).cos() / (8.0 * angle.tan())).cbrt()
}

pub(crate) fn peirce() -> Vec<Row> {
    let mesh = equilateral(CELLS, side());
    // Γ = (l / c)³: chords of 7, 20 and 41.5 degrees.
    let row = |gamma: f64| {
        let [drop, reach] = hang(&mesh, Model::Material, gamma);
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
