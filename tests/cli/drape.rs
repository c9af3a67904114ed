//! What `drape` writes.

use std::{collections::HashMap, fmt::Write, path::Path};

use garnet::{
    Point3, Rig, SkinWeights, TriMesh, Vector3,
    io::{ObjFile, read_rig, write_rig_npz},
};
use serde_json::Value;

use crate::{
    fixtures::{Fixture, refused, stderr},
    glb::glb_of,
};

/// Runs a command that must succeed and gives its report.
fn reported(fixture: &Fixture, arguments: &str) -> Value {
    let output = fixture.garnet(&format!("{arguments} --json"));
    assert_eq!(
        output.status.code(),
        Some(0),
        "{arguments}: {}",
        stderr(&output)
    );
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Largest distance between the vertices of two files.
fn distance(fixture: &Fixture, a: &str, b: &str) -> f32 {
    let [a, b] = [a, b].map(|name| ObjFile::read(fixture.path(name)).unwrap());
    assert_eq!(a.num_vertices(), b.num_vertices());
    let pairs = a.positions().iter().zip(b.positions());
    pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f32::max)
}

/// Positions that were brought to other units and back, in metres.
const CONVERSION: f32 = 1e-5;

/// A pose that was recovered from vertices instead of given, in metres.
const RECOVERED: f32 = 1e-3;

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let fixture = Fixture::new();
    for threads in [1, 2, 3] {
        let arguments = format!("drape sleeve.obj bent.obj --rest-body body.obj -o {threads}.obj");
        reported(&fixture, &format!("{arguments} --threads {threads}"));
    }
    assert!(fixture.read("1.obj") == fixture.read("2.obj"));
    assert!(fixture.read("1.obj") == fixture.read("3.obj"));
}

#[test]
fn nothing_is_left_inside_and_all_but_positions_is_kept() {
    let fixture = Fixture::new();
    let report = reported(
        &fixture,
        "drape sleeve.obj body.obj --pose bend.json -o out.obj",
    );
    let untangle = &report["drapes"][0]["untangle"];
    assert_eq!(untangle["inside"], 0);
    assert_eq!(report["schema"], "garnet.drape/1");
    assert_eq!(report["method"], "warp");
    assert_eq!(report["garment"]["units"], "m");
    let kept = |name: &str| -> Vec<String> {
        let text = String::from_utf8(fixture.read(name)).unwrap();
        let lines = text.lines().filter(|line| !line.starts_with("v "));
        lines.map(str::to_owned).collect()
    };
    assert_eq!(kept("out.obj"), kept("sleeve.obj"));
}

#[test]
fn a_pose_and_its_body_lead_to_the_same_drape() {
    let fixture = Fixture::new();
    let arguments =
        "drape sleeve.obj body.obj --pose bend.json -o posed.obj --body-out posed_body.obj";
    reported(&fixture, arguments);
    let arguments = "drape sleeve.obj posed_body.obj --rest-body body.obj -o fitted.obj";
    let report = reported(&fixture, arguments);
    assert!(report["drapes"][0]["fit_residual_m"].as_f64().unwrap() < f64::from(RECOVERED));
    assert!(distance(&fixture, "posed.obj", "fitted.obj") < RECOVERED);
}

#[test]
fn bodies_that_are_inside_out_are_turned_and_told() {
    let fixture = Fixture::new();
    for name in ["body.obj", "bent.obj"] {
        let mesh = ObjFile::read(fixture.path(name)).unwrap().mesh().unwrap();
        let (positions, faces) = mesh.into_parts();
        let faces = faces.into_iter().map(|[a, b, c]| [a, c, b]).collect();
        let mesh = TriMesh::new(positions, faces).unwrap();
        fixture.mesh(&format!("turned_{name}"), &mesh);
    }
    let rig = "--rig body.rig.npz -o";
    reported(
        &fixture,
        &format!("drape sleeve.obj bent.obj --rest-body body.obj {rig} right.obj"),
    );
    let report = reported(
        &fixture,
        &format!("drape sleeve.obj turned_bent.obj --rest-body turned_body.obj {rig} turned.obj"),
    );
    assert!(fixture.read("right.obj") == fixture.read("turned.obj"));
    let warnings = report["warnings"].as_array().unwrap();
    let told = |warning: &Value| warning["kind"] == "inside_out_body";
    assert!(warnings.iter().any(told), "{report}");
}

