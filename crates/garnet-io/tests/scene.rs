//! Scenes out of files: what is detected, and what is refused by its type.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::path::Path;

use garnet_io::{
    Misplaced, ObjFile, PoseNote, Scene, SceneError, SceneFiles, SceneProblem, TargetSource,
    is_rig, read_mesh, write_obj, write_rig_npz,
};
use garnet_mesh::{
    TriMesh, Unit, UpAxis,
    primitives::{capsule, tube},
};
use garnet_skin::{Body, Joint, Method, Point3, Pose, Rig, Skeleton, SkinWeights, Vector3};
use nalgebra::UnitQuaternion;

/// Positions that were brought to another unit and back, in metres.
const ROUNDING: f32 = 1e-5;

/// A body of two joints that stands around the origin.
fn body() -> Body {
    let mesh = capsule(0.15, 1.4, 24, 24);
    let joint = |name: &str, parent, y| Joint {
        name: name.to_owned(),
        parent,
        rest_position: Point3::new(0.0, y, 0.0),
    };
    let joints = vec![joint("hip", None, -0.3), joint("chest", Some(0), 0.2)];
    let share = |point: &Point3| (0.5 + point.y).clamp(0.0, 1.0);
    let rows = mesh.positions().iter().map(share);
    let rows = rows.map(|share| [(0, 1.0 - share), (1, share)]);
    let weights = SkinWeights::from_influences(2, rows).unwrap();
    Body::new(mesh, Skeleton::new(joints).unwrap(), weights).unwrap()
}

fn shirt() -> TriMesh {
    tube(0.2, 0.6, 24, 12)
}

fn changed(mesh: &TriMesh, way: impl Fn(&Point3) -> Point3) -> TriMesh {
    let positions = mesh.positions().iter().map(way);
    mesh.with_positions(positions.collect()).unwrap()
}

/// The files of a shirt and a body with its rig in a folder.
fn files(folder: &Path, shirt: &TriMesh) -> SceneFiles {
    write_obj(folder.join("body.obj"), body().rest()).unwrap();
    write_rig_npz(folder.join("body.rig.npz"), &Rig::from(body())).unwrap();
    write_obj(folder.join("shirt.obj"), shirt).unwrap();
    let mut files = SceneFiles::new(folder.join("shirt.obj"));
    files.bodies = vec![folder.join("body.obj")];
    files
}

#[test]
fn a_rig_beside_the_body_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::load(&files(folder.path(), &shirt())).unwrap();
    assert_eq!(scene.rest.rig_path, folder.path().join("body.rig.npz"));
    assert_eq!(scene.garment.mesh.positions(), shirt().positions());
    assert!(matches!(scene.targets[0].source, TargetSource::Vertices(_)));
    assert!(scene.own.is_none() && scene.notes.is_empty());
    scene.targets[0].posed(&scene.body).unwrap();
}

#[test]
fn units_and_axes_are_detected_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let large = |p: &Point3| Point3::new(p.x, -p.z, p.y) * 100.0;
    let mut files = files(folder.path(), &changed(&shirt(), large));
    let rest = folder.path().join("rest.obj");
    write_obj(&rest, &changed(body().rest(), large)).unwrap();
    files.bodies = vec![rest.clone()];
    files.rig = Some(folder.path().join("body.rig.npz"));
    files.rest_body = Some(rest);
    let scene = Scene::load(&files).unwrap();
    let frame = scene.garment.frame;
    assert_eq!((frame.unit, frame.up), (Unit::Centimetre, UpAxis::Z));
    assert_eq!(scene.rest.file_frame, frame);
    let pairs = scene
        .garment
        .mesh
        .positions()
        .iter()
        .zip(shirt().into_parts().0);
    for (found, expected) in pairs {
        assert!((found - expected).norm() < ROUNDING);
    }
}

