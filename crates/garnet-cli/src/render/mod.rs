//! `garnet render`: a shaded picture of meshes.

pub(crate) mod colors;
mod fit;
mod frames;
mod materials;
pub(crate) mod problems;
mod words;

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use garnet::{
    TriMesh,
    io::ObjFile,
    mesh::{Bounds, Unit},
};
use garnet_view::{Camera, Layer, Paint, Picture, Rgb, View, palette, render};
use rayon::prelude::*;

use crate::{
    console::{Console, print_document},
    failure::{ExitStatus, refused},
    moving::{Moving, frames_of, frames_per_second, told_notes},
    output,
    rig_args::RigArgs,
};
use colors::{ColorBy, Heatmap};
use frames::Drawn;
use materials::{Look, look_of};
pub(crate) use words::UpName;
use words::ViewName;

/// Arguments of `render`.
#[derive(Debug, Args)]
pub(crate) struct RenderArgs {
    /// Meshes, as OBJ, GLB, glTF or npz: garments, and the body last. Motions are folders of OBJ,
    /// npz with the vertices of all frames, or GLB whose meshes change their shapes. An OBJ whose
    /// materials have pictures (`map_Kd`) is drawn with them.
    #[arg(value_name = "MESH", required = true)]
    meshes: Vec<PathBuf>,
    /// Where the picture goes, as PNG; of a motion some frames side by side, or all as an animated
    /// GIF.
    #[arg(short, long, value_name = "PNG|GIF")]
    output: PathBuf,
    /// A body; then all of MESH are garments.
    #[arg(long, value_name = "OBJ")]
    body: Option<PathBuf>,
    /// How rigs are read.
    #[command(flatten)]
    rig: RigArgs,
    /// Sides to look from, with commas [default: front, three-quarter and back; front of the frames
    /// on a sheet; three-quarter of an animation].
    #[arg(long, value_name = "SIDE,...", value_delimiter = ',')]
    views: Vec<ViewName>,
    /// Frames a second of an animation [default: as the file says, else 25].
    #[arg(long, hide_short_help = true, value_name = "N", value_parser = frames_per_second, allow_negative_numbers = true)]
    fps: Option<f64>,
    /// Size of the picture in pixels [default: 600 for each view, by 800; less for frames].
    #[arg(long, value_name = "WxH", value_parser = words::size)]
    size: Option<[u32; 2]>,
    /// Color the first mesh: none, problems (where it runs through body or cloth, or is trapped),
    /// stretch=REST.obj, distance=BODY.obj, displacement=OTHER.obj, fit=PACKAGE or fit=PACKAGE@SIZE
    /// (of its garment, for the body) or file=VALUES.txt (one number for each vertex).
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

impl RenderArgs {
    /// The sides that are asked for, or else these.
    fn views_or(&self, usual: &[ViewName]) -> Vec<ViewName> {
        match self.views.as_slice() {
            [] => usual.to_vec(),
            asked => asked.to_vec(),
        }
    }
}

/// Sides of a picture of one frame.
const SIDES: [ViewName; 3] = [ViewName::Front, ViewName::ThreeQuarter, ViewName::Back];

const DEFAULT_SIZE: [u32; 2] = [600, 800];

/// Reads the meshes, colors the first, draws, writes.
pub(crate) fn run(args: &RenderArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    output::check_picture(&args.output)?;
    let paths: Vec<&PathBuf> = args.meshes.iter().chain(&args.body).collect();
    let read: Vec<&Path> = (paths.iter().map(|path| path.as_path()))
        .chain(args.color_by.file())
        .collect();
    output::check_apart(&[&args.output], &read)?;
    args.rig.check(paths.iter().copied())?;
    let (options, up) = (args.rig.clone().options(), args.up.axis());
    let moving: Vec<anyhow::Result<Moving>> = paths
        .par_iter()
        .map(|path| Moving::read(path, &options, up))
        .collect();
    let mut moving = moving.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    if moving.len() == 1 {
        moving = moving.remove(0).apart()?;
    }
    let names = frames_of(&moving)?;
    let looks: Vec<Look> = (moving.par_iter().enumerate())
        .map(|(index, mesh)| look_of(mesh.file(), color_of(index, moving.len())))
        .collect();
    check_options(args, !names.is_empty())?;
    let is_animated = args
        .output
        .extension()
        .is_some_and(|kind| kind.eq_ignore_ascii_case("gif"));
    let drawn = match (names.is_empty(), is_animated) {
        (true, false) => still(&moving, &looks, args)?,
        (true, true) => {
            return Err(refused(
                format!("`{}` would not move", args.output.display()),
                "the meshes have one frame",
                "name folders with an OBJ for each frame, or draw a PNG",
            ));
        }
        (false, true) => {
            frames::check(args)?;
            frames::animation(&moving, &looks, &names, args, console)?
        }
        (false, false) if args.color_by != ColorBy::Nothing && moving.iter().all(is_of_glb) => {
            let note = format!("the first of {} frames is drawn", names.len());
            let drawn = still(&moving, &looks, args)?;
            Drawn {
                note: drawn.note.or(Some(note)),
                ..drawn
            }
        }
        (false, false) => {
            frames::check(args)?;
            frames::sheet(&moving, &looks, &names, args)?
        }
    };
    output::write(&args.output, &drawn.bytes)?;
    let mut notes = told_notes(&moving, console);
    let of_looks = looks.into_iter().filter_map(|look| look.note);
    for note in of_looks.chain(drawn.note) {
        console.summary(&format_args!("note: {note}"));
        notes.push(note);
    }
    let [width, height] = drawn.size;
    let frames = match drawn.frames {
        [1, 1] => String::new(),
        [all, shown] => format!(", {shown} of {all} frames"),
    };
    console.summary(&format_args!(
        "drew {} in `{}`, {width} x {height} pixels{frames}",
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
            "frames": drawn.frames[1],
            "notes": notes,
        }))?;
    }
    Ok(ExitStatus::Done)
}

