//! Drapes a garment on each frame of a motion: bound once, draped many times.
//!
//! `cargo run --example motion -- FOLDER`

use std::error::Error;
use std::path::{Path, PathBuf};

use garnet::{Draper, Garment, Pose, UnitQuaternion, Vector3, io};

/// Frames of the motion.
const FRAMES: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let folder: PathBuf = std::env::args().nth(1).unwrap_or_else(|| ".".into()).into();
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/demo");
    let file = io::ObjFile::read(demo.join("tunic.obj"))?;
    let body = io::read_body(demo.join("body.rig.npz"))?;
    let draper = Draper::new(Garment::new(file.mesh()?).bind(&body)?);

    for frame in 0..FRAMES {
        // The body leans to its side, a little more in each frame.
        let mut pose = Pose::rest(body.skeleton().num_joints());
        let angle = 0.1 * frame as f32;
        pose.rotations[0] = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        let drape = draper.drape(&body.posed(&pose)?)?;
        let path = folder.join(format!("frame_{frame:04}.obj"));
        file.write_with_positions(path, &drape.positions)?;
    }
    Ok(())
}
