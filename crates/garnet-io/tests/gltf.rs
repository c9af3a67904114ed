//! Rigs as GLB and glTF: what they mean, and damaged files.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::{
    fs,
    path::{Path, PathBuf},
};

use garnet_io::{
    LeftOut, RigOptions, RigPart, read_mesh, read_rig, read_rig_with, read_shown_mesh,
};
use garnet_skin::Point3;
use proptest::prelude::*;
use serde_json::{Value, json};

mod common;

use common::{chain, strip};

/// JSON and binary chunk of the strip of the other tests.
///
/// The knee comes before the hip in the skin; weights are bytes; everything is a hundred times its
/// size under a node that scales by 0.01.
fn file() -> (Value, Vec<u8>) {
    let rig = strip();
    let mesh = rig.rest.as_ref().unwrap();
    let mut binary = Vec::new();
    let mut views = Vec::new();
    let mut add = |bytes: Vec<u8>| {
        views.push(json!({"buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len()}));
        binary.extend(bytes);
    };
    let floats = |values: &mut dyn Iterator<Item = f32>| {
        values.flat_map(f32::to_le_bytes).collect::<Vec<u8>>()
    };
    add(floats(&mut mesh.positions().iter().flat_map(|point| {
        [point.x, point.y, point.z].map(|value| 100.0 * value)
    })));
    add(mesh
        .faces()
        .as_flattened()
        .iter()
        .flat_map(|&corner| (corner as u16).to_le_bytes())
        .collect());
    add((0..8).flat_map(|_| [1, 0, 0, 0]).collect());
    let shares = [0_u8, 0, 64, 64, 191, 191, 255, 255];
    add(shares
        .iter()
        .flat_map(|share| [255 - share, *share, 0, 0])
        .collect());
    let inverse_bind = |x: f32, y: f32| {
        let mut matrix = [0.0; 16];
        for i in 0..4 {
            matrix[5 * i] = 1.0;
        }
        matrix[12] = -x;
        matrix[13] = -y;
        matrix
    };
    add(floats(
        &mut [inverse_bind(5.0, 40.0), inverse_bind(5.0, 0.0)]
            .concat()
            .into_iter(),
    ));
    let num_bytes = binary.len();
    let json = json!({
        "asset": {"version": "2.0"},
        "nodes": [
            {"mesh": 0, "skin": 0},
            {"name": "armature", "children": [2], "scale": [0.01, 0.01, 0.01]},
            {"name": "hip", "children": [3], "translation": [5.0, 0.0, 0.0]},
            {"name": "between", "children": [4]},
            {"name": "knee", "translation": [0.0, 40.0, 0.0]},
        ],
        "skins": [{"joints": [4, 2], "inverseBindMatrices": 4}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3},
            "indices": 1,
        }]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 18, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5121, "count": 8, "type": "VEC4"},
            {"bufferView": 3, "componentType": 5121, "count": 8, "type": "VEC4", "normalized": true},
            {"bufferView": 4, "componentType": 5126, "count": 2, "type": "MAT4"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": num_bytes}],
    });
    (json, binary)
}

fn glb(json: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let chunks = [(b"JSON", &text[..]), (b"BIN\0", binary)];
    let mut body = Vec::new();
    for (kind, data) in chunks {
        body.extend((data.len() as u32).to_le_bytes());
        body.extend(kind);
        body.extend(data);
    }
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((body.len() as u32 + 12).to_le_bytes());
    bytes.extend(body);
    bytes
}

fn written(folder: &Path, bytes: &[u8]) -> PathBuf {
    let path = folder.join("body.glb");
    fs::write(&path, bytes).unwrap();
    path
}

fn check(path: &Path) {
    let rig = read_rig(path).unwrap();
    let expected = strip();
    let (mesh, expected_mesh) = (rig.rest.unwrap(), expected.rest.unwrap());
    for (found, expected) in mesh.positions().iter().zip(expected_mesh.positions()) {
        approx::assert_relative_eq!(*found, *expected, epsilon = 1e-6);
    }
    assert_eq!(mesh.faces(), expected_mesh.faces());
    let [knee, hip] = [0, 1].map(|joint| rig.skeleton.joints()[joint].clone());
    assert_eq!((knee.name.as_str(), knee.parent), ("knee", Some(1)));
    assert_eq!((hip.name.as_str(), hip.parent), ("hip", None));
    approx::assert_relative_eq!(
        knee.rest_position,
        Point3::new(0.05, 0.4, 0.0),
        epsilon = 1e-6
    );
    approx::assert_relative_eq!(
        hip.rest_position,
        Point3::new(0.05, 0.0, 0.0),
        epsilon = 1e-6
    );
    // Slot 0 of the file is joint 1 of the skin, the hip, with 255 minus the share.
    assert_eq!(rig.weights.vertex(0).collect::<Vec<_>>(), [(1, 1.0)]);
    assert_eq!(rig.weights.heaviest(7), 0);
    approx::assert_relative_eq!(
        rig.weights.vertex(2).next().unwrap().1,
        0.75,
        epsilon = 0.01
    );
}

#[test]
fn a_glb_and_a_gltf_with_its_buffer_inside_or_beside_give_the_same_rig() {
    let folder = tempfile::tempdir().unwrap();
    let (mut json, binary) = file();
    check(&written(folder.path(), &glb(&json, &binary)));

    let beside = folder.path().join("body.gltf");
    fs::write(folder.path().join("body data.bin"), &binary).unwrap();
    json["buffers"][0]["uri"] = json!("body%20data.bin");
    fs::write(&beside, json.to_string()).unwrap();
    check(&beside);

    let symbols = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let text: String = binary
        .chunks(3)
        .map(|group| {
            let bits = group
                .iter()
                .chain(&[0, 0])
                .take(3)
                .fold(0_u32, |bits, &byte| bits << 8 | u32::from(byte));
            let symbol = |i: usize| char::from(symbols[(bits >> (18 - 6 * i) & 63) as usize]);
            let filled = |i| if i <= group.len() { symbol(i) } else { '=' };
            (0..4).map(filled).collect::<String>()
        })
        .collect();
    json["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{text}"));
    let inside = folder.path().join("inside.json");
    fs::write(&inside, json.to_string()).unwrap();
    check(&inside);
}

