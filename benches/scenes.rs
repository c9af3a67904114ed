//! Untangling on scenes of real garments and bodies, as they are and subdivided once.
//!
//! `GARNET_ASSETS` names a folder with `scenes/*/scene.json`; without it there is nothing to
//! measure.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use garnet::{
    Draper, Garment,
    io::{ObjFile, SceneJson},
};
use garnet_benches::group;
use garnet_mesh::subdivided;

#[expect(
    clippy::print_stdout,
    reason = "the bench says why it measures nothing"
)]
fn bench_scenes(criterion: &mut Criterion) {
    let Some(assets) = std::env::var_os("GARNET_ASSETS") else {
        println!("GARNET_ASSETS is not set: no scenes are measured");
        return;
    };
    let mut group = group(criterion, "scenes/untangle");
    for path in scene_files(&Path::new(&assets).join("scenes")) {
        let scene = SceneJson::read(&path).expect("the scene can be read");
        let mesh_of = |path: &Path| {
            let file = ObjFile::read(path).expect("the mesh can be read");
            file.mesh().expect("the mesh has faces")
        };
        let rig = scene.rig().expect("the scene has a rig");
        let body = rig.into_body().expect("the rig fits its mesh");
        let target = mesh_of(&scene.target_body);
        let posed = match scene.posed_from_rest.clone() {
            Some(transforms) => body.fitted_by(target.positions(), transforms),
            None => body.fitted(target.positions()),
        };
        let posed = posed.expect("the target has the vertices of the rest body");
        let authored = mesh_of(&scene.garment);
        let finer = subdivided(&authored).expect("the mesh can be subdivided");
        for mesh in [finer, authored] {
            let bound = Garment::new(mesh).bind(&body).expect("the garment binds");
            let num_nodes = bound.cloth().rest_nodes().len();
            let draper = Draper::new(bound);
            let placed = draper.place(&posed, &AtomicBool::new(false));
            let placed = placed.expect("the body fits");
            group.throughput(Throughput::Elements(num_nodes as u64));
            let id = BenchmarkId::new(&scene.name, num_nodes);
            group.bench_function(id, |bencher| {
                bencher.iter(|| draper.untangle(placed.clone()));
            });
        }
    }
    group.finish();
}

/// The scenes below a folder, by name.
fn scene_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("GARNET_ASSETS has a folder `scenes`");
    let scenes = entries.filter_map(|entry| Some(entry.ok()?.path().join("scene.json")));
    let mut scenes: Vec<PathBuf> = scenes.filter(|path| path.is_file()).collect();
    scenes.sort();
    scenes
}

criterion_group!(benches, bench_scenes);
criterion_main!(benches);
