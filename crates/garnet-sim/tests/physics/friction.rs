//! Coulomb friction: the inclined plane and the capstan.

use garnet_sim::Fabric;
use garnet_sim::reference::{Cylinder, Plane, Reference, ReferenceOptions};
use nalgebra::{Unit, Vector3};

#[cfg(test)]
use super::row::assert_all;
use super::row::{Bound, Row};
use super::sheets::{Cut, cloth_of, sheet};

const THRESHOLD: Bound = Bound::Absolute(0.5);
const CAPSTAN: Bound = Bound::Relative(0.05);

/// How far a sheet has slid down a plane after a second, in metres.
fn slide(friction: f64, degrees: f64) -> f64 {
    let angle = degrees.to_radians();
    let fabric = Fabric {
        friction: friction as f32,
        ..Fabric::cotton()
    };
    let mesh = sheet([6, 6], 0.02, Cut::Alternating);
    let cloth = cloth_of(&mesh, &fabric, &[]);
    let plane = Plane {
        origin: Vector3::new(0.0, -f64::from(fabric.thickness), 0.0),
        normal: Vector3::y_axis(),
    };
    let options = ReferenceOptions {
        gravity: 9.81 * Vector3::new(angle.sin(), -angle.cos(), 0.0),
        ..ReferenceOptions::default()
    };
    let mut sheet = Reference::new(&cloth, mesh.positions(), &plane, options).unwrap();
    for _ in 0..60 {
        assert!(sheet.step(1.0 / 60.0).unwrap().is_solved);
    }
    sheet.positions()[0].x - f64::from(mesh.positions()[0].x)
}

/// Cloth that has gone less far after a second, in metres, holds. Half a degree above the threshold
/// it goes 40 mm.
const HOLDS: f64 = 1e-4;

pub(crate) fn plane() -> Vec<Row> {
    let mut rows = Vec::new();
    for friction in [0.1, 0.3, 0.5] {
        let threshold = f64::atan(friction).to_degrees();
        let [mut holding, mut sliding] = [threshold - 2.0, threshold + 2.0];
        assert!(slide(friction, holding) < HOLDS && slide(friction, sliding) > HOLDS);
        while sliding - holding > 0.05 {
            let middle = 0.5 * (holding + sliding);
            if slide(friction, middle) < HOLDS {
                holding = middle;
            } else {
                sliding = middle;
            }
        }
        rows.push(Row {
            name: format!("inclined plane, angle of sliding, friction {friction} (degrees)"),
            expected: threshold,
            measured: 0.5 * (holding + sliding),
            bound: THRESHOLD,
        });
        let steep = (threshold + 5.0).to_radians();
        let acceleration = 9.81 * (steep.sin() - friction * steep.cos());
        rows.push(Row {
            name: format!("inclined plane, way in 1 s at 5 degrees more, friction {friction} (m)"),
            // Implicit Euler: h² n (n + 1) / 2 instead of t² / 2.
            expected: 0.5 * acceleration * (61.0 / 60.0),
            measured: slide(friction, threshold + 5.0),
            bound: Bound::Relative(0.02),
        });
    }
    rows
}

/// Cloth slides if and only if tan α > μ, and then with g (sin α − μ cos α) (Coulomb 1785).
#[test]
fn cloth_on_an_inclined_plane_slides_at_the_angle_of_friction() {
    assert_all(&plane());
}

/// The pull at the tight end of a strip around a cylinder over that at the slack end.
fn pull_ratio(friction: f64, wrap: f64) -> f64 {
    let fabric = Fabric {
        density: 0.2,
        membrane: 1000.0,
        compression: 1.0,
        bending: 0.0,
        friction: friction as f32,
        thickness: 0.003,
    };
    let (radius, tail, side) = (0.1, 0.04, 0.004);
    let roll = radius + f64::from(fabric.thickness);
    let cells = [((2.0 * tail + roll * wrap) / side).ceil() as usize, 2];
    let mesh = sheet(cells, side, Cut::Alternating);
    let across = cells[1] + 1;
    let pins: Vec<u32> = (0..across)
        .map(|j| (cells[0] * across + j) as u32)
        .collect();
    let cloth = cloth_of(&mesh, &fabric, &pins);
    let cylinder = Cylinder {
        center: Vector3::zeros(),
        axis: Vector3::z_axis(),
        radius,
    };
    // The strip comes up at the left, lies over the top and leaves to where `wrap` ends.
    let on_roll = |along: f64| {
        let angle = (along - tail) / roll;
        let inside = angle.clamp(0.0, wrap);
        let out = Vector3::new(-inside.cos(), inside.sin(), 0.0);
        let ahead = Vector3::new(inside.sin(), inside.cos(), 0.0);
        out * roll + ahead * ((angle - inside) * roll)
    };
    let placed = |point: &garnet_mesh::Point3| {
        let place = on_roll(f64::from(point.x)) + Vector3::z() * f64::from(point.z);
        garnet_mesh::Point3::from(place.cast::<f32>())
    };
    let start: Vec<_> = mesh.positions().iter().map(placed).collect();
    let options = ReferenceOptions {
        gravity: Vector3::zeros(),
        ..ReferenceOptions::default()
    };
    let mut strip = Reference::new(&cloth, &start, &cylinder, options).unwrap();
    let slack = 0.01;
    for vertex in 0..across {
        strip.add_load(vertex, -Vector3::y() * (slack / across as f64));
    }
    let ahead = Unit::new_normalize(Vector3::new(wrap.sin(), wrap.cos(), 0.0));
    for _ in 0..40 {
        for &pin in &pins {
            let place = strip.positions()[pin as usize] + ahead.into_inner() * 2e-4;
            strip.place(pin as usize, place);
        }
        strip.descend(1.0).unwrap();
    }
    let forces = strip.gradient();
    let pull: Vector3<f64> = pins.iter().map(|&pin| forces[pin as usize]).sum();
    pull.dot(&ahead) / slack
}

pub(crate) fn capstan() -> Vec<Row> {
    use std::f64::consts::{FRAC_PI_2, PI};
    let cases = [(0.3, FRAC_PI_2), (0.3, PI), (0.5, FRAC_PI_2), (0.5, PI)];
    let row = |(friction, wrap): (f64, f64)| Row {
        name: format!(
            "capstan, pull over pull, friction {friction}, {:.0} degrees",
            wrap.to_degrees()
        ),
        expected: (friction * wrap).exp(),
        measured: pull_ratio(friction, wrap),
        bound: CAPSTAN,
    };
    cases.into_iter().map(row).collect()
}

/// A strip pulled over a cylinder: T₁ / T₀ = exp(μ φ) (Euler 1769, Eytelwein 1808).
#[test]
fn pulls_on_a_capstan_grow_exponentially() {
    assert_all(&capstan());
}
