//! Pictures of the drapes of a data set.
//!
//! Each sheet has twelve scenes, from the front to the left and from the back.

use std::{error::Error, fs, path::PathBuf};

use clap::Args;
use garnet::{
    body::shape::ParametricBody,
    data::{BodyRecord, Dataset, SceneRecord, Split},
    package::GarmentPackage,
};
use garnet_skin::Method;
use garnet_view::{Camera, palette};

use crate::{
    Outcome,
    sheet::{Scene, Sheet},
    spread,
};

const COLUMNS: usize = 6;
const ROWS: usize = 2;

/// What to draw.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The garment package.
    package: PathBuf,
    /// The data set.
    dataset: PathBuf,
    /// Where pictures go.
    folder: PathBuf,
    /// The split; all without one.
    #[arg(value_parser = spread::split)]
    split: Option<Split>,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let folder = &arguments.folder;
    fs::create_dir_all(folder)?;
    let package = GarmentPackage::read(&arguments.package)?;
    let dataset = Dataset::open(&arguments.dataset)?;
    let mut scenes = Vec::new();
    for split in Split::ALL {
        if arguments.split.is_some_and(|wanted| wanted != split) {
            continue;
        }
        for shard in dataset.split(split) {
            let shard = shard?;
            for scene in &shard.scenes {
                let body = shard.bodies.iter().find(|body| body.number == scene.body);
                let body = body.ok_or("a scene without body")?;
                scenes.push(drawn(&package, body, scene, split)?);
            }
        }
    }
    for (index, scenes) in scenes.chunks(COLUMNS * ROWS).enumerate() {
        let mut sheet = Sheet::new(COLUMNS, [330, 360]);
        let cameras = [Camera::new(0.5, 0.1), Camera::new(3.6, 0.1)];
        sheet.add_columns(scenes.to_vec(), &cameras);
        sheet.write_png(&folder.join(format!("drapes_{index}.png")))?;
    }
    Ok(())
}

/// Garment and body of a scene.
fn drawn(
    package: &GarmentPackage,
    body: &BodyRecord,
    scene: &SceneRecord,
    split: Split,
) -> Result<Scene, Box<dyn Error>> {
    let parameters = body.parameters.as_ref().ok_or("no built-in body")?;
    let built = ParametricBody::build(&parameters.parameters()?)?;
    let pose = scene.pose().ok_or("no pose")?;
    let posed = built.body().posed_positions(pose, Method::DualQuaternion)?;
    let caption = format!(
        "{} {}/{} {}",
        split.name(),
        scene.body,
        scene.pose,
        scene.sequence
    );
    let garment = package.mesh.with_positions(scene.garment.clone())?;
    let body = built.body().rest().with_positions(posed)?;
    Ok(Scene {
        caption,
        meshes: vec![(garment, palette::GARMENT), (body, palette::SKIN)],
        framed: 0,
    })
}
