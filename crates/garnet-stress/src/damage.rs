//! Meshes that are made worse.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use garnet_body::shape::{ParametricBody, tape_measures};
use garnet_mesh::primitives::icosphere;
use garnet_mesh::{Point3, Topology, TriMesh, subdivided, vertex_normals};
use garnet_skin::{Body, SkinWeights};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::StressError;

/// Split into four as often as it takes.
pub(crate) fn finer(mesh: &TriMesh, times: f64) -> Result<TriMesh, StressError> {
    let mut finer = mesh.clone();
    let mut count = 1.0;
    while 4.0 * count <= times {
        finer = subdivided(&finer)?;
        count *= 4.0;
    }
    Ok(finer)
}

pub(crate) fn finer_body(body: &Body, times: f64) -> Result<Body, StressError> {
    if times < 4.0 {
        return Ok(body.clone());
    }
    let rest = body.rest();
    let topology = Topology::new(rest.num_vertices(), rest.faces());
    let of_vertex = |vertex: u32| body.weights().vertex(vertex as usize);
    let old = (0..rest.num_vertices() as u32).map(|vertex| of_vertex(vertex).collect());
    let middles = topology.edges().iter().map(|&[a, b]| {
        let ends = of_vertex(a).chain(of_vertex(b));
        ends.map(|(joint, weight)| (joint, 0.5 * weight)).collect()
    });
    let rows: Vec<Vec<(usize, f32)>> = old.chain(middles).collect();
    let weights = SkinWeights::from_influences(body.skeleton().num_joints(), rows)?;
    Ok(Body::new(
        subdivided(rest)?,
        body.skeleton().clone(),
        weights,
    )?)
}

/// The coarse level, of a quarter of the vertices; none for bodies that are not built in, and for
/// other shares.
pub(crate) fn coarser_body(body: &Body, times: f64) -> Result<Option<Body>, StressError> {
    if times <= 1.0 {
        return Ok(Some(body.clone()));
    }
    if times > 4.0 || tape_measures(body).is_none() {
        return Ok(None);
    }
    let rest = ParametricBody::coarse(body.rest().positions());
    let kept = ParametricBody::coarse_vertices().iter();
    let rows = kept.map(|&vertex| body.weights().vertex(vertex as usize).collect::<Vec<_>>());
    let weights = SkinWeights::from_influences(body.skeleton().num_joints(), rows)?;
    Ok(Some(Body::new(rest, body.skeleton().clone(), weights)?))
}

/// Without so many percent of its faces, in patches; each seed takes others.
///
/// # Errors
///
/// [`StressError`], if no face is left.
pub fn without_patches(mesh: &TriMesh, percent: f64, seed: u64) -> Result<TriMesh, StressError> {
    with_holes(mesh, percent, &mut ChaCha8Rng::seed_from_u64(seed))
}

/// Without so many percent of its faces, in patches.
pub(crate) fn with_holes(
    mesh: &TriMesh,
    percent: f64,
    random: &mut ChaCha8Rng,
) -> Result<TriMesh, StressError> {
    let gone = patches(mesh, percent, random);
    let kept = mesh.faces().iter().enumerate();
    let kept = kept.filter(|(face, _)| !gone.contains(face));
    Ok(TriMesh::new(
        mesh.positions().to_vec(),
        kept.map(|(_, corners)| *corners).collect(),
    )?)
}

/// With so many percent of its faces turned to the other side, in patches.
pub(crate) fn turned_in_patches(
    mesh: &TriMesh,
    percent: f64,
    random: &mut ChaCha8Rng,
) -> Result<TriMesh, StressError> {
    let mut faces = mesh.faces().to_vec();
    for face in patches(mesh, percent, random) {
        faces[face].swap(1, 2);
    }
    Ok(TriMesh::new(mesh.positions().to_vec(), faces)?)
}

