//! The files in `models/demo`: a tunic on the built-in body, and that body in a pose; and a larger
//! scene to measure the command with.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use garnet::body::motion::{Ground, put_on_ground};
use garnet::body::poses::{Poser, SelfContact, SeparationOptions, key_pose};
use garnet::body::shape::{BodyParameters, Measure, ParametricBody};
use garnet::io::{write_atomically, write_rig_npz};
use garnet::{Body, Point3, Pose, Rig, skin::Method};

use crate::{Form, mannequin, reach, tunic, tunic_on};

/// About how many vertices the tunic of the demo has.
const TUNIC_VERTICES: usize = 3_000;

/// The pose of the library of `reach.obj`.
const REACH: &str = "reach_front";

/// Poses of the library in which the demo is tested, too.
const OTHER_POSES: [&str; 2] = ["throw", "ballroom_frame"];

/// Spacing of the vertices of a mannequin of 13 000, in metres.
const FINE_SPACING: f32 = 0.0132;

/// About how many vertices the tunic on it has.
const FINE_TUNIC: usize = 10_000;

/// The name of a pose, and the vertices of a body in it `[vertex]`.
pub type Posed = (&'static str, Vec<Point3>);

/// The contents of the demo.
#[derive(Debug, Clone)]
pub struct Demo {
    /// The body at rest.
    pub body: Body,
    /// The text of `tunic.obj`.
    pub tunic_obj: String,
    /// The text of `reach.obj`.
    pub reach_obj: String,
}

impl Demo {
    /// Generates the demo.
    ///
    /// # Errors
    ///
    /// What the built-in body refuses.
    pub fn new() -> Result<Self, Box<dyn Error>> {
        let parameters = BodyParameters::new(1.0)
            .with(Measure::Stature, 1.70)
            .with_bmi(22.0);
        let body = ParametricBody::build(&parameters)?.into_body();
        let form = Form::of_body(&parameters, &body)?;
        Ok(Self {
            tunic_obj: tunic_on(&form, TUNIC_VERTICES).to_obj(),
            reach_obj: body_text(&library_posed(&body, REACH)?, &body),
            body,
        })
    }

    /// Each pose that the demo is tested in, and the body in it.
    ///
    /// # Errors
    ///
    /// What the built-in body refuses.
    pub fn posed(&self) -> Result<Vec<Posed>, Box<dyn Error>> {
        let poses = [REACH].into_iter().chain(OTHER_POSES);
        poses
            .map(|pose| Ok((pose, library_posed(&self.body, pose)?)))
            .collect()
    }

    /// The folder of the committed files.
    pub fn folder() -> PathBuf {
        [env!("CARGO_MANIFEST_DIR"), "..", "models", "demo"]
            .iter()
            .collect()
    }

    /// Writes all files into [`Demo::folder`].
    ///
    /// # Errors
    ///
    /// What the system refuses.
    pub fn write(&self) -> Result<(), Box<dyn Error>> {
        let folder = Self::folder();
        write(&folder, "tunic.obj", &self.tunic_obj)?;
        write(&folder, "reach.obj", &self.reach_obj)?;
        write_rig_npz(folder.join("body.rig.npz"), &Rig::from(self.body.clone()))?;
        Ok(())
    }
}

/// Writes the scene that the times of the command are stated for: a tunic of 10 000 vertices on a
/// [`mannequin`] of 13 000, and the pose [`reach`].
///
/// # Errors
///
/// What the system refuses.
pub fn write_fine(folder: &Path) -> Result<(), Box<dyn Error>> {
    let body = mannequin(FINE_SPACING);
    write(
        folder,
        "body.obj",
        &body_text(body.rest().positions(), &body),
    )?;
    write(folder, "tunic.obj", &tunic(FINE_TUNIC).to_obj())?;
    write(folder, "reach.json", &pose_text(&body, &reach()))?;
    write_rig_npz(folder.join("body.rig.npz"), &Rig::from(body))?;
    Ok(())
}

/// Sex, stature in metres, body mass index, and pose of some bodies side by side.
const PEOPLE: [(f64, f64, f64, &str); 10] = [
    (1.0, 1.72, 18.5, "a_pose"),
    (1.0, 1.63, 25.0, "stand"),
    (1.0, 1.60, 33.0, "a_pose"),
    (0.0, 1.80, 20.0, "a_pose"),
    (0.0, 1.76, 27.0, "stand"),
    (0.0, 1.72, 34.0, "a_pose"),
    (1.0, 1.70, 21.0, "tree"),
    (0.0, 1.78, 24.0, "throw"),
    (1.0, 1.66, 29.0, "dancer"),
    (0.0, 1.85, 23.0, "chair"),
];

/// From one body of the picture to the next, in metres.
const PEOPLE_SPACING: f32 = 1.2;

/// The bodies of the picture side by side, as the text of one OBJ.
///
/// # Errors
///
/// What the built-in body refuses.
pub fn people_obj() -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    let mut faces = String::new();
    let mut first = 1;
    for (index, (sex, stature, bmi, pose)) in PEOPLE.into_iter().enumerate() {
        let parameters = BodyParameters::new(sex).with(Measure::Stature, stature);
        let body = ParametricBody::build(&parameters.with_bmi(bmi))?.into_body();
        let positions = library_posed(&body, pose)?;
        for point in &positions {
            let x = point.x + PEOPLE_SPACING * index as f32;
            writeln!(text, "v {x:.5} {:.5} {:.5}", point.y, point.z)?;
        }
        for face in body.rest().faces() {
            let [a, b, c] = face.map(|vertex| vertex + first);
            writeln!(faces, "f {a} {b} {c}")?;
        }
        first += positions.len() as u32;
    }
    Ok(text + &faces)
}

