//! Cloth on bodies that stand and move.

use std::ops::ControlFlow;

use garnet_mesh::TriMesh;
use garnet_mesh::primitives::{capsule, cuboid, grid, icosphere, tube};
use garnet_sim::{
    Cloth, Collider, Fabric, MovingBody, Point3, Quality, STANDARD_GRAVITY, Scene, Schedule,
    SelfContact, Vector3, Wind,
};

use crate::stage::{cloth_of, run, undamped};

/// A sheet in the plane y = `height`.
pub(crate) fn lying_sheet(cells: usize, size: f32, height: f32) -> TriMesh {
    let sheet = grid(cells, cells, [size, size]);
    let lying = |p: &Point3| Point3::new(p.x, height, -p.y);
    let positions = sheet.positions().iter().map(lying).collect();
    sheet
        .with_positions(positions)
        .expect("as many positions as before")
}

pub(crate) fn collider_of(mesh: &TriMesh) -> Collider {
    Collider::new(mesh.faces(), mesh.num_vertices()).expect("faces of a mesh")
}

pub(crate) fn scene<'a>(
    cloth: &'a Cloth,
    start: &'a [Point3],
    collider: &'a Collider,
    motion: &'a garnet_sim::Motion<'a>,
) -> Scene<'a> {
    Scene {
        cloth,
        start,
        body: Some(MovingBody {
            collider,
            motion,
            wind: None,
            allowed_parts: None,
            likely_faces: None,
        }),
    }
}

#[test]
fn a_sheet_lies_on_a_ball_and_the_same_bits_come_out_again() {
    let sheet = lying_sheet(24, 0.5, 0.155);
    let cloth = cloth_of(&sheet, &Fabric::cotton());
    let ball = icosphere(4, 0.15);
    let collider = collider_of(&ball);
    let motion = |_: f32| ball.positions().to_vec();
    let scene = scene(&cloth, sheet.positions(), &collider, &motion);
    let schedule = Schedule {
        motion_frames: 0,
        ..Schedule::for_quality(Quality::Fast, cloth.mean_edge_length())
    };
    let draped = run(&scene, &schedule).unwrap();
    assert_eq!(draped.report.penetration.num_inside, 0);
    assert_eq!(draped.report.num_freed, 0);
    let thickness = cloth.fabric().thickness;
    let nearest = draped
        .positions
        .iter()
        .map(|p| p.coords.norm())
        .fold(1.0, f32::min);
    assert!(nearest > 0.15 + 0.5 * thickness, "{nearest}");
    let lowest = draped.positions.iter().map(|p| p.y).fold(1.0, f32::min);
    assert!(lowest < 0.0, "it hangs down at the sides: {lowest}");
    assert_eq!(run(&scene, &schedule).unwrap(), draped);
}

#[test]
fn cloth_that_is_told_its_skin_lies_as_cloth_that_looks_for_it() {
    let sheet = lying_sheet(24, 0.5, 0.155);
    let cloth = cloth_of(&sheet, &Fabric::cotton());
    let ball = icosphere(4, 0.15);
    let collider = collider_of(&ball);
    let motion = |_: f32| ball.positions().to_vec();
    let looking = scene(&cloth, sheet.positions(), &collider, &motion);
    let schedule = Schedule {
        motion_frames: 0,
        ..Schedule::for_quality(Quality::Fast, cloth.mean_edge_length())
    };
    let looked = run(&looking, &schedule).unwrap();
    let told = |faces: &[u32]| {
        let body = looking.body.map(|body| MovingBody {
            likely_faces: Some(faces),
            ..body
        });
        run(&Scene { body, ..looking }, &schedule).unwrap()
    };
    let skin = garnet_knn::Surface::new(&ball);
    let nearest = skin.closest_all(sheet.positions());
    let near = told(
        &nearest
            .iter()
            .map(|closest| closest.face)
            .collect::<Vec<_>>(),
    );
    let pairs = near.positions.iter().zip(&looked.positions);
    let apart: f32 = pairs.map(|(a, b)| (b - a).norm()).sum();
    let apart = apart / near.positions.len() as f32;
    assert!(apart < 1e-3, "{apart}");
    // Told wrong, on the far side of the ball, it still does not enter it.
    let far = told(&vec![0; cloth.num_vertices()]);
    assert_eq!(far.report.penetration.num_inside, 0);
}

