//! Charts: what they leave, how they go on, and what they refuse.

use serde_json::Value;

use crate::fixtures::stderr;
use crate::train::{done, prepared};

const ASKED: &str = "--teacher-scenes 0 --repeat 1";

#[test]
fn a_chart_leaves_pictures_and_numbers_and_goes_on_from_there() {
    let fixture = prepared();
    done(&fixture, "train net scenes --preset tiny --epochs 1 -q");
    let report = done(&fixture, &format!("chart net scenes -o out {ASKED} --json"));
    let report: Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["schema"], "garnet.chart/1");
    let methods = report["methods"].as_array().unwrap();
    let names: Vec<&str> = methods
        .iter()
        .map(|method| method["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["dqs", "warp", "local", "local settled"]);
    for method in methods {
        let seconds = &method["seconds"];
        let total = seconds["total"]["median"].as_f64().unwrap();
        assert!(total > seconds["untangle"]["median"].as_f64().unwrap());
        assert_eq!(
            (&method["scenes"], &method["inside"]),
            (&1.into(), &0.into())
        );
    }
    let is_on_front = |method: &Value| method["is_on_front"] == true;
    assert!(methods.iter().any(is_on_front));
    assert!(methods[2]["flop"].as_u64().unwrap() > 0);
    let text = |name: &str| String::from_utf8(fixture.read(name)).unwrap();
    let svg = text("out/chart.svg");
    assert!(svg.starts_with("<svg") && svg.contains("local"));
    assert!(fixture.read("out/chart.png").starts_with(b"\x89PNG"));
    let csv = text("out/chart.csv");
    let fields: Vec<usize> = csv.lines().map(|line| line.split(',').count()).collect();
    assert_eq!(fields.len(), 5);
    assert!(fields.iter().all(|&count| count == fields[0]));

    // What is there is not measured again; a new network is.
    let samples = fixture.read("out/samples.json");
    done(&fixture, &format!("chart net scenes -o out {ASKED} -q"));
    assert_eq!(fixture.read("out/samples.json"), samples);
    done(
        &fixture,
        "train net scenes --preset tiny --epochs 1 --kind local --variant more -q",
    );
    done(&fixture, &format!("chart net scenes -o out {ASKED} -q"));
    let method = |bytes: &[u8], name: &str| -> Value {
        let record: Value = serde_json::from_slice(bytes).unwrap();
        let methods = record["methods"].as_array().unwrap();
        let found = methods.iter().find(|method| method["name"] == name);
        found.unwrap()["samples"].clone()
    };
    let more = fixture.read("out/samples.json");
    assert_eq!(method(&more, "warp"), method(&samples, "warp"));
    assert_eq!(method(&more, "more").as_array().unwrap().len(), 1);
    done(
        &fixture,
        &format!("chart net scenes -o out {ASKED} -q --fresh"),
    );
    let fresh = fixture.read("out/samples.json");
    assert_ne!(method(&fresh, "warp"), method(&samples, "warp"));
}

#[test]
fn other_programs_are_drawn_beside() {
    let fixture = prepared();
    let peer = r#"{"schema": "garnet.peer/1", "name": "Elsewhere", "settings": "as it comes",
        "garment": "sleeve", "pose": "wave", "machine": "-", "seconds": 12.5, "is_at_rest": true,
        "distance_m": 0.0123, "inside": 3, "deepest": 0.001, "crossing_faces": 7,
        "stretch_p99": 1.125}"#;
    let peer = peer.replace('\n', "");
    fixture.text("peers.jsonl", &format!("{peer}\n"));
    let chart = format!("chart net scenes -o out {ASKED} --peers");
    let table = done(&fixture, &format!("{chart} peers.jsonl"));
    let told = "Elsewhere (as it comes): 12.5 s, 12.3 mm, 3 vertices inside, 7 faces cross the skin, \
                strain p99 12.5 %";
    assert!(table.contains(told), "{table}");
    let svg = String::from_utf8(fixture.read("out/chart.svg")).unwrap();
    assert!(svg.contains("Elsewhere") && svg.contains("other programs"));
    let report: Value = serde_json::from_slice(&fixture.read("out/chart.json")).unwrap();
    assert_eq!(report["peers"][0]["name"], "Elsewhere");
    for (line, expected) in [
        (
            peer.replace("\"sleeve\"", "\"other\""),
            "it drapes `other`, not `sleeve`",
        ),
        (peer.replace("12.5", "0"), "must be above zero"),
        (
            peer.replace("peer/1", "peer/2"),
            "its schema is `garnet.peer/2`",
        ),
        ("{}".to_owned(), "peers.jsonl`, line 2: no peer"),
    ] {
        fixture.text("peers.jsonl", &format!("{peer}\n{line}\n"));
        let output = fixture.garnet(&format!("{chart} peers.jsonl"));
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
}

#[test]
fn what_cannot_be_charted_is_refused_and_nothing_is_written() {
    let fixture = prepared();
    fixture.text(
        "no_test.json",
        r#"{"schema": "garnet.import/1", "units": "m", "scenes": [
  {"split": "train", "body": "a", "sequence": "bend", "body_mesh": "bent.obj", "garment_mesh": "md_bent.obj"}]}"#,
    );
    done(&fixture, "dataset net --import no_test.json -o no_test -q");
    fixture.moved("sleeve.obj", "other.obj", |place| 1.01 * *place);
    done(
        &fixture,
        "garment from-obj other.obj --rest-body body.obj -o other -q",
    );
    for (arguments, expected) in [
        ("chart net no_test -o out", "no scenes in its split `test`"),
        ("chart other scenes -o out", "other vertices at rest"),
        (
            "chart nothing scenes -o out",
            "`nothing` is no garment package",
        ),
        (
            "chart net scenes -o no/out",
            "the folder `no` does not exist",
        ),
        ("chart net scenes -o out --model none", "no variant `none`"),
    ] {
        let before = fixture.names();
        let output = fixture.garnet(arguments);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {text}");
        assert!(text.contains(expected), "{arguments}: {text}");
        assert!(text.contains("hint: "), "{arguments}: {text}");
        assert_eq!(fixture.names(), before, "{arguments}");
    }
}

#[test]
fn samples_that_cannot_be_gone_on_with_are_kept() {
    let fixture = prepared();
    let chart = "chart net scenes -o out --teacher-scenes 0";
    done(&fixture, &format!("{chart} -q"));
    let whole = fixture.read("out/samples.json");
    let refused = |arguments: &str, expected: &str| {
        let before = fixture.read("out/samples.json");
        let output = fixture.garnet(arguments);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {text}");
        assert!(text.contains(expected), "{arguments}: {text}");
        assert!(text.contains("hint: `--fresh`"), "{arguments}: {text}");
        assert_eq!(fixture.read("out/samples.json"), before, "{arguments}");
    };
    refused(&format!("{chart} --clearance 3"), "another clearance");
    refused(&format!("{chart} --repeat 2"), "another number of repeats");
    assert_eq!(fixture.read("out/samples.json"), whole);
    fixture.half("out/samples.json", "out/samples.json");
    refused(chart, "it is damaged");
    done(&fixture, &format!("{chart} --fresh -q"));
    assert!(fixture.read("out/samples.json").len() > whole.len() / 2);
}
