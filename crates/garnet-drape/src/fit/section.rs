//! The line round a garment in a plane: closed, round one part of the body and no other.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use garnet_body::shape::{Measure, Tape, TapePlane, Tube};
use garnet_mesh::{MeshLoop, Point3, Topology, plane_loops};
use garnet_sim::RestShape;
use nalgebra::{Point3 as Point, Vector3 as Vector};

use crate::BoundGarment;

/// A garment as it lies on its body, and as it was cut.
#[derive(Debug)]
pub(super) struct Cut<'a> {
    garment: &'a BoundGarment,
    /// Positions on its body `[node]`, in the frame of the tape.
    nodes: Cow<'a, [Point3]>,
    /// Faces of the mesh between nodes `[face]`; some may be lines.
    faces: Vec<[u32; 3]>,
    /// `None`: as it lies on its body.
    flat: Option<&'a [[[f32; 2]; 3]]>,
    /// Positions `[vertex]` at which it has its lengths, if they are not those on its body.
    worn: Option<Vec<Point3>>,
    /// The pieces that it was cut in `[face]`; empty if that is not known.
    pieces: Vec<u32>,
    /// The pieces round the waist; those of a sleeve are others.
    of_trunk: BTreeSet<u32>,
}

/// A line round a garment and its length in the pattern, in metres.
#[derive(Debug, Clone)]
pub(super) struct Line {
    pub(super) curve: MeshLoop,
    pub(super) girth: f64,
}

impl<'a> Cut<'a> {
    /// The height up to which the garment reaches, in metres.
    pub(super) fn top(&self) -> f64 {
        let heights = self.nodes.iter().map(|node| f64::from(node.y));
        heights.fold(f64::NEG_INFINITY, f64::max)
    }

    /// `tape` is that round the body on which the garment lies.
    pub(super) fn new(garment: &'a BoundGarment, rest: Option<&'a RestShape>, tape: &Tape) -> Self {
        let weld = garment.cloth().weld();
        let node = |vertex: u32| weld.node_of_vertex()[vertex as usize];
        let faces = garment.mesh().faces().iter();
        let faces: Vec<[u32; 3]> = faces.map(|face| face.map(node)).collect();
        let flat = match rest {
            Some(RestShape::Flat { corners, .. }) if corners.len() == faces.len() => {
                Some(corners.as_slice())
            }
            _ => None,
        };
        let worn = match rest {
            Some(RestShape::Worn(positions))
                if positions.len() == garment.mesh().num_vertices() =>
            {
                Some(weld.gather(positions))
            }
            _ => None,
        };
        let mut cut = Self {
            garment,
            nodes: tape.own_places(garment.cloth().rest_nodes()),
            pieces: flat.map_or_else(Vec::new, |flat| pieces(&faces, flat)),
            faces,
            flat,
            worn,
            of_trunk: BTreeSet::new(),
        };
        cut.of_trunk = cut.pieces_round_waist(tape);
        cut
    }

    fn pieces_round_waist(&self, tape: &Tape) -> BTreeSet<u32> {
        let heights = [Measure::Waist, Measure::Chest].map(|measure| tape.height(measure));
        let ([Some(waist), Some(chest)], false) = (heights, self.pieces.is_empty()) else {
            return BTreeSet::new();
        };
        // Some garments end above the waist.
        let shares = [0.0, 0.25, 0.5, 0.75].into_iter();
        let mut lines =
            shares.filter_map(|share| self.round_trunk(tape, waist + share * (chest - waist)));
        let line = lines.next();
        line.iter().flat_map(|line| self.pieces_of(line)).collect()
    }

    fn pieces_of<'b>(&'b self, line: &'b Line) -> impl Iterator<Item = u32> + 'b {
        let segments = line.curve.segments().iter();
        segments.map(|segment| self.pieces[segment.face as usize])
    }

    /// Whether a line goes through the pieces round the waist alone, or through none of them, as
    /// above a seam round the waist: not through a sleeve, too, which hangs beside the chest where
    /// armholes are deep.
    pub(super) fn is_of_trunk(&self, line: &Line) -> bool {
        if self.of_trunk.is_empty() {
            return false;
        }
        let mut of_trunk = (self.pieces_of(line)).map(|piece| self.of_trunk.contains(&piece));
        let first = of_trunk.next();
        of_trunk.all(|is_of_trunk| Some(is_of_trunk) == first)
    }

