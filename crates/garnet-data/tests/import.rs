//! Data sets made elsewhere.

#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use std::{
    collections::BTreeMap,
    error::Error,
    fs,
    io::{Cursor, Write},
    path::{Path, PathBuf},
};

use garnet_data::{DataError, Dataset, DatasetManifest, ImportManifest, Split, import};
use garnet_drape::GarmentPackage;
use garnet_io::write_obj;
use garnet_mesh::{Point3, TriMesh, Vector3};
use tempfile::TempDir;
use zip::{ZipWriter, write::SimpleFileOptions};

/// A folder with meshes of a package, on two bodies.
struct Elsewhere {
    package: GarmentPackage,
    folder: TempDir,
}

const MANIFEST: &str = r#"{"schema": "garnet.import/1", "units": "m", "scenes": [
    {"split": "train", "body": "a", "sequence": "stand", "body_mesh": "body.obj", "garment_mesh": "garment.obj"},
    {"split": "test", "body": "b", "body_mesh": "other.obj", "garment_mesh": "moved.obj"}]}"#;

/// The first scene alone.
const TRAIN_ALONE: &str = r#"{"schema": "garnet.import/1", "units": "m", "scenes": [
    {"split": "train", "body": "a", "body_mesh": "body.obj", "garment_mesh": "garment.obj"}]}"#;

impl Elsewhere {
    fn new() -> Self {
        let elsewhere = Self {
            package: common::tshirt(),
            folder: tempfile::tempdir().unwrap(),
        };
        let Self { package, .. } = &elsewhere;
        let rest = package.body.rest();
        for (mesh, name, copy) in [
            (rest, "body.obj", "other.obj"),
            (&package.mesh, "garment.obj", "moved.obj"),
        ] {
            write_obj(elsewhere.path(name), mesh).unwrap();
            let moved = mesh.positions().iter().map(|place| place * 1.01).collect();
            let moved = mesh.with_positions(moved).unwrap();
            write_obj(elsewhere.path(copy), &moved).unwrap();
        }
        elsewhere
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn import(&self, manifest: &str, output: &str) -> Result<DatasetManifest, Box<DataError>> {
        let path = self.path("import.json");
        fs::write(&path, manifest).unwrap();
        let scenes = ImportManifest::read(&path).unwrap();
        let folder = self.path(output);
        let imported = import(&self.package, &scenes, &path, &folder, &mut |_| {});
        imported.map_err(Box::new)
    }

    /// An error and its causes; nothing is written.
    fn refusal(&self, manifest: &str) -> String {
        let error = self.import(manifest, "refused").unwrap_err();
        assert!(!self.path("refused").exists());
        let mut text = error.to_string();
        let mut source = error.source();
        while let Some(error) = source {
            text = format!("{text}: {error}");
            source = error.source();
        }
        text
    }

    /// The bytes of every file below a folder, by path.
    fn files(&self, name: &str) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut found = BTreeMap::new();
        let mut folders = vec![self.path(name)];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    let bytes = fs::read(&path).unwrap();
                    found.insert(path, bytes);
                }
            }
        }
        found
    }
}

#[test]
fn drapes_made_elsewhere_are_imported() {
    let elsewhere = Elsewhere::new();
    let package = &elsewhere.package;
    elsewhere.import(MANIFEST, "out").unwrap();
    let dataset = Dataset::open(&elsewhere.path("out")).unwrap();
    assert_eq!(dataset.manifest.bodies.train, 1);
    let train: Vec<_> = dataset.split(Split::Train).collect();
    let scene = &train[0].as_ref().unwrap().scenes[0];
    assert_eq!(scene.garment, package.mesh.positions());
    assert_eq!(scene.mesh().unwrap(), package.body.rest().positions());
    assert!(!elsewhere.path("out/unfinished").exists());

    let before = elsewhere.files("out");
    elsewhere.import(MANIFEST, "out").unwrap();
    assert!(elsewhere.files("out") == before, "a second import shows");
}

#[test]
fn scenes_that_are_none_are_refused_with_their_file_and_number() {
    let elsewhere = Elsewhere::new();
    let refused = |manifest: String, expected: &[&str]| {
        let error = elsewhere.refusal(&manifest);
        for expected in expected {
            assert!(error.contains(expected), "{expected}: {error}");
        }
    };
    refused(
        MANIFEST.replace("\"moved.obj\"", "\"body.obj\""),
        &[
            "scene 2, of body `b`, of `",
            "import.json",
            "body.obj",
            "the template of the package has",
        ],
    );
    refused(
        MANIFEST.replace("moved.obj", "nowhere.obj"),
        &["scene 2", "nowhere.obj"],
    );
    refused(
        MANIFEST.replace("\"m\"", "\"inch\""),
        &["import.json`: `units`: `inch` is not a unit"],
    );
    refused(
        MANIFEST.replace("\"m\"", "\"mm\""),
        &["scene 1", "body.obj` extends over 0.001"],
    );
    let empty = r#"{"schema": "garnet.import/1", "units": "m", "scenes": []}"#;
    refused(empty.to_owned(), &["import.json`: it lists no scenes"]);
}

