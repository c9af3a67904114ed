//! Pages that show meshes in a browser.
//!
//! That the numbers of a page are those of the meshes is held by the tests of `garnet-view`, what a
//! browser makes of it by `benches/python/check_page.py`.

use std::{fs, path::Path};

use serde_json::{Value, json};

use crate::fixtures::{Fixture, refused_with_hint, stderr};
use crate::glb;
use crate::train::done;

/// What a page must stay below, in bytes: a T-shirt on its body.
const LARGEST: usize = 2_000_000;

/// What a page says of its numbers.
fn described(html: &str) -> Value {
    let (_, scene) = html.split_once("id=\"scene\">").unwrap();
    serde_json::from_str(scene.split_once("</script>").unwrap().0).unwrap()
}

/// The text of a page that asks for nothing else.
fn page(fixture: &Fixture, name: &str) -> String {
    let html = String::from_utf8(fixture.read(name)).unwrap();
    check_alone(&html);
    html
}

fn check_alone(html: &str) {
    assert!(html.starts_with("<!DOCTYPE html>") && html.ends_with("</html>\n"));
    for word in ["http:", "https:", "src=", "@import", "url("] {
        assert!(!html.contains(word), "`{word}`");
    }
    assert_eq!(
        html.matches("href=").count(),
        html.matches("href=\"data:,\"").count()
    );
}

fn texts<'a>(list: &'a Value, field: &str) -> Vec<&'a str> {
    let list = list.as_array().unwrap();
    list.iter()
        .map(|entry| entry[field].as_str().unwrap())
        .collect()
}

/// The sleeve on the bent body in two ways.
const BENT: &str = "drape sleeve.obj bent.obj --rig body.rig.npz -q";

/// The sleeve on three bodies.
const THREE: &str = "drape sleeve.obj bent.obj more.obj most.obj --rig body.rig.npz -q";

/// A folder `bodies` with the three bodies.
fn make_bodies(fixture: &Fixture) {
    fs::create_dir(fixture.path("bodies")).unwrap();
    for name in ["bent.obj", "more.obj", "most.obj"] {
        fixture.bytes(&format!("bodies/{name}"), &fixture.read(name));
    }
}

#[test]
fn garments_stand_side_by_side_on_one_body() {
    let fixture = Fixture::new();
    done(&fixture, &format!("{BENT} -o warp.obj"));
    done(
        &fixture,
        &format!("{BENT} -o dqs.obj --method dqs --no-untangle"),
    );
    let report = done(
        &fixture,
        "view warp.obj dqs.obj bent.obj -o page.html --json --color-by stretch=sleeve.obj --color-by \
         displacement=dqs.obj",
    );
    let report: Value = serde_json::from_str(&report).unwrap();
    let html = page(&fixture, "page.html");
    assert_eq!(report["schema"], "garnet.view/1");
    assert_eq!(report["bytes"], html.len());
    let scene = described(&html);
    assert_eq!(scene["title"], "warp, dqs on bent");
    assert_eq!(texts(&scene["panes"], "name"), ["warp", "dqs"]);
    assert_eq!(scene["panes"][1]["meshes"], json!([1, 2]));
    assert_eq!(
        texts(&scene["meshes"], "part"),
        ["garment", "garment", "body"]
    );
    assert_eq!(
        scene["topologies"].as_array().unwrap().len(),
        2,
        "one for both garments"
    );
    let labels = [
        "to the skin (mm)",
        "problems",
        "stretch (%)",
        "displacement (mm)",
    ];
    assert_eq!(texts(&scene["colorings"], "label"), labels);
    // To itself there is none.
    assert_eq!(scene["colorings"][3]["low"], 0.0);
    assert!(scene["colorings"][3]["high"].as_f64().unwrap() > 0.1);
    assert_eq!(scene["frames"], json!([""]));
    let values = scene["meshes"][1]["values"].as_array().unwrap();
    assert_eq!(values.len(), 4);
    assert_eq!(scene["meshes"][2]["values"], json!([]));
}

