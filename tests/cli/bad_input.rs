//! Bad input ends with 2, one clear error with the path, the line where there is one, and a hint,
//! and nothing is written.

use std::fs;

use garnet::mesh::primitives::capsule;

use crate::fixtures::{Fixture, refused_with_hint as refused, stderr, stdout};
use crate::train::done;

#[test]
fn missing_and_unreadable_files() {
    let fixture = Fixture::new();
    refused(
        &fixture,
        "drape nothing.obj body.obj -o out.obj",
        &["`nothing.obj`"],
    );
    refused(
        &fixture,
        "drape sleeve.obj nothing.obj -o out.obj",
        &["`nothing.obj`"],
    );
    refused(&fixture, "drape . body.obj -o out.obj", &["`.`"]);
    refused(
        &fixture,
        "drape sleeve.obj bent.obj --rig no.npz -o out.obj",
        &["`no.npz`"],
    );
    refused(
        &fixture,
        "drape sleeve.obj body.obj --pose no.json -o out.obj",
        &["`no.json`"],
    );
    refused(&fixture, "drape --scene no.json -o out.obj", &["`no.json`"]);
    refused(&fixture, "info no.obj", &["`no.obj`"]);
    refused(&fixture, "info .", &["`.`", "no garment package"]);
    refused(&fixture, "render no.obj -o out.png", &["`no.obj`"]);
}

/// Commands that read `odd`, the last one if it is a file alone.
#[cfg(unix)]
const READ_ODD: [&str; 6] = [
    "info odd",
    "drape --batch odd",
    "drape --batch odd.csv",
    "render body.obj -o out.png --color-by file=odd",
    "train net scenes --config odd",
    "stress net -o cells --axis knee --method none",
];

#[test]
#[cfg(unix)]
fn pipes_and_files_without_end_are_refused() {
    use std::os::unix::fs::symlink;

    let fixture = Fixture::new();
    let make = "garment from-obj sleeve.obj --rest-body body.obj -o net -q";
    assert_eq!(fixture.garnet(make).status.code(), Some(0));
    fs::create_dir(fixture.path("cells")).unwrap();
    for name in ["odd.csv", "cells/cells.json"] {
        symlink(fixture.path("odd"), fixture.path(name)).unwrap();
    }
    let made = std::process::Command::new("mkfifo")
        .arg(fixture.path("odd"))
        .status();
    if made.is_ok_and(|status| status.success()) {
        for arguments in &READ_ODD[..READ_ODD.len() - 1] {
            refused(&fixture, arguments, &["`odd", "it is a pipe or a device"]);
        }
        fs::remove_file(fixture.path("odd")).unwrap();
    }
    // Six gigabytes that take no room on the disk.
    let file = fs::File::create(fixture.path("odd")).unwrap();
    if file.set_len(6 << 30).is_ok() {
        for arguments in &READ_ODD[1..] {
            refused(&fixture, arguments, &["read at most"]);
        }
        // What begins so is no mesh.
        refused(&fixture, READ_ODD[0], &["`odd`"]);
    }
}

#[test]
fn texts_that_are_none_are_told_with_their_path() {
    let fixture = Fixture::new();
    fixture.bytes("odd.txt", b"1\n\xff\xfe\n");
    fixture.text("cut.json", "{");
    let make = "garment from-obj sleeve.obj --rest-body body.obj -o net -q";
    assert_eq!(fixture.garnet(make).status.code(), Some(0));
    for (arguments, told) in [
        (
            "render body.obj -o out.png --color-by file=odd.txt",
            ["`odd.txt`", "line 2 is no text in UTF-8"],
        ),
        (
            "train net scenes --config odd.txt",
            ["`odd.txt`", "it is no text in UTF-8"],
        ),
        ("info cut.json", ["`cut.json`", "cut off"]),
        (
            "simulate sleeve.obj bent.obj --rest-body body.obj -o out.obj --frames sleeve.obj",
            ["`sleeve.obj`", "name another folder"],
        ),
        (
            "drape net bent.obj --method fast -o out.obj",
            ["cannot drape `net` by `fast`", "has no variant"],
        ),
    ] {
        refused(&fixture, arguments, &told);
    }
}