#[test]
fn arrays_that_are_no_points_are_refused() {
    let elsewhere = Elsewhere::new();
    let mut points = elsewhere.package.mesh.positions().to_vec();
    let (rows, columns) = (
        format!("({}, 3)", points.len()),
        format!("(3, {})", points.len()),
    );
    let refused = |bytes: Vec<u8>, expected: &str| {
        fs::write(elsewhere.path("garment.npz"), bytes).unwrap();
        let error = elsewhere.refusal(&MANIFEST.replace("moved.obj", "garment.npz"));
        assert!(
            error.contains("garment.npz") && error.contains(expected),
            "{expected}: {error}"
        );
    };
    refused(
        npz_of("<f4", &columns, &bytes_of(&points)),
        "expected (N, 3)",
    );
    let integers = vec![1_u8; 3 * points.len()];
    refused(npz_of("|b1", &rows, &integers), "it holds booleans");
    refused(npz_of("|i1", &rows, &integers), "it holds integers");
    let one_place = vec![Point3::origin(); points.len()];
    refused(npz_of_points(&one_place), "extends over 0.0000 m");
    points[7].y = 1e20;
    refused(
        npz_of_points(&points),
        "vertex 7 has the coordinate `1000000",
    );
}

#[test]
fn meshes_of_another_order_or_side_are_refused() {
    let elsewhere = Elsewhere::new();
    let refused = |from: &str, name: &str, expected: &str| {
        let error = elsewhere.refusal(&MANIFEST.replace(from, name));
        let named = format!("{name}` does not belong here: ");
        assert!(
            error.contains(&named) && error.contains(expected),
            "{expected}: {error}"
        );
    };
    let package = &elsewhere.package;
    let body = package.body.rest();
    let mirrored = body.positions().iter();
    let mirrored: Vec<Point3> = mirrored.map(|p| Point3::new(-p.x, p.y, p.z)).collect();
    fs::write(elsewhere.path("mirrored.npz"), npz_of_points(&mirrored)).unwrap();
    let mirrored = body.with_positions(mirrored).unwrap();
    write_obj(elsewhere.path("mirrored.obj"), &mirrored).unwrap();
    let mirror_image = "it is the mirror image of the rest body of the package";
    refused("other.obj", "mirrored.obj", mirror_image);
    refused("other.obj", "mirrored.npz", mirror_image);

    for (mesh, from, name) in [
        (body, "other.obj", "rest body"),
        (&package.mesh, "moved.obj", "template"),
    ] {
        let shuffled = shuffled(mesh);
        write_obj(elsewhere.path("shuffled.obj"), &shuffled).unwrap();
        refused(from, "shuffled.obj", &format!(" the {name} of the package"));
        let bytes = npz_of_points(shuffled.positions());
        fs::write(elsewhere.path("shuffled.npz"), bytes).unwrap();
        let order = format!("in another order than those of the {name} of the package");
        refused(from, "shuffled.npz", &order);
    }
}

/// The same mesh with its vertices in another order.
fn shuffled(mesh: &TriMesh) -> TriMesh {
    let num_vertices = mesh.num_vertices() as u32;
    // A prime, so that no two vertices come to one place.
    let place = |vertex: u32| vertex * 1009 % num_vertices;
    let mut positions = mesh.positions().to_vec();
    for (vertex, &position) in (0..).zip(mesh.positions()) {
        positions[place(vertex) as usize] = position;
    }
    let faces = mesh.faces().iter().map(|face| face.map(place));
    TriMesh::new(positions, faces.collect()).unwrap()
}

#[test]
fn a_garment_away_from_its_body_is_refused() {
    let elsewhere = Elsewhere::new();
    let mesh = &elsewhere.package.mesh;
    let away = mesh.positions().iter().map(|p| p + Vector3::x() * 5.0);
    let away = mesh.with_positions(away.collect()).unwrap();
    write_obj(elsewhere.path("away.obj"), &away).unwrap();
    let error = elsewhere.refusal(&MANIFEST.replace("moved.obj", "away.obj"));
    for expected in [
        "scene 2",
        "away.obj` is ",
        " m away from its body `",
        "other.obj`",
    ] {
        assert!(error.contains(expected), "{expected}: {error}");
    }
}