#[test]
fn a_body_in_an_imperial_unit_is_known_by_its_size() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = files(folder.path(), &shirt());
    let posed = folder.path().join("posed.obj");
    files.rest_body = Some(folder.path().join("body.obj"));
    files.rig = Some(folder.path().join("body.rig.npz"));
    files.bodies = vec![posed.clone()];
    for unit in [Unit::Inch, Unit::Foot] {
        let of_file = changed(body().rest(), |place| place / unit.in_metres());
        write_obj(&posed, &of_file).unwrap();
        let scene = Scene::load(&files).unwrap();
        assert_eq!(scene.garment.frame.unit, Unit::Metre);
        let TargetSource::Vertices(found) = &scene.targets[0].source else {
            panic!("a posed body has vertices");
        };
        let pairs = found.iter().zip(body().rest().positions().to_vec());
        assert!(pairs.into_iter().all(|(a, b)| (a - b).norm() < ROUNDING));
        let told = PoseNote::InUnit {
            path: posed.clone(),
            unit,
        };
        assert_eq!(scene.notes, [told]);
    }
}

#[test]
fn what_is_wrong_has_a_type() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = files(folder.path(), &shirt());

    let away = changed(&shirt(), |point| point + Vector3::x() * 3.0);
    write_obj(folder.path().join("away.obj"), &away).unwrap();
    files.garment = folder.path().join("away.obj");
    let error = Scene::load(&files).unwrap_err();
    let SceneError::Misplaced { problem, .. } = error else {
        panic!("{error}");
    };
    assert!(matches!(problem, Misplaced::Apart { .. }), "{problem}");

    let large = changed(&shirt(), |point| point * 100.0);
    write_obj(folder.path().join("large.obj"), &large).unwrap();
    files.garment = folder.path().join("large.obj");
    let error = Scene::load(&files).unwrap_err();
    let SceneError::Misplaced { problem, .. } = error else {
        panic!("{error}");
    };
    let (garment, taken) = (Unit::Centimetre, Unit::Metre);
    let or = Some(Unit::Inch);
    assert_eq!(problem, Misplaced::Unit { garment, or, taken });

    files.garment = folder.path().join("shirt.obj");
    files.pose = Some("no_such_pose".into());
    assert!(matches!(Scene::load(&files), Err(SceneError::Pose(_))));
    files.pose = None;

    let other = folder.path().join("other.obj");
    write_obj(&other, &capsule(0.15, 1.4, 20, 20)).unwrap();
    files.rig = Some(folder.path().join("body.rig.npz"));
    files.bodies = vec![other.clone()];
    let error = Scene::load(&files).unwrap_err();
    let SceneError::OtherTopology { problem, .. } = error else {
        panic!("{error}");
    };
    assert!(
        matches!(problem, SceneProblem::VertexCount { .. }),
        "{problem}"
    );

    files.rig = None;
    let error = Scene::load(&files).unwrap_err();
    assert!(matches!(error, SceneError::NoRig { .. }), "{error}");
    assert_eq!(
        error.to_string(),
        format!("there is no rig for `{}`", other.display())
    );
}

#[test]
fn meshes_of_rigs_are_read_as_obj() {
    let folder = tempfile::tempdir().unwrap();
    files(folder.path(), &shirt());
    let path = folder.path().join("body.rig.npz");
    assert!(is_rig(&path) && !is_rig(Path::new("body.obj")));
    let of_rig = read_mesh(&path).unwrap();
    let of_obj = ObjFile::read(folder.path().join("body.obj")).unwrap();
    assert_eq!(of_rig.source(), of_obj.source());
    assert_eq!(of_rig.path(), path);
}

#[test]
fn a_rest_body_in_another_pose_than_its_rig_is_told_and_posed_from_that_of_the_rig() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = files(folder.path(), &shirt());
    let mut bend = Pose::rest(2);
    bend.rotations[1] = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.4);
    let bent = body().posed_positions(&bend, Method::Linear).unwrap();
    write_obj(
        folder.path().join("bent.obj"),
        &body().rest().with_positions(bent.clone()).unwrap(),
    )
    .unwrap();
    files.rest_body = Some(folder.path().join("bent.obj"));
    files.rig = Some(folder.path().join("body.rig.npz"));
    files.bodies = Vec::new();
    let turn = r#"{"joints": {"chest": [0, 0, 0, 1]}}"#;
    std::fs::write(folder.path().join("rest.json"), turn).unwrap();
    files.pose = Some(folder.path().join("rest.json").to_str().unwrap().into());
    let scene = Scene::load(&files).unwrap();
    let told = scene
        .notes
        .iter()
        .any(|note| note.to_string().contains("in another pose than its rig"));
    assert!(told, "{:?}", scene.notes);
    // The garment lies on the bent body, and the pose of no turns is that of the rig.
    for (found, expected) in scene.body.rest().positions().iter().zip(&bent) {
        assert!((found - expected).norm() < ROUNDING);
    }
    let posed = scene.targets[0].posed(&scene.body).unwrap();
    for (found, expected) in posed
        .skin()
        .positions()
        .iter()
        .zip(body().rest().positions())
    {
        assert!((found - expected).norm() < 1e-3, "{found} {expected}");
    }
}

