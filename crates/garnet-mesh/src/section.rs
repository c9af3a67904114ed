//! The closed curves in which a plane cuts a mesh.

use std::collections::BTreeMap;

use nalgebra::{Point3 as Point, Vector3 as Vector};

use crate::Point3;

/// A closed curve on a mesh that runs straight through one face after the other.
///
/// It is told by faces and shares of their corners, so that it can be followed on the same mesh in
/// another state: a tape drawn on the cloth.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshLoop {
    segments: Vec<LoopSegment>,
}

/// The part of a [`MeshLoop`] in one face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopSegment {
    /// The face.
    pub face: u32,
    /// Shares of its corners at the two ends; each sums to 1.
    pub ends: [[f64; 3]; 2],
}

impl MeshLoop {
    /// The parts of the curve, each from where the last one ends.
    pub fn segments(&self) -> &[LoopSegment] {
        &self.segments
    }

    /// How long the curve is where `corners` has the corners of a face, in metres: on the mesh in
    /// some state, or in the plane of its pattern.
    ///
    /// ```
    /// use garnet_mesh::{plane_loops, primitives::tube};
    /// use nalgebra::{Point3, Vector3};
    ///
    /// let sleeve = tube(0.06, 0.25, 400, 20);
    /// let middle = Point3::new(0.0, 0.001, 0.0);
    /// let found = plane_loops(sleeve.faces(), sleeve.positions(), &middle, &Vector3::y());
    /// let corners = |face: u32| {
    ///     sleeve.faces()[face as usize].map(|v| sleeve.positions()[v as usize].coords.cast())
    /// };
    /// let round = std::f64::consts::TAU * 0.06;
    /// assert!((found[0].length(corners) - round).abs() < 1e-4);
    /// ```
    pub fn length(&self, corners: impl Fn(u32) -> [Vector<f64>; 3]) -> f64 {
        let of_segment = |segment: &LoopSegment| {
            let corners = corners(segment.face);
            let [start, end] = segment.ends.map(|shares| weighted(&corners, &shares));
            (end - start).norm()
        };
        self.segments.iter().map(of_segment).sum()
    }

    /// Where each part of the curve starts, on the mesh with vertices at `positions`.
    ///
    /// # Panics
    ///
    /// If the faces are not those of the mesh that was cut.
    pub fn points(&self, faces: &[[u32; 3]], positions: &[Point3]) -> Vec<Point<f64>> {
        let start = |segment: &LoopSegment| {
            let corners = corners_at(faces, positions, segment.face);
            Point::from(weighted(&corners, &segment.ends[0]))
        };
        self.segments.iter().map(start).collect()
    }
}

fn weighted(corners: &[Vector<f64>; 3], shares: &[f64; 3]) -> Vector<f64> {
    let [a, b, c] = corners;
    let [u, v, w] = shares;
    *u * a + *v * b + *w * c
}

fn corners_at(faces: &[[u32; 3]], positions: &[Point3], face: u32) -> [Vector<f64>; 3] {
    faces[face as usize].map(|vertex| positions[vertex as usize].coords.cast())
}

/// A face that the plane cuts: the two edges, the smaller vertex first, and where it cuts them.
struct Cut {
    face: u32,
    edges: [[u32; 2]; 2],
    ends: [[f64; 3]; 2],
}

/// The closed curves in which the plane through `point` with this `normal` cuts a mesh, in the
/// order of their first faces.
///
/// Curves that end at a boundary, and those that run into an edge of more than two faces, are left
/// out.
///
/// # Panics
///
/// If a face names a vertex that has no position.
pub fn plane_loops(
    faces: &[[u32; 3]],
    positions: &[Point3],
    point: &Point<f64>,
    normal: &Vector<f64>,
) -> Vec<MeshLoop> {
    let cuts = cuts(faces, positions, point, normal);
    let mut at_edge: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (number, cut) in cuts.iter().enumerate() {
        for edge in cut.edges {
            at_edge.entry(edge).or_default().push(number);
        }
    }
    let mut is_seen = vec![false; cuts.len()];
    let mut loops = Vec::new();
    for start in 0..cuts.len() {
        if is_seen[start] {
            continue;
        }
        let mut segments = Vec::new();
        let (mut number, mut entry) = (start, 0);
        let is_closed = loop {
            let cut = &cuts[number];
            is_seen[number] = true;
            let exit = 1 - entry;
            segments.push(LoopSegment {
                face: cut.face,
                ends: [cut.ends[entry], cut.ends[exit]],
            });
            let edge = cut.edges[exit];
            let &[one, other] = at_edge[&edge].as_slice() else {
                break false;
            };
            let next = if one == number { other } else { one };
            if is_seen[next] {
                break next == start && cuts[start].edges[0] == edge;
            }
            entry = usize::from(cuts[next].edges[1] == edge);
            number = next;
        };
        if is_closed {
            loops.push(MeshLoop { segments });
        }
    }
    loops
}

