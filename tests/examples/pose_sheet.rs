//! Pictures of the key poses, the gait cycle or drawn poses on a rigged body:
//! `cargo run --release -p garnet-tests --example pose_sheet -- BODY FOLDER [KIND]…`.
//!
//! BODY is a rig or `SEX,STATURE,BMI` of the built-in body; KIND is `keys`, `gait`, `samples`, `sound`, the
//! beginning of names of key poses or a motion file.

use std::{
    env,
    error::Error,
    io::{self, Write},
    path::Path,
};

use garnet::{
    io::{Take, read_rig},
    motion::{Ground, ReadOptions, RetargetOptions, put_on_ground},
    poses::{GaitCycle, PoseSampler, Poser, SelfContact, SeparationOptions, key_poses},
    shape::{BodyParameters, Measure, ParametricBody},
};
use garnet_skin::{Body, Method, Pose};
use garnet_tests::{Scene, Sheet};
use garnet_view::{Camera, palette};

const COLUMNS: usize = 6;
const ROWS: usize = 2;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [rig, folder, kinds @ ..] = arguments.as_slice() else {
        return Err(
            "usage: pose_sheet RIG|SEX,STATURE,BMI FOLDER [keys|gait|samples|PREFIX|MOTION]…"
                .into(),
        );
    };
    let body = body(rig)?;
    let poser = Poser::new(body.skeleton())?;
    let contact = SelfContact::new(&body)?;
    let all = ["keys".to_owned(), "gait".to_owned()];
    for kind in if kinds.is_empty() { &all } else { kinds } {
        let poses = poses_of(kind, &poser, &contact)?;
        let (names, mut poses): (Vec<String>, Vec<Pose>) = poses.into_iter().unzip();
        put_on_ground(&body, &mut poses, Ground::EachPose)?;
        let mut log = io::stdout().lock();
        for (name, pose) in names.iter().zip(&poses) {
            for contact in contact.report(pose)?.contacts {
                let depth = 1e3 * contact.depth;
                if depth > 5.0 {
                    writeln!(
                        log,
                        "{name}: {:?} {:?} {depth:.0} mm",
                        contact.kind, contact.parts
                    )?;
                }
            }
        }
        let sheets = names
            .chunks(COLUMNS * ROWS)
            .zip(poses.chunks(COLUMNS * ROWS));
        for (index, (names, poses)) in sheets.enumerate() {
            let path = Path::new(folder).join(format!("{}_{index}.png", file_stem(kind)));
            sheet(&body, names, poses, &path)?;
        }
    }
    Ok(())
}

/// The body of a rig file, or the built-in one of `SEX,STATURE,BMI` (stature in metres).
fn body(text: &str) -> Result<Body, Box<dyn Error>> {
    let numbers: Vec<f64> = text
        .split(',')
        .filter_map(|part| part.parse().ok())
        .collect();
    let [sex, stature, bmi] = *numbers.as_slice() else {
        return Ok(read_rig(text)?.into_body()?);
    };
    let parameters = BodyParameters::new(sex)
        .with(Measure::Stature, stature)
        .with_bmi(bmi);
    Ok(ParametricBody::build(&parameters)?.into_body())
}

fn file_stem(path: &str) -> String {
    let stem = Path::new(path).file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// The poses of a kind and what to call them.
fn poses_of(
    kind: &str,
    poser: &Poser,
    contact: &SelfContact,
) -> Result<Vec<(String, Pose)>, Box<dyn Error>> {
    let mut poses: Vec<(String, Pose)> = Vec::new();
    match kind {
        "gait" => {
            for step in 0..12 {
                let phase = f64::from(step) / 12.0;
                let angles = GaitCycle::default().angles(phase);
                poses.push((format!("gait {:.0} %", 100.0 * phase), poser.pose(&angles)));
            }
        }
        "samples" => {
            let sampler = PoseSampler::new(1);
            for index in 0..36 {
                let sound = sampler.sample_for(poser, contact, index)?;
                poses.push((
                    format!("{index} {} {:.2}", sound.sequence, sound.phase),
                    sound.pose,
                ));
            }
        }
        file if Path::new(file).exists() => {
            let take = Take::read(file, &ReadOptions::default())?;
            let step = take.num_frames().div_ceil(COLUMNS * ROWS).max(1);
            let range = format!("::{step}").parse()?;
            let found = take.poses(poser.skeleton(), range, &RetargetOptions::default())?;
            let name = |index: usize| format!("{} {}", file_stem(file), index * step);
            poses.extend(
                found
                    .into_iter()
                    .enumerate()
                    .map(|(index, pose)| (name(index), pose)),
            );
        }
        "sound" => {
            for key in key_poses() {
                let pose = poser.pose(&key.angles);
                match contact.separated(&pose, &SeparationOptions::default())? {
                    Some(separated) => poses.push((key.name.to_owned(), separated.pose)),
                    None => poses.push((format!("REJECTED {}", key.name), pose)),
                }
            }
        }
        prefix => {
            for key in key_poses() {
                if prefix == "keys" || key.name.starts_with(prefix) {
                    poses.push((key.name.to_owned(), poser.pose(&key.angles)));
                }
            }
        }
    }
    Ok(poses)
}

fn sheet(body: &Body, names: &[String], poses: &[Pose], path: &Path) -> Result<(), Box<dyn Error>> {
    let mut scenes = Vec::new();
    for (name, pose) in names.iter().zip(poses) {
        let positions = body.posed_positions(pose, Method::DualQuaternion)?;
        scenes.push(Scene {
            caption: name.clone(),
            meshes: vec![(body.rest().with_positions(positions)?, palette::SKIN)],
            framed: 0,
        });
    }
    let mut sheet = Sheet::new(COLUMNS, [300, 330]);
    sheet.add_columns(scenes, &[Camera::new(0.5, 0.15), Camera::left()]);
    sheet.write_png(path)?;
    Ok(())
}
