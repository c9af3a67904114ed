use garnet_mesh::primitives::{grid, icosphere, tube};
use garnet_mesh::{Point3, Topology, TriMesh, mean_curvature_normals};

use super::gradient::{Gradient, Place};
use super::mean_curvature::TargetCurvature;
use super::penetration::Front;
use super::rayleigh::{Neighborhoods, rayleigh_quotients};
use super::*;

/// Every term with a weight of its own.
fn all_terms() -> LossConfig {
    LossConfig {
        mean_curvature: 0.7,
        uniform_curvature: 0.9,
        rayleigh: [1.1, 1.2, 1.3],
        strain: 0.4,
        gravity: 0.6,
        fold: 0.8,
        ..LossConfig::paper()
    }
}

/// Reproducible numbers in ±1.
fn noise(seed: u64) -> impl FnMut() -> f32 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    }
}

fn shaken(points: &[Point3], size: f32, seed: u64) -> Vec<Point3> {
    let mut noise = noise(seed);
    let shake = |point: &Point3| point + Vector3::new(noise(), noise(), noise()) * size;
    points.iter().map(shake).collect()
}

fn sleeve() -> TriMesh {
    tube(0.06, 0.12, 9, 6)
}

#[test]
fn every_derivative_agrees_with_finite_differences() {
    let template = sleeve();
    let losses = Losses::new(&template, &all_terms()).unwrap();
    let target = losses
        .target(&shaken(template.positions(), 0.004, 1))
        .unwrap();
    let predicted = in_units(&shaken(template.positions(), 0.006, 2));
    let body = LossBody::new(&icosphere(2, 0.062)).unwrap();
    let fronts: Vec<Front> = body.fronts(template.positions(), 0.2);
    let value = |term: Term, places: &[Place], sums: &mut Vec<Place>| {
        sums.clear();
        sums.resize(places.len(), Place::zeros());
        let mut gradient = Gradient { sums, weight: 1.0 };
        losses.value(term, places, &target, &fronts, &mut gradient)
    };
    for term in Term::ALL {
        let (mut sums, mut unused) = (Vec::new(), Vec::new());
        let at_rest = value(term, &predicted, &mut sums);
        assert!(at_rest.abs() > 1e-9, "{} is not tested", term.name());
        let largest = sums.iter().map(Place::amax).fold(0.0, f64::max);
        let step = 1e-6;
        for vertex in 0..predicted.len() {
            for axis in 0..3 {
                let mut moved = predicted.clone();
                moved[vertex][axis] += step;
                let after = value(term, &moved, &mut unused);
                moved[vertex][axis] -= 2.0 * step;
                let before = value(term, &moved, &mut unused);
                let expected = (after - before) / (2.0 * step);
                let error = (sums[vertex][axis] - expected).abs() / largest;
                assert!(error < 1e-5, "{} at {vertex}: {error}", term.name());
            }
        }
    }
}

#[test]
fn supervised_terms_vanish_at_the_target() {
    let template = sleeve();
    let losses = Losses::new(&template, &all_terms()).unwrap();
    let draped = shaken(template.positions(), 0.005, 3);
    let target = losses.target(&draped).unwrap();
    let body = LossBody::new(&icosphere(1, 0.01)).unwrap();
    let report = losses.evaluate(&draped, &target, &body).unwrap();
    for value in &report.values {
        if !matches!(value.term, Term::Strain | Term::Gravity | Term::Fold) {
            assert!(
                value.value < 1e-12,
                "{}: {}",
                value.term.name(),
                value.value
            );
        }
    }
    assert!(report.value(Term::Strain).unwrap() > 0.0);
    let own = losses.target(template.positions()).unwrap();
    let at_rest = losses.evaluate(template.positions(), &own, &body).unwrap();
    assert!(at_rest.value(Term::Strain).unwrap() < 1e-12);
}

#[test]
fn the_vertex_term_is_in_squared_units() {
    let template = sleeve();
    let losses = Losses::new(&template, &LossConfig::paper()).unwrap();
    let target = losses.target(template.positions()).unwrap();
    let body = LossBody::new(&icosphere(1, 0.001)).unwrap();
    let up = Vector3::new(0.0, 0.1, 0.0);
    let moved: Vec<Point3> = template
        .positions()
        .iter()
        .map(|place| place + up)
        .collect();
    let report = losses.evaluate(&moved, &target, &body).unwrap();
    approx::assert_relative_eq!(report.value(Term::Vertex).unwrap(), 1.0, epsilon = 1e-5);
    assert!(report.value(Term::Normal).unwrap() < 1e-9);
    assert!(report.value(Term::Bending).unwrap() < 1e-5);
}