#[test]
fn files_that_are_no_meshes() {
    let fixture = Fixture::new();
    fixture.bytes("binary.obj", &[0, 159, 146, 150, 0, 1, 2, 3]);
    fixture.text("empty.obj", "");
    fixture.text("points.obj", "v 0 0 0\nv 1 0 0\n");
    for (name, cause) in [
        ("binary.obj", "not an OBJ mesh"),
        ("empty.obj", "empty"),
        ("points.obj", "no faces"),
    ] {
        refused(
            &fixture,
            &format!("drape {name} body.obj -o out.obj"),
            &[name, cause],
        );
        refused(
            &fixture,
            &format!("drape sleeve.obj {name} -o out.obj"),
            &[name, cause],
        );
    }
    refused(&fixture, "render empty.obj -o out.png", &["`empty.obj`"]);
}

#[test]
fn files_without_content_and_folders_are_named() {
    let fixture = Fixture::new();
    fs::create_dir(fixture.path("folder")).unwrap();
    for name in [
        "none.obj",
        "none.glb",
        "none.gltf",
        "none.npz",
        "none.json",
        "none.bvh",
        "none",
    ] {
        fixture.text(name, "");
        let run = |arguments: String| {
            let quoted = format!("`{name}`");
            refused(&fixture, &arguments, &[&quoted, "the file is empty"]);
        };
        run(format!("info {name}"));
        run(format!("drape sleeve.obj {name} -o out.obj"));
        run(format!("drape sleeve.obj body.obj --rig {name} -o out.obj"));
        if name != "none" {
            run(format!(
                "drape sleeve.obj body.obj --pose {name} -o out.obj"
            ));
        }
    }
    fixture.bytes("model.pkl", b"\x80\x02}q\x01");
    for arguments in [
        "drape sleeve.obj body.obj --rig model.pkl -o out.obj",
        "drape sleeve.obj body.obj --pose model.pkl -o out.obj",
        "drape sleeve.obj model.pkl -o out.obj",
    ] {
        refused(&fixture, arguments, &["`model.pkl`", "a pickle of Python"]);
    }
    for arguments in [
        "drape folder body.obj -o out.obj",
        "drape sleeve.obj folder -o out.obj",
        "drape sleeve.obj body.obj --rig folder -o out.obj",
        "drape sleeve.obj body.obj --pose folder -o out.obj",
        "drape sleeve.obj body.obj --joints folder -o out.obj",
    ] {
        refused(&fixture, arguments, &["`folder`"]);
    }
}

