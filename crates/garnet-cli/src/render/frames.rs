//! Pictures of several frames: a sheet of some, or all as an animation.

use anyhow::Context;
use garnet::{
    TriMesh,
    mesh::{Bounds, primitives::cuboid},
};
use garnet_view::{GifWriter, Layer, Picture, View, render};

use super::{Look, RenderArgs, layers, view, words::ViewName};
use crate::{console::Console, failure::refused, moving::Moving};

/// Frames a second of an animation whose files tell none.
const FPS: f64 = 25.0;

/// A sheet has at most so many frames.
const MOST_ON_SHEET: usize = 12;

/// Width and height of a view of a frame on a sheet, in pixels.
const CELL: [u32; 2] = [300, 400];

/// Width and height of an animation of one view, in pixels.
const FRAME: [u32; 2] = [480, 640];

/// A picture of frames, packed.
pub(super) struct Drawn {
    pub(super) bytes: Vec<u8>,
    pub(super) size: [u32; 2],
    /// How many frames there are, and how many are shown.
    pub(super) frames: [usize; 2],
    /// What is doubtful about its colors.
    pub(super) note: Option<String>,
}

/// All frames one after the other, as GIF. The camera keeps still.
pub(super) fn animation(
    moving: &[Moving],
    looks: &[Look],
    names: &[String],
    args: &RenderArgs,
    console: &Console,
) -> anyhow::Result<Drawn> {
    let views = args.views_or(&[ViewName::ThreeQuarter]);
    let size = args.size.unwrap_or_else(|| {
        let [width, height] = FRAME;
        [width.saturating_mul(views.len() as u32), height]
    });
    let frame = bounding_box(moving)?;
    let fps = args.fps.or(moving.iter().find_map(Moving::fps));
    let mut bytes = Vec::new();
    let mut gif = GifWriter::new(&mut bytes, fps.unwrap_or(FPS))?;
    let progress = console.progress(names.len());
    for number in 0..names.len() {
        let meshes = meshes_in(moving, number)?;
        let mut layers = layers(&meshes, looks, None, args);
        let shown: Vec<usize> = (0..layers.len()).collect();
        let framed = vec![layers.len()];
        layers.push(Layer::new(&frame));
        let views = views.iter().map(|name| View {
            shown: Some(shown.clone()),
            framed: Some(framed.clone()),
            ..view(*name, args.zoom)
        });
        let image = render(&Picture {
            layers,
            views: views.collect(),
            ..Picture::new(size[0], size[1])
        })
        .with_context(|| format!("cannot draw `{}`", args.output.display()))?;
        gif.push(&image)?;
        progress.inc(1);
    }
    progress.finish_and_clear();
    drop(gif);
    Ok(Drawn {
        bytes,
        size,
        frames: [names.len(); 2],
        note: None,
    })
}

/// Some frames, evenly chosen, the first and the last among them, each in a column.
pub(super) fn sheet(
    moving: &[Moving],
    looks: &[Look],
    names: &[String],
    args: &RenderArgs,
) -> anyhow::Result<Drawn> {
    let views = args.views_or(&[ViewName::Front]);
    let count = names.len().min(MOST_ON_SHEET);
    let chosen = (0..count).map(|place| place * (names.len() - 1) / (count - 1).max(1));
    let chosen: Vec<usize> = chosen.collect();
    let frames = chosen.iter().map(|&number| meshes_in(moving, number));
    let frames = frames.collect::<anyhow::Result<Vec<_>>>()?;
    let size = args.size.unwrap_or_else(|| {
        let [width, height] = CELL;
        let [columns, rows] = [count, views.len()].map(|count| count as u32);
        [width.saturating_mul(columns), height.saturating_mul(rows)]
    });
    let each = moving.len();
    let cells = views.iter().flat_map(|name| {
        let frames = chosen.iter().enumerate();
        frames.map(move |(place, &number)| View {
            caption: names[number].clone(),
            shown: Some((place * each..(place + 1) * each).collect()),
            ..view(*name, args.zoom)
        })
    });
    let image = render(&Picture {
        layers: frames
            .iter()
            .flat_map(|meshes| layers(meshes, looks, None, args))
            .collect(),
        views: cells.collect(),
        columns: Some(count as u32),
        ..Picture::new(size[0], size[1])
    })
    .with_context(|| format!("cannot draw `{}`", args.output.display()))?;
    Ok(Drawn {
        bytes: image.to_png_bytes()?,
        size,
        frames: [names.len(), count],
        note: None,
    })
}

/// Refuses what is of one frame alone.
pub(super) fn check(args: &RenderArgs) -> anyhow::Result<()> {
    if args.color_by != super::ColorBy::Nothing {
        return Err(refused(
            "frames cannot be colored",
            "`--color-by` is for one frame",
            "draw one, or write a page with `garnet view`, which colors all",
        ));
    }
    Ok(())
}

fn meshes_in(moving: &[Moving], number: usize) -> anyhow::Result<Vec<TriMesh>> {
    moving.iter().map(|mesh| mesh.upright_in(number)).collect()
}

/// A box round all meshes in all frames.
fn bounding_box(moving: &[Moving]) -> anyhow::Result<TriMesh> {
    let mut corners = Vec::new();
    for mesh in moving {
        for number in 0..mesh.num_frames() {
            let mesh = mesh.upright_in(number)?;
            let bounds = Bounds::of_faces(mesh.positions(), mesh.faces());
            corners.extend(
                bounds
                    .map(|bounds| [bounds.min, bounds.max])
                    .into_iter()
                    .flatten(),
            );
        }
    }
    let bounds = Bounds::of(&corners).unwrap_or_default();
    let unit = cuboid([1.0; 3]);
    let around = Bounds::of(unit.positions()).unwrap_or_default();
    let extent = bounds.extent();
    let places = unit.positions().iter().map(|place| {
        let share = place - around.min;
        bounds.min + share.component_mul(&extent)
    });
    Ok(unit.with_positions(places.collect())?)
}
