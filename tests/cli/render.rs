//! What `render` and `info` give.

use crate::fixtures::{Fixture, stderr, stdout};

#[test]
fn a_picture_is_not_named_as_another_kind() {
    let fixture = Fixture::new();
    let output = fixture.garnet("render sleeve.obj -o sleeve.jpg");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("pictures are PNG, animated ones GIF"));
    assert!(!fixture.path("sleeve.jpg").exists());
}

#[test]
fn pictures_are_png_of_the_size_asked_for() {
    let fixture = Fixture::new();
    for options in [
        "",
        "--wireframe --views side,top --zoom 1.5",
        "--color-by distance=body.obj --range -5:30",
        "--color-by displacement=sleeve.obj --up z",
        "--color-by stretch=sleeve.obj --body bent.obj",
        "--color-by problems",
    ] {
        let arguments = format!("render sleeve.obj body.obj -o out.png --size 320x120 {options}");
        let output = fixture.garnet(&arguments);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{arguments}: {}",
            stderr(&output)
        );
        let png = fixture.read("out.png");
        assert!(png.starts_with(b"\x89PNG"), "{arguments}");
        assert_eq!(png[16..24], [0, 0, 1, 64, 0, 0, 0, 120], "{arguments}");
    }
}

#[test]
fn values_that_do_not_fit_are_refused() {
    let fixture = Fixture::new();
    fixture.text("few.txt", "1 2 3");
    fixture.text("words.txt", "1\nx\n");
    for (what, words) in [
        ("file=few.txt", "it has 3 numbers"),
        ("file=words.txt", "line 2: `x` is not a number"),
        ("stretch=body.obj", "`body.obj`"),
        ("distance=no.obj", "`no.obj`"),
        ("problems", "problems are looked for on a body"),
    ] {
        let output = fixture.garnet(&format!("render sleeve.obj -o out.png --color-by {what}"));
        assert_eq!(output.status.code(), Some(2), "{what}");
        assert!(
            stderr(&output).contains(words),
            "{what}: {}",
            stderr(&output)
        );
        assert!(!fixture.path("out.png").exists());
    }
}

#[test]
fn info_tells_each_kind_of_file() {
    let fixture = Fixture::new();
    let output = fixture.garnet("info sleeve.obj body.rig.npz bend.json --json");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let document: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    let kinds: Vec<_> = [0, 1, 2]
        .map(|file| document["files"][file]["kind"].clone())
        .into();
    assert_eq!(kinds, ["mesh", "rig", "pose"]);
    assert_eq!(document["files"][0]["boundary_loops"], 2);
    assert_eq!(document["files"][1]["joints"][1]["parent"], "shoulder");
    assert_eq!(document["files"][2]["joints"][0], "elbow");
}

#[test]
fn info_tells_of_the_files_that_can_be_read() {
    let fixture = Fixture::new();
    let output = fixture.garnet("info sleeve.obj no.obj body.obj neither.obj");
    assert_eq!(output.status.code(), Some(2));
    let (told, failed) = (stdout(&output), stderr(&output));
    assert!(
        told.contains("sleeve.obj") && told.contains("body.obj"),
        "{told}"
    );
    assert!(
        failed.contains("`no.obj`") && failed.contains("`neither.obj`"),
        "{failed}"
    );
}

#[test]
fn options_of_pictures_that_do_nothing_are_refused() {
    let fixture = Fixture::new();
    for options in ["--range 0:1", "--fps 3"] {
        let output = fixture.garnet(&format!("render sleeve.obj -o no.png {options}"));
        assert_eq!(output.status.code(), Some(2), "{options}");
        assert!(
            stderr(&output).contains("does nothing"),
            "{}",
            stderr(&output)
        );
    }
}

