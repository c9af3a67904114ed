//! Small bodies made of capsules: an arm, and a figure whose parts run through each other.

use garnet::{
    Body, Joint, Point3, Pose, Skeleton, SkinWeights, TriMesh, UnitQuaternion, Vector3,
    mesh::primitives,
};

/// An arm of two bones of 30 cm along y, 5 cm thick, with the elbow at the origin.
///
/// # Panics
///
/// Never: the parts fit together.
pub fn arm() -> Body {
    let mesh = primitives::capsule(0.05, 0.6, 24, 24);
    let forearm = |p: &Point3| (0.5 + p.y / 0.1).clamp(0.0, 1.0);
    let rows = mesh.positions().iter();
    let rows = rows.map(|p| [(0, 1.0 - forearm(p)), (1, forearm(p))]);
    let weights = SkinWeights::from_influences(2, rows).expect("weights of a vertex sum to 1");
    let joints = vec![
        joint("shoulder", None, [0.0, -0.3, 0.0]),
        joint("elbow", Some(0), [0.0; 3]),
    ];
    let skeleton = Skeleton::new(joints).expect("two joints make a tree");
    Body::new(mesh, skeleton, weights).expect("weights were made for this mesh")
}

/// The pose of [`arm`] with the elbow bent by an angle in radians.
pub fn bent(angle: f32) -> Pose {
    let mut pose = Pose::rest(2);
    pose.rotations[1] = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
    pose
}

/// Joints of the [`figure`].
pub const FIGURE_JOINTS: [&str; 7] = [
    "trunk",
    "left_shoulder",
    "left_elbow",
    "right_shoulder",
    "right_elbow",
    "left_hip",
    "right_hip",
];

/// A figure of five capsules in one mesh: a trunk, two arms spread to the sides, two legs.
///
/// Arms and legs begin inside the trunk, so the mesh runs through itself, as real bodies do.
///
/// # Panics
///
/// Never: the parts fit together.
pub fn figure() -> Body {
    let shoulder = Vector3::new(0.14, 1.3, 0.0);
    let elbow = shoulder + Vector3::new(0.28, 0.0, 0.0);
    let hip = Vector3::new(0.09, 0.85, 0.0);
    let mut parts = Parts::default();
    parts.add(
        0.15,
        0.42,
        Vector3::new(0.0, 1.1, 0.0),
        Vector3::y(),
        |_| vec![(0, 1.0)],
    );
    for side in [1.0, -1.0] {
        let first = if side > 0.0 { 1 } else { 3 };
        let center = Vector3::new(side * (shoulder.x + 0.27), shoulder.y, 0.0);
        parts.add(0.045, 0.54, center, side * Vector3::x(), |point| {
            let forearm = (0.5 + (side * point.x - elbow.x) / 0.08).clamp(0.0, 1.0);
            vec![(first, 1.0 - forearm), (first + 1, forearm)]
        });
        let joint = if side > 0.0 { 5 } else { 6 };
        let center = Vector3::new(side * hip.x, 0.45, 0.0);
        parts.add(0.075, 0.72, center, -Vector3::y(), |_| vec![(joint, 1.0)]);
    }
    let mirrored = |v: Vector3| [-v.x, v.y, v.z];
    let joints = vec![
        joint(FIGURE_JOINTS[0], None, [0.0, 0.95, 0.0]),
        joint(FIGURE_JOINTS[1], Some(0), shoulder.into()),
        joint(FIGURE_JOINTS[2], Some(1), elbow.into()),
        joint(FIGURE_JOINTS[3], Some(0), mirrored(shoulder)),
        joint(FIGURE_JOINTS[4], Some(3), mirrored(elbow)),
        joint(FIGURE_JOINTS[5], Some(0), hip.into()),
        joint(FIGURE_JOINTS[6], Some(0), mirrored(hip)),
    ];
    let skeleton = Skeleton::new(joints).expect("the joints make a tree");
    let weights = SkinWeights::from_influences(7, parts.weights).expect("weights sum to 1");
    let mesh = TriMesh::new(parts.positions, parts.faces).expect("capsules are finite");
    Body::new(mesh, skeleton, weights).expect("weights were made for this mesh")
}

