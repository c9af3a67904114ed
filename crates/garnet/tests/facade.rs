//! The examples run, and the front of the library stays small.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::path::{Path, PathBuf};
use std::process::Command;

/// Names at the root of the library, modules apart.
const MAX_NAMES: usize = 30;

/// An example, which is built beside this test.
fn example(name: &str) -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let folder = test.parent().and_then(Path::parent).unwrap();
    let name = format!("{name}{}", std::env::consts::EXE_SUFFIX);
    folder.join("examples").join(name)
}

#[test]
fn examples_write_what_they_say() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let frames = ["frame_0000.obj", "frame_0001.obj", "frame_0002.obj"];
    for (name, argument, written) in [
        ("drape", place("draped.obj"), vec!["draped.obj"]),
        ("motion", place(""), frames.to_vec()),
        ("own_body", place("sleeve.obj"), vec!["sleeve.obj"]),
        ("outfit", place(""), vec!["tshirt.obj", "sweater.obj"]),
        ("package", place("shirt.obj"), vec!["shirt.obj"]),
        ("threads", place(""), vec!["shirt_0.obj", "shirt_1.obj"]),
    ] {
        let output = Command::new(example(name)).arg(&argument).output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{name}: {told}");
        for file in written {
            let file = garnet::io::ObjFile::read(place(file)).unwrap();
            assert!(file.num_vertices() > 0, "{name}");
        }
    }
}

#[test]
fn the_root_has_few_names() {
    let source = include_str!("../src/lib.rs");
    let uses = source.split("\npub use ").skip(1);
    let names = uses.flat_map(|text| {
        let text = text.split(';').next().unwrap();
        assert!(!text.contains('*'), "{text}");
        let names = text.split_once('{').map_or(text, |(_, names)| names);
        names.trim_end_matches('}').split(',')
    });
    let names: Vec<&str> = names
        .map(str::trim)
        .filter(|name| !name.is_empty())
        .collect();
    assert!(names.contains(&"Draper") && names.len() > 20, "{names:?}");
    assert!(names.len() <= MAX_NAMES, "{} names: {names:?}", names.len());
}
