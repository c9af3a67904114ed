//! Pictures of the key poses, the gait cycle or drawn poses on a rigged body.

use std::{
    error::Error,
    io::{self, Write},
    path::{Path, PathBuf},
};

use clap::Args;
use garnet::{
    body::{
        motion::{Ground, ReadOptions, RetargetOptions, StartAt, put_on_ground},
        poses::{GaitCycle, PoseSampler, Poser, SelfContact, SeparationOptions, key_poses},
        shape::{BodyParameters, Measure, ParametricBody},
    },
    io::{Take, read_rig},
};
use garnet_skin::{Body, Method, Pose};
use garnet_view::{Camera, palette};

use crate::{
    Outcome,
    sheet::{Scene, Sheet},
};

const COLUMNS: usize = 6;
const ROWS: usize = 2;

/// What to draw.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A rig, or sex from 0 to 1, stature in metres and body mass index of the built-in body.
    #[arg(value_name = "RIG|SEX,STATURE,BMI")]
    body: String,
    /// Where pictures go.
    folder: PathBuf,
    /// `keys`, `gait`, `samples`, `sound` (key poses, parts of the body apart), the beginning of
    /// names of key poses, or a motion file.
    #[arg(default_values = ["keys", "gait"])]
    kinds: Vec<String>,
}

/// What a built-in body is made by.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Figure([f64; 3]);

/// Reads `SEX,STATURE,BMI`.
pub(crate) fn figure(text: &str) -> Result<Figure, String> {
    let numbers: Vec<f64> = (text.split(','))
        .filter_map(|part| part.parse().ok())
        .collect();
    match numbers[..] {
        [sex, stature, bmi] => Ok(Figure([sex, stature, bmi])),
        _ => Err("expected SEX,STATURE,BMI, three numbers".to_owned()),
    }
}

impl Figure {
    pub(crate) fn parameters(self) -> BodyParameters {
        let [sex, stature, bmi] = self.0;
        BodyParameters::new(sex)
            .with(Measure::Stature, stature)
            .with_bmi(bmi)
    }
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let body = body(&arguments.body)?;
    let poser = Poser::new(body.skeleton())?;
    let contact = SelfContact::new(&body)?;
    for kind in &arguments.kinds {
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
            let path = arguments
                .folder
                .join(format!("{}_{index}.png", file_stem(kind)));
            sheet(&body, names, poses, &path)?;
        }
    }
    Ok(())
}

/// The body of a rig file, or the built-in one of `SEX,STATURE,BMI` (stature in metres).
fn body(text: &str) -> Result<Body, Box<dyn Error>> {
    let Ok(figure) = figure(text) else {
        return Ok(read_rig(text)?.into_body()?);
    };
    Ok(ParametricBody::build(&figure.parameters())?.into_body())
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
            let options = RetargetOptions {
                start_at: StartAt::Origin,
                ..RetargetOptions::default()
            };
            let found = take.poses(poser.skeleton(), range, &options)?;
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
