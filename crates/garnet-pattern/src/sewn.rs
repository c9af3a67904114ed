//! A sewn garment that is not yet worn.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use garnet_mesh::{TriMesh, WriteError, write_atomically};

use crate::{Parameters, Point3};

/// A panel and its faces.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Panel {
    /// The name, such as `front` or `left sleeve`; left is the wearer's, at +X.
    pub name: String,
    /// Its faces.
    pub faces: Range<usize>,
}

/// A named line of vertices: a seam, or a part of a rim.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// The name, such as `left side` or `right front hem`.
    pub name: String,
    /// Its vertices, from one end to the other.
    pub vertices: Vec<u32>,
}

/// A garment whose seams are closed: the flat pattern that gives its rest lengths, and a start
/// shape around the wearer's rest body that touches neither the body nor itself.
#[derive(Debug, Clone, PartialEq)]
pub struct SewnGarment {
    /// The parameters of the pattern.
    pub parameters: Parameters,
    /// Vertex numbers `[face][corner]`, counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
    /// The flat pattern `[face][corner]`, in metres: panels lie apart, seen from outside, each
    /// face counter-clockwise. They are the UVs, too.
    pub flat: Vec<[[f32; 2]; 3]>,
    /// Rest lengths of a face over those of its flat triangle: below 1 in ribs and waistbands.
    pub shrink: Vec<f32>,
    /// The panels; their faces follow one another.
    pub panels: Vec<Panel>,
    /// The seams; their vertices belong to both sides.
    pub seams: Vec<Line>,
    /// The parts of the rims.
    pub rims: Vec<Line>,
    /// The vertex that is each vertex's mirror image at x = 0; its own in the middle.
    pub mirror: Vec<u32>,
    /// Positions `[vertex]` around the wearer at rest, in metres.
    pub start: Vec<Point3>,
}

impl SewnGarment {
    /// How many vertices there are.
    pub fn num_vertices(&self) -> usize {
        self.start.len()
    }

    /// The start shape as a mesh.
    ///
    /// # Panics
    ///
    /// Never, unless the fields were changed: faces name vertices and positions are finite.
    pub fn start_mesh(&self) -> TriMesh {
        TriMesh::new(self.start.clone(), self.faces.clone()).expect("a sewn garment is a mesh")
    }

    /// The flat pattern as a mesh of three vertices a face, for pictures.
    ///
    /// # Panics
    ///
    /// Never, unless the fields were changed.
    pub fn flat_mesh(&self) -> TriMesh {
        let corners = self.flat.iter().flatten();
        let positions = corners.map(|&[u, v]| Point3::new(u, v, 0.0)).collect();
        let faces = (0..self.flat.len() as u32)
            .map(|face| [3 * face, 3 * face + 1, 3 * face + 2])
            .collect();
        TriMesh::new(positions, faces).expect("a flat pattern is a mesh")
    }

    /// The garment at positions `[vertex]` as an OBJ: groups are panels, `vt` is the flat pattern
    /// in metres, every vertex is written once.
    ///
    /// # Panics
    ///
    /// If there are more or fewer positions than vertices.
    pub fn obj(&self, positions: &[Point3]) -> String {
        assert_eq!(positions.len(), self.num_vertices(), "a position a vertex");
        let mut text = String::with_capacity(120 * positions.len());
        let mut put = |line: std::fmt::Arguments<'_>| {
            text.write_fmt(line).expect("a string takes all text");
        };
        put(format_args!("# {}\n", self.parameters.garment()));
        for p in positions {
            put(format_args!("v {} {} {}\n", p.x, p.y, p.z));
        }
        // Corners at one vertex and one place of the pattern share a texture vertex.
        let mut numbers: BTreeMap<(u32, [u32; 2]), usize> = BTreeMap::new();
        let mut lines = Vec::with_capacity(self.faces.len());
        for (face, flat) in self.faces.iter().zip(&self.flat) {
            lines.push([0, 1, 2].map(|corner| {
                let (vertex, uv) = (face[corner], flat[corner]);
                let next = numbers.len() + 1;
                let number = *numbers
                    .entry((vertex, uv.map(f32::to_bits)))
                    .or_insert(next);
                if number == next {
                    put(format_args!("vt {} {}\n", uv[0], uv[1]));
                }
                [vertex as usize + 1, number]
            }));
        }
        for panel in &self.panels {
            put(format_args!("g {}\n", panel.name.replace(' ', "_")));
            for [a, b, c] in &lines[panel.faces.clone()] {
                put(format_args!(
                    "f {}/{} {}/{} {}/{}\n",
                    a[0], a[1], b[0], b[1], c[0], c[1]
                ));
            }
        }
        text
    }

    /// Writes [`SewnGarment::obj`] to a file, whole or not at all.
    ///
    /// # Errors
    ///
    /// [`WriteError`].
    ///
    /// # Panics
    ///
    /// If there are more or fewer positions than vertices.
    pub fn write_obj(
        &self,
        path: impl AsRef<Path>,
        positions: &[Point3],
    ) -> Result<(), WriteError> {
        let text = self.obj(positions);
        write_atomically(path, |writer| writer.write_all(text.as_bytes()))
    }
}
