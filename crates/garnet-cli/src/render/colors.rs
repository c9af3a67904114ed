//! Values for the vertices of a mesh, shown as colors.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::Context;
use garnet::{
    Point3,
    io::{ObjFile, read_mesh},
    knn::Surface,
};
use garnet_view::{ColorMap, Heat};

use super::metres_of;
use crate::failure::refused;

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
    /// Numbers in this file.
    File(PathBuf),
}

impl ColorBy {
    /// The file that it is read from, if it is.
    pub(super) fn file(&self) -> Option<&Path> {
        match self {
            Self::Nothing => None,
            Self::Stretch(path)
            | Self::Distance(path)
            | Self::Displacement(path)
            | Self::File(path) => Some(path),
        }
    }
}

pub(crate) fn color_by(text: &str) -> Result<ColorBy, String> {
    match text.split_once('=') {
        None if text == "none" => Ok(ColorBy::Nothing),
        Some(("stretch", path)) => Ok(ColorBy::Stretch(path.into())),
        Some(("distance", path)) => Ok(ColorBy::Distance(path.into())),
        Some(("displacement", path)) => Ok(ColorBy::Displacement(path.into())),
        Some(("file", path)) => Ok(ColorBy::File(path.into())),
        _ => Err(
            "expected `none`, `stretch=REST.obj`, `distance=BODY.obj`, `displacement=OTHER.obj` or \
             `file=VALUES.txt`"
                .to_owned(),
        ),
    }
}

/// Distances beyond this have the color of the end of the bar, unless asked otherwise, in
/// millimetres.
const DISTANCES: [f32; 2] = [-20.0, 20.0];

/// Values `[vertex]` and how they are shown.
#[derive(Debug)]
pub(crate) struct Heatmap {
    values: Vec<f32>,
    map: ColorMap,
    range: Option<[f32; 2]>,
    label: String,
}

impl Heatmap {
    pub(crate) fn new(color_by: &ColorBy, file: &ObjFile) -> anyhow::Result<Option<Self>> {
        let (values, map, range, label) = match color_by {
            ColorBy::Nothing => return Ok(None),
            ColorBy::Stretch(path) => {
                let rest = same_vertices(file, read_mesh(path)?)?;
                let values = mean_stretches(file, rest.positions());
                (values, ColorMap::CoolWarm, None, "stretch (%)".to_owned())
            }
            ColorBy::Distance(path) => {
                let body = read_mesh(path)?;
                let skin = Surface::new(&body.mesh()?);
                let values = distances(file.positions(), &skin, 1e3 * metres_of(&body));
                let label = "to the skin (mm)".to_owned();
                (values, ColorMap::CoolWarm, Some(DISTANCES), label)
            }
            ColorBy::Displacement(path) => {
                let other = same_vertices(file, read_mesh(path)?)?;
                let millimetres = 1e3 * metres_of(file);
                let pairs = file.positions().iter().zip(other.positions());
                let values = pairs.map(|(a, b)| millimetres * (a - b).norm()).collect();
                (
                    values,
                    ColorMap::Viridis,
                    None,
                    "displacement (mm)".to_owned(),
                )
            }
            ColorBy::File(path) => {
                let values = numbers(path, file.num_vertices())?;
                let stem = path.file_stem().unwrap_or_default().to_string_lossy();
                (values, ColorMap::Viridis, None, stem.into_owned())
            }
        };
        Ok(Some(Self {
            values,
            map,
            range,
            label,
        }))
    }

    pub(crate) fn heat(&self, range: Option<[f32; 2]>) -> Heat<'_> {
        Heat {
            map: self.map,
            range: range.or(self.range),
            ..Heat::new(&self.values, &self.label)
        }
    }
}

fn same_vertices(file: &ObjFile, other: ObjFile) -> anyhow::Result<ObjFile> {
    let (expected, found) = (file.num_vertices(), other.num_vertices());
    if found == expected {
        return Ok(other);
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
fn mean_stretches(file: &ObjFile, rest: &[Point3]) -> Vec<f32> {
    let positions = file.positions();
    let mut sums = vec![(0.0_f32, 0.0_f32); positions.len()];
    for [a, b] in file.polygon_edges() {
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

/// Distances to the skin, negative inside.
fn distances(positions: &[Point3], skin: &Surface, millimetres: f32) -> Vec<f32> {
    let is_inside = skin.contains_all(positions);
    let closest = skin.closest_all(positions);
    let signed = closest.iter().zip(is_inside).map(|(closest, inside)| {
        let distance = millimetres * closest.distance_squared.sqrt();
        if inside { -distance } else { distance }
    });
    signed.collect()
}

fn numbers(path: &PathBuf, expected: usize) -> anyhow::Result<Vec<f32>> {
    let shown = path.display();
    let text = fs::read_to_string(path).with_context(|| format!("cannot read `{shown}`"))?;
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