#[test]
fn names_titles_and_bodies_are_those_asked_for() {
    let fixture = Fixture::new();
    done(
        &fixture,
        "view sleeve.obj sleeve.obj --body body.obj --body bent.obj --names straight,</script> -o \
         page.htm --title <T> --color-by none -q",
    );
    let html = page(&fixture, "page.htm");
    let scene = described(&html);
    assert_eq!(scene["title"], "<T>");
    assert!(html.contains("<title>&lt;T&gt;</title>"));
    assert_eq!(texts(&scene["panes"], "name"), ["straight", "</script>"]);
    assert_eq!(scene["panes"][1]["meshes"], json!([1, 3]));
    assert_eq!(scene["colorings"], json!([]));
    done(&fixture, "view body.obj -o one.html -q");
    let scene = described(&page(&fixture, "one.html"));
    assert_eq!(texts(&scene["meshes"], "part"), ["garment"]);
}

#[test]
fn folders_and_archives_of_frames_play() {
    let fixture = Fixture::new();
    make_bodies(&fixture);
    done(&fixture, &format!("{THREE} -o walk"));
    done(&fixture, &format!("{THREE} -o walk.npz"));
    done(&fixture, "view walk bodies -o folder.html -q");
    let folder = described(&page(&fixture, "folder.html"));
    assert_eq!(folder["frames"], json!(["bent", "more", "most"]));
    for mesh in [0, 1] {
        assert_eq!(
            folder["meshes"][mesh]["origins"].as_array().unwrap().len(),
            3
        );
    }
    assert_eq!(folder["meshes"][0]["values"][0]["frames"], 3);
    done(&fixture, "view walk.npz bodies -o archive.html --fps 12 -q");
    let archive = described(&page(&fixture, "archive.html"));
    assert_eq!(archive["fps"], 12.0);
    assert_eq!(
        archive["meshes"][0]["origins"],
        folder["meshes"][0]["origins"]
    );
    // A body that keeps still is in all frames.
    done(&fixture, "view walk.npz bent.obj -o still.html -q");
    let still = described(&page(&fixture, "still.html"));
    assert_eq!(still["meshes"][1]["origins"].as_array().unwrap().len(), 1);
    assert_eq!(still["meshes"][0]["values"][0]["frames"], 3);
}

#[test]
fn drape_shows_what_it_writes() {
    let fixture = Fixture::new();
    make_bodies(&fixture);
    done(&fixture, &format!("{THREE} -o walk --view draped.html"));
    done(&fixture, "view walk bodies -o written.html -q");
    let [draped, written] =
        ["draped.html", "written.html"].map(|name| described(&page(&fixture, name)));
    assert_eq!(draped["frames"], json!(["bent", "more", "most"]));
    assert_eq!(
        texts(&draped["colorings"], "label"),
        ["stretch (%)", "to the skin (mm)", "problems"]
    );
    for mesh in [0, 1] {
        for frame in 0..3 {
            for axis in 0..3 {
                let [a, b] = [&draped, &written].map(|scene| {
                    scene["meshes"][mesh]["origins"][frame][axis]
                        .as_f64()
                        .unwrap()
                });
                assert!((a - b).abs() < 1e-5, "{a} {b}");
            }
        }
    }
    done(&fixture, &format!("{BENT} -o one.glb --view one.html"));
    assert_eq!(
        described(&page(&fixture, "one.html"))["frames"],
        json!([""])
    );
}

#[test]
fn pages_of_other_kinds_and_over_other_files_are_refused() {
    let fixture = Fixture::new();
    for (arguments, words) in [
        (
            "view sleeve.obj body.obj -o page.png",
            "pages are HTML, not png",
        ),
        (
            "view sleeve.obj body.obj -o no/page.html",
            "output folder `no` does not exist",
        ),
        (
            "drape sleeve.obj body.obj --pose bend.json -o out.obj --view page.obj",
            "pages are HTML",
        ),
        (
            "drape sleeve.obj body.obj --pose bend.json -o out.obj --report x --view x",
            "two outputs have this name",
        ),
        (
            "view sleeve.obj no.obj -o page.html",
            "cannot read `no.obj`",
        ),
        (
            "view sleeve.obj --body body.obj --body bent.obj -o page.html",
            "1 garments and 2 bodies",
        ),
        (
            "view sleeve.obj body.obj --names a,b -o page.html",
            "2 names and 1 garments",
        ),
        (
            "view sleeve.obj body.obj --color-by stretch=body.obj -o page.html",
            "cannot be compared",
        ),
    ] {
        refused_with_hint(&fixture, arguments, &[words]);
    }
    let output = fixture.garnet("view sleeve.obj -o page.html --fps 0");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("frames a second from 0.001 to 1000"));
}

