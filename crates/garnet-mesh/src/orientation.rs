//! To which side the faces of a mesh look.

use std::collections::HashMap;

use crate::{Bounds, Point3};

/// A mesh whose faces enclose less than this share of its box, in size, has no side that is surely
/// the inner one.
const MIN_ENCLOSED: f64 = 1e-3;

/// Whether most of the faces of a mesh look inwards: the volume that they enclose is negative. An
/// open mesh is closed by cones from the middle of its box.
///
/// ```
/// use garnet_mesh::{is_inside_out, primitives::icosphere};
///
/// let ball = icosphere(2, 1.0);
/// let turned: Vec<[u32; 3]> = ball.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
/// assert!(!is_inside_out(ball.positions(), ball.faces()));
/// assert!(is_inside_out(ball.positions(), &turned));
/// ```
///
/// # Panics
///
/// If a face names a vertex that there is not.
pub fn is_inside_out(positions: &[Point3], faces: &[[u32; 3]]) -> bool {
    enclosed(positions, faces) < -MIN_ENCLOSED
}

/// The volume that faces enclose with the middle of their box, over that of the box: negative if
/// they look inwards; 0 of flat ones.
fn enclosed(positions: &[Point3], faces: &[[u32; 3]]) -> f64 {
    let Some(bounds) = Bounds::of_faces(positions, faces) else {
        return 0.0;
    };
    let middle = nalgebra::center(&bounds.min, &bounds.max);
    let corner = |vertex: u32| (positions[vertex as usize] - middle).cast::<f64>();
    let cones = faces.iter().map(|face| face.map(corner));
    let enclosed: f64 = cones.map(|[a, b, c]| a.cross(&b).dot(&c) / 6.0).sum();
    let extent = bounds.extent().cast::<f64>();
    let of_box = extent.x * extent.y * extent.z;
    if of_box > 0.0 { enclosed / of_box } else { 0.0 }
}

/// A piece with rims encloses at least this share of its box, or it has no side that is surely the
/// inner one. Higher leaves more pieces as they are.
const MIN_ENCLOSED_OPEN: f64 = 0.05;

/// Faces that look outwards.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Outward {
    /// The faces in their order, some turned.
    pub faces: Vec<[u32; 3]>,
    /// How many were turned.
    pub num_turned: usize,
    /// Faces that have the corners of an earlier one, as those of two-sided exports: each looks to
    /// the side of that one.
    pub doubles: Vec<u32>,
}

/// Turns the faces of the surface of a body so that all look outwards: faces that meet at an edge
/// look to the same side, that of most of their area, and closed pieces look away from what they
/// enclose. Vertices at one place are one. At edges of three faces or more, pieces end.
///
/// ```
/// use garnet_mesh::{outward_faces, primitives::icosphere};
///
/// let ball = icosphere(2, 1.0);
/// let mut faces = ball.faces().to_vec();
/// faces[..100].iter_mut().for_each(|face| face.swap(1, 2));
/// let outward = outward_faces(ball.positions(), &faces);
/// assert_eq!(outward.num_turned, 100);
/// ```
///
/// # Panics
///
/// If a face names a vertex that there is not.
pub fn outward_faces(positions: &[Point3], faces: &[[u32; 3]]) -> Outward {
    let at_place = vertices_by_place(positions);
    let corners = |face: &[u32; 3]| face.map(|vertex| at_place[vertex as usize]);
    let mut first_of: HashMap<[u32; 3], u32> = HashMap::with_capacity(faces.len());
    let mut first = Vec::with_capacity(faces.len());
    for (number, face) in (0_u32..).zip(faces) {
        let mut key = corners(face);
        key.sort_unstable();
        first.push(*first_of.entry(key).or_insert(number));
    }
    let is_first = |number: u32| first[number as usize] == number;
    let singles = (0..faces.len() as u32).filter(|&number| is_first(number));
    let singles: Vec<u32> = singles.collect();
    let mut sides: Vec<Side> = Vec::with_capacity(3 * singles.len());
    for &face in &singles {
        let [a, b, c] = corners(&faces[face as usize]);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            if from != to {
                sides.push(Side {
                    ends: [from.min(to), from.max(to)],
                    face,
                    runs_upward: from < to,
                });
            }
        }
    }
    sides.sort_unstable();
    let mut pieces = Pieces::new(faces.len());
    for group in sides.chunk_by(|a, b| a.ends == b.ends) {
        pieces.meet(group);
    }
    let mut outward = faces.to_vec();
    let mut num_turned = 0;
    for piece in pieces.found(&singles) {
        let area = |&(face, is_turned): &(u32, bool)| {
            let [a, b, c] = faces[face as usize].map(|vertex| positions[vertex as usize]);
            let area = f64::from((b - a).cross(&(c - a)).norm());
            if is_turned { -area } else { area }
        };
        let most = piece.faces.iter().map(area).sum::<f64>();
        let turned = |turns_all: bool| {
            let of_piece = piece.faces.iter();
            of_piece.map(move |&(face, is_turned)| (face, is_turned != turns_all))
        };
        let mut turns_all = most < 0.0;
        let seen: Vec<[u32; 3]> = turned(turns_all)
            .map(|(face, is_turned)| turned_if(faces[face as usize], is_turned))
            .collect();
        let least = match (piece.is_closed, piece.is_apart) {
            (true, _) => Some(MIN_ENCLOSED),
            (false, true) => Some(MIN_ENCLOSED_OPEN),
            (false, false) => None,
        };
        if least.is_some_and(|least| enclosed(positions, &seen) < -least) {
            turns_all = !turns_all;
        }
        for (face, is_turned) in turned(turns_all) {
            outward[face as usize] = turned_if(faces[face as usize], is_turned);
            num_turned += usize::from(is_turned);
        }
    }
    let doubles = (0..faces.len() as u32).filter(|&number| !is_first(number));
    let doubles: Vec<u32> = doubles.collect();
    for &double in &doubles {
        let side = corners(&outward[first[double as usize] as usize]);
        let own = corners(&faces[double as usize]);
        if !is_rotation(own, side) {
            outward[double as usize].swap(1, 2);
        }
    }
    Outward {
        faces: outward,
        num_turned,
        doubles,
    }
}

