//! Threads that share one draper: each drapes another body.
//!
//! `cargo run --example threads -- FOLDER`

use std::error::Error;
use std::path::{Path, PathBuf};
use std::thread;

use garnet::{Package, Pose, UnitQuaternion, Vector3};

fn main() -> Result<(), Box<dyn Error>> {
    let folder: PathBuf = std::env::args().nth(1).unwrap_or_else(|| ".".into()).into();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let shirt = Package::open(models.join("tshirt"))?;
    let draper = shirt.draper("fast")?;

    let posed = |angle: f32| {
        let mut pose = Pose::rest(shirt.body().skeleton().num_joints());
        pose.rotations[0] = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle);
        shirt.body().posed(&pose)
    };
    let bodies = [posed(0.0)?, posed(0.2)?];
    let drapes = thread::scope(|scope| {
        let draper = &draper;
        let threads = bodies
            .each_ref()
            .map(|body| scope.spawn(move || draper.drape(body)));
        threads.map(|thread| thread.join().expect("no drape panics"))
    });
    for (number, drape) in drapes.into_iter().enumerate() {
        shirt.write(
            folder.join(format!("shirt_{number}.obj")),
            &drape?.positions,
        )?;
    }
    Ok(())
}