#[test]
fn a_joint_that_a_map_names_twice_is_refused() {
    let fixture = Fixture::new();
    fixture.text("map.json", r#"{"neck": "shoulder", "spine1": "shoulder"}"#);
    refused(
        &fixture,
        "drape sleeve.obj body.obj --rig body.rig.npz --joints map.json -o out.obj",
        &["`map.json`", "`shoulder` both `neck` and `spine1`"],
    );
}

#[test]
fn lines_that_are_wrong() {
    let fixture = Fixture::new();
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (name, line, cause) in [
        (
            "range.obj",
            "f 1 2 9",
            "line 4: face corner `9` names vertex 9",
        ),
        ("zero.obj", "f 0 1 2", "line 4"),
        (
            "nan.obj",
            "v nan 0 0\nf 1 2 3",
            "line 4: vertex coordinate `nan` is not finite or beyond 1000000",
        ),
        ("inf.obj", "v 0 inf 0\nf 1 2 3", "line 4"),
        (
            "word.obj",
            "v 0 x 0\nf 1 2 3",
            "line 4: vertex coordinate `x` is not a number",
        ),
        ("short.obj", "f", "line 4"),
    ] {
        fixture.text(name, &format!("{triangle}{line}\n"));
        let quoted = format!("`{name}`");
        let run = |arguments: String| refused(&fixture, &arguments, &[&quoted, cause]);
        run(format!("drape {name} body.obj -o out.obj"));
        run(format!(
            "drape sleeve.obj {name} --rig body.rig.npz -o out.obj"
        ));
        run(format!("info {name}"));
    }
}

#[test]
fn other_units_and_far_apart() {
    let fixture = Fixture::new();
    fixture.moved("sleeve.obj", "large.obj", |point| point * 100.0);
    fixture.moved("sleeve.obj", "far.obj", |point| {
        point + garnet::Vector3::x() * 3.0
    });
    for name in ["body.obj", "bent.obj"] {
        fixture.moved(name, &format!("large_{name}"), |point| point * 100.0);
    }
    let units = [
        "the garment looks like centimetres or inches, the body like metres",
        "`--units cm,m`",
    ];
    refused(&fixture, "drape large.obj body.obj -o out.obj", &units);
    refused(
        &fixture,
        "drape sleeve.obj large_bent.obj --rest-body large_body.obj --rig body.rig.npz -o out.obj",
        &[
            "the garment looks like metres, the body like centimetres",
            "`--units m,cm`",
        ],
    );
    refused(
        &fixture,
        "drape far.obj body.obj -o out.obj",
        &["m apart", "`--units"],
    );
}

#[test]
fn bodies_of_other_topology() {
    let fixture = Fixture::new();
    fixture.mesh("other.obj", &capsule(0.1, 1.4, 20, 16));
    refused(
        &fixture,
        "drape sleeve.obj other.obj -o out.obj",
        &[
            "there is no rig for `other.obj`",
            "`other.rig.npz`",
            "--rig",
        ],
    );
    refused(
        &fixture,
        "drape sleeve.obj other.obj --rest-body body.obj -o out.obj",
        &["`other.obj` has another topology", "vertices", "--pose"],
    );
    fixture.moved("body.obj", "shuffled.obj", |point| {
        // Vertices far from their neighbors, as if they were in another order.
        let turn = (point.x * 9173.0 + point.y * 7919.0 + point.z * 6113.0).sin();
        garnet::Point3::new(turn, -turn, 1.0 - turn * turn)
    });
    refused(
        &fixture,
        "drape sleeve.obj shuffled.obj --rest-body body.obj -o out.obj",
        &["`shuffled.obj` has another topology", "another order"],
    );
    // The same mesh with its vertices in another order.
    let body = garnet::io::ObjFile::read(fixture.path("body.obj")).unwrap();
    let (_, faces) = body.mesh().unwrap().into_parts();
    // At rest it would be matched by the places of its vertices.
    let bent = garnet::io::ObjFile::read(fixture.path("bent.obj")).unwrap();
    let positions = bent.positions().to_vec();
    let count = positions.len() as u32;
    let rolled = |vertex: u32| (vertex + 50) % count;
    let mut places = positions.clone();
    for vertex in 0..count {
        places[rolled(vertex) as usize] = positions[vertex as usize];
    }
    // With faces numbered likewise, they would tell which vertex is which.
    fixture.mesh("rolled.obj", &garnet::TriMesh::new(places, faces).unwrap());
    refused(
        &fixture,
        "drape sleeve.obj rolled.obj --rest-body body.obj -o out.obj",
        &["`rolled.obj` has another topology", "order"],
    );
    fixture.moved("bent.obj", "mirrored.obj", |point| {
        garnet::Point3::new(-point.x, point.y, point.z)
    });
    refused(
        &fixture,
        "drape sleeve.obj mirrored.obj --rest-body body.obj -o out.obj",
        &["`mirrored.obj` has another topology", "mirror image"],
    );
    refused(
        &fixture,
        "drape sleeve.obj bent.obj --rig body.rig.npz --pose bend.json -o out.obj",
        &["`bent.obj` is not the rest body"],
    );
}

#[test]
fn a_rig_elsewhere_than_the_body() {
    let fixture = Fixture::new();
    for name in ["body.obj", "bent.obj", "sleeve.obj"] {
        fixture.moved(name, &format!("far_{name}"), |point| {
            point + garnet::Vector3::z() * 10.0
        });
    }
    refused(
        &fixture,
        "drape far_sleeve.obj far_bent.obj --rest-body far_body.obj --rig body.rig.npz -o out.obj",
        &[
            "`body.rig.npz` does not fit the rest body `far_body.obj`",
            "joints lie outside",
        ],
    );
}

#[test]
fn garments_that_are_not_there() {
    let fixture = Fixture::new();
    fs::create_dir(fixture.path("empty")).unwrap();
    for (name, cause) in [
        ("nowhere", "no folder of packages has one"),
        ("nowhere.obj", "No such file"),
        ("empty", "no `garment.toml`"),
    ] {
        let arguments = format!("drape {name} --pose bend.json --rig body.rig.npz -o out.obj");
        refused(&fixture, &arguments, &[&format!("`{name}`"), cause]);
    }
}

#[test]
fn rigs_that_are_impossible() {
    let fixture = Fixture::new();
    let joints = |parents: [i32; 2]| {
        let [a, b] = parents;
        format!(
            r#"[{{"name": "shoulder", "parent": {a}, "rest_position": [0, -0.7, 0]}},
                {{"name": "elbow", "parent": {b}, "rest_position": [0, 0, 0]}}]"#
        )
    };
    fixture.rig_json("cyclic.json", &joints([1, 0]), [0.5, 0.5]);
    fixture.rig_json("parent.json", &joints([-1, 7]), [0.5, 0.5]);
    fixture.rig_json("weights.json", &joints([-1, 0]), [0.0, 0.0]);
    fixture.rig_json("good.json", &joints([-1, 0]), [0.5, 0.5]);
    let good = fixture.garnet("drape sleeve.obj body.obj --rig good.json -o good.obj");
    assert_eq!(good.status.code(), Some(0), "{}", stderr(&good));
    fixture.mesh("other.obj", &capsule(0.1, 1.4, 20, 16));
    fixture.half("body.rig.npz", "half.npz");
    fixture.bytes("half.glb", b"glTF\x02\x00\x00\x00\xff\xff\x00\x00\x10");
    fixture.text("text.npz", "hello");
    for (name, cause) in [
        ("cyclic.json", "is its own ancestor"),
        ("parent.json", "has the parent 7"),
        ("weights.json", "follows no joint: its weights sum to"),
        ("half.npz", "archive"),
        ("half.glb", "cannot read `half.glb`"),
        ("text.npz", "archive"),
        ("bend.json", "bend.json"),
        ("body.obj", "no rig"),
    ] {
        refused(
            &fixture,
            &format!("drape sleeve.obj body.obj --rig {name} -o out.obj"),
            &[name, cause],
        );
    }
    refused(
        &fixture,
        "drape sleeve.obj other.obj --rest-body other.obj --rig body.rig.npz -o out.obj",
        &["`body.rig.npz`", "`other.obj`", "vertices"],
    );
}

