//! What is unusual about a mesh: the first question of someone whose garment does not drape.

use std::collections::HashMap;

use crate::normals::area_vector;
use crate::{Point3, Topology, TriMesh, Vector3};

/// The smallest box along the axes that holds some points, in the unit of the points.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: Point3,
    /// Largest coordinates.
    pub max: Point3,
}

impl Bounds {
    /// The bounds of points, or nothing without points.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a Point3>) -> Option<Self> {
        let mut points = points.into_iter();
        let first = *points.next()?;
        let mut bounds = Self {
            min: first,
            max: first,
        };
        for point in points {
            bounds.min = bounds.min.inf(point);
            bounds.max = bounds.max.sup(point);
        }
        Some(bounds)
    }

    /// The bounds of the vertices that faces name, or nothing without faces: other vertices may lie
    /// anywhere.
    ///
    /// # Panics
    ///
    /// If a face names a vertex that there is not.
    pub fn of_faces(positions: &[Point3], faces: &[[u32; 3]]) -> Option<Self> {
        let corners = faces.as_flattened().iter();
        Self::of(corners.map(|&vertex| &positions[vertex as usize]))
    }

    /// Sizes along x, y and z.
    pub fn extent(&self) -> Vector3 {
        self.max - self.min
    }

    /// The length of the diagonal.
    pub fn diagonal(&self) -> f32 {
        self.extent().norm()
    }

    /// How far a point is from the box, along the axis where it is farthest; 0 inside.
    pub fn distance(&self, point: Point3) -> f32 {
        let before = (self.min - point).max();
        let behind = (point - self.max).max();
        before.max(behind).max(0.0)
    }

    /// The distance to another box; 0 if they overlap.
    pub fn gap(&self, other: &Self) -> f32 {
        let apart = (self.min - other.max).sup(&(other.min - self.max));
        apart.map(|length| length.max(0.0)).norm()
    }

    /// The middle of the box.
    pub fn center(&self) -> Point3 {
        nalgebra::center(&self.min, &self.max)
    }
}

/// What is in a mesh, and what is unusual about it.
///
/// Lists hold numbers of vertices, faces or edges from 0, sorted.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct MeshDiagnosis {
    /// How many vertices there are.
    pub num_vertices: usize,
    /// How many triangles there are.
    pub num_faces: usize,
    /// How many edges the triangles have.
    pub num_edges: usize,
    /// Bounds of the vertices that faces name.
    pub bounds: Bounds,
    /// Mean length of the edges, in the unit of the file.
    pub mean_edge_length: f64,
    /// Vertices that no face names.
    pub unused_vertices: Vec<u32>,
    /// Used vertices at the very position of a used one with a smaller number.
    pub duplicate_vertices: Vec<u32>,
    /// Faces without area: two corners are one, or all lie on a line.
    pub degenerate_faces: Vec<u32>,
    /// Faces with the same vertices as one with a smaller number.
    pub duplicate_faces: Vec<u32>,
    /// Edges with more than two faces, by their vertices.
    pub non_manifold_edges: Vec<[u32; 2]>,
    /// Edges whose two faces look to different sides, by their vertices.
    pub inconsistent_edges: Vec<[u32; 2]>,
    /// The rims of the surface: see [`Topology::boundary_loops`].
    pub boundary_loops: Vec<Vec<u32>>,
    /// Parts that share no vertex, unused vertices apart.
    pub num_components: usize,
    /// Whether every edge has two faces.
    pub is_closed: bool,
}

impl MeshDiagnosis {
    /// Whether nothing was found that hinders a garment or a body; rims and parts are no fault.
    pub fn is_clean(&self) -> bool {
        self.degenerate_faces.is_empty()
            && self.duplicate_faces.is_empty()
            && self.non_manifold_edges.is_empty()
            && self.inconsistent_edges.is_empty()
    }
}

/// Looks at a mesh as it is; nothing is repaired.
///
/// # Examples
///
/// ```
/// let diagnosis = garnet_mesh::diagnose(&garnet_mesh::primitives::tube(0.1, 0.6, 12, 4));
/// assert_eq!(diagnosis.boundary_loops.len(), 2);
/// assert!(diagnosis.is_clean() && !diagnosis.is_closed);
/// ```
pub fn diagnose(mesh: &TriMesh) -> MeshDiagnosis {
    let (positions, faces) = (mesh.positions(), mesh.faces());
    let topology = Topology::new(mesh.num_vertices(), faces);
    let is_used = |vertex: &u32| !topology.vertex_faces(*vertex as usize).is_empty();
    let vertices = 0..mesh.num_vertices() as u32;
    let (used, unused): (Vec<u32>, Vec<u32>) = vertices.partition(is_used);
    let edge = |&index: &u32| topology.edges()[index as usize];
    let of_edges = |indices: Vec<u32>| indices.iter().map(edge).collect();
    // A mesh has a face, so there are used vertices.
    let bounds = Bounds::of(used.iter().map(|&vertex| &positions[vertex as usize]));
    MeshDiagnosis {
        num_vertices: mesh.num_vertices(),
        num_faces: mesh.num_faces(),
        num_edges: topology.edges().len(),
        bounds: bounds.unwrap_or_default(),
        mean_edge_length: mean_length(positions, topology.edges()),
        duplicate_vertices: repeated(&used, |vertex| position_key(positions[vertex as usize])),
        unused_vertices: unused,
        degenerate_faces: (0..faces.len() as u32)
            .filter(|&face| is_degenerate(positions, faces[face as usize]))
            .collect(),
        duplicate_faces: repeated(&(0..faces.len() as u32).collect::<Vec<_>>(), |face| {
            let mut corners = faces[face as usize];
            corners.sort_unstable();
            corners
        }),
        non_manifold_edges: of_edges(topology.non_manifold_edges()),
        inconsistent_edges: of_edges(topology.inconsistent_edges()),
        boundary_loops: topology.boundary_loops(),
        num_components: topology.face_components().1,
        is_closed: (0..topology.edges().len()).all(|edge| topology.edge_faces(edge).len() == 2),
    }
}

