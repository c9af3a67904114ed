use garnet_mesh::TriMesh;
use nalgebra::UnitQuaternion;
use proptest::prelude::*;

use super::*;
use crate::{Joint, Skeleton, SkinWeights, Vector3};

/// A tube along y with `num_joints` joints, one every 0.3 m, and weights that blend between them.
fn tube(num_joints: usize) -> Body {
    let length = 0.3 * num_joints as f32;
    let (rings, sides) = (12 * num_joints, 12);
    let mut positions = Vec::new();
    let mut influences = Vec::new();
    for ring in 0..=rings {
        let y = length * ring as f32 / rings as f32;
        for side in 0..sides {
            let angle = std::f32::consts::TAU * side as f32 / sides as f32;
            positions.push(Point3::new(0.06 * angle.cos(), y, 0.08 * angle.sin()));
            let joint = (ring / 12).min(num_joints - 1);
            let share = ((y - 0.3 * joint as f32) / 0.1 + 0.5).clamp(0.0, 1.0);
            let parent = joint.saturating_sub(1);
            influences.push([(joint, share), (parent, 1.0 - share)]);
        }
    }
    let mut faces = Vec::new();
    for ring in 0..rings {
        for side in 0..sides {
            let [a, b] =
                [ring * sides + side, ring * sides + (side + 1) % sides].map(|index| index as u32);
            let up = sides as u32;
            faces.extend([[a, b, a + up], [b, b + up, a + up]]);
        }
    }
    let joints = (0..num_joints).map(|index| Joint {
        name: format!("joint_{index}"),
        parent: index.checked_sub(1),
        rest_position: Point3::new(0.0, 0.3 * index as f32, 0.0),
    });
    let skeleton = Skeleton::new(joints.collect()).unwrap();
    let weights = SkinWeights::from_influences(num_joints, influences).unwrap();
    Body::new(TriMesh::new(positions, faces).unwrap(), skeleton, weights).unwrap()
}

/// The accuracy that is asked of a recovery with known weights, in metres.
const REPRODUCED: f32 = 1e-3;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn the_pose_of_a_skinned_tube_is_found(
        num_joints in 2_usize..6,
        angles in prop::collection::vec(prop::array::uniform3(-0.9_f32..0.9), 5),
        shift in prop::array::uniform3(-2.0_f32..2.0),
        turn in prop::array::uniform3(-3.0_f32..3.0),
        is_linear in any::<bool>(),
    ) {
        let body = tube(num_joints);
        let mut rotations: Vec<_> = angles[..num_joints].iter().map(|&angle| UnitQuaternion::from_scaled_axis(Vector3::from(angle))).collect();
        rotations[0] = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
        let pose = Pose { root_translation: Vector3::from(shift), rotations };
        let method = if is_linear { Method::Linear } else { Method::DualQuaternion };
        let target = body.posed_positions(&pose, method).unwrap();
        let recovered = recover_pose(&body, &target).unwrap();
        prop_assert!(recovered.max_residual_m < REPRODUCED, "{recovered:?}");
        let fit = recovered.pose(&body).unwrap();
        prop_assert!(fit.max_residual_m < 5.0 * REPRODUCED, "joints apart by {}", fit.max_residual_m);
    }

    #[test]
    fn any_target_gives_finite_rigid_transforms(values in prop::collection::vec(-3.0_f32..3.0, 900)) {
        let body = tube(2);
        let target: Vec<Point3> = values.chunks_exact(3).map(|row| Point3::new(row[0], row[1], row[2])).collect();
        prop_assert_eq!(target.len(), body.rest().num_vertices());
        let recovered = recover_pose(&body, &target).unwrap();
        for transform in &recovered.transforms {
            prop_assert!((transform.rotation.coords.norm() - 1.0).abs() < 1e-5);
            prop_assert!(transform.translation.vector.iter().all(|value| value.is_finite()));
        }
    }
}

