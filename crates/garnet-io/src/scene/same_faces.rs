//! Matching the vertices of two meshes by how their faces hang together, wherever they are: a rest
//! body and a rig whose vertices an exporter has split, numbered anew, and posed otherwise.
//!
//! Vertices at one place are one node. From one edge that both meshes have, all others follow: a
//! face is to the left of an edge in both, and its next corner is the same in both.

use std::collections::{HashMap, HashSet};

use garnet_mesh::{Bounds, Point3, is_inside_out};
use garnet_skin::Weld;
use nalgebra::{Matrix3, Vector3};

/// Starts that are tried for a part of a mesh, the likeliest first.
const NUM_STARTS: usize = 64;

/// How often what is known of nodes is told to their neighbours, to tell them apart.
const NUM_ROUNDS: usize = 12;

/// A mesh whose vertices are to be matched.
#[derive(Debug, Clone, Copy)]
pub(super) struct Faces<'a> {
    pub(super) positions: &'a [Point3],
    pub(super) triangles: &'a [[u32; 3]],
    /// Edges of the polygons that triangles were cut from, if that is known.
    pub(super) edges: &'a [[u32; 2]],
}

/// For each vertex of `mesh` the vertex of `known` that has its place among the faces; nothing if
/// the faces are others, or those of the mirror image.
pub(super) fn same_vertices(known: &Faces<'_>, mesh: &Faces<'_>) -> Option<Vec<u32>> {
    let [known_weld, weld] = [known, mesh].map(|mesh| Weld::new(mesh.positions));
    if weld.num_nodes() != known_weld.num_nodes() {
        return None;
    }
    let of_triangles = || {
        let [known, mesh] = [known, mesh].map(|mesh| mesh.triangles.iter().map(|f| f.to_vec()));
        Some([known.collect(), mesh.collect()])
    };
    let found = [of_triangles(), polygons_of(known, mesh)]
        .into_iter()
        .flatten();
    let mut found = found.filter_map(|[of_known, own]: [Vec<Vec<u32>>; 2]| {
        let known = Polygons::new(known, &known_weld, of_known)?;
        let own = Polygons::new(mesh, &weld, own)?;
        let map = own.matched(&known)?;
        (!own.is_mirrored(&known, &map)).then_some(map)
    });
    let map = found.next()?;
    let mut first = vec![u32::MAX; known_weld.num_nodes()];
    for (vertex, &node) in (0_u32..).zip(known_weld.node_of_vertex()) {
        let first = &mut first[node as usize];
        *first = vertex.min(*first);
    }
    let nodes = weld.node_of_vertex().iter();
    Some(
        nodes
            .map(|&node| first[map[node as usize] as usize])
            .collect(),
    )
}

/// The polygons of both meshes, in the order of the file that tells them: an exporter cuts them in
/// other ways than a reader, but one after the other.
fn polygons_of(known: &Faces<'_>, mesh: &Faces<'_>) -> Option<[Vec<Vec<u32>>; 2]> {
    if known.triangles.len() != mesh.triangles.len() {
        return None;
    }
    let sizes = [known, mesh].map(|mesh| sizes_of(mesh));
    let told = sizes
        .iter()
        .flatten()
        .find(|sizes| sizes.iter().any(|&size| size > 1))?;
    let cut = |mesh: &Faces<'_>, own: &Option<Vec<usize>>| {
        let mut rest = mesh.triangles;
        let sizes = own.as_ref().unwrap_or(told).iter();
        let polygons = sizes.map(|&size| {
            let (first, others) = rest.split_at_checked(size)?;
            rest = others;
            outline(first)
        });
        polygons.collect::<Option<Vec<Vec<u32>>>>()
    };
    Some([cut(known, &sizes[0])?, cut(mesh, &sizes[1])?])
}

