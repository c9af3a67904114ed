//! Values for the vertices of a mesh, shown as colors.

use std::path::{Path, PathBuf};

use garnet::{
    Point3, TriMesh,
    io::{Frame, ObjFile, RigOptions, is_rig, read_mesh},
    knn::Surface,
    mesh::UpAxis,
};
use garnet_view::{ColorMap, Heat};

use super::{fit, metres_of, problems::problems};
use crate::{
    cut_args::{SizeChoice, size},
    failure::refused,
    hints::did_you_mean_or,
    input,
    models::package_or_file,
    moving::Moving,
};

/// What the first mesh is colored by.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum ColorBy {
    /// One color.
    Nothing,
    /// Mean stretch of the edges of each vertex against this mesh.
    Stretch(PathBuf),
    /// Distance to the surface of this mesh, negative inside.
    Distance(PathBuf),
    /// Distance to the same vertex of this mesh.
    Displacement(PathBuf),
    /// How the garment of this package, in a size if one is named, fits the body of the picture.
    Fit(PathBuf, Option<SizeChoice>),
    /// Numbers in this file.
    File(PathBuf),
    /// What is wrong with it on its body.
    Problems,
}

impl ColorBy {
    /// The file that it is read from, if it is.
    pub(crate) fn file(&self) -> Option<&Path> {
        match self {
            Self::Nothing | Self::Problems => None,
            Self::Stretch(path)
            | Self::Distance(path)
            | Self::Displacement(path)
            | Self::Fit(path, _)
            | Self::File(path) => Some(path),
        }
    }
}

/// The words of `--color-by`, without what follows them.
const NAMES: [&str; 7] = [
    "none",
    "problems",
    "stretch",
    "distance",
    "displacement",
    "fit",
    "file",
];

/// A package, with a size after an `@` unless that is a part of its name.
fn fit_of(text: &str) -> Result<ColorBy, String> {
    let package = |path: &str| match package_or_file(path) {
        Ok(folder) => folder,
    };
    match text.rsplit_once('@') {
        Some((path, named)) if !Path::new(text).exists() => {
            Ok(ColorBy::Fit(package(path), Some(size(named)?)))
        }
        _ => Ok(ColorBy::Fit(package(text), None)),
    }
}

pub(crate) fn color_by(text: &str) -> Result<ColorBy, String> {
    match text.split_once('=') {
        None if text == "none" => Ok(ColorBy::Nothing),
        None if text == "problems" => Ok(ColorBy::Problems),
        Some(("stretch", path)) => Ok(ColorBy::Stretch(path.into())),
        Some(("distance", path)) => Ok(ColorBy::Distance(path.into())),
        Some(("displacement", path)) => Ok(ColorBy::Displacement(path.into())),
        Some(("fit", path)) => fit_of(path),
        Some(("file", path)) => Ok(ColorBy::File(path.into())),
        found => {
            const EXPECTED: &str = "expected `none`, `problems`, `stretch=REST.obj`, \
                                    `distance=BODY.obj`, `displacement=OTHER.obj`, `fit=PACKAGE`, \
                                    `fit=PACKAGE@SIZE` or `file=VALUES.txt`";
            let name = found.map_or(text, |(name, _)| name);
            if NAMES.contains(&text) {
                return Err(format!("`{text}` needs a file after `=`: {EXPECTED}"));
            }
            Err(did_you_mean_or(name, NAMES, EXPECTED))
        }
    }
}

/// Distances beyond this have the color of the end of the bar, unless asked otherwise, in
/// millimetres.
const DISTANCES: [f32; 2] = [-20.0, 20.0];

/// How values are shown.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Scale {
    pub(crate) label: String,
    pub(crate) map: ColorMap,
    /// Values at the ends of the bar; where none is given, those of the mesh.
    pub(crate) range: Option<[f32; 2]>,
}