#[test]
fn a_garment_that_is_inside_out_is_draped_as_others_and_told() {
    let fixture = Fixture::new();
    let mesh = ObjFile::read(fixture.path("sleeve.obj"))
        .unwrap()
        .mesh()
        .unwrap();
    let (positions, faces) = mesh.into_parts();
    let faces = faces.into_iter().map(|[a, b, c]| [a, c, b]).collect();
    let turned = TriMesh::new(positions, faces).unwrap();
    fixture.mesh("turned.obj", &turned);
    let rig = "body.obj --rig body.rig.npz --pose bend.json -o";
    let report = reported(&fixture, &format!("drape sleeve.obj {rig} out.obj"));
    let told = |report: &Value| {
        let warnings = report["warnings"].as_array().unwrap().iter();
        let of_sides = warnings.filter(|warning| warning["kind"] == "inside_out_garment");
        of_sides.count()
    };
    assert_eq!(told(&report), 0, "{report}");
    let report = reported(&fixture, &format!("drape turned.obj {rig} turned_out.obj"));
    assert_eq!(told(&report), 1, "{report}");
    // Sums over the corners of faces come in another order.
    assert!(distance(&fixture, "out.obj", "turned_out.obj") < 1e-4);
    let out = ObjFile::read(fixture.path("turned_out.obj"))
        .unwrap()
        .mesh()
        .unwrap();
    assert_eq!(out.faces(), turned.faces());
}

#[test]
fn vertices_that_no_face_names_decide_nothing() {
    let fixture = Fixture::new();
    for name in ["body.obj", "sleeve.obj"] {
        let mut text = String::from_utf8(fixture.read(name)).unwrap();
        text.push_str("v 90 -80 500\n");
        fixture.text(&format!("more_{name}"), &text);
    }
    let report = reported(&fixture, "info more_body.obj");
    assert_eq!(report["files"][0]["unused_vertices"], 1, "{report}");
    let report = reported(
        &fixture,
        "drape more_sleeve.obj body.obj --rig body.rig.npz -o out.obj",
    );
    assert_eq!(report["rest_body"]["units"], "m");
    assert_eq!(report["drapes"][0]["untangle"]["inside"], 0);
}

/// A copy of `body.rig.npz` with a vertex that no face names, and of meshes with one elsewhere in
/// each.
fn with_strays(fixture: &Fixture) {
    let rig = read_rig(fixture.path("body.rig.npz")).unwrap();
    let (mut positions, faces) = rig.rest.unwrap().into_parts();
    let rows = (0..positions.len()).map(|vertex| rig.weights.vertex(vertex).collect::<Vec<_>>());
    let rows = rows.chain([vec![(1, 1.0)]]);
    let weights = SkinWeights::from_influences(2, rows).unwrap();
    positions.push(Point3::new(3.0, -80.0, 5.0));
    let rest = TriMesh::new(positions, faces).unwrap();
    let rig = Rig {
        rest: Some(rest),
        weights,
        ..rig
    };
    write_rig_npz(fixture.path("stray.rig.npz"), &rig).unwrap();
    for (name, stray) in [("body", "v 3 -80 6"), ("bent", "v -40 2 300")] {
        let text = String::from_utf8(fixture.read(&format!("{name}.obj"))).unwrap();
        let first_face = text.find("\nf ").unwrap();
        let (vertices, faces) = text.split_at(first_face);
        fixture.text(
            &format!("stray_{name}.obj"),
            &format!("{vertices}\n{stray}{faces}"),
        );
    }
}

#[test]
fn strays_of_a_body_are_nowhere_in_its_drapes() {
    let fixture = Fixture::new();
    with_strays(&fixture);
    for (of_strays, of_body) in [
        (
            "drape sleeve.obj stray_bent.obj",
            "drape sleeve.obj bent.obj",
        ),
        (
            "drape sleeve.obj stray_body.obj --pose bend.json",
            "drape sleeve.obj body.obj --pose bend.json",
        ),
        (
            "simulate sleeve.obj stray_bent.obj --quality fast",
            "simulate sleeve.obj bent.obj --quality fast",
        ),
    ] {
        reported(
            &fixture,
            &format!("{of_body} --rig body.rig.npz -o out.obj"),
        );
        reported(
            &fixture,
            &format!("{of_strays} --rig stray.rig.npz -o strays.obj"),
        );
        assert!(
            distance(&fixture, "out.obj", "strays.obj") < 1e-4,
            "{of_strays}"
        );
    }
}

