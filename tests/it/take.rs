//! Frames of a motion that go on from each other.

use std::{error::Error, sync::atomic::AtomicBool};

use garnet::{
    Body, Draper, Garment, Point3, Pose, PosedBody, TriMesh,
    drape::{Smoothing, StepLimit, Take, TakeFrame},
};
use garnet_tests::capsules::{figure, lowered, shirt, skirt, step};

/// Arms that come down on the shirt and press into the trunk, by a degree and a half a frame.
fn arms_down() -> impl Iterator<Item = Pose> {
    (0..60).map(|frame| lowered(0.2 + 0.025 * frame as f32))
}

/// Arms that swing slowly through the hem of the skirt, there and back.
fn arms_through_skirt() -> impl Iterator<Item = Pose> {
    (0..80).map(|frame| {
        let share = 0.5 - 0.5 * (std::f32::consts::TAU * frame as f32 / 80.0).cos();
        lowered(1.0 + 0.6 * share)
    })
}

fn draper(garment: TriMesh, body: &Body) -> Result<Draper, Box<dyn Error>> {
    Ok(Draper::new(Garment::new(garment).bind(body)?))
}

/// The farthest that a vertex steps, in metres, and how far beyond four times the step of the skin
/// that is next to it in one of the two frames: an arm may push it off the trunk.
fn steps(cloth: [&[Point3]; 2], body: [&PosedBody; 2]) -> (f32, f32) {
    let at = |side: usize, corner: u32| body[side].skin().positions()[corner as usize];
    let of_skin = |side: usize, place: &Point3| {
        let skin = body[side].skin();
        let corners = skin.faces()[skin.closest(*place).face as usize];
        let steps = corners.map(|corner| (at(1, corner) - at(0, corner)).norm());
        steps.into_iter().fold(0.0, f32::max)
    };
    let beyond = |(from, to): (&Point3, &Point3)| {
        let step = (to - from).norm();
        (step, step - 4.0 * of_skin(0, from).max(of_skin(1, to)))
    };
    let pairs = cloth[0].iter().zip(cloth[1]).map(beyond);
    pairs.fold((0.0, f32::NEG_INFINITY), |(most, far), (step, beyond)| {
        (most.max(step), far.max(beyond))
    })
}

/// What a take of a garment reaches with a limit: the largest steps of all frames.
fn judged(
    garment: TriMesh,
    poses: impl Iterator<Item = Pose>,
    limit: StepLimit,
) -> Result<(f32, f32), Box<dyn Error>> {
    let body = figure();
    let draper = draper(garment, &body)?;
    let mut take = Take::new(&draper).with_limit(limit);
    let stop = AtomicBool::new(false);
    let mut largest = (0.0_f32, 0.0_f32);
    let mut last: Option<(Vec<Point3>, PosedBody)> = None;
    for pose in poses {
        let posed = body.posed(&pose)?;
        let frame = take.drape(&posed, &stop)?;
        let report = frame
            .drape
            .report
            .as_ref()
            .ok_or("untangling was asked for")?;
        assert_eq!(report.inside, 0);
        let positions = frame.drape.positions;
        if let Some((before, skin)) = &last {
            let (step, beyond) = steps([before, &positions], [skin, &posed]);
            assert!((step - frame.step).abs() < 1e-6, "{step} {}", frame.step);
            largest = (largest.0.max(step), largest.1.max(beyond));
        }
        last = Some((positions, posed));
    }
    Ok(largest)
}

#[test]
fn cloth_steps_no_farther_than_the_skin_next_to_it_lets_it() -> Result<(), Box<dyn Error>> {
    for (name, garment, poses) in [
        (
            "arms on the shirt",
            shirt(),
            arms_down().collect::<Vec<_>>(),
        ),
        ("arms in the skirt", skirt(), arms_through_skirt().collect()),
    ] {
        let alone = judged(garment.clone(), poses.clone().into_iter(), StepLimit::NONE)?;
        let take = judged(garment, poses.into_iter(), StepLimit::default())?;
        println!("{name}: alone {alone:?}, in a take {take:?}");
        assert!(take.1 <= alone.1, "{name}: {take:?} {alone:?}");
        assert!(name != "arms on the shirt" || take.1 < 0.008, "{take:?}");
    }
    Ok(())
}