impl Scale {
    /// Of the stretch of edges, in percent.
    pub(crate) fn stretch() -> Self {
        Self {
            label: "stretch (%)".to_owned(),
            map: ColorMap::CoolWarm,
            range: None,
        }
    }

    /// Of distances to the skin, in millimetres.
    pub(crate) fn distance() -> Self {
        Self {
            label: "to the skin (mm)".to_owned(),
            map: ColorMap::CoolWarm,
            range: Some(DISTANCES),
        }
    }

    /// Of how a garment fits.
    pub(crate) fn fit() -> Self {
        Self {
            label: "fit".to_owned(),
            map: ColorMap::Fit,
            range: None,
        }
    }

    /// Of what is wrong.
    pub(crate) fn problems() -> Self {
        Self {
            label: "problems".to_owned(),
            map: ColorMap::Problems,
            range: None,
        }
    }
}

/// The body that a garment is on.
#[derive(Debug)]
pub(crate) struct Skin {
    path: PathBuf,
    surface: Surface,
    /// How many metres a unit of its file is.
    metres: f32,
}

impl Skin {
    /// Of a body whose vertices are at `positions`, in the unit of its file.
    pub(crate) fn new(body: &ObjFile, positions: &[Point3]) -> anyhow::Result<Self> {
        let mesh = body.mesh()?.with_positions(positions.to_vec())?;
        Ok(Self {
            path: body.path().to_path_buf(),
            surface: Surface::new(&mesh),
            metres: metres_of(body),
        })
    }

    /// Where its vertices are, in metres with y up.
    fn in_metres(&self) -> Vec<Point3> {
        let (positions, faces) = (self.surface.positions(), self.surface.faces());
        let mesh = TriMesh::new(positions.to_vec(), faces.to_vec());
        let frame = mesh.as_ref().map_or(Frame::OURS, Frame::detected);
        frame.to_metres(positions.to_vec())
    }

    /// What is wrong with a garment of the same unit.
    fn problems(&self, positions: &[Point3], faces: &[[u32; 3]]) -> anyhow::Result<Vec<f32>> {
        let scaled = |points: &[Point3]| -> Vec<Point3> {
            points.iter().map(|point| point * self.metres).collect()
        };
        let skin = self.surface.moved(scaled(self.surface.positions()))?;
        problems(&scaled(positions), faces, &skin)
    }
}

/// What a mesh is colored by.
#[derive(Debug)]
pub(crate) struct Values {
    /// `[vertex]`
    pub(crate) of_vertices: Vec<f32>,
    /// What is doubtful about them.
    pub(crate) note: Option<String>,
}

/// What meshes are colored by, read once.
#[derive(Debug)]
pub(crate) enum Measure {
    /// Mean stretch of the edges of each vertex against a mesh.
    Stretch(ObjFile),
    /// Distance to a skin, of which a unit is so many millimetres.
    Distance(Box<Surface>, f32),
    /// Distance to the same vertex of a mesh.
    Displacement(ObjFile),
    /// How the garment of a package fits.
    Fit(PathBuf, Option<SizeChoice>),
    /// The numbers of a file.
    Numbers(PathBuf),
    /// Distance to the body that the mesh is on.
    ToSkin,
    /// What is wrong on that body.
    Problems,
}

impl Measure {
    /// Reads what is needed; nothing for [`ColorBy::Nothing`].
    pub(crate) fn read(color_by: &ColorBy) -> anyhow::Result<Option<Self>> {
        Ok(Some(match color_by {
            ColorBy::Nothing => return Ok(None),
            ColorBy::Stretch(path) => Self::Stretch(garment_in(path)?),
            ColorBy::Distance(path) => {
                let body = body_in(path)?;
                let skin = Surface::new(&body.mesh()?);
                Self::Distance(Box::new(skin), 1e3 * metres_of(&body))
            }
            ColorBy::Displacement(path) => Self::Displacement(garment_in(path)?),
            ColorBy::Fit(path, size) => Self::Fit(path.clone(), *size),
            ColorBy::File(path) => Self::Numbers(path.clone()),
            ColorBy::Problems => Self::Problems,
        }))
    }

