//! Closing the holes of a mesh by faces between the vertices of their rims.

use std::collections::BTreeMap;

use garnet_mesh::{Point3, Vector3};

/// Ears that look to the other side than their rim are cut last: their diagonal counts as so many
/// times as long.
const TURNED: f32 = 100.0;

/// Faces that close holes, and how many holes there are.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Caps {
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) num_rims: usize,
}

impl Caps {
    /// Closes all holes of a mesh: each rim gets the faces that cut off its shortest diagonals, one
    /// after the other.
    pub(crate) fn of(positions: &[Point3], faces: &[[u32; 3]]) -> Self {
        let rims = rims(faces);
        let faces = rims.iter().flat_map(|rim| cap(positions, rim)).collect();
        Self {
            faces,
            num_rims: rims.len(),
        }
    }
}

/// The rims of a mesh, each a loop of different vertices, in the direction of faces that close it.
fn rims(faces: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let mut sides: Vec<(u32, u32, i32)> = Vec::with_capacity(3 * faces.len());
    for &[a, b, c] in faces {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            sides.push((from.min(to), from.max(to), if from < to { 1 } else { -1 }));
        }
    }
    sides.sort_unstable();
    // Where a side is run through more often one way than the other, caps run the other way.
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for same in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (low, high, _) = same[0];
        let balance: i32 = same.iter().map(|&(_, _, way)| way).sum();
        let (from, to) = if balance > 0 {
            (high, low)
        } else {
            (low, high)
        };
        let ends = next.entry(from).or_default();
        ends.extend(std::iter::repeat_n(to, balance.unsigned_abs() as usize));
    }
    next.retain(|_, ends| !ends.is_empty());
    let mut rims = Vec::new();
    while let Some(&start) = next.keys().next() {
        let mut path = vec![start];
        let mut place: BTreeMap<u32, usize> = BTreeMap::from([(start, 0)]);
        let mut at = start;
        while let Some(ends) = next.get_mut(&at) {
            let Some(to) = ends.pop() else {
                break;
            };
            if ends.is_empty() {
                next.remove(&at);
            }
            if let Some(&first) = place.get(&to) {
                // A rim is closed; one that touches itself is several.
                for vertex in &path[first + 1..] {
                    place.remove(vertex);
                }
                let rim = path.split_off(first);
                path.push(to);
                if rim.len() > 2 {
                    rims.push(rim);
                }
            } else {
                place.insert(to, path.len());
                path.push(to);
            }
            at = to;
        }
    }
    rims
}

/// The faces of a rim.
fn cap(positions: &[Point3], rim: &[u32]) -> Vec<[u32; 3]> {
    let at = |vertex: u32| positions[vertex as usize].coords;
    let origin = at(rim[0]);
    let around = rim.iter().zip(rim.iter().cycle().skip(1));
    let normal: Vector3 = around
        .map(|(&a, &b)| (at(a) - origin).cross(&(at(b) - origin)))
        .sum();
    let count = rim.len();
    let mut before: Vec<usize> = (0..count).map(|i| (i + count - 1) % count).collect();
    let mut after: Vec<usize> = (0..count).map(|i| (i + 1) % count).collect();
    let cost = |a: usize, b: usize, c: usize| {
        let [a, b, c] = [a, b, c].map(|place| at(rim[place]));
        let looks_away = (b - a).cross(&(c - a)).dot(&normal) < 0.0;
        (c - a).norm_squared() * if looks_away { TURNED } else { 1.0 }
    };
    // Costs are no less than zero, whose bits are in their order.
    let entry = |before: &[usize], after: &[usize], ear: usize| {
        (cost(before[ear], ear, after[ear]).to_bits(), ear)
    };
    let mut queue: std::collections::BTreeSet<(u32, usize)> =
        (0..count).map(|ear| entry(&before, &after, ear)).collect();
    let mut faces = Vec::with_capacity(count - 2);
    while faces.len() + 2 < count {
        let Some((_, ear)) = queue.pop_first() else {
            break;
        };
        let (left, right) = (before[ear], after[ear]);
        faces.push([rim[left], rim[ear], rim[right]]);
        for side in [left, right] {
            queue.remove(&entry(&before, &after, side));
        }
        (after[left], before[right]) = (right, left);
        for side in [left, right] {
            queue.insert(entry(&before, &after, side));
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;
    use garnet_knn::Surface;
    use garnet_mesh::TriMesh;
    use garnet_mesh::primitives::{icosphere, tube};

    fn closed(mesh: &TriMesh) -> (Caps, Surface) {
        let caps = Caps::of(mesh.positions(), mesh.faces());
        let faces = [mesh.faces(), &caps.faces].concat();
        let mesh = TriMesh::new(mesh.positions().to_vec(), faces).unwrap();
        (caps, Surface::new(&mesh))
    }

    #[test]
    fn closed_meshes_have_no_rims() {
        let ball = icosphere(2, 0.3);
        assert_eq!(Caps::of(ball.positions(), ball.faces()), Caps::default());
    }

    #[test]
    fn both_ends_of_a_tube_are_closed() {
        let (caps, skin) = closed(&tube(0.2, 0.6, 16, 4));
        assert_eq!((caps.num_rims, caps.faces.len()), (2, 2 * 14));
        assert!(skin.is_closed());
        assert!(skin.contains(Point3::new(0.05, 0.0, 0.05)));
        assert!(!skin.contains(Point3::new(0.0, 0.4, 0.0)));
    }

    #[test]
    fn holes_that_touch_are_closed_each_by_itself() {
        let ball = icosphere(2, 0.3);
        // Two faces that share a vertex only.
        let first = ball.faces()[0];
        let shares = |face: &[u32; 3]| face.iter().filter(|v| first.contains(v)).count();
        let other = ball
            .faces()
            .iter()
            .position(|face| shares(face) == 1)
            .unwrap();
        let faces: Vec<[u32; 3]> = (ball.faces().iter().enumerate())
            .filter(|&(face, _)| face != 0 && face != other)
            .map(|(_, face)| *face)
            .collect();
        let open = TriMesh::new(ball.positions().to_vec(), faces).unwrap();
        let (caps, skin) = closed(&open);
        assert_eq!((caps.num_rims, caps.faces.len()), (2, 2));
        assert!(skin.is_closed());
    }
}
