//! Simulations: frames, reports, and garments that no cloth can be.

use std::fs;

use garnet::{Point3, TriMesh, io::ObjFile, primitives::tube};

use crate::fixtures::{Fixture, stderr, stdout};

/// Runs a command that must be refused without leaving anything behind.
fn refused(fixture: &Fixture, arguments: &str, expected: &str) {
    let before = fixture.names();
    let output = fixture.garnet(arguments);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments}: {text}");
    assert!(text.starts_with("error: "), "{arguments}: {text}");
    assert!(
        text.contains(expected),
        "{arguments}: `{expected}` is not in {text}"
    );
    assert_eq!(fixture.names(), before, "{arguments}");
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
fn what_is_no_cloth_is_refused() {
    let fixture = Fixture::new();
    let sleeve = tube(0.13, 0.8, 40, 30);
    let write = |name: &str, faces: Vec<[u32; 3]>| {
        let mesh = TriMesh::new(sleeve.positions().to_vec(), faces).unwrap();
        fixture.mesh(name, &mesh);
    };

    let mut inverted = sleeve.faces().to_vec();
    inverted[7].swap(0, 1);
    write("inverted.obj", inverted);
    refused(
        &fixture,
        "simulate inverted.obj bent.obj --rig body.rig.npz -o out.obj",
        "cannot simulate",
    );

    let mut fins = sleeve.faces().to_vec();
    let [a, b, _] = fins[0];
    fins.push([a, b, 500]);
    write("fins.obj", fins);
    refused(
        &fixture,
        "simulate fins.obj bent.obj --rig body.rig.npz -o out.obj",
        "cannot simulate",
    );

    let [a, b, c] = sleeve.faces()[0].map(|vertex| vertex as usize);
    let mut positions = sleeve.positions().to_vec();
    positions[a] = positions[b] + 0.5 * (positions[c] - positions[b]);
    let needle = sleeve.with_positions(positions).unwrap();
    fixture.mesh("needle.obj", &needle);
    refused(
        &fixture,
        "simulate needle.obj bent.obj --rig body.rig.npz -o out.obj",
        "cannot simulate",
    );

    fixture.moved("sleeve.obj", "thin.obj", |p| {
        Point3::new(0.3 * p.x, p.y, 0.3 * p.z)
    });
    refused(
        &fixture,
        "simulate thin.obj bent.obj --rig body.rig.npz -o out.obj",
        "inside the body at rest",
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