    /// The shortest line round the trunk, and round no arm, at a height.
    pub(super) fn round_trunk(&self, tape: &Tape, height: f64) -> Option<Line> {
        let plane = tape.trunk_plane(Measure::Waist, height);
        self.line_round(tape, &plane, Tube::Trunk, &[Tube::LeftArm, Tube::RightArm])
    }

    pub(super) fn nodes(&self) -> &[Point3] {
        &self.nodes
    }

    pub(super) fn into_faces(self) -> Vec<[u32; 3]> {
        self.faces
    }

    /// The corners of a face as it was cut, in metres.
    fn corners(&self, face: u32) -> [Vector<f64>; 3] {
        if let Some(flat) = self.flat {
            return flat[face as usize].map(|[x, y]| Vector::new(f64::from(x), f64::from(y), 0.0));
        }
        let positions = self.worn.as_deref();
        let positions = positions.unwrap_or(self.garment.cloth().rest_nodes());
        self.faces[face as usize].map(|node| positions[node as usize].coords.cast())
    }

    /// The shortest line in a plane that goes round the middle of `tube` and not round those of
    /// `others`.
    pub(super) fn line_round(
        &self,
        tape: &Tape,
        plane: &TapePlane,
        tube: Tube,
        others: &[Tube],
    ) -> Option<Line> {
        let middle = tape.middle_in(tube, plane)?;
        let others = others
            .iter()
            .filter_map(|&tube| tape.middle_in(tube, plane));
        let others: Vec<Point<f64>> = others.collect();
        let nodes = &*self.nodes;
        let loops = plane_loops(&self.faces, nodes, &plane.center(), &plane.normal());
        let lines = loops.into_iter().filter_map(|curve| {
            let points = curve.points(&self.faces, nodes);
            let goes_round = |middle: &Point<f64>| winding(&points, middle, &plane.normal()) != 0;
            if !goes_round(&middle) || others.iter().any(goes_round) {
                return None;
            }
            let girth = curve.length(|face| self.corners(face));
            Some(Line { curve, girth })
        });
        lines.min_by(|a, b| a.girth.total_cmp(&b.girth))
    }
}

/// Numbers the pieces of cloth that faces were cut in `[face]`: in the flat they have no corner in
/// common.
fn pieces(faces: &[[u32; 3]], flat: &[[[f32; 2]; 3]]) -> Vec<u32> {
    let mut corners = BTreeMap::new();
    let mut number = |node: u32, [x, y]: [f32; 2]| {
        let next = corners.len() as u32;
        *corners
            .entry((node, x.to_bits(), y.to_bits()))
            .or_insert(next)
    };
    let apart = faces.iter().zip(flat);
    let apart: Vec<[u32; 3]> = apart
        .map(|(face, flat)| [0, 1, 2].map(|corner| number(face[corner], flat[corner])))
        .collect();
    Topology::new(corners.len(), &apart).face_components().0
}

/// How often a closed line in a plane goes round a point of that plane.
fn winding(points: &[Point<f64>], middle: &Point<f64>, normal: &Vector<f64>) -> i32 {
    let mut turn = 0.0;
    for (number, point) in points.iter().enumerate() {
        let [a, b] = [point, &points[(number + 1) % points.len()]].map(|point| point - middle);
        turn += normal.dot(&a.cross(&b)).atan2(a.dot(&b));
    }
    (turn / std::f64::consts::TAU).round() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_goes_round_its_middle_once_and_round_nothing_beside_it() {
        let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
        let mut points: Vec<Point<f64>> = corners.map(|[x, z]| Point::new(x, 0.0, z)).to_vec();
        let up = Vector::y();
        let found = winding(&points, &Point::new(0.2, 0.0, 0.3), &up);
        assert_eq!(found.abs(), 1);
        assert_eq!(winding(&points, &Point::new(1.5, 0.0, 0.0), &up), 0);
        points.reverse();
        assert_eq!(winding(&points, &Point::origin(), &up), -found);
    }
}