#[test]
fn two_primitives_on_the_same_vertices_share_them() {
    let folder = tempfile::tempdir().unwrap();
    let (mut json, binary) = file();
    let primitive = json["meshes"][0]["primitives"][0].clone();
    json["meshes"][0]["primitives"] = json!([primitive, primitive]);
    let rig = read_rig(written(folder.path(), &glb(&json, &binary))).unwrap();
    let mesh = rig.rest.unwrap();
    assert_eq!((mesh.num_vertices(), mesh.num_faces()), (8, 12));
}

#[test]
fn primitives_without_end_are_refused_before_they_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let (mut json, binary) = file();
    let primitive = json["meshes"][0]["primitives"][0].clone();
    json["meshes"][0]["primitives"] = json!(vec![primitive; 700_001]);
    let error = read_rig(written(folder.path(), &glb(&json, &binary))).unwrap_err();
    let text = format!("{error:#} {}", error.problem);
    assert!(
        text.contains("more than 4194304 vertices or faces"),
        "{text}"
    );
}

#[test]
fn buffers_are_files_beside_the_gltf_of_a_gibibyte_together() {
    let folder = tempfile::tempdir().unwrap();
    let (mut json, binary) = file();
    fs::create_dir(folder.path().join("in")).unwrap();
    let path = folder.path().join("in/body.gltf");
    let problem = |json: &Value| {
        fs::write(&path, json.to_string()).unwrap();
        read_rig(&path).unwrap_err().problem.to_string()
    };
    fs::write(folder.path().join("up.bin"), &binary).unwrap();
    for uri in ["../up.bin", "/dev/zero", "a/../../up.bin"] {
        json["buffers"][0]["uri"] = json!(uri);
        let found = problem(&json);
        assert!(found.contains("not beside the glTF"), "{found}");
    }
    // Each would be read anew.
    let large = fs::File::create(folder.path().join("in/large.bin")).unwrap();
    large.set_len(300 << 20).unwrap();
    let buffer = json!({"byteLength": 9, "uri": "large.bin"});
    json["buffers"] = json!(vec![buffer; 100_000]);
    let found = problem(&json);
    assert!(
        found.contains("buffer 3") && found.contains("1 GiB"),
        "{found}"
    );
}

