//! Names that are mistyped are asked about.

use crate::fixtures::{Fixture, refused, stderr};
use crate::train::done;

#[test]
fn names_that_there_are_not_are_asked_about() {
    let fixture = Fixture::new();
    done(&fixture, "garment tshirt --vertices 600 -o tee -q");
    let drape = "drape sleeve.obj bent.obj --rest-body body.obj -o out.obj";
    for (arguments, told) in [
        ("stress -o out --axis jionts", "did you mean `joints`?"),
        (
            "stress -o out --method simulatr",
            "did you mean `simulator`?",
        ),
        ("body --pose waev -o out.obj", "did you mean `wave`?"),
        (
            &format!("{drape} --settle 2 --fabric cottn"),
            "did you mean `cotton`?",
        ),
        (
            "render body.obj -o out.png --color-by strech=body.obj",
            "did you mean `stretch`?",
        ),
        (
            "view body.obj -o out.html --color-by problem",
            "did you mean `problems`?",
        ),
        (
            "dataset tee -o out --bodies 1/0/0 --vary sleve=18:34",
            "did you mean `sleeve`?",
        ),
        (
            "train tee out --preset smal",
            "did you mean `small`? `garnet train --help`",
        ),
        ("garment tshirt -o out --size axl", "did you mean `xl`?"),
        // What clap finds by itself.
        ("drap", "'drape'"),
        ("garment tshrt -o out", "'tshirt'"),
        ("garment tshirt -o out --sleev 20", "'--sleeve'"),
        ("body --statur 170 -o out.obj", "'--stature'"),
        (
            "simulate sleeve.obj bent.obj --rest-body body.obj -o out.obj --quality fsat",
            "'fast'",
        ),
    ] {
        refused(&fixture, arguments, &[told]);
        assert!(!fixture.path("out").exists(), "{arguments}");
    }
    // Programs are told, too.
    let output = fixture.garnet("drap --json");
    let error: serde_json::Value = serde_json::from_str(&stderr(&output)).unwrap();
    let hint = error["hint"].as_str().unwrap();
    assert!(hint.contains("'drape'"), "{hint}");
}
