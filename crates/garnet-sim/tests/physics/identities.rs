//! What holds for every solver: free fall, rigid motion, energy, gradient.

use garnet_sim::Fabric;
use garnet_sim::reference::{Nothing, Plane, Reference, ReferenceOptions};
use nalgebra::{Rotation3, Vector3};

use crate::sheets::{Cut, cloth_of, noise, rest_of, sheet};

/// Rounding of positions of about a metre, in metres.
const ROUNDING: f64 = 1e-12;

/// Analytic gradient against central differences.
const GRADIENT: f64 = 1e-3;

fn options() -> ReferenceOptions {
    ReferenceOptions {
        tolerance: 1e-6,
        ..ReferenceOptions::default()
    }
}

/// Implicit Euler falls by g h² n (n + 1) / 2 in n steps of length h.
#[test]
fn cloth_falls_freely() {
    let mesh = sheet([5, 4], 0.02, Cut::Alternating);
    let cloth = cloth_of(&mesh, &Fabric::jersey(), &[]);
    let mut falling = Reference::new(&cloth, mesh.positions(), &Nothing, options()).unwrap();
    let (steps, seconds) = (20, 1.0 / 60.0);
    for _ in 0..steps {
        assert!(falling.step(seconds).unwrap().is_solved);
    }
    let fallen = 0.5 * 9.81 * seconds * seconds * f64::from(steps * (steps + 1));
    for (place, start) in falling.positions().iter().zip(mesh.positions()) {
        let start = start.coords.cast::<f64>();
        // The tolerance of a millionth of a weight, 210 times.
        assert!((place - start + Vector3::y() * fallen).norm() < 1e-6 * fallen);
    }
}

/// Moving and turning cloth as a whole costs no energy and gives no force.
#[test]
fn a_rigid_motion_gives_no_force() {
    let mesh = sheet([8, 6], 0.02, Cut::Alternating);
    let fabric = Fabric::denim();
    let cloth = cloth_of(&mesh, &fabric, &[]);
    let weightless = ReferenceOptions {
        gravity: Vector3::zeros(),
        ..options()
    };
    let springs = Reference::new(&cloth, mesh.positions(), &Nothing, weightless).unwrap();
    let triangles = Reference::new(&cloth, mesh.positions(), &Nothing, weightless).unwrap();
    let triangles = triangles
        .with_material(&cloth, &rest_of(&mesh), 0.3)
        .unwrap();
    let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    for mut rigid in [springs, triangles] {
        let before = rigid.gradient();
        for vertex in 0..mesh.num_vertices() {
            let place = turn * rigid.positions()[vertex] + Vector3::new(0.5, 1.0, -0.2);
            rigid.place(vertex, place);
        }
        // Rest lengths are stored in `f32`: what force there is turns along.
        let stiffest = 2.0 * f64::from(fabric.membrane);
        for (after, before) in rigid.gradient().into_iter().zip(before) {
            assert!((after - turn * before).norm() < ROUNDING * stiffest);
            assert!(after.norm() < 1e-8 * stiffest);
        }
    }
}

/// Without friction or drag implicit Euler loses energy and never gains any.
#[test]
fn energy_never_grows() {
    let mesh = sheet([8, 8], 0.02, Cut::Alternating);
    let cloth = cloth_of(&mesh, &Fabric::cotton(), &[0, 8]);
    let mut swinging = Reference::new(&cloth, mesh.positions(), &Nothing, options()).unwrap();
    swinging.set_velocities(|place| Vector3::new(0.0, 20.0 * place.x, 5.0 * place.z));
    let energy = |cloth: &Reference| cloth.kinetic_energy() + cloth.energies().total();
    let mut last = energy(&swinging);
    for _ in 0..100 {
        assert!(swinging.step(1.0 / 120.0).unwrap().is_solved);
        let next = energy(&swinging);
        assert!(next <= last + 1e-9, "{next} J after {last} J");
        last = next;
    }
}

/// The gradient is the derivative of the energy, for every part of it.
#[test]
fn the_gradient_is_the_derivative_of_the_energy() {
    let mesh = sheet([5, 4], 0.02, Cut::OneWay);
    let cloth = cloth_of(&mesh, &Fabric::denim(), &[]);
    let options = ReferenceOptions {
        self_contact: Some(0.03),
        ..options()
    };
    let plane = Plane {
        origin: Vector3::zeros(),
        normal: Vector3::y_axis(),
    };
    for with_triangles in [false, true] {
        let mut cloth_on_plane = Reference::new(&cloth, mesh.positions(), &plane, options).unwrap();
        if with_triangles {
            let rest = rest_of(&mesh);
            cloth_on_plane = cloth_on_plane.with_material(&cloth, &rest, 0.3).unwrap();
        }
        cloth_on_plane.step(1e-3).unwrap();
        for vertex in 0..mesh.num_vertices() {
            let seed = 3 * vertex as u64;
            let bump = Vector3::new(noise(seed), noise(seed + 1), noise(seed + 2)) * 0.004;
            let place = cloth_on_plane.positions()[vertex] + bump;
            cloth_on_plane.place(vertex, place);
        }
        let gradient = cloth_on_plane.gradient();
        let largest = gradient.iter().map(Vector3::norm).fold(0.0, f64::max);
        for (vertex, gradient) in gradient.iter().enumerate() {
            for axis in 0..3 {
                let place = cloth_on_plane.positions()[vertex];
                let mut energy = |offset: f64| {
                    let mut moved = place;
                    moved[axis] += offset;
                    cloth_on_plane.place(vertex, moved);
                    cloth_on_plane.energies().total()
                };
                let difference = (energy(1e-7) - energy(-1e-7)) / 2e-7;
                energy(0.0);
                let error = (difference - gradient[axis]).abs();
                assert!(error < GRADIENT * largest, "vertex {vertex}, axis {axis}");
            }
        }
    }
}

/// A NaN, a list that does not fit and cloth that nothing holds end in an answer.
#[test]
fn what_cannot_be_simulated_is_refused() {
    let mesh = sheet([2, 2], 0.1, Cut::OneWay);
    let cloth = cloth_of(&mesh, &Fabric::silk(), &[]);
    let mut start = mesh.positions().to_vec();
    start[3].y = f32::NAN;
    assert!(Reference::new(&cloth, &start, &Nothing, options()).is_err());
    assert!(Reference::new(&cloth, &start[1..], &Nothing, options()).is_err());
    let bounded = ReferenceOptions {
        max_steps: 3,
        ..options()
    };
    let mut falling = Reference::new(&cloth, mesh.positions(), &Nothing, bounded).unwrap();
    let settled = falling.settle().unwrap();
    assert!(!settled.is_settled && settled.steps == 3);
}
