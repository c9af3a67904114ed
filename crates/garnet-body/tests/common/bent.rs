//! What bending does to an elbow or a knee.

use std::error::Error;

use garnet_body::poses::{BodyAngles, Poser};
use garnet_skin::{Body, Method, Point3, Vector3};

/// Vertices this close to the plane through the joint are its ring, in metres.
const RING_WIDTH: f32 = 0.012;

/// And on the outer side these count too.
const OUTER_WIDTH: f32 = 0.06;

/// And they follow the two bones by at least this much.
const MIN_WEIGHT: f32 = 0.9;

/// A joint between two bones of a limb of the left side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Hinge {
    /// Upper arm and forearm.
    Elbow,
    /// Thigh and shank.
    Knee,
}

impl Hinge {
    /// Both.
    pub(crate) const ALL: [Self; 2] = [Self::Elbow, Self::Knee];

    fn joints(self) -> [&'static str; 3] {
        match self {
            Self::Elbow => ["left_shoulder", "left_elbow", "left_wrist"],
            Self::Knee => ["left_hip", "left_knee", "left_ankle"],
        }
    }

    fn angles(self, degrees: f64) -> BodyAngles {
        let mut angles = BodyAngles::default();
        match self {
            Self::Elbow => angles.arms[0].elbow = degrees,
            Self::Knee => angles.legs[0].knee = degrees,
        }
        angles
    }
}

/// How much the radius of a bent limb differs from rest near the joint.
///
/// The ring at the joint is every vertex within 12 mm, at rest, of the plane through the joint that
/// halves the angle of the two bones; its radius is the distance from the joint in that plane. On
/// the outer side every vertex within 60 mm counts too, with its distance from the nearer of the
/// two bones. The same vertices are compared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct BentRing {
    /// The largest growth of a radius, relative.
    pub(crate) bulge: f32,
    /// The largest loss of a radius of the ring on the side of the fold, relative.
    pub(crate) fold_collapse: f32,
    /// The largest loss of a radius on the outer side, relative.
    pub(crate) outer_collapse: f32,
}

/// Frame of a bent limb: its joints, the normal of the halving plane, and the outer side.
struct Bend {
    joints: [Point3; 3],
    normal: Vector3,
    outward: Vector3,
}

impl Bend {
    fn new([upper, joint, lower]: [Point3; 3]) -> Self {
        let arriving = (joint - upper).normalize();
        let leaving = (lower - joint).normalize();
        Self {
            joints: [upper, joint, lower],
            normal: (arriving + leaving).normalize(),
            outward: arriving - leaving,
        }
    }

    /// Distance from the plane, radius, and whether it is on the outer side.
    fn place(&self, point: &Point3) -> (f32, f32, bool) {
        let offset = point - self.joints[1];
        let along = offset.dot(&self.normal);
        let across = offset - along * self.normal;
        (along, across.norm(), across.dot(&self.outward) > 0.0)
    }

    /// Distance from the nearer bone.
    fn distance(&self, point: &Point3) -> f32 {
        let [upper, joint, lower] = self.joints;
        let distance = |start: Point3, end: Point3| {
            let bone = end - start;
            let place = (point - start).dot(&bone) / bone.norm_squared();
            (point - (start + place.clamp(0.0, 1.0) * bone)).norm()
        };
        distance(upper, joint).min(distance(joint, lower))
    }
}

/// Bends a limb of a body with the built-in joint names by so many degrees from straight, and
/// measures its ring.
///
/// # Errors
///
/// A body that has not those joints.
pub(crate) fn bent_ring(
    body: &Body,
    hinge: Hinge,
    degrees: f64,
) -> Result<BentRing, Box<dyn Error>> {
    let skeleton = body.skeleton();
    let mut joints = [0; 3];
    for (joint, name) in joints.iter_mut().zip(hinge.joints()) {
        *joint = skeleton
            .find(name)
            .ok_or_else(|| format!("the body has no joint `{name}`"))?;
    }
    let pose = Poser::new(skeleton)?.pose(&hinge.angles(degrees));
    let transforms = skeleton.transforms(&pose)?;
    let rest_of = |joint: usize| skeleton.joints()[joint].rest_position;
    let rest = Bend::new(joints.map(rest_of));
    let bent = Bend::new(joints.map(|joint| transforms[joint] * rest_of(joint)));
    let posed = body.posed_positions(&pose, Method::DualQuaternion)?;
    let mut ring = BentRing::default();
    for (vertex, (old, new)) in body.rest().positions().iter().zip(&posed).enumerate() {
        let of_limb = body.weights().vertex(vertex);
        let weight: f32 = of_limb
            .filter(|(joint, _)| joints[..2].contains(joint))
            .map(|(_, weight)| weight)
            .sum();
        let (along, radius, _) = rest.place(old);
        if weight < MIN_WEIGHT || along.abs() > OUTER_WIDTH {
            continue;
        }
        let (_, new_radius, is_outer) = bent.place(new);
        let of_ring = (along.abs() < RING_WIDTH).then(|| new_radius / radius - 1.0);
        let of_bones = is_outer.then(|| bent.distance(new) / rest.distance(old) - 1.0);
        for growth in of_ring.into_iter().chain(of_bones) {
            ring.bulge = ring.bulge.max(growth);
            let collapse = if is_outer {
                &mut ring.outer_collapse
            } else {
                &mut ring.fold_collapse
            };
            *collapse = collapse.max(-growth);
        }
    }
    Ok(ring)
}