    pub(crate) fn scale(&self) -> Scale {
        let viridis = |label| Scale {
            label,
            map: ColorMap::Viridis,
            range: None,
        };
        match self {
            Self::Stretch(_) => Scale::stretch(),
            Self::Distance(..) | Self::ToSkin => Scale::distance(),
            Self::Problems => Scale::problems(),
            Self::Fit(..) => Scale::fit(),
            Self::Displacement(_) => viridis("displacement (mm)".to_owned()),
            Self::Numbers(path) => {
                let stem = path.file_stem().unwrap_or_default();
                viridis(stem.to_string_lossy().into_owned())
            }
        }
    }

    /// Whether it depends on the body that the mesh is on.
    pub(crate) fn needs_skin(&self) -> bool {
        matches!(self, Self::ToSkin | Self::Problems | Self::Fit(..))
    }

    /// Whether it is the same in all frames: a wearer has one girth.
    pub(crate) fn is_of_wearer(&self) -> bool {
        matches!(self, Self::Fit(..))
    }

    /// A value for each vertex of a mesh that is at `positions`, in the unit of its file, on a
    /// body.
    pub(crate) fn values(
        &self,
        file: &ObjFile,
        positions: &[Point3],
        skin: Option<&Skin>,
    ) -> anyhow::Result<Values> {
        let on_body = || {
            skin.ok_or_else(|| {
                refused(
                    format!("`{}` cannot be colored", file.path().display()),
                    "problems are looked for on a body, and there is none",
                    "name the body as the last mesh, or with `--body`",
                )
            })
        };
        let mut note = None;
        let of_vertices = match self {
            Self::ToSkin => {
                let skin = on_body()?;
                distances(positions, &skin.surface, 1e3 * skin.metres)
            }
            Self::Problems => on_body()?.problems(positions, &file.triangles())?,
            Self::Stretch(rest) => {
                check_same_vertices(file, rest)?;
                mean_stretches(&file.polygon_edges(), rest.positions(), positions)
            }
            Self::Distance(skin, millimetres) => distances(positions, skin, *millimetres),
            Self::Displacement(other) => {
                check_same_vertices(file, other)?;
                let millimetres = 1e3 * metres_of(file);
                let pairs = positions.iter().zip(other.positions());
                pairs.map(|(a, b)| millimetres * (a - b).norm()).collect()
            }
            Self::Fit(package, size) => {
                let body = skin.map(|skin| (skin.path.as_path(), skin.in_metres()));
                let (levels, found) = fit::levels((package, *size), file, body)?;
                note = found;
                levels
            }
            Self::Numbers(path) => numbers(path, file.num_vertices())?,
        };
        Ok(Values { of_vertices, note })
    }
}

/// Values `[vertex]` and how they are shown.
#[derive(Debug)]
pub(crate) struct Heatmap {
    values: Values,
    scale: Scale,
}

impl Heatmap {
    /// Of a mesh on a body.
    pub(crate) fn new(
        color_by: &ColorBy,
        file: &ObjFile,
        body: Option<&ObjFile>,
    ) -> anyhow::Result<Option<Self>> {
        let Some(measure) = Measure::read(color_by)? else {
            return Ok(None);
        };
        let body = body.filter(|_| measure.needs_skin());
        let skin = body
            .map(|body| Skin::new(body, body.positions()))
            .transpose()?;
        Ok(Some(Self {
            values: measure.values(file, file.positions(), skin.as_ref())?,
            scale: measure.scale(),
        }))
    }

    /// What is doubtful about the colors.
    pub(crate) fn note(&self) -> Option<&str> {
        self.values.note.as_deref()
    }

