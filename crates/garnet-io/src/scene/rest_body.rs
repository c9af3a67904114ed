//! The rest body: mesh, skeleton and weights in metres, in the pose that garments lie on.

use std::path::Path;

use garnet_mesh::{Bounds, Kinship, Point3, TriMesh, Unit, UpAxis, Vector3, kinship};
use garnet_skin::{Body, Joint, Method, Pose, PosedBody, Rig, Skeleton, SkinError};
use nalgebra::{Isometry3, Quaternion, UnitQuaternion};

use super::{
    PoseNote, SceneError, SceneProblem,
    frame::{Frame, detected_up, unit_of},
    rest_mesh::{Frames, RestMesh, other_topology},
};

/// The rest body, and the body in the pose zero of the rig if garments lie on it in another.
#[derive(Debug)]
pub(super) struct RestBodies {
    pub(super) rest: Body,
    pub(super) zero: Option<Zero>,
    /// The largest turn of a joint from the rig to the rest body, in degrees, if that pose had to
    /// be recovered.
    posed_by: Option<f32>,
    /// How far the rest body is from the mesh of its rig at most, in metres, if it has another
    /// shape.
    shaped_by: Option<f32>,
}

impl RestBodies {
    /// What was taken for granted of a rest body at `path`.
    pub(super) fn notes(&self, path: &Path, rig: &Path) -> Vec<PoseNote> {
        let posed = self.posed_by.map(|degrees| PoseNote::RestPosed {
            path: path.to_path_buf(),
            rig: rig.to_path_buf(),
            degrees,
        });
        let shaped = self.shaped_by.map(|distance| PoseNote::RestShaped {
            path: path.to_path_buf(),
            rig: rig.to_path_buf(),
            distance,
        });
        posed.into_iter().chain(shaped).collect()
    }
}

/// A body in the pose zero of its rig, and the way from there to the rest body.
#[derive(Debug)]
pub(super) struct Zero {
    pub(super) body: Body,
    pub(super) rest_from_zero: Vec<Isometry3<f32>>,
}

pub(super) fn rest_body_of(
    rig: Rig,
    taken: &RestMesh,
    frames: &Frames,
    rig_path: &Path,
) -> Result<RestBodies, SceneError> {
    let unfit = |problem| unfit(rig_path, &taken.path, problem);
    let of_skin = |error: SkinError| unfit(error.into());
    let mut rig_frame = frames.rig;
    let mut zero_mesh = None;
    if let Some(mesh) = &rig.rest {
        if taken.is_obj && mesh.num_vertices() == taken.mesh.num_vertices() {
            let kin = kinship(taken.mesh.positions(), mesh.positions(), mesh.faces());
            let Kinship::Scaled { ratio } = kin else {
                return Err(other_topology(
                    &taken.path,
                    SceneProblem::VertexOrderOfRig {
                        rig: rig_path.to_path_buf(),
                    },
                ));
            };
            rig_frame = Frame {
                unit: unit_of(frames.rest.unit, ratio).unwrap_or(Unit::Metre),
                up: detected_up(mesh),
            };
        }
        zero_mesh = Some(in_metres(mesh.clone(), rig_frame)?);
    } else {
        rig_frame = Frame::OURS;
    }
    let skeleton = placed(&rig.skeleton, rig_frame).map_err(of_skin)?;
    let mesh = in_metres(taken.mesh.clone(), frames.rest)?;
    check_joints(&skeleton, &mesh).map_err(unfit)?;
    let rest_pose = rig.rest_pose.map(|pose| turned(&pose, rig_frame));
    let rest_mesh = zero_mesh.clone();
    if let (Some(pose), Some(zero_mesh)) = (rest_pose, zero_mesh) {
        let zero = Body::new(zero_mesh, skeleton.clone(), rig.weights.clone());
        let zero = zero.map_err(of_skin)?;
        let rest_from_zero = zero.skeleton().transforms(&pose).map_err(of_skin)?;
        let positions = zero.transformed_positions(&rest_from_zero, Method::Linear);
        let is_zero = largest_distance(mesh.positions(), zero.rest().positions())
            < largest_distance(mesh.positions(), &positions);
        if !(taken.is_obj && is_zero) {
            let mesh = if taken.is_obj {
                mesh
            } else {
                mesh.with_positions(positions.clone())
                    .map_err(|error| unfit(error.into()))?
            };
            return of_shown(zero, rest_from_zero, &positions, mesh).map_err(of_skin);
        }
    }
    if let Some(zero_mesh) = rest_mesh.filter(|_| taken.is_obj) {
        let own = Body::new(zero_mesh, skeleton, rig.weights).map_err(of_skin)?;
        return of_rig(&own, mesh).map_err(of_skin);
    }
    let rest = Body::new(mesh, skeleton, rig.weights).map_err(of_skin)?;
    Ok(RestBodies {
        rest,
        zero: None,
        posed_by: None,
        shaped_by: None,
    })
}

