//! Simulations: frames, reports, and garments that no cloth can be.

use std::fs;

use garnet::{
    Point3, TriMesh,
    io::ObjFile,
    mesh::primitives::{capsule, tube},
};

use crate::fixtures::{self, Fixture, stderr, stdout};

/// Runs a command that must be refused with this in its message.
fn refused(fixture: &Fixture, arguments: &str, expected: &str) {
    fixtures::refused(fixture, arguments, &[expected]);
}

#[test]
fn a_simulation_writes_its_way_and_reports() {
    let fixture = Fixture::new();
    let arguments = "simulate sleeve.obj bent.obj --rig body.rig.npz --quality fast -o out.obj --frames way --report -";
    let output = fixture.garnet(arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(report["method"], "sim");
    assert_eq!(report["simulation"]["quality"], "fast");
    let drape = &report["drapes"][0];
    assert!(
        drape["simulated"]["strain_p99"].as_f64().unwrap() < 0.1,
        "{drape}"
    );
    assert_eq!(drape["simulated"]["inside"], 0, "{drape}");
    // Cloth caught between parts of the body is told apart.
    assert_eq!(drape["penetration"]["inside"], 0, "{drape}");
    assert_eq!(drape["penetration"]["trapped"], 0, "{drape}");
    let frames = fs::read_dir(fixture.path("way")).unwrap().count();
    assert!(frames > 30, "{frames}");
    let (start, end) = (
        ObjFile::read(fixture.path("sleeve.obj")),
        ObjFile::read(fixture.path("out.obj")),
    );
    assert_eq!(start.unwrap().num_vertices(), end.unwrap().num_vertices());
}

/// The names in a folder, sorted.
fn names_in(fixture: &Fixture, folder: &str) -> Vec<String> {
    let entries = fs::read_dir(fixture.path(folder)).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

#[test]
fn each_body_has_its_own_frames_and_no_older_ones() {
    let fixture = Fixture::new();
    fixture.moved("bent.obj", "second.obj", |p| Point3::new(p.x, p.y, p.z));
    let simulate = |bodies: &str, output: &str, quality: &str| {
        let arguments = format!(
            "simulate sleeve.obj {bodies} --rig body.rig.npz --quality {quality} -o {output} --frames way -q"
        );
        let output = fixture.garnet(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    };
    simulate("bent.obj second.obj", "drapes", "fast");
    assert_eq!(names_in(&fixture, "way"), ["bent", "second"]);
    let of_fast = names_in(&fixture, "way/bent");
    assert_eq!(of_fast, names_in(&fixture, "way/second"));
    fs::remove_dir_all(fixture.path("way")).unwrap();
    simulate("bent.obj", "out.obj", "teacher");
    fixture.text("way/frame_notes.obj", "");
    fixture.text("way/frame_9.obj", "");
    assert!(names_in(&fixture, "way").len() > of_fast.len() + 2);
    simulate("bent.obj", "out.obj", "fast");
    let mut expected = of_fast;
    expected.extend(["frame_9.obj".to_owned(), "frame_notes.obj".to_owned()]);
    assert_eq!(names_in(&fixture, "way"), expected);
}

#[test]
fn where_a_body_stands_and_how_it_faces_does_not_matter() {
    let fixture = Fixture::new();
    // By 100 degrees about y, and far away.
    let (sine, cosine) = 100_f32.to_radians().sin_cos();
    let away = |p: &Point3| {
        Point3::new(
            cosine * p.x + sine * p.z + 7.0,
            p.y - 3.0,
            cosine * p.z - sine * p.x - 20.0,
        )
    };
    let back = |p: &Point3| {
        let (x, z) = (p.x - 7.0, p.z + 20.0);
        Point3::new(cosine * x - sine * z, p.y + 3.0, cosine * z + sine * x)
    };
    fixture.moved("bent.obj", "away.obj", away);
    for (body, output) in [("bent.obj", "here.obj"), ("away.obj", "there.obj")] {
        let arguments = format!(
            "simulate sleeve.obj {body} --rig body.rig.npz --quality fast -o {output} --frames way_{output} --report {output}.json"
        );
        let output = fixture.garnet(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    let positions = |name: &str| {
        ObjFile::read(fixture.path(name))
            .unwrap()
            .positions()
            .to_vec()
    };
    let (here, there) = (positions("here.obj"), positions("there.obj"));
    let moved = there
        .iter()
        .map(back)
        .zip(&here)
        .map(|(a, b)| (a - b).norm());
    let mean = moved.sum::<f32>() / here.len() as f32;
    assert!(mean < 5e-4, "{mean}");
    let frames = names_in(&fixture, "way_there.obj");
    let last = positions(&format!("way_there.obj/{}", frames.last().unwrap()));
    assert_eq!(last, there);
    let report: serde_json::Value =
        serde_json::from_slice(&fixture.read("there.obj.json")).unwrap();
    assert_eq!(report["schema"], "garnet.simulate/1");
    assert_eq!(report["drapes"][0]["penetration"]["inside"], 0);
}

#[test]
fn outputs_do_not_take_the_place_of_inputs_or_of_each_other() {
    let fixture = Fixture::new();
    let arguments = "simulate sleeve.obj bent.obj --rig body.rig.npz --quality fast";
    let read = "one of the files that are read";
    for (output, expected) in [
        ("-o ./bent.obj", read),
        (
            "-o out.obj --report body.rig.npz",
            "reports are written as JSON",
        ),
        ("-o out --report out", "two outputs have this name"),
        ("-o -", "name a file"),
    ] {
        refused(&fixture, &format!("{arguments} {output}"), expected);
    }
    fs::create_dir(fixture.path("drapes")).unwrap();
    let twice = "two outputs have this name";
    fixture.text("twice.json", TWO_FRAMES);
    fs::create_dir(fixture.path("own")).unwrap();
    fixture.moved("sleeve.obj", "own/template.obj", |p| *p);
    for (arguments, expected) in [
        (
            "drape sleeve.obj bent.obj body.obj --rig body.rig.npz -o .",
            read,
        ),
        (
            "drape sleeve.obj bent.obj --rig body.rig.npz -o out.obj --report sleeve.obj",
            "reports are written as JSON",
        ),
        (
            "drape sleeve.obj --rig body.rig.npz --pose bend.json -o out.obj --body-out sleeve.obj",
            read,
        ),
        (
            "drape sleeve.obj --rig body.rig.npz --pose twice.json:0:2 -o drapes --body-out drapes",
            twice,
        ),
        (
            "drape sleeve.obj --rig body.rig.npz --pose twice.json:0:2 -o -",
            "name a folder",
        ),
        ("body body.obj --pose bend.json -o body.obj", read),
        (
            "garment from-obj own/template.obj --rest-body body.obj -o own",
            read,
        ),
        (
            "garment from-obj sleeve.obj --rest-body body.obj -o -",
            "name a folder",
        ),
    ] {
        refused(&fixture, arguments, expected);
    }
}

/// What a pose file of two frames says.
const TWO_FRAMES: &str = r#"{"schema": "garnet.pose/1", "frames": [
    {"joints": {"elbow": [0.5, 0, 0, 0.866025]}}, {"joints": {"elbow": [0.6, 0, 0, 0.8]}}]}"#;

#[test]
fn faces_that_cross_the_skin_are_told() {
    let fixture = Fixture::new();
    // Six sides round a limb: their middles are nearer to it than their corners.
    fixture.mesh("coarse.obj", &tube(0.158, 0.8, 6, 6));
    let arguments =
        "simulate coarse.obj bent.obj --rig body.rig.npz --quality fast -o out.obj --report -";
    let output = fixture.garnet(arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    let crossing = &report["drapes"][0]["penetration"]["crossing_faces"];
    assert!(crossing.as_u64().unwrap() > 0, "{report}");
    let warnings = report["warnings"].as_array().unwrap();
    let of_crossing = |warning: &serde_json::Value| warning["kind"] == "crossing_faces";
    assert!(warnings.iter().any(of_crossing), "{report}");
}

#[test]
fn the_same_simulation_gives_the_same_bytes() {
    let fixture = Fixture::new();
    for (threads, name) in [("1", "a.obj"), ("3", "b.obj")] {
        let arguments = format!(
            "simulate sleeve.obj bent.obj --rig body.rig.npz --quality fast --threads {threads} -o {name} -q"
        );
        let output = fixture.garnet(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    assert!(fixture.read("a.obj") == fixture.read("b.obj"));
}

#[test]
fn drape_by_simulation_leaves_nothing_inside() {
    let fixture = Fixture::new();
    let output = fixture
        .garnet("drape sleeve.obj bent.obj --rig body.rig.npz --method sim --report - -o out.obj");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(report["drapes"][0]["untangle"]["inside"], 0);
}

#[test]
fn any_garment_is_simulated() {
    let fixture = Fixture::new();
    let sleeve = tube(0.13, 0.8, 40, 30);
    let write = |name: &str, faces: Vec<[u32; 3]>| {
        let mesh = TriMesh::new(sleeve.positions().to_vec(), faces).unwrap();
        fixture.mesh(name, &mesh);
    };
    let mut inverted = sleeve.faces().to_vec();
    inverted[7].swap(0, 1);
    write("inverted.obj", inverted);
    let behind = sleeve.faces().iter().map(|&[a, b, c]| [a, c, b]);
    write(
        "doubled.obj",
        sleeve.faces().iter().copied().chain(behind).collect(),
    );
    let mut fins = sleeve.faces().to_vec();
    let [a, b, _] = fins[0];
    fins.push([a, b, 500]);
    write("fins.obj", fins);
    let [a, b, c] = sleeve.faces()[0].map(|vertex| vertex as usize);
    let mut positions = sleeve.positions().to_vec();
    positions[a] = positions[b] + 0.5 * (positions[c] - positions[b]);
    fixture.mesh("needle.obj", &sleeve.with_positions(positions).unwrap());
    write("plain.obj", sleeve.faces().to_vec());

    for (name, most) in [
        ("plain", 0.0),
        ("inverted", 0.01),
        ("doubled", 0.01),
        ("fins", 0.5),
        ("needle", 0.1),
    ] {
        let output = fixture.garnet(&format!(
            "simulate {name}.obj bent.obj --rig body.rig.npz --quality fast -o {name}.out.obj"
        ));
        let told = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{name}: {told}");
        let is_told = told.contains("look to different sides")
            || told.contains("have the vertices of another")
            || told.contains("more than two faces")
            || told.contains("no area");
        assert_eq!(is_told, name != "plain", "{name}: {told}");
        let [plain, found] = ["plain", name]
            .map(|name| ObjFile::read(fixture.path(&format!("{name}.out.obj"))).unwrap());
        let pairs = plain.positions().iter().zip(found.positions());
        let farthest = pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f32::max);
        assert!(farthest <= most, "{name}: {farthest}");
    }
}

#[test]
fn a_part_that_is_the_body_is_told_however_it_is_cut() {
    let fixture = Fixture::new();
    let sleeve = tube(0.13, 0.8, 40, 30);
    // Another mesh of the body, one that is 3 mm smaller, and a suit 6 mm outside of it.
    for (name, radius, is_body) in [
        ("coarse", 0.1, true),
        ("smaller", 0.097, true),
        ("suit", 0.106, false),
    ] {
        let part = capsule(radius, 1.4 + 2.0 * (radius - 0.1), 40, 20);
        let places = sleeve.positions().iter().chain(part.positions());
        let count = sleeve.num_vertices() as u32;
        let other = part
            .faces()
            .iter()
            .map(|face| face.map(|corner| corner + count));
        let faces = sleeve.faces().iter().copied().chain(other);
        let both = TriMesh::new(places.copied().collect(), faces.collect()).unwrap();
        fixture.mesh(&format!("{name}.obj"), &both);
        let output = fixture.garnet(&format!(
            "drape {name}.obj bent.obj --rig body.rig.npz --method warp --no-untangle -o out.obj"
        ));
        let told = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{name}: {told}");
        let expected = "one part of the garment is the body";
        assert_eq!(told.contains(expected), is_body, "{name}: {told}");
    }
}

#[test]
fn a_garment_in_the_body_is_not_simulated() {
    let fixture = Fixture::new();
    fixture.moved("sleeve.obj", "thin.obj", |p| {
        Point3::new(0.3 * p.x, p.y, 0.3 * p.z)
    });
    refused(
        &fixture,
        "simulate thin.obj bent.obj --rig body.rig.npz -o out.obj",
        "deep in the body",
    );
}

#[test]
fn absurd_fabrics_are_refused() {
    let fixture = Fixture::new();
    let made = fixture.garnet("garment from-obj sleeve.obj --rest-body body.obj -o pack -q");
    assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
    let manifest = fixture.path("pack/garment.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    let density = text
        .lines()
        .find(|line| line.starts_with("density"))
        .unwrap();
    fs::write(&manifest, text.replace(density, "density = -1.0")).unwrap();
    refused(&fixture, "simulate pack bent.obj -o out.obj", "density");
}

#[test]
fn what_stays_strained_as_it_settles_is_simulated_from_rest() {
    let fixture = Fixture::new();
    let demo = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/demo");
    let demo = demo.display();
    let scene = format!("{demo}/tunic.obj --rig {demo}/body.rig.npz --pose upward_salute");
    let report = |arguments: &str| -> (serde_json::Value, String) {
        let output = fixture.garnet(&format!("drape {scene} {arguments} --report - -q"));
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let report: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
        (report["drapes"][0].clone(), stderr(&output))
    };
    let (warped, _) = report("-o warped.obj");
    let (settled, _) = report("--settle 12 -o settled.obj");
    let p99 = |drape: &serde_json::Value| drape["stretch"]["p99"].as_f64().unwrap();
    assert!(p99(&warped) > 1.3, "{warped}");
    assert!(p99(&settled) < 1.25, "{settled}");
    let reason = settled["fallback"].as_str().unwrap();
    assert!(
        reason.starts_with("when it settled, 1 % of its edges"),
        "{reason}"
    );
    assert_eq!(settled["untangle"]["inside"], 0, "{settled}");
}
