//! Many drapes that a file lists.

use serde_json::Value;

use crate::fixtures::{Fixture, refused_with_hint, stderr, stdout};

/// The lines of a batch.
fn lines(text: &str) -> Vec<Value> {
    let lines = text.lines();
    lines
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

#[test]
fn each_job_has_its_drape_and_its_line() {
    let fixture = Fixture::new();
    fixture.text(
        "jobs.json",
        r#"[
            {"garment": "sleeve.obj", "bodies": "bent.obj", "rest-body": "body.obj", "output": "a.obj"},
            {"garment": "absent.obj", "bodies": ["bent.obj"], "rest-body": "body.obj", "output": "b.obj"},
            {"garment": "sleeve.obj", "body": "body.obj", "pose": "bend.json", "output": "c.obj",
             "clearance": 3, "no-untangle": false, "max-penetration": 0.5}
        ]"#,
    );
    fixture.garnet("drape sleeve.obj bent.obj --rest-body body.obj -o alone.obj");
    let output = fixture.garnet("drape --batch jobs.json");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("2 of 3 jobs are done"));
    let lines = lines(&stdout(&output));
    assert_eq!(lines.len(), 3);
    let of = |line: usize, key: &str| lines[line][key].clone();
    assert_eq!((of(0, "job"), of(0, "exit_code")), (1.into(), 0.into()));
    assert_eq!(of(0, "report")["schema"], "garnet.drape/1");
    assert_eq!(of(2, "report")["clearance_m"], 0.003_f32);
    assert_eq!(
        (of(1, "exit_code"), of(1, "report")),
        (2.into(), Value::Null)
    );
    let told = of(1, "error").to_string();
    assert!(
        told.contains("absent.obj") && told.contains("hint"),
        "{told}"
    );
    // A job is what the command would have been.
    assert_eq!(fixture.read("a.obj"), fixture.read("alone.obj"));
    let names = fixture.names();
    assert!(names.contains(&"c.obj".to_owned()) && !names.contains(&"b.obj".to_owned()));
}

#[test]
fn a_list_that_is_wrong_is_refused_before_the_first_drape() {
    let fixture = Fixture::new();
    let good = r#"{"garment": "sleeve.obj", "bodies": "bent.obj", "rest-body": "body.obj", "output": "a.obj"}"#;
    let cases = [
        ("[]".to_owned(), "no jobs"),
        ("{}".to_owned(), "no list of jobs"),
        (
            format!(r#"[{good}, {{"garnment": "sleeve.obj"}}]"#),
            "job 2",
        ),
        (
            format!("[{good}, {good}]"),
            "job 1 has the output `a.obj`, too",
        ),
        (
            good.replace("a.obj", "a.obj\", \"settle\": \"many\", \"x\": \"y"),
            "no list of jobs",
        ),
        (
            format!("[{}]", good.replace("a.obj", "a.obj\", \"settle\": \"many")),
            "many",
        ),
        (
            format!(
                "[{}]",
                good.replace("a.obj", "a.obj\", \"units\": [\"m\"], \"x\": \"y")
            ),
            "units",
        ),
    ];
    for (text, expected) in cases {
        fixture.text("jobs.json", &text);
        refused_with_hint(&fixture, "drape --batch jobs.json", &[expected]);
        assert!(!fixture.names().contains(&"a.obj".to_owned()), "{text}");
    }
    refused_with_hint(&fixture, "drape --batch absent.json", &["absent.json"]);
    let output = fixture.garnet("drape --batch jobs.json --method warp");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("cannot be used with"));
}
