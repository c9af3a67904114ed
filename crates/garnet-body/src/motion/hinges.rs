//! The hinges of elbows and knees, which tell how a limb is turned about itself at rest.
//!
//! Where the rest poses of two skeletons differ, the smallest rotation from bone to bone leaves
//! open how the limb is turned about the bone. The axis about which the elbow or knee bends settles
//! it: a recording shows its own, a body has it by the bend of its limb at rest, or else by anatomy
//! (forearms bend to the front, shanks to the back when limbs hang).

use nalgebra::{Matrix3, SymmetricEigen, Unit, UnitQuaternion, Vector3};

use super::{
    Figure, Motion, Role,
    rotation::{Direction, Rotation, smallest_rotation, unit, world_rotations},
};

/// About so many frames of a recording tell its hinges.
const LOOKED_AT: usize = 200;

/// Fewer frames are poses, which tell no hinge.
const LEAST_FRAMES: usize = 20;

/// Least root mean square of the sine of the bend that tells an axis.
const LEAST_BEND: f64 = 0.3;

/// Least share of an axis in all bending about a joint.
const LEAST_SHARE: f64 = 0.85;

/// Sine of the least bend at rest that tells an axis.
const BENT_AT_REST: f64 = 0.26;

/// Rest poses whose bones differ by less agree, in radians.
const REST_AGREES: f64 = 0.26;

/// Hinges that differ by less agree: axes of recordings are no surer, in radians.
const HINGES_AGREE: f64 = 0.52;

/// The upper bone of a limb, the lower one, and the axis of the hinge between them where limbs
/// hang: x is the body's left.
fn limb(role: Role) -> Option<(Role, f64)> {
    match role {
        Role::Shoulder(side) => Some((Role::Elbow(side), -1.0)),
        Role::Hip(side) => Some((Role::Knee(side), 1.0)),
        _ => None,
    }
}

/// How far an upper arm or thigh is to be turned about itself after `alignment`, by which its bone
/// points as that of the source; the identity where rest poses or hinges agree, or nothing tells
/// the source's hinge.
pub(super) fn turn_about_bone(
    motion: &Motion,
    source: &Figure,
    target: &Figure,
    upper: Role,
    trunk: &Rotation,
    alignment: &Rotation,
) -> Rotation {
    let turned = || {
        let (lower, sign) = limb(upper)?;
        let bones = [upper, lower].map(|role| source.bone(role).zip(target.bone(role)));
        let differ = |bones: &Option<(Direction, Direction)>| {
            bones.is_some_and(|(source, target)| source.angle(&(trunk * target)) > REST_AGREES)
        };
        if !bones.iter().any(differ) {
            return None;
        }
        let bone = unit(&source.bone(upper)?)?;
        let wanted = across(&recorded(motion, source, upper, lower)?, &bone)?;
        let found = across(&(alignment * at_rest(target, upper, lower, sign)?), &bone)?;
        let angle = found.cross(&wanted).dot(&bone).atan2(found.dot(&wanted));
        (angle.abs() > HINGES_AGREE)
            .then(|| UnitQuaternion::from_axis_angle(&Unit::new_normalize(bone), angle))
    };
    turned().unwrap_or_else(Rotation::identity)
}

/// The axis about which the lower bone bends in a recording, in the axes of its rest pose.
fn recorded(motion: &Motion, figure: &Figure, upper: Role, lower: Role) -> Option<Direction> {
    let (above, below) = (figure.joint(upper)?, figure.joint(lower)?);
    let bone = unit(&figure.bone(upper)?)?;
    let next = unit(&figure.bone(lower)?)?;
    if motion.frames.len() < LEAST_FRAMES {
        return None;
    }
    let step = motion.frames.len().div_ceil(LOOKED_AT).max(1);
    let mut sum = Vector3::zeros();
    let mut squares = Matrix3::zeros();
    let mut count = 0.0;
    for pose in motion.frames.iter().step_by(step) {
        let world = world_rotations(&motion.skeleton, pose);
        // By where the bones are: rest poses may be bent themselves.
        let bend = bone.cross(&(world[above].inverse() * (world[below] * next)));
        sum += bend;
        squares += bend * bend.transpose();
        count += 1.0;
    }
    let eigen = SymmetricEigen::new(squares / f64::max(count, 1.0));
    let largest = eigen.eigenvalues.imax();
    let (square, all) = (eigen.eigenvalues[largest], eigen.eigenvalues.sum());
    let axis: Direction = eigen.eigenvectors.column(largest).into();
    let mean = (sum / count).dot(&axis);
    let is_sure = square.sqrt() > LEAST_BEND
        && square > LEAST_SHARE * all
        && mean.abs() > 0.5 * square.sqrt();
    is_sure.then(|| axis * mean.signum())
}

/// The axis about which the lower bone bends, by the rest pose alone.
fn at_rest(figure: &Figure, upper: Role, lower: Role, sign: f64) -> Option<Direction> {
    let bone = unit(&figure.bone(upper)?)?;
    if let Some(next) = figure.bone(lower).and_then(|next| unit(&next)) {
        let axis = bone.cross(&next);
        if axis.norm() > BENT_AT_REST {
            return Some(axis);
        }
    }
    let rest_from_body = figure.rest_from_body();
    let down = rest_from_body * -Direction::y();
    let rest_from_hanging = smallest_rotation(&down, &bone)?;
    Some(rest_from_hanging * (rest_from_body * (Direction::x() * sign)))
}

/// The part of an axis across a bone.
fn across(axis: &Direction, bone: &Direction) -> Option<Direction> {
    let across = axis - bone * bone.dot(axis);
    (across.norm() > 0.3 * axis.norm())
        .then(|| unit(&across))
        .flatten()
}