fn cuts(
    faces: &[[u32; 3]],
    positions: &[Point3],
    point: &Point<f64>,
    normal: &Vector<f64>,
) -> Vec<Cut> {
    let level = normal.dot(&point.coords);
    let height = |position: &Point3| normal.dot(&position.coords.cast::<f64>()) - level;
    let heights: Vec<f64> = positions.iter().map(height).collect();
    let mut cuts = Vec::new();
    for (face, corners) in faces.iter().enumerate() {
        let [a, b, c] = *corners;
        if a == b || b == c || c == a {
            continue;
        }
        let mut found = Vec::with_capacity(2);
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            // From the smaller vertex to the larger, so that both faces find the same place.
            let (i, j) = if corners[i] < corners[j] {
                (i, j)
            } else {
                (j, i)
            };
            let [low, high] = [i, j].map(|corner| heights[corners[corner] as usize]);
            if (low >= 0.0) != (high >= 0.0) {
                let share = low / (low - high);
                let mut shares = [0.0; 3];
                shares[i] = 1.0 - share;
                shares[j] = share;
                found.push(([corners[i], corners[j]], shares));
            }
        }
        if let [(first, start), (second, end)] = found[..] {
            cuts.push(Cut {
                face: face as u32,
                edges: [first, second],
                ends: [start, end],
            });
        }
    }
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TriMesh;
    use crate::primitives::{capsule, tube};

    fn round_at(mesh: &TriMesh, height: f64) -> Vec<MeshLoop> {
        let point = Point::new(0.0, height, 0.0);
        plane_loops(mesh.faces(), mesh.positions(), &point, &Vector::y())
    }

    fn length(mesh: &TriMesh, found: &MeshLoop, stretch: f64) -> f64 {
        found.length(|face| {
            let corners = corners_at(mesh.faces(), mesh.positions(), face);
            corners.map(|corner| stretch * corner)
        })
    }

    #[test]
    fn a_tube_is_cut_into_its_polygon_at_any_height() {
        const SIDES: usize = 64;
        let sleeve = tube(0.1, 0.5, SIDES, 20);
        let polygon = 2.0 * SIDES as f64 * 0.1 * (std::f64::consts::PI / SIDES as f64).sin();
        for height in [-0.2, 0.0, 0.013, 0.24] {
            let found = round_at(&sleeve, height);
            assert_eq!(found.len(), 1, "{height}");
            approx::assert_relative_eq!(
                length(&sleeve, &found[0], 1.0),
                polygon,
                max_relative = 1e-5
            );
            approx::assert_relative_eq!(
                length(&sleeve, &found[0], 1.1),
                1.1 * polygon,
                max_relative = 1e-5
            );
        }
        assert_eq!(round_at(&sleeve, 0.6).len(), 0);
    }

    #[test]
    fn the_points_of_a_curve_lie_in_the_plane_and_follow_each_other() {
        let limb = capsule(0.05, 0.4, 24, 12);
        let found = round_at(&limb, 0.03);
        assert_eq!(found.len(), 1);
        let points = found[0].points(limb.faces(), limb.positions());
        assert!(points.iter().all(|point| (point.y - 0.03).abs() < 1e-6));
        let mut round = 0.0;
        for (number, point) in points.iter().enumerate() {
            round += (points[(number + 1) % points.len()] - point).norm();
        }
        approx::assert_relative_eq!(round, length(&limb, &found[0], 1.0), max_relative = 1e-6);
    }

    #[test]
    fn a_curve_that_ends_at_a_boundary_is_none() {
        let sleeve = tube(0.1, 0.5, 32, 20);
        let front = sleeve.faces().iter().copied();
        let is_front = |face: &[u32; 3]| {
            let depth = |&vertex: &u32| sleeve.positions()[vertex as usize].z;
            face.iter().map(depth).sum::<f32>() > -0.2
        };
        let open = TriMesh::new(
            sleeve.positions().to_vec(),
            front.filter(is_front).collect(),
        );
        assert!(round_at(&open.unwrap(), 0.013).is_empty());
    }
}