#[test]
fn frames_that_do_not_go_together_are_refused() {
    let fixture = Fixture::new();
    make_bodies(&fixture);
    fs::create_dir(fixture.path("empty")).unwrap();
    fs::create_dir(fixture.path("mixed")).unwrap();
    fs::create_dir(fixture.path("two")).unwrap();
    for (copy, name) in [
        ("mixed/a", "body"),
        ("mixed/b", "sleeve"),
        ("two/a", "sleeve"),
        ("two/b", "sleeve"),
    ] {
        fixture.bytes(
            &format!("{copy}.obj"),
            &fixture.read(&format!("{name}.obj")),
        );
    }
    for (meshes, words) in [
        ("sleeve.obj empty", "it has no OBJ"),
        (
            "mixed",
            "`mixed/a.obj` and `mixed/b.obj` are not the same mesh",
        ),
        ("two bodies", "`two` has 2 frames, `bodies` has 3"),
    ] {
        refused_with_hint(&fixture, &format!("view {meshes} -o page.html"), &[words]);
    }
}

#[test]
fn a_t_shirt_on_its_body_is_a_small_page() {
    let fixture = Fixture::new();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let shown = models.display();
    done(
        &fixture,
        &format!(
            "drape {shown}/tshirt {shown}/demo/reach.obj --method fast -o draped.obj --view page.html -q"
        ),
    );
    let drawn = page(&fixture, "page.html");
    assert!(drawn.len() < LARGEST / 4, "{} bytes", drawn.len());
    assert_eq!(described(&drawn)["title"], "tshirt");
    let vertices = |scene: &Value| scene["meshes"][0]["vertices"].as_u64();
    assert_eq!(vertices(&described(&drawn)), Some(4_975));
    // And that of the repository.
    let shipped = fs::read_to_string(models.join("../docs/pictures/methods.html")).unwrap();
    check_alone(&shipped);
    assert!(shipped.len() < LARGEST, "{} bytes", shipped.len());
    assert_eq!(vertices(&described(&shipped)), Some(4_975));
}

#[test]
fn what_is_left_out_of_a_glb_is_told_by_pictures_and_pages() {
    let fixture = Fixture::new();
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let binary = glb::floats(corners.into_iter().flatten());
    let primitive = |mode: u32| json!({"attributes": {"POSITION": 0}, "mode": mode});
    let scene = json!({
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0, "name": "Cloth"}, {"mesh": 1, "name": "Guides"}],
        "meshes": [{"primitives": [primitive(4)]}, {"primitives": [primitive(1)]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": binary.len()}],
        "buffers": [{"byteLength": binary.len()}],
    });
    fixture.bytes("mesh.glb", &glb::container(&scene, &binary));
    let note = "of `mesh.glb` the mesh is `Cloth`; left out: `Guides` (points or lines)";
    for output in ["page.html", "picture.png"] {
        let command = if output == "page.html" {
            "view"
        } else {
            "render"
        };
        let written = fixture.garnet(&format!("{command} mesh.glb -o {output} --json"));
        let told = stderr(&written);
        assert_eq!(written.status.code(), Some(0), "{told}");
        let report: Value = serde_json::from_slice(&written.stdout).unwrap();
        assert_eq!(report["notes"], json!([note]));
        let written = fixture.garnet(&format!("{command} mesh.glb -o {output}"));
        let told = stderr(&written);
        assert!(told.contains(&format!("note: {note}")), "{told}");
    }
}