/// The pose of the [`figure`] with both arms lowered from the horizontal by an angle in radians.
pub fn lowered(angle: f32) -> Pose {
    let mut pose = Pose::rest(FIGURE_JOINTS.len());
    for (joint, sign) in [(1, -1.0), (3, 1.0)] {
        pose.rotations[joint] = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), sign * angle);
    }
    pose
}

/// The pose of the [`figure`] with one leg forward and one back, by an angle in radians each.
pub fn step(angle: f32) -> Pose {
    let mut pose = lowered(0.6);
    for (joint, sign) in [(5, -1.0), (6, 1.0)] {
        pose.rotations[joint] = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), sign * angle);
    }
    pose
}

/// A shirt for the [`figure`]: a tube around the trunk, without sleeves, from hip to armpit.
pub fn shirt() -> TriMesh {
    moved(&primitives::tube(0.165, 0.36, 48, 20), [0.0, 1.02, 0.0])
}

/// A skirt for the [`figure`]: a cone from the waist to the knees.
pub fn skirt() -> TriMesh {
    moved(
        &primitives::cone_skirt([0.27, 0.165], 0.5, 56, 28),
        [0.0, 0.77, 0.0],
    )
}

/// A sleeve for the left upper arm and elbow of the [`figure`].
///
/// # Panics
///
/// Never: the positions are finite.
pub fn sleeve() -> TriMesh {
    let tube = primitives::tube(0.058, 0.3, 28, 24);
    let turned = tube
        .positions()
        .iter()
        .map(|p| Point3::new(0.44 + p.y, 1.3 - p.x, p.z));
    tube.with_positions(turned.collect())
        .expect("turned positions are finite")
}

/// The mesh, shifted by metres.
///
/// # Panics
///
/// If the shift is not finite.
pub fn moved(mesh: &TriMesh, shift: [f32; 3]) -> TriMesh {
    let shift = Vector3::from(shift);
    let positions = mesh.positions().iter().map(|p| p + shift).collect();
    mesh.with_positions(positions)
        .expect("shifted positions are finite")
}

/// Two meshes in one, the vertices of the second after those of the first.
///
/// # Panics
///
/// Never: both are meshes.
pub fn joined(first: &TriMesh, second: &TriMesh) -> TriMesh {
    let offset = first.num_vertices() as u32;
    let positions = [first.positions(), second.positions()].concat();
    let mut faces = first.faces().to_vec();
    faces.extend(second.faces().iter().map(|face| face.map(|v| v + offset)));
    TriMesh::new(positions, faces).expect("both were meshes")
}

fn joint(name: &str, parent: Option<usize>, position: [f32; 3]) -> Joint {
    Joint {
        name: name.to_owned(),
        parent,
        rest_position: position.into(),
    }
}

#[derive(Default)]
struct Parts {
    positions: Vec<Point3>,
    faces: Vec<[u32; 3]>,
    weights: Vec<Vec<(usize, f32)>>,
}

impl Parts {
    /// Adds a capsule along `axis` around `center`, with weights by place.
    fn add(
        &mut self,
        radius: f32,
        length: f32,
        center: Vector3,
        axis: Vector3,
        weights: impl Fn(&Point3) -> Vec<(usize, f32)>,
    ) {
        let capsule = primitives::capsule(radius, length, 28, 14);
        let turn = UnitQuaternion::rotation_between(&Vector3::y(), &axis).unwrap_or_else(|| {
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f32::consts::PI)
        });
        let offset = self.positions.len() as u32;
        for point in capsule.positions() {
            let point = turn * point + center;
            self.weights.push(weights(&point));
            self.positions.push(point);
        }
        self.faces
            .extend(capsule.faces().iter().map(|face| face.map(|v| v + offset)));
    }
}
