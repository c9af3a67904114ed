//! A page that shows meshes in a browser: one file, without a network.
//!
//! The page holds its program, which draws by WebGL 2, a description as JSON, and all numbers as
//! one packed block: positions and values are rounded to 16 bits, told as differences from what
//! comes before, their bytes sorted apart, deflated, and written in base64. `page/decode.js` undoes
//! that.

mod description;
mod pack;

#[cfg(test)]
mod tests;

use garnet_mesh::{Point3, TriMesh};

use crate::{ColorMap, Rgb, ViewError};
use description::Description;
use pack::{Packer, base64};

/// Meshes in panes side by side, which are looked at from the same side.
///
/// # Examples
///
/// ```
/// use garnet_mesh::primitives::icosphere;
/// use garnet_view::{Page, PageMesh, PagePane, PagePart, palette};
///
/// # fn main() -> Result<(), garnet_view::ViewError> {
/// let ball = icosphere(2, 0.5);
/// let page = Page {
///     meshes: vec![PageMesh::new("ball", PagePart::Garment, palette::GARMENT, &ball)],
///     panes: vec![PagePane { name: "ball".to_owned(), meshes: vec![0] }],
///     ..Page::new("A ball")
/// };
/// assert!(page.to_html()?.starts_with("<!DOCTYPE html>"));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Page<'a> {
    /// What stands above.
    pub title: String,
    /// All meshes, each once.
    pub meshes: Vec<PageMesh<'a>>,
    /// What is seen together, in the order of reading.
    pub panes: Vec<PagePane>,
    /// Names of the frames; none if nothing moves.
    pub frames: Vec<String>,
    /// Frames a second.
    pub fps: f64,
}

impl Page<'_> {
    /// A page without meshes yet, in which nothing moves.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            meshes: Vec::new(),
            panes: Vec::new(),
            frames: Vec::new(),
            fps: 30.0,
        }
    }
}

/// A mesh of a page.
#[derive(Debug, Clone)]
pub struct PageMesh<'a> {
    /// What it is called.
    pub name: String,
    /// With which others it is shown and hidden.
    pub part: PagePart,
    /// Its color where no values are shown.
    pub color: Rgb,
    /// The mesh in the first frame.
    pub mesh: &'a TriMesh,
    /// Positions `[vertex]` in the frames after the first; none if it keeps still.
    pub later: Vec<Vec<Point3>>,
    /// What it can be colored by.
    pub colorings: Vec<Coloring>,
}

impl<'a> PageMesh<'a> {
    /// A mesh that keeps still, and has no values.
    pub fn new(name: impl Into<String>, part: PagePart, color: Rgb, mesh: &'a TriMesh) -> Self {
        Self {
            name: name.into(),
            part,
            color,
            mesh,
            later: Vec::new(),
            colorings: Vec::new(),
        }
    }
}

/// What is shown and hidden together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PagePart {
    /// Cloth.
    Garment,
    /// What is below.
    Body,
}

/// Values for the vertices of a mesh. Those of all meshes under one label share a color bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Coloring {
    /// What the values are, with their unit.
    pub label: String,
    /// The colors.
    pub map: ColorMap,
    /// Values at the ends of the color bar, as in [`Heat::range`](crate::Heat::range); where none
    /// is given, the finite values of all meshes and frames are between them.
    pub range: Option<[f32; 2]>,
    /// Values `[frame][vertex]`: of one frame, or of as many as the mesh has.
    pub values: Vec<Vec<f32>>,
}

/// Meshes that are seen together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PagePane {
    /// What is written above.
    pub name: String,
    /// Numbers of the meshes.
    pub meshes: Vec<usize>,
}

/// The files of the page.
const TEMPLATE: &str = include_str!("../../page/page.html");
const STYLE: &str = include_str!("../../page/page.css");
const SCRIPT: &str = concat!(
    include_str!("../../page/decode.js"),
    include_str!("../../page/camera.js"),
    include_str!("../../page/draw.js"),
    include_str!("../../page/page.js"),
);

impl Page<'_> {
    /// The text of the page.
    ///
    /// Positions are rounded to a 65,535th of the longest side of the mesh's box, values to a
    /// 65,534th of their range.
    ///
    /// # Errors
    ///
    /// [`ViewError::NoLayers`] without a mesh, [`ViewError::NoViews`] without a pane, and
    /// [`ViewError::PageCount`], [`ViewError::PagePane`] or [`ViewError::ValueRange`] for what does
    /// not fit together.
    pub fn to_html(&self) -> Result<String, ViewError> {
        self.check()?;
        let mut packer = Packer::default();
        let description = Description::new(self, &mut packer);
        // Within an element of a script nothing but its end means anything.
        let scene = description.to_json().replace('<', "\\u003c");
        let title = escaped(&self.title);
        let numbers = base64(&packer.finish());
        Ok(filled(&[
            ("version", env!("CARGO_PKG_VERSION")),
            ("title", &title),
            ("style", STYLE.trim_end()),
            ("scene", &scene),
            ("numbers", &numbers),
            ("script", SCRIPT.trim_end()),
        ]))
    }

    fn check(&self) -> Result<(), ViewError> {
        if self.meshes.is_empty() {
            return Err(ViewError::NoLayers);
        }
        if self.panes.is_empty() {
            return Err(ViewError::NoViews);
        }
        let num_frames = self.frames.len().max(1);
        for (index, mesh) in self.meshes.iter().enumerate() {
            let count = |what, found, expected| {
                let error = ViewError::PageCount {
                    mesh: index,
                    what,
                    found,
                    expected,
                };
                if found == expected {
                    Ok(())
                } else {
                    Err(error)
                }
            };
            let num_vertices = mesh.mesh.num_vertices();
            if !mesh.later.is_empty() {
                count("frames", 1 + mesh.later.len(), num_frames)?;
            }
            for positions in &mesh.later {
                count("vertices in a frame", positions.len(), num_vertices)?;
            }
            for coloring in &mesh.colorings {
                if coloring.values.len() != 1 {
                    count("frames of values", coloring.values.len(), num_frames)?;
                }
                for values in &coloring.values {
                    count("values in a frame", values.len(), num_vertices)?;
                }
                let ends = coloring
                    .range
                    .filter(|[low, high]| !(low.is_finite() && high.is_finite() && low < high));
                if let Some([low, high]) = ends {
                    let layer = index;
                    return Err(ViewError::ValueRange { layer, low, high });
                }
            }
        }
        let num_meshes = self.meshes.len();
        for (pane, shown) in self.panes.iter().enumerate() {
            if let Some(&index) = shown.meshes.iter().find(|&&index| index >= num_meshes) {
                return Err(ViewError::PagePane {
                    pane,
                    index,
                    num_meshes,
                });
            }
        }
        Ok(())
    }
}

/// The template with its fields filled in.
fn filled(fields: &[(&str, &str)]) -> String {
    let mut text = String::new();
    let mut rest = TEMPLATE;
    while let Some((before, after)) = rest.split_once("{{") {
        let (name, after) = after
            .split_once("}}")
            .expect("fields of the template are closed");
        let field = fields.iter().find(|(known, _)| *known == name);
        let (_, value) = field.expect("fields of the template are known");
        text.push_str(before);
        text.push_str(value);
        rest = after;
    }
    text + rest
}

/// A text that HTML shows as it is.
fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}
