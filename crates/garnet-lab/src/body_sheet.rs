//! The pictures of bodies in the README: each body from the front, the side and the back.

use std::{error::Error, path::PathBuf};

use clap::{Args, ValueEnum};
use garnet::body::{
    motion::{Ground, put_on_ground},
    poses::{Poser, SelfContact, SeparationOptions, key_pose},
    shape::{BodyParameters, Measure, ParametricBody},
};
use garnet_mesh::TriMesh;
use garnet_skin::{Body, Method};
use garnet_view::{Camera, palette};

use crate::{
    Outcome,
    sheet::{Scene, Sheet},
};

/// Sex, stature in metres and body mass index of the bodies at rest.
const BODIES: [(f64, f64, f64); 12] = [
    (1.0, 1.72, 18.0),
    (1.0, 1.63, 21.0),
    (1.0, 1.68, 24.0),
    (1.0, 1.55, 28.0),
    (1.0, 1.66, 32.0),
    (1.0, 1.60, 36.0),
    (0.0, 1.83, 18.5),
    (0.0, 1.76, 22.0),
    (0.0, 1.90, 25.0),
    (0.0, 1.66, 27.0),
    (0.0, 1.75, 31.0),
    (0.0, 1.80, 36.0),
];

/// The bodies that are posed, in turn.
const POSED: [(f64, f64, f64); 4] = [
    (1.0, 1.70, 21.0),
    (0.0, 1.78, 24.0),
    (1.0, 1.64, 28.0),
    (0.0, 1.74, 30.0),
];

const POSES: [&str; 24] = [
    "stand",
    "a_pose",
    "tree",
    "warrior_two",
    "chair",
    "dancer",
    "triangle",
    "forward_fold",
    "downward_dog",
    "boat",
    "garland",
    "kneel",
    "sit",
    "squat",
    "high_lunge",
    "throw",
    "reach_front",
    "upward_salute",
    "phone_at_ear",
    "hands_on_hips",
    "arms_crossed",
    "ballroom_frame",
    "first_arabesque",
    "grand_jete",
];

const COLUMNS: usize = 12;
const CELL: [u32; 2] = [140, 230];

/// What to draw.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Bodies at rest, or bodies in poses of the library.
    #[arg(value_enum)]
    what: What,
    /// The picture.
    #[arg(value_name = "FILE.png")]
    path: PathBuf,
}

/// What bodies do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum What {
    Bodies,
    Poses,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let mut scenes = Vec::new();
    let mut add = |mesh: TriMesh, caption: String| {
        scenes.push(Scene {
            caption,
            meshes: vec![(mesh, palette::SKIN)],
            framed: 0,
        });
    };
    if arguments.what == What::Bodies {
        for (sex, stature, bmi) in BODIES {
            let mesh = body(sex, stature, bmi)?.rest().clone();
            add(mesh, format!("{:.0} cm, {bmi:.0}", 100.0 * stature));
        }
    } else {
        let bodies: Vec<Body> = POSED
            .into_iter()
            .map(|(sex, stature, bmi)| body(sex, stature, bmi))
            .collect::<Result<_, _>>()?;
        for (index, name) in POSES.into_iter().enumerate() {
            let mesh = posed(&bodies[index % bodies.len()], name)?;
            add(mesh, name.replace('_', " "));
        }
    }
    let mut sheet = Sheet::new(COLUMNS, CELL);
    let cameras = [Camera::new(0.0, 0.06), Camera::left(), Camera::back()];
    sheet.add_columns(scenes, &cameras);
    sheet.write_png(&arguments.path)?;
    Ok(())
}

fn body(sex: f64, stature: f64, bmi: f64) -> Result<Body, Box<dyn Error>> {
    let parameters = BodyParameters::new(sex)
        .with(Measure::Stature, stature)
        .with_bmi(bmi);
    Ok(ParametricBody::build(&parameters)?.into_body())
}

/// A body in a pose of the library, its parts apart, on the ground.
fn posed(body: &Body, name: &str) -> Result<TriMesh, Box<dyn Error>> {
    let key = key_pose(name).ok_or_else(|| format!("there is no pose `{name}`"))?;
    let pose = Poser::new(body.skeleton())?.pose(&key.angles);
    let separated = SelfContact::new(body)?.separated(&pose, &SeparationOptions::default())?;
    let mut poses = [separated.map_or(pose, |separated| separated.pose)];
    put_on_ground(body, &mut poses, Ground::EachPose)?;
    let positions = body.posed_positions(&poses[0], Method::DualQuaternion)?;
    Ok(body.rest().with_positions(positions)?)
}
