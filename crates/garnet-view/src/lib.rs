//! Pictures: shaded PNG of meshes, charts as SVG and PNG, and pages that show meshes in a browser.
//!
//! A small software renderer for looking at cloth on bodies: several meshes from several sides in
//! one picture, lit like clay, with creases darkened so that folds, contact and skin that pokes
//! through cloth are seen at once. Values per vertex (an error, a penetration depth, a strain)
//! become colors with a bar beside them. The same picture gives the same bytes on every run, with
//! any number of threads.
//!
//! # Examples
//!
//! ```
//! use garnet_mesh::{Point3, TriMesh};
//! use garnet_view::{Camera, Layer, Paint, Picture, View, palette, render};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
//! let positions = corners.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
//! let mesh = TriMesh::new(positions, vec![[0, 1, 2]])?;
//! let image = render(&Picture {
//!     layers: vec![Layer { paint: Paint::Plain(palette::GARMENT), ..Layer::new(&mesh) }],
//!     views: vec![View::new(Camera::front()), View::new(Camera::three_quarter())],
//!     ..Picture::new(320, 160)
//! })?;
//! image.write_png(&std::env::temp_dir().join("garnet-view-example.png"))?;
//! # Ok(())
//! # }
//! ```

mod camera;
mod canvas;
mod chart;
mod clip;
mod color_bar;
mod color_map;
mod error;
mod image;
mod layer;
mod layout;
mod lens;
mod letters;
mod lighting;
mod normals;
mod occlusion;
mod page;
pub mod palette;
mod picture;
mod prepared;
mod raster;
mod render;
mod resolve;
mod rgb;
mod scene;
mod text;
mod texture;

#[cfg(test)]
mod shapes;

pub use camera::{Camera, Projection};
pub use chart::{
    Axis, Chart, Entry, Key, Level, Line, Mark, Scale, Series, Shape, Stroke, Symbol, safe,
};
pub use color_map::{ColorMap, Problem};
pub use error::ViewError;
pub use image::{GifWriter, Image};
pub use layer::{BackSide, FaceMaterials, Heat, Layer, Material, Paint, Shading};
pub use page::{Coloring, Page, PageMesh, PagePane, PagePart};
pub use picture::{MAX_SIZE, MAX_SUPERSAMPLING, Picture, View};
pub use render::render;
pub use rgb::Rgb;
pub use texture::Texture;