/// So many percent of the faces, in patches of a few hundred.
fn patches(mesh: &TriMesh, percent: f64, random: &mut ChaCha8Rng) -> BTreeSet<usize> {
    const PATCH: usize = 150;
    let count = mesh.num_faces();
    let asked = (0.01 * percent * count as f64) as usize;
    let topology = Topology::new(mesh.num_vertices(), mesh.faces());
    let mut of_edge = vec![Vec::new(); topology.edges().len()];
    let edge_of = |a: u32, b: u32| topology.edges().binary_search(&[a.min(b), a.max(b)]).ok();
    let edges_of = |face: usize| {
        let [a, b, c] = mesh.faces()[face];
        [edge_of(a, b), edge_of(b, c), edge_of(c, a)]
            .into_iter()
            .flatten()
    };
    for face in 0..count {
        for edge in edges_of(face) {
            of_edge[edge].push(face);
        }
    }
    let mut gone: BTreeSet<usize> = BTreeSet::new();
    while gone.len() < asked {
        let mut queue = VecDeque::from([random.random_range(0..count)]);
        let mut taken = 0;
        while let Some(face) = queue.pop_front() {
            if taken >= PATCH || gone.len() >= asked {
                break;
            }
            if gone.insert(face) {
                taken += 1;
                queue.extend(edges_of(face).flat_map(|edge| of_edge[edge].iter().copied()));
            }
        }
    }
    gone
}

/// With further faces on so many percent of its edges, each to a vertex of its own beside the edge:
/// edges of three faces.
pub(crate) fn with_fins(
    mesh: &TriMesh,
    percent: f64,
    random: &mut ChaCha8Rng,
) -> Result<TriMesh, StressError> {
    let topology = Topology::new(mesh.num_vertices(), mesh.faces());
    let normals = vertex_normals(mesh.positions(), mesh.faces());
    let mut places = mesh.positions().to_vec();
    let mut faces = mesh.faces().to_vec();
    for edge in some(topology.edges().len(), percent, random) {
        let [a, b] = topology.edges()[edge];
        let [from, to] = [a, b].map(|end| mesh.positions()[end as usize]);
        let middle = nalgebra::center(&from, &to);
        places.push(middle + 0.5 * (to - from).norm() * normals[a as usize]);
        faces.push([a, b, places.len() as u32 - 1]);
    }
    Ok(TriMesh::new(places, faces)?)
}

/// Cut into so many pieces that share no vertex: each face goes to the nearest of as many random
/// vertices.
pub(crate) fn in_pieces(
    mesh: &TriMesh,
    count: usize,
    random: &mut ChaCha8Rng,
) -> Result<TriMesh, StressError> {
    let all = mesh.num_vertices();
    let seeds: Vec<Point3> = some_of(all, count, random)
        .into_iter()
        .map(|vertex| mesh.positions()[vertex])
        .collect();
    let mut places = Vec::new();
    let mut faces = Vec::with_capacity(mesh.num_faces());
    let mut of_piece: BTreeMap<(usize, u32), u32> = BTreeMap::new();
    for corners in mesh.faces() {
        let [a, b, c] = corners.map(|corner| mesh.positions()[corner as usize].coords);
        let middle = Point3::from((a + b + c) / 3.0);
        let distance = |seed: &Point3| (seed - middle).norm_squared();
        let nearest = (0..seeds.len()).min_by(|&a, &b| {
            let [a, b] = [a, b].map(|seed| distance(&seeds[seed]));
            a.total_cmp(&b)
        });
        let piece = nearest.unwrap_or(0);
        faces.push(corners.map(|corner| {
            *of_piece.entry((piece, corner)).or_insert_with(|| {
                places.push(mesh.positions()[corner as usize]);
                places.len() as u32 - 1
            })
        }));
    }
    Ok(TriMesh::new(places, faces)?)
}

