//! `garnet view`: a page that shows meshes in a browser.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use garnet::{Point3, TriMesh};
use garnet_view::{Coloring, Page, PageMesh, PagePane, PagePart, palette};
use rayon::prelude::*;

use crate::{
    console::{Console, print_document},
    failure::{ExitStatus, refused},
    moving::{Moving, frames_of, frames_per_second, told_notes},
    output,
    render::{
        STRONG, UpName,
        colors::{ColorBy, Measure, Scale, Skin, Values, color_by},
    },
    rig_args::RigArgs,
};

/// Arguments of `view`.
#[derive(Debug, Args)]
#[command(after_long_help = LONG_HELP)]
pub(crate) struct ViewArgs {
    /// Meshes, as OBJ, GLB, glTF or npz: garments, each in a pane of its own, and the body last. A
    /// folder with an OBJ for each frame, an npz of all frames or a GLB whose meshes change their
    /// shapes is a motion.
    #[arg(value_name = "MESH", required = true)]
    meshes: Vec<PathBuf>,
    /// Where the page goes, as HTML.
    #[arg(short, long, value_name = "HTML")]
    output: PathBuf,
    /// A body, beside which all of MESH are garments; named again, a body for each, in their order.
    #[arg(long, value_name = "OBJ")]
    body: Vec<PathBuf>,
    /// How rigs are read.
    #[command(flatten)]
    rig: RigArgs,
    /// What the garments are called, with commas [default: their files].
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    names: Vec<String>,
    /// A coloring to choose: stretch=REST.obj, distance=BODY.obj, displacement=OTHER.obj,
    /// fit=PACKAGE or fit=PACKAGE@SIZE (of its garment, for the body) or file=VALUES.txt (one
    /// number for each vertex); several by naming it again. On a body there are its distance and
    /// problems, too; none leaves them out.
    #[arg(long, value_name = "WHAT", value_parser = color_by)]
    color_by: Vec<ColorBy>,
    /// Frames a second of a motion [default: those of an npz, else 30].
    #[arg(long, hide_short_help = true, value_name = "N", value_parser = frames_per_second, allow_negative_numbers = true)]
    fps: Option<f64>,
    /// What stands above the page [default: the names].
    #[arg(long, hide_short_help = true, value_name = "TEXT")]
    title: Option<String>,
    /// Axis that points up.
    #[arg(long, hide_short_help = true, value_name = "AXIS", default_value = "y")]
    up: UpName,
}

const LONG_HELP: &str = "\
The page is one file that any browser opens, without a network. In it, `?` lists the keys.";

/// Refuses a rate of frames where there are none.
fn check_fps(args: &ViewArgs, num_frames: usize) -> anyhow::Result<()> {
    if args.fps.is_some() && num_frames < 2 {
        return Err(refused(
            "`--fps` is given, and does nothing",
            "the meshes do not move",
            "leave it out",
        ));
    }
    Ok(())
}

/// Browsers open larger pages slowly, in bytes.
const LARGE: usize = 20_000_000;