fn turned_if([a, b, c]: [u32; 3], is_turned: bool) -> [u32; 3] {
    if is_turned { [a, c, b] } else { [a, b, c] }
}

/// Whether two lists of the same three corners go round in the same way.
fn is_rotation(own: [u32; 3], other: [u32; 3]) -> bool {
    let [a, b, c] = own;
    other == [a, b, c] || other == [b, c, a] || other == [c, a, b]
}

/// A number for each vertex that is the same for all at its place `[vertex]`.
fn vertices_by_place(positions: &[Point3]) -> Vec<u32> {
    let mut first = HashMap::with_capacity(positions.len());
    let number = |(vertex, place): (u32, &Point3)| {
        // Both zeros are one.
        let place = [place.x, place.y, place.z].map(|coordinate| (coordinate + 0.0).to_bits());
        *first.entry(place).or_insert(vertex)
    };
    (0_u32..).zip(positions).map(number).collect()
}

/// A side of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    ends: [u32; 2],
    face: u32,
    runs_upward: bool,
}

/// Which faces meet, and whether they look to the same side there.
struct Pieces {
    /// Over an edge of two faces: the other one, and whether one of both has to turn `[face]`.
    across: Vec<Vec<(u32, bool)>>,
    /// Whether a face has an edge of its own alone `[face]`.
    has_rim: Vec<bool>,
    /// Whether a face has an edge of three faces or more `[face]`.
    has_branch: Vec<bool>,
}

/// Faces that meet at edges of two.
struct Piece {
    /// With whether a face looks to the other side than the first.
    faces: Vec<(u32, bool)>,
    is_closed: bool,
    /// Whether it touches no other piece at an edge.
    is_apart: bool,
}

impl Pieces {
    fn new(num_faces: usize) -> Self {
        Self {
            across: vec![Vec::new(); num_faces],
            has_rim: vec![false; num_faces],
            has_branch: vec![false; num_faces],
        }
    }

    /// Takes all sides at an edge.
    fn meet(&mut self, sides: &[Side]) {
        match sides {
            [one, other] if one.face != other.face => {
                let differ = one.runs_upward == other.runs_upward;
                self.across[one.face as usize].push((other.face, differ));
                self.across[other.face as usize].push((one.face, differ));
            }
            [alone] => self.has_rim[alone.face as usize] = true,
            _ => {
                for side in sides {
                    self.has_branch[side.face as usize] = true;
                }
            }
        }
    }

