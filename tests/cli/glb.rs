//! A rigged body as GLB, as modelling programs write it.

use garnet::{Body, Point3};
use serde_json::{Value, json};

/// Influences of a vertex in a GLB.
const SLOTS: usize = 4;

/// The bytes of a GLB with the rest mesh, the joints as nodes and the four heaviest weights of each
/// vertex.
pub(crate) fn glb_of(body: &Body) -> Vec<u8> {
    let (rest, joints) = (body.rest(), body.skeleton().joints());
    let mut binary = Vec::new();
    let mut views = Vec::new();
    let mut add = |bytes: Vec<u8>| {
        views.push(json!({"buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len()}));
        binary.extend(bytes);
    };
    add(floats(rest.positions().iter().flat_map(coordinates)));
    let corners = rest.faces().as_flattened().iter();
    add(corners.flat_map(|corner| corner.to_le_bytes()).collect());
    let (slots, shares): (Vec<[u8; SLOTS]>, Vec<[f32; SLOTS]>) = (0..rest.num_vertices())
        .map(|vertex| influences(body, vertex))
        .unzip();
    add(slots.into_flattened());
    add(floats(shares.into_flattened().into_iter()));
    add(floats(joints.iter().flat_map(|joint| {
        let mut matrix = [0.0; 16];
        for i in 0..4 {
            matrix[5 * i] = 1.0;
        }
        for (place, value) in coordinates(&joint.rest_position).into_iter().enumerate() {
            matrix[12 + place] = -value;
        }
        matrix
    })));
    let (num_vertices, num_joints) = (rest.num_vertices(), joints.len());
    let json = json!({
        "asset": {"version": "2.0"},
        "nodes": nodes(body),
        "skins": [{"joints": (0..num_joints).collect::<Vec<_>>(), "inverseBindMatrices": 4}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3},
            "indices": 1,
        }]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": num_vertices, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": 3 * rest.num_faces(), "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5121, "count": num_vertices, "type": "VEC4"},
            {"bufferView": 3, "componentType": 5126, "count": num_vertices, "type": "VEC4"},
            {"bufferView": 4, "componentType": 5126, "count": num_joints, "type": "MAT4"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": binary.len()}],
    });
    container(&json, &binary)
}

/// A node for each joint, and one for the mesh.
fn nodes(body: &Body) -> Vec<Value> {
    let joints = body.skeleton().joints();
    let node = |(index, joint): (usize, &garnet::Joint)| {
        let origin = joint
            .parent
            .map_or_else(Point3::origin, |parent| joints[parent].rest_position);
        let children = (0..joints.len()).filter(|&child| joints[child].parent == Some(index));
        let children: Vec<usize> = children.collect();
        let offset = joint.rest_position - origin;
        let mut node = json!({"name": joint.name, "translation": [offset.x, offset.y, offset.z]});
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        node
    };
    let mut nodes: Vec<Value> = joints.iter().enumerate().map(node).collect();
    nodes.push(json!({"mesh": 0, "skin": 0}));
    nodes
}

/// The joints and weights of the heaviest influences of a vertex; the weights sum up to 1.
fn influences(body: &Body, vertex: usize) -> ([u8; SLOTS], [f32; SLOTS]) {
    let mut all: Vec<(usize, f32)> = body.weights().vertex(vertex).collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all.truncate(SLOTS);
    let sum: f32 = all.iter().map(|(_, weight)| weight).sum();
    let (mut slots, mut shares) = ([0; SLOTS], [0.0; SLOTS]);
    for (slot, (joint, weight)) in all.into_iter().enumerate() {
        slots[slot] = joint as u8;
        shares[slot] = weight / sum;
    }
    (slots, shares)
}

fn coordinates(point: &Point3) -> [f32; 3] {
    [point.x, point.y, point.z]
}

/// The bytes of floats.
pub(crate) fn floats(values: impl Iterator<Item = f32>) -> Vec<u8> {
    values.flat_map(f32::to_le_bytes).collect()
}

/// The bytes of a GLB.
pub(crate) fn container(json: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut chunks = Vec::new();
    for (kind, data) in [(b"JSON", &text[..]), (b"BIN\0", binary)] {
        chunks.extend((data.len() as u32).to_le_bytes());
        chunks.extend(kind);
        chunks.extend(data);
    }
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((chunks.len() as u32 + 12).to_le_bytes());
    bytes.extend(chunks);
    bytes
}
