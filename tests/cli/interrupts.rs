//! Commands that are stopped: each says what is left of it, and ends with 130.

use std::process::Output;

use crate::fixtures::{Fixture, stderr, stdout};
use crate::train::done;

fn told(output: &Output) -> String {
    let text = stderr(output);
    assert_eq!(output.status.code(), Some(130), "{text}");
    text
}

#[test]
fn a_batch_ends_after_the_job_that_it_is_at() {
    let fixture = Fixture::new();
    let job = |number: usize| {
        format!(
            r#"{{"garment": "sleeve.obj", "bodies": "bent.obj", "rest-body": "body.obj", "output": "{number}.obj"}}"#
        )
    };
    let jobs: Vec<String> = (0..3000).map(job).collect();
    fixture.text("jobs.jsonl", &jobs.join("\n"));
    let first = fixture.path("0.obj");
    let output = fixture.interrupted("drape --batch jobs.jsonl", || first.exists());
    let text = told(&output);
    let count = stdout(&output).lines().count();
    assert!((1..3000).contains(&count), "{count}");
    let expected = format!("interrupted: {count} of 3000 jobs are done");
    assert!(text.contains(&expected), "{text}");
    // No drape without its line.
    assert!(fixture.path(&format!("{}.obj", count - 1)).exists());
    assert!(!fixture.path(&format!("{count}.obj")).exists());
}

#[test]
fn a_data_set_says_how_it_goes_on() {
    let fixture = Fixture::new();
    done(&fixture, "garment tshirt --vertices 600 -o tee -q");
    let arguments = "dataset tee -o out --bodies 40/0/0 --poses 8 --quality fast";
    let begun = fixture.path("out/dataset.json");
    let output = fixture.interrupted(arguments, || begun.exists());
    let text = told(&output);
    let expected = "interrupted: `out` keeps the scenes that are there: the same command goes on";
    assert!(text.contains(expected), "{text}");
}
