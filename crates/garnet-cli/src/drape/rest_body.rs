//! The rest body: mesh, skeleton and weights in metres, in the pose that garments lie on.

use std::path::Path;

use anyhow::Context;
use garnet::{
    Body, Bounds, Isometry3, Joint, Kinship, Method, Point3, Pose, Quaternion, Rig, Skeleton,
    TriMesh, Unit, UnitQuaternion, UpAxis, Vector3, kinship,
};

use super::{
    frame::{Frame, detected_up, name, shorter},
    rest_mesh::{Frames, RestMesh, other_topology},
};
use crate::failure::Hint;

/// The rest body, and the body in the pose zero of the rig if garments lie on it in another.
#[derive(Debug)]
pub(crate) struct RestBodies {
    pub(crate) rest: Body,
    pub(crate) zero: Option<Zero>,
}

/// A body in the pose zero of its rig, and the way from there to the rest body.
#[derive(Debug)]
pub(crate) struct Zero {
    pub(crate) body: Body,
    pub(crate) rest_from_zero: Vec<Isometry3<f32>>,
}

pub(crate) fn rest_body_of(
    rig: Rig,
    taken: &RestMesh,
    frames: &Frames,
    rig_path: &Path,
) -> anyhow::Result<RestBodies> {
    let fits = || does_not_fit(rig_path, &taken.path);
    let mut rig_frame = frames.rig;
    let mut zero_mesh = None;
    if let Some(mesh) = &rig.rest {
        if taken.is_obj && mesh.num_vertices() == taken.mesh.num_vertices() {
            let kin = kinship(taken.mesh.positions(), mesh.positions(), mesh.faces());
            let Kinship::Scaled { decades } = kin else {
                return Err(other_topology(
                    &taken.path,
                    format!(
                        "its vertices are in another order than in `{}`",
                        rig_path.display()
                    ),
                ));
            };
            rig_frame = Frame {
                unit: shorter(frames.rest.unit, decades).unwrap_or(Unit::Metre),
                up: detected_up(mesh),
            };
        }
        zero_mesh = Some(in_metres(mesh.clone(), rig_frame)?);
    } else {
        rig_frame = Frame::OURS;
    }
    let skeleton = placed(&rig.skeleton, rig_frame).with_context(fits)?;
    let mesh = in_metres(taken.mesh.clone(), frames.rest)?;
    check_joints(&skeleton, &mesh).with_context(fits)?;
    let rest_pose = rig.rest_pose.map(|pose| turned(&pose, rig_frame));
    if let (Some(pose), Some(zero_mesh)) = (rest_pose, zero_mesh) {
        let zero = Body::new(zero_mesh, skeleton.clone(), rig.weights.clone());
        let zero = zero.with_context(fits)?;
        let rest_from_zero = zero.skeleton().transforms(&pose).with_context(fits)?;
        let positions = zero.transformed_positions(&rest_from_zero, Method::Linear);
        let is_zero = largest_distance(mesh.positions(), zero.rest().positions())
            < largest_distance(mesh.positions(), &positions);
        if !(taken.is_obj && is_zero) {
            let mesh = if taken.is_obj {
                mesh
            } else {
                mesh.with_positions(positions)?
            };
            let skeleton = moved(&skeleton, &rest_from_zero).with_context(fits)?;
            let rest = Body::new(mesh, skeleton, rig.weights).with_context(fits)?;
            return Ok(RestBodies {
                rest,
                zero: Some(Zero {
                    body: zero,
                    rest_from_zero,
                }),
            });
        }
    }
    let rest = Body::new(mesh, skeleton, rig.weights).with_context(fits)?;
    Ok(RestBodies { rest, zero: None })
}

pub(crate) fn does_not_fit(rig: &Path, rest: &Path) -> String {
    format!(
        "the rig `{}` does not fit the rest body `{}`",
        rig.display(),
        rest.display()
    )
}

/// Joints are as far as this outside the box of their body at most, over the size of the box: those at the tips of hands and feet.
const JOINT_MARGIN: f32 = 0.1;

/// Refuses a skeleton most of which lies outside the body: rig and mesh are in two places, or of two sizes.
fn check_joints(skeleton: &Skeleton, mesh: &TriMesh) -> anyhow::Result<()> {
    let Some(Bounds { min, max }) = Bounds::of_faces(mesh.positions(), mesh.faces()) else {
        return Ok(());
    };
    let margin = Vector3::repeat(JOINT_MARGIN * (max - min).norm());
    let (low, high) = (min - margin, max + margin);
    let is_outside = |joint: &&Joint| {
        let place = joint.rest_position;
        (0..3).any(|axis| !(low[axis]..=high[axis]).contains(&place[axis]))
    };
    let joints = skeleton.joints();
    let num_outside = joints.iter().filter(is_outside).count();
    if 2 * num_outside <= joints.len() {
        return Ok(());
    }
    let cause = format!(
        "{num_outside} of its {} joints lie outside the body",
        joints.len()
    );
    Err(anyhow::anyhow!(cause)).hint(|| {
        "export rig and rest body from one scene, in one place and unit, or name the unit with `--units`".to_owned()
    })
}

/// A skeleton in metres with y up.
fn placed(skeleton: &Skeleton, frame: Frame) -> Result<Skeleton, garnet::SkinError> {
    if frame == Frame::OURS {
        return Ok(skeleton.clone());
    }
    let joint = |joint: &Joint| Joint {
        rest_position: frame.point_to_metres(&joint.rest_position),
        ..joint.clone()
    };
    Skeleton::new(skeleton.joints().iter().map(joint).collect())
}

/// A skeleton whose joints were moved.
fn moved(
    skeleton: &Skeleton,
    transforms: &[Isometry3<f32>],
) -> Result<Skeleton, garnet::SkinError> {
    let joints = skeleton.joints().iter().zip(transforms);
    let joint = |(joint, transform): (&Joint, &Isometry3<f32>)| Joint {
        rest_position: transform * joint.rest_position,
        ..joint.clone()
    };
    Skeleton::new(joints.map(joint).collect())
}

/// A pose in metres with y up.
fn turned(pose: &Pose, frame: Frame) -> Pose {
    if frame.up == UpAxis::Y && frame.unit == Unit::Metre {
        return pose.clone();
    }
    let shift = frame.point_to_metres(&pose.root_translation.into());
    let turn = |rotation: &UnitQuaternion<f32>| match frame.up {
        UpAxis::Y => *rotation,
        UpAxis::Z => UnitQuaternion::new_unchecked(Quaternion::new(
            rotation.w,
            rotation.i,
            rotation.k,
            -rotation.j,
        )),
    };
    Pose {
        root_translation: Vector3::from(shift.coords),
        rotations: pose.rotations.iter().map(turn).collect(),
    }
}

pub(crate) fn largest_distance<'a>(
    a: impl IntoIterator<Item = &'a Point3>,
    b: impl IntoIterator<Item = &'a Point3>,
) -> f32 {
    let distances = a.into_iter().zip(b).map(|(a, b)| (a - b).norm());
    distances.fold(0.0, f32::max)
}

pub(crate) fn in_metres(mesh: TriMesh, frame: Frame) -> anyhow::Result<TriMesh> {
    if frame == Frame::OURS {
        return Ok(mesh);
    }
    let (positions, faces) = mesh.into_parts();
    TriMesh::new(frame.to_metres(positions), faces).hint(|| {
        format!(
            "it was read in {}; `--units` overrides this",
            name(frame.unit)
        )
    })
}