#[test]
fn strays_of_a_garment_are_not_simulated() {
    let fixture = Fixture::new();
    let mut text = String::from_utf8(fixture.read("sleeve.obj")).unwrap();
    text.push_str("v -900 0 0\n");
    fixture.text("more_sleeve.obj", &text);
    let output = fixture.garnet("garment from-obj more_sleeve.obj --rest-body body.obj -o more -q");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report = reported(&fixture, "simulate more bent.obj --quality fast -o out.obj");
    assert_eq!(report["drapes"][0]["penetration"]["inside"], 0);
    let draped = ObjFile::read(fixture.path("out.obj")).unwrap();
    assert_eq!(
        draped.positions().last(),
        Some(&Point3::new(-900.0, 0.0, 0.0))
    );
}

#[test]
fn cloth_that_would_tear_is_told() {
    let fixture = Fixture::new();
    let arguments = "drape sleeve.obj bent.obj --rest-body body.obj --clearance 400 -o out.obj";
    let report = reported(&fixture, arguments);
    assert!(report["drapes"][0]["stretch"]["max"].as_f64().unwrap() > 2.0);
    let warnings = report["warnings"].as_array().unwrap();
    for kind in ["torn", "tight"] {
        let is_told = warnings.iter().any(|warning| warning["kind"] == kind);
        assert!(is_told, "{kind}: {report}");
    }
}

#[test]
fn a_lining_stays_inside_of_its_sleeve_and_is_counted() {
    let fixture = Fixture::new();
    let sleeve = ObjFile::read(fixture.path("sleeve.obj")).unwrap();
    let mesh = sleeve.mesh().unwrap();
    let mut normals = vec![Vector3::zeros(); mesh.num_vertices()];
    for face in mesh.faces() {
        let [a, b, c] = face.map(|vertex| mesh.positions()[vertex as usize]);
        for &vertex in face {
            normals[vertex as usize] += (b - a).cross(&(c - a));
        }
    }
    let inner = mesh.positions().iter().zip(&normals);
    let inner = inner.map(|(place, normal)| place - 0.003 * normal.normalize());
    let positions: Vec<Point3> = mesh.positions().iter().copied().chain(inner).collect();
    let count = mesh.num_vertices() as u32;
    let lining = mesh
        .faces()
        .iter()
        .map(|face| face.map(|vertex| vertex + count));
    let faces = mesh.faces().iter().copied().chain(lining).collect();
    let lined = TriMesh::new(positions, faces).unwrap();
    garnet::io::write_obj(fixture.path("lined.obj"), &lined).unwrap();
    let arguments = "drape lined.obj bent.obj --rest-body body.obj -o lined_out.obj";
    let report = reported(&fixture, arguments);
    assert!(
        report["garment"]["layered"].as_u64().unwrap() > 0,
        "{report}"
    );
    let drape = &report["drapes"][0];
    assert_eq!(drape["cloth_crossings_at_rest"], 0);
    assert_eq!(drape["cloth_crossings"], 0);
    assert_eq!(drape["limbs_outside"].as_array().map(Vec::len), Some(0));
}