#[test]
fn sparse_accessors_replace_single_vertices() {
    let folder = tempfile::tempdir().unwrap();
    let (mut json, mut binary) = file();
    let start = binary.len();
    binary.extend([3, 0, 0, 0]);
    binary.extend(
        [7.0_f32, 8.0, 9.0]
            .iter()
            .flat_map(|value| value.to_le_bytes()),
    );
    json["buffers"][0]["byteLength"] = json!(binary.len());
    let views = json["bufferViews"].as_array_mut().unwrap();
    views.push(json!({"buffer": 0, "byteOffset": start, "byteLength": 16}));
    json["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": 5, "componentType": 5121},
        "values": {"bufferView": 5, "byteOffset": 4},
    });
    let rig = read_rig(written(folder.path(), &glb(&json, &binary))).unwrap();
    let moved = rig.rest.unwrap().positions()[3];
    approx::assert_relative_eq!(moved, Point3::new(0.07, 0.08, 0.09), epsilon = 1e-6);
    let mut short = json.clone();
    short["accessors"][0]["count"] = json!(3);
    short["accessors"][2]["count"] = json!(3);
    assert!(read_rig(written(folder.path(), &glb(&short, &binary))).is_err());
    // Without a view all others are zero.
    let whole = json["accessors"][0].as_object_mut().unwrap();
    whole.remove("bufferView");
    let rig = read_rig(written(folder.path(), &glb(&json, &binary))).unwrap();
    let positions = rig.rest.unwrap().into_parts().0;
    approx::assert_relative_eq!(positions[3], moved, epsilon = 1e-6);
    assert_eq!(positions[2], positions[0]);
    json["accessors"][0]["count"] = json!(4_000_000_000_u64);
    assert!(read_rig(written(folder.path(), &glb(&json, &binary))).is_err());
}

/// Appends floats as an accessor of vectors, and gives its number.
fn add_vectors(json: &mut Value, binary: &mut Vec<u8>, values: &[f32]) -> usize {
    let start = binary.len();
    binary.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    json["buffers"][0]["byteLength"] = json!(binary.len());
    let views = json["bufferViews"].as_array_mut().unwrap();
    views.push(json!({"buffer": 0, "byteOffset": start, "byteLength": 4 * values.len()}));
    let view = views.len() - 1;
    let accessors = json["accessors"].as_array_mut().unwrap();
    let count = values.len() / 3;
    accessors
        .push(json!({"bufferView": view, "componentType": 5126, "count": count, "type": "VEC3"}));
    accessors.len() - 1
}

#[test]
fn all_meshes_on_a_skeleton_are_the_body_but_what_is_called_otherwise() {
    let folder = tempfile::tempdir().unwrap();
    let (mut json, binary) = file();
    let mesh = json["meshes"][0].clone();
    json["meshes"] = json!([mesh, mesh, mesh]);
    let nodes = json["nodes"].as_array_mut().unwrap();
    nodes[0]["name"] = json!("Legs");
    nodes.push(json!({"mesh": 1, "skin": 0, "name": "Hair_01"}));
    nodes.push(json!({"mesh": 2, "skin": 0, "name": "Feet"}));
    nodes.push(json!({"mesh": 2, "name": "Stone"}));
    let path = written(folder.path(), &glb(&json, &binary));
    let read = read_rig_with(&path, &RigOptions::default()).unwrap();
    assert_eq!(read.rig.rest.unwrap().num_faces(), 12);
    let fate = |part: &RigPart| (part.name.clone(), part.left_out.map(LeftOut::name));
    let fates: Vec<_> = read.parts.iter().map(fate).collect();
    let named = |name: &str, why| (name.to_owned(), why);
    let expected = [
        named("Legs", None),
        named("Hair_01", Some("hair")),
        named("Feet", None),
        named("Stone", Some("not on this skeleton")),
    ];
    assert_eq!(fates, expected);
    let mut options = RigOptions::default();
    options.meshes = vec!["hair_01".to_owned()];
    let read = read_rig_with(&path, &options).unwrap();
    assert_eq!(read.rig.rest.unwrap().num_faces(), 6);
    options.meshes = vec!["Wig".to_owned()];
    let text = chain(&read_rig_with(&path, &options).unwrap_err());
    assert!(
        text.contains("there is no skinned mesh `Wig`; there are `Legs`"),
        "{text}"
    );
}