/// Reads the meshes, measures what they can be colored by, writes.
pub(crate) fn run(args: &ViewArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    output::check_page(&args.output)?;
    let (garments, bodies) = parts(args)?;
    let files = args.color_by.iter().filter_map(ColorBy::file);
    let read = garments.iter().chain(bodies).map(PathBuf::as_path);
    let read: Vec<&Path> = read.chain(files).collect();
    output::check_apart(&[&args.output], &read)?;
    let paths: Vec<&PathBuf> = garments.iter().chain(bodies).collect();
    args.rig.check(paths.iter().copied())?;
    let (moving, bodies) = read_all(args, &paths, bodies)?;
    let bodies = &bodies[..];
    let frames = frames_of(&moving)?;
    check_fps(args, frames.len())?;
    let (of_garments, of_bodies) = moving.split_at(garments.len());
    let body_of = |garment: usize| match of_bodies {
        [] => None,
        [one] => Some(one),
        each => Some(&each[garment]),
    };
    let measures = measures(&args.color_by, !bodies.is_empty())?;
    let mut doubts = Vec::new();
    let mut colorings = |(index, garment): (usize, &Moving)| -> anyhow::Result<Vec<Coloring>> {
        let all = measures.iter().map(|(measure, scale)| {
            let (values, note) = values_of(measure, garment, body_of(index))?;
            doubts.extend(note.filter(|note| !doubts.contains(note)));
            Ok(Coloring {
                label: scale.label.clone(),
                map: scale.map,
                range: scale.range,
                values,
            })
        });
        all.collect()
    };
    let colorings: Vec<anyhow::Result<Vec<Coloring>>> =
        of_garments.iter().enumerate().map(&mut colorings).collect();
    let colorings = colorings.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    let names = names_of(args, garments)?;
    let title = args
        .title
        .clone()
        .unwrap_or_else(|| title_of(&names, bodies));
    let meshes = moving.iter().map(Moving::upright);
    let meshes: Vec<TriMesh> = meshes.collect::<anyhow::Result<_>>()?;
    let page = Page {
        meshes: page_meshes(&names, bodies, &moving, &meshes, colorings),
        panes: panes(&names, bodies.len()),
        fps: args
            .fps
            .or(moving.iter().find_map(Moving::fps))
            .unwrap_or(30.0),
        frames,
        ..Page::new(title)
    };
    let bytes = write_page(&args.output, &page, console)?;
    let mut notes = told_notes(&moving, console);
    for doubt in doubts {
        console.summary(&format_args!("note: {doubt}"));
        notes.push(doubt);
    }
    let num_frames = page.frames.len().max(1);
    tell_written(
        &args.output,
        [page.meshes.len(), num_frames, bytes],
        console,
    );
    if console.is_json() {
        print_document(&serde_json::json!({
            "schema": "garnet.view/1",
            "output": args.output.display().to_string(),
            "meshes": paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
            "frames": num_frames,
            "bytes": bytes,
            "notes": notes,
        }))?;
    }
    Ok(ExitStatus::Done)
}

/// Reads all meshes. A file that holds a drape and its body has a body of its own.
fn read_all(
    args: &ViewArgs,
    paths: &[&PathBuf],
    bodies: &[PathBuf],
) -> anyhow::Result<(Vec<Moving>, Vec<PathBuf>)> {
    let (options, up) = (args.rig.clone().options(), args.up.axis());
    let moving: Vec<anyhow::Result<Moving>> = (paths.par_iter())
        .map(|path| Moving::read(path, &options, up))
        .collect();
    let mut moving = moving.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    let mut bodies = bodies.to_vec();
    if moving.len() == 1 {
        moving = moving.remove(0).apart()?;
        bodies.extend((1..moving.len()).map(|_| PathBuf::from("body")));
    }
    Ok((moving, bodies))
}

fn tell_written(path: &Path, [meshes, frames, bytes]: [usize; 3], console: &Console) {
    console.summary(&format_args!(
        "wrote `{}`: {meshes} {}, {frames} {}, {:.2} MB",
        path.display(),
        if meshes == 1 { "mesh" } else { "meshes" },
        if frames == 1 { "frame" } else { "frames" },
        1e-6 * bytes as f64
    ));
}

/// Garments and bodies: the last of several meshes is the body, unless it is named as such.
fn parts(args: &ViewArgs) -> anyhow::Result<(&[PathBuf], &[PathBuf])> {
    let (garments, bodies) = match &args.meshes[..] {
        [garments @ .., body] if !garments.is_empty() && args.body.is_empty() => {
            (garments, std::slice::from_ref(body))
        }
        garments => (garments, &args.body[..]),
    };
    if bodies.len() > 1 && bodies.len() != garments.len() {
        return Err(refused(
            "each garment needs a body",
            format!(
                "there are {} garments and {} bodies",
                garments.len(),
                bodies.len()
            ),
            "name one `--body` for all garments, or one for each",
        ));
    }
    Ok((garments, bodies))
}

/// What is to be measured, each under a label of its own: on a body distance and problems, unless
/// they are asked for or left out, and what is asked for.
fn measures(color_by: &[ColorBy], is_on_body: bool) -> anyhow::Result<Vec<(Measure, Scale)>> {
    let is_asked = |is: fn(&ColorBy) -> bool| color_by.iter().any(is);
    let mut all = Vec::new();
    if is_on_body && !is_asked(|by| *by == ColorBy::Nothing) {
        if !is_asked(|by| matches!(by, ColorBy::Distance(_))) {
            all.push((Measure::ToSkin, None));
        }
        if !is_asked(|by| *by == ColorBy::Problems) {
            all.push((Measure::Problems, None));
        }
    }
    for by in color_by {
        all.extend(Measure::read(by)?.map(|measure| (measure, by.file())));
    }
    let mut measures: Vec<(Measure, Scale)> = Vec::with_capacity(all.len());
    for (measure, file) in all {
        let mut scale = measure.scale();
        let is_taken = measures.iter().any(|(_, other)| other.label == scale.label);
        if let Some(path) = file.filter(|_| is_taken) {
            scale.label = format!("{}: {}", scale.label, path.display());
        }
        measures.push((measure, scale));
    }
    Ok(measures)
}

