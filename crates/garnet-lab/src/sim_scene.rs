//! Drapes of the teacher on poses of the built-in body, in numbers and pictures.
//!
//! Each pose is one line: time, strain, speeds and penetration; and of the quality `reference` how
//! far the teacher's drape is from balance.

use std::{
    error::Error,
    io::{self, Write},
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
    time::Instant,
};

use clap::Args;
use garnet::{
    body::{
        poses::{Poser, SelfContact, SeparationOptions, key_pose},
        shape::ParametricBody,
    },
    data::{Tailor, default_rest_body, usual_fabric, wearer_of},
    package::{BodyPath, Quality, quality_of},
    pattern::GarmentKind,
    sim::Drape,
};
use garnet_mesh::TriMesh;
use garnet_skin::{Body, Method, Pose};
use garnet_view::{Camera, palette};

use crate::{
    Outcome,
    sheet::{Scene, Sheet},
};

/// What to drape.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The garment.
    garment: GarmentKind,
    /// Its vertices.
    vertices: usize,
    /// Where pictures go.
    folder: PathBuf,
    /// Poses of the library.
    poses: Vec<String>,
    /// Quality of the simulation: fast, teacher or reference.
    #[arg(long, default_value = "teacher", value_parser = quality)]
    quality: Quality,
}

fn quality(name: &str) -> Result<Quality, String> {
    quality_of(name).ok_or_else(|| "expected fast, teacher or reference".to_owned())
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let kind = arguments.garment;
    let stop = AtomicBool::new(false);
    let body = ParametricBody::build(&default_rest_body())?.into_body();
    let wearer = wearer_of(&body).ok_or("the built-in body has measures")??;
    let tailor = Tailor::new(kind.parameters(), arguments.vertices, usual_fabric(kind))?;
    let worn = tailor.dress(&body, &wearer, &stop)?;
    let simulator = tailor.simulator(&worn, &body)?;
    let poser = Poser::new(body.skeleton())?;
    let contact = SelfContact::new(&body)?;
    let mut log = io::stdout().lock();
    for name in &arguments.poses {
        let key = key_pose(name).ok_or_else(|| format!("there is no pose `{name}`"))?;
        let pose = contact.separated(&poser.pose(&key.angles), &SeparationOptions::default())?;
        let Some(pose) = pose.map(|separated| separated.pose) else {
            writeln!(log, "{name}: the body cannot do this")?;
            continue;
        };
        let path = BodyPath::to_shape(&body, &body, &pose)?;
        let began = Instant::now();
        let drape = simulator.drape(&path, arguments.quality, &stop, &mut |_| {})?;
        let seconds = began.elapsed().as_secs_f64();
        writeln!(log, "{name}: {seconds:.2} s | {}", line(&drape))?;
        let mesh = TriMesh::new(drape.positions, worn.sewn.faces.clone())?;
        picture(
            &body,
            &pose,
            mesh,
            &arguments.folder.join(format!("{kind}_{name}.png")),
        )?;
    }
    Ok(())
}

fn line(drape: &Drape) -> String {
    let report = &drape.report;
    let (strain, speeds, inside) = (report.strain, report.speeds, report.penetration);
    let balance = report.balance.map_or_else(String::new, |found| {
        format!(
            "moved {:.2} mm to balance, {:.4} weights of a vertex left, {} held | ",
            1e3 * found.moved,
            found.settled.residual,
            found.held
        )
    });
    balance
        + &format!(
            "strain p50 {:.2} p99 {:.2} max {:.0} % | {:.2} % moving, at most {:.1} mm/s | {} inside, {} trapped, {} freed | {} crossings and {} squeezed",
            1e2 * strain.p50,
            1e2 * strain.p99,
            1e2 * strain.max,
            1e2 * speeds.share_moving,
            1e3 * speeds.max,
            inside.num_inside,
            inside.num_trapped,
            report.num_freed,
            report.self_intersections.num_free,
            report.self_intersections.num_squeezed,
        )
}

fn picture(body: &Body, pose: &Pose, garment: TriMesh, path: &Path) -> Result<(), Box<dyn Error>> {
    let posed = body.posed_positions(pose, Method::DualQuaternion)?;
    let skin = body.rest().with_positions(posed)?;
    let scene = Scene {
        caption: String::new(),
        meshes: vec![(skin, palette::SKIN), (garment, palette::GARMENT)],
        framed: 1,
    };
    let cameras = [(0.0, 0.1), (0.7, 0.15), (2.4, 0.1), (3.9, 0.1)];
    let mut sheet = Sheet::new(4, [450, 560]);
    sheet.add_row(
        scene,
        &cameras.map(|(around, above)| Camera::new(around, above)),
    );
    sheet.write_png(path)?;
    Ok(())
}