/// The body of a rig that shows a pose, in which its skin is at `positions` `[vertex]`, with the
/// mesh at rest in that pose.
fn of_shown(
    zero: Body,
    rest_from_zero: Vec<Isometry3<f32>>,
    positions: &[Point3],
    mesh: TriMesh,
) -> Result<RestBodies, SkinError> {
    let distance = distance_of_skin(&zero, positions, mesh.positions());
    let is_fit = mesh.num_vertices() == positions.len();
    let shaped_by = (is_fit && distance > SHAPED).then_some(distance);
    let zero = match shaped_by {
        Some(_) => shaped(
            &zero,
            &zero.fitted_by(mesh.positions(), rest_from_zero.clone())?,
        )?,
        None => zero,
    };
    let skeleton = moved(zero.skeleton(), &rest_from_zero)?;
    Ok(RestBodies {
        rest: Body::new(mesh, skeleton, zero.weights().clone())?,
        zero: Some(Zero {
            body: zero,
            rest_from_zero,
        }),
        posed_by: None,
        shaped_by,
    })
}

/// The body of a rig with a mesh of its own at rest, in another pose or shape.
fn of_rig(own: &Body, mesh: TriMesh) -> Result<RestBodies, SkinError> {
    let distance = distance_of_skin(own, own.rest().positions(), mesh.positions());
    if let Some((zero, degrees, left)) = recovered(own, &mesh, distance)? {
        let skeleton = moved(zero.body.skeleton(), &zero.rest_from_zero)?;
        return Ok(RestBodies {
            rest: Body::new(mesh, skeleton, own.weights().clone())?,
            zero: Some(zero),
            posed_by: Some(degrees),
            shaped_by: (left > SHAPED).then_some(left),
        });
    }
    let is_fit = own.rest().num_vertices() == mesh.num_vertices();
    let shaped_by = (is_fit && distance > SHAPED).then_some(distance);
    let rest = match shaped_by {
        Some(_) => own.reshaped(mesh.positions())?,
        None => Body::new(mesh, own.skeleton().clone(), own.weights().clone())?,
    };
    Ok(RestBodies {
        rest,
        zero: None,
        posed_by: None,
        shaped_by,
    })
}

/// A rest body that is farther from the mesh of its rig has another shape, in metres.
const SHAPED: f32 = 5e-3;

/// The largest distance between two places of the skin of a body.
fn distance_of_skin(body: &Body, a: &[Point3], b: &[Point3]) -> f32 {
    largest_distance(body.of_skin(a), body.of_skin(b))
}

/// A body in the shape of what was fitted to it.
fn shaped(body: &Body, fitted: &PosedBody) -> Result<Body, SkinError> {
    let Some(offsets) = fitted.shape_offsets() else {
        return Ok(body.clone());
    };
    let places = body.rest().positions().iter().zip(offsets);
    let places: Vec<Point3> = places.map(|(place, offset)| place + offset).collect();
    body.reshaped(&places)
}

/// A rest body this far from its rig may be in another pose, in metres.
const POSED: f32 = 5e-3;

/// Joints that are turned by less are those of another shape, in degrees.
const MIN_TURN: f32 = 3.0;

/// A pose leaves less than this part of the distance from the rig to the rest body.
const MAX_LEFT: f32 = 0.5;

/// Between bodies of two shapes in one pose, long bones turn by less, in degrees. A higher value
/// takes more poses for shapes.
const MIN_BENT: f32 = 12.0;

/// A long bone has this part of the size of the skeleton.
const LONG_BONE: f32 = 0.08;

/// The rest body in the pose of its rig, the largest turn of a joint between both in degrees, and
/// how far the pose leaves the mesh of the rig from the rest body, in metres, if that is in another
/// pose: what the pose does not explain is its shape, and stays.
fn recovered(
    rig: &Body,
    mesh: &TriMesh,
    distance: f32,
) -> Result<Option<(Zero, f32, f32)>, SkinError> {
    if mesh.num_vertices() != rig.rest().num_vertices() || distance < POSED {
        return Ok(None);
    }
    let fitted = rig.fitted(mesh.positions())?;
    let rest_from_zero = fitted.posed_from_rest().to_vec();
    let pose = Pose::from_transforms(rig.skeleton(), &rest_from_zero)?.pose;
    let turns = pose.rotations.iter().map(UnitQuaternion::angle);
    let degrees = turns.fold(0.0, f32::max).to_degrees();
    let left = fitted.max_residual();
    if degrees < MIN_TURN || left > MAX_LEFT * distance {
        return Ok(None);
    }
    // Turns of joints explain part of another size, too.
    if left > SHAPED {
        let reshaped = rig.reshaped(mesh.positions())?;
        if bent_by(rig.skeleton(), reshaped.skeleton()) < MIN_BENT {
            return Ok(None);
        }
    }
    if left <= SHAPED && apart(rig.skeleton(), &rest_from_zero) <= SHAPED {
        let zero = Zero {
            body: shaped(rig, &fitted)?,
            rest_from_zero,
        };
        return Ok(Some((zero, degrees, left)));
    }
    // Bones of other lengths pull the fitted joints apart: a pose does not. The more alike both are
    // in size, the better are the turns.
    let (first, _) = rig.unposed(mesh.positions(), &turns_of(&rest_from_zero))?;
    let lengths = [first.skeleton(), rig.skeleton()].map(Skeleton::length_of_bones);
    let times = lengths[0] / lengths[1];
    let is_usable = times.is_finite() && times > 0.0;
    let grown = rig.scaled(if is_usable { times } else { 1.0 })?;
    let fitted = grown.fitted(mesh.positions())?;
    let turns = turns_of(fitted.posed_from_rest());
    let (body, rest_from_zero) = grown.unposed(mesh.positions(), &turns)?;
    let left = distance_of_skin(rig, rig.rest().positions(), body.rest().positions());
    let zero = Zero {
        body,
        rest_from_zero,
    };
    Ok(Some((zero, degrees, left)))
}

