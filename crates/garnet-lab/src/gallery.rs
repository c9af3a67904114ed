//! What networks make of a data set, beside the teacher.
//!
//! `gallery.png` has scenes of the split (test, unless told otherwise) in rows: skinning, warp,
//! variants and teacher, and where the last variant is off; `curvature.png` has the mean curvature
//! of variants and teacher (figure 7 of the paper); `errors.png` has the mean distance of each
//! vertex over the split on the template, one column a variant, from the front and from the back;
//! `sheet.png` has four bodies in six poses each, the relaxed drapes of the variants beside the
//! teacher's, to be looked at.

use std::{
    error::Error,
    fs,
    path::{Path, PathBuf},
};

use clap::Args;
use garnet::{
    data::{Dataset, Split},
    package::GarmentPackage,
    train::{Candidate, DrapedScene, SceneName, Stage, chart::spread, drape_scenes},
    untangle::UntangleOptions,
};
use garnet_mesh::{Point3, Topology, TriMesh, mean_curvatures};
use garnet_view::{Camera, ColorMap, Heat, Layer, Paint, Picture, View, palette, render};

use crate::{Outcome, spread as splits};

/// Rows of the gallery.
const SCENES: usize = 6;

/// Bodies of the sheet, and scenes of each.
const SHEET: [usize; 2] = [4, 6];

/// Width and height of a view, in pixels.
const CELL: [u32; 2] = [300, 380];

/// And of one of the sheet.
const SHEET_CELL: [u32; 2] = [170, 250];

/// Values at the ends of the color bars.
const MOST_MILLIMETRES: f32 = 40.0;
const MOST_CURVED: f32 = 100.0;

/// A mesh, with values by which it is painted.
struct Figure {
    mesh: TriMesh,
    values: Option<(Vec<f32>, Scale)>,
    body: Option<TriMesh>,
    caption: String,
    camera: Camera,
}

#[derive(Clone, Copy)]
enum Scale {
    Millimetres,
    Curvature,
}

/// What to draw.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The garment package.
    package: PathBuf,
    /// The data set.
    dataset: PathBuf,
    /// Where pictures go.
    folder: PathBuf,
    /// Variants of the package.
    variants: Vec<String>,
    /// The split: train, valid or test.
    #[arg(long, default_value = "test", value_parser = splits::split)]
    split: Split,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let Arguments {
        package: path,
        folder,
        split,
        ..
    } = arguments;
    let split = *split;
    fs::create_dir_all(folder)?;
    let package = GarmentPackage::read(path)?;
    let mut candidates = vec![Candidate::Skinning, Candidate::Warp];
    let mut names = vec!["skinning (DQS)".to_owned(), "warp".to_owned()];
    for name in &arguments.variants {
        let weights = package.manifest.weights_of(path, name)?;
        let variant = package.manifest.variant(name);
        let frames = variant.and_then(|variant| variant.settle_frames);
        for candidate in Candidate::of_weights(name, &weights, frames)? {
            if let Candidate::Model { settle, .. } = candidate {
                names.push(Candidate::settled_name(name, settle));
            }
            candidates.push(candidate);
        }
    }
    let stage = Stage::new(package, Dataset::open(&arguments.dataset)?)?;
    let all = stage.scene_names(split)?;
    let chosen = spread(&all, SCENES);
    let on_sheet = of_bodies(&all, SHEET);

    let (mut scenes, mut sheet) = (Vec::new(), Vec::new());
    let num_vertices = stage.package.mesh.num_vertices();
    let mut sums = vec![vec![0.0_f32; num_vertices]; candidates.len()];
    let options = UntangleOptions::default();
    drape_scenes(
        &stage,
        split,
        &candidates,
        &options,
        |_| true,
        &mut |scene| {
            for (sums, drape) in sums.iter_mut().zip(&scene.drapes) {
                for (sum, distance) in sums.iter_mut().zip(distances(drape, &scene.teacher)) {
                    *sum += distance / all.len() as f32;
                }
            }
            if on_sheet.contains(&scene.scene) {
                sheet.push(scene.clone());
            }
            if chosen.contains(&scene.scene) {
                scenes.push(scene);
            }
        },
    )?;

    let mesh = &stage.package.mesh;
    write(
        &gallery(mesh, &scenes, &names)?,
        names.len() + 2,
        CELL,
        &folder.join("gallery.png"),
    )?;
    write(
        &curvature(mesh, &scenes, &names)?,
        names.len(),
        CELL,
        &folder.join("curvature.png"),
    )?;
    write(
        &errors(mesh, &sums, &names),
        names.len(),
        CELL,
        &folder.join("errors.png"),
    )?;
    let (figures, columns) = sheet_of(mesh, &mut sheet, &names)?;
    write(&figures, columns, SHEET_CELL, &folder.join("sheet.png"))
}

/// The first scenes of bodies that are spread over all, as many of each as are asked for.
fn of_bodies(all: &[SceneName], [bodies, poses]: [usize; 2]) -> Vec<SceneName> {
    let count = |body: u32| all.iter().filter(|scene| scene.body == body).count();
    let mut whole: Vec<u32> = all.iter().map(|scene| scene.body).collect();
    whole.dedup();
    whole.retain(|&body| count(body) >= poses);
    let chosen = (0..bodies.min(whole.len())).map(|at| whole[at * whole.len() / bodies]);
    let scenes = chosen.flat_map(|body| {
        let of_body = all.iter().filter(move |scene| scene.body == body);
        of_body.take(poses).copied()
    });
    scenes.collect()
}

