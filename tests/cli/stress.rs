//! The level at which each way to drape breaks, by the command.

use garnet::io::read_rig;
use serde_json::{Value, json};

use crate::fixtures::{Fixture, refused_with_hint, stderr};
use crate::train::done;

#[test]
fn a_table_a_picture_and_numbers_are_left_and_gone_on_from() {
    let fixture = Fixture::new();
    let asked = "stress -o out --quick --axis elbow,place --method none";
    let report: Value = serde_json::from_str(&done(&fixture, &format!("{asked} --json"))).unwrap();
    assert_eq!(report["schema"], "garnet.stress/1");
    assert_eq!(report["garment"], "tshirt");
    let holds = report["holds"].as_array().unwrap();
    assert_eq!(holds.len(), 12);
    let of = |method: &str, axis: &str| {
        let is = |hold: &&Value| hold["method"] == method && hold["axis"] == axis;
        holds.iter().find(is).unwrap().clone()
    };
    let ours = of("warp, untangled", "elbow");
    assert_eq!(
        (&ours["fails"], &ours["broke"]),
        (&false.into(), &Value::Null)
    );
    let plain = of("linear, nearest weights", "elbow");
    assert!(plain["broke"].is_array(), "{plain}");
    for name in [
        "out/stress.md",
        "out/stress.json",
        "out/stress.svg",
        "out/cells.json",
    ] {
        assert!(!fixture.read(name).is_empty(), "{name}");
    }
    assert!(fixture.read("out/stress.png").starts_with(b"\x89PNG"));
    let table = String::from_utf8(fixture.read("out/stress.md")).unwrap();
    assert!(
        table.contains("| `elbow`: ") && table.contains(" [^check] |"),
        "{table}"
    );

    // What is there is not draped again; another axis is.
    let cells = |bytes: &[u8]| -> Vec<Value> {
        let record: Value = serde_json::from_slice(bytes).unwrap();
        record["cells"].as_array().unwrap().clone()
    };
    let before = cells(&fixture.read("out/cells.json"));
    done(
        &fixture,
        "stress -o out --quick --axis elbow,clearance --method none -q",
    );
    let after = cells(&fixture.read("out/cells.json"));
    assert_eq!(after[..before.len()], before[..]);
    assert!(
        after[before.len()..]
            .iter()
            .all(|cell| cell["axis"] == "clearance")
    );
    assert!(after.len() > before.len());
}

#[test]
fn what_there_is_not_is_refused_with_what_there_is() {
    let fixture = Fixture::new();
    let out = "-o out --quick";
    refused_with_hint(
        &fixture,
        &format!("stress {out} --axis weather"),
        &["there is no axis `weather`", "the axes are: elbow, knee"],
    );
    refused_with_hint(
        &fixture,
        &format!("stress {out} --method magic"),
        &[
            "there is no method `magic`",
            "expected one of simulator, none",
        ],
    );
    done(
        &fixture,
        "stress -o out --quick --axis clearance --method none -q",
    );
    refused_with_hint(
        &fixture,
        "stress -o out --quick --axis clearance --method none --seed 2",
        &["is of another run", "remove the file to begin anew"],
    );
}

#[test]
fn one_of_ours_that_breaks_is_an_exit_status() {
    let fixture = Fixture::new();
    done(
        &fixture,
        "stress -o out --quick --axis clearance --method none -q",
    );
    let text = String::from_utf8(fixture.read("out/cells.json")).unwrap();
    let mut record: Value = serde_json::from_str(&text).unwrap();
    for cell in record["cells"].as_array_mut().unwrap() {
        if cell["method"] == "warp, untangled" && cell["level"] == 2.0 {
            cell["broken"] = serde_json::json!({ "inside": 3 });
        }
    }
    std::fs::write(fixture.path("out/cells.json"), record.to_string()).unwrap();
    let output = fixture.garnet("stress -o out --quick --axis clearance --method none");
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("1 of ours break at their bar or before"));
    let table = String::from_utf8(fixture.read("out/stress.md")).unwrap();
    assert!(table.contains("**0: 3 inside**"), "{table}");
    assert!(table.contains("--seed 1 --axis clearance`"), "{table}");
}

#[test]
fn a_package_that_is_none_leaves_no_folder() {
    let fixture = Fixture::new();
    let output = fixture.garnet("stress nowhere -o out --quick");
    assert_eq!(output.status.code(), Some(2));
    assert!(!fixture.path("out").exists());
}

/// Joints at most that move a vertex in a file.
const INFLUENCES: usize = 8;

#[test]
fn a_scene_of_ones_own_is_stressed() {
    let fixture = Fixture::new();
    done(&fixture, "garment tshirt --vertices 500 -o tee -q");
    let rig = read_rig(fixture.path("tee/body.rig.npz")).unwrap();
    fixture.mesh("own.obj", rig.rest.as_ref().unwrap());
    let joints = rig.skeleton.joints().iter().map(|joint| {
        let parent = joint.parent.map_or(json!(-1), |parent| json!(parent));
        let place: [f32; 3] = joint.rest_position.into();
        json!({"name": joint.name, "parent": parent, "rest_position": place})
    });
    let joints: Vec<Value> = joints.collect();
    let rows = (0..rig.weights.num_vertices()).map(|vertex| {
        let mut row: Vec<(usize, f32)> = rig.weights.vertex(vertex).collect();
        row.resize(INFLUENCES, (0, 0.0));
        row
    });
    let rows: Vec<Vec<(usize, f32)>> = rows.collect();
    let indices: Vec<Vec<usize>> = (rows.iter())
        .map(|row| row.iter().map(|(joint, _)| *joint).collect())
        .collect();
    let shares: Vec<Vec<f32>> = (rows.iter())
        .map(|row| row.iter().map(|(_, share)| *share).collect())
        .collect();
    let weights = json!({
        "joints": joints.len(), "influences_per_vertex": INFLUENCES,
        "joint_index": indices, "weight": shares,
    });
    fixture.text("weights.json", &weights.to_string());
    let scene = json!({
        "schema": "drape-scene/1", "units": "m", "up": "+Y",
        "garment": {"mesh": "tee/template.obj"},
        "body_rest": {"mesh": "own.obj", "joints": joints},
        "body_target": {"mesh": "own.obj"},
        "weights": "weights.json",
    });
    fixture.text("scene.json", &scene.to_string());
    let asked = "stress --scene scene.json -o out --quick --axis elbow,strong-gravity";
    for _ in 0..2 {
        let text = done(&fixture, &format!("{asked} --method simulator --json"));
        let report: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(report["garment"], "scene");
        let holds = report["holds"].as_array().unwrap();
        let is_ours = |hold: &&Value| hold["method"] == "warp, untangled";
        assert_eq!(holds.iter().filter(is_ours).count(), 2);
        let breaks = |hold: &Value| hold["fails"] == true;
        assert!(!holds.iter().any(breaks), "{report}");
    }
    // A package is another input.
    let both = fixture.garnet("stress tee --scene scene.json -o out");
    assert_eq!(both.status.code(), Some(2));
}