#[test]
fn poses_that_do_not_fit() {
    let fixture = Fixture::new();
    let pose = |name: &str, text: &str, cause: &str| {
        fixture.text(name, text);
        refused(
            &fixture,
            &format!("drape sleeve.obj body.obj --pose {name} -o out.obj"),
            &[name, cause],
        );
    };
    pose(
        "name.json",
        r#"{"joints": {"elbo": [0, 0, 0, 1]}}"#,
        "near it are `elbow`",
    );
    pose(
        "norm.json",
        r#"{"joints": {"elbow": [1, 1, 1, 1]}}"#,
        "has the norm 2",
    );
    pose("cut.json", r#"{"joints": {"elbow""#, "line 1 column");
    pose("none.json", "{}", "no pose");
    refused(
        &fixture,
        "drape sleeve.obj body.obj --pose wave -o out.obj",
        &[
            "the rig `body.rig.npz` cannot be posed",
            "the body has no joint that is named like",
            "give it with `--joints`; found: {",
        ],
    );
    refused(
        &fixture,
        "drape sleeve.obj body.obj --pose bend.json:3 -o out.obj",
        &["cannot read frames of `bend.json`", "frame 3 was asked for"],
    );
    refused(
        &fixture,
        "drape sleeve.obj body.obj --pose bend.json:0s:1s -o out/",
        &["cannot read frames of `bend.json`", "`0s:1s"],
    );
}

#[test]
fn outputs_that_cannot_be_written() {
    let fixture = Fixture::new();
    let missing = ["`missing/out", "does not exist"];
    refused(
        &fixture,
        "drape sleeve.obj body.obj -o missing/out.obj",
        &missing,
    );
    refused(
        &fixture,
        "drape sleeve.obj body.obj bent.obj -o missing/out",
        &["`missing`"],
    );
    refused(&fixture, "render body.obj -o missing/out.png", &missing);
    refused(
        &fixture,
        "drape sleeve.obj body.obj -o .",
        &["`.`", "folder"],
    );
    refused(
        &fixture,
        "drape sleeve.obj body.obj bent.obj -o body.obj",
        &["it is a file"],
    );
    refused(
        &fixture,
        "drape sleeve.obj body.obj -o out.obj --report missing/report.json",
        &["`missing/report.json`"],
    );
}

#[test]
fn one_bad_body_of_several_stops_all() {
    let fixture = Fixture::new();
    fixture.half("bent.obj", "half.obj");
    refused(
        &fixture,
        "drape sleeve.obj body.obj half.obj bent.obj -o several",
        &["`half.obj`"],
    );
}

#[test]
fn usage_that_is_wrong() {
    let fixture = Fixture::new();
    for arguments in [
        "drape",
        "drape sleeve.obj -o out.obj",
        "drape sleeve.obj body.obj",
        "drape sleeve.obj body.obj -o out.obj --clearance -1",
        "drape sleeve.obj body.obj -o out.obj --method best",
        "drape sleeve.obj body.obj -o out.obj --units inch",
        "drape sleeve.obj body.obj -o out.obj --repeat 0",
        "drape sleeve.obj body.obj -o out.obj --threads many",
        "drape sleeve.obj body.obj -o out.obj --betas nan",
        "drape sleeve.obj body.obj -o out.obj --betas 0.5,inf",
        "drape sleeve.obj body.obj -o out.obj --betas tall",
        "drape --scene scene.json sleeve.obj -o out.obj",
        "render body.obj -o out.png --size 0x0",
        "render body.obj -o out.png --color-by mood",
        "render body.obj -o out.png --range 2:1",
        "unknown",
        "",
    ] {
        let output = fixture.garnet(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert!(
            !stderr(&output).is_empty() && stdout(&output).is_empty(),
            "{arguments}"
        );
    }
    let negative = fixture.garnet("drape sleeve.obj body.obj -o out.obj --clearance -3");
    let text = stderr(&negative);
    assert!(text.contains("from 0 to 1000"), "{text}");
    let betas = fixture.garnet("drape sleeve.obj body.obj -o out.obj --betas 0.5,nan");
    let text = stderr(&betas);
    assert!(
        text.contains("'nan'") && text.contains("finite numbers"),
        "{text}"
    );
    assert!(!fixture.path("out.obj").exists() && !fixture.path("out.png").exists());
}

#[test]
fn errors_are_documents_too() {
    let fixture = Fixture::new();
    for arguments in ["drape no.obj body.obj -o out.obj --json", "drape --json"] {
        let output = fixture.garnet(arguments);
        assert_eq!(output.status.code(), Some(2));
        let document: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
        assert_eq!(document["schema"], "garnet.error/1");
        assert!(document["error"].is_string() && document["causes"].is_array());
        assert!(document["hint"].is_string(), "{document}");
    }
}

#[test]
fn what_is_asked_for_in_vain_is_told_or_refused() {
    let fixture = Fixture::new();
    let drape = "drape sleeve.obj body.obj --rig body.rig.npz --pose bend.json";
    let output = fixture.garnet(&format!("{drape} -o out.obj --ground --fabric silk"));
    let text = stderr(&output) + &stdout(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(
        text.contains("`bend.json` is no motion: its place"),
        "{text}"
    );
    assert!(text.contains("`--fabric` changes nothing"), "{text}");
    let output = fixture.garnet(&format!("{drape} -o out.obj"));
    let text = stderr(&output) + &stdout(&output);
    assert!(
        !text.contains("no motion") && !text.contains("--fabric"),
        "{text}"
    );
    for (arguments, expected) in [
        (
            "-o no.obj --key-spacing 5",
            "`--key-spacing` is for the frames",
        ),
        (
            "-o no.obj --frames-alone",
            "`--frames-alone` is for the frames",
        ),
        ("-o no.obj --mesh Body", "and `Body` is chosen"),
        (
            "-o sleeve.obj/x.obj",
            "output folder `sleeve.obj` is a file",
        ),
    ] {
        refused(&fixture, &format!("{drape} {arguments}"), &[expected]);
    }
    for (arguments, expected) in [
        ("body -o no.obj --mesh x", "the built-in body is asked for"),
        (
            "body -o no.obj --pose sit --frames 0:3",
            "given without `--motion`",
        ),
        (
            "info sleeve.obj --betas 1",
            "`--betas` is given, and does nothing",
        ),
        (
            "render sleeve.obj --mesh x -o no.png",
            "there is no rig among the files",
        ),
        (
            "view sleeve.obj --joints map.json -o no.html",
            "`--joints` is given",
        ),
    ] {
        refused(&fixture, arguments, &[expected]);
    }
    for kind in ["vrm", "blend", "zip", "MA"] {
        let arguments = format!("drape sleeve.obj body.obj body.obj -o no.{kind}");
        refused(
            &fixture,
            &arguments,
            &[&format!("cannot write into `no.{kind}`")],
        );
    }
}

#[test]
fn rigs_that_pose_other_bodies_than_they_say_are_refused() {
    let fixture = Fixture::new();
    // An elbow a kilometre away, and one that has the name of the shoulder.
    let joints = r#"[{"name": "shoulder", "parent": -1, "rest_position": [0, -0.7, 0]},
        {"name": "elbow", "parent": 0, "rest_position": [0, 1000, 0]}]"#;
    fixture.rig_json("far.json", joints, [0.5, 0.5]);
    for arguments in [
        "drape sleeve.obj bent.obj --rest-body body.obj --rig far.json -o out.obj",
        "drape sleeve.obj body.obj --rig far.json --pose bend.json -o out.obj",
    ] {
        let words = "joint 1 (`elbow`) is 1000 m away from the body";
        refused(&fixture, arguments, &["`far.json`", words]);
    }
    let rig = garnet::io::read_rig(fixture.path("body.rig.npz")).unwrap();
    let joints = rig.skeleton.joints().iter().cloned();
    let joints = joints.map(|joint| garnet::Joint {
        name: "elbow".to_owned(),
        ..joint
    });
    let skeleton = garnet::Skeleton::new(joints.collect()).unwrap();
    let twice = garnet::Rig { skeleton, ..rig };
    garnet::io::write_rig_npz(fixture.path("twice.npz"), &twice).unwrap();
    refused(
        &fixture,
        "drape sleeve.obj body.obj --rig twice.npz --pose bend.json -o out.obj",
        &["`twice.npz`", "joint_names", "it has `elbow` twice"],
    );
}

#[test]
fn poses_that_contradict_themselves_are_refused() {
    let fixture = Fixture::new();
    fixture.text(
        "both.json",
        r#"{"joints": {"elbow": [0.5, 0, 0, 0.866025]},
            "local_rotation_xyzw": [[0, 0, 0, 1], [0, 0, 0, 1]]}"#,
    );
    // The forearm is taken off the arm.
    fixture.text(
        "apart.json",
        r#"{"joint_transforms_row_major_4x4":
            [[1, 0, 0, 0,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 0, 1],
             [1, 0, 0, 0.3,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 0, 1]]}"#,
    );
    for (name, words) in [
        (
            "both.json",
            "the pose is told in several ways: joints, local_rotation_xyzw",
        ),
        (
            "apart.json",
            "the transforms pull joints apart, by up to 0.3",
        ),
    ] {
        let arguments = format!("drape sleeve.obj body.obj --pose {name} -o out.obj");
        refused(&fixture, &arguments, &[&format!("`{name}`"), words]);
    }
    for option in [
        "--ground",
        "--in-place",
        "--fps 10",
        "--keep-flips",
        "--keep-arms",
        "--pose-up z",
    ] {
        let arguments = format!("drape sleeve.obj bent.obj --rig body.rig.npz {option} -o out.obj");
        refused(&fixture, &arguments, &["is given without a pose"]);
    }
}

