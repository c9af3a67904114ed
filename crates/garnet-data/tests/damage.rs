//! Files that are not those that were written are refused by name, wherever they are damaged.

#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use std::{collections::BTreeMap, collections::HashMap, fs, path::Path};

use garnet_data::{BodyRecord, DataError, Posed, SceneRecord, Shard, Split};
use garnet_drape::{GarmentPackage, MANIFEST_FILE, PackageError};
use garnet_mesh::{Fingerprint, Point3};
use garnet_skin::Pose;
use safetensors::SafeTensors;

/// An error with its causes.
fn told(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        text = format!("{text}: {cause}");
        source = cause.source();
    }
    text
}

/// Copies of a file with one bit turned, at many places: all bits of the first bytes, then fewer.
fn flipped(bytes: &[u8], all: usize, step: usize) -> impl Iterator<Item = (usize, Vec<u8>)> + '_ {
    let first = (0..8 * all.min(bytes.len())).step_by(3);
    let others = (8 * all..8 * bytes.len()).step_by(step);
    first.chain(others).map(|bit| {
        let mut damaged = bytes.to_vec();
        damaged[bit / 8] ^= 1 << (bit % 8);
        (bit, damaged)
    })
}

/// Copies of a file that end too early.
fn cut(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let lengths = (0..bytes.len()).step_by(bytes.len() / 60 + 1);
    lengths.map(|length| &bytes[..length])
}

/// A safetensors file with another text and other names of tensors.
fn rewritten(
    bytes: &[u8],
    text: impl Fn(&str) -> String,
    name: impl Fn(&str) -> String,
) -> Vec<u8> {
    let (_, metadata) = SafeTensors::read_metadata(bytes).unwrap();
    let texts = metadata.metadata().clone().unwrap();
    let texts: HashMap<String, String> = (texts.into_iter())
        .map(|(key, value)| (key, text(&value)))
        .collect();
    let tensors = SafeTensors::deserialize(bytes).unwrap();
    let views = tensors.iter().map(|(known, view)| (name(known), view));
    safetensors::serialize(views, Some(texts)).unwrap()
}

/// The text of a shard as earlier versions wrote it.
fn unsigned(text: &str) -> String {
    let start = text.find(r#""checksum":"#).unwrap();
    let end = start + text[start..].find(',').unwrap() + 1;
    text[..start].to_owned() + &text[end..]
}

fn shard() -> Shard {
    let places = |shift: f32| -> Vec<Point3> {
        (0..5)
            .map(|at| Point3::new(at as f32, shift, 0.5))
            .collect()
    };
    let scene = |pose: u32| SceneRecord {
        body: 0,
        pose,
        sequence: "walk".to_owned(),
        posed: Posed::Pose(Pose::rest(3)),
        garment: places(pose as f32),
        arrived: Some(places(0.1)),
        midway: Some(places(0.2)),
        report: None,
    };
    Shard {
        split: Split::Train,
        bodies: vec![BodyRecord {
            number: 0,
            parameters: None,
            garment: BTreeMap::from([("length".to_owned(), 0.6)]),
            worn: Some(places(0.3)),
        }],
        // As many as a place has numbers, so that axes can be mistaken for each other.
        scenes: (0..3).map(scene).collect(),
        rejections: Vec::new(),
    }
}

#[test]
fn a_shard_is_the_one_that_was_written_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("train_0000.safetensors");
    let dataset = Fingerprint::of_bytes(b"data");
    shard().write(&path, dataset).unwrap();
    let whole = fs::read(&path).unwrap();
    assert_eq!(Shard::read(&path, dataset).unwrap(), shard());

    let read = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        Shard::read(&path, dataset)
    };
    let named = |error: DataError| {
        let text = told(&error);
        assert!(text.contains("train_0000.safetensors"), "{text}");
    };
    for (bit, damaged) in flipped(&whole, 100, 7) {
        match read(&damaged) {
            Ok(_) => panic!("bit {bit} made no difference"),
            Err(error) => named(error),
        }
    }
    for shorter in cut(&whole) {
        named(read(shorter).unwrap_err());
    }
    // A bit of a number.
    let mut damaged = whole.clone();
    *damaged.last_mut().unwrap() ^= 1;
    assert!(matches!(read(&damaged), Err(DataError::Altered { .. })));
    let names = [
        "garment",
        "arrived",
        "midway",
        "rotations",
        "root_translation",
        "worn",
    ];
    let renamed = |renamed: &'static str| {
        let name = move |name: &str| name.replace(renamed, "other");
        rewritten(&whole, str::to_owned, name)
    };
    for name in names {
        assert!(matches!(
            read(&renamed(name)),
            Err(DataError::Altered { .. })
        ));
    }

    // Of an earlier version: read, and never a panic.
    let before = rewritten(&whole, unsigned, str::to_owned);
    assert_eq!(read(&before).unwrap(), shard());
    for name in names {
        let other = |known: &str| known.replace(name, "other");
        named(read(&rewritten(&before, str::to_owned, other)).unwrap_err());
    }
    for (_, damaged) in flipped(&before, 1200, 7) {
        if let Err(error) = read(&damaged) {
            named(error);
        }
    }
}

