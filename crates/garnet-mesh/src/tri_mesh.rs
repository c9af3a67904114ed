//! The triangle mesh: positions and faces, checked once on creation.

use crate::{MeshError, Point3};

/// The largest coordinate that a mesh may have, in metres (in those of a file before its units are
/// known).
///
/// There `f32` tells places apart that are 6 cm from each other. Far beyond, squares and products
/// of lengths become infinite, and queries have to look at every face.
pub const MAX_COORDINATE: f32 = 1e6;

/// A triangle mesh whose faces name existing vertices, with coordinates up to [`MAX_COORDINATE`].
///
/// Metres; counter-clockwise faces seen from outside. Unused, duplicate and non-manifold vertices
/// are allowed: real files have them.
#[derive(Debug, Clone, PartialEq)]
pub struct TriMesh {
    positions: Vec<Point3>,
    faces: Vec<[u32; 3]>,
}

impl TriMesh {
    /// Checks positions `[vertex]` and faces `[face][corner]` and makes a mesh of them.
    ///
    /// # Errors
    ///
    /// [`MeshError::NoFaces`], [`MeshError::FaceIndexOutOfRange`],
    /// [`MeshError::CoordinateOutOfRange`] or [`MeshError::TooLarge`].
    pub fn new(positions: Vec<Point3>, faces: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        let count = positions.len().max(faces.len());
        if count >= u32::MAX as usize {
            return Err(MeshError::TooLarge { count });
        }
        if faces.is_empty() {
            return Err(MeshError::NoFaces);
        }
        let num_vertices = positions.len();
        for (face, corners) in faces.iter().enumerate() {
            for &index in corners {
                if index as usize >= num_vertices {
                    return Err(MeshError::FaceIndexOutOfRange {
                        face,
                        index,
                        num_vertices,
                    });
                }
            }
        }
        check_range(&positions)?;
        Ok(Self { positions, faces })
    }

    /// The same faces at other positions `[vertex]`.
    ///
    /// # Errors
    ///
    /// [`MeshError::PositionCount`] or [`MeshError::CoordinateOutOfRange`].
    pub fn with_positions(&self, positions: Vec<Point3>) -> Result<Self, MeshError> {
        if positions.len() != self.positions.len() {
            return Err(MeshError::PositionCount {
                found: positions.len(),
                expected: self.positions.len(),
            });
        }
        check_range(&positions)?;
        Ok(Self {
            positions,
            faces: self.faces.clone(),
        })
    }

    /// Positions `[vertex]`, in metres.
    pub fn positions(&self) -> &[Point3] {
        &self.positions
    }

    /// Vertex numbers `[face][corner]`, from 0.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// How many vertices there are, unused ones included.
    pub fn num_vertices(&self) -> usize {
        self.positions.len()
    }

    /// How many triangles there are.
    pub fn num_faces(&self) -> usize {
        self.faces.len()
    }

    /// The positions of the three corners of a face.
    pub fn corners(&self, face: usize) -> [Point3; 3] {
        self.faces[face].map(|vertex| self.positions[vertex as usize])
    }

    /// Gives back positions and faces.
    pub fn into_parts(self) -> (Vec<Point3>, Vec<[u32; 3]>) {
        (self.positions, self.faces)
    }
}

/// Whether a coordinate is a number up to [`MAX_COORDINATE`].
fn is_in_range(value: f32) -> bool {
    value.abs() <= MAX_COORDINATE
}

/// Refuses positions `[vertex]` with a coordinate that is NaN or beyond [`MAX_COORDINATE`].
///
/// # Errors
///
/// [`MeshError::CoordinateOutOfRange`] of the first one.
pub fn check_range(positions: &[Point3]) -> Result<(), MeshError> {
    match stray_coordinate(positions) {
        Some((vertex, value)) => Err(MeshError::CoordinateOutOfRange { vertex, value }),
        None => Ok(()),
    }
}

/// The first coordinate that is NaN or beyond [`MAX_COORDINATE`], after the number of its point.
pub fn stray_coordinate(positions: &[Point3]) -> Option<(usize, f32)> {
    positions.iter().enumerate().find_map(|(index, position)| {
        let stray = position.iter().find(|&&value| !is_in_range(value));
        stray.map(|&value| (index, value))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner_points() -> Vec<Point3> {
        vec![
            Point3::origin(),
            Point3::new(1.0, 0.0, 0.0),
            Point3::new(0.0, 1.0, 0.0),
        ]
    }

    #[test]
    fn a_face_that_names_a_missing_vertex_is_refused() {
        let error = TriMesh::new(corner_points(), vec![[0, 1, 3]]).unwrap_err();
        let expected = MeshError::FaceIndexOutOfRange {
            face: 0,
            index: 3,
            num_vertices: 3,
        };
        assert_eq!(error, expected);
    }

    #[test]
    fn a_coordinate_that_is_not_a_number_is_refused() {
        let mut positions = corner_points();
        positions[1].y = f32::NAN;
        let error = TriMesh::new(positions, vec![[0, 1, 2]]).unwrap_err();
        assert!(matches!(
            error,
            MeshError::CoordinateOutOfRange { vertex: 1, .. }
        ));
    }

    #[test]
    fn a_coordinate_of_no_place_on_earth_is_refused() {
        let mesh = TriMesh::new(corner_points(), vec![[0, 1, 2]]).unwrap();
        for (value, is_taken) in [(1e6, true), (-1e6, true), (1.1e6, false), (-1e20, false)] {
            let mut positions = corner_points();
            positions[2].x = value;
            let expected = MeshError::CoordinateOutOfRange { vertex: 2, value };
            let refusal = mesh.with_positions(positions).err();
            assert_eq!(refusal, (!is_taken).then_some(expected));
        }
    }

    #[test]
    fn new_positions_must_fit_the_vertices() {
        let mesh = TriMesh::new(corner_points(), vec![[0, 1, 2]]).unwrap();
        let error = mesh.with_positions(vec![Point3::origin()]).unwrap_err();
        let expected = MeshError::PositionCount {
            found: 1,
            expected: 3,
        };
        assert_eq!(error, expected);
    }
}
