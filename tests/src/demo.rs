//! The files in `models/demo`: a mannequin, a tunic on it, and a pose.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use garnet::io::{ObjFile, write_atomically, write_rig_npz};
use garnet::{Body, Pose, Rig};

use crate::{mannequin, reach, tunic};

/// Spacing of the mannequin's vertices, in metres.
const SPACING: f32 = 0.02;

/// About how many vertices the tunic has.
const TUNIC_VERTICES: usize = 3_000;

/// The contents of the demo.
#[derive(Debug, Clone)]
pub struct Demo {
    /// The mannequin at rest, with the positions that `body.obj` has.
    pub body: Body,
    /// The text of `body.obj`.
    pub body_obj: String,
    /// The text of `tunic.obj`.
    pub tunic_obj: String,
    /// The text of `reach.json`.
    pub reach_json: String,
}

impl Demo {
    /// Generates the demo.
    ///
    /// # Panics
    ///
    /// Never: the parts fit together.
    pub fn new() -> Self {
        Self::of_size(SPACING, TUNIC_VERTICES)
    }

    /// Generates a demo with vertices of the mannequin `spacing` metres apart, and about as many
    /// vertices of the tunic as told.
    ///
    /// # Panics
    ///
    /// Never: the parts fit together.
    pub fn of_size(spacing: f32, tunic_vertices: usize) -> Self {
        let generated = mannequin(spacing);
        let body_obj = body_text(&generated);
        let file = ObjFile::parse(body_obj.clone().into_bytes(), "body.obj");
        let mesh = file.ok().and_then(|file| file.mesh().ok());
        let mesh = mesh.expect("the text was made of a mesh");
        let skeleton = generated.skeleton().clone();
        let body = Body::new(mesh, skeleton, generated.weights().clone());
        let body = body.expect("the text has the vertices of the mannequin");
        Self {
            reach_json: pose_text(&body, &reach()),
            body,
            body_obj,
            tunic_obj: tunic(tunic_vertices).to_obj(),
        }
    }

    /// The folder of the committed files.
    pub fn folder() -> PathBuf {
        [env!("CARGO_MANIFEST_DIR"), "..", "models", "demo"]
            .iter()
            .collect()
    }

    /// Writes all files into a folder: [`Demo::folder`] for those of the repository.
    ///
    /// # Errors
    ///
    /// What the system refuses.
    pub fn write(&self, folder: &Path) -> Result<(), Box<dyn std::error::Error>> {
        for (name, text) in [
            ("body.obj", &self.body_obj),
            ("tunic.obj", &self.tunic_obj),
            ("reach.json", &self.reach_json),
        ] {
            write_atomically(folder.join(name), |file| file.write_all(text.as_bytes()))?;
        }
        write_rig_npz(folder.join("body.rig.npz"), &Rig::from(self.body.clone()))?;
        Ok(())
    }
}

impl Default for Demo {
    fn default() -> Self {
        Self::new()
    }
}

fn body_text(body: &Body) -> String {
    let mut text = String::from("# a mannequin, in metres\no body\n");
    for point in body.rest().positions() {
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
