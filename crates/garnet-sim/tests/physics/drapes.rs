//! Cloth on a ball and on a drape tester.

#[cfg(test)]
use garnet_knn::Surface;
#[cfg(test)]
use garnet_mesh::primitives::icosphere;
use garnet_mesh::{Point3, TriMesh};
use garnet_sim::Fabric;
use garnet_sim::reference::{Nothing, Obstacle, Reference, ReferenceOptions, Sphere};
use nalgebra::Vector3;

#[cfg(test)]
use super::row::assert_all;
use super::row::{Bound, Row};
use super::sheets::{Cut, cloth_of, noise, sheet};

const BALANCE: Bound = Bound::Relative(0.01);

/// A square of 1 m, 0.2 kg/m², starts flat above a ball of 25 cm: the forces of contact and the
/// nearest place to the ball.
pub(crate) fn ball() -> Vec<Row> {
    let cells = 24;
    let mesh = sheet([cells, cells], 1.0 / cells as f64, Cut::Alternating);
    let fabric = Fabric {
        density: 0.2,
        bending: 1e-4,
        ..Fabric::cotton()
    };
    let cloth = cloth_of(&mesh, &fabric, &[]);
    let ball = Sphere {
        center: Vector3::new(0.5, -0.25 - f64::from(fabric.thickness), 0.5),
        radius: 0.25,
    };
    let options = ReferenceOptions {
        self_contact: Some(0.02),
        ..ReferenceOptions::default()
    };
    let mut drape = Reference::new(&cloth, mesh.positions(), &ball, options).unwrap();
    let settled = drape.settle().unwrap();
    assert!(settled.is_settled, "{settled:?}");
    let forces = drape.contact_forces();
    let sum: Vector3<f64> = forces
        .iter()
        .map(|force| force.normal + force.friction)
        .sum();
    let distance = |(vertex, x): (usize, &Vector3<f64>)| {
        let nearest = ball.nearest(vertex, x, 10.0);
        nearest.map_or(10.0, |nearest| nearest.distance)
    };
    let nearest = drape.positions().iter().enumerate().map(distance);
    let thickness = f64::from(fabric.thickness);
    vec![
        Row {
            name: "ball, sum of the vertical forces of contact (N)".into(),
            expected: 0.2 * 9.81,
            measured: sum.y,
            bound: BALANCE,
        },
        Row {
            name: "ball, sideways forces of contact (N)".into(),
            expected: 0.0,
            measured: sum.x.hypot(sum.z),
            bound: Bound::Absolute(0.01 * 0.2 * 9.81),
        },
        Row {
            name: "ball, smallest distance (m)".into(),
            expected: thickness,
            measured: nearest.fold(10.0, f64::min),
            bound: Bound::Absolute(0.5 * thickness),
        },
    ]
}

/// At rest what the ball does to the cloth is the weight of the cloth, ρ A g = 1.962 N upward, and
/// no vertex is inside.
#[test]
fn a_ball_carries_the_weight_of_the_cloth_on_it() {
    assert_all(&ball());
}

/// Radii of the disc of cloth and of the one that holds it, in metres (ISO 9073-9).
const CLOTH_RADIUS: f64 = 0.15;
const HELD_RADIUS: f64 = 0.09;

/// The weight is put on in this many steps: all at once, cloth buckles into more folds than its
/// weight can keep.
const LOAD_STEPS: u8 = 8;

/// What a drape tester reads.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cusick {
    /// Share of the ring's shadow that stays, in percent.
    pub(crate) coefficient: f64,
    /// Waves of the rim.
    pub(crate) folds: usize,
    /// Whether the cloth came to rest.
    pub(crate) is_settled: bool,
}

