//! Rotations in double precision.

use garnet_skin::{Pose, Skeleton};
use nalgebra::{Unit, UnitQuaternion, Vector3};

pub(crate) type Rotation = UnitQuaternion<f64>;
pub(crate) type Direction = Vector3<f64>;

/// The rotation by the smallest angle that turns the direction of `from` into that of `to`.
///
/// Nothing where one of them has no direction. Opposite directions are turned about some axis
/// across them.
pub fn smallest_rotation(from: &Vector3<f64>, to: &Vector3<f64>) -> Option<UnitQuaternion<f64>> {
    let (from, to) = (unit(from)?, unit(to)?);
    if let Some(rotation) = Rotation::rotation_between(&from, &to) {
        return Some(rotation);
    }
    let across = if from.x.abs() < 0.7 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    let axis = Unit::try_new(from.cross(&across), 1e-9)?;
    Some(Rotation::from_axis_angle(&axis, std::f64::consts::PI))
}

/// The pose at a share of the way from one to another: turns by the shorter way, and the shift
/// along a line.
pub fn pose_between(from: &Pose, to: &Pose, share: f32) -> Pose {
    let rotations = from.rotations.iter().zip(&to.rotations);
    Pose {
        root_translation: from.root_translation.lerp(&to.root_translation, share),
        rotations: rotations
            .map(|(from, to)| from.try_slerp(to, share, 1e-6).unwrap_or(*to))
            .collect(),
    }
}

/// The unit vector along `vector`; nothing for one that is too short or not finite.
pub(crate) fn unit(vector: &Direction) -> Option<Direction> {
    let length = vector.norm();
    (length > 1e-9 && length.is_finite()).then(|| vector / length)
}

/// The rotation of each joint `[joint]` from rest to the pose, in the world.
pub fn world_rotations(skeleton: &Skeleton, pose: &Pose) -> Vec<UnitQuaternion<f64>> {
    let mut world = vec![Rotation::identity(); skeleton.num_joints()];
    for &index in skeleton.parents_first() {
        let local = pose
            .rotations
            .get(index)
            .map_or_else(Rotation::identity, to_f64);
        world[index] = match skeleton.joints()[index].parent {
            Some(parent) => world[parent] * local,
            None => local,
        };
    }
    world
}

/// The local rotations of rotations in the world; both of them `[joint]`.
pub(crate) fn local_rotations(skeleton: &Skeleton, world: &[Rotation]) -> Vec<UnitQuaternion<f32>> {
    let joints = skeleton.joints().iter().enumerate();
    let locals = joints.map(|(index, joint)| match joint.parent {
        Some(parent) => to_f32(&(world[parent].inverse() * world[index])),
        None => to_f32(&world[index]),
    });
    locals.collect()
}

pub(crate) fn to_f64(rotation: &UnitQuaternion<f32>) -> Rotation {
    Rotation::new_normalize(rotation.into_inner().cast())
}

pub(crate) fn to_f32(rotation: &Rotation) -> UnitQuaternion<f32> {
    UnitQuaternion::new_normalize(rotation.into_inner().cast())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_smallest_rotation_meets_its_target(
            from in prop::array::uniform3(-1.0_f64..1.0),
            to in prop::array::uniform3(-1.0_f64..1.0),
        ) {
            let (from, to) = (Vector3::from(from), Vector3::from(to));
            prop_assume!(from.norm() > 0.01 && to.norm() > 0.01);
            let rotation = smallest_rotation(&from, &to).unwrap();
            prop_assert!((rotation * from.normalize() - to.normalize()).norm() < 1e-9);
            prop_assert!((rotation.angle() - from.angle(&to)).abs() < 1e-6);
        }
    }

    #[test]
    fn opposite_directions_are_turned_over_and_none_is_refused() {
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
            let rotation = smallest_rotation(&axis, &-axis).unwrap();
            assert!((rotation * axis + axis).norm() < 1e-9);
        }
        assert!(smallest_rotation(&Vector3::zeros(), &Vector3::x()).is_none());
        assert!(smallest_rotation(&Vector3::x(), &Vector3::repeat(f64::NAN)).is_none());
    }
}
