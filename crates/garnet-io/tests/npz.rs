//! Rigs as npz: round trips, all element types, damaged archives.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::{
    fs,
    io::{Cursor, Write},
    path::{Path, PathBuf},
};

use garnet_io::{
    FileProblem, NpzFile, RigOptions, read_rig, read_rig_npz, read_rig_with, write_rig_npz,
};
use garnet_skin::{Pose, Vector3};
use proptest::prelude::*;
use zip::{CompressionMethod, ZipWriter, write::SimpleFileOptions};

mod common;

use common::{chain, strip};

/// An `.npy` file with a header as `NumPy` writes it.
fn npy(descr: &str, is_fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let fortran = if is_fortran { "True" } else { "False" };
    let header =
        format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

/// The values as little- or big-endian bytes of an element type.
fn encoded(descr: &str, values: &[f64]) -> Vec<u8> {
    let little = |value: f64| match &descr[1..] {
        "f2" => half(value).to_le_bytes().to_vec(),
        "f4" => (value as f32).to_le_bytes().to_vec(),
        "f8" => value.to_le_bytes().to_vec(),
        other => {
            let size: usize = other[1..].parse().unwrap();
            (value as i64).to_le_bytes()[..size].to_vec()
        }
    };
    let order = |mut bytes: Vec<u8>| {
        if descr.starts_with('>') {
            bytes.reverse();
        }
        bytes
    };
    values
        .iter()
        .flat_map(|&value| order(little(value)))
        .collect()
}

/// Half-precision bits of the values in these tests.
fn half(value: f64) -> u16 {
    let known = [
        (0.0, 0),
        (0.25, 0x3400),
        (0.5, 0x3800),
        (0.75, 0x3a00),
        (1.0, 0x3c00),
        (2.0, 0x4000),
        (4.0, 0x4400),
        (-1.0, 0xbc00),
    ];
    let found = known
        .iter()
        .find(|(known, _)| f64::total_cmp(known, &value).is_eq());
    found.unwrap().1
}

type Entries = Vec<(&'static str, Vec<u8>)>;

/// A triangle on two joints, all of whose numbers are exact in half precision.
fn triangle(float: &str, integer: &str, root: f64, is_fortran: bool) -> Entries {
    let rows = |columns: usize, values: &[f64]| {
        if !is_fortran {
            return values.to_vec();
        }
        let count = values.len() / columns;
        (0..values.len())
            .map(|i| values[(i % count) * columns + i / count])
            .collect()
    };
    let floats = |shape: &str, columns, values: &[f64]| {
        npy(
            float,
            is_fortran,
            shape,
            &encoded(float, &rows(columns, values)),
        )
    };
    let integers = |shape: &str, columns, values: &[f64]| {
        npy(
            integer,
            is_fortran,
            shape,
            &encoded(integer, &rows(columns, values)),
        )
    };
    vec![
        (
            "vertices",
            floats(
                "(3, 3)",
                3,
                &[0.0, 1.0, 2.0, 0.5, 0.25, -1.0, 4.0, 0.0, 0.75],
            ),
        ),
        ("faces", integers("(1, 3)", 3, &[0.0, 2.0, 1.0])),
        (
            "blend_weights",
            floats("(3, 2)", 2, &[1.0, 0.0, 0.25, 0.75, 0.0, 1.0]),
        ),
        (
            "joints",
            floats("(2, 3)", 3, &[0.0, 0.0, 0.0, 0.0, 1.0, 0.5]),
        ),
        ("parents", integers("(2,)", 1, &[root, 0.0])),
    ]
}

fn packed(entries: &Entries, method: CompressionMethod) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (key, bytes) in entries {
        let options = SimpleFileOptions::default().compression_method(method);
        archive.start_file(format!("{key}.npy"), options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn written(folder: &Path, bytes: &[u8]) -> PathBuf {
    let path = folder.join("body.rig.npz");
    fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn a_rig_survives_the_round_trip_and_gives_the_same_bytes_twice() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("body.rig.npz");
    let mut rig = strip();
    let mut pose = Pose::rest(2);
    pose.rotations[1] = nalgebra::UnitQuaternion::from_scaled_axis(Vector3::new(0.5, 0.0, 0.25));
    rig.rest_pose = Some(pose);
    write_rig_npz(&path, &rig).unwrap();
    let first = fs::read(&path).unwrap();
    let mut back = read_rig(&path).unwrap();
    let found = back.rest_pose.take().unwrap().rotations[1];
    assert!(found.angle_to(&rig.rest_pose.take().unwrap().rotations[1]) < 1e-3);
    assert_eq!(back, rig);
    write_rig_npz(&path, &rig).unwrap();
    assert_eq!(read_rig_npz(&path).unwrap().rest_pose, None);
    write_rig_npz(&path, &back).unwrap();
    assert!(fs::read(&path).unwrap().len() < first.len());
}

#[test]
fn every_element_type_order_and_compression_reads_the_same_rig() {
    let folder = tempfile::tempdir().unwrap();
    let expected = packed(
        &triangle("<f8", "<i8", -1.0, false),
        CompressionMethod::Stored,
    );
    let expected = read_rig(written(folder.path(), &expected)).unwrap();
    assert_eq!(expected.skeleton.joints()[1].name, "joint_1");
    assert_eq!(expected.weights.heaviest(1), 1);
    assert_eq!(expected.rest.as_ref().unwrap().faces(), [[0, 2, 1]]);
    for float in ["<f2", "<f4", "<f8", ">f2", ">f4", ">f8"] {
        for integer in [
            "|i1", "<i2", "<i4", "<i8", ">i2", ">i8", "|u1", "<u2", "<u4", "<u8", ">u4", "<f4",
        ] {
            for is_fortran in [false, true] {
                let method = if is_fortran {
                    CompressionMethod::Deflated
                } else {
                    CompressionMethod::Stored
                };
                // As unsigned, -1 is the largest number; 0 is the root's own number.
                for root in [-1.0, 0.0] {
                    let bytes = packed(&triangle(float, integer, root, is_fortran), method);
                    let rig = read_rig(written(folder.path(), &bytes)).unwrap();
                    assert_eq!(rig, expected, "{float} {integer} {is_fortran} {root}");
                }
            }
        }
    }
    let bytes = packed(
        &triangle("<f4", "<i8", 4_294_967_295.0, false),
        CompressionMethod::Stored,
    );
    assert_eq!(read_rig(written(folder.path(), &bytes)).unwrap(), expected);
}

#[test]
fn missing_keys_are_listed_with_those_found() {
    let folder = tempfile::tempdir().unwrap();
    let mut entries = triangle("<f4", "<i4", -1.0, false);
    entries.retain(|(key, _)| !["joints", "faces"].contains(key));
    let path = written(folder.path(), &packed(&entries, CompressionMethod::Stored));
    let text = chain(&read_rig(&path).unwrap_err());
    assert!(text.contains("body.rig.npz"), "{text}");
    assert!(
        text.contains("missing `faces`, `joints`; found `blend_weights`, `parents`, `vertices`"),
        "{text}"
    );
}

#[test]
fn wrong_shapes_and_values_are_refused_by_key() {
    let cases: [(&str, Vec<u8>, &str); 7] = [
        (
            "vertices",
            npy("<f4", false, "(9,)", &[0; 36]),
            "key `vertices`: it has the shape [9], expected [_, 3]",
        ),
        (
            "blend_weights",
            npy("<f4", false, "(2, 2)", &[0; 16]),
            "expected [3, 2]",
        ),
        (
            "parents",
            npy("<i4", false, "(2,)", &encoded("<i4", &[-1.0, -7.0])),
            "key `parents`: its element 1 is `-7`",
        ),
        (
            "parents",
            npy("<i4", false, "(2,)", &encoded("<i4", &[1.0, 0.0])),
            "is its own ancestor",
        ),
        (
            "faces",
            npy("<f4", false, "(1, 3)", &encoded("<f4", &[0.0, 0.5, 1.0])),
            "key `faces`: its element 1 is `0.5`",
        ),
        (
            "faces",
            npy("<i4", false, "(1, 3)", &encoded("<i4", &[0.0, 5.0, 1.0])),
            "names vertex 5",
        ),
        (
            "joints",
            npy("|O", false, "(2, 3)", &[0; 48]),
            "key `joints` is an object of Python",
        ),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (key, bytes, expected) in cases {
        let mut entries = triangle("<f4", "<i4", -1.0, false);
        for (name, entry) in &mut entries {
            if *name == key {
                entry.clone_from(&bytes);
            }
        }
        let path = written(folder.path(), &packed(&entries, CompressionMethod::Stored));
        let text = chain(&read_rig(&path).unwrap_err());
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
fn a_zero_rest_pose_is_none_and_another_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    for (value, is_some) in [(0.0, false), (0.5, true)] {
        let mut entries = triangle("<f4", "<i4", -1.0, false);
        let pose = encoded("<f4", &[0.0, 0.0, 0.0, 0.0, value, 0.0]);
        entries.push(("rest_pose", npy("<f4", false, "(2, 3)", &pose)));
        let path = written(folder.path(), &packed(&entries, CompressionMethod::Stored));
        assert_eq!(read_rig(&path).unwrap().rest_pose.is_some(), is_some);
    }
}

#[test]
fn truncated_and_foreign_archives_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = packed(
        &triangle("<f4", "<i4", -1.0, false),
        CompressionMethod::Deflated,
    );
    for length in 0..bytes.len() {
        assert!(
            read_rig(written(folder.path(), &bytes[..length])).is_err(),
            "cut at {length}"
        );
    }
    let error = read_rig(written(folder.path(), b"no zip at all")).unwrap_err();
    assert!(matches!(error.problem, FileProblem::Archive(_)));
    assert!(NpzFile::open(folder.path().join("absent.npz")).is_err());
    let mut other = triangle("<f4", "<i4", -1.0, false);
    other.truncate(0);
    let path = written(folder.path(), &packed(&other, CompressionMethod::Stored));
    assert!(matches!(
        read_rig(path).unwrap_err().problem,
        FileProblem::MissingKeys { .. }
    ));
}

proptest! {
    #[test]
    fn no_damage_makes_the_reader_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        is_stored in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let method = if is_stored { CompressionMethod::Stored } else { CompressionMethod::Deflated };
        let mut bytes = packed(&triangle("<f4", "<i4", -1.0, false), method);
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let _ = read_rig(written(folder.path(), &bytes));
    }

    #[test]
    fn no_array_makes_the_reader_panic(
        key in 0_usize..5,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let mut entries = triangle("<f4", "<i4", -1.0, false);
        for (at, value) in changes {
            let at = at.index(entries[key].1.len());
            entries[key].1[at] = value;
        }
        let _ = read_rig(written(folder.path(), &packed(&entries, CompressionMethod::Stored)));
    }
}

/// A model of the SMPL family: two joints on a triangle, and one shape direction.
fn smpl(regressor: (&'static str, Vec<u8>)) -> Vec<u8> {
    smpl_with(vec![regressor])
}

/// The same with a regressor in parts.
fn smpl_with(regressor: Entries) -> Vec<u8> {
    let floats = |shape: &str, values: &[f64]| npy("<f8", false, shape, &encoded("<f8", values));
    let mut entries: Entries = vec![
        (
            "v_template",
            floats("(3, 3)", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0]),
        ),
        (
            "f",
            npy("<u4", false, "(1, 3)", &encoded("<u4", &[0.0, 1.0, 2.0])),
        ),
        ("weights", floats("(3, 2)", &[1.0, 0.0, 1.0, 0.0, 0.0, 1.0])),
        (
            "kintree_table",
            npy(
                "<i8",
                false,
                "(2, 2)",
                &encoded("<i8", &[-1.0, 0.0, 0.0, 1.0]),
            ),
        ),
        (
            "shapedirs",
            floats("(3, 3, 1)", &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0]),
        ),
    ];
    entries.extend(regressor);
    packed(&entries, CompressionMethod::Stored)
}

#[test]
fn sparse_and_turned_regressors_are_the_dense_one() {
    let folder = tempfile::tempdir().unwrap();
    let array = |shape: &str, values: &[f64]| npy("<f8", false, shape, &encoded("<f8", values));
    let list = |values: &[f64]| array(&format!("({},)", values.len()), values);
    let read = |entries: Entries| read_rig(written(folder.path(), &smpl_with(entries)));
    let dense = [1.0, 0.0, 0.0, 0.0, 0.5, 0.5];
    let expected = read(vec![("J_regressor", array("(2, 3)", &dense))]).unwrap();
    // Of [[1, 0, 0], [0, 0.5, 0.5]]: rows as joints, or turned.
    let data = || list(&[1.0, 0.5, 0.5]);
    let layouts: [Entries; 7] = [
        vec![(
            "J_regressor",
            array("(3, 2)", &[1.0, 0.0, 0.0, 0.5, 0.0, 0.5]),
        )],
        vec![
            ("J_regressor_data", data()),
            ("J_regressor_indices", list(&[0.0, 1.0, 2.0])),
            ("J_regressor_indptr", list(&[0.0, 1.0, 3.0])),
        ],
        vec![
            ("J_regressor.data", data()),
            ("J_regressor.indices", list(&[0.0, 1.0, 1.0])),
            ("J_regressor.indptr", list(&[0.0, 1.0, 2.0, 3.0])),
            ("J_regressor.shape", list(&[2.0, 3.0])),
            ("J_regressor.format", npy("|S3", false, "()", b"csc")),
        ],
        vec![
            ("J_regressor/data", data()),
            ("J_regressor/indices", list(&[0.0, 1.0, 1.0])),
            ("J_regressor/indptr", list(&[0.0, 1.0, 2.0, 3.0])),
            ("J_regressor/shape", list(&[3.0, 2.0])),
        ],
        vec![
            ("J_regressor_row", list(&[0.0, 1.0, 1.0])),
            ("J_regressor_col", list(&[0.0, 1.0, 2.0])),
            ("J_regressor_data", data()),
        ],
        vec![
            ("J_regressor_row", list(&[0.0, 1.0, 2.0])),
            ("J_regressor_col", list(&[0.0, 1.0, 1.0])),
            ("J_regressor_data", data()),
        ],
        vec![
            (
                "J_regressor",
                npy("|O", false, "()", b"\x80\x03cscipy.sparse"),
            ),
            ("J_regressor_data", data()),
            ("J_regressor_indices", list(&[0.0, 1.0, 2.0])),
            ("J_regressor_indptr", list(&[0.0, 1.0, 3.0])),
        ],
    ];
    for (number, layout) in layouts.into_iter().enumerate() {
        assert_eq!(read(layout).unwrap(), expected, "layout {number}");
    }
}

#[test]
fn sparse_regressors_that_do_not_fit_are_refused_by_key() {
    let folder = tempfile::tempdir().unwrap();
    let array = |shape: &str, values: &[f64]| npy("<f8", false, shape, &encoded("<f8", values));
    let list = |values: &[f64]| array(&format!("({},)", values.len()), values);
    let read = |entries: Entries| read_rig(written(folder.path(), &smpl_with(entries)));
    let data = || list(&[1.0, 0.5, 0.5]);
    let broken: [(Entries, &str); 5] = [
        (
            vec![
                ("J_regressor_data", data()),
                ("J_regressor_indices", list(&[0.0, 1.0, 2.0])),
            ],
            "missing `J_regressor_indptr`",
        ),
        (
            vec![
                ("J_regressor_data", data()),
                ("J_regressor_indices", list(&[0.0, 1.0, 2.0])),
                ("J_regressor_indptr", list(&[0.0, 3.0, 1.0])),
            ],
            "key `J_regressor_indptr`: its element 2 is `1`",
        ),
        (
            vec![
                ("J_regressor_data", data()),
                ("J_regressor_indices", list(&[0.0, 1.0, 2.0])),
                ("J_regressor_indptr", list(&[0.0, 1.0, 1.0, 2.0, 3.0])),
            ],
            "it has the shape [5], expected [3] (CSR) or [4] (CSC)",
        ),
        (
            vec![
                ("J_regressor_data", data()),
                ("J_regressor_indices", list(&[0.0, 1.0, 3.0])),
                ("J_regressor_indptr", list(&[0.0, 1.0, 3.0])),
            ],
            "key `J_regressor_indices`: its element 2 is `3`",
        ),
        (
            vec![("J_regressor", array("(4, 2)", &[0.0; 8]))],
            "it has the shape [4, 2], expected [2, 3]",
        ),
    ];
    for (entries, expected) in broken {
        let text = chain(&read(entries).unwrap_err());
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
fn models_of_the_smpl_family_are_rigs_in_the_shape_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let dense = [1.0, 0.0, 0.0, 0.0, 0.5, 0.5];
    let rows = [0.0, 0.0, 1.0, 1.0, 1.0, 0.5, 1.0, 2.0, 0.5];
    for (shape, values) in [("(2, 3)", &dense[..]), ("(3, 3)", &rows[..])] {
        let regressor = npy("<f8", false, shape, &encoded("<f8", values));
        let path = written(folder.path(), &smpl(("J_regressor", regressor)));
        let mut options = RigOptions::default();
        for (betas, height) in [(vec![], 1.0), (vec![2.0], 1.5)] {
            options.betas = betas;
            let rig = read_rig_with(&path, &options).unwrap().rig;
            let joint = &rig.skeleton.joints()[1];
            assert_eq!((joint.parent, joint.rest_position.y), (Some(0), height));
            let top = rig.rest.unwrap().positions()[2].y;
            assert!((top - 2.0 * height).abs() < 1e-6, "{top}");
        }
        options.betas = vec![0.0; 3];
        let text = chain(&read_rig_with(&path, &options).unwrap_err());
        assert!(text.contains("1 shape directions, 3 betas"), "{text}");
    }
    let pickled = npy("|O", false, "()", b"\x80\x03cscipy.sparse");
    let path = written(folder.path(), &smpl(("J_regressor", pickled)));
    let text = chain(&read_rig(path).unwrap_err());
    assert!(
        text.contains("`J_regressor` is an object of Python"),
        "{text}"
    );
}

#[test]
fn an_array_that_says_that_it_is_huge_is_not_unpacked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bomb.npz");
    let mut archive = ZipWriter::new(fs::File::create(&path).unwrap());
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    archive.start_file("poses.npy", options).unwrap();
    let zeros = vec![0; 1 << 20];
    for _ in 0..257 {
        archive.write_all(&zeros).unwrap();
    }
    archive.finish().unwrap();
    assert!(fs::metadata(&path).unwrap().len() < 1 << 20);
    let mut npz = NpzFile::open(&path).unwrap();
    let error = npz.array("poses").unwrap_err();
    let text = error.problem.to_string();
    assert!(text.contains("268435456"), "{text}");
}