/// A disc of cloth of the given bending rigidity (N m), held in the middle.
pub(crate) fn cusick(bending: f64, rings: usize) -> Cusick {
    let (mesh, rim) = disc(rings);
    let held =
        |vertex: &u32| mesh.positions()[*vertex as usize].coords.norm() < HELD_RADIUS as f32 + 1e-4;
    let pins: Vec<u32> = (0..mesh.num_vertices() as u32).filter(held).collect();
    let rough = |(vertex, point): (usize, &Point3)| {
        let is_held = held(&(vertex as u32));
        let height = if is_held {
            0.0
        } else {
            1e-3 * noise(vertex as u64)
        };
        Point3::new(point.x, height as f32, point.z)
    };
    let mut place: Vec<Point3> = mesh.positions().iter().enumerate().map(rough).collect();
    let options = ReferenceOptions {
        self_contact: Some(0.7 * CLOTH_RADIUS / rings as f64),
        ..ReferenceOptions::default()
    };
    let fabric = Fabric {
        density: 0.2,
        membrane: 1000.0,
        bending: bending as f32,
        ..Fabric::default()
    };
    let cloth = cloth_of(&mesh, &fabric, &pins);
    let mut is_settled = false;
    let mut x = Vec::new();
    for step in 1..=LOAD_STEPS {
        let gravity = options.gravity * (f64::from(step) / f64::from(LOAD_STEPS));
        let loaded = ReferenceOptions { gravity, ..options };
        let mut drape = Reference::new(&cloth, &place, &Nothing, loaded).unwrap();
        let settled = drape.settle().unwrap();
        is_settled = settled.is_settled;
        x = drape.positions().to_vec();
        place = x.iter().map(|x| Point3::from(x.cast::<f32>())).collect();
    }
    let disc_area = |radius: f64| std::f64::consts::PI * radius * radius;
    let [full, held] = [disc_area(CLOTH_RADIUS), disc_area(HELD_RADIUS)];
    let shadow = shadow(&x, mesh.faces());
    Cusick {
        coefficient: 100.0 * (shadow - held) / (full - held),
        folds: folds(&x[rim..]),
        is_settled,
    }
}

/// Area under the cloth, m²: of the squares of a fine raster whose middle a face covers.
fn shadow(x: &[Vector3<f64>], faces: &[[u32; 3]]) -> f64 {
    const SIDE: usize = 400;
    let cell = 2.2 * CLOTH_RADIUS / SIDE as f64;
    let mut covered = vec![false; SIDE * SIDE];
    for face in faces {
        let corners = face.map(|vertex| {
            let place = x[vertex as usize];
            [
                place.x / cell + SIDE as f64 / 2.0,
                place.z / cell + SIDE as f64 / 2.0,
            ]
        });
        let bounds = |axis: usize| {
            let values = corners.map(|corner| corner[axis]);
            let low = values.into_iter().fold(f64::INFINITY, f64::min).max(0.0);
            let high = values
                .into_iter()
                .fold(0.0, f64::max)
                .min(SIDE as f64 - 1.0);
            low as usize..=high as usize
        };
        for i in bounds(0) {
            for j in bounds(1) {
                let [px, pz] = [i as f64 + 0.5, j as f64 + 0.5];
                let side = |a: [f64; 2], b: [f64; 2]| {
                    (b[0] - a[0]) * (pz - a[1]) - (b[1] - a[1]) * (px - a[0])
                };
                let [a, b, c] = corners;
                let sides = [side(a, b), side(b, c), side(c, a)];
                let is_inside =
                    sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0);
                covered[i * SIDE + j] |= is_inside;
            }
        }
    }
    covered.iter().filter(|is_covered| **is_covered).count() as f64 * cell * cell
}

/// Waves of a rim: how often its distance from the axis rises through the mean, small ripples
/// apart.
fn folds(rim: &[Vector3<f64>]) -> usize {
    let radii: Vec<f64> = rim.iter().map(|place| place.x.hypot(place.z)).collect();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    let deviation = |radius: &f64| (radius - mean).powi(2);
    let spread = (radii.iter().map(deviation).sum::<f64>() / radii.len() as f64).sqrt();
    // A wave has to pass from below to above by a third of the spread.
    let margin = spread.max(1e-3) / 3.0;
    let mut is_high = radii[radii.len() - 1] > mean;
    let mut rises = 0;
    for _ in 0..2 {
        rises = 0;
        for &radius in &radii {
            if is_high && radius < mean - margin {
                is_high = false;
            } else if !is_high && radius > mean + margin {
                is_high = true;
                rises += 1;
            }
        }
    }
    rises
}

