//! `garnet render`: a shaded picture of meshes.

pub(crate) mod colors;
mod fit;
pub(crate) mod problems;
mod words;

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use garnet::{
    TriMesh,
    io::{Frame, ObjFile, is_rig, read_mesh_of},
    mesh::{Bounds, Unit, UpAxis},
};
use garnet_view::{Camera, Layer, Paint, Picture, View, palette, render};
use rayon::prelude::*;

use crate::{
    console::{Console, print_document},
    failure::ExitStatus,
    output,
    rig_args::RigArgs,
};
use colors::{ColorBy, Heatmap};
pub(crate) use words::UpName;
use words::ViewName;

/// Arguments of `render`.
#[derive(Debug, Args)]
pub(crate) struct RenderArgs {
    /// Meshes, as OBJ, GLB, glTF or npz: garments, and the body last.
    #[arg(value_name = "MESH", required = true)]
    meshes: Vec<PathBuf>,
    /// Where the picture goes, as PNG.
    #[arg(short, long, value_name = "PNG")]
    output: PathBuf,
    /// A body; then all of MESH are garments.
    #[arg(long, value_name = "OBJ")]
    body: Option<PathBuf>,
    /// How rigs are read.
    #[command(flatten)]
    rig: RigArgs,
    /// Sides to look from, with commas.
    #[arg(
        long,
        value_name = "SIDE,...",
        value_delimiter = ',',
        default_value = "front,three-quarter,back"
    )]
    views: Vec<ViewName>,
    /// Size of the picture in pixels [default: 600 for each view, by 800].
    #[arg(long, value_name = "WxH", value_parser = words::size)]
    size: Option<[u32; 2]>,
    /// Color the first mesh: none, problems (where it runs through body or cloth, or is trapped),
    /// stretch=REST.obj, distance=BODY.obj, displacement=OTHER.obj, fit=PACKAGE (of its garment,
    /// for the body) or file=VALUES.txt (one number for each vertex).
    #[arg(long, value_name = "WHAT", default_value = "none", value_parser = colors::color_by)]
    color_by: ColorBy,
    /// Values at the ends of the color bar.
    #[arg(long, hide_short_help = true, value_name = "LO:HI", value_parser = words::range, allow_hyphen_values = true)]
    range: Option<[f32; 2]>,
    /// Draw the edges of the triangles.
    #[arg(long, hide_short_help = true)]
    wireframe: bool,
    /// Enlarge by this factor.
    #[arg(long, hide_short_help = true, value_name = "X", default_value = "1", value_parser = words::zoom, allow_negative_numbers = true)]
    zoom: f32,
    /// Axis that points up.
    #[arg(long, hide_short_help = true, value_name = "AXIS", default_value = "y")]
    up: UpName,
}

const DEFAULT_SIZE: [u32; 2] = [600, 800];

/// Reads the meshes, colors the first, draws, writes.
pub(crate) fn run(args: &RenderArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    output::check_png(&args.output)?;
    let paths: Vec<&PathBuf> = args.meshes.iter().chain(&args.body).collect();
    let read: Vec<&Path> = (paths.iter().map(|path| path.as_path()))
        .chain(args.color_by.file())
        .collect();
    output::check_apart(&[&args.output], &read)?;
    let up = args.up.axis();
    let options = args.rig.clone().options();
    let files: Vec<anyhow::Result<ObjFile>> = paths
        .par_iter()
        .map(|path| Ok(read_mesh_of(path, &options)?))
        .collect();
    let files = files.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    // The last of several meshes is the body.
    let body = files[1..].last();
    let heat = Heatmap::new(&args.color_by, &files[0], body)?;
    let upright = files.iter().map(|file| upright(file, up));
    let meshes = upright.collect::<anyhow::Result<Vec<_>>>()?;
    let [width, height] = args.size.unwrap_or_else(|| {
        let [width, height] = DEFAULT_SIZE;
        [width.saturating_mul(args.views.len() as u32), height]
    });
    let image = render(&Picture {
        layers: layers(&meshes, heat.as_ref(), args),
        views: args
            .views
            .iter()
            .map(|name| view(*name, args.zoom))
            .collect(),
        ..Picture::new(width, height)
    })
    .with_context(|| format!("cannot draw `{}`", args.output.display()))?;
    output::write(&args.output, &image.to_png_bytes()?)?;
    console.summary(&format_args!(
        "drew {} in `{}`, {width} x {height} pixels",
        shown(&paths),
        args.output.display()
    ));
    if console.is_json() {
        print_document(&serde_json::json!({
            "schema": "garnet.render/1",
            "output": args.output.display().to_string(),
            "meshes": paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
            "width": width,
            "height": height,
        }))?;
    }
    Ok(ExitStatus::Done)
}

/// Strong colors for garments in their order, and that of skin for the body, which is the last of
/// several meshes.
fn layers<'a>(
    meshes: &'a [TriMesh],
    heat: Option<&'a Heatmap>,
    args: &RenderArgs,
) -> Vec<Layer<'a>> {
    let strong = [palette::GARMENT, palette::REFERENCE, palette::THIRD];
    let last = meshes.len() - 1;
    let layer = |(index, mesh): (usize, &'a TriMesh)| {
        let is_body = index == last && last > 0;
        let paint = match heat {
            Some(heat) if index == 0 => Paint::Heat(heat.heat(args.range)),
            _ if is_body => Paint::Plain(palette::SKIN),
            _ => Paint::Plain(strong[index % strong.len()]),
        };
        Layer {
            paint,
            wireframe: args.wireframe.then_some(palette::WIRE),
            ..Layer::new(mesh)
        }
    };
    meshes.iter().enumerate().map(layer).collect()
}

fn view(name: ViewName, zoom: f32) -> View {
    View {
        caption: name.caption().to_owned(),
        ..View::new(Camera {
            zoom,
            ..name.camera()
        })
    }
}

/// The mesh with y up.
fn upright(file: &ObjFile, up: UpAxis) -> anyhow::Result<TriMesh> {
    let mesh = file
        .mesh()
        .with_context(|| format!("cannot read `{}`", file.path().display()))?;
    let unit = Unit::Metre;
    // Rigs have y up, whatever the OBJ files have.
    let up = if is_rig(file.path()) { UpAxis::Y } else { up };
    let (positions, faces) = mesh.into_parts();
    Ok(TriMesh::new(
        Frame { unit, up }.to_metres(positions),
        faces,
    )?)
}

/// How many metres one unit of a file is, if it is of the size of a person.
pub(crate) fn metres_of(file: &ObjFile) -> f32 {
    let named = Bounds::of_faces(file.positions(), &file.triangles());
    let extent = named.unwrap_or_default().extent();
    let unit = garnet::io::guess_body_unit(extent.max());
    unit.unwrap_or(Unit::Metre).in_metres()
}

fn shown(paths: &[&PathBuf]) -> String {
    let names = paths
        .iter()
        .map(|path| format!("`{}`", Path::display(path)));
    names.collect::<Vec<_>>().join(", ")
}