    fn found(&self, faces: &[u32]) -> Vec<Piece> {
        let mut is_seen = vec![false; self.across.len()];
        let mut pieces = Vec::new();
        for &start in faces {
            if std::mem::replace(&mut is_seen[start as usize], true) {
                continue;
            }
            let mut found = vec![(start, false)];
            let mut next = 0;
            while let Some(&(face, is_turned)) = found.get(next) {
                next += 1;
                for &(other, differ) in &self.across[face as usize] {
                    if !std::mem::replace(&mut is_seen[other as usize], true) {
                        found.push((other, is_turned != differ));
                    }
                }
            }
            let any = |of: &[bool]| found.iter().any(|&(face, _)| of[face as usize]);
            let (has_rim, has_branch) = (any(&self.has_rim), any(&self.has_branch));
            pieces.push(Piece {
                faces: found,
                is_closed: !has_rim && !has_branch,
                is_apart: !has_branch,
            });
        }
        pieces
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TriMesh;
    use crate::primitives::{icosphere, tube};

    fn turned(faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
        faces.iter().map(|&[a, b, c]| [a, c, b]).collect()
    }

    /// Two meshes as one.
    fn together(one: &TriMesh, other: &TriMesh) -> (Vec<Point3>, Vec<[u32; 3]>) {
        let count = one.num_vertices() as u32;
        let places = one.positions().iter().chain(other.positions());
        let faces = other
            .faces()
            .iter()
            .map(|face| face.map(|corner| corner + count));
        (
            places.copied().collect(),
            one.faces().iter().copied().chain(faces).collect(),
        )
    }

    #[test]
    fn faces_that_look_outwards_are_left() {
        for mesh in [icosphere(2, 1.0), tube(0.1, 0.4, 12, 6)] {
            let outward = outward_faces(mesh.positions(), mesh.faces());
            assert_eq!(outward.faces, mesh.faces());
            assert_eq!((outward.num_turned, outward.doubles.len()), (0, 0));
        }
    }

    #[test]
    fn any_part_of_a_closed_mesh_is_turned_back() {
        let ball = icosphere(2, 1.0);
        for step in 1..5 {
            let faces = (0..).zip(ball.faces()).map(|(number, &[a, b, c])| {
                if number % step == 0 {
                    [a, c, b]
                } else {
                    [a, b, c]
                }
            });
            let faces: Vec<[u32; 3]> = faces.collect();
            let outward = outward_faces(ball.positions(), &faces);
            assert_eq!(outward.faces, ball.faces(), "{step}");
            assert_eq!(outward.num_turned, ball.num_faces().div_ceil(step));
        }
    }

    #[test]
    fn seams_do_not_part_a_mesh() {
        let ball = icosphere(1, 1.0);
        // Each face has corners of its own.
        let places = ball.faces().as_flattened().iter();
        let places: Vec<Point3> = places.map(|&v| ball.positions()[v as usize]).collect();
        let whole: Vec<[u32; 3]> = (0..ball.num_faces() as u32)
            .map(|face| [3 * face, 3 * face + 1, 3 * face + 2])
            .collect();
        let mut faces = whole.clone();
        faces[7].swap(1, 2);
        assert_eq!(outward_faces(&places, &faces).faces, whole);
    }

    #[test]
    fn inner_walls_and_turned_pieces_look_outwards() {
        let (skin, wall) = (icosphere(2, 1.0), icosphere(2, 0.9));
        let wall = TriMesh::new(wall.positions().to_vec(), turned(wall.faces())).unwrap();
        let (places, faces) = together(&skin, &wall);
        let outward = outward_faces(&places, &faces);
        assert_eq!(outward.num_turned, wall.num_faces());
        let sleeve = tube(0.1, 0.4, 12, 6);
        let sleeve = TriMesh::new(sleeve.positions().to_vec(), turned(sleeve.faces())).unwrap();
        let (places, faces) = together(&skin, &sleeve);
        assert_eq!(
            outward_faces(&places, &faces).num_turned,
            sleeve.num_faces()
        );
        // A sheet has no inner side.
        let sheet = crate::primitives::grid(4, 4, [1.0, 1.0]);
        for faces in [sheet.faces().to_vec(), turned(sheet.faces())] {
            assert_eq!(outward_faces(sheet.positions(), &faces).faces, faces);
        }
    }

    #[test]
    fn doubles_are_named_and_look_as_their_first() {
        let ball = icosphere(2, 1.0);
        for other in [ball.faces().to_vec(), turned(ball.faces())] {
            let faces: Vec<[u32; 3]> = ball.faces().iter().copied().chain(other).collect();
            let outward = outward_faces(ball.positions(), &faces);
            let count = ball.num_faces() as u32;
            assert_eq!(outward.doubles, (count..2 * count).collect::<Vec<_>>());
            assert_eq!(&outward.faces[..count as usize], ball.faces());
            for (one, other) in ball.faces().iter().zip(&outward.faces[count as usize..]) {
                assert!(is_rotation(*other, *one));
            }
        }
    }
}