/// The file with a strip of its eight vertices in place of its triangles, and some more corners.
fn stripped(mode: u32, corners: &[u16]) -> (Value, Vec<u8>) {
    let (mut json, mut binary) = file();
    let start = binary.len();
    binary.extend(corners.iter().flat_map(|corner| corner.to_le_bytes()));
    json["buffers"][0]["byteLength"] = json!(binary.len());
    let views = json["bufferViews"].as_array_mut().unwrap();
    let num_bytes = 2 * corners.len();
    views.push(json!({"buffer": 0, "byteOffset": start, "byteLength": num_bytes}));
    let view = views.len() - 1;
    json["accessors"][1]["bufferView"] = json!(view);
    json["accessors"][1]["count"] = json!(corners.len());
    json["meshes"][0]["primitives"][0]["mode"] = json!(mode);
    (json, binary)
}

/// The same faces whatever corner comes first.
fn turned(faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let first = |&[a, b, c]: &[u32; 3]| match a.min(b).min(c) {
        least if least == a => [a, b, c],
        least if least == b => [b, c, a],
        _ => [c, a, b],
    };
    faces.iter().map(first).collect()
}

/// Mode, corners and expected faces.
type Case<'a> = (u32, &'a [u16], &'a [[u32; 3]]);

#[test]
fn strips_and_fans_are_their_triangles_with_and_without_a_skin() {
    let folder = tempfile::tempdir().unwrap();
    let whole = strip().rest.unwrap().faces().to_vec();
    let fan = vec![[0, 1, 3], [0, 3, 5], [0, 5, 4], [0, 4, 2]];
    let cases: [Case<'_>; 4] = [
        (5, &[0, 1, 2, 3, 4, 5, 6, 7], &whole),
        // A strip that goes on after corners twice, and one that starts anew.
        (5, &[0, 1, 2, 3, 4, 5, 5, 4, 4, 5, 6, 7], &whole),
        (5, &[0, 1, 2, 3, 4, 5, 65_535, 4, 5, 6, 7], &whole),
        (6, &[0, 1, 3, 5, 4, 2], &fan),
    ];
    for (mode, corners, expected) in cases {
        let (mut json, binary) = stripped(mode, corners);
        let path = written(folder.path(), &glb(&json, &binary));
        let rig = read_rig(&path).unwrap();
        let found = rig.rest.unwrap();
        assert_eq!(turned(found.faces()), turned(expected), "{corners:?}");
        json["skins"] = json!([]);
        json["nodes"][0]["skin"] = Value::Null;
        let path = written(folder.path(), &glb(&json, &binary));
        let found = read_mesh(&path).unwrap().triangles();
        assert_eq!(turned(&found), turned(expected), "{corners:?}");
    }
    // Without indices the vertices are the corners.
    let (mut json, binary) = stripped(5, &[]);
    json["meshes"][0]["primitives"][0]["indices"] = Value::Null;
    let rig = read_rig(written(folder.path(), &glb(&json, &binary))).unwrap();
    assert_eq!(turned(rig.rest.unwrap().faces()), turned(&whole));
    let (json, binary) = stripped(5, &[0, 1, 2, 9]);
    let error = read_rig(written(folder.path(), &glb(&json, &binary))).unwrap_err();
    assert!(
        chain(&error).contains("names vertex 9"),
        "{}",
        chain(&error)
    );
}

#[test]
fn points_and_lines_are_left_out_and_told() {
    let folder = tempfile::tempdir().unwrap();
    for mode in 0..4 {
        let (mut json, binary) = file();
        let triangles = json["meshes"][0]["primitives"][0].clone();
        // Guides of hair need no weights.
        let lines = json!({"attributes": {"POSITION": 0}, "mode": mode});
        json["meshes"] = json!([{"primitives": [lines, triangles]}, {"primitives": [lines]}]);
        let nodes = json["nodes"].as_array_mut().unwrap();
        nodes[0]["name"] = json!("Body");
        nodes.push(json!({"mesh": 1, "skin": 0, "name": "Guides"}));
        let path = written(folder.path(), &glb(&json, &binary));
        let read = read_rig_with(&path, &RigOptions::default()).unwrap();
        let note = read.note(&path).unwrap().to_string();
        assert_eq!(read.rig.rest.unwrap().num_faces(), 6);
        let told =
            "the body is `Body`; left out: `Body` (points or lines), `Guides` (points or lines)";
        assert!(note.ends_with(told), "{note}");

        json["skins"] = json!([]);
        for node in json["nodes"].as_array_mut().unwrap() {
            node["skin"] = Value::Null;
        }
        let path = written(folder.path(), &glb(&json, &binary));
        let shown = read_shown_mesh(&path, &RigOptions::default()).unwrap();
        assert_eq!(shown.file.num_polygons(), 6);
        let note = shown.note.unwrap().to_string();
        assert!(
            note.ends_with(&told.replace("the body", "the mesh")),
            "{note}"
        );
        json["meshes"][0] = json["meshes"][1].clone();
        let path = written(folder.path(), &glb(&json, &binary));
        let error = chain(&read_mesh(&path).unwrap_err());
        assert!(error.contains("without a triangle"), "{error}");
    }
}

