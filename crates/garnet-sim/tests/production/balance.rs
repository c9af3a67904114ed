//! The reference quality: the way of the production solver, and balance in the end.

use std::ops::ControlFlow;

use garnet_mesh::primitives::icosphere;
use garnet_sim::{
    Energy, Event, Fabric, Quality, STANDARD_GRAVITY, Scene, Schedule, SimError, Speeds,
};

use crate::body::{collider_of, lying_sheet, scene};
use crate::stage::{cloth_of, run};

#[test]
fn a_sheet_on_a_ball_is_brought_into_balance_near_where_the_production_solver_leaves_it() {
    let sheet = lying_sheet(20, 0.4, 0.155);
    let cloth = cloth_of(&sheet, &Fabric::cotton());
    let ball = icosphere(3, 0.15);
    let collider = collider_of(&ball);
    let motion = |_: f32| ball.positions().to_vec();
    let scene = scene(&cloth, sheet.positions(), &collider, &motion);
    let of = |quality: Quality| Schedule {
        motion_frames: 0,
        ..Schedule::for_quality(quality, cloth.mean_edge_length())
    };
    let produced = run(&scene, &of(Quality::Teacher)).unwrap();
    assert_eq!(produced.report.balance, None);
    let balanced = run(&scene, &of(Quality::Reference)).unwrap();
    let balance = balanced.report.balance.unwrap();
    assert!(balance.settled.is_settled, "{balance:?}");
    assert!(balance.settled.residual < 0.01, "{balance:?}");
    // It is the way of the teacher that ends there.
    let moves = produced.positions.iter().zip(&balanced.positions);
    let moves: Vec<f32> = moves.map(|(from, to)| (to - from).norm()).collect();
    let mean = moves.iter().sum::<f32>() / moves.len() as f32;
    assert!((f64::from(mean) - balance.moved).abs() < 1e-4, "{mean}");
    assert!(mean < 2e-3, "{mean}");
    let energy = |positions: &[_]| Energy::of(&cloth, positions, STANDARD_GRAVITY).total();
    assert!(energy(&balanced.positions) < energy(&produced.positions));
    assert_eq!(balanced.report.penetration.num_inside, 0);
    assert_eq!(balanced.report.speeds, Speeds::STILL);
}

#[test]
fn an_observer_hears_of_the_balance_and_can_break_it_off() {
    let sheet = lying_sheet(8, 0.3, 0.0);
    let cloth = cloth_of(&sheet, &Fabric::cotton());
    let pinned = cloth.with_pins(&[0, 8]).unwrap();
    let scene = Scene {
        cloth: &pinned,
        start: sheet.positions(),
        body: None,
    };
    let schedule = Schedule {
        motion_frames: 0,
        stages: Vec::new(),
        ..Schedule::for_quality(Quality::Reference, pinned.mean_edge_length())
    };
    let mut residuals = Vec::new();
    let mut watch = |event: Event<'_>| {
        if let Event::Balance { residual, .. } = event {
            residuals.push(residual);
        }
        ControlFlow::Continue(())
    };
    let hung = garnet_sim::drape(&scene, &schedule, &mut watch).unwrap();
    let balance = hung.report.balance.unwrap();
    assert!(balance.settled.is_settled, "{balance:?}");
    assert_eq!(residuals.len(), balance.settled.steps);
    assert!(balance.moved > 0.05, "it hangs down: {balance:?}");

    let mut stop = |event: Event<'_>| match event {
        Event::Balance { num_done: 2, .. } => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    };
    let stopped = garnet_sim::drape(&scene, &schedule, &mut stop);
    assert!(
        matches!(stopped, Err(SimError::Stopped { .. })),
        "{stopped:?}"
    );
}