#[test]
fn a_body_that_nothing_could_be_cut_for_has_no_garment() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("train_0000.safetensors");
    let dataset = Fingerprint::of_bytes(b"data");
    let mut written = shard();
    let dressed = written.bodies[0].clone();
    let bare = BodyRecord {
        number: 1,
        parameters: None,
        garment: BTreeMap::new(),
        worn: None,
    };
    let last = BodyRecord {
        number: 2,
        worn: Some(vec![Point3::new(1.0, 2.0, 3.0); 5]),
        ..dressed
    };
    written.bodies.extend([bare, last]);
    written.write(&path, dataset).unwrap();
    assert_eq!(Shard::read(&path, dataset).unwrap(), written);
}

#[test]
fn a_package_is_the_one_that_was_written_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let package = common::tshirt();
    package.write(folder.path()).unwrap();
    GarmentPackage::read(folder.path()).unwrap();
    for (name, all, step) in [
        ("template.rest.safetensors", 60, 9001),
        ("body.rig.npz", 12, 120_001),
    ] {
        let path = folder.path().join(name);
        let whole = fs::read(&path).unwrap();
        let refused = |bytes: &[u8], what: &str| {
            fs::write(&path, bytes).unwrap();
            match GarmentPackage::read(folder.path()) {
                Ok(_) => panic!("{name}: {what} made no difference"),
                Err(error) => assert!(told(&error).contains(name), "{}", told(&error)),
            }
        };
        for (bit, damaged) in flipped(&whole, all, step) {
            refused(&damaged, &format!("bit {bit}"));
        }
        for shorter in cut(&whole).step_by(6) {
            refused(shorter, &format!("{} bytes", shorter.len()));
        }
        fs::write(&path, &whole).unwrap();
    }
    GarmentPackage::read(folder.path()).unwrap();
}

#[test]
fn packages_of_earlier_versions_are_read_and_do_not_panic() {
    let folder = tempfile::tempdir().unwrap();
    let package = common::tshirt();
    package.write(folder.path()).unwrap();
    let path = |name: &str| folder.path().join(name);
    without_checksum(&path(MANIFEST_FILE));
    let rest = fs::read(path("template.rest.safetensors")).unwrap();
    let schema = |text: &str| text.split(' ').next().unwrap().to_owned();
    let before = rewritten(&rest, schema, str::to_owned);
    fs::write(path("template.rest.safetensors"), &before).unwrap();
    let read = GarmentPackage::read(folder.path()).unwrap();
    assert_eq!(read.rest, package.rest);
    assert_eq!(read.manifest, package.manifest);
    for name in ["corners", "shrink"] {
        let other = |known: &str| known.replace(name, "other");
        let renamed = rewritten(&before, str::to_owned, other);
        fs::write(path("template.rest.safetensors"), renamed).unwrap();
        let error = GarmentPackage::read(folder.path()).unwrap_err();
        assert!(matches!(error, PackageError::Foreign { .. }), "{error}");
    }
    fs::write(path("template.rest.safetensors"), &before).unwrap();
    let rig = fs::read(path("body.rig.npz")).unwrap();
    for (_, damaged) in flipped(&rig, 12, 40_001) {
        fs::write(path("body.rig.npz"), damaged).unwrap();
        if let Err(error) = GarmentPackage::read(folder.path()) {
            assert!(told(&error).contains("body.rig.npz"), "{}", told(&error));
        }
    }
}

fn without_checksum(manifest: &Path) {
    let text = fs::read_to_string(manifest).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with("checksum"));
    let lines: Vec<&str> = lines.collect();
    assert!(lines.len() < text.lines().count());
    fs::write(manifest, lines.join("\n")).unwrap();
}

#[test]
fn a_package_names_files_of_its_own_alone() {
    let package = common::tshirt();
    let folder = tempfile::tempdir().unwrap();
    package.write(folder.path()).unwrap();
    let path = folder.path().join("garment.toml");
    let text = fs::read_to_string(&path).unwrap();
    for name in ["/dev/zero", "../body.rig.npz", "a/../../body.rig.npz"] {
        let weights = format!("\n[[variant]]\nname = \"fast\"\nweights = \"{name}\"\n");
        for text in [
            text.clone() + &weights,
            text.replace("rig = \"body.rig.npz\"", &format!("rig = \"{name}\"")),
        ] {
            fs::write(&path, text).unwrap();
            let error = GarmentPackage::read(folder.path()).unwrap_err();
            assert!(matches!(error, PackageError::Foreign { .. }), "{error}");
            assert!(
                error.to_string().contains("outside of the package"),
                "{error}"
            );
        }
    }
}

#[cfg(unix)]
#[test]
fn weights_are_files_and_no_devices() {
    let package = common::tshirt();
    let folder = tempfile::tempdir().unwrap();
    package.write(folder.path()).unwrap();
    std::os::unix::fs::symlink("/dev/zero", folder.path().join("fast.safetensors")).unwrap();
    let path = folder.path().join("garment.toml");
    let text = fs::read_to_string(&path).unwrap();
    let weights = "\n[[variant]]\nname = \"fast\"\nweights = \"fast.safetensors\"\n";
    fs::write(&path, text + weights).unwrap();
    let package = garnet_drape::Package::open(folder.path()).unwrap();
    let error = package.draper("fast").unwrap_err();
    let text = told(&error);
    assert!(text.contains("a pipe or a device"), "{text}");
}
