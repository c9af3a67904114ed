//! Cloth in empty space: what mechanics conserves.

use approx::assert_relative_eq;
use garnet_mesh::primitives::{grid, tube};
use garnet_sim::{Energy, Fabric, Point3, STANDARD_GRAVITY, Schedule};

use crate::stage::{center, cloth_of, run_free, undamped};

/// Positions near 1 m in `f32`.
const ROUNDING: f32 = 1e-6;

/// What 2400 substeps may move the center by, in metres.
const DRIFT: f64 = 5e-6;

/// What rounding may move vertices aside by while they fall, in metres: edges that are shortened by
/// it hardly push back.
const ASIDE: f32 = 3e-6;

/// Sums of some hundred displacements in `f32`.
const FALLING: f64 = 1e-4;

/// Into how many patches the cloth is cut.
const PATCHES: [u32; 3] = [1, 2, 5];

#[test]
fn cloth_falls_as_everything_falls() {
    let mesh = grid(10, 10, [0.3, 0.3]);
    let cloth = cloth_of(&mesh, &Fabric::cotton());
    let (frames, rate) = (24, 1200.0);
    // With substeps of h: y = −g h² n (n + 1) / 2.
    let steps = f64::from(frames) * f64::from(rate) / 60.0;
    let fall = 0.5 * f64::from(STANDARD_GRAVITY) * steps * (steps + 1.0) / f64::from(rate).powi(2);
    for patches in PATCHES {
        let schedule = Schedule {
            gravity: STANDARD_GRAVITY,
            patches,
            ..undamped(frames, rate)
        };
        let draped = run_free(&cloth, mesh.positions(), &schedule, &mut |_| {});
        for (start, end) in mesh.positions().iter().zip(&draped.positions) {
            assert_relative_eq!(f64::from(start.y - end.y), fall, max_relative = FALLING);
            let aside = (start.x - end.x).abs().max((start.z - end.z).abs());
            assert!(aside < ASIDE, "{aside}");
        }
    }
}

#[test]
fn springs_of_a_share_of_their_lengths_draw_cloth_together_by_it() {
    let mesh = grid(12, 9, [0.4, 0.3]);
    let cloth = cloth_of(&mesh, &Fabric::cotton());
    let schedule = Schedule {
        length_share: 0.98,
        drag: 20.0,
        ..undamped(60, 2400.0)
    };
    let draped = run_free(&cloth, mesh.positions(), &schedule, &mut |_| {});
    for spring in cloth.springs() {
        let [a, b] = spring
            .vertices
            .map(|vertex| draped.positions[vertex as usize]);
        assert_relative_eq!(
            (a - b).norm(),
            0.98 * spring.rest_length,
            max_relative = 1e-3
        );
    }
}

#[test]
fn flat_cloth_at_rest_stays_at_rest() {
    let mesh = grid(12, 9, [0.4, 0.3]);
    let cloth = cloth_of(&mesh, &Fabric::denim());
    for patches in PATCHES {
        let schedule = Schedule {
            patches,
            ..undamped(30, 2400.0)
        };
        let draped = run_free(&cloth, mesh.positions(), &schedule, &mut |_| {});
        for (start, end) in mesh.positions().iter().zip(&draped.positions) {
            assert!((end - start).norm() < ROUNDING, "{start} {end}");
        }
        assert!(draped.report.speeds.max < ROUNDING);
    }
}

#[test]
fn stretched_cloth_keeps_its_momentum_and_gains_no_energy() {
    let mesh = tube(0.1, 0.3, 20, 16);
    let cloth = cloth_of(&mesh, &Fabric::jersey());
    let stretched: Vec<Point3> = mesh
        .positions()
        .iter()
        .map(|p| Point3::new(1.05 * p.x, 1.1 * p.y, p.z + 0.02 * p.y))
        .collect();
    let before = Energy::of(&cloth, &stretched, 0.0).total();
    let start = center(&cloth, &stretched);
    for patches in PATCHES {
        let mut last = stretched.clone();
        let schedule = Schedule {
            patches,
            ..undamped(60, 2400.0)
        };
        run_free(&cloth, &stretched, &schedule, &mut |positions| {
            let moved = (center(&cloth, positions) - start).norm();
            assert!(moved < DRIFT, "the center moved by {moved} m");
            let elastic = Energy::of(&cloth, positions, 0.0).total();
            // The mean velocity over a frame gives less than the kinetic energy, never more.
            let kinetic: f64 = last
                .iter()
                .zip(positions)
                .zip(cloth.masses())
                .map(|((a, b), &mass)| 0.5 * f64::from(mass * (60.0 * (b - a)).norm_squared()))
                .sum();
            assert!(
                elastic + kinetic < 1.001 * before,
                "{elastic} + {kinetic} > {before}"
            );
            last.copy_from_slice(positions);
        });
    }
}

#[test]
fn a_pinned_strip_hangs_as_long_as_its_weight_stretches_it() {
    // Edges along the load carry Y/(1 − ν²)-like stiffness that depends on the mesh; a generous
    // band tells a soft solver (percents) from the spring's own law (parts of a percent).
    let mesh = grid(4, 40, [0.05, 0.5]);
    let fabric = Fabric::cotton();
    let top: Vec<u32> = (0..5).map(|column| 40 * 5 + column).collect();
    let cloth = cloth_of(&mesh, &fabric).with_pins(&top).unwrap();
    let schedule = Schedule {
        gravity: STANDARD_GRAVITY,
        drag: 10.0,
        ..undamped(60, 12_000.0)
    };
    let draped = run_free(&cloth, mesh.positions(), &schedule, &mut |_| {});
    for &vertex in &top {
        let vertex = vertex as usize;
        assert_eq!(draped.positions[vertex], mesh.positions()[vertex]);
    }
    let sag = mesh.positions()[2].y - draped.positions[2].y;
    let law = fabric.density * STANDARD_GRAVITY * 0.25 / (2.0 * fabric.membrane);
    assert!(sag > 0.5 * law && sag < 0.01, "{sag} is not about {law}");
}