#[test]
fn patches_lie_as_one_and_threads_do_not_show() {
    let sheet = lying_sheet(24, 0.5, 0.155);
    let cloth = cloth_of(&sheet, &Fabric::cotton());
    let ball = icosphere(4, 0.15);
    let collider = collider_of(&ball);
    let shift = Vector3::new(0.1, 0.05, 0.0);
    let motion = |time: f32| ball.positions().iter().map(|p| p + shift * time).collect();
    let scene = scene(&cloth, sheet.positions(), &collider, &motion);
    let draped = |patches: u32, threads: usize| {
        let schedule = Schedule {
            patches,
            ..Schedule::for_quality(Quality::Fast, cloth.mean_edge_length())
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build()
            .unwrap()
            .install(|| run(&scene, &schedule).unwrap())
    };
    let whole = draped(1, 1);
    for patches in [2, 3] {
        let alone = draped(patches, 1);
        assert_eq!(alone.report.penetration.num_inside, 0);
        assert!(alone.report.strain.p99 < whole.report.strain.p99 + 0.005);
        let (here, there) = (alone.report.energy.total(), whole.report.energy.total());
        assert!((here - there).abs() < 0.02 * there.abs(), "{here} {there}");
        for threads in [2, 3] {
            assert_eq!(draped(patches, threads), alone, "{threads} threads");
        }
    }
}

#[test]
fn cloth_sticks_to_a_gentle_slope_and_slides_down_a_steep_one() {
    let fabric = Fabric::cotton();
    // The angle of friction is atan 0.3 = 16.7°.
    let slide = |degrees: f32| {
        let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), degrees.to_radians());
        let board = cuboid([2.0, 0.1, 2.0]);
        let board = board.with_positions(board.positions().iter().map(|p| turn * p).collect());
        let board = board.unwrap();
        let sheet = lying_sheet(8, 0.1, 0.05 + fabric.thickness);
        let start: Vec<Point3> = sheet.positions().iter().map(|p| turn * p).collect();
        let cloth = cloth_of(&sheet, &fabric);
        let collider = collider_of(&board);
        let motion = |_: f32| board.positions().to_vec();
        let schedule = Schedule {
            gravity: STANDARD_GRAVITY,
            ..undamped(30, 1200.0)
        };
        let draped = run(&scene(&cloth, &start, &collider, &motion), &schedule).unwrap();
        (draped.positions[40] - start[40]).norm()
    };
    assert!(slide(12.0) < 0.005, "{}", slide(12.0));
    // ½ (g sin α − μ g cos α) t² = 0.17 m.
    let steep = slide(25.0);
    assert!((0.13..0.21).contains(&steep), "{steep}");
}

#[test]
fn a_moving_body_carries_its_cloth_along() {
    let sheet = lying_sheet(20, 0.5, 0.155);
    let cloth = cloth_of(&sheet, &Fabric::knit());
    let ball = icosphere(4, 0.15);
    let collider = collider_of(&ball);
    let shift = Vector3::new(0.2, 0.1, -0.1);
    let motion = |time: f32| ball.positions().iter().map(|p| p + shift * time).collect();
    let carried = |time: f32| sheet.positions().iter().map(|p| p + shift * time).collect();
    let mut scene = scene(&cloth, sheet.positions(), &collider, &motion);
    let looseness = vec![1.0; cloth.num_vertices()];
    scene.body.as_mut().unwrap().wind = Some(Wind {
        motion: &carried,
        looseness: &looseness,
    });
    // Nothing but friction and the air that goes along holds this sheet.
    let schedule = Schedule {
        motion_friction: 1.0,
        ..Schedule::for_quality(Quality::Fast, cloth.mean_edge_length())
    };
    let draped = run(&scene, &schedule).unwrap();
    assert_eq!(draped.report.penetration.num_inside, 0);
    let top = draped.positions[10 * 21 + 10];
    let on_the_top = (top - shift).coords - Vector3::new(0.0, 0.153, 0.0);
    assert!(on_the_top.norm() < 0.06, "{on_the_top}");
}