#[test]
fn units_and_axes_do_not_matter() {
    let fixture = Fixture::new();
    let arguments = "drape sleeve.obj bent.obj --rig body.rig.npz --rest-body body.obj -o out.obj";
    reported(&fixture, arguments);
    for name in ["sleeve.obj", "bent.obj", "body.obj"] {
        fixture.moved(name, &format!("cm_{name}"), |p| {
            100.0 * Point3::new(p.x, -p.z, p.y)
        });
    }
    let arguments = "drape cm_sleeve.obj cm_bent.obj --rig body.rig.npz --rest-body cm_body.obj";
    let report = reported(&fixture, &format!("{arguments} -o cm_out.obj"));
    assert_eq!(report["garment"]["units"], "cm");
    assert_eq!(report["rest_body"]["up"], "z");
    fixture.moved("cm_out.obj", "back.obj", |p| {
        Point3::new(p.x, p.z, -p.y) / 100.0
    });
    assert!(distance(&fixture, "out.obj", "back.obj") < RECOVERED);

    fixture.moved("sleeve.obj", "large.obj", |point| point * 100.0);
    let arguments = "drape large.obj bent.obj --rest-body body.obj --units cm,m -o large_out.obj";
    reported(&fixture, arguments);
    fixture.moved("large_out.obj", "large_back.obj", |point| point / 100.0);
    assert!(distance(&fixture, "out.obj", "large_back.obj") < RECOVERED.max(CONVERSION));
}

#[test]
fn several_bodies_go_to_a_folder() {
    let fixture = Fixture::new();
    let arguments = "drape sleeve.obj body.obj bent.obj -o draped --repeat 2";
    let report = reported(&fixture, arguments);
    assert_eq!(report["drapes"].as_array().map(Vec::len), Some(2));
    assert!(
        report["drapes"][1]["repeated"]["drape"]["median"]
            .as_f64()
            .unwrap()
            > 0.0
    );
    assert!(fixture.path("draped/body.obj").is_file());
    reported(
        &fixture,
        "drape sleeve.obj bent.obj --rest-body body.obj -o one.obj",
    );
    assert!(fixture.read("draped/bent.obj") == fixture.read("one.obj"));
}

#[test]
fn a_limit_that_is_exceeded_ends_with_one() {
    let fixture = Fixture::new();
    fixture.moved("sleeve.obj", "tight.obj", |p| {
        Point3::new(0.7 * p.x, p.y, 0.7 * p.z)
    });
    let arguments = "drape tight.obj bent.obj --rest-body body.obj -o out.obj --max-penetration 1";
    let output = fixture.garnet(&format!("{arguments} --no-untangle"));
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("error: 1 of 1 drapes end deeper than 1 mm in the body"));
    assert!(fixture.path("out.obj").is_file());
}

#[test]
fn faces_that_cross_the_skin_are_a_limit_of_their_own() {
    let fixture = Fixture::new();
    fixture.moved("sleeve.obj", "tight.obj", |p| {
        Point3::new(0.7 * p.x, p.y, 0.7 * p.z)
    });
    let arguments = "drape tight.obj bent.obj --rest-body body.obj -o out.obj --no-untangle";
    let with = |limits: &str| {
        let output = fixture.garnet(&format!("{arguments} --report report.json {limits}"));
        let report: Value = serde_json::from_slice(&fixture.read("report.json")).unwrap();
        (output.status.code(), stderr(&output), report)
    };
    let (status, _, report) = with("");
    assert_eq!(status, Some(0));
    assert!(report["max_crossing_faces"].is_null());
    let found = report["drapes"][0]["penetration"]["crossing_faces"].as_u64();
    let found = found.unwrap();
    assert!(found > 0);

    let (status, text, report) = with("--max-crossing 0");
    assert_eq!(status, Some(1), "{text}");
    let expected =
        format!("cross the skin with more than 0 faces, the worst with {found} (`out.obj`)");
    assert!(text.contains(&expected), "{text}");
    assert_eq!(report["max_crossing_faces"], 0);

    let (status, text, _) = with(&format!("--max-crossing {found}"));
    assert_eq!(status, Some(0), "{text}");
    // Both limits are told.
    let (status, text, _) = with("--max-crossing 0 --max-penetration 1");
    assert_eq!(
        (status, text.matches("error: ").count()),
        (Some(1), 2),
        "{text}"
    );
    let free = fixture
        .garnet("drape tight.obj bent.obj --rest-body body.obj -o out.obj --max-crossing 0 -q");
    assert_eq!(free.status.code(), Some(0), "{}", stderr(&free));
}