    pub(crate) fn heat(&self, range: Option<[f32; 2]>) -> Heat<'_> {
        Heat {
            map: self.scale.map,
            range: range.or(self.scale.range),
            ..Heat::new(&self.values.of_vertices, &self.scale.label)
        }
    }
}

/// The mesh of a file; of a drape and its body in a GLB, the drape.
fn garment_in(path: &Path) -> anyhow::Result<ObjFile> {
    Ok(meshes_in(path)?.swap_remove(0))
}

/// The mesh of a file; of a drape and its body in a GLB, the body.
fn body_in(path: &Path) -> anyhow::Result<ObjFile> {
    let mut meshes = meshes_in(path)?;
    Ok(meshes.swap_remove(meshes.len() - 1))
}

/// One mesh, or a drape and its body, as they are in the first frame.
fn meshes_in(path: &Path) -> anyhow::Result<Vec<ObjFile>> {
    if !is_rig(path) {
        return Ok(vec![read_mesh(path)?]);
    }
    let moving = Moving::read(path, &RigOptions::default(), UpAxis::Y)?;
    let meshes = moving.apart()?.into_iter();
    Ok(meshes.map(Moving::into_file).collect())
}

fn check_same_vertices(file: &ObjFile, other: &ObjFile) -> anyhow::Result<()> {
    let (expected, found) = (file.num_vertices(), other.num_vertices());
    if found == expected {
        return Ok(());
    }
    Err(refused(
        format!(
            "`{}` cannot be compared with `{}`",
            file.path().display(),
            other.path().display()
        ),
        format!("they have {expected} and {found} vertices"),
        "compare with the same mesh in another state, such as the garment before draping",
    ))
}

/// Mean stretch of the edges of each vertex, in percent; 0 of no edge.
pub(crate) fn mean_stretches(
    edges: &[[u32; 2]],
    rest: &[Point3],
    positions: &[Point3],
) -> Vec<f32> {
    let mut sums = vec![(0.0_f32, 0.0_f32); positions.len()];
    for &[a, b] in edges {
        let length = |positions: &[Point3]| (positions[a as usize] - positions[b as usize]).norm();
        let rest_length = length(rest);
        if rest_length > 0.0 {
            let percent = 100.0 * (length(positions) / rest_length - 1.0);
            for vertex in [a, b] {
                sums[vertex as usize].0 += percent;
                sums[vertex as usize].1 += 1.0;
            }
        }
    }
    let mean = |(sum, count): (f32, f32)| sum / count.max(1.0);
    sums.into_iter().map(mean).collect()
}

/// Distances to the skin, negative inside, times how many millimetres a unit is.
pub(crate) fn distances(positions: &[Point3], skin: &Surface, millimetres: f32) -> Vec<f32> {
    let is_inside = skin.contains_all(positions);
    let closest = skin.closest_all(positions);
    let signed = closest.iter().zip(is_inside).map(|(closest, inside)| {
        let distance = millimetres * closest.distance_squared.sqrt();
        if inside { -distance } else { distance }
    });
    signed.collect()
}

fn numbers(path: &Path, expected: usize) -> anyhow::Result<Vec<f32>> {
    let shown = path.display();
    let text = input::text(path)?;
    let mut values = Vec::with_capacity(expected);
    for (line, words) in text.lines().enumerate() {
        for word in words.split_whitespace() {
            let value = word.parse().ok().ok_or_else(|| {
                refused(
                    format!("cannot read `{shown}`"),
                    format!("line {}: `{word}` is not a number", line + 1),
                    "the file has one number for each vertex, in their order",
                )
            })?;
            values.push(value);
        }
    }
    if values.len() == expected {
        return Ok(values);
    }
    Err(refused(
        format!("`{shown}` does not fit the mesh"),
        format!(
            "it has {} numbers, the mesh has {expected} vertices",
            values.len()
        ),
        "the file has one number for each vertex, in their order",
    ))
}