/// A row for each pose; in it for each body what the variants make of it, and the teacher.
fn sheet_of(
    mesh: &TriMesh,
    scenes: &mut [DrapedScene],
    names: &[String],
) -> Result<(Vec<Figure>, usize), Box<dyn Error>> {
    let [_, poses] = SHEET;
    scenes.sort_by_key(|scene| (scene.scene.body, scene.scene.pose));
    // Skinning, the warp and what networks predict before they are relaxed are left out.
    let is_shown = |name: &str| name.ends_with("settled");
    let mut figures = Vec::new();
    for row in 0..poses {
        for scene in scenes.iter().skip(row).step_by(poses) {
            let drapes = scene.drapes.iter().zip(names);
            let drapes = drapes.filter(|(_, name)| is_shown(name));
            let drapes = drapes.map(|(drape, name)| (drape, name.trim_end_matches(" settled")));
            for (drape, name) in drapes.chain([(&scene.teacher, "simulator")]) {
                figures.push(Figure {
                    mesh: mesh.with_positions(drape.clone())?,
                    values: None,
                    body: Some(scene.body.clone()),
                    caption: name.to_owned(),
                    camera: Camera::new(0.5, 0.1),
                });
            }
        }
    }
    let columns = figures.len() / poses;
    Ok((figures, columns.max(1)))
}

/// Distances in millimetres.
fn distances<'a>(drape: &'a [Point3], teacher: &'a [Point3]) -> impl Iterator<Item = f32> + 'a {
    let pairs = drape.iter().zip(teacher);
    pairs.map(|(place, target)| 1e3 * (place - target).norm())
}

fn caption(scene: SceneName, name: &str, error: f32) -> String {
    format!("{name} {}/{}: {error:.1} mm", scene.body, scene.pose)
}

fn gallery(
    mesh: &TriMesh,
    scenes: &[DrapedScene],
    names: &[String],
) -> Result<Vec<Figure>, Box<dyn Error>> {
    let mut figures = Vec::new();
    let camera = Camera::new(0.5, 0.1);
    for scene in scenes {
        let mut last = Vec::new();
        for (drape, name) in scene.drapes.iter().zip(names) {
            last = distances(drape, &scene.teacher).collect();
            let mean = last.iter().sum::<f32>() / last.len() as f32;
            figures.push(Figure {
                mesh: mesh.with_positions(drape.clone())?,
                values: None,
                body: Some(scene.body.clone()),
                caption: caption(scene.scene, name, mean),
                camera,
            });
        }
        let teacher = mesh.with_positions(scene.teacher.clone())?;
        for (values, name) in [(None, "teacher"), (Some(last), "distance")] {
            figures.push(Figure {
                mesh: teacher.clone(),
                values: values.map(|values| (values, Scale::Millimetres)),
                body: Some(scene.body.clone()),
                caption: name.to_owned(),
                camera,
            });
        }
    }
    Ok(figures)
}

fn curvature(
    mesh: &TriMesh,
    scenes: &[DrapedScene],
    names: &[String],
) -> Result<Vec<Figure>, Box<dyn Error>> {
    let topology = Topology::new(mesh.num_vertices(), mesh.faces());
    let mut figures = Vec::new();
    for scene in scenes {
        // Skinning is left out: its curvature is that of the template.
        let drapes = scene.drapes.iter().zip(names).skip(1);
        let drapes = drapes.map(|(drape, name)| (drape, name.as_str()));
        for (drape, name) in drapes.chain([(&scene.teacher, "teacher")]) {
            figures.push(Figure {
                mesh: mesh.with_positions(drape.clone())?,
                values: Some((mean_curvatures(drape, &topology), Scale::Curvature)),
                body: Some(scene.body.clone()),
                caption: name.to_owned(),
                camera: Camera::new(0.5, 0.1),
            });
        }
    }
    Ok(figures)
}

fn errors(mesh: &TriMesh, sums: &[Vec<f32>], names: &[String]) -> Vec<Figure> {
    let mut figures = Vec::new();
    for azimuth in [0.0, std::f32::consts::PI] {
        for (values, name) in sums.iter().zip(names) {
            let mean = values.iter().sum::<f32>() / values.len() as f32;
            figures.push(Figure {
                mesh: mesh.clone(),
                values: Some((values.clone(), Scale::Millimetres)),
                body: None,
                caption: format!("{name}: {mean:.1} mm"),
                camera: Camera::new(azimuth, 0.0),
            });
        }
    }
    figures
}

fn write(figures: &[Figure], columns: usize, cell: [u32; 2], path: &Path) -> Outcome {
    let mut layers = Vec::new();
    let mut views = Vec::new();
    for figure in figures {
        let first = layers.len();
        let paint = match &figure.values {
            None => Paint::Plain(palette::GARMENT),
            Some((values, scale)) => Paint::Heat(heat(values, *scale)),
        };
        layers.push(Layer {
            paint,
            ..Layer::new(&figure.mesh)
        });
        layers.extend(figure.body.as_ref().map(Layer::new));
        views.push(View {
            caption: figure.caption.clone(),
            shown: Some((first..layers.len()).collect()),
            framed: Some(vec![first]),
            ..View::new(figure.camera)
        });
    }
    let rows = views.len().div_ceil(columns);
    let picture = Picture {
        layers,
        columns: Some(columns as u32),
        supersampling: 2,
        views,
        ..Picture::new(cell[0] * columns as u32 + 120, cell[1] * rows as u32)
    };
    render(&picture)?.write_png(path)?;
    Ok(())
}

fn heat(values: &[f32], scale: Scale) -> Heat<'_> {
    match scale {
        Scale::Millimetres => Heat {
            range: Some([0.0, MOST_MILLIMETRES]),
            ..Heat::new(values, "mm")
        },
        Scale::Curvature => Heat {
            range: Some([-MOST_CURVED, MOST_CURVED]),
            map: ColorMap::CoolWarm,
            ..Heat::new(values, "1/m")
        },
    }
}