#[test]
fn vertices_that_no_face_names_are_no_cloth() {
    let fixture = Fixture::new();
    let sleeve = String::from_utf8(fixture.read("sleeve.obj")).unwrap();
    // In the middle of the arm.
    let strays = (0..600).map(|n| format!("v 0 {} 0\n", 0.001 * f64::from(n)));
    let strays = strays.collect::<Vec<String>>().concat();
    fixture.text("strays.obj", &(sleeve + &strays));
    let output = fixture.garnet("drape strays.obj body.obj --pose bend.json -o out.obj");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

#[test]
#[cfg(unix)]
fn pipes_that_a_folder_or_a_list_names_are_not_waited_for() {
    let fixture = Fixture::new();
    done(
        &fixture,
        "garment from-obj sleeve.obj --rest-body body.obj -o pack -q",
    );
    fs::remove_file(fixture.path("pack/template.obj")).unwrap();
    let made = std::process::Command::new("mkfifo")
        .arg(fixture.path("pack/template.obj"))
        .status();
    assert!(made.unwrap().success());
    fixture.text(
        "jobs.json",
        r#"[{"garment": "sleeve.obj", "body": "/dev/zero", "output": "o.obj"}]"#,
    );
    for arguments in [
        "drape pack bent.obj -o o.obj",
        "info pack",
        "drape --batch jobs.json",
    ] {
        let output = fixture.garnet(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        let told = stderr(&output) + &stdout(&output);
        assert!(told.contains("a pipe or a device"), "{arguments}: {told}");
    }
}
