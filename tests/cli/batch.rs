//! Many drapes that a file lists.

use garnet::mesh::primitives::tube;
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
        (
            format!("[{}]", good.replace("output", "ouput")),
            "did you mean `output`?",
        ),
        (
            "[{\"garment\": \"sleeve.obj\", \"bodies\": \"bent.obj\"}]".to_owned(),
            "--output <OUT>",
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

#[test]
fn tables_and_lines_of_json_are_jobs() {
    let fixture = Fixture::new();
    fixture.text(
        "jobs.csv",
        "garment,bodies,rest-body,pose,output,no-untangle,clearance\r\n\
         sleeve.obj,bent.obj,body.obj,,\"a, b.obj\",,\r\n\
         sleeve.obj,body.obj,,bend.json,c.obj,TRUE,\r\n\
         sleeve.obj,bent.obj;more.obj,body.obj,,many/,,3\r\n",
    );
    let output = fixture.garnet("drape --batch jobs.csv");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let of_table = lines(&stdout(&output));
    assert_eq!(of_table.len(), 3);
    assert_eq!(of_table[1]["report"]["untangled"], false);
    assert_eq!(of_table[2]["report"]["clearance_m"], 0.003_f32);
    assert!(fixture.path("many/more.obj").exists());
    fixture.garnet("drape sleeve.obj bent.obj --rest-body body.obj -o alone.obj");
    assert_eq!(fixture.read("a, b.obj"), fixture.read("alone.obj"));
    fixture.text(
        "jobs.jsonl",
        "{\"garment\": \"sleeve.obj\", \"bodies\": \"bent.obj\", \"rest-body\": \"body.obj\", \
         \"output\": \"d.obj\"}\n\n",
    );
    let output = fixture.garnet("drape --batch jobs.jsonl");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(lines(&stdout(&output)).len(), 1);
    assert_eq!(fixture.read("d.obj"), fixture.read("alone.obj"));
}

#[test]
fn tables_and_lines_that_are_wrong_are_told_by_line_and_value() {
    let fixture = Fixture::new();
    let head = "garment,body,rest-body,output";
    for (name, text, told) in [
        ("jobs.csv", String::new(), "`jobs.csv` has no jobs"),
        ("jobs.csv", format!("{head}\n"), "`jobs.csv` has no jobs"),
        (
            "jobs.csv",
            format!("{head},setle\n"),
            "did you mean `settle`?",
        ),
        (
            "jobs.csv",
            format!("{head},settle\nsleeve.obj,bent.obj,body.obj,a.obj,many\n"),
            "job 1 (line 2) of `jobs.csv` is refused\n  cause: invalid value 'many'",
        ),
        (
            "jobs.csv",
            format!("{head}\n\nsleeve.obj,bent.obj,body.obj\n"),
            "line 3 has 3 cells",
        ),
        (
            "jobs.csv",
            format!("{}\n", head.replace(',', ";")),
            "part cells by commas",
        ),
        (
            "jobs.jsonl",
            "{\"garment\": \"a.obj\", \"output\": \"a.obj\"}\n{\"garment\": }\n".to_owned(),
            "line 2: expected value, at column 13",
        ),
        (
            "jobs.jsonl",
            "\n{\"garment\": \"a.obj\", \"outptu\": \"b.obj\"}\n".to_owned(),
            "job 1 (line 2) of `jobs.jsonl` is refused",
        ),
    ] {
        fixture.text(name, &text);
        refused_with_hint(&fixture, &format!("drape --batch {name}"), &[name, told]);
        assert!(!fixture.names().contains(&"a.obj".to_owned()), "{text}");
    }
}

#[test]
fn no_job_replaces_the_list_or_what_any_job_reads_or_writes() {
    let fixture = Fixture::new();
    let job = |output: &str, more: &str| {
        format!(
            r#"{{"garment": "sleeve.obj", "bodies": "bent.obj", "rest-body": "body.obj", "output": "{output}"{more}}}"#
        )
    };
    let good = job("a.obj", "");
    std::fs::create_dir(fixture.path("frames")).unwrap();
    fixture.bytes("frames/wave_0001.obj", &fixture.read("bent.obj"));
    fixture.text("wave.bvh", "");
    let in_frames = job("b.obj", "").replace("\"bent.obj", "\"frames/wave_0001.obj");
    let motion = r#"{"garment": "sleeve.obj", "bodies": "body.obj", "pose": "wave.bvh:0:4", "output": "frames"}"#;
    let posed = |more: &str| job("b.obj", &format!(r#", "pose": "bend.json", {more}"#));
    for (jobs, told) in [
        (
            [&good, &job("b.obj", r#", "hide": "jobs.json""#)],
            "its output `jobs.json` is the list of jobs",
        ),
        ([&good, &job("body.obj", "")], "`body.obj` is read by job 1"),
        (
            [&good, &job("b.obj", r#", "hide": "./body.rig.npz""#)],
            "`./body.rig.npz` is read by job 1",
        ),
        (
            [&good, &posed(r#""report": "bend.json""#)],
            "`bend.json` is read by job 2",
        ),
        (
            [&good, &posed(r#""body-out": "a.obj""#)],
            "job 1 has the output `a.obj`, too",
        ),
        (
            [&good, &posed(r#""view": "b.obj""#)],
            "two of its outputs are `b.obj`",
        ),
        (
            [&in_frames, &motion.to_owned()],
            "has the name of one of its frames",
        ),
    ] {
        let text = format!("[{}, {}]", jobs[0], jobs[1]);
        fixture.text("jobs.json", &text);
        let names = fixture.names();
        let told = ["job 2 of `jobs.json` is refused", told];
        refused_with_hint(&fixture, "drape --batch jobs.json", &told);
        assert_eq!(fixture.names(), names, "{text}");
        assert_eq!(fixture.read("jobs.json"), text.as_bytes());
    }
}

#[test]
fn an_outfit_is_a_job_with_a_report_of_its_own() {
    let fixture = Fixture::new();
    fixture.mesh("coat.obj", &tube(0.16, 0.8, 40, 30));
    fixture.text(
        "jobs.json",
        r#"[{"garment": "sleeve.obj", "layer": "coat.obj", "bodies": "bent.obj",
             "rest-body": "body.obj", "output": "worn"}]"#,
    );
    let output = fixture.garnet("drape --batch jobs.json");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let line: Value = serde_json::from_str(stdout(&output).trim()).unwrap();
    assert_eq!(line["report"]["schema"], "garnet.outfit/1", "{line}");
    assert_eq!(line["report"]["layers"].as_array().unwrap().len(), 1);
    assert!(fixture.path("worn/coat.obj").exists());
}