/// Values `[frame][vertex]` of a garment, in each frame in which they may differ, and what is
/// doubtful about them.
fn values_of(
    measure: &Measure,
    garment: &Moving,
    body: Option<&Moving>,
) -> anyhow::Result<(Vec<Vec<f32>>, Option<String>)> {
    let body = body.filter(|_| measure.needs_skin());
    let frames = garment.num_frames().max(body.map_or(1, Moving::num_frames));
    let count = if measure.is_of_wearer() { 1 } else { frames };
    let values = (0..count).into_par_iter().map(|frame| {
        let skin = body.map(|body| Skin::new(body.file(), body.positions(frame)));
        let skin = skin.transpose()?;
        measure.values(garment.file(), garment.positions(frame), skin.as_ref())
    });
    let values: Vec<anyhow::Result<Values>> = values.collect();
    let values = values.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    let note = values.iter().find_map(|values| values.note.clone());
    let values = values.into_iter().map(|values| values.of_vertices);
    Ok((values.collect(), note))
}

/// What the garments are called: as asked for, or by their files, with folders where those alone
/// differ.
fn names_of(args: &ViewArgs, garments: &[PathBuf]) -> anyhow::Result<Vec<String>> {
    let expected = garments.len();
    if !args.names.is_empty() {
        let found = args.names.len();
        if found != expected {
            return Err(refused(
                "`--names` has one for each garment",
                format!("there are {found} names and {expected} garments"),
                "name each garment, with commas between",
            ));
        }
        return Ok(args.names.clone());
    }
    let stems: Vec<String> = garments.iter().map(|path| stem_of(path)).collect();
    let is_told = |stem: &String| stems.iter().filter(|other| *other == stem).count() == 1;
    let named = |(path, stem): (&PathBuf, &String)| {
        let folder = path.parent().and_then(Path::file_name);
        match folder {
            Some(folder) if !is_told(stem) => format!("{}/{stem}", folder.to_string_lossy()),
            _ => stem.clone(),
        }
    };
    Ok(garments.iter().zip(&stems).map(named).collect())
}

fn stem_of(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or(path.as_os_str());
    stem.to_string_lossy().into_owned()
}

fn title_of(names: &[String], bodies: &[PathBuf]) -> String {
    let names = names.join(", ");
    match bodies {
        [body] => format!("{names} on {}", stem_of(body)),
        _ => names,
    }
}

/// Garments in strong colors, in their order, and then bodies in that of skin.
fn page_meshes<'a>(
    names: &[String],
    bodies: &[PathBuf],
    moving: &[Moving],
    meshes: &'a [TriMesh],
    colorings: Vec<Vec<Coloring>>,
) -> Vec<PageMesh<'a>> {
    let bodies = bodies.iter().map(|path| (stem_of(path), PagePart::Body));
    let garments = names.iter().map(|name| (name.clone(), PagePart::Garment));
    let mut colorings = colorings.into_iter();
    let mesh = |(index, (name, part)): (usize, (String, PagePart))| PageMesh {
        later: moving[index].later_upright(),
        colorings: colorings.next().unwrap_or_default(),
        ..PageMesh::new(
            name,
            part,
            match part {
                PagePart::Garment => STRONG[index % STRONG.len()],
                PagePart::Body => palette::SKIN,
            },
            &meshes[index],
        )
    };
    garments.chain(bodies).enumerate().map(mesh).collect()
}

/// A pane for each garment, with its body.
fn panes(names: &[String], num_bodies: usize) -> Vec<PagePane> {
    let pane = |(garment, name): (usize, &String)| {
        let body = match num_bodies {
            0 => None,
            1 => Some(names.len()),
            _ => Some(names.len() + garment),
        };
        PagePane {
            name: name.clone(),
            meshes: std::iter::once(garment).chain(body).collect(),
        }
    };
    names.iter().enumerate().map(pane).collect()
}