#[test]
fn a_body_that_has_not_moved_gives_the_rest_pose() {
    let body = tube(3);
    let recovered = recover_pose(&body, body.rest().positions()).unwrap();
    assert!(recovered.max_residual_m < 1e-6);
    for transform in &recovered.transforms {
        assert!(
            transform.rotation.angle() < 1e-3,
            "f32 quaternions resolve 1e-3"
        );
    }
}

#[test]
fn a_joint_without_vertices_follows_its_parent() {
    let body = tube(2);
    let mut joints = body.skeleton().joints().to_vec();
    joints.push(Joint {
        name: "tip".to_owned(),
        parent: Some(1),
        rest_position: Point3::new(0.0, 0.6, 0.0),
    });
    let skeleton = Skeleton::new(joints).unwrap();
    let rows = (0..body.weights().num_vertices()).map(|vertex| body.weights().vertex(vertex));
    let weights = SkinWeights::from_influences(3, rows).unwrap();
    let body = Body::new(body.rest().clone(), skeleton, weights).unwrap();
    let mut pose = Pose::rest(3);
    pose.rotations[1] = UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.0, 0.8));
    let target = body.posed_positions(&pose, Method::Linear).unwrap();
    let recovered = recover_pose(&body, &target).unwrap();
    let fit = recovered.pose(&body).unwrap();
    assert!(recovered.max_residual_m < REPRODUCED);
    assert!(fit.pose.rotations[2].angle() < 0.01);
    assert!(fit.max_residual_m < REPRODUCED);
}

#[test]
fn collapsed_and_wrong_targets_are_survived() {
    let body = tube(3);
    let num_vertices = body.rest().num_vertices();
    let recovered = recover_pose(&body, &vec![Point3::new(1.0, 2.0, 3.0); num_vertices]).unwrap();
    assert!(
        recovered.transforms.iter().all(|transform| transform
            .translation
            .vector
            .norm()
            .is_finite())
    );
    let error = recover_pose(&body, &[]).unwrap_err();
    assert_eq!(
        error,
        SkinError::TargetCount {
            found: 0,
            expected: num_vertices
        }
    );
    let mut target = body.rest().positions().to_vec();
    target[7].z = f32::NAN;
    assert_eq!(
        recover_pose(&body, &target).unwrap_err(),
        SkinError::NonFiniteTarget { vertex: 7 }
    );
}

#[test]
fn the_result_is_the_same_with_any_number_of_threads() {
    let body = tube(5);
    let mut pose = Pose::rest(5);
    pose.rotations[2] = UnitQuaternion::from_scaled_axis(Vector3::new(0.3, 0.2, 0.8));
    let target = body.posed_positions(&pose, Method::DualQuaternion).unwrap();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| recover_pose(&body, &target)).unwrap()
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn vertices_that_no_face_names_tell_nothing_of_the_pose() {
    let body = tube(3);
    let mut pose = Pose::rest(3);
    pose.rotations[1] = UnitQuaternion::from_scaled_axis(Vector3::new(0.7, 0.1, 0.0));
    let posed = body.posed(&pose).unwrap().skin().positions().to_vec();
    let strays = [Point3::new(5.0, -5.0, 5.0), Point3::new(-5.0, 9.0, 5.0)];
    let with = |places: &[Point3]| [places, &strays].concat();
    let mesh = TriMesh::new(with(body.rest().positions()), body.rest().faces().to_vec());
    let rows: Vec<Vec<(usize, f32)>> = (0..body.rest().num_vertices())
        .map(|vertex| body.weights().vertex(vertex).collect())
        .chain([vec![(2, 1.0)], vec![(1, 1.0)]])
        .collect();
    let weights = SkinWeights::from_influences(3, rows).unwrap();
    let more = Body::new(mesh.unwrap(), body.skeleton().clone(), weights).unwrap();
    let expected = recover_pose(&body, &posed).unwrap();
    assert_eq!(recover_pose(&more, &with(&posed)).unwrap(), expected);
    let fitted = more.fitted(&with(&posed)).unwrap();
    assert!(fitted.max_residual() < REPRODUCED);
    assert!(fitted.shape_offsets().is_none());
    let home = fitted.at_home(&more).unwrap();
    assert_eq!(home.body().skin().positions(), fitted.skin().positions());
}