#[test]
fn an_import_of_other_scenes_is_refused_and_one_of_the_same_is_not() {
    let elsewhere = Elsewhere::new();
    let dataset = elsewhere.import(MANIFEST, "out").unwrap();
    assert!(dataset.imported.is_some());
    let before = elsewhere.files("out");
    let refused = |manifest: &str| {
        let error = elsewhere.import(manifest, "out").unwrap_err();
        assert!(
            matches!(
                *error,
                DataError::OtherDataset {
                    field: "imported content",
                    ..
                }
            ),
            "{error}"
        );
        assert!(elsewhere.files("out") == before);
    };
    refused(&MANIFEST.replace("stand", "walk"));
    // It is what is in the files that counts.
    fs::rename(elsewhere.path("moved.obj"), elsewhere.path("same.obj")).unwrap();
    let renamed = MANIFEST.replace("moved.obj", "same.obj");
    elsewhere.import(&renamed, "out").unwrap();
    assert!(elsewhere.files("out") == before);
    let mesh = &elsewhere.package.mesh;
    let larger = mesh.positions().iter().map(|place| place * 1.02).collect();
    let larger = mesh.with_positions(larger).unwrap();
    write_obj(elsewhere.path("moved.obj"), &larger).unwrap();
    refused(MANIFEST);
}

#[test]
fn an_import_leaves_other_data_sets_alone() {
    let elsewhere = Elsewhere::new();
    elsewhere.import(MANIFEST, "out").unwrap();
    let before = elsewhere.files("out");
    let error = elsewhere.import(TRAIN_ALONE, "out").unwrap_err();
    assert!(matches!(*error, DataError::OtherDataset { .. }), "{error}");
    assert!(elsewhere.files("out") == before);

    fs::remove_file(elsewhere.path("out/dataset.json")).unwrap();
    let before = elsewhere.files("out");
    let error = elsewhere.import(TRAIN_ALONE, "out").unwrap_err();
    assert!(matches!(*error, DataError::Foreign { .. }), "{error}");
    assert!(elsewhere.files("out") == before);
}

#[test]
fn a_second_import_that_fails_leaves_the_first_one() {
    let elsewhere = Elsewhere::new();
    elsewhere.import(MANIFEST, "out").unwrap();
    let before = elsewhere.files("out");
    fs::remove_file(elsewhere.path("moved.obj")).unwrap();
    write_obj(elsewhere.path("garment.obj"), elsewhere.package.body.rest()).unwrap();
    elsewhere.import(MANIFEST, "out").unwrap_err();
    assert!(elsewhere.files("out") == before);
    assert!(!elsewhere.path("out/unfinished").exists());
}

/// An npz archive with these `vertices`.
fn npz_of_points(points: &[Point3]) -> Vec<u8> {
    npz_of("<f4", &format!("({}, 3)", points.len()), &bytes_of(points))
}

fn bytes_of(points: &[Point3]) -> Vec<u8> {
    let values = points.iter().flat_map(|point| point.iter());
    values.flat_map(|value| value.to_le_bytes()).collect()
}

/// An npz archive with an array `vertices`.
fn npz_of(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default();
    archive.start_file("vertices.npy", options).unwrap();
    archive.write_all(b"\x93NUMPY\x01\0").unwrap();
    let length = header.len() as u16;
    archive.write_all(&length.to_le_bytes()).unwrap();
    archive.write_all(header.as_bytes()).unwrap();
    archive.write_all(data).unwrap();
    archive.finish().unwrap().into_inner()
}

#[test]
fn the_shirts_of_wang_2018_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["AAA", "BBB", "P3ORMPBNJJAJ"] {
        let sample = folder.path().join(name);
        fs::create_dir(&sample).unwrap();
        fs::write(sample.join("shirt_mesh_r_tmp.obj"), "").unwrap();
        fs::write(sample.join("shirt_info.txt"), "0\n0\n0.5 0.25 1\n").unwrap();
    }
    let manifest = ImportManifest::wang_2018(folder.path(), "body.obj", garnet_mesh::Unit::Metre);
    let manifest = manifest.unwrap();
    assert_eq!(manifest.scenes.len(), 2);
    assert!(manifest.check().is_ok());
    assert_eq!(manifest.scenes[1].body_mesh, Path::new("BBB/body.obj"));
    assert!((manifest.scenes[0].parameters["p1"] - 0.25).abs() < 1e-12);
    // What is no number is refused before anything is written.
    for word in ["nan", "inf", "x"] {
        let text = format!("0\n\n0.5 {word} 1\n\n");
        fs::write(folder.path().join("BBB/shirt_info.txt"), text).unwrap();
        let listed = ImportManifest::wang_2018(folder.path(), "body.obj", garnet_mesh::Unit::Metre);
        let text = listed.unwrap_err().to_string();
        let place = format!("line 3: `{word}`");
        assert!(
            text.contains("shirt_info.txt") && text.contains(&place),
            "{text}"
        );
    }
}