/// Whether a mesh keeps still, or is of a file of which one frame cannot be named.
fn is_of_glb(moving: &Moving) -> bool {
    let kind = moving.path().extension().unwrap_or_default();
    let is_glb = ["glb", "gltf"]
        .iter()
        .any(|other| kind.eq_ignore_ascii_case(other));
    moving.num_frames() == 1 || is_glb
}

/// Refuses options that would do nothing.
fn check_options(args: &RenderArgs, moves: bool) -> anyhow::Result<()> {
    let given = |option: &str, reason: &str, hint: &str| {
        Err(refused(
            format!("`{option}` is given, and does nothing"),
            reason,
            hint,
        ))
    };
    if args.range.is_some() && args.color_by == ColorBy::Nothing {
        return given(
            "--range",
            "there is no color bar",
            "say what the first mesh is colored by with `--color-by`, or leave it out",
        );
    }
    if args.fps.is_some() && !moves {
        return given("--fps", "the meshes do not move", "leave it out");
    }
    Ok(())
}

/// One frame, its first mesh colored.
fn still(moving: &[Moving], looks: &[Look], args: &RenderArgs) -> anyhow::Result<Drawn> {
    // The last of several meshes is the body.
    let body = moving[1..].last().map(Moving::file);
    let heat = Heatmap::new(&args.color_by, moving[0].file(), body)?;
    let meshes = moving.iter().map(Moving::upright);
    let meshes = meshes.collect::<anyhow::Result<Vec<_>>>()?;
    let views = args.views_or(&SIDES);
    let size = args.size.unwrap_or_else(|| {
        let [width, height] = DEFAULT_SIZE;
        [width.saturating_mul(views.len() as u32), height]
    });
    let image = render(&Picture {
        layers: layers(&meshes, looks, heat.as_ref(), args),
        views: views.iter().map(|name| view(*name, args.zoom)).collect(),
        ..Picture::new(size[0], size[1])
    })
    .with_context(|| format!("cannot draw `{}`", args.output.display()))?;
    let note = heat.as_ref().and_then(Heatmap::note);
    Ok(Drawn {
        note: note.map(str::to_owned),
        bytes: image.to_png_bytes()?,
        size,
        frames: [1, 1],
    })
}

/// Colors of garments, in their order.
pub(crate) const STRONG: [Rgb; 3] = [palette::GARMENT, palette::REFERENCE, palette::THIRD];

/// Strong colors for garments in their order, and that of skin for the body, which is the last of
/// several meshes.
fn color_of(index: usize, num_meshes: usize) -> Rgb {
    if index + 1 == num_meshes && index > 0 {
        palette::SKIN
    } else {
        STRONG[index % STRONG.len()]
    }
}

fn layers<'a>(
    meshes: &'a [TriMesh],
    looks: &'a [Look],
    heat: Option<&'a Heatmap>,
    args: &RenderArgs,
) -> Vec<Layer<'a>> {
    let layer = |(index, (mesh, look)): (usize, (&'a TriMesh, &'a Look))| {
        let paint = match (heat, &look.faces) {
            (Some(heat), _) if index == 0 => Paint::Heat(heat.heat(args.range)),
            (None, Some(materials)) => Paint::Materials(materials),
            _ => Paint::Plain(color_of(index, meshes.len())),
        };
        Layer {
            paint,
            wireframe: args.wireframe.then_some(palette::WIRE),
            ..Layer::new(mesh)
        }
    };
    meshes.iter().zip(looks).enumerate().map(layer).collect()
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
