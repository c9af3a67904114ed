//! The garments of the built-in patterns, in the flat and around a body, as OBJ and PNG:
//! `cargo run --release -p garnet-tests --example pattern_sheet -- FOLDER SEX,STATURE,BMI [VERTICES] [SIZE] [NAME=VALUE]…`.
//!
//! Without a SIZE the garments are made to measure. Stature and values of parameters are in metres
//! or shares.

use std::{
    env,
    error::Error,
    fs,
    io::{self, Write},
    path::Path,
};

use garnet::io::write_obj;
use garnet::{
    data::wearer_of,
    shape::{BodyParameters, Measure, ParametricBody},
};
use garnet_knn::Surface;
use garnet_mesh::TriMesh;
use garnet_pattern::{GarmentKind, SewnGarment, Size, Template};
use garnet_tests::{Scene, Sheet};
use garnet_view::{Camera, palette};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [folder, shape, rest @ ..] = arguments.as_slice() else {
        return Err(
            "usage: pattern_sheet FOLDER SEX,STATURE,BMI [VERTICES] [SIZE] [NAME=VALUE]…".into(),
        );
    };
    let numbers: Vec<f64> = shape.split(',').map(str::parse).collect::<Result<_, _>>()?;
    let [sex, stature, bmi] = *numbers.as_slice() else {
        return Err("SEX,STATURE,BMI are three numbers".into());
    };
    let parameters = BodyParameters::new(sex)
        .with(Measure::Stature, stature)
        .with_bmi(bmi);
    let body = ParametricBody::build(&parameters)?;
    let wearer = wearer_of(body.body()).ok_or("the built-in body has measures")??;
    let vertices = rest.iter().find_map(|word| word.parse().ok());
    let size: Option<Size> = rest.iter().find_map(|word| word.parse().ok());
    let cut = size.map_or(wearer.measures, Size::measures);

    fs::create_dir_all(folder)?;
    let folder = Path::new(folder);
    write_obj(folder.join("body.obj"), body.body().rest())?;
    for kind in GarmentKind::ALL {
        let template = Template::new(kind, vertices.unwrap_or(5000))?;
        let mut parameters = kind.parameters();
        for word in rest {
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