#[test]
fn unusual_meshes_are_accepted_with_a_warning() {
    let fixture = Fixture::new();
    let mut text = String::from_utf8(fixture.read("sleeve.obj")).unwrap();
    // An unused vertex, a face without area, a third face at an edge, and a piece of its own.
    text += "v 0 0 0.2\nv 0.13 0.1 0.01\nv 0.14 0.1 0.01\nv 0.13 0.11 0.01\nf 1 2 2\nf 1 2 30\n";
    text += "f 1242 1243 1244\n";
    fixture.text("odd.obj", &text);
    let report = reported(
        &fixture,
        "drape odd.obj bent.obj --rest-body body.obj -o out.obj",
    );
    let kinds: Vec<&str> = report["warnings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|warning| warning["kind"].as_str().unwrap())
        .collect();
    for kind in [
        "unused_vertices",
        "zero_area_faces",
        "non_manifold_edges",
        "components",
    ] {
        assert!(kinds.contains(&kind), "{kind} is not in {kinds:?}");
    }
}

#[test]
fn a_report_can_go_to_a_file() {
    let fixture = Fixture::new();
    let arguments = "drape sleeve.obj body.obj -o out.obj --report report.json -q";
    let output = fixture.garnet(arguments);
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
    let report: Value = serde_json::from_slice(&fixture.read("report.json")).unwrap();
    assert_eq!(report["drapes"][0]["output"], "out.obj");
}

#[test]
fn a_garment_beside_the_body_is_refused() {
    let fixture = Fixture::new();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let shirt = ObjFile::read(models.join("tshirt/template.obj")).unwrap();
    for (way, told) in [
        (Vector3::x(), "to one side of the skin"),
        (Vector3::z(), "are 0.3"),
    ] {
        let moved: Vec<Point3> = shirt.positions().iter().map(|p| p + way * 0.7).collect();
        let path = fixture.path("beside.obj");
        shirt.write_with_positions(&path, &moved).unwrap();
        let rig = models.join("tshirt/body.rig.npz");
        let arguments = format!(
            "drape beside.obj --rig {} --pose wave -o out.obj",
            rig.display()
        );
        let output = fixture.garnet(&arguments);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(told) && text.contains("hint:"), "{text}");
        assert!(!fixture.path("out.obj").exists());
    }
}

#[test]
fn a_garment_too_high_or_too_low_is_refused() {
    let fixture = Fixture::new();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let mut accepted = Vec::new();
    for (garment, rig) in [
        ("tshirt/template.obj", "tshirt/body.rig.npz"),
        ("demo/tunic.obj", "demo/body.rig.npz"),
    ] {
        let file = ObjFile::read(models.join(garment)).unwrap();
        for height in [-0.7, -0.5, 0.7] {
            let way = Vector3::y() * height;
            let moved: Vec<Point3> = file.positions().iter().map(|p| p + way).collect();
            let path = fixture.path("moved.obj");
            file.write_with_positions(&path, &moved).unwrap();
            let rig = models.join(rig);
            let arguments = format!(
                "drape moved.obj --rig {} --pose wave -o out.obj",
                rig.display()
            );
            let output = fixture.garnet(&arguments);
            let text = stderr(&output);
            if output.status.code() != Some(2) || !text.contains("does not lie on") {
                accepted.push(format!("{garment} {height}: {text}"));
            }
        }
    }
    assert!(accepted.is_empty(), "{}", accepted.join("\n"));
}

#[test]
fn a_body_in_the_place_of_the_garment_is_told() {
    let fixture = Fixture::new();
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/demo");
    let [tunic, reach, rig] =
        ["tunic.obj", "reach.obj", "body.rig.npz"].map(|name| demo.join(name));
    let [tunic, reach, rig] = [&tunic, &reach, &rig].map(|path| path.display());
    for arguments in [
        // Swapped, the body twice, and a package as the body.
        format!("drape {reach} {tunic} --rig {rig} -o out.obj"),
        format!("drape {reach} {reach} --rig {rig} -o out.obj"),
        format!("drape {reach} {}/../tshirt -o out.obj", demo.display()),
    ] {
        let output = fixture.garnet(&arguments);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(
            text.contains("is given as") && text.contains("comes first"),
            "{text}"
        );
        assert!(!fixture.path("out.obj").exists());
    }
}