#[test]
fn of_two_bodies_the_one_in_the_scene_that_is_shown_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let (mut json, binary) = file();
    // A second skeleton, twice as large.
    let nodes = json["nodes"].as_array_mut().unwrap();
    let mut twice: Vec<Value> = nodes.clone();
    let first = nodes.len();
    twice[0]["skin"] = json!(1);
    for node in &mut twice {
        if let Some(child) = node["children"][0].as_u64() {
            node["children"] = json!([child as usize + first]);
        }
    }
    twice[1]["scale"] = json!([0.02, 0.02, 0.02]);
    nodes.extend(twice);
    let mut skin = json["skins"][0].clone();
    skin["joints"] = json!([4 + first, 2 + first]);
    json["skins"].as_array_mut().unwrap().push(skin);
    json["scenes"] = json!([{"nodes": [0, 1]}, {"nodes": [first, first + 1]}]);
    let height = |json: &Value| {
        let path = written(folder.path(), &glb(json, &binary));
        let mesh = read_rig(&path).unwrap().rest.unwrap();
        let heights = mesh.positions().iter().map(|p| p.y);
        heights.fold(f32::NEG_INFINITY, f32::max)
    };
    json["scene"] = json!(0);
    let small = height(&json);
    json["scene"] = json!(1);
    assert!((height(&json) / small - 2.0).abs() < 1e-3);
    // Without a word it is the first.
    json.as_object_mut().unwrap().remove("scene");
    assert!((height(&json) / small - 1.0).abs() < 1e-3);
}

#[test]
fn default_weights_of_morph_targets_are_applied_and_those_of_the_node_come_first() {
    let folder = tempfile::tempdir().unwrap();
    let (mut json, mut binary) = file();
    let shift = [10.0_f32, 0.0, 0.0].repeat(8);
    let target = add_vectors(&mut json, &mut binary, &shift);
    json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": target}]);
    let moved = |json: &Value| {
        let rig = read_rig(written(folder.path(), &glb(json, &binary))).unwrap();
        rig.rest.unwrap().positions()[0].x - strip().rest.unwrap().positions()[0].x
    };
    assert!(moved(&json).abs() < 1e-6);
    json["meshes"][0]["weights"] = json!([0.5]);
    assert!((moved(&json) - 0.05).abs() < 1e-6);
    json["nodes"][0]["weights"] = json!([1.0]);
    assert!((moved(&json) - 0.1).abs() < 1e-6);
}

