//! Scenes that cannot be simulated end with an error that names the place, and soon.

use std::ops::ControlFlow;

use garnet_mesh::primitives::{grid, icosphere};
use garnet_sim::{
    Cloth, Collider, Fabric, MovingBody, Point3, Quality, RestShape, STANDARD_GRAVITY, Scene,
    Schedule, SimError, drape,
};

use crate::stage::{cloth_of, run, undamped};

fn sheet() -> (Cloth, Vec<Point3>) {
    let sheet = grid(8, 8, [0.2, 0.2]);
    (
        cloth_of(&sheet, &Fabric::silk()),
        sheet.positions().to_vec(),
    )
}

fn on_ball(motion: &garnet_sim::Motion<'_>) -> Result<garnet_sim::Drape, SimError> {
    let (cloth, start) = sheet();
    let ball = icosphere(2, 0.1);
    let collider = Collider::new(ball.faces(), ball.num_vertices())?;
    let scene = Scene {
        cloth: &cloth,
        start: &start,
        body: Some(MovingBody {
            collider: &collider,
            motion,
            wind: None,
            allowed_parts: None,
            likely_faces: None,
        }),
    };
    run(&scene, &Schedule::for_quality(Quality::Fast, 0.025))
}

#[test]
fn a_start_that_does_not_fit_is_refused() {
    let (cloth, mut start) = sheet();
    start[7].y = f32::NAN;
    let scene = Scene {
        cloth: &cloth,
        start: &start,
        body: None,
    };
    let error = run(&scene, &undamped(1, 600.0)).unwrap_err();
    assert!(error.to_string().contains("vertex 7"), "{error}");
    let scene = Scene {
        start: &start[1..],
        ..scene
    };
    let error = run(&scene, &undamped(1, 600.0)).unwrap_err();
    assert!(matches!(
        error,
        SimError::Count {
            found: 80,
            expected: 81,
            ..
        }
    ));
}

#[test]
fn a_body_that_is_nowhere_or_jumps_is_refused() {
    let ball = icosphere(2, 0.1);
    let lost = |time: f32| {
        let mut positions = ball.positions().to_vec();
        positions[3].x = if time > 0.5 { f32::INFINITY } else { 0.0 };
        positions
    };
    let error = on_ball(&lost).unwrap_err();
    assert!(
        matches!(error, SimError::MotionTooFast { vertex: 3, .. }),
        "{error}"
    );
    let jumps = |time: f32| {
        let shift = if time > 0.5 { 1.0 } else { 0.0 };
        ball.positions()
            .iter()
            .map(|p| Point3::new(p.x + shift, p.y, p.z))
            .collect()
    };
    assert!(matches!(
        on_ball(&jumps),
        Err(SimError::MotionTooFast { .. })
    ));
    let other = |time: f32| ball.positions()[usize::from(time > 0.5)..].to_vec();
    assert!(matches!(on_ball(&other), Err(SimError::Count { .. })));
    let nothing = |_: f32| vec![Point3::new(f32::NAN, 0.0, 0.0); ball.num_vertices()];
    assert!(matches!(on_ball(&nothing), Err(SimError::Collider(_))));
}

#[test]
fn an_observer_can_break_off() {
    let (cloth, start) = sheet();
    let scene = Scene {
        cloth: &cloth,
        start: &start,
        body: None,
    };
    let mut frames = 0;
    let stopped = drape(&scene, &undamped(100, 600.0), &mut |_| {
        frames += 1;
        if frames == 3 {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    });
    assert!(matches!(stopped, Err(SimError::Stopped { .. })));
    assert_eq!(frames, 3);
}

#[test]
fn faces_that_the_body_lacks_and_lists_of_another_length_are_refused() {
    let ball = icosphere(2, 0.1);
    let collider = Collider::new(ball.faces(), ball.num_vertices()).unwrap();
    let (cloth, start) = sheet();
    let missing = ball.num_faces() as u32;
    for faces in [vec![missing; start.len()], vec![0; start.len() - 1]] {
        let scene = Scene {
            cloth: &cloth,
            start: &start,
            body: Some(MovingBody {
                collider: &collider,
                motion: &|_| ball.positions().to_vec(),
                wind: None,
                allowed_parts: None,
                likely_faces: Some(&faces),
            }),
        };
        let error = run(&scene, &Schedule::for_quality(Quality::Fast, 0.025));
        assert!(matches!(error, Err(SimError::Count { .. })));
    }
}

#[test]
fn a_garment_far_inside_the_body_ends_and_is_reported() {
    let ball = icosphere(3, 0.5);
    let collider = Collider::new(ball.faces(), ball.num_vertices()).unwrap();
    let (cloth, start) = sheet();
    let scene = Scene {
        cloth: &cloth,
        start: &start,
        body: Some(MovingBody {
            collider: &collider,
            motion: &|_| ball.positions().to_vec(),
            wind: None,
            allowed_parts: None,
            likely_faces: None,
        }),
    };
    let schedule = Schedule {
        gravity: 0.0,
        ..Schedule::for_quality(Quality::Fast, 0.025)
    };
    let report = run(&scene, &schedule).unwrap().report;
    assert_eq!(report.penetration.num_inside, cloth.num_vertices());
}

#[test]
fn a_garment_crumpled_to_a_point_ends_finite_or_with_an_error() {
    let (cloth, start) = sheet();
    let schedule = Schedule {
        gravity: STANDARD_GRAVITY,
        ..Schedule::for_quality(Quality::Fast, 0.025)
    };
    for scale in [0.0, 1e-3, 50.0] {
        let crumpled: Vec<Point3> = start.iter().map(|p| p * scale).collect();
        let scene = Scene {
            cloth: &cloth,
            start: &crumpled,
            body: None,
        };
        if let Ok(draped) = run(&scene, &schedule) {
            assert!(draped.positions.iter().all(|p| p.coords.norm() < 100.0));
        }
    }
}

#[test]
fn a_pattern_much_smaller_than_the_start_is_torn_or_contracts() {
    let sheet = grid(8, 8, [0.2, 0.2]);
    let small: Vec<Point3> = sheet.positions().iter().map(|p| p * 0.01).collect();
    let rest = RestShape::Worn(small);
    let cloth = Cloth::new(sheet.faces(), sheet.num_vertices(), &rest, &Fabric::silk()).unwrap();
    let scene = Scene {
        cloth: &cloth,
        start: sheet.positions(),
        body: None,
    };
    match run(&scene, &undamped(5, 600.0)) {
        Ok(draped) => assert!(draped.report.strain.max < 9.0, "{:?}", draped.report),
        Err(error) => assert!(matches!(
            error,
            SimError::Torn { .. } | SimError::Exploded { .. }
        )),
    }
}