/// A disc of rings of nearly equilateral triangles, each turned by the golden angle against the one
/// inside so that no number of folds is favored; and the first vertex of the rim.
fn disc(rings: usize) -> (TriMesh, usize) {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let mut positions = vec![Point3::origin()];
    let mut starts = vec![0, 1];
    let size = |ring: usize| 6 * ring;
    let angle = |ring: usize, step: usize| {
        golden * ring as f64 + std::f64::consts::TAU * step as f64 / size(ring) as f64
    };
    for ring in 1..=rings {
        let radius = CLOTH_RADIUS * ring as f64 / rings as f64;
        for step in 0..size(ring) {
            let (sin, cos) = angle(ring, step).sin_cos();
            positions.push(Point3::new(
                (radius * cos) as f32,
                0.0,
                (radius * sin) as f32,
            ));
        }
        starts.push(positions.len());
    }
    let mut faces = Vec::new();
    let at = |ring: usize, step: usize| (starts[ring] + step % size(ring).max(1)) as u32;
    for step in 0..6 {
        faces.push([0, at(1, step + 1), at(1, step)]);
    }
    for ring in 2..=rings {
        // The first vertex of the inner ring goes with the nearest one of the outer.
        let turn = (angle(ring - 1, 0) - golden * ring as f64).rem_euclid(std::f64::consts::TAU);
        let first = (turn / std::f64::consts::TAU * size(ring) as f64).round() as usize;
        let (mut inner, mut outer) = (0, 0);
        while inner < size(ring - 1) || outer < size(ring) {
            let goes_outer = inner == size(ring - 1)
                || (outer < size(ring) && (outer + 1) * size(ring - 1) <= (inner + 1) * size(ring));
            let (a, b) = (at(ring - 1, inner), at(ring, first + outer));
            if goes_outer {
                faces.push([a, at(ring, first + outer + 1), b]);
                outer += 1;
            } else {
                faces.push([a, at(ring - 1, inner + 1), b]);
                inner += 1;
            }
        }
    }
    (TriMesh::new(positions, faces).unwrap(), starts[rings])
}

/// Bending rigidities from silk to denim, N m.
pub(crate) const RIGIDITIES: [f64; 5] = [3e-6, 1e-5, 3e-5, 1e-4, 3e-4];

/// The drape coefficient rises with the bending rigidity, and a medium fabric falls in 5 to 8 folds
/// (Cusick 1965, "The dependence of fabric drape on bending and shear stiffness").
#[test]
fn stiffer_cloth_drapes_less_and_a_medium_one_in_five_to_eight_folds() {
    let measured = RIGIDITIES.map(|bending| cusick(bending, 15));
    let coefficients = measured.map(|measured| measured.coefficient);
    assert!(coefficients.is_sorted(), "{measured:?}");
    assert!((5..=8).contains(&measured[1].folds), "{measured:?}");
}

/// Cloth settles on a mesh as it does on the ball that the mesh is inscribed in, and twice alike.
#[test]
fn cloth_settles_on_a_mesh_as_on_the_ball_that_it_stands_for() {
    let ball = Sphere {
        center: Vector3::zeros(),
        radius: 0.1,
    };
    let body = Surface::new(&icosphere(4, ball.radius as f32));
    let cells = 12;
    let fabric = Fabric::denim();
    let flat = sheet([cells, cells], 0.15 / cells as f64, Cut::OneWay);
    let above = flat
        .positions()
        .iter()
        .map(|point| Point3::new(point.x - 0.075, 0.1 + fabric.thickness, point.z - 0.075));
    let start: Vec<Point3> = above.collect();
    let cloth = cloth_of(&flat, &fabric, &[]);
    let options = ReferenceOptions::default();
    let settled = || {
        let mut reference = Reference::new(&cloth, &start, &body, options).unwrap();
        let settled = reference.settle().unwrap();
        assert!(settled.is_settled, "{settled:?}");
        reference.positions().to_vec()
    };
    let on_mesh = settled();
    assert_eq!(settled(), on_mesh);
    let mut on_ball = Reference::new(&cloth, &start, &ball, options).unwrap();
    assert!(on_ball.settle().unwrap().is_settled);
    // The faces of the mesh lie up to 0.3 mm inside the ball.
    for (mesh, ball) in on_mesh.iter().zip(on_ball.positions()) {
        assert!((mesh - ball).norm() < 1e-3, "{mesh} {ball}");
    }
}
