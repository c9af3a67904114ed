//! Pictures of the drapes of a data set:
//! `cargo run --release -p garnet-tests --example drape_sheet -- PACKAGE DATASET FOLDER [SPLIT]`.
//!
//! Each sheet has twelve scenes, from the front to the left and from the back.

use std::{env, error::Error, path::Path};

use garnet::{
    data::{BodyRecord, Dataset, GarmentPackage, SceneRecord, Split},
    shape::ParametricBody,
};
use garnet_mesh::TriMesh;
use garnet_skin::Method;
use garnet_view::{Camera, Layer, Paint, Picture, View, palette, render};

const COLUMNS: usize = 6;
const ROWS: usize = 2;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [package, dataset, folder, split @ ..] = arguments.as_slice() else {
        return Err("usage: drape_sheet PACKAGE DATASET FOLDER [train|valid|test]".into());
    };
    let package = GarmentPackage::read(Path::new(package))?;
    let dataset = Dataset::open(Path::new(dataset))?;
    let wanted = split.first().map(String::as_str);
    let mut scenes: Vec<(String, TriMesh, TriMesh)> = Vec::new();
    for split in Split::ALL {
        if wanted.is_some_and(|wanted| wanted != split.name()) {
            continue;
        }
        for shard in dataset.split(split) {
            let shard = shard?;
            for scene in &shard.scenes {
                let body = shard.bodies.iter().find(|body| body.number == scene.body);
                let body = body.ok_or("a scene without body")?;
                scenes.push(meshes(&package, body, scene, split)?);
            }
        }
    }
    for (index, scenes) in scenes.chunks(COLUMNS * ROWS).enumerate() {
        sheet(
            scenes,
            &Path::new(folder).join(format!("drapes_{index}.png")),
        )?;
    }
    Ok(())
}

/// Caption, garment and body of a scene.
fn meshes(
    package: &GarmentPackage,
    body: &BodyRecord,
    scene: &SceneRecord,
    split: Split,
) -> Result<(String, TriMesh, TriMesh), Box<dyn Error>> {
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
    Ok((caption, garment, built.body().rest().with_positions(posed)?))
}

fn sheet(scenes: &[(String, TriMesh, TriMesh)], path: &Path) -> Result<(), Box<dyn Error>> {
    let mut views = Vec::new();
    let cameras = [Camera::new(0.5, 0.1), Camera::new(3.6, 0.1)];
    for row in 0..scenes.len().div_ceil(COLUMNS) {
        for (side, camera) in cameras.into_iter().enumerate() {
            for column in 0..COLUMNS {
                let index = row * COLUMNS + column;
                let shown = index.min(scenes.len() - 1);
                views.push(View {
                    caption: if side == 0 && index < scenes.len() {
                        scenes[index].0.clone()
                    } else {
                        String::new()
                    },
                    shown: Some(vec![2 * shown, 2 * shown + 1]),
                    framed: Some(vec![2 * shown]),
                    ..View::new(camera)
                });
            }
        }
    }
    let rows = views.len() / COLUMNS;
    let layers = scenes.iter().flat_map(|(_, garment, body)| {
        let paint = Paint::Plain(palette::SKIN);
        [
            Layer::new(garment),
            Layer {
                paint,
                ..Layer::new(body)
            },
        ]
    });
    let image = render(&Picture {
        layers: layers.collect(),
        views,
        columns: Some(COLUMNS as u32),
        supersampling: 2,
        ..Picture::new(330 * COLUMNS as u32, 360 * rows as u32)
    })?;
    image.write_png(path)?;
    Ok(())
}