#[test]
fn a_tube_that_starts_too_wide_contracts_onto_the_limb() {
    let limb = capsule(0.05, 0.5, 24, 12);
    let sleeve = tube(0.054, 0.2, 32, 24);
    let wide: Vec<Point3> = sleeve
        .positions()
        .iter()
        .map(|p| Point3::new(1.5 * p.x, p.y, 1.5 * p.z))
        .collect();
    let cloth = cloth_of(&sleeve, &Fabric::jersey());
    let collider = collider_of(&limb);
    let motion = |_: f32| limb.positions().to_vec();
    let scene = scene(&cloth, &wide, &collider, &motion);
    let schedule = Schedule {
        motion_frames: 0,
        contraction_frames: 20,
        gravity: 0.0,
        ..Schedule::for_quality(Quality::Fast, cloth.mean_edge_length())
    };
    let mut widest = 0.0_f32;
    let mut observer = |event: garnet_sim::Event<'_>| {
        if let garnet_sim::Event::Frame { positions, .. } = event {
            let radius = |p: &Point3| p.x.hypot(p.z);
            widest = widest.max(positions.iter().map(radius).fold(0.0, f32::max));
        }
        ControlFlow::Continue(())
    };
    let draped = garnet_sim::drape(&scene, &schedule, &mut observer).unwrap();
    assert!(widest < 0.09, "it bursts to {widest} m");
    assert!(
        draped.report.strain.p99 < 0.03,
        "{:?}",
        draped.report.strain
    );
    assert_eq!(draped.report.penetration.num_inside, 0);
}

#[test]
fn cloth_between_limbs_that_run_through_each_other_is_neither_torn_nor_thrown() {
    // Two limbs with a sleeve on one; the other comes 15 mm into it.
    let limb = capsule(0.05, 0.6, 32, 20);
    let num = limb.num_vertices() as u32;
    let both = limb.faces().iter().copied();
    let faces: Vec<[u32; 3]> = both
        .clone()
        .chain(both.map(|f| f.map(|v| v + num)))
        .collect();
    let parts = [vec![0; limb.num_faces()], vec![1; limb.num_faces()]].concat();
    let collider = Collider::new(&faces, 2 * num as usize)
        .unwrap()
        .with_parts(parts)
        .unwrap();
    let motion = |time: f32| -> Vec<Point3> {
        let second = Vector3::new(0.20 - 0.115 * time, 0.0, 0.0);
        let own = limb.positions().iter().copied();
        own.clone().chain(own.map(|p| p + second)).collect()
    };
    let sleeve = tube(0.056, 0.25, 40, 28);
    let cloth = cloth_of(&sleeve, &Fabric::jersey());
    let scene = scene(&cloth, sleeve.positions(), &collider, &motion);
    let schedule = Schedule {
        gravity: 0.0,
        ..Schedule::for_quality(Quality::Teacher, cloth.mean_edge_length())
    };
    let report = run(&scene, &schedule).unwrap().report;
    assert_eq!(report.penetration.num_inside, 0, "{report:?}");
    assert!(
        report.penetration.num_trapped > 0,
        "the limbs do meet: {report:?}"
    );
    assert!(report.strain.max < 0.6, "{report:?}");
    assert!(report.speeds.share_moving < 0.1, "{report:?}");
}

#[test]
fn a_folded_sheet_does_not_fall_through_itself() {
    // One half lies over the other, 12 mm above it, and both on a table.
    let sheet = grid(16, 16, [0.3, 0.3]);
    let folded = |p: &Point3| {
        if p.x > 0.0 {
            Point3::new(0.15 - p.x, 0.056 + 0.012, -p.y)
        } else {
            Point3::new(p.x + 0.15, 0.056, -p.y)
        }
    };
    let start: Vec<Point3> = sheet.positions().iter().map(folded).collect();
    let cloth = cloth_of(&sheet, &Fabric::denim());
    let table = cuboid([1.0, 0.1, 1.0]);
    let collider = collider_of(&table);
    let motion = |_: f32| table.positions().to_vec();
    let scene = scene(&cloth, &start, &collider, &motion);
    let schedule = Schedule {
        gravity: STANDARD_GRAVITY,
        drag: 5.0,
        self_contact: SelfContact::Repulsion {
            distance: 0.75,
            least: 0.5,
        },
        stages: vec![garnet_sim::Stage {
            frames: 40,
            rate: 1200.0,
            extra_drag: 0.0,
            friction: 1.0,
        }],
        ..undamped(0, 1200.0)
    };
    let draped = run(&scene, &schedule).unwrap();
    // Away from the fold the upper half is still over the lower one.
    for row in 0..=16 {
        for column in 0..6 {
            let [lower, upper] = [column, 16 - column].map(|c| draped.positions[row * 17 + c]);
            assert!(
                upper.y > lower.y,
                "row {row} column {column}: {lower} {upper}"
            );
        }
    }
}