#[test]
fn what_is_mistyped_is_told_before_work() {
    let fixture = Fixture::new();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let (shirt, walk) = (models.join("tshirt"), models.join("demo/walk.bvh"));
    let (shirt, walk) = (shirt.display(), walk.display());
    for (arguments, told) in [
        (
            format!("{shirt} --pose waev -o out.obj"),
            "did you mean `wave`?",
        ),
        (
            format!("{shirt} --pose wave --method fats -o out.obj"),
            "did you mean `fast`?",
        ),
        (
            "sleeve.obj bent.obj --rig body.rig.npz --method wrap -o out.obj".to_owned(),
            "did you mean `warp`?",
        ),
        (format!("{shirt} -o out.obj"), "as `--pose wave`"),
        (
            format!("{shirt} --pose {walk}:5:3 -o out.obj"),
            "`5:3` names none",
        ),
        (
            format!("{shirt} . -o out.obj"),
            "it is a folder, not a file",
        ),
    ] {
        let output = fixture.garnet(&format!("drape {arguments}"));
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(told), "{text}");
        assert!(!fixture.path("out.obj").exists());
    }
}

/// Writes the body of the fixture as `own.glb`.
fn glb_of_body(fixture: &Fixture) {
    let body = read_rig(fixture.path("body.rig.npz")).unwrap();
    fixture.bytes("own.glb", &glb_of(&body.into_body().unwrap()));
}

#[test]
fn a_body_may_be_a_rig() {
    let fixture = Fixture::new();
    glb_of_body(&fixture);
    reported(
        &fixture,
        "drape sleeve.obj --rig own.glb --pose bend.json -o out.obj",
    );
    reported(
        &fixture,
        "drape sleeve.obj own.glb --pose bend.json -o of_glb.obj",
    );
    assert_eq!(fixture.read("out.obj"), fixture.read("of_glb.obj"));
    reported(
        &fixture,
        "drape sleeve.obj body.rig.npz --pose bend.json -o of_npz.obj",
    );
    assert!(distance(&fixture, "out.obj", "of_npz.obj") < RECOVERED);
    let output = fixture.garnet("render sleeve.obj own.glb -o of_glb.png --size 320x120");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = fixture.garnet("render sleeve.obj body.obj -o of_obj.png --size 320x120");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(fixture.read("of_glb.png"), fixture.read("of_obj.png"));
}

#[test]
fn a_body_at_rest_tells_unit_and_axis() {
    let fixture = Fixture::new();
    glb_of_body(&fixture);
    reported(
        &fixture,
        "drape sleeve.obj --rig own.glb --pose bend.json -o out.obj",
    );
    for name in ["sleeve.obj", "body.obj"] {
        fixture.moved(name, &format!("cm_{name}"), |p| {
            100.0 * Point3::new(p.x, -p.z, p.y)
        });
    }
    let arguments = "drape cm_sleeve.obj cm_body.obj --rig own.glb --pose bend.json -o cm_out.obj";
    let report = reported(&fixture, arguments);
    assert_eq!(report["garment"]["units"], "cm");
    assert_eq!(report["garment"]["up"], "z");
    fixture.moved("cm_out.obj", "back.obj", |p| {
        Point3::new(p.x, p.z, -p.y) / 100.0
    });
    assert!(distance(&fixture, "out.obj", "back.obj") < RECOVERED);
}

#[test]
fn a_posed_body_lies_under_the_drape_whatever_its_file_is_in() {
    let fixture = Fixture::new();
    reported(
        &fixture,
        "drape sleeve.obj body.obj --pose bend.json -o out.obj --body-out b.obj",
    );
    let upright = |p: &Point3| Point3::new(p.x, -p.z, p.y);
    fixture.moved("body.obj", "large.obj", |p| 100.0 * upright(p));
    fixture.moved("sleeve.obj", "upright.obj", upright);
    let arguments = "drape upright.obj large.obj --rig body.rig.npz --pose bend.json --units m,cm \
                     --up z -o upright_out.obj --body-out upright_b.obj";
    let report = reported(&fixture, arguments);
    for (part, units) in [("garment", "m"), ("rest_body", "cm")] {
        assert_eq!(report[part]["units"], units, "{part}");
        assert_eq!(report[part]["up"], "z", "{part}");
    }
    for [level, upright] in [["out.obj", "upright_out.obj"], ["b.obj", "upright_b.obj"]] {
        fixture.moved(upright, "back.obj", |p| Point3::new(p.x, p.z, -p.y));
        assert!(distance(&fixture, level, "back.obj") < RECOVERED, "{level}");
    }
}