/// A body in a pose of the library, its parts apart, on the ground.
fn library_posed(body: &Body, pose: &str) -> Result<Vec<Point3>, Box<dyn Error>> {
    let angles = key_pose(pose)
        .ok_or("the library has the poses of the demo")?
        .angles;
    let pose = Poser::new(body.skeleton())?.pose(&angles);
    let separated = SelfContact::new(body)?.separated(&pose, &SeparationOptions::default())?;
    let mut poses = [separated.map_or(pose, |separated| separated.pose)];
    put_on_ground(body, &mut poses, Ground::EachPose)?;
    Ok(body.posed_positions(&poses[0], Method::DualQuaternion)?)
}

fn write(folder: &Path, name: &str, text: &str) -> Result<(), Box<dyn Error>> {
    write_atomically(folder.join(name), |file| file.write_all(text.as_bytes()))?;
    Ok(())
}

fn body_text(positions: &[Point3], body: &Body) -> String {
    let mut text = String::from("# a body, in metres\no body\n");
    for point in positions {
        let line = writeln!(text, "v {:.5} {:.5} {:.5}", point.x, point.y, point.z);
        line.expect("a string takes all text");
    }
    for face in body.rest().faces() {
        let [a, b, c] = face.map(|vertex| vertex + 1);
        writeln!(text, "f {a} {b} {c}").expect("a string takes all text");
    }
    text
}

fn pose_text(body: &Body, pose: &Pose) -> String {
    let mut rotations = Vec::new();
    for (joint, rotation) in body.skeleton().joints().iter().zip(&pose.rotations) {
        let [x, y, z, w]: [f32; 4] = rotation.coords.into();
        if rotation.angle() > 0.0 {
            rotations.push(format!(
                "    \"{}\": [{x:.6}, {y:.6}, {z:.6}, {w:.6}]",
                joint.name
            ));
        }
    }
    let [x, y, z]: [f32; 3] = pose.root_translation.into();
    format!(
        "{{\n  \"schema\": \"garnet.pose/1\",\n  \"joints\": {{\n{}\n  }},\n  \
         \"root_translation\": [{x:.6}, {y:.6}, {z:.6}]\n}}\n",
        rotations.join(",\n")
    )
}
