//! Cloth that hangs: stretch under its own weight, and the catenary.

use garnet_mesh::{Point3, TriMesh};
use garnet_sim::Fabric;
use garnet_sim::reference::{Nothing, Reference, ReferenceOptions};
use nalgebra::Vector3;

#[cfg(test)]
use super::row::assert_all;
use super::row::{Bound, Row};
use super::sheets::{Cut, cloth_of, equilateral, jittered, rest_of, sheet};

const STRIP: Bound = Bound::Relative(0.02);
const CATENARY: Bound = Bound::Relative(0.01);

/// Squares along and across the hanging strip.
const CELLS: [usize; 2] = [40, 4];

/// Side of a square of the hanging strip, in metres.
const SIDE: f64 = 0.025;

/// Poisson's ratio of the triangles.
const POISSON: f64 = 1.0 / 3.0;

/// Which membrane hangs.
#[derive(Clone, Copy, PartialEq)]
enum Membrane {
    Springs,
    Triangles,
}

/// How far the end of a strip held at its first column sinks, and how far it has to, in metres.
fn sink(mesh: &TriMesh, membrane: Membrane) -> [f64; 2] {
    let fabric = Fabric {
        density: 0.2,
        membrane: 1000.0,
        compression: 1.0,
        bending: 1e-5,
        ..Fabric::default()
    };
    let across = CELLS[1] + 1;
    let pins: Vec<u32> = (0..across as u32).collect();
    let cloth = cloth_of(mesh, &fabric, &pins);
    let options = ReferenceOptions {
        gravity: Vector3::new(9.81, 0.0, 0.0),
        ..ReferenceOptions::default()
    };
    let mut strip = Reference::new(&cloth, mesh.positions(), &Nothing, options).unwrap();
    if membrane == Membrane::Triangles {
        strip = strip
            .with_material(&cloth, &rest_of(mesh), POISSON)
            .unwrap();
    }
    let settled = strip.settle().unwrap();
    assert!(settled.is_settled, "{settled:?}");
    let first = mesh.num_vertices() - across;
    let sunk = (first..mesh.num_vertices())
        .map(|vertex| strip.positions()[vertex].x - f64::from(mesh.positions()[vertex].x));
    let length = CELLS[0] as f64 * SIDE;
    let expected = 0.2 * 9.81 * length * length / (2.0 * 1000.0);
    [sunk.sum::<f64>() / across as f64, expected]
}

pub(crate) fn strips() -> Vec<Row> {
    let square = sheet(CELLS, SIDE, Cut::Alternating);
    let one_way = sheet(CELLS, SIDE, Cut::OneWay);
    let rough = jittered(&square, CELLS, SIDE, 0.2);
    let regular = equilateral(CELLS, SIDE);
    let row = |name: &str, mesh: &TriMesh, membrane| {
        let [measured, expected] = sink(mesh, membrane);
        Row {
            name: format!("hanging strip, sinking of the end, {name} (m)"),
            expected,
            measured,
            bound: STRIP,
        }
    };
    vec![
        row("springs, equilateral", &regular, Membrane::Springs),
        row("triangles, equilateral", &regular, Membrane::Triangles),
        row("triangles, alternating", &square, Membrane::Triangles),
        row("triangles, one way", &one_way, Membrane::Triangles),
        row("triangles, jittered", &rough, Membrane::Triangles),
    ]
}

/// A strip under its own weight: the strain is ρ g (L − x) / Y, so the end sinks by ρ g L² / (2 Y).
///
/// Springs have the Young's modulus that they are given on equilateral faces (Van Gelder 1998) and
/// 1.2 times that on squares with alternating diagonals; triangles have it on every mesh.
#[test]
fn a_strip_sinks_under_its_own_weight() {
    assert_all(&strips());
}

/// Length over span, and sag over span: sinh(u) / u = L / d, sag / d = (cosh u − 1) / (2 u).
const SAGS: [(f64, f64); 6] = [
    (1.02, 0.0872),
    (1.05, 0.1393),
    (1.1, 0.2003),
    (1.2, 0.2923),
    (1.5, 0.5026),
    (2.0, 0.7964),
];

/// Pieces of a chain, an even number.
const PIECES: usize = 80;

/// Sag over span of a chain that starts as two straight halves.
fn sag(length_over_span: f64) -> f64 {
    let side = 1.0 / PIECES as f64;
    let mesh = sheet([PIECES, 1], side, Cut::OneWay);
    let fabric = Fabric {
        density: 0.2,
        membrane: 1e6,
        compression: 1.0,
        bending: 0.0,
        ..Fabric::default()
    };
    let last = mesh.num_vertices() as u32 - 1;
    let cloth = cloth_of(&mesh, &fabric, &[0, 1, last - 1, last]);
    let span = 1.0 / length_over_span;
    let depth = 0.5 * (1.0 - span * span).sqrt();
    let folded = |point: &Point3| {
        let down = 1.0 - (2.0 * f64::from(point.x) - 1.0).abs();
        let [x, y] = [f64::from(point.x) * span, -depth * down];
        Point3::new(x as f32, y as f32, point.z)
    };
    let start: Vec<Point3> = mesh.positions().iter().map(folded).collect();
    let options = ReferenceOptions::default();
    let mut chain = Reference::new(&cloth, &start, &Nothing, options).unwrap();
    let settled = chain.settle().unwrap();
    assert!(settled.is_settled, "{settled:?}");
    -chain.positions()[PIECES].y / span
}

pub(crate) fn catenaries() -> Vec<Row> {
    let row = |(length, expected): (f64, f64)| Row {
        name: format!("catenary, sag over span, length {length} spans"),
        expected,
        measured: sag(length),
        bound: CATENARY,
    };
    SAGS.into_iter().map(row).collect()
}

/// A chain between two points hangs as a catenary (Bernoulli, Huygens and Leibniz 1691).
#[test]
fn a_chain_hangs_as_a_catenary() {
    assert_all(&catenaries());
}
