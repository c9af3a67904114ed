//! Frames of a motion that go on from each other.

use std::{error::Error, sync::atomic::AtomicBool};

use garnet::{
    Body, Draper, Garment, Point3, Pose, PosedBody, TriMesh,
    drape::{KeyFrame, KeySpacing, Smoothing, StepLimit, Take, TakeFrame},
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

fn all_bodies(
    body: &Body,
    poses: impl Iterator<Item = Pose>,
) -> Result<Vec<PosedBody>, Box<dyn Error>> {
    let bodies = poses.map(|pose| body.posed(&pose));
    Ok(bodies.collect::<Result<_, _>>()?)
}

fn keys(draper: &Draper, bodies: &[PosedBody], spacing: KeySpacing) -> Vec<usize> {
    let transforms: Vec<_> = bodies
        .iter()
        .map(|one| one.posed_from_rest().to_vec())
        .collect();
    spacing.keys(draper.garment(), &transforms)
}

#[test]
fn keys_are_where_the_body_has_moved_and_not_where_it_was_carried() -> Result<(), Box<dyn Error>> {
    let body = figure();
    let draper = draper(shirt(), &body)?;
    let carried = (0..30).map(|frame| {
        let mut pose = lowered(0.9);
        pose.root_translation.x = 0.1 * frame as f32;
        pose
    });
    let carried = all_bodies(&body, carried)?;
    assert_eq!(
        keys(&draper, &carried, KeySpacing::default()),
        [0, 12, 24, 29]
    );
    assert_eq!(keys(&draper, &carried[..1], KeySpacing::default()), [0]);
    assert!(keys(&draper, &[], KeySpacing::default()).is_empty());
    let moving = all_bodies(&body, arms_down())?;
    let every: Vec<usize> = (0..moving.len()).collect();
    assert_eq!(keys(&draper, &moving, KeySpacing::NONE), every);
    let [few, some] = [0.1, 0.01].map(|apart| KeySpacing::default().with_apart(apart));
    let [few, some] = [few, some].map(|spacing| keys(&draper, &moving, spacing).len());
    println!("{few} and {some} keys of {} frames", moving.len());
    assert!(few < some && some < moving.len());
    Ok(())
}

#[test]
fn between_two_keys_cloth_lies_on_the_way_from_one_to_the_other() -> Result<(), Box<dyn Error>> {
    let body = figure();
    let garment = Garment::new(shirt()).bind(&body)?;
    let options = garnet::DrapeOptions::default().without_untangling();
    let draper = Draper::new(garment).with_options(options);
    let posed = body.posed(&lowered(0.9))?;
    let drape = draper.drape(&posed)?;
    let mut thicker = drape.clone();
    for place in &mut thicker.positions {
        place.z *= 1.01;
    }
    let key = |drape| KeyFrame::new(&draper, &posed, drape);
    let (key, next) = (key(drape.clone())?, key(thicker)?);
    let stop = AtomicBool::new(false);
    for share in [0.0, 0.25, 1.0] {
        let mut take = Take::new(&draper);
        let frame = take.go_between(&posed, [&key, &next], share, &stop)?;
        assert!(frame.is_between);
        for (place, from) in frame.drape.positions.iter().zip(&drape.positions) {
            let expected = Point3::new(from.x, from.y, from.z * (1.0 + 0.01 * share));
            assert!(
                (place - expected).norm() < 1e-6,
                "{share}: {place} {expected}"
            );
        }
    }
    Ok(())
}

#[test]
fn frames_between_keys_are_free_and_near_those_draped_alone() -> Result<(), Box<dyn Error>> {
    let body = figure();
    // Alone, this cloth jumps by 87 mm where an arm comes down on it; where arms swing through it,
    // it may be on either side.
    for (poses, most, most_mean) in [
        (arms_down().collect::<Vec<_>>(), 0.05, 0.002),
        (arms_through_skirt().collect(), 0.1, 0.003),
    ] {
        let draper = draper(shirt(), &body)?;
        let bodies = all_bodies(&body, poses.into_iter())?;
        let numbers = keys(&draper, &bodies, KeySpacing::default());
        assert!(numbers.len() < bodies.len());
        let stop = AtomicBool::new(false);
        let (mut take, mut whole) = (Take::new(&draper), Take::new(&draper));
        let key = |number: usize| {
            let drape = draper.drape(&bodies[number])?;
            KeyFrame::new(&draper, &bodies[number], drape)
        };
        let mut last = key(0)?;
        take.go_on(&bodies[0], last.drape().clone())?;
        whole.drape(&bodies[0], &stop)?;
        let (mut farthest, mut sum, mut count) = (0.0_f32, 0.0, 0);
        for pair in numbers.windows(2) {
            let next = key(pair[1])?;
            let between = &bodies[pair[0] + 1..pair[1]];
            for (at, posed) in (1..).zip(between) {
                let share = at as f32 / (pair[1] - pair[0]) as f32;
                let frame = take.go_between(posed, [&last, &next], share, &stop)?;
                let report = frame.drape.report.ok_or("untangling was asked for")?;
                assert_eq!(report.inside, 0, "{pair:?} {at}");
                let own = whole.drape(posed, &stop)?.drape.positions;
                for (a, b) in frame.drape.positions.iter().zip(&own) {
                    farthest = farthest.max((a - b).norm());
                    sum += (a - b).norm();
                    count += 1;
                }
            }
            take.go_on(&bodies[pair[1]], next.drape().clone())?;
            whole.drape(&bodies[pair[1]], &stop)?;
            last = next;
        }
        let mean = sum / count as f32;
        println!(
            "{} keys, {farthest} apart, {mean} in the mean",
            numbers.len()
        );
        assert!(farthest < most && mean < most_mean, "{farthest} {mean}");
    }
    Ok(())
}