#[test]
fn a_new_body_is_in_the_units_of_the_drape() {
    let fixture = Fixture::new();
    glb_of_body(&fixture);
    let arguments = "drape sleeve.obj --rig own.glb --pose bend.json -o out.obj --body-out b.obj";
    reported(&fixture, arguments);
    fixture.moved("sleeve.obj", "large.obj", |p| {
        100.0 * Point3::new(p.x, -p.z, p.y)
    });
    let arguments = "drape large.obj --rig own.glb --pose bend.json --units cm,m --up z \
                     -o large_out.obj --body-out large_b.obj";
    reported(&fixture, arguments);
    for [small, large] in [["out.obj", "large_out.obj"], ["b.obj", "large_b.obj"]] {
        fixture.moved(large, "back.obj", |p| Point3::new(p.x, p.z, -p.y) / 100.0);
        assert!(distance(&fixture, small, "back.obj") < RECOVERED, "{large}");
    }
}

#[test]
fn a_scene_in_another_pose_is_told_how() {
    let fixture = Fixture::new();
    let output = fixture.garnet("drape --scene scene.json --pose wave -o out.obj");
    assert_eq!(output.status.code(), Some(2));
    let text = stderr(&output);
    assert!(text.contains("--rig scene.json --pose"), "{text}");
}

