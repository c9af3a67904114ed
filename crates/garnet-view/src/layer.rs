//! One mesh of a picture and how it is painted.

use garnet_mesh::TriMesh;

use crate::{ColorMap, Rgb, Texture, palette};

/// A mesh and the way it looks.
#[derive(Debug, Clone)]
pub struct Layer<'a> {
    /// The mesh.
    pub mesh: &'a TriMesh,
    /// The color of the front side.
    pub paint: Paint<'a>,
    /// The back side, seen where open cloth shows its inside.
    pub back: BackSide,
    /// Whether faces blend into each other.
    pub shading: Shading,
    /// The color of lines along all edges of triangles, if any.
    pub wireframe: Option<Rgb>,
    /// From 0, not drawn, to 1, opaque; anything outside is clamped, not a number is opaque.
    ///
    /// Of a layer that is not opaque the nearest surface alone is drawn.
    pub opacity: f32,
}

impl<'a> Layer<'a> {
    /// An opaque, smooth layer of skin color whose back side is darker.
    pub fn new(mesh: &'a TriMesh) -> Self {
        Self {
            mesh,
            paint: Paint::Plain(palette::SKIN),
            back: BackSide::Darker,
            shading: Shading::Smooth,
            wireframe: None,
            opacity: 1.0,
        }
    }
}

/// The color of a surface.
#[derive(Debug, Clone)]
pub enum Paint<'a> {
    /// One color everywhere.
    Plain(Rgb),
    /// A color by value.
    Heat(Heat<'a>),
    /// The materials of the faces.
    Materials(&'a FaceMaterials),
}

/// Materials of the faces of a mesh.
#[derive(Debug, Clone, Default)]
pub struct FaceMaterials {
    /// The materials.
    pub materials: Vec<Material>,
    /// The material of each face `[face]`, of those.
    pub of_face: Vec<u32>,
    /// Texture coordinates of its corners `[face]`, of which v counts from below.
    pub corners: Vec<[[f32; 2]; 3]>,
}

/// How a surface looks.
#[derive(Debug, Clone)]
pub struct Material {
    /// Its color; with a texture, what that is multiplied by.
    pub color: Rgb,
    /// The picture that is laid over it, if any.
    pub texture: Option<Texture>,
}

/// A heat map: a value for every vertex, shown as a color, with a bar beside the picture.
///
/// Where a value is infinite or not a number, the surface is
/// [`palette::NON_FINITE`].
#[derive(Debug, Clone)]
pub struct Heat<'a> {
    /// The values `[vertex]`, in any unit.
    pub values: &'a [f32],
    /// The colors.
    pub map: ColorMap,
    /// The values at the two ends of the color bar; beyond them colors stay the same.
    ///
    /// If not given: from the least to the greatest finite value, and for [`ColorMap::CoolWarm`]
    /// widened so that zero is in the middle.
    pub range: Option<[f32; 2]>,
    /// What the values are, with their unit, written above the bar.
    pub label: String,
}

impl<'a> Heat<'a> {
    /// A heat map in [`ColorMap::Viridis`] over the whole range of the values.
    pub fn new(values: &'a [f32], label: impl Into<String>) -> Self {
        Self {
            values,
            map: ColorMap::default(),
            range: None,
            label: label.into(),
        }
    }
}

/// What is seen of the back of a face, where its corners run clockwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BackSide {
    /// The paint of the front side, darker.
    #[default]
    Darker,
    /// The same as the front side.
    Same,
    /// A color of its own.
    Plain(Rgb),
    /// Nothing: one looks through it.
    Hidden,
}

/// How normals run over a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shading {
    /// Normals of vertices, interpolated: the surface looks round.
    #[default]
    Smooth,
    /// One normal a face: the triangles can be told apart.
    Flat,
}
