//! Pictures of many scenes in rows and columns.

use std::path::Path;

use garnet_mesh::TriMesh;
use garnet_view::{Camera, Layer, Paint, Picture, Rgb, View, ViewError, render};

/// Meshes that are drawn together.
#[derive(Debug, Clone)]
pub(crate) struct Scene {
    /// What it is called below its first view.
    pub(crate) caption: String,
    /// Each mesh and its color.
    pub(crate) meshes: Vec<(TriMesh, Rgb)>,
    /// The number of the mesh that must fit into the frame.
    pub(crate) framed: usize,
}

/// Views of one size in rows and columns.
#[derive(Debug, Clone)]
pub(crate) struct Sheet {
    columns: usize,
    cell: [u32; 2],
    meshes: Vec<(TriMesh, Rgb)>,
    views: Vec<View>,
}

impl Sheet {
    /// An empty sheet; `cell` is width and height of a view in pixels.
    pub(crate) const fn new(columns: usize, cell: [u32; 2]) -> Self {
        Self {
            columns,
            cell,
            meshes: Vec::new(),
            views: Vec::new(),
        }
    }

    /// Adds a scene, its views beside each other.
    pub(crate) fn add_row(&mut self, scene: Scene, cameras: &[Camera]) {
        let mut view = self.view_of(scene);
        for &camera in cameras {
            self.views.push(View {
                camera,
                ..view.clone()
            });
            view.caption.clear();
        }
    }

    /// Adds scenes, one in each column, the views of each below each other.
    pub(crate) fn add_columns(&mut self, scenes: Vec<Scene>, cameras: &[Camera]) {
        let mut views: Vec<View> = Vec::new();
        for scene in scenes {
            views.push(self.view_of(scene));
        }
        for row in views.chunks(self.columns) {
            for (side, &camera) in cameras.iter().enumerate() {
                let placed = row.iter().map(|view| View {
                    camera,
                    caption: if side == 0 {
                        view.caption.clone()
                    } else {
                        String::new()
                    },
                    ..view.clone()
                });
                self.views.extend(placed);
                // A row that is not full keeps its places empty.
                let free = self.columns - row.len();
                self.views.extend((0..free).map(|_| View {
                    shown: Some(Vec::new()),
                    framed: Some(vec![0]),
                    ..View::new(camera)
                }));
            }
        }
    }

    /// Takes over the meshes of a scene; a view of them from the front.
    fn view_of(&mut self, scene: Scene) -> View {
        let first = self.meshes.len();
        self.meshes.extend(scene.meshes);
        View {
            caption: scene.caption,
            shown: Some((first..self.meshes.len()).collect()),
            framed: Some(vec![first + scene.framed]),
            ..View::new(Camera::front())
        }
    }

    /// Draws the sheet into a PNG file.
    ///
    /// # Errors
    ///
    /// An empty sheet, views too small to draw into, and what the system refuses.
    pub(crate) fn write_png(self, path: &Path) -> Result<(), ViewError> {
        let rows = self.views.len().div_ceil(self.columns);
        let [width, height] = self.cell;
        let layers = self.meshes.iter().map(|(mesh, color)| Layer {
            paint: Paint::Plain(*color),
            ..Layer::new(mesh)
        });
        let image = render(&Picture {
            layers: layers.collect(),
            columns: Some(self.columns as u32),
            supersampling: 2,
            views: self.views,
            ..Picture::new(width * self.columns as u32, height * rows as u32)
        })?;
        image.write_png(path)
    }
}