#[test]
fn joints_go_along_with_a_rest_body_of_another_size() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = files(folder.path(), &shirt());
    let grown = changed(body().rest(), |point| {
        Point3::new(1.1 * point.x, 1.2 * point.y, 1.1 * point.z)
    });
    write_obj(folder.path().join("grown.obj"), &grown).unwrap();
    files.rest_body = Some(folder.path().join("grown.obj"));
    files.rig = Some(folder.path().join("body.rig.npz"));
    let scene = Scene::load(&files).unwrap();
    let told = |note: &PoseNote| note.to_string().contains("another shape than its rig");
    assert_eq!(scene.notes.iter().filter(|note| told(note)).count(), 1);
    let heights = |body: &Body| -> Vec<f32> {
        let joints = body.skeleton().joints().iter();
        joints.map(|joint| joint.rest_position.y).collect()
    };
    for (found, rig) in heights(&scene.body).iter().zip(heights(&body())) {
        assert!((found - 1.2 * rig).abs() < 0.02, "{found} of {rig}");
    }
    // The same body is left as it is, and nothing is told.
    files.rest_body = Some(folder.path().join("body.obj"));
    let scene = Scene::load(&files).unwrap();
    assert!(!scene.notes.iter().any(told));
    assert_eq!(heights(&scene.body), heights(&body()));
}

#[test]
fn vertices_that_an_exporter_numbered_anew_are_matched_by_their_places() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = files(folder.path(), &shirt());
    let whole = body();
    let count = whole.rest().num_vertices();
    // 97 has no factor in common with the number of vertices.
    assert_ne!(count % 97, 0);
    let mut renumbered = vec![0_u32; count];
    for (place, old) in (0..count).map(|place| (place, place * 97 % count)) {
        renumbered[old] = place as u32;
    }
    let mixed = |mesh: &TriMesh| {
        let positions = (0..count).map(|place| mesh.positions()[place * 97 % count]);
        let faces = mesh.faces().iter();
        let faces = faces.map(|face| face.map(|vertex| renumbered[vertex as usize]));
        TriMesh::new(positions.collect(), faces.collect()).unwrap()
    };
    let mut bend = Pose::rest(2);
    bend.rotations[1] = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.4);
    let bent = whole.posed_positions(&bend, Method::Linear).unwrap();
    let bent = whole.rest().with_positions(bent).unwrap();
    write_obj(folder.path().join("mixed.obj"), &mixed(whole.rest())).unwrap();
    write_obj(folder.path().join("bent.obj"), &bent).unwrap();
    files.rig = Some(folder.path().join("body.rig.npz"));
    files.rest_body = Some(folder.path().join("mixed.obj"));
    // The posed body has the order of the rig, and then that of the rest body.
    for posed in [bent.clone(), mixed(&bent)] {
        write_obj(folder.path().join("bent.obj"), &posed).unwrap();
        files.bodies = vec![folder.path().join("bent.obj")];
        let scene = Scene::load(&files).unwrap();
        let TargetSource::Vertices(found) = &scene.targets[0].source else {
            panic!("a mesh is where its vertices are");
        };
        for (found, expected) in found.iter().zip(mixed(&bent).positions()) {
            assert!((found - expected).norm() < ROUNDING, "{found} {expected}");
        }
    }
}

