//! No mesh makes the library panic.

use garnet::{
    Body, Draper, Garment, Joint, Point3, Pose, Skeleton, SkinWeights, TriMesh,
    mesh::MAX_COORDINATE,
};
use garnet::{UnitQuaternion, Vector3};
use garnet_tests::capsules::{arm, bent};
use proptest::prelude::*;

/// Meshes with faces without area, doubled and unused vertices, at any scale.
fn garbage() -> impl Strategy<Value = TriMesh> {
    let coordinate = prop_oneof![
        4 => -1.0_f32..1.0,
        1 => prop_oneof![Just(0.0), Just(-0.0), Just(0.5), Just(1e-30), Just(1e9), Just(-3e18)],
    ];
    let scale = prop_oneof![6 => Just(1.0_f32), 1 => Just(1e-6), 1 => Just(1e6), 1 => Just(1e-38)];
    let positions =
        prop::collection::vec([coordinate.clone(), coordinate.clone(), coordinate], 1..40);
    (positions, scale, any::<bool>()).prop_flat_map(|(positions, scale, is_moderate)| {
        let count = positions.len() as u32;
        let limit = if is_moderate { 1.0 } else { MAX_COORDINATE };
        let place = move |value: f32| (value * scale).clamp(-limit, limit);
        let positions: Vec<Point3> = positions.into_iter().map(|p| p.map(place).into()).collect();
        let faces = prop::collection::vec([0..count, 0..count, 0..count], 1..60);
        faces.prop_map(move |faces| TriMesh::new(positions.clone(), faces).unwrap())
    })
}

/// Binds and drapes; an error is as good as a drape, whose positions must then be numbers.
fn draped(garment: TriMesh, body: &Body, pose: &Pose) {
    let Ok(bound) = Garment::new(garment).bind(body) else {
        return;
    };
    let Ok(posed) = body.posed(pose) else { return };
    if let Ok(drape) = Draper::new(bound).drape(&posed) {
        let mut values = drape.positions.iter().flat_map(|p| p.iter());
        assert!(values.all(|value| value.is_finite()));
    }
}

/// A body of any mesh, with two joints in it.
fn body_of(mesh: TriMesh) -> Body {
    let bounds = garnet::mesh::Bounds::of(mesh.positions()).unwrap();
    let joint = |name: &str, parent, share: f32| Joint {
        name: name.to_owned(),
        parent,
        rest_position: bounds.center() + Vector3::y() * (share * bounds.diagonal()),
    };
    let joints = vec![joint("root", None, 0.0), joint("tip", Some(0), 0.3)];
    let rows = (0..mesh.num_vertices()).map(|v| [(v % 2, 0.7), (1 - v % 2, 0.3)]);
    let weights = SkinWeights::from_influences(2, rows).unwrap();
    Body::new(mesh, Skeleton::new(joints).unwrap(), weights).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn no_garment_makes_a_drape_panic(garment in garbage(), angle in -3.0_f32..3.0) {
        draped(garment, &arm(), &bent(angle));
    }

    #[test]
    fn no_body_makes_a_drape_panic(mesh in garbage(), angle in -3.0_f32..3.0) {
        let mut pose = Pose::rest(2);
        pose.rotations[1] = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        let body = body_of(mesh);
        draped(body.rest().clone(), &body, &pose);
        let bounds = garnet::mesh::Bounds::of(body.rest().positions()).unwrap();
        if let Ok(garment) = garnet::mesh::primitives::tube(0.1, 0.4, 8, 6).with_positions(
            garnet::mesh::primitives::tube(0.1, 0.4, 8, 6)
                .positions()
                .iter()
                .map(|p| bounds.center() + p.coords)
                .collect(),
        ) {
            draped(garment, &body, &pose);
        }
    }

    #[test]
    fn no_target_makes_a_fit_panic(
        mesh in garbage(),
        target in garbage(),
        scale in prop_oneof![3 => Just(1.0_f32), 1 => Just(1e12)],
    ) {
        let body = body_of(mesh);
        let positions = target.positions().iter().cycle().take(body.rest().num_vertices());
        let positions: Vec<Point3> = positions.map(|p| p * scale).collect();
        if let (Ok(posed), Ok(bound)) =
            (body.fitted(&positions), Garment::new(body.rest().clone()).bind(&body))
        {
            let _either = Draper::new(bound).drape(&posed);
        }
    }
}
