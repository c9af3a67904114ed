//! Frames of a motion that go on from each other.

use std::{error::Error, sync::atomic::AtomicBool};

use garnet::{
    Body, Draper, Garment, Point3, Pose, PosedBody, TriMesh,
    drape::{StepLimit, Take},
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
