//! The garments of packages on four bodies in four poses: the picture of README.
//!
//! A row has a garment, a column a body in a pose. Each is draped by the default variant of its
//! package, cut to measure where the package is.

use std::{path::PathBuf, sync::atomic::AtomicBool};

use clap::Args;
use garnet::body::shape::{BodyParameters, Measure, ParametricBody};
use garnet_body::poses::{Poser, key_pose};
use garnet_data::{CutOptions, recut};
use garnet_drape::Package;
use garnet_mesh::TriMesh;
use garnet_view::{Camera, palette};

use crate::{
    Outcome,
    sheet::{Scene, Sheet},
};

/// Sex, body mass index, stature in metres, and the pose of each column.
const COLUMNS: [(f64, f64, f64, &str); 4] = [
    (1.0, 21.0, 1.66, "wave"),
    (0.0, 24.0, 1.80, "stairs_up"),
    (1.0, 26.0, 1.70, "sit"),
    (0.0, 21.5, 1.74, "hands_on_hips"),
];

/// Width and height of a view, in pixels.
const CELL: [u32; 2] = [300, 420];

/// What to draw.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Where the picture goes.
    picture: PathBuf,
    /// Garment packages, a row each.
    #[arg(required = true)]
    packages: Vec<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let mut sheet = Sheet::new(COLUMNS.len(), CELL);
    let camera = [Camera::new(0.45, 0.1)];
    for path in &arguments.packages {
        let package = Package::open(path)?;
        let mut row = Vec::new();
        for (sex, bmi, stature, pose) in COLUMNS {
            let parameters = BodyParameters::new(sex);
            let parameters = parameters.with(Measure::Stature, stature).with_bmi(bmi);
            let own = ParametricBody::build(&parameters)?.into_body();
            let key = key_pose(pose).ok_or_else(|| format!("there is no pose `{pose}`"))?;
            let posed = own.posed(&Poser::new(own.skeleton())?.pose(&key.angles))?;
            let skin = own
                .rest()
                .with_positions(posed.skin().positions().to_vec())?;
            let cut = if package.manifest().is_made_to_measure() {
                let to_measure = CutOptions::default();
                recut(package.content(), own, &to_measure, &AtomicBool::new(false))?
            } else {
                None
            };
            let cut = cut
                .map(|content| package.with_content(content))
                .transpose()?;
            let package = cut.as_ref().unwrap_or(&package);
            let target = package.body().fitted(skin.positions())?;
            let drape = package.default_draper()?.drape(&target)?;
            let faces = package.content().mesh.faces().to_vec();
            row.push(Scene {
                caption: String::new(),
                meshes: vec![
                    (skin, palette::SKIN),
                    (TriMesh::new(drape.positions, faces)?, palette::GARMENT),
                ],
                framed: 0,
            });
        }
        sheet.add_columns(row, &camera);
    }
    sheet.write_png(&arguments.picture)?;
    Ok(())
}