/// Two sheets of a garment, each so far over it, in metres.
pub(crate) fn layers(mesh: &TriMesh, heights: [f32; 2]) -> Result<[TriMesh; 2], StressError> {
    let normals = vertex_normals(mesh.positions(), mesh.faces());
    let [first, second] = heights.map(|height| {
        let places = mesh.positions().iter().zip(&normals);
        let places = places.map(|(place, normal)| place + height * normal);
        TriMesh::new(places.collect(), mesh.faces().to_vec())
    });
    Ok([first?, second?])
}

/// A garment of two layers: its own vertices, then those of a lining so far under it, in metres.
pub(crate) fn lined(mesh: &TriMesh, apart: f32) -> Result<TriMesh, StressError> {
    // Half of the distance to each side: the garment fits its body as before.
    let [outer, lining] = layers(mesh, [0.5 * apart, -0.5 * apart])?;
    joined(&outer, &lining)
}

/// Both meshes in one, the vertices and faces of the first one first.
pub(crate) fn joined(first: &TriMesh, second: &TriMesh) -> Result<TriMesh, StressError> {
    let count = first.num_vertices() as u32;
    let places = first.positions().iter().chain(second.positions());
    let moved = |face: &[u32; 3]| face.map(|corner| corner + count);
    let faces = first.faces().iter().copied();
    Ok(TriMesh::new(
        places.copied().collect(),
        faces.chain(second.faces().iter().map(moved)).collect(),
    )?)
}

/// The body and so many balls that stick half out of its skin, where it has most vertices.
pub(crate) fn with_balls(
    body: &Body,
    count: usize,
    random: &mut ChaCha8Rng,
) -> Result<Body, StressError> {
    const RADIUS: f32 = 0.03;
    let rest = body.rest();
    let mut places = rest.positions().to_vec();
    let mut faces = rest.faces().to_vec();
    let of_vertex = |vertex: usize| body.weights().vertex(vertex).collect::<Vec<_>>();
    let mut rows: Vec<Vec<(usize, f32)>> = (0..rest.num_vertices()).map(of_vertex).collect();
    let ball = icosphere(2, RADIUS);
    for center in some_of(rest.num_vertices(), count, random) {
        let first = places.len() as u32;
        let at = rest.positions()[center].coords;
        places.extend(ball.positions().iter().map(|place| place + at));
        faces.extend(
            ball.faces()
                .iter()
                .map(|face| face.map(|corner| corner + first)),
        );
        rows.extend(ball.positions().iter().map(|_| of_vertex(center)));
    }
    let weights = SkinWeights::from_influences(body.skeleton().num_joints(), rows)?;
    let rest = TriMesh::new(places, faces)?;
    Ok(Body::new(rest, body.skeleton().clone(), weights)?)
}

/// The body in another size.
pub(crate) fn resized_body(body: &Body, times: f32) -> Result<Body, StressError> {
    let places = body.rest().positions().iter().map(|place| place * times);
    let rest = TriMesh::new(places.collect(), body.rest().faces().to_vec())?;
    let skeleton = body
        .skeleton()
        .placed(|_, joint| joint.rest_position * times)?;
    Ok(Body::new(rest, skeleton, body.weights().clone())?)
}

/// Numbers of so many percent of `count`, each once.
fn some(count: usize, percent: f64, random: &mut ChaCha8Rng) -> BTreeSet<usize> {
    some_of(count, (0.01 * percent * count as f64) as usize, random)
}

/// So many numbers below `count`, each once.
fn some_of(count: usize, asked: usize, random: &mut ChaCha8Rng) -> BTreeSet<usize> {
    let asked = asked.min(count);
    let mut found = BTreeSet::new();
    while found.len() < asked {
        found.insert(random.random_range(0..count));
    }
    found
}

pub(crate) fn slivers(
    mesh: &TriMesh,
    percent: f64,
    random: &mut ChaCha8Rng,
) -> Result<TriMesh, StressError> {
    let mut places = mesh.positions().to_vec();
    for face in some(mesh.num_faces(), percent, random) {
        let [a, b, c] = mesh.faces()[face].map(|corner| corner as usize);
        let middle = Point3::from(0.5 * (places[b].coords + places[c].coords));
        places[a] = middle + 0.02 * (places[a] - middle);
    }
    Ok(TriMesh::new(places, mesh.faces().to_vec())?)
}