#[test]
fn cloth_behind_a_plane_penetrates_by_its_depth() {
    let template = grid(4, 4, [0.1, 0.1]);
    let losses = Losses::new(&template, &LossConfig::paper()).unwrap();
    let target = losses.target(template.positions()).unwrap();
    let lower = |depth: f32| {
        let down = Vector3::new(0.0, 0.0, -depth);
        let moved: Vec<Point3> = template
            .positions()
            .iter()
            .map(|place| place + down)
            .collect();
        let report = losses.evaluate(&moved, &target, &LossBody::new(&template).unwrap());
        report.unwrap().value(Term::Penetration).unwrap()
    };
    // The normal of the grid is +z or -z; either way one side counts and the other does not.
    let body = LossBody::new(&template).unwrap();
    let side = body.normals[0].z;
    let offset = f64::from(body.mean_edge_length * 0.2 / UNIT);
    approx::assert_relative_eq!(lower(0.01 * side), 0.1 + offset, epsilon = 1e-4);
    approx::assert_relative_eq!(lower(-0.02 * side), 0.0, epsilon = 1e-6);
    // Beyond the tolerance it does not count either.
    approx::assert_relative_eq!(lower(0.06 * side), 0.0, epsilon = 1e-6);
}

#[test]
fn mean_curvature_agrees_with_that_of_the_mesh_crate() {
    let ball = icosphere(3, 0.2);
    let topology = Topology::new(ball.num_vertices(), ball.faces());
    let ours = TargetCurvature::new(&in_units(ball.positions()), &topology, 1e3);
    let theirs = mean_curvature_normals(ball.positions(), &topology);
    for (ours, theirs) in ours.normals().iter().zip(theirs) {
        // Eq. 9 is -4 H n; H is 1 / radius, in 1/unit.
        approx::assert_relative_eq!(ours.norm(), 4.0 * 0.1 / 0.2, max_relative = 0.02);
        let expected = theirs.cast::<f64>() * -4.0 * f64::from(UNIT);
        approx::assert_relative_eq!(*ours, expected, epsilon = 1e-4);
    }
    let plane = grid(6, 5, [0.3, 0.2]);
    let topology = Topology::new(plane.num_vertices(), plane.faces());
    let flat = TargetCurvature::new(&in_units(plane.positions()), &topology, 1e3);
    assert!(flat.normals().iter().all(|normal| normal.norm() < 1e-4));
}

#[test]
fn quotients_of_a_plane_are_ordered_and_those_of_a_line_are_one_number() {
    let plane = grid(7, 7, [0.4, 0.4]);
    let losses = Losses::new(&plane, &LossConfig::paper()).unwrap();
    let quotients = rayleigh_quotients(&in_units(plane.positions()), &losses.neighborhoods[1]);
    assert!(
        quotients
            .iter()
            .all(|[low, high]| *low > 0.0 && high >= low)
    );
    // On a line all directions are one, and the quotient is the variance along it.
    let line: Vec<Place> = (0..3).map(|x| Place::new(f64::from(x), 0.0, 0.0)).collect();
    let hoods = Neighborhoods {
        indices: vec![0, 1, 2],
        size: 3,
    };
    let [[low, high]] = rayleigh_quotients(&line, &hoods)[..] else {
        panic!("one neighborhood has one pair of quotients");
    };
    approx::assert_relative_eq!(low, 2.0 / 3.0, epsilon = 1e-12);
    approx::assert_relative_eq!(high, 2.0 / 3.0, epsilon = 1e-12);
}

#[test]
fn degenerate_meshes_have_finite_terms_and_derivatives() {
    let mut positions = sleeve().positions().to_vec();
    positions[3] = positions[4];
    positions[20] = positions[21];
    positions[11] = positions[12] + (positions[13] - positions[12]) * 0.5;
    let template = TriMesh::new(positions, sleeve().faces().to_vec()).unwrap();
    let losses = Losses::new(&template, &all_terms()).unwrap();
    let collapsed = vec![Point3::new(0.01, 0.02, 0.03); template.num_vertices()];
    let body = LossBody::new(&template).unwrap();
    for draped in [template.positions(), &collapsed] {
        for predicted in [template.positions(), &collapsed] {
            let target = losses.target(draped).unwrap();
            let report = losses.measure(predicted, &target, &body).unwrap();
            assert_eq!(report.non_finite_term(), None);
            assert_eq!(report.non_finite_vertex(), None);
        }
    }
}

#[test]
fn wrong_input_is_refused() {
    let template = sleeve();
    let bad = LossConfig {
        normal: f64::NAN,
        ..LossConfig::paper()
    };
    assert!(matches!(
        Losses::new(&template, &bad),
        Err(NetError::Loss {
            field: "normal",
            ..
        })
    ));
    let bad = LossConfig {
        rayleigh: [0.0, -1.0, 0.0],
        ..LossConfig::paper()
    };
    let told = bad.check().unwrap_err().to_string();
    assert!(told.starts_with("`rayleigh` of the loss is `-1`"), "{told}");
    let losses = Losses::new(&template, &LossConfig::paper()).unwrap();
    assert!(losses.target(&template.positions()[1..]).is_err());
    let mut stray = template.positions().to_vec();
    stray[5].y = f32::NAN;
    assert!(matches!(
        losses.target(&stray),
        Err(NetError::NotFinite { index: 5, .. })
    ));
}
