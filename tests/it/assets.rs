//! Real garments on real bodies, in the folder named by `GARNET_ASSETS`.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use garnet::Garment;
use garnet::io::{ObjFile, SceneJson, empty_sleeves};
use garnet_tests::Judge;

use crate::held::{Bars, held};

/// Folder of a scene, and what its drape is held to.
const SCENES: [(&str, Bars); 4] = [
    ("01_tee_walk", bars(1.35, 0.005)),
    ("03_trousers_knee_up", bars(1.5, 0.02)),
    ("05_unisex_shirt_run", bars(1.5, 0.005)),
    ("07_skirt_step", bars(1.35, 0.005)),
];

const fn bars(stretch_p99: f32, crossing: f32) -> Bars {
    Bars {
        stretch_p99,
        stretch_max: 3.0,
        crossing,
    }
}

/// The folder of the outside files; without it the tests are skipped, and say so.
fn assets(test: &str) -> Option<PathBuf> {
    let folder = env::var_os("GARNET_ASSETS").map(PathBuf::from);
    if folder.is_none() {
        println!("skipped: `{test}` needs outside files, and GARNET_ASSETS is not set");
    }
    folder
}

/// Where the pose of the target body comes from.
#[derive(Debug, Clone, Copy)]
enum PoseFrom {
    SceneJson,
    Meshes,
}

fn scene_holds(folder: &Path, name: &str, bars: Bars, pose_from: PoseFrom) {
    let scene = SceneJson::read(folder.join("scenes").join(name).join("scene.json")).unwrap();
    let body = scene.rig().unwrap().into_body().unwrap();
    let file = ObjFile::read(&scene.garment).unwrap();
    let target = ObjFile::read(&scene.target_body).unwrap();
    let posed = match pose_from {
        PoseFrom::SceneJson => {
            let transforms = scene.posed_from_rest.unwrap();
            body.fitted_by(target.positions(), transforms).unwrap()
        }
        PoseFrom::Meshes => body.fitted(target.positions()).unwrap(),
    };
    let mesh = file.mesh().unwrap();
    let judge = Judge::new(&mesh).with_edges(file.polygon_edges());
    let bound = Garment::new(mesh).bind(&body).unwrap();
    held(
        &format!("{name}, pose from {pose_from:?}"),
        &judge,
        &bound,
        &posed,
        bars,
    );
}

#[test]
fn scenes_hold() {
    let Some(folder) = assets("scenes_hold") else {
        return;
    };
    for (name, bars) in SCENES {
        scene_holds(&folder, name, bars, PoseFrom::SceneJson);
    }
}

#[test]
fn scenes_hold_with_poses_recovered_from_the_meshes_alone() {
    let Some(folder) = assets("scenes_hold_with_poses_recovered_from_the_meshes_alone") else {
        return;
    };
    for (name, bars) in SCENES {
        scene_holds(&folder, name, bars, PoseFrom::Meshes);
    }
}

#[test]
fn no_garment_of_a_scene_has_an_empty_sleeve() {
    let Some(folder) = assets("no_garment_of_a_scene_has_an_empty_sleeve") else {
        return;
    };
    for (name, _) in SCENES {
        let scene = SceneJson::read(folder.join("scenes").join(name).join("scene.json")).unwrap();
        let body = scene.rig().unwrap().into_body().unwrap();
        let mesh = ObjFile::read(&scene.garment).unwrap().mesh().unwrap();
        assert_eq!(empty_sleeves(&mesh, &body), [], "{name}");
        let bound = Garment::new(mesh).bind(&body).unwrap();
        let share = bound.cloth().inward_share();
        assert!(share < 0.3, "{name}: {share}");
    }
}

#[test]
fn every_obj_comes_back_byte_for_byte() {
    let Some(folder) = assets("every_obj_comes_back_byte_for_byte") else {
        return;
    };
    let mut folders = vec![folder];
    let mut count = 0;
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "obj") {
                let file = ObjFile::read(&path).unwrap();
                let bytes = file.bytes_with_positions(file.positions()).unwrap();
                assert!(bytes == fs::read(&path).unwrap(), "{}", path.display());
                count += 1;
            }
        }
    }
    println!("{count} files came back");
    assert!(count > 0, "there is no OBJ in the folder of GARNET_ASSETS");
}