/// The rig of a body whose faces have vertices of their own, in reversed order.
fn split(body: &Body) -> Rig {
    let mesh = body.rest();
    let corners = mesh.faces().as_flattened().iter().rev();
    let corners: Vec<usize> = corners.map(|&vertex| vertex as usize).collect();
    let positions = corners.iter().map(|&vertex| mesh.positions()[vertex]);
    let positions = positions.collect();
    let faces = (0..corners.len() as u32 / 3).map(|face| [3 * face + 2, 3 * face + 1, 3 * face]);
    let rows = corners.iter().map(|&vertex| body.weights().vertex(vertex));
    Rig {
        rest: Some(TriMesh::new(positions, faces.collect()).unwrap()),
        weights: SkinWeights::from_influences(2, rows).unwrap(),
        ..Rig::from(body.clone())
    }
}

#[test]
fn vertices_that_an_exporter_split_are_matched_by_their_places() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = files(folder.path(), &shirt());
    let whole = body();
    let split = split(&whole);
    write_rig_npz(folder.path().join("split.rig.npz"), &split).unwrap();
    let mut bend = Pose::rest(2);
    bend.rotations[1] = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.4);
    let bent = body().posed_positions(&bend, Method::Linear).unwrap();
    let bent = body().rest().with_positions(bent).unwrap();
    write_obj(folder.path().join("bent.obj"), &bent).unwrap();
    files.rig = Some(folder.path().join("split.rig.npz"));
    files.rest_body = Some(folder.path().join("body.obj"));
    files.bodies = vec![folder.path().join("bent.obj")];
    let scene = Scene::load(&files).unwrap();
    assert_eq!(
        scene.body.rest().num_vertices(),
        whole.rest().num_vertices()
    );
    let TargetSource::Vertices(found) = &scene.targets[0].source else {
        panic!("a mesh is where its vertices are");
    };
    assert_eq!(found.len(), whole.rest().num_vertices());
    // The other way round: the rig has the vertices of the OBJ, and the body is split.
    files.rig = Some(folder.path().join("body.rig.npz"));
    files.bodies = vec![folder.path().join("split.rig.npz")];
    let scene = Scene::load(&files).unwrap();
    let posed = scene.targets[0].posed(&scene.body).unwrap();
    for (found, expected) in posed
        .skin()
        .positions()
        .iter()
        .zip(whole.rest().positions())
    {
        assert!((found - expected).norm() < ROUNDING);
    }
}

#[test]
fn a_rest_body_in_another_pose_than_a_split_rig_is_matched_by_its_faces() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = files(folder.path(), &shirt());
    write_rig_npz(folder.path().join("split.rig.npz"), &split(&body())).unwrap();
    let bent = |angle: f32| {
        let mut bend = Pose::rest(2);
        bend.rotations[1] = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        let places = body().posed_positions(&bend, Method::Linear).unwrap();
        body().rest().with_positions(places).unwrap()
    };
    write_obj(folder.path().join("rest.obj"), &bent(0.4)).unwrap();
    write_obj(folder.path().join("posed.obj"), &bent(-0.3)).unwrap();
    files.rig = Some(folder.path().join("split.rig.npz"));
    files.rest_body = Some(folder.path().join("rest.obj"));
    files.bodies = vec![folder.path().join("posed.obj")];
    let scene = Scene::load(&files).unwrap();
    let is_told = |note: &PoseNote| note.to_string().contains("in another pose than its rig");
    assert!(scene.notes.iter().any(is_told), "{:?}", scene.notes);
    let pairs = scene.body.rest().positions().iter();
    for (found, expected) in pairs.zip(bent(0.4).positions()) {
        assert!((found - expected).norm() < ROUNDING);
    }
    let joints = scene.body.skeleton().joints().iter();
    for (found, expected) in joints.zip(body().skeleton().joints()) {
        // The pose is about the hip, and was recovered.
        assert!((found.rest_position - expected.rest_position).norm() < 0.02);
    }
    // Without the rest body, a posed one is matched with the rig itself.
    files.rest_body = None;
    let scene = Scene::load(&files).unwrap();
    let posed = scene.targets[0].posed(&scene.body).unwrap();
    let places = posed.skin().positions();
    let expected = bent(-0.3);
    let corners = body().rest().faces().as_flattened().to_vec();
    for (found, &corner) in places.iter().zip(corners.iter().rev()) {
        assert!((found - expected.positions()[corner as usize]).norm() < 2e-3);
    }
}
