//! What a picture is made of.

use crate::{Camera, Layer, Projection, Rgb, ViewError, palette};

/// The greatest width and height of a picture, in pixels.
pub const MAX_SIZE: u32 = 16_384;

/// The greatest number of samples along each side of a pixel.
pub const MAX_SUPERSAMPLING: u32 = 8;

/// Meshes, the views of them that stand side by side, and the frame around.
///
/// The views share the picture equally. Where a layer is a heat map, color bars stand at the
/// right edge, unless the picture is too small for them.
#[derive(Debug, Clone)]
pub struct Picture<'a> {
    /// Width of the whole picture, pixels.
    pub width: u32,
    /// Height of the whole picture, pixels.
    pub height: u32,
    /// The color behind everything.
    pub background: Rgb,
    /// The meshes; where two surfaces coincide, the earlier layer is seen.
    pub layers: Vec<Layer<'a>>,
    /// The views, row by row from the upper left.
    pub views: Vec<View>,
    /// How many views stand in a row; if not given or zero, all of them.
    pub columns: Option<u32>,
    /// Samples along each side of a pixel, 1 to [`MAX_SUPERSAMPLING`]: smoother edges, more time.
    pub supersampling: u32,
}

/// The camera may cut every triangle in two, and pieces have numbers of 32 bits.
pub(crate) const MAX_TRIANGLES: usize = u32::MAX as usize / 2;

impl Picture<'_> {
    /// A picture without layers yet, with one view from the front and 3 by 3 samples a pixel.
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            background: palette::BACKGROUND,
            layers: Vec::new(),
            views: vec![View::new(Camera::front())],
            columns: None,
            supersampling: 3,
        }
    }

    /// Refuses what cannot be drawn, before any work is done.
    pub(crate) fn check(&self) -> Result<(), ViewError> {
        let (width, height) = (self.width, self.height);
        if width == 0 || height == 0 || width > MAX_SIZE || height > MAX_SIZE {
            return Err(ViewError::PictureSize { width, height });
        }
        if self.supersampling == 0 || self.supersampling > MAX_SUPERSAMPLING {
            let found = self.supersampling;
            return Err(ViewError::Supersampling { found });
        }
        if self.layers.is_empty() {
            return Err(ViewError::NoLayers);
        }
        if self.views.is_empty() {
            return Err(ViewError::NoViews);
        }
        let count = self.layers.iter().map(|layer| layer.mesh.num_faces()).sum();
        if count >= MAX_TRIANGLES {
            return Err(ViewError::TooManyTriangles { count });
        }
        for (index, view) in self.views.iter().enumerate() {
            view.check(index, self.layers.len())?;
        }
        Ok(())
    }
}

/// One look at the layers.
#[derive(Debug, Clone)]
pub struct View {
    /// Where it is taken from.
    pub camera: Camera,
    /// A line of text below; an empty one takes no room.
    pub caption: String,
    /// The numbers of the layers that are drawn; if not given, all.
    pub shown: Option<Vec<usize>>,
    /// The numbers of the layers that must fit into the frame; if not given, all of the picture,
    /// so that views which show different layers from one side can be compared.
    pub framed: Option<Vec<usize>>,
}

impl View {
    /// All layers from one camera, without a caption.
    pub const fn new(camera: Camera) -> Self {
        Self {
            camera,
            caption: String::new(),
            shown: None,
            framed: None,
        }
    }

    fn check(&self, view: usize, num_layers: usize) -> Result<(), ViewError> {
        let named = [&self.shown, &self.framed].into_iter().flatten().flatten();
        for &index in named {
            if index >= num_layers {
                return Err(ViewError::LayerIndexOutOfRange {
                    view,
                    index,
                    num_layers,
                });
            }
        }
        let camera = |what, value, expected| {
            Err(ViewError::Camera {
                view,
                what,
                value,
                expected,
            })
        };
        let Camera {
            azimuth,
            elevation,
            projection,
            zoom,
        } = self.camera;
        if !azimuth.is_finite() {
            return camera("azimuth", azimuth, "a finite angle");
        }
        if !elevation.is_finite() {
            return camera("elevation", elevation, "a finite angle");
        }
        if !(1e-3..=1e3).contains(&zoom) {
            return camera("zoom", zoom, "0.001 to 1000");
        }
        match projection {
            Projection::Perspective { field_of_view } if !(1e-3..=3.0).contains(&field_of_view) => {
                camera("field of view", field_of_view, "0.001 to 3 radians")
            }
            _ => Ok(()),
        }
    }
}