pub(crate) fn flipped(
    mesh: &TriMesh,
    percent: f64,
    random: &mut ChaCha8Rng,
) -> Result<TriMesh, StressError> {
    let mut faces = mesh.faces().to_vec();
    for face in some(mesh.num_faces(), percent, random) {
        faces[face].swap(1, 2);
    }
    Ok(TriMesh::new(mesh.positions().to_vec(), faces)?)
}

pub(crate) fn split(
    mesh: &TriMesh,
    percent: f64,
    random: &mut ChaCha8Rng,
) -> Result<TriMesh, StressError> {
    let mut places = mesh.positions().to_vec();
    let mut faces = mesh.faces().to_vec();
    let chosen = some(mesh.num_vertices(), percent, random);
    let mut copies = BTreeMap::new();
    for corners in &mut faces {
        for corner in corners {
            let vertex = *corner as usize;
            // Every second face of the vertex takes the copy.
            if chosen.contains(&vertex) && random.random_range(0..2) == 1 {
                *corner = *copies.entry(vertex).or_insert_with(|| {
                    places.push(places[vertex]);
                    places.len() as u32 - 1
                });
            }
        }
    }
    Ok(TriMesh::new(places, faces)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_are_made_worse_by_as_much_as_is_asked() {
        let ball = icosphere(3, 0.2);
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let faces = ball.num_faces();
        let holes = with_holes(&ball, 20.0, &mut random).unwrap();
        assert_eq!(holes.num_faces(), faces - faces / 5);
        let turned = flipped(&ball, 10.0, &mut random).unwrap();
        let differing = turned
            .faces()
            .iter()
            .zip(ball.faces())
            .filter(|(a, b)| a != b);
        assert_eq!(differing.count(), faces / 10);
        let doubled = split(&ball, 10.0, &mut random).unwrap();
        let added = doubled.num_vertices() - ball.num_vertices();
        assert!((50..=64).contains(&added), "{added}");
        let area = |mesh: &TriMesh, [a, b, c]: [u32; 3]| {
            let at = |vertex: u32| mesh.positions()[vertex as usize];
            (at(b) - at(a)).cross(&(at(c) - at(a))).norm()
        };
        let flat = slivers(&ball, 5.0, &mut random).unwrap();
        let thin = flat
            .faces()
            .iter()
            .filter(|face| area(&flat, **face) < 0.1 * area(&ball, **face));
        assert!(thin.count() >= faces / 40);
        for unchanged in [slivers, flipped, split, with_holes] {
            assert_eq!(
                unchanged(&ball, 0.0, &mut random).unwrap().faces(),
                ball.faces()
            );
        }
        let fins = with_fins(&ball, 10.0, &mut random).unwrap();
        let edges = Topology::new(fins.num_vertices(), fins.faces());
        assert_eq!(edges.non_manifold_edges().len(), 3 * faces / 20);
        for count in [1, 7, 40] {
            let pieces = in_pieces(&ball, count, &mut random).unwrap();
            let topology = Topology::new(pieces.num_vertices(), pieces.faces());
            assert!(topology.num_components() >= count, "{count}");
            assert_eq!(pieces.num_faces(), faces);
        }
        let lined = lined(&ball, 0.004).unwrap();
        let radius = |vertex: usize| lined.positions()[vertex].coords.norm();
        for vertex in 0..ball.num_vertices() {
            let apart = radius(vertex) - radius(ball.num_vertices() + vertex);
            assert!((apart - 0.004).abs() < 1e-5, "{apart}");
        }
        assert_eq!(finer(&ball, 16.0).unwrap().num_faces(), 16 * faces);
        assert_eq!(finer(&ball, 1.0).unwrap().num_faces(), faces);
    }
}
