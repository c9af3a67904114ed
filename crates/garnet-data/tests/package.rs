//! Garment packages.

#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use std::{fs, path::Path};

use garnet_drape::{GarmentPackage, MANIFEST_FILE, PackageError};
use garnet_knn::Surface;

fn refused(folder: &Path) -> String {
    let error = GarmentPackage::read(folder).unwrap_err();
    let mut text = error.to_string();
    let mut source = std::error::Error::source(&error);
    while let Some(cause) = source {
        text = format!("{text}: {cause}");
        source = cause.source();
    }
    text
}

#[test]
fn a_package_comes_back_as_it_was_written() {
    let package = common::tshirt();
    let folder = tempfile::tempdir().unwrap();
    package.write(folder.path()).unwrap();
    assert!(GarmentPackage::is_at(folder.path()));
    let read = GarmentPackage::read(folder.path()).unwrap();
    let mut written = package.manifest.clone();
    written
        .rest_body
        .checksum
        .clone_from(&read.manifest.rest_body.checksum);
    assert!(written.rest_body.checksum.is_some());
    assert_eq!(read.manifest, written);
    assert_eq!(read.template.source(), package.template.source());
    assert_eq!(read.rest, package.rest);
    assert_eq!(read.body.rest(), package.body.rest());
}

#[test]
fn a_worn_garment_is_outside_its_body_and_keeps_its_lengths() {
    let package = common::tshirt_of(2000);
    let skin = package.body.skin();
    let inside = skin.contains_all(package.mesh.positions());
    assert_eq!(inside.iter().filter(|&&inside| inside).count(), 0);
    let crossings = Surface::new(&package.mesh).self_intersections();
    assert!(crossings.is_empty(), "{crossings:?}");
    let neck = package
        .mesh
        .positions()
        .iter()
        .map(|p| p.y)
        .fold(0.0, f32::max);
    let hem = package
        .mesh
        .positions()
        .iter()
        .map(|p| p.y)
        .fold(3.0, f32::min);
    assert!(
        (1.40..1.52).contains(&neck) && (0.70..0.90).contains(&hem),
        "{hem} to {neck}"
    );
}

#[test]
fn what_is_damaged_or_foreign_is_refused_by_name() {
    let package = common::tshirt();
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let write = || package.write(folder.path()).unwrap();

    assert!(refused(folder.path()).contains(MANIFEST_FILE));
    write();
    let manifest = fs::read_to_string(path(MANIFEST_FILE)).unwrap();
    fs::write(
        path(MANIFEST_FILE),
        manifest.replace("garnet.garment/1", "garnet.garment/9"),
    )
    .unwrap();
    assert!(refused(folder.path()).contains("garnet.garment/9"));
    fs::write(path(MANIFEST_FILE), "name = 3").unwrap();
    assert!(refused(folder.path()).contains("line 1"));

    write();
    let mut rest = fs::read(path("template.rest.safetensors")).unwrap();
    rest.truncate(rest.len() / 2);
    fs::write(path("template.rest.safetensors"), rest).unwrap();
    assert!(refused(folder.path()).contains("template.rest.safetensors"));

    write();
    let template = fs::read_to_string(path("template.obj")).unwrap();
    fs::write(path("template.obj"), template.replacen("v ", "v 1", 1)).unwrap();
    assert!(matches!(
        GarmentPackage::read(folder.path()),
        Err(PackageError::Foreign { .. } | PackageError::Obj(_))
    ));
}

#[test]
fn edges_of_the_pattern_are_as_long_as_they_were_cut_and_ribs_apart() {
    let package = common::tshirt();
    let mesh = &package.mesh;
    let topology = garnet_mesh::Topology::new(mesh.num_vertices(), mesh.faces());
    let flat = package.flat_edges().unwrap().unwrap();
    // The rib of the neck has its own lengths.
    assert!(flat.len() < topology.edges().len() && flat.len() > topology.edges().len() * 9 / 10);
    let worn =
        |[a, b]: [u32; 2]| (mesh.positions()[a as usize] - mesh.positions()[b as usize]).norm();
    let mut stretches: Vec<f32> = flat
        .iter()
        .map(|&(ends, length)| worn(ends) / length)
        .collect();
    stretches.sort_unstable_by(f32::total_cmp);
    assert!((stretches[stretches.len() / 2] - 1.0).abs() < 0.02);
    let mut own = package.clone();
    own.rest = garnet_sim::RestShape::Worn(mesh.positions().to_vec());
    assert_eq!(own.flat_edges().unwrap(), None);
}

#[test]
fn a_package_that_cannot_be_written_leaves_the_old_one() {
    let package = common::tshirt();
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    package.write(folder.path()).unwrap();
    fs::remove_file(path("body.rig.npz")).unwrap();
    fs::create_dir(path("body.rig.npz")).unwrap();
    let names = ["template.obj", "template.rest.safetensors", MANIFEST_FILE];
    let held = || names.map(|name| fs::read(path(name)).unwrap());
    let before = held();
    let mut other = package.clone();
    other.manifest.name = "other".to_owned();
    assert!(matches!(
        other.write(folder.path()),
        Err(PackageError::Write(_))
    ));
    assert_eq!(held(), before);
}

#[test]
fn a_fabric_that_is_none_is_said_of_the_manifest() {
    let package = common::tshirt();
    let folder = tempfile::tempdir().unwrap();
    package.write(folder.path()).unwrap();
    let mut manifest = package.manifest.clone();
    manifest.fabric.membrane = f32::NAN;
    GarmentPackage::write_manifest(folder.path(), &manifest).unwrap();
    let text = refused(folder.path());
    assert!(
        text.contains(MANIFEST_FILE) && text.contains("`NaN`"),
        "{text}"
    );
}