#[test]
fn a_body_that_keeps_still_gives_the_drape_alone_to_the_bit() -> Result<(), Box<dyn Error>> {
    let body = figure();
    let draper = draper(shirt(), &body)?;
    let posed = body.posed(&lowered(0.9))?;
    let alone = draper.drape(&posed)?;
    let mut take = Take::new(&draper);
    for _ in 0..3 {
        let frame = take.drape(&posed, &AtomicBool::new(false))?;
        assert_eq!(frame.drape.positions, alone.positions);
        assert_eq!(
            (frame.held_back, frame.step, frame.body_step),
            (0, 0.0, 0.0)
        );
    }
    Ok(())
}

#[test]
fn cloth_held_back_arrives_once_the_body_keeps_still() -> Result<(), Box<dyn Error>> {
    let body = figure();
    let draper = draper(skirt(), &body)?;
    let stop = AtomicBool::new(false);
    let mut take = Take::new(&draper).with_limit(StepLimit::default().with_still(0.001));
    take.drape(&body.posed(&step(0.1))?, &stop)?;
    let posed = body.posed(&step(0.5))?;
    let first = take.drape(&posed, &stop)?;
    assert!(first.held_back > 0);
    let mut frame = first;
    for _ in 0..400 {
        frame = take.drape(&posed, &stop)?;
    }
    assert_eq!(frame.held_back, 0);
    assert_eq!(frame.drape.positions, draper.drape(&posed)?.positions);
    Ok(())
}

/// The frames of a take with a limit, smoothed over `radius` frames to either side, with their
/// bodies.
fn smoothed(
    draper: &Draper,
    bodies: impl Iterator<Item = PosedBody>,
    limit: StepLimit,
    radius: usize,
) -> Result<Vec<(PosedBody, TakeFrame)>, Box<dyn Error>> {
    let mut take = Take::new(draper).with_limit(limit);
    let mut smoothing = Smoothing::new(draper, radius);
    let stop = AtomicBool::new(false);
    let mut frames = Vec::new();
    for posed in bodies {
        let frame = take.drape(&posed, &stop)?;
        frames.extend(smoothing.push(posed, frame)?);
    }
    while let Some(left) = smoothing.next_left()? {
        frames.push(left);
    }
    Ok(frames)
}

fn largest_step(frames: &[(PosedBody, TakeFrame)]) -> f32 {
    let steps = frames.iter().map(|(_, frame)| frame.step);
    steps.fold(0.0, f32::max)
}

#[test]
fn smoothing_leaves_a_motion_that_keeps_still_to_the_bit() -> Result<(), Box<dyn Error>> {
    let body = figure();
    let draper = draper(shirt(), &body)?;
    let posed = body.posed(&lowered(0.9))?;
    let alone = draper.drape(&posed)?;
    for count in [1, 2, 9] {
        let bodies = (0..count).map(|_| posed.clone());
        let frames = smoothed(&draper, bodies, StepLimit::default(), 3)?;
        assert_eq!(frames.len(), count);
        for (_, frame) in &frames {
            assert_eq!(frame.drape.positions, alone.positions);
            assert_eq!(frame.drape.report, alone.report);
        }
    }
    Ok(())
}