/// How many triangles each polygon was cut into, if edges tell it: as a fan, one after the other.
fn sizes_of(mesh: &Faces<'_>) -> Option<Vec<usize>> {
    if mesh.edges.is_empty() {
        return None;
    }
    let edges: HashSet<[u32; 2]> = mesh.edges.iter().map(|&edge| sorted(edge)).collect();
    let mut sizes: Vec<usize> = Vec::new();
    for (number, face) in mesh.triangles.iter().enumerate() {
        let before = number.checked_sub(1).map(|before| mesh.triangles[before]);
        let goes_on = before.is_some_and(|before| {
            before[0] == face[0]
                && before[2] == face[1]
                && !edges.contains(&sorted([face[0], face[1]]))
        });
        match sizes.last_mut() {
            Some(size) if goes_on => *size += 1,
            _ => sizes.push(1),
        }
    }
    Some(sizes)
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The corners of the polygon that some triangles make together.
fn outline(triangles: &[[u32; 3]]) -> Option<Vec<u32>> {
    let sides = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let sides: Vec<[u32; 2]> = sides.collect();
    let is_outer = |[a, b]: &&[u32; 2]| !sides.contains(&[*b, *a]);
    let outer: Vec<[u32; 2]> = sides.iter().filter(is_outer).copied().collect();
    let mut corners = vec![outer.first()?[0]];
    for _ in 1..outer.len() {
        let last = corners[corners.len() - 1];
        corners.push(outer.iter().find(|side| side[0] == last)?[1]);
    }
    let is_whole = corners.len() == triangles.len() + 2;
    is_whole.then_some(corners)
}

/// A mesh of polygons between nodes.
struct Polygons {
    all: Vec<Vec<u32>>,
    places: Vec<Point3>,
    /// The polygon to the left of an edge, and the corner at which that starts.
    left: HashMap<[u32; 2], (u32, u32)>,
    /// Ends of the edges that start at each node `[node]`.
    ends: Vec<Vec<u32>>,
    /// What tells nodes apart `[node]`.
    marks: Vec<u64>,
}

impl Polygons {
    /// Nothing if faces do not look to one side, if more than two meet at an edge, or if there are
    /// nodes without a face.
    fn new(mesh: &Faces<'_>, weld: &Weld, polygons: Vec<Vec<u32>>) -> Option<Self> {
        let is_turned = is_inside_out(mesh.positions, mesh.triangles);
        let mut polygons = polygons;
        let mut left = HashMap::new();
        let mut ends = vec![Vec::new(); weld.num_nodes()];
        for (number, polygon) in (0_u32..).zip(&mut polygons) {
            for corner in polygon.iter_mut() {
                *corner = weld.node_of_vertex()[*corner as usize];
            }
            if is_turned {
                polygon.reverse();
            }
            for (corner, side) in (0_u32..).zip(sides(polygon)) {
                ends[side[0] as usize].push(side[1]);
                if side[0] == side[1] || left.insert(side, (number, corner)).is_some() {
                    return None;
                }
            }
        }
        if ends.iter().any(Vec::is_empty) {
            return None;
        }
        let mut marks: Vec<u64> = ends.iter().map(|ends| ends.len() as u64).collect();
        for _ in 0..NUM_ROUNDS {
            let mut next: Vec<u64> = marks.iter().map(|&mark| mixed(mark)).collect();
            for polygon in &polygons {
                let size = polygon.len();
                for (corner, &node) in polygon.iter().enumerate() {
                    // Left and right count differently.
                    let others = (1..size).map(|step| polygon[(corner + step) % size]);
                    let told = others.fold(size as u64, |told, other| {
                        mixed(told ^ marks[other as usize])
                    });
                    let next = &mut next[node as usize];
                    *next = next.wrapping_add(told);
                }
            }
            marks = next;
        }
        Some(Self {
            all: polygons,
            places: weld.gather(mesh.positions),
            left,
            ends,
            marks,
        })
    }

    /// The node of `known` that each node is `[node]`.
    fn matched(&self, known: &Self) -> Option<Vec<u32>> {
        let sorted = |marks: &[u64]| {
            let mut marks = marks.to_vec();
            marks.sort_unstable();
            marks
        };
        if self.all.len() != known.all.len() || sorted(&self.marks) != sorted(&known.marks) {
            return None;
        }
        let mut of_mark: HashMap<u64, Vec<u32>> = HashMap::new();
        for (node, &mark) in (0_u32..).zip(&known.marks) {
            of_mark.entry(mark).or_default().push(node);
        }
        let alike = |node: u32| &of_mark[&self.marks[node as usize]];
        // The node that the fewest are like comes first.
        let mut order: Vec<u32> = (0..self.marks.len() as u32).collect();
        order.sort_by_key(|&node| alike(node).len());
        let mut found = Matching {
            map: vec![u32::MAX; self.marks.len()],
            is_taken: vec![false; known.marks.len()],
        };
        let near = self.nearness(known);
        for start in order {
            if found.map[start as usize] != u32::MAX {
                continue;
            }
            let end = self.ends[start as usize][0];
            let mut starts: Vec<[u32; 2]> = Vec::new();
            for &other in alike(start) {
                let ends = known.ends[other as usize].iter();
                let ends =
                    ends.filter(|&&other| known.marks[other as usize] == self.marks[end as usize]);
                starts.extend(ends.map(|&end| [other, end]));
            }
            let far = |&[from, to]: &[u32; 2]| near(start, from) + near(end, to);
            starts.sort_by(|a, b| far(a).total_cmp(&far(b)));
            // Of several ways, as on what is round, the one that moves nodes least.
            let mut best: Option<(f64, Vec<[u32; 2]>)> = None;
            for other in starts.into_iter().take(NUM_STARTS) {
                let Some(pairs) = self.spread(known, ([start, end], other), &mut found) else {
                    continue;
                };
                let far = pairs
                    .iter()
                    .map(|&[node, other]| f64::from(near(node, other)));
                let far: f64 = far.sum();
                if best.as_ref().is_none_or(|(least, _)| far < *least) {
                    best = Some((far, pairs));
                }
            }
            for [node, other] in best?.1 {
                found.take(node, other);
            }
        }
        Some(found.map)
    }

    /// How far a node is from one of `known`, as far as both meshes lie in one frame.
    fn nearness<'a>(&'a self, known: &'a Self) -> impl Fn(u32, u32) -> f32 + 'a {
        let normed = |places: &[Point3]| -> Vec<Point3> {
            let bounds = Bounds::of(places).unwrap_or_default();
            let size = bounds.diagonal().max(f32::MIN_POSITIVE);
            let middle = nalgebra::center(&bounds.min, &bounds.max);
            places
                .iter()
                .map(|place| Point3::from((place - middle) / size))
                .collect()
        };
        let (own, others) = (normed(&self.places), normed(&known.places));
        move |node, other| (own[node as usize] - others[other as usize]).norm()
    }

    /// The pairs of nodes that follow from one edge; nothing if they contradict each other or those
    /// that are known. What is known is left as it was.
    fn spread(
        &self,
        known: &Self,
        start: ([u32; 2], [u32; 2]),
        found: &mut Matching,
    ) -> Option<Vec<[u32; 2]>> {
        let mut pairs = Vec::new();
        let mut is_seen = HashSet::new();
        let mut queue = vec![start];
        let mut is_sound = true;
        while let (Some((edge, other)), true) = (queue.pop(), is_sound) {
            let (face, known_face) = match (self.left.get(&edge), known.left.get(&other)) {
                (Some(&face), Some(&known_face)) => (face, known_face),
                (face, known_face) => {
                    // The rim of one is that of the other.
                    is_sound = face.is_none() && known_face.is_none();
                    continue;
                }
            };
            if !is_seen.insert(face.0) {
                continue;
            }
            let own = rotated(&self.all[face.0 as usize], face.1);
            let others = rotated(&known.all[known_face.0 as usize], known_face.1);
            is_sound = own.len() == others.len()
                && own.iter().zip(&others).all(|(&node, &other)| {
                    let taken = found.take(node, other);
                    if taken == Taken::New {
                        pairs.push([node, other]);
                    }
                    taken != Taken::Not
                });
            let both = sides(&own).zip(sides(&others));
            queue.extend(both.map(|([a, b], [c, d])| ([b, a], [d, c])));
        }
        for &[node, other] in &pairs {
            found.map[node as usize] = u32::MAX;
            found.is_taken[other as usize] = false;
        }
        is_sound.then_some(pairs)
    }

    /// Whether left is right in `known`.
    fn is_mirrored(&self, known: &Self, map: &[u32]) -> bool {
        let middle = |places: &[Point3]| {
            let sum: Vector3<f64> = places.iter().map(|place| place.coords.cast::<f64>()).sum();
            sum / places.len().max(1) as f64
        };
        let [own, other] = [middle(&self.places), middle(&known.places)];
        let pairs = self.places.iter().zip(map);
        let sum: Matrix3<f64> = pairs
            .map(|(place, &node)| {
                let there = known.places[node as usize].coords.cast::<f64>() - other;
                (place.coords.cast::<f64>() - own) * there.transpose()
            })
            .sum();
        sum.determinant() < 0.0
    }
}

/// Which node of a known mesh nodes are.
struct Matching {
    map: Vec<u32>,
    is_taken: Vec<bool>,
}

/// Whether a node was taken for another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Taken {
    New,
    Known,
    /// One of both is another one's.
    Not,
}