fn turns_of(transforms: &[Isometry3<f32>]) -> Vec<UnitQuaternion<f32>> {
    transforms
        .iter()
        .map(|transform| transform.rotation)
        .collect()
}

/// How far transforms pull joints from their parents at most, in metres.
fn apart(skeleton: &Skeleton, transforms: &[Isometry3<f32>]) -> f32 {
    let joints = skeleton.joints().iter().zip(transforms);
    let gaps = joints.filter_map(|(joint, transform)| {
        let place = joint.rest_position;
        Some((transform * place - transforms[joint.parent?] * place).norm())
    });
    gaps.fold(0.0, f32::max)
}

/// The largest angle between the bones of two bodies, in degrees; short ones tell nothing.
fn bent_by(a: &Skeleton, b: &Skeleton) -> f32 {
    let bones = |skeleton: &Skeleton| -> Vec<Vector3> {
        let joints = skeleton.joints();
        let bone = |joint: &Joint| {
            let from = joint.parent.map_or(joint, |parent| &joints[parent]);
            joint.rest_position - from.rest_position
        };
        joints.iter().map(bone).collect()
    };
    let places: Vec<Point3> = a.joints().iter().map(|joint| joint.rest_position).collect();
    let size = Bounds::of(&places).map_or(0.0, |bounds| bounds.diagonal());
    let (a, b) = (bones(a), bones(b));
    let is_long = |(a, b): &(&Vector3, &Vector3)| a.norm().min(b.norm()) > LONG_BONE * size;
    let pairs = a.iter().zip(&b).filter(is_long);
    let angles = pairs.map(|(a, b)| a.angle(b));
    angles.fold(0.0, f32::max).to_degrees()
}

/// A rig that is not of the rest body.
pub(super) fn unfit(rig: &Path, rest: &Path, problem: SceneProblem) -> SceneError {
    SceneError::UnfitRig {
        rig: rig.to_path_buf(),
        rest: rest.to_path_buf(),
        problem,
    }
}

/// Joints are as far as this outside the box of their body at most, over the size of the box: those
/// at the tips of hands and feet.
const JOINT_MARGIN: f32 = 0.1;

/// Refuses a skeleton most of which lies outside the body: rig and mesh are in two places, or of
/// two sizes.
fn check_joints(skeleton: &Skeleton, mesh: &TriMesh) -> Result<(), SceneProblem> {
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
    Err(SceneProblem::JointsOutside {
        num_outside,
        num_joints: joints.len(),
    })
}

/// A skeleton in metres with y up.
fn placed(skeleton: &Skeleton, frame: Frame) -> Result<Skeleton, SkinError> {
    if frame == Frame::OURS {
        return Ok(skeleton.clone());
    }
    skeleton.placed(|_, joint| frame.point_to_metres(&joint.rest_position))
}

/// A skeleton whose joints were moved.
fn moved(skeleton: &Skeleton, transforms: &[Isometry3<f32>]) -> Result<Skeleton, SkinError> {
    skeleton.placed(|number, joint| transforms[number] * joint.rest_position)
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

/// The largest distance between two lists of points.
pub fn largest_distance<'a>(
    a: impl IntoIterator<Item = &'a Point3>,
    b: impl IntoIterator<Item = &'a Point3>,
) -> f32 {
    let distances = a.into_iter().zip(b).map(|(a, b)| (a - b).norm());
    distances.fold(0.0, f32::max)
}

/// A mesh of a file, in metres with y up.
pub(super) fn in_metres(mesh: TriMesh, frame: Frame) -> Result<TriMesh, SceneError> {
    if frame == Frame::OURS {
        return Ok(mesh);
    }
    let (positions, faces) = mesh.into_parts();
    let unit = frame.unit;
    TriMesh::new(frame.to_metres(positions), faces)
        .map_err(|source| SceneError::OutOfRange { unit, source })
}