#[test]
fn meshes_without_a_skin_are_read_where_their_nodes_have_them() {
    let folder = tempfile::tempdir().unwrap();
    let (mut json, binary) = file();
    json["skins"] = json!([]);
    // Once as it is, and once in front, mirrored.
    json["nodes"] = json!([
        {"name": "scene", "children": [1, 2], "scale": [0.01, 0.01, 0.01]},
        {"name": "strip", "mesh": 0},
        {"name": "mirror", "mesh": 0, "translation": [0.0, 0.0, 50.0], "scale": [-1.0, 1.0, 1.0]},
    ]);
    json["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0});
    let path = written(folder.path(), &glb(&json, &binary));
    let mesh = read_mesh(&path).unwrap().mesh().unwrap();
    let expected = strip().rest.unwrap();
    let (num, faces) = (expected.num_vertices(), expected.faces());
    assert_eq!(mesh.num_vertices(), 2 * num);
    for (vertex, place) in expected.positions().iter().enumerate() {
        let mirrored = Point3::new(-place.x, place.y, place.z + 0.5);
        approx::assert_relative_eq!(mesh.positions()[vertex], *place, epsilon = 1e-6);
        approx::assert_relative_eq!(mesh.positions()[num + vertex], mirrored, epsilon = 1e-6);
    }
    let [a, b, c] = faces[0].map(|corner| corner + num as u32);
    assert_eq!(mesh.faces()[0], faces[0]);
    assert_eq!(mesh.faces()[faces.len()], [a, c, b]);
    // It is no rig.
    assert!(chain(&read_rig(&path).unwrap_err()).contains("no mesh has a skin"));
}

#[test]
fn a_joint_in_a_frame_of_an_animation_leaves_the_rest_pose_and_shows_the_other() {
    let folder = tempfile::tempdir().unwrap();
    let (mut json, binary) = file();
    json["nodes"][4]["rotation"] = json!([0.0, 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()]);
    let path = written(folder.path(), &glb(&json, &binary));
    let rig = read_rig(&path).unwrap();
    let (rest, expected) = (rig.rest.clone().unwrap(), strip().rest.unwrap());
    for (found, expected) in rest.positions().iter().zip(expected.positions()) {
        approx::assert_relative_eq!(*found, *expected, epsilon = 1e-6);
    }
    let transforms = rig.skeleton.transforms(&rig.rest_pose.unwrap()).unwrap();
    // The knee, at (0.05, 0.4), turns what follows it alone by a right angle.
    let shown = read_mesh(&path).unwrap();
    let last = expected.positions()[7];
    let turned = Point3::new(0.05 - (last.y - 0.4), 0.4 + (last.x - 0.05), last.z);
    approx::assert_relative_eq!(shown.positions()[7], turned, epsilon = 1e-5);
    approx::assert_relative_eq!(transforms[0] * last, turned, epsilon = 1e-5);
    // Whoever has moved a little, too, rests where the armature has the bind pose; far away, not.
    for (x, is_moved) in [(5.8, false), (105.0, true)] {
        json["nodes"][2]["translation"] = json!([x, 0.0, 0.0]);
        let path = written(folder.path(), &glb(&json, &binary));
        let rest = read_rig(&path).unwrap().rest.unwrap();
        let by = (rest.positions()[0] - expected.positions()[0]).norm();
        assert_eq!(by > 1e-5, is_moved, "{x}: {by}");
    }
}

#[test]
fn a_joint_that_is_stretched_is_shown_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let (mut json, binary) = file();
    json["nodes"][4]["scale"] = json!([1.0, 2.0, 1.0]);
    let rig = read_rig(written(folder.path(), &glb(&json, &binary))).unwrap();
    assert_eq!(rig.rest_pose, None);
    let last = strip().rest.unwrap().positions()[7];
    let expected = Point3::new(last.x, 0.4 + 2.0 * (last.y - 0.4), last.z);
    approx::assert_relative_eq!(rig.rest.unwrap().positions()[7], expected, epsilon = 1e-5);
}

#[test]
fn the_humanoid_map_of_a_vrm_tells_joints() {
    let folder = tempfile::tempdir().unwrap();
    let (mut json, binary) = file();
    let map = json!({"leftUpperLeg": {"node": 2}, "leftLowerLeg": {"node": 4}});
    json["extensions"] = json!({"VRMC_vrm": {"humanoid": {"humanBones": map}}});
    let rig = read_rig(written(folder.path(), &glb(&json, &binary))).unwrap();
    let labels: Vec<(&str, usize)> = (rig.skeleton.labels().iter())
        .map(|(name, joint)| (name.as_str(), *joint))
        .collect();
    assert_eq!(labels, [("left_hip", 1), ("left_knee", 0)]);
}

