//! The garments of the built-in patterns, in the flat and around a body, as OBJ and PNG.

use std::{
    error::Error,
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
};

use clap::Args;
use garnet::{body::shape::ParametricBody, data::wearer_of, io::write_obj};
use garnet_knn::Surface;
use garnet_mesh::TriMesh;
use garnet_pattern::{GarmentKind, SewnGarment, Size, Template};
use garnet_view::{Camera, palette};

use crate::{
    Outcome,
    pose_sheet::{Figure, figure},
    sheet::{Scene, Sheet},
};

/// What to cut.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Where meshes and pictures go.
    folder: PathBuf,
    /// Sex from 0 to 1, stature in metres and body mass index of the wearer.
    #[arg(value_name = "SEX,STATURE,BMI", value_parser = figure)]
    body: Figure,
    /// Vertices of the garments.
    #[arg(long, default_value = "5000")]
    vertices: usize,
    /// Size of the garments; without one they are made to measure.
    #[arg(long)]
    size: Option<Size>,
    /// Parameters of the patterns, in metres or shares.
    #[arg(value_name = "NAME=VALUE")]
    parameters: Vec<String>,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let body = ParametricBody::build(&arguments.body.parameters())?;
    let wearer = wearer_of(body.body()).ok_or("the built-in body has measures")??;
    let cut = arguments.size.map_or(wearer.measures, Size::measures);

    let folder = &arguments.folder;
    fs::create_dir_all(folder)?;
    write_obj(folder.join("body.obj"), body.body().rest())?;
    for kind in GarmentKind::ALL {
        let template = Template::new(kind, arguments.vertices)?;
        let mut parameters = kind.parameters();
        for word in &arguments.parameters {
            if let Some((name, value)) = word.split_once('=')
                && parameters.get(name).is_ok()
            {
                parameters.set(name, value.parse()?)?;
            }
        }
        let garment = template.sewn(&parameters, &cut, &wearer)?;
        garment.write_obj(folder.join(format!("{kind}_start.obj")), &garment.start)?;
        write_obj(
            folder.join(format!("{kind}_flat.obj")),
            &garment.flat_mesh(),
        )?;
        picture(
            &garment,
            body.body().rest(),
            &folder.join(format!("{kind}.png")),
        )?;
        report(&garment, body.body().rest())?;
    }
    Ok(())
}

fn report(garment: &SewnGarment, body: &TriMesh) -> Result<(), Box<dyn Error>> {
    let surface = Surface::new(&garment.start_mesh());
    let crossing = surface.intersections(&Surface::new(body)).len();
    let own = surface.self_intersections().len();
    let mut stretch: Vec<f32> = Vec::new();
    let mut quality: Vec<f32> = Vec::new();
    for (face, flat) in garment.faces.iter().zip(&garment.flat) {
        let side = |i: usize| {
            let (p, q) = (flat[i], flat[(i + 1) % 3]);
            (p[0] - q[0]).hypot(p[1] - q[1])
        };
        let [a, b, c] = [side(0), side(1), side(2)];
        quality.push((b + c - a) * (c + a - b) * (a + b - c) / (a * b * c));
        for corner in 0..3 {
            let ends = [face[corner], face[(corner + 1) % 3]];
            let [p, q] = ends.map(|vertex| garment.start[vertex as usize]);
            stretch.push((p - q).norm() / side(corner));
        }
    }
    stretch.sort_by(f32::total_cmp);
    quality.sort_by(f32::total_cmp);
    let at = |values: &[f32], share: f32| values[(share * (values.len() - 1) as f32) as usize];
    writeln!(
        io::stdout().lock(),
        "{:<8} {:>6} vertices {:>6} faces  body {crossing}  self {own}  quality min {:.2} 1% {:.2} median {:.3}  stretch 1% {:.2} median {:.2} 99% {:.2} max {:.2}",
        garment.parameters.garment().name(),
        garment.num_vertices(),
        garment.faces.len(),
        quality[0],
        at(&quality, 0.01),
        at(&quality, 0.5),
        at(&stretch, 0.01),
        at(&stretch, 0.5),
        at(&stretch, 0.99),
        stretch[stretch.len() - 1],
    )?;
    Ok(())
}

fn picture(garment: &SewnGarment, body: &TriMesh, path: &Path) -> Result<(), Box<dyn Error>> {
    let start = (garment.start_mesh(), palette::GARMENT);
    let on_body = Scene {
        caption: String::new(),
        meshes: vec![(body.clone(), palette::SKIN), start],
        framed: 0,
    };
    let flat = Scene {
        caption: String::new(),
        meshes: vec![(garment.flat_mesh(), palette::GARMENT)],
        framed: 0,
    };
    let around = [
        Camera::front(),
        Camera::new(0.6, 0.2),
        Camera::left(),
        Camera::new(std::f32::consts::PI, 0.1),
    ];
    let mut sheet = Sheet::new(3, [500, 550]);
    sheet.add_row(on_body, &around);
    sheet.add_row(flat, &[Camera::front()]);
    sheet.write_png(path)?;
    Ok(())
}
