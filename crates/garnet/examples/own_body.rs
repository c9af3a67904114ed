//! A body of one's own: a mesh, a skeleton and weights, and a garment that lies on it.
//!
//! `cargo run --example own_body -- OUT.obj`

use std::error::Error;

use garnet::mesh::primitives::{capsule, tube};
use garnet::{
    Body, Draper, Garment, Joint, Point3, Pose, Skeleton, SkinWeights, UnitQuaternion, Vector3, io,
};

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "sleeve.obj".into());
    // An arm of two bones along y, in metres.
    let arm = capsule(0.05, 0.6, 24, 24);
    let joint = |name: &str, parent, y| Joint {
        name: name.to_owned(),
        parent,
        rest_position: Point3::new(0.0, y, 0.0),
    };
    let joints = vec![joint("shoulder", None, -0.3), joint("elbow", Some(0), 0.0)];
    let forearm = |p: &Point3| (0.5 + p.y / 0.1).clamp(0.0, 1.0);
    let rows = (arm.positions().iter()).map(|p| [(0, 1.0 - forearm(p)), (1, forearm(p))]);
    let weights = SkinWeights::from_influences(2, rows)?;
    let body = Body::new(arm, Skeleton::new(joints)?, weights)?;

    let draper = Draper::new(Garment::new(tube(0.06, 0.4, 32, 30)).bind(&body)?);
    let mut pose = Pose::rest(2);
    pose.rotations[1] = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 1.2);
    let drape = draper.drape(&body.posed(&pose)?)?;
    let mesh = draper.garment().mesh().with_positions(drape.positions)?;
    io::write_obj(out, &mesh)?;
    Ok(())
}
