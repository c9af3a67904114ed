//! What can be wrong with a picture.

use std::path::PathBuf;

use crate::{MAX_SIZE, MAX_SUPERSAMPLING};

/// Why a picture cannot be drawn or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// A width or height that is zero or above [`MAX_SIZE`].
    #[error("a picture of {width} x {height} pixels, expected 1 to {MAX_SIZE} each way")]
    PictureSize {
        /// The width asked for.
        width: u32,
        /// The height asked for.
        height: u32,
    },
    /// Supersampling of zero or above [`MAX_SUPERSAMPLING`].
    #[error("supersampling of {found}, expected 1 to {MAX_SUPERSAMPLING}")]
    Supersampling {
        /// What was asked for.
        found: u32,
    },
    /// A picture without layers.
    #[error("the picture has no layers")]
    NoLayers,
    /// A picture without views.
    #[error("the picture has no views")]
    NoViews,
    /// More views than pixels to show them.
    #[error("no room for {num_views} views in {width} x {height} pixels")]
    NoRoom {
        /// How many views there are.
        num_views: usize,
        /// Width of the picture.
        width: u32,
        /// Height of the picture.
        height: u32,
    },
    /// A heat map whose values do not fit the vertices of its mesh.
    #[error("layer {layer} has {found} values, expected {expected}, one per vertex")]
    ValueCount {
        /// Which layer.
        layer: usize,
        /// How many values there are.
        found: usize,
        /// How many vertices there are.
        expected: usize,
    },
    /// A range of values that is not finite or whose ends are swapped.
    #[error("layer {layer} has the value range `{low}` to `{high}`, expected finite and rising")]
    ValueRange {
        /// Which layer.
        layer: usize,
        /// The lower end.
        low: f32,
        /// The upper end.
        high: f32,
    },
    /// A view that names a layer which does not exist.
    #[error("view {view} names layer {index}, but there are {num_layers} layers")]
    LayerIndexOutOfRange {
        /// Which view.
        view: usize,
        /// The layer it names.
        index: usize,
        /// How many layers there are.
        num_layers: usize,
    },
    /// A mesh of a page with too many or too few of something.
    #[error("mesh {mesh} of the page has {found} {what}, expected {expected}")]
    PageCount {
        /// Which mesh.
        mesh: usize,
        /// What is counted.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A pane of a page that names a mesh which does not exist.
    #[error("pane {pane} names mesh {index}, but there are {num_meshes} meshes")]
    PagePane {
        /// Which pane.
        pane: usize,
        /// The mesh it names.
        index: usize,
        /// How many meshes there are.
        num_meshes: usize,
    },
    /// A camera angle, field of view or zoom that cannot be used.
    #[error("the {what} of view {view} is `{value}`, expected {expected}")]
    Camera {
        /// Which view.
        view: usize,
        /// The name of the quantity.
        what: &'static str,
        /// What was found.
        value: f32,
        /// What would be accepted.
        expected: &'static str,
    },
    /// A chart without a point that can be shown.
    #[error("the chart `{title}` has no point to show")]
    NoPoints {
        /// Its title.
        title: String,
    },
    /// A chart, or the text of a picture, could not be drawn.
    #[error("the picture could not be drawn: {reason}")]
    Chart {
        /// What the plotter says.
        reason: String,
    },
    /// More triangles than can be numbered.
    #[error(
        "{count} triangles in all, expected fewer than {}",
        crate::picture::MAX_TRIANGLES
    )]
    TooManyTriangles {
        /// The sum over the layers.
        count: usize,
    },
    /// A texture could not be read.
    #[error("the texture could not be read")]
    Decode {
        /// What the decoder said.
        source: ::image::ImageError,
    },
    /// Materials that do not fit the faces of their mesh.
    #[error(
        "layer {layer} has materials of {found} faces, or of a number that there is not, expected {expected}"
    )]
    FaceMaterials {
        /// Which layer.
        layer: usize,
        /// Of how many faces the material is told.
        found: usize,
        /// How many faces there are.
        expected: usize,
    },
    /// The pixels could not be packed as PNG or GIF.
    #[error("the picture could not be packed")]
    Encode {
        /// What the encoder said.
        source: ::image::ImageError,
    },
    /// The file could not be written.
    #[error("`{}` could not be written", path.display())]
    Write {
        /// Where it should have gone.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}