#[test]
fn impossible_files_are_refused_with_the_reason() {
    type Change = fn(&mut Value);
    let cases: [(Change, &str); 14] = [
        (
            |json| json["nodes"][0]["skin"] = Value::Null,
            "no mesh has a skin",
        ),
        (
            |json| json["nodes"][0]["skin"] = json!(4),
            "names skin 4, but there are 1",
        ),
        (
            |json| json["nodes"][4]["children"] = json!([2]),
            "is its own ancestor",
        ),
        (
            |json| json["nodes"][1]["children"] = json!([9]),
            "names node 9",
        ),
        (
            |json| json["skins"][0]["joints"] = json!([4, 77]),
            "names node 77",
        ),
        (
            |json| json["skins"][0]["inverseBindMatrices"] = Value::Null,
            "no inverse bind matrices",
        ),
        (
            |json| json["accessors"][0]["count"] = json!(9),
            "accessor 0: it ends outside its buffer view",
        ),
        (
            |json| json["accessors"][0]["count"] = json!(u64::MAX),
            "accessor 0: it ends outside its buffer view",
        ),
        (
            |json| json["accessors"][0]["byteOffset"] = json!(u64::MAX - 3),
            "accessor 0: it ends outside",
        ),
        (
            |json| json["bufferViews"][0]["byteLength"] = json!(u64::MAX),
            "accessor 0: ",
        ),
        (
            |json| json["meshes"][0]["primitives"][0]["mode"] = json!(1),
            "its meshes are made of points or lines, without a triangle",
        ),
        (
            |json| json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]),
            "KHR_draco_mesh_compression",
        ),
        (
            |json| json["extensionsRequired"] = json!(["VRM", "EXT_mesh_gpu_instancing"]),
            "needs the extension `EXT_mesh_gpu_instancing`, which is not known",
        ),
        (
            |json| json["buffers"][0]["byteLength"] = json!(1_u64 << 40),
            "fewer bytes than it says",
        ),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (change, expected) in cases {
        let (mut json, binary) = file();
        change(&mut json);
        let error = read_rig(written(folder.path(), &glb(&json, &binary))).unwrap_err();
        assert!(chain(&error).contains(expected), "{}", chain(&error));
    }
}

#[test]
fn extensions_that_change_no_mesh_may_be_needed() {
    let folder = tempfile::tempdir().unwrap();
    let (mut json, binary) = file();
    let plain = read_rig(written(folder.path(), &glb(&json, &binary))).unwrap();
    let needed = [
        "KHR_materials_unlit",
        "KHR_texture_transform",
        "EXT_texture_webp",
        "KHR_mesh_quantization",
        "VRM",
        "VRMC_vrm",
        "VRMC_springBone",
    ];
    json["extensionsRequired"] = json!(needed);
    let rig = read_rig(written(folder.path(), &glb(&json, &binary))).unwrap();
    assert_eq!(
        rig.rest.unwrap().positions(),
        plain.rest.unwrap().positions()
    );
}

#[test]
fn extras_may_be_anything() {
    let folder = tempfile::tempdir().unwrap();
    for extras in [
        json!("text"),
        json!(5),
        json!(true),
        json!(null),
        json!([1, {"a": [2]}]),
        json!({"from": "elsewhere"}),
    ] {
        let (mut json, binary) = file();
        for part in ["nodes", "meshes"] {
            json[part][0]["extras"] = extras.clone();
        }
        json["asset"]["extras"] = extras.clone();
        check(&written(folder.path(), &glb(&json, &binary)));
    }
}

#[test]
fn a_glb_cut_anywhere_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (json, binary) = file();
    let bytes = glb(&json, &binary);
    for length in 0..bytes.len() {
        assert!(
            read_rig(written(folder.path(), &bytes[..length])).is_err(),
            "cut at {length}"
        );
    }
}

proptest! {
    #[test]
    fn no_damage_makes_the_reader_panic(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let folder = tempfile::tempdir().unwrap();
        let (json, binary) = file();
        let mut bytes = glb(&json, &binary);
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let _ = read_rig(written(folder.path(), &bytes));
    }

    #[test]
    fn no_number_in_the_json_makes_the_reader_panic(at in any::<prop::sample::Index>(), value in prop_oneof![0_u64..12, any::<u64>()]) {
        let folder = tempfile::tempdir().unwrap();
        let (json, binary) = file();
        let text = json.to_string();
        let is_digit = |i: &usize| text.as_bytes()[*i].is_ascii_digit();
        let digits: Vec<usize> = (0..text.len()).filter(is_digit).collect();
        let at = digits[at.index(digits.len())];
        let changed = format!("{}{value}{}", &text[..at], &text[at + 1..]);
        if let Ok(json) = serde_json::from_str(&changed) {
            let _ = read_rig(written(folder.path(), &glb(&json, &binary)));
        }
    }
}