/// The items whose key an earlier item has.
fn repeated<K: Eq + std::hash::Hash>(items: &[u32], key: impl Fn(u32) -> K) -> Vec<u32> {
    let mut first_with: HashMap<K, u32> = HashMap::with_capacity(items.len());
    let is_repeated = |item: &u32| *first_with.entry(key(*item)).or_insert(*item) != *item;
    items.iter().copied().filter(is_repeated).collect()
}

/// Equal for equal positions; both zeros are one.
fn position_key(position: Point3) -> [u32; 3] {
    [position.x, position.y, position.z].map(|value| (value + 0.0).to_bits())
}

/// Whether the height of a face over its longest side is within the rounding of its corners.
fn is_degenerate(positions: &[Point3], corners: [u32; 3]) -> bool {
    let [a, b, c] = corners.map(|vertex| positions[vertex as usize].coords);
    let longest = [b - a, c - b, a - c]
        .map(|side| f64::from(side.norm()))
        .into_iter()
        .fold(0.0, f64::max);
    let largest = [a, b, c].map(|corner| f64::from(corner.amax()));
    let rounding = f64::from(f32::EPSILON) * largest.into_iter().fold(0.0, f64::max);
    2.0 * area_vector(positions, corners).norm() <= rounding * longest
}

fn mean_length(positions: &[Point3], edges: &[[u32; 2]]) -> f64 {
    let length = |&[a, b]: &[u32; 2]| {
        let (a, b) = (positions[a as usize], positions[b as usize]);
        (b.cast::<f64>() - a.cast()).norm()
    };
    edges.iter().map(length).sum::<f64>() / edges.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::{cuboid, tube};

    #[test]
    fn a_clean_closed_mesh_has_nothing_to_tell() {
        let diagnosis = diagnose(&cuboid([1.0, 2.0, 3.0]));
        assert!(diagnosis.is_clean() && diagnosis.is_closed);
        assert_eq!(diagnosis.bounds.extent(), Vector3::new(1.0, 2.0, 3.0));
        assert_eq!(diagnosis.num_components, 1);
        assert!(diagnosis.duplicate_vertices.is_empty() && diagnosis.unused_vertices.is_empty());
    }

    #[test]
    fn the_distance_of_bounds_is_along_the_farthest_axis_and_none_inside() {
        let bounds = Bounds::of(cuboid([2.0, 4.0, 6.0]).positions()).unwrap();
        let middle = bounds.center();
        let distance = |x, y, z| bounds.distance(middle + Vector3::new(x, y, z));
        let distances = [
            distance(0.0, 1.9, -2.9),
            distance(3.0, 0.0, 0.0),
            distance(0.0, -3.0, 4.5),
            distance(-2.0, 2.5, 0.0),
        ];
        for (distance, expected) in distances.into_iter().zip([0.0, 2.0, 1.5, 1.0]) {
            assert!((distance - expected).abs() < 1e-6, "{distance} {expected}");
        }
    }

    #[test]
    fn the_gap_of_two_boxes_is_the_way_between_them() {
        let bounds = Bounds::of(cuboid([2.0, 4.0, 6.0]).positions()).unwrap();
        let gap = |x, y, z| {
            let shift = Vector3::new(x, y, z);
            let [min, max] = [bounds.min + shift, bounds.max + shift];
            [
                bounds.gap(&Bounds { min, max }),
                Bounds { min, max }.gap(&bounds),
            ]
        };
        for (found, expected) in [
            (gap(1.0, -3.0, 5.0), 0.0),
            (gap(0.0, 0.0, -9.0), 3.0),
            (gap(5.0, 8.0, 0.0), 5.0),
        ] {
            assert!(found.iter().all(|gap| (gap - expected).abs() < 1e-5));
        }
    }

    #[test]
    fn every_fault_is_found() {
        let rows = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, -0.0, 0.0],
            [9.0, 9.0, 9.0],
            [2.0, 0.0, 0.0],
            [0.0, -1.0, 0.0],
        ];
        let faces = vec![
            [0, 1, 2],
            [1, 0, 3],
            [2, 0, 1],
            [0, 1, 6],
            [4, 7, 6],
            [2, 3, 0],
        ];
        let mesh = TriMesh::new(rows.map(Point3::from).to_vec(), faces).unwrap();
        let diagnosis = diagnose(&mesh);
        assert_eq!(diagnosis.unused_vertices, [5]);
        assert_eq!(diagnosis.duplicate_vertices, [4]);
        assert_eq!(diagnosis.degenerate_faces, [3]);
        assert_eq!(diagnosis.duplicate_faces, [2]);
        assert_eq!(diagnosis.non_manifold_edges, [[0, 1], [0, 2]]);
        assert_eq!(diagnosis.inconsistent_edges, [[1, 2]]);
        assert_eq!(diagnosis.num_components, 1);
        assert!(!diagnosis.is_closed && !diagnosis.is_clean());
    }

    #[test]
    fn a_garment_tells_its_rims() {
        let diagnosis = diagnose(&tube(0.3, 0.7, 12, 6));
        assert_eq!(diagnosis.boundary_loops.len(), 2);
    }
}