impl Matching {
    /// Takes a node for one of the known mesh.
    fn take(&mut self, node: u32, other: u32) -> Taken {
        let place = &mut self.map[node as usize];
        if *place == other {
            return Taken::Known;
        }
        let is_taken = &mut self.is_taken[other as usize];
        if *place != u32::MAX || std::mem::replace(is_taken, true) {
            return Taken::Not;
        }
        *place = other;
        Taken::New
    }
}

fn sides(polygon: &[u32]) -> impl Iterator<Item = [u32; 2]> + '_ {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).map(|(&a, &b)| [a, b])
}

fn rotated(polygon: &[u32], first: u32) -> Vec<u32> {
    let (before, after) = polygon.split_at(first as usize);
    [after, before].concat()
}

/// Bits of a number mixed, as of Steele, Lea and Flood 2014 (`SplitMix`).
fn mixed(value: u64) -> u64 {
    let value = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let value = (value ^ (value >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let value = (value ^ (value >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    value ^ (value >> 31)
}

#[cfg(test)]
mod tests {
    use garnet_mesh::{TriMesh, primitives::capsule};

    use super::*;

    fn faces(mesh: &TriMesh) -> Faces<'_> {
        Faces {
            positions: mesh.positions(),
            triangles: mesh.faces(),
            edges: &[],
        }
    }

    /// A body without symmetry: some faces are cut once more.
    fn body() -> TriMesh {
        let mesh = capsule(0.2, 1.4, 16, 12);
        let (mut places, mut faces) = mesh.into_parts();
        for number in [40, 97, 98, 151] {
            let [a, b, c] = faces[number];
            let sum: Vector3<f32> = [a, b, c].iter().map(|&v| places[v as usize].coords).sum();
            let middle = places.len() as u32;
            places.push(Point3::from(sum / 3.0));
            faces[number] = [a, b, middle];
            faces.extend([[b, c, middle], [c, a, middle]]);
        }
        TriMesh::new(places, faces).unwrap()
    }

    /// The same with corners of its own for each face, in another order, bent.
    fn split(mesh: &TriMesh) -> (TriMesh, Vec<u32>) {
        let count = mesh.num_faces();
        let order = (0..count).map(|face| face * 7 % count);
        let corners: Vec<u32> = order
            .flat_map(|face| {
                let [a, b, c] = mesh.faces()[face];
                [[a, b, c], [b, c, a], [c, a, b]][face % 3]
            })
            .collect();
        let bent = |&vertex: &u32| {
            let place = mesh.positions()[vertex as usize];
            Point3::new(place.x, place.y, place.z + place.y * place.y) * 100.0
        };
        let places = corners.iter().map(bent).collect();
        let faces = (0..count as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]);
        let split = TriMesh::new(places, faces.collect()).unwrap();
        (split, corners)
    }

    #[test]
    fn split_vertices_are_matched_in_any_order_and_pose() {
        let mesh = body();
        let (split, corners) = split(&mesh);
        let found = same_vertices(&faces(&mesh), &faces(&split)).unwrap();
        assert_eq!(found, corners);
        let found = same_vertices(&faces(&split), &faces(&mesh)).unwrap();
        let back = found.iter().map(|&vertex| corners[vertex as usize]);
        assert!(back.eq(0..mesh.num_vertices() as u32));
    }

    #[test]
    fn inside_out_meshes_are_matched_and_mirror_images_are_not() {
        let mesh = body();
        let (split, corners) = split(&mesh);
        let turned = split.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
        let turned = TriMesh::new(split.positions().to_vec(), turned).unwrap();
        assert_eq!(
            same_vertices(&faces(&mesh), &faces(&turned)).unwrap(),
            corners
        );
        let mirrored = split
            .positions()
            .iter()
            .map(|p| Point3::new(-p.x, p.y, p.z));
        let mirrored = split.with_positions(mirrored.collect()).unwrap();
        assert_eq!(same_vertices(&faces(&mesh), &faces(&mirrored)), None);
    }

    #[test]
    fn other_faces_are_not_matched() {
        let mesh = body();
        let mut others = mesh.faces().to_vec();
        others.swap_remove(5);
        let other = TriMesh::new(mesh.positions().to_vec(), others).unwrap();
        assert_eq!(same_vertices(&faces(&mesh), &faces(&other)), None);
        let other = capsule(0.2, 1.4, 17, 12);
        assert_eq!(same_vertices(&faces(&mesh), &faces(&other)), None);
    }

    #[test]
    fn polygons_that_were_cut_otherwise_are_matched_in_their_order() {
        // A strip of quads that is bent; the middle one has a fifth corner.
        let place = |number: u32| {
            let along = number as f32 * 0.5;
            Point3::new(along.floor(), (number % 2) as f32, 0.02 * along * along)
        };
        let places: Vec<Point3> = (0..14).map(place).collect();
        let quads = (0..6_u32).map(|quad| [2 * quad, 2 * quad + 2, 2 * quad + 3, 2 * quad + 1]);
        let edges: Vec<[u32; 2]> = quads
            .clone()
            .flat_map(|quad| {
                let [a, b, c, d] = quad;
                [[a, b], [b, c], [c, d], [d, a]]
            })
            .collect();
        let as_read = quads
            .clone()
            .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect();
        let as_cut = quads
            .flat_map(|[a, b, c, d]| [[b, c, d], [b, d, a]])
            .collect();
        let read = TriMesh::new(places.clone(), as_read).unwrap();
        let cut = TriMesh::new(places, as_cut).unwrap();
        let of_read = Faces {
            edges: &edges,
            ..faces(&read)
        };
        let found = same_vertices(&faces(&cut), &of_read).unwrap();
        assert!(found.into_iter().eq(0..14));
    }
}
