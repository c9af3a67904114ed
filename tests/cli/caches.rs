//! Drapes in files that programs play, and many drapes at once.

use std::{fs, path::Path};

use garnet::{
    Point3,
    io::{NpzFile, ObjFile, read_mesh_frames},
};
use serde_json::Value;

use crate::fixtures::{Fixture, refused_with_hint, stderr, stdout};
use crate::train::done;

/// Frames in which the elbow bends.
fn bending(fixture: &Fixture, count: usize) {
    let frame = |number: usize| {
        let half = 0.6 * number as f32 / count as f32;
        let (sine, cosine) = half.sin_cos();
        format!(r#"{{"joints": {{"elbow": [{sine}, 0, 0, {cosine}]}}}}"#)
    };
    let frames: Vec<String> = (0..count).map(frame).collect();
    let text = format!(
        r#"{{"schema": "garnet.pose/1", "frames": [{}]}}"#,
        frames.join(",")
    );
    fixture.text("bending.json", &text);
}

const MOTION: &str = "drape sleeve.obj body.obj --pose bending.json:0:7";

/// The points of a PC2.
fn points(bytes: &[u8]) -> Vec<Point3> {
    let (words, _) = bytes[32..].as_chunks::<4>();
    let floats: Vec<f32> = words.iter().copied().map(f32::from_le_bytes).collect();
    let (points, rest) = floats.as_chunks::<3>();
    assert!(rest.is_empty());
    points.iter().copied().map(Point3::from).collect()
}

#[test]
fn a_glb_is_played_again() {
    let fixture = Fixture::new();
    bending(&fixture, 7);
    done(&fixture, &format!("{MOTION} -o out -q"));
    let told = stderr(&fixture.garnet(&format!("{MOTION} -o out.glb")));
    let note = "the motion does not say how many frames it has a second: 30 are taken";
    assert!(told.contains(note), "{told}");
    let frames = read_mesh_frames(fixture.path("out.glb")).unwrap().unwrap();
    assert!(frames.fps.unwrap() > 1.0);
    assert_eq!(frames.positions.len(), 7);
    for (number, found) in frames.positions.iter().enumerate() {
        // The body comes after the garment, whose vertices may be split and in another order.
        let path = fixture.path(&format!("out/bending_{number:04}.obj"));
        let garment = ObjFile::read(path).unwrap();
        for vertex in garment.positions() {
            let nearest = found.iter().map(|other| (other - vertex).norm());
            let nearest = nearest.min_by(f32::total_cmp).unwrap();
            assert!(nearest < 1e-5, "frame {number}: {nearest}");
        }
    }
    let output = fixture.garnet("render out.glb -o out.gif --size 90x120");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let told = stderr(&output);
    assert!(
        told.contains("7 of 7 frames") && !told.contains("note"),
        "{told}"
    );
    let output = fixture.garnet("view out.glb -o out.html");
    let told = stderr(&output);
    assert!(told.contains("2 meshes, 7 frames"), "{told}");
}

#[test]
fn a_cache_has_the_frames_of_a_folder() {
    let fixture = Fixture::new();
    bending(&fixture, 7);
    done(&fixture, &format!("{MOTION} -o out --body-out bodies -q"));
    done(
        &fixture,
        &format!("{MOTION} -o out.pc2 --body-out bodies.pc2 -q"),
    );
    done(&fixture, &format!("{MOTION} -o out.npz -q"));
    for (cache, folder) in [("out.pc2", "out"), ("bodies.pc2", "bodies")] {
        let found = points(&fixture.read(cache));
        let of_frame = |number: usize| {
            let path = fixture.path(&format!("{folder}/bending_{number:04}.obj"));
            ObjFile::read(path).unwrap().positions().to_vec()
        };
        let expected: Vec<Point3> = (0..7).flat_map(of_frame).collect();
        assert_eq!(found, expected, "{cache}");
    }
    let mut npz = NpzFile::open(fixture.path("out.npz")).unwrap();
    let vertices = npz.array("vertices").unwrap().unwrap();
    let sleeve = ObjFile::read(fixture.path("sleeve.obj")).unwrap();
    assert_eq!(vertices.shape, [7, sleeve.num_vertices(), 3]);
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let fixture = Fixture::new();
    bending(&fixture, 7);
    for kind in ["pc2", "glb", "npz"] {
        let one = format!("{MOTION} -o one.{kind} --threads 1 -q");
        let three = format!("{MOTION} -o three.{kind} --threads 3 -q");
        done(&fixture, &one);
        done(&fixture, &three);
        let same = fixture.read(&format!("one.{kind}")) == fixture.read(&format!("three.{kind}"));
        assert!(same, "{kind}");
    }
    let bodies = "drape sleeve.obj body.obj bent.obj more.obj most.obj --rig body.rig.npz";
    done(&fixture, &format!("{bodies} -o alone --threads 1 -q"));
    done(&fixture, &format!("{bodies} -o beside --threads 3 -q"));
    for name in ["body.obj", "bent.obj", "more.obj", "most.obj"] {
        assert!(fixture.read(&format!("alone/{name}")) == fixture.read(&format!("beside/{name}")));
    }
}

#[test]
fn a_smooth_motion_has_all_frames_in_every_form_and_part() {
    let fixture = Fixture::new();
    bending(&fixture, 7);
    done(&fixture, &format!("{MOTION} -o rough.pc2 -q"));
    for threads in [1, 3] {
        let smooth = format!("{MOTION} -o {threads}.pc2 --smooth=2 -q --threads {threads}");
        done(&fixture, &smooth);
    }
    let smooth = fixture.read("1.pc2");
    assert!(smooth == fixture.read("3.pc2"));
    assert!(smooth != fixture.read("rough.pc2"));
    let smooth = points(&smooth);
    let frames: Vec<&[Point3]> = smooth.chunks_exact(smooth.len() / 7).collect();
    done(
        &fixture,
        &format!("{MOTION} -o out --body-out bodies --smooth 2 --report out.json -q"),
    );
    for part in 1..=3 {
        let part = format!("{MOTION} -o parts --smooth 2 -q --shard {part}/3");
        done(&fixture, &part);
    }
    let report: Value = serde_json::from_slice(&fixture.read("out.json")).unwrap();
    let steps = &report["drapes"];
    for (number, points) in frames.iter().enumerate() {
        let path = format!("out/bending_{number:04}.obj");
        let file = ObjFile::read(fixture.path(&path)).unwrap();
        assert_eq!(file.positions(), *points);
        let part = format!("parts/bending_{number:04}.obj");
        assert!(fixture.read(&path) == fixture.read(&part), "{part}");
        assert!(
            fixture
                .path(&format!("bodies/bending_{number:04}.obj"))
                .exists()
        );
        let told = steps[number]["steps"]["cloth_m"].as_f64().unwrap();
        let from = frames[number.saturating_sub(1)];
        let pairs = from.iter().zip(*points);
        let step = pairs.map(|(a, b)| (b - a).norm()).fold(0.0, f32::max);
        assert!((told - f64::from(step)).abs() < 1e-5, "{told} {step}");
    }
    let alone = "drape sleeve.obj body.obj --pose bend.json -o one.obj --smooth";
    refused_with_hint(
        &fixture,
        alone,
        &["`--smooth` is for the frames of a motion", "FILE:FIRST:END"],
    );
    let bodies = "drape sleeve.obj body.obj bent.obj --rig body.rig.npz -o out2 --smooth";
    refused_with_hint(&fixture, bodies, &["no range of frames is draped"]);
    let both = format!("{MOTION} -o out3 --smooth 2 --frames-alone");
    assert_eq!(fixture.garnet(&both).status.code(), Some(2));
}

#[test]
fn the_report_tells_frames_of_a_cache_and_the_rate() {
    let fixture = Fixture::new();
    bending(&fixture, 7);
    done(
        &fixture,
        &format!("{MOTION} -o out.pc2 --report out.json -q --threads 2"),
    );
    let report: Value = serde_json::from_slice(&fixture.read("out.json")).unwrap();
    assert_eq!(report["drapes"][3]["output"], "out.pc2:3");
    assert_eq!(report["threads_a_drape"], 1);
    let rate = report["drapes_per_second"].as_f64().unwrap();
    let seconds = report["seconds"]["drape"].as_f64().unwrap();
    assert!((rate * seconds - 7.0).abs() < 1e-6);
}

#[test]
fn one_drape_is_a_glb_with_the_body() {
    let fixture = Fixture::new();
    done(
        &fixture,
        "drape sleeve.obj body.obj --pose bend.json -o one.glb -q",
    );
    let bytes = fixture.read("one.glb");
    assert!(bytes.starts_with(b"glTF"));
    let length = u32::from_le_bytes([bytes[12], bytes[13], bytes[14], bytes[15]]) as usize;
    let json: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let names: Vec<&str> = (json["nodes"].as_array().unwrap().iter())
        .map(|node| node["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["sleeve", "body"]);
    assert!(json.get("animations").is_none());
}

#[test]
fn names_that_are_no_files_of_frames_are_refused() {
    let fixture = Fixture::new();
    bending(&fixture, 7);
    for name in ["walk.usd", "walk.fbx", "walk.abc"] {
        let expected = [
            "the name of a file",
            "a file of all frames that ends with .pc2, .mdd, .npz or .glb",
        ];
        refused_with_hint(&fixture, &format!("{MOTION} -o {name}"), &expected);
    }
    let twice = format!("{MOTION} -o out.pc2 --body-out out.pc2");
    refused_with_hint(&fixture, &twice, &["two outputs have this name"]);
    let missing = format!("{MOTION} -o missing/out.pc2");
    refused_with_hint(
        &fixture,
        &missing,
        &["output folder `missing` does not exist"],
    );
}

#[test]
fn parts_are_the_frames_and_bodies_of_the_whole() {
    let fixture = Fixture::new();
    bending(&fixture, 7);
    done(&fixture, &format!("{MOTION} -o whole -q"));
    for part in 1..=3 {
        done(&fixture, &format!("{MOTION} -o parts --shard {part}/3 -q"));
    }
    // Slow enough that no frame waits for cloth.
    for number in 0..7 {
        let name = format!("bending_{number:04}.obj");
        let [whole, part] =
            ["whole", "parts"].map(|folder| fixture.read(&format!("{folder}/{name}")));
        assert!(whole == part, "{name}");
    }
    let bodies = "drape sleeve.obj body.obj bent.obj more.obj --rig body.rig.npz";
    done(&fixture, &format!("{bodies} -o one --shard 2/2 -q"));
    let names = fs::read_dir(fixture.path("one")).unwrap();
    let mut names: Vec<_> = names.map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["bent.obj", "more.obj"]);
    let too_many = format!("{MOTION} -o parts --shard 1/8");
    refused_with_hint(
        &fixture,
        &too_many,
        &["no drape for each part", "there are 7 drapes"],
    );
    let alone = "drape sleeve.obj body.obj --pose bend.json -o one.obj --shard 1/2";
    refused_with_hint(&fixture, alone, &["`--shard` is for several drapes"]);
}

#[test]
fn covered_faces_are_written_as_json_and_text() {
    let fixture = Fixture::new();
    bending(&fixture, 7);
    done(
        &fixture,
        &format!("{MOTION} -o out.pc2 --hide hide.json -q"),
    );
    done(&fixture, &format!("{MOTION} -o out.pc2 --hide hide.txt -q"));
    let report: Value = serde_json::from_slice(&fixture.read("hide.json")).unwrap();
    assert_eq!(report["schema"], "garnet.hide/1");
    assert_eq!(report["drapes"], 7);
    let body = ObjFile::read(fixture.path("body.obj")).unwrap();
    assert_eq!(report["faces"], body.num_polygons());
    let hidden: Vec<usize> = serde_json::from_value(report["hidden"].clone()).unwrap();
    let text = String::from_utf8(fixture.read("hide.txt")).unwrap();
    let told: Vec<usize> = text.lines().map(|line| line.parse().unwrap()).collect();
    assert_eq!(hidden, told);
    assert!(!hidden.is_empty() && hidden.len() < body.num_polygons() / 2);
    // The sleeve goes from -0.4 to 0.4, and is 0.03 away from the skin.
    for face in hidden {
        let ends = body
            .polygon(face)
            .iter()
            .map(|&vertex| body.positions()[vertex as usize].y);
        assert!(ends.map(f32::abs).fold(0.0, f32::max) < 0.33);
    }
    let expected = ["covered faces are written as JSON or text", ".json or .txt"];
    refused_with_hint(
        &fixture,
        &format!("{MOTION} -o out.pc2 --hide hide.csv"),
        &expected,
    );
}

const FOLLOW: &str = "simulate sleeve.obj body.obj --pose bending.json:0:20 --quality fast";

#[test]
fn a_motion_is_simulated_as_one_and_goes_on_after_a_stop() {
    let fixture = Fixture::new();
    bending(&fixture, 20);
    done(
        &fixture,
        &format!("{FOLLOW} -o whole.pc2 --report whole.json -q"),
    );
    assert!(!fixture.path("whole.pc2.part").exists());
    let whole = points(&fixture.read("whole.pc2"));
    let sleeve = ObjFile::read(fixture.path("sleeve.obj")).unwrap();
    assert_eq!(whole.len(), 20 * sleeve.num_vertices());
    let report: Value = serde_json::from_slice(&fixture.read("whole.json")).unwrap();
    let drapes = report["drapes"].as_array().unwrap();
    assert_eq!(drapes.len(), 20);
    for (number, drape) in drapes.iter().enumerate() {
        // It goes along with the arm, and falls off it no faster than things fall.
        let fallen = 9.81 * (number as f64 / 30.0) / 30.0;
        let [cloth, body] = ["cloth_m", "body_m"].map(|key| drape["steps"][key].as_f64().unwrap());
        assert!(
            cloth < 1.5 * body + fallen + 0.01,
            "{number}: {cloth} {body}"
        );
        assert_eq!(drape["penetration"]["inside"], 0);
    }
    assert!(drapes[5]["steps"]["cloth_m"].as_f64().unwrap() > 0.02);
    // With what a stop has left: the frames of the first stretch, and a part of the next.
    let state = fixture.path("parts.pc2.part/state.json");
    let output = fixture.interrupted(&format!("{FOLLOW} -o parts.pc2"), || state.exists());
    if output.status.code() != Some(0) {
        assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
        assert!(
            stderr(&output).contains("`--resume` goes on"),
            "{}",
            stderr(&output)
        );
        assert!(!fixture.path("parts.pc2").exists());
        done(&fixture, &format!("{FOLLOW} -o parts.pc2 --resume -q"));
    }
    assert!(fixture.read("parts.pc2") == fixture.read("whole.pc2"));
    assert!(!fixture.path("parts.pc2.part").exists());
}

#[test]
fn what_was_begun_otherwise_is_not_gone_on_with() {
    let fixture = Fixture::new();
    bending(&fixture, 20);
    fs::create_dir(fixture.path("out.part")).unwrap();
    let state = r#"{"schema": "garnet.following/1", "fingerprint": 1, "num_done": 3,
        "positions": [], "velocities": [], "faces": []}"#;
    fixture.text("out.part/state.json", state);
    fixture.text("out.part/frames.f32", "");
    let expected = [
        "cannot go on with `out.part`",
        "begun with other files",
        "without `--resume`",
    ];
    refused_with_hint(&fixture, &format!("{FOLLOW} -o out --resume"), &expected);
    let alone = "simulate sleeve.obj bent.obj --rig body.rig.npz -o out.obj --resume";
    refused_with_hint(
        &fixture,
        alone,
        &["`--resume` is for simulations along a motion"],
    );
    let way = format!("{FOLLOW} -o out --frames way");
    refused_with_hint(&fixture, &way, &["`--frames` writes the way to one pose"]);
}

/// A stop takes away what was begun.
#[cfg(unix)]
#[test]
fn an_interrupted_cache_leaves_nothing() {
    let fixture = Fixture::new();
    bending(&fixture, 3000);
    fixture.text("out.pc2", "old");
    let before = fixture.names();
    let arguments = "drape sleeve.obj body.obj --pose bending.json:0: -o out.pc2";
    // Until frames are being written.
    let has_begun = || {
        let names = fixture.names();
        names.iter().any(|name| name.starts_with(".garnet-"))
    };
    let output = fixture.interrupted(arguments, has_begun);
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(stderr(&output).contains("interrupted: `out.pc2` is as it was before"));
    assert_eq!(fixture.names(), before);
    assert_eq!(fixture.read("out.pc2"), b"old");
}

#[test]
fn a_network_drapes_key_frames_and_other_frames_lie_between() {
    let fixture = Fixture::new();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let (shirt, walk) = (models.join("tshirt"), models.join("demo/walk.bvh"));
    let (shirt, walk) = (shirt.display(), walk.display());
    let motion = format!("drape {shirt} --pose {walk}:0s:0.3s --fps 120 --method fast");
    let report = |name: &str| -> Value { serde_json::from_slice(&fixture.read(name)).unwrap() };
    let between = |report: &Value| -> Vec<usize> {
        let drapes = report["drapes"].as_array().unwrap().iter();
        let is_between = |drape: &Value| drape["steps"]["is_between"].as_bool().unwrap();
        let found = drapes.enumerate().filter(|(_, drape)| is_between(drape));
        found.map(|(number, _)| number).collect()
    };
    let one = fixture.garnet(&format!(
        "{motion} -o one.pc2 --report one.json --threads 1"
    ));
    let told = stderr(&one) + &stdout(&one);
    let found = report("one.json");
    let numbers = between(&found);
    let count = found["drapes"].as_array().unwrap().len();
    let expected = format!(
        "; {} frames draped by themselves, {} between them",
        count - numbers.len(),
        numbers.len()
    );
    assert!(told.contains(&expected), "{expected}: {told}");
    assert!(numbers.len() > count / 3, "{numbers:?} of {count}");
    assert!(
        numbers
            .iter()
            .all(|number| number % 12 != 0 && number + 1 != count)
    );
    for drape in found["drapes"].as_array().unwrap() {
        assert_eq!(drape["untangle"]["inside"], 0);
    }
    done(&fixture, &format!("{motion} -o two.pc2 --threads 2 -q"));
    assert!(fixture.read("one.pc2") == fixture.read("two.pc2"));
    let each = "-o each.pc2 --report each.json --key-spacing 0 -q";
    done(&fixture, &format!("{motion} {each}"));
    assert!(between(&report("each.json")).is_empty());
    let [one, each] = ["one.pc2", "each.pc2"].map(|name| points(&fixture.read(name)));
    let apart = one.iter().zip(&each).map(|(a, b)| (a - b).norm());
    let apart = apart.sum::<f32>() / one.len() as f32;
    assert!(apart > 0.0 && apart < 0.002, "{apart}");
    let both = format!("{motion} -o both --key-spacing 5 --frames-alone");
    assert_eq!(fixture.garnet(&both).status.code(), Some(2));
    // Parts have the keys of the whole.
    for part in 1..=2 {
        let part = format!("-o parts --shard {part}/2 --report part{part}.json -q");
        done(&fixture, &format!("{motion} {part}"));
    }
    let first = between(&report("part1.json"));
    let second = between(&report("part2.json"));
    let second = second.iter().map(|number| number + count / 2);
    let parts: Vec<usize> = first.into_iter().chain(second).collect();
    assert_eq!(parts, numbers);
}

#[test]
fn info_tells_frames_of_a_mesh() {
    let fixture = Fixture::new();
    bending(&fixture, 7);
    done(&fixture, &format!("{MOTION} -o all.npz -q"));
    done(&fixture, &format!("{MOTION} -o all.glb -q"));
    for name in ["all.npz", "all.glb"] {
        let output = fixture.garnet(&format!("info {name}"));
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let told = stdout(&output);
        let words: Vec<&str> = told.split_whitespace().collect();
        assert!(
            words.windows(2).any(|pair| pair == ["frames", "7"]),
            "{told}"
        );
    }
}