/// A drape on its bodies, frame by frame, in metres with y up.
pub(crate) struct Drapes<'a> {
    /// What is draped.
    pub(crate) name: String,
    /// The garment, for its faces.
    pub(crate) garment: &'a [[u32; 3]],
    /// The body, for its faces.
    pub(crate) body: &'a [[u32; 3]],
    /// Positions `[frame][vertex]` of the garment.
    pub(crate) cloth: Vec<Vec<Point3>>,
    /// Positions `[frame][vertex]` of the body.
    pub(crate) skin: Vec<Vec<Point3>>,
    pub(crate) colorings: Vec<Coloring>,
    /// Names of the frames.
    pub(crate) frames: Vec<String>,
    pub(crate) fps: f64,
}

/// Writes a page of drapes on one body, the inner first.
pub(crate) fn write_drapes(
    mut all: Vec<Drapes<'_>>,
    path: &Path,
    console: &Console,
) -> anyhow::Result<()> {
    let shapes = |frames: &[Vec<Point3>], faces: &[[u32; 3]]| {
        let first = frames.first().context("there is no drape to show")?;
        anyhow::Ok(TriMesh::new(first.clone(), faces.to_vec())?)
    };
    let inner = all.first_mut().context("there is no drape to show")?;
    let body = shapes(&inner.skin, inner.body)?;
    let skin = std::mem::take(&mut inner.skin)
        .into_iter()
        .skip(1)
        .collect();
    let (frames, fps) = (inner.frames.clone(), inner.fps);
    let garments = all
        .iter()
        .map(|drapes| shapes(&drapes.cloth, drapes.garment));
    let garments = garments.collect::<anyhow::Result<Vec<_>>>()?;
    let names: Vec<String> = all.iter().map(|drapes| drapes.name.clone()).collect();
    let mut meshes = Vec::with_capacity(all.len() + 1);
    for (place, (drapes, garment)) in all.into_iter().zip(&garments).enumerate() {
        let color = STRONG[place % STRONG.len()];
        meshes.push(PageMesh {
            later: drapes.cloth.into_iter().skip(1).collect(),
            colorings: drapes.colorings,
            ..PageMesh::new(drapes.name, PagePart::Garment, color, garment)
        });
    }
    meshes.push(PageMesh {
        later: skin,
        ..PageMesh::new("body", PagePart::Body, palette::SKIN, &body)
    });
    let name = names.join(", ");
    let page = Page {
        panes: vec![PagePane {
            name: name.clone(),
            meshes: (0..meshes.len()).collect(),
        }],
        meshes,
        frames: if frames.len() > 1 { frames } else { Vec::new() },
        fps,
        ..Page::new(&name)
    };
    write_page(path, &page, console)?;
    Ok(())
}

/// Writes a page, and tells how many bytes it has.
fn write_page(path: &Path, page: &Page<'_>, console: &Console) -> anyhow::Result<usize> {
    let html = page.to_html();
    let html = html.with_context(|| format!("cannot show `{}`", path.display()))?;
    output::write(path, html.as_bytes())?;
    if html.len() > LARGE {
        console.warning(&format_args!(
            "`{}` has {:.0} MB, which browsers open slowly: take fewer frames, as FIRST:END:STEP",
            path.display(),
            1e-6 * html.len() as f64
        ));
    }
    Ok(html.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_files_share_get_their_folders() {
        let args = |names: &[&str]| ViewArgs {
            meshes: Vec::new(),
            output: PathBuf::new(),
            body: Vec::new(),
            rig: RigArgs::default(),
            names: names.iter().map(|name| (*name).to_owned()).collect(),
            color_by: Vec::new(),
            fps: None,
            title: None,
            up: UpName::Y,
        };
        let named = |paths: &[&str]| {
            let paths: Vec<PathBuf> = paths.iter().map(PathBuf::from).collect();
            names_of(&args(&[]), &paths).unwrap()
        };
        assert_eq!(named(&["a/fast.obj", "b/warp.obj"]), ["fast", "warp"]);
        assert_eq!(named(&["a/x.obj", "b/x.obj"]), ["a/x", "b/x"]);
        assert_eq!(named(&["x.obj", "b/x.obj", "walk/"]), ["x", "b/x", "walk"]);
        assert!(names_of(&args(&["one"]), &["x".into(), "y".into()]).is_err());
    }
}
