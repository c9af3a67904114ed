//! The garments of packages on four bodies in four poses: the picture of README.
//!
//! A row has a garment or an outfit, a column a body in a pose. Each is draped by the default
//! variant of its package, cut to measure where the package is.

use std::{path::PathBuf, sync::atomic::AtomicBool};

use clap::Args;
use garnet::body::shape::{BodyParameters, Measure, ParametricBody};
use garnet_body::poses::{Poser, key_pose};
use garnet_data::{CutOptions, recut};
use garnet_drape::{Outfit, Package};
use garnet_mesh::TriMesh;
use garnet_skin::Body;
use garnet_view::{Camera, Rgb, palette};

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

/// Colors of the garments of an outfit, the innermost first.
const COLORS: [Rgb; 3] = [palette::GARMENT, palette::REFERENCE, palette::THIRD];

/// What to draw.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Where the picture goes.
    picture: PathBuf,
    /// Garment packages, a row each; an outfit of several, the inner first, as
    /// `models/jeans+models/tshirt`.
    #[arg(required = true)]
    packages: Vec<String>,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let mut sheet = Sheet::new(COLUMNS.len(), CELL);
    let camera = [Camera::new(0.45, 0.1)];
    for outfit in &arguments.packages {
        let packages = outfit.split('+').map(Package::open);
        let packages = packages.collect::<Result<Vec<Package>, _>>()?;
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
            let garments = worn(&packages, &own, &skin)?;
            let garments = garments.into_iter().zip(COLORS);
            let meshes = std::iter::once((skin, palette::SKIN)).chain(garments);
            row.push(Scene {
                caption: String::new(),
                meshes: meshes.collect(),
                framed: 0,
            });
        }
        sheet.add_columns(row, &camera);
    }
    sheet.write_png(&arguments.picture)?;
    Ok(())
}

/// The garments of an outfit, the inner first, on a body with its skin at `skin`, which stands as
/// `own` at rest.
fn worn(
    packages: &[Package],
    own: &Body,
    skin: &TriMesh,
) -> Result<Vec<TriMesh>, Box<dyn std::error::Error>> {
    let mut cut = Vec::with_capacity(packages.len());
    for package in packages {
        let content = if package.manifest().is_made_to_measure() {
            let to_measure = CutOptions::default();
            let never = AtomicBool::new(false);
            recut(package.content(), own.clone(), &to_measure, &never)?
        } else {
            None
        };
        let content = content.unwrap_or_else(|| package.content().clone());
        cut.push(package.with_content(content)?);
    }
    let mut outfit = Outfit::default();
    for package in &cut {
        let posed = package.body().fitted(skin.positions())?;
        outfit.drape(package.default_draper()?, posed)?;
    }
    outfit.free()?;
    let pairs = cut.iter().zip(outfit.into_drapes());
    let meshes = pairs.map(|(package, drape)| {
        let mesh = package.garment().mesh();
        mesh.with_positions(drape.positions)
    });
    Ok(meshes.collect::<Result<_, _>>()?)
}