#[test]
fn a_drape_in_a_glb_is_a_garment_on_its_body() {
    let fixture = Fixture::new();
    let drape = "drape sleeve.obj bent.obj --rig body.rig.npz -o worn.glb -q";
    for drape in [
        drape,
        "drape sleeve.obj more.obj --rig body.rig.npz -o other.glb -q",
    ] {
        let output = fixture.garnet(drape);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    // Problems are looked for on a body.
    for colored in [
        "render worn.glb -o worn.png --size 300x100",
        "view worn.glb -o worn.html",
    ] {
        // Of other drapes the garment is compared, and the body is the skin.
        for by in [
            "problems",
            "displacement=other.glb",
            "stretch=other.glb",
            "distance=other.glb",
        ] {
            let output = fixture.garnet(&format!("{colored} --color-by {by}"));
            assert_eq!(output.status.code(), Some(0), "{by}: {}", stderr(&output));
        }
    }
}

#[test]
fn frames_are_a_sheet_or_an_animation() {
    let fixture = Fixture::new();
    for (frame, height) in [(0, 0.0), (1, 0.1), (2, 0.2)] {
        let lifted = |place: &garnet::Point3| place + garnet::Vector3::new(0.0, height, 0.0);
        std::fs::create_dir_all(fixture.path("frames")).unwrap();
        fixture.moved("sleeve.obj", &format!("frames/{frame}.obj"), lifted);
    }
    let drawn = |arguments: &str| {
        let output = fixture.garnet(arguments);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{arguments}: {text}");
        text
    };
    let text = drawn("render frames body.obj -o walk.gif --size 90x120");
    assert!(text.contains("3 of 3 frames"), "{text}");
    let gif = fixture.read("walk.gif");
    assert!(gif.starts_with(b"GIF89a\x5a\x00\x78\x00"));
    // A graphic control of 0.04 s before each frame.
    let controls = gif
        .windows(6)
        .filter(|bytes| bytes[..3] == *b"\x21\xf9\x04" && bytes[4] == 4);
    assert_eq!(controls.count(), 3);
    let text = drawn("render frames body.obj -o sheet.png");
    assert!(text.contains("900 x 400 pixels, 3 of 3 frames"), "{text}");

    let refused = |arguments: &str, words: &str| {
        let output = fixture.garnet(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
    };
    refused(
        "render sleeve.obj -o still.gif",
        "the meshes have one frame",
    );
    refused(
        "render frames body.obj -o walk.gif --color-by problems",
        "`--color-by` is for one frame",
    );
    assert!(!fixture.path("still.gif").exists());
}

#[test]
fn an_obj_is_drawn_with_the_pictures_of_its_materials() {
    let fixture = Fixture::new();
    let draw = |file: &str| {
        let output = fixture.garnet(&format!("render {file} -o {file}.png --size 300x100"));
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        (fixture.read(&format!("{file}.png")), stderr(&output))
    };
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    let faces = "usemtl silk\nf 1/1 2/2 3/3 4/4\n";
    fixture.text("plain.obj", &format!("{square}{faces}"));
    let (plain, told) = draw("plain.obj");
    assert!(!told.contains("note"), "{told}");
    fixture.text("silk.obj", &format!("mtllib silk.mtl\n{square}{faces}"));
    // A material without a picture, one that is not there, and the picture that was just drawn.
    for (library, is_plain, note) in [
        ("newmtl silk\nKd 0.1 0.9 0.1\n", true, None),
        ("newmtl silk\nmap_Kd no.png\n", true, Some("names `no.png`")),
        (
            "newmtl silk\nmap_Kd plain.obj\n",
            true,
            Some("names `plain.obj`"),
        ),
        ("newmtl silk\nKd 0 0 0\nmap_Kd plain.obj.png\n", false, None),
    ] {
        fixture.text("silk.mtl", library);
        let (drawn, told) = draw("silk.obj");
        assert_eq!(drawn == plain, is_plain, "{library}");
        assert_eq!(told.contains("note"), note.is_some(), "{library}: {told}");
        assert!(told.contains(note.unwrap_or_default()), "{library}: {told}");
    }
}