#[test]
fn a_jump_is_spread_over_the_window_by_binomial_weights() -> Result<(), Box<dyn Error>> {
    let body = figure();
    let draper = draper(shirt(), &body)?;
    let posed = body.posed(&lowered(0.9))?;
    let mut smoothing = Smoothing::new(&draper, 2);
    let mut take = Take::new(&draper);
    let mut frames = Vec::new();
    // Thicker: away from the skin everywhere.
    let out = 0.2;
    for number in 0..10 {
        let mut frame = take.drape(&posed, &AtomicBool::new(false))?;
        if number >= 5 {
            for place in &mut frame.drape.positions {
                place.z += out * place.z;
            }
        }
        frames.extend(smoothing.push(posed.clone(), frame)?);
    }
    while let Some(left) = smoothing.next_left()? {
        frames.push(left);
    }
    let alone = draper.drape(&posed)?.positions;
    // Sums of 1, 4, 6, 4 and 1 sixteenths.
    let shares = [0.0, 0.0, 0.0, 1.0, 5.0, 11.0, 15.0, 16.0, 16.0, 16.0];
    for (number, ((_, frame), share)) in frames.iter().zip(shares).enumerate() {
        for (place, alone) in frame.drape.positions.iter().zip(&alone) {
            let expected = alone.z * (1.0 + out * share / 16.0);
            let apart = (place - Point3::new(alone.x, alone.y, expected)).norm();
            assert!(apart < 1e-3, "{number}: {apart}");
        }
    }
    let thickest = alone.iter().map(|place| place.z.abs()).fold(0.0, f32::max);
    let step = largest_step(&frames);
    assert!((step - out * thickest * 6.0 / 16.0).abs() < 1e-3, "{step}");
    Ok(())
}

#[test]
fn smoothing_shortens_steps_and_keeps_cloth_out_of_the_skin() -> Result<(), Box<dyn Error>> {
    let body = figure();
    let draper = draper(shirt(), &body)?;
    let bodies = || arms_down().map(|pose| body.posed(&pose));
    let bodies = || bodies().collect::<Result<Vec<_>, _>>();
    let rough = smoothed(&draper, bodies()?.into_iter(), StepLimit::default(), 0)?;
    let mut last = largest_step(&rough);
    for radius in [1, 3] {
        let frames = smoothed(&draper, bodies()?.into_iter(), StepLimit::default(), radius)?;
        let step = largest_step(&frames);
        println!("over {radius} frames: {step}, before {last}");
        assert!(step < last, "{radius}: {step} {last}");
        last = step;
        for ((skin, frame), (own, before)) in frames.iter().zip(&rough) {
            assert_eq!(skin.skin().positions(), own.skin().positions());
            let of = |frame: &TakeFrame| frame.drape.report.clone().ok_or("it was untangled");
            let (report, before) = (of(frame)?, of(before)?);
            assert_eq!(report.inside, 0);
            assert_eq!(report.below_clearance, report.squeezed);
            assert!(report.crossing_faces <= before.crossing_faces.max(2));
            let nodes = frame.drape.positions.iter().zip(&frame.drape.is_trapped);
            for (place, _) in nodes.filter(|(_, is_trapped)| !**is_trapped) {
                assert!(!skin.skin().contains(*place));
            }
        }
    }
    Ok(())
}

#[test]
fn smooth_cloth_does_not_lag_behind_the_body() -> Result<(), Box<dyn Error>> {
    let body = figure();
    let draper = draper(shirt(), &body)?;
    // A step aside by 20 cm from one frame to the next, and back.
    let bodies = (0..12).map(|frame| {
        let mut pose = lowered(0.9);
        pose.root_translation.x = if (4..8).contains(&frame) { 0.2 } else { 0.0 };
        body.posed(&pose)
    });
    let bodies: Vec<PosedBody> = bodies.collect::<Result<_, _>>()?;
    let rough = smoothed(&draper, bodies.iter().cloned(), StepLimit::default(), 0)?;
    let smooth = smoothed(&draper, bodies.into_iter(), StepLimit::default(), 4)?;
    for ((_, smooth), (_, rough)) in smooth.iter().zip(&rough) {
        let pairs = smooth.drape.positions.iter().zip(&rough.drape.positions);
        let farthest = pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f32::max);
        assert!(farthest < 1e-3, "{farthest}");
    }
    Ok(())
}