#[test]
fn a_garment_is_placed_where_it_does_not_lie_on_its_body() {
    let fixture = Fixture::new();
    fixture.moved("sleeve.obj", "cm.obj", |p| p * 100.0);
    fixture.moved("sleeve.obj", "beside.obj", |p| {
        p + Vector3::new(0.9, 0.1, 0.0)
    });
    for name in ["cm", "beside"] {
        let arguments = format!("drape {name}.obj body.obj --pose bend.json");
        refused(
            &fixture,
            &format!("{arguments} -o no.obj"),
            &["does not lie on", "`--place`"],
        );
        let arguments = format!("{arguments} --place -o {name}_out.obj");
        let output = fixture.garnet(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let told = stderr(&output);
        assert!(told.contains("is brought to the body: "), "{told}");
        assert!(
            told.contains("limbs go through 2 of its 2 openings"),
            "{told}"
        );
        let report = reported(&fixture, &arguments);
        assert_eq!(report["drapes"][0]["untangle"]["inside"], 0);
        assert_eq!(report["garment"]["units"], "m");
        let stretch = report["drapes"][0]["stretch"]["p99"].as_f64().unwrap();
        assert!(stretch < 1.3, "{name}: {stretch}");
    }
    let output = fixture.garnet("garment from-obj cm.obj --rest-body body.obj --place -o sleeve");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report = reported(&fixture, "drape sleeve --pose bend.json -o packaged.obj");
    assert_eq!(report["drapes"][0]["untangle"]["inside"], 0);
}

#[test]
fn holes_of_a_body_are_closed_and_told() {
    let fixture = Fixture::new();
    let body = read_rig(fixture.path("body.rig.npz")).unwrap();
    let rest = body.rest.clone().unwrap();
    // The skin of the lower half is missing but for the end.
    let at = |vertex: u32| rest.positions()[vertex as usize].y;
    let is_kept = |face: &&[u32; 3]| {
        !face
            .iter()
            .all(|&vertex| (-0.35..0.1).contains(&at(vertex)))
    };
    let faces = rest.faces().iter().filter(is_kept).copied().collect();
    let open = TriMesh::new(rest.positions().to_vec(), faces).unwrap();
    let rig = Rig {
        rest: Some(open),
        ..body
    };
    write_rig_npz(fixture.path("open.rig.npz"), &rig).unwrap();
    let arguments = "drape sleeve.obj --rig open.rig.npz --pose bend.json";
    let report = reported(
        &fixture,
        &format!("{arguments} --body-out b.obj -o open.obj"),
    );
    assert_eq!(report["drapes"][0]["untangle"]["inside"], 0);
    let over = report["garment"]["over_holes"].as_u64().unwrap();
    assert!((200..1240).contains(&over), "{over}");
    let warnings = report["warnings"].as_array().unwrap();
    for kind in ["open_body", "over_holes"] {
        let told = |warning: &Value| warning["kind"] == kind;
        assert!(warnings.iter().any(told), "{kind}: {warnings:?}");
    }
    // The body is written as it is, without what closes it.
    let written = ObjFile::read(fixture.path("b.obj"))
        .unwrap()
        .mesh()
        .unwrap();
    assert_eq!(written.num_faces(), rig.rest.unwrap().num_faces());
    // Nothing would hold it: it does not settle, which is told.
    let report = reported(&fixture, &format!("{arguments} --settle 5 -o settled.obj"));
    let warnings = report["warnings"].as_array().unwrap();
    let told = |warning: &Value| warning["kind"] == "unsettled";
    assert!(warnings.iter().any(told), "{warnings:?}");
    assert!(fixture.read("open.obj") == fixture.read("settled.obj"));
}

#[test]
fn meshes_of_a_rig_are_chosen_by_every_command_that_reads_one() {
    let fixture = Fixture::new();
    let body = read_rig(fixture.path("body.rig.npz")).unwrap();
    let bytes = glb_of(&body.into_body().unwrap());
    std::fs::write(fixture.path("body.glb"), bytes).unwrap();
    for command in [
        "drape sleeve.obj --rig body.glb --pose bend.json -o no.obj",
        "info body.glb",
        "render body.glb -o no.png",
        "garment from-obj sleeve.obj --rig body.glb -o no",
    ] {
        refused(&fixture, &format!("{command} --mesh Cloak"), &["Cloak"]);
    }
}

#[test]
fn triangles_whose_corners_were_rounded_apart_are_one_cloth() {
    let fixture = Fixture::new();
    let sleeve = ObjFile::read(fixture.path("sleeve.obj")).unwrap();
    let mesh = sleeve.mesh().unwrap();
    let mut soup = String::new();
    for (number, face) in mesh.faces().iter().enumerate() {
        for (corner, &vertex) in face.iter().enumerate() {
            let place = mesh.positions()[vertex as usize];
            let off = 1e-6 * ((number + corner) % 3) as f32;
            let [x, y, z] = [place.x + off, place.y - off, place.z];
            writeln!(soup, "v {x:.6} {y:.6} {z:.6}").unwrap();
        }
        let first = 3 * number + 1;
        writeln!(soup, "f {first} {} {}", first + 1, first + 2).unwrap();
    }
    fixture.text("soup.obj", &soup);
    let output = fixture.garnet("drape soup.obj bent.obj --rig body.rig.npz -o out.obj");
    let told = stderr(&output);
    assert!(output.status.success(), "{told}");
    assert!(told.contains("sewn to it"), "{told}");
    assert!(!told.contains("parts that share no vertex"), "{told}");
    // Corners of one vertex of the sleeve stay together.
    let draped = ObjFile::read(fixture.path("out.obj")).unwrap();
    let corners = mesh.faces().as_flattened().iter().zip(draped.positions());
    let mut first = HashMap::new();
    for (vertex, place) in corners {
        let first = *first.entry(vertex).or_insert(*place);
        assert!((first - place).norm() < 1e-5, "{vertex}");
    }
}

#[test]
fn a_few_faces_that_settling_brings_into_the_skin_do_not_stop_the_rest() {
    let fixture = Fixture::new();
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/demo");
    let demo = demo.display();
    let inputs = format!("drape {demo}/tunic.obj --rig {demo}/body.rig.npz --pose step_forward");
    let drape =
        |options: &str| reported(&fixture, &format!("{inputs} {options}"))["drapes"][0].clone();
    let warped = drape("-o warped.obj");
    let settled = drape("--settle 60 -o settled.obj");
    assert!(settled["unsettled"].is_null(), "{settled}");
    assert_eq!(settled["untangle"]["inside"], 0);
    assert_eq!(settled["untangle"]["crossing_faces"], 0);
    let strain = |drape: &Value| drape["stretch"]["p99"].as_f64().unwrap() - 1.0;
    assert!(
        strain(&settled) < 0.6 * strain(&warped),
        "{settled} {warped}"
    );
}
