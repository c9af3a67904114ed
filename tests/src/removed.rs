//! Bodies of which skin was deleted.

use garnet::{Body, SkinWeights, TriMesh};

/// The body without the faces whose corners all are as is said, and without vertices that no face
/// names then.
///
/// # Panics
///
/// If no face is left.
pub fn without(body: &Body, is_removed: impl Fn(usize) -> bool) -> Body {
    let rest = body.rest();
    let is_kept = |face: &&[u32; 3]| !face.iter().all(|&vertex| is_removed(vertex as usize));
    let faces: Vec<[u32; 3]> = rest.faces().iter().filter(is_kept).copied().collect();
    let mut place = vec![u32::MAX; rest.num_vertices()];
    let mut kept = Vec::new();
    for &vertex in faces.as_flattened() {
        if place[vertex as usize] == u32::MAX {
            place[vertex as usize] = kept.len() as u32;
            kept.push(vertex as usize);
        }
    }
    let faces = faces
        .iter()
        .map(|face| face.map(|vertex| place[vertex as usize]));
    let positions = kept.iter().map(|&vertex| rest.positions()[vertex]);
    let mesh = TriMesh::new(positions.collect(), faces.collect()).expect("the vertices are kept");
    let rows = kept.iter().map(|&vertex| body.weights().vertex(vertex));
    let weights = SkinWeights::from_influences(body.weights().num_joints(), rows)
        .expect("they are rows of weights");
    Body::new(mesh, body.skeleton().clone(), weights).expect("the parts fit together")
}
