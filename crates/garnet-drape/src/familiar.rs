//! Bodies within what a network has seen, in place of others.
//!
//! Joint by joint, what is farther outside of the training than is trusted goes back to there, the
//! short way towards the middle of the training. A network predicts on that body; how far that is
//! from the warp there is laid on the warp of the body that was asked for. So nothing jumps where a
//! joint leaves the range.

use garnet_mesh::{Point3, Vector3};
use garnet_net::TrainedRange;
use garnet_skin::{Body, Joint, PosedBody, SkinError, skin_dual_quaternion};
use nalgebra::{Matrix3, Rotation3, Translation3, UnitQuaternion};

use crate::Unfamiliar;
use crate::unfamiliar::{MAX_GROWTH, MAX_TURN, TURN, norm, turned_by, unfamiliar};

/// Into how many steps the way to the middle is cut, and how often the last one is halved.
const STEPS: u32 = 64;
const HALVINGS: u32 = 12;

/// A body that a network knows.
#[derive(Debug)]
pub(crate) struct Familiar {
    pub(crate) body: PosedBody,
    /// What is the farthest outside on the body that was asked for.
    pub(crate) reason: Unfamiliar,
}

impl Familiar {
    /// The body within `range` that is the nearest to `posed`; none if that is within it itself.
    /// Joints that do not move the garment stay as they are.
    pub(crate) fn near(
        range: &TrainedRange,
        body: &Body,
        posed: &PosedBody,
        moves: &[bool],
    ) -> Result<Option<Self>, SkinError> {
        let numbers = body.pose_and_shape(posed);
        let skeleton = body.skeleton();
        let joints = skeleton.joints();
        let Some(reason) = unfamiliar(&range.excess(&numbers), joints, moves) else {
            return Ok(None);
        };
        let middle = range.middle();
        let asked = posed.posed_from_rest();
        let mut transforms = asked.to_vec();
        let mut shares = vec![1.0_f32; joints.len()];
        for &joint in skeleton.parents_first() {
            let parent = joints[joint].parent;
            let own = parent.map_or(asked[joint], |parent| {
                asked[parent].inverse() * asked[joint]
            });
            let mut turn = own.rotation;
            let first = joint * Body::NUMBERS_A_JOINT;
            let (last, end) = (first + TURN, first + Body::NUMBERS_A_JOINT);
            if moves[joint] && middle.len() >= end {
                turn = kept_turn(range, (first, &joints[joint]), turn, &middle[first..last]);
                shares[joint] = kept_share(range, last, &numbers[last..end]);
            }
            let pivot = joints[joint].rest_position;
            let place = Translation3::from((own * pivot).coords);
            let kept = place * turn * Translation3::from(-pivot.coords);
            transforms[joint] = parent.map_or(kept, |parent| transforms[parent] * kept);
        }
        let positions = shaped(body, posed, &shares);
        let positions = skin_dual_quaternion(&positions, body.weights(), &transforms);
        Ok(Some(Self {
            body: body.fitted_by(&positions, transforms)?,
            reason,
        }))
    }
}

/// The turn of a joint against its parent, as far as it is trusted.
fn kept_turn(
    range: &TrainedRange,
    (first, joint): (usize, &Joint),
    turn: UnitQuaternion<f32>,
    middle: &[f32],
) -> UnitQuaternion<f32> {
    let is_root = joint.parent.is_none();
    let columns = [&middle[..3], &middle[3..]].map(Vector3::from_column_slice);
    let up = |turn: UnitQuaternion<f32>| turn.inverse() * Vector3::y();
    let middle = if is_root {
        // Where up is, seen from the root, whichever way that looks.
        let lean = UnitQuaternion::rotation_between(&up(turn), &columns[0]);
        turn * lean.unwrap_or_default().inverse()
    } else {
        of_columns(columns).unwrap_or_default()
    };
    let excess = |turn: UnitQuaternion<f32>| {
        let numbers: [f32; TURN] = if is_root {
            let up = up(turn);
            [up.x, up.y, up.z, 0.0, 0.0, 0.0]
        } else {
            let matrix = turn.to_rotation_matrix();
            std::array::from_fn(|number| matrix.matrix().as_slice()[number])
        };
        turned_by(&range.excess_from(first, &numbers))
    };
    let at = |share: f32| {
        let between = turn.try_slerp(&middle, share, 1e-6);
        between.unwrap_or(if share < 0.5 { turn } else { middle })
    };
    at(share_of_way(|share| excess(at(share)) <= MAX_TURN))
}

/// The rotation nearest to two columns, if they are any.
fn of_columns([first, second]: [Vector3; 2]) -> Option<UnitQuaternion<f32>> {
    let first = first.try_normalize(1e-3)?;
    let second = (second - first * first.dot(&second)).try_normalize(1e-3)?;
    let matrix = Matrix3::from_columns(&[first, second, first.cross(&second)]);
    let rotation = Rotation3::from_matrix_unchecked(matrix);
    Some(UnitQuaternion::from_rotation_matrix(&rotation))
}

/// The share of a change of shape around a joint that is trusted.
fn kept_share(range: &TrainedRange, first: usize, numbers: &[f32]) -> f32 {
    let excess = |share: f32| {
        let numbers: Vec<f32> = numbers.iter().map(|number| share * number).collect();
        norm(&range.excess_from(first, &numbers))
    };
    1.0 - share_of_way(|share| excess(1.0 - share) <= MAX_GROWTH)
}

/// The first share of a way, from 0 to 1, that is near enough; all of it if none is.
fn share_of_way(is_near: impl Fn(f32) -> bool) -> f32 {
    if is_near(0.0) {
        return 0.0;
    }
    let step = 1.0 / STEPS as f32;
    let near = (1..=STEPS).find(|&number| is_near(number as f32 * step));
    let Some(near) = near else { return 1.0 };
    let (mut far, mut near) = ((near - 1) as f32 * step, near as f32 * step);
    for _ in 0..HALVINGS {
        let middle = f32::midpoint(far, near);
        if is_near(middle) {
            near = middle;
        } else {
            far = middle;
        }
    }
    near
}

/// The skin at rest with the shares of its change of shape that joints keep.
fn shaped(body: &Body, posed: &PosedBody, shares: &[f32]) -> Vec<Point3> {
    let rest = body.rest().positions();
    let Some(offsets) = posed.shape_offsets() else {
        return rest.to_vec();
    };
    let moved = rest.iter().zip(offsets).enumerate();
    moved
        .map(|(vertex, (rest, offset))| {
            let weights = body.weights().vertex(vertex);
            let share: f32 = weights.map(|(joint, weight)| weight * shares[joint]).sum();
            rest + share * offset
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use garnet_mesh::primitives::capsule;
    use garnet_skin::{Pose, Skeleton, SkinWeights};

    use super::*;

    fn arm() -> Body {
        let arm = capsule(0.05, 0.6, 16, 24);
        let joint = |name: &str, parent, y| Joint {
            name: name.to_owned(),
            parent,
            rest_position: Point3::new(0.0, y, 0.0),
        };
        let joints = vec![joint("shoulder", None, -0.3), joint("elbow", Some(0), 0.0)];
        let forearm = |point: &Point3| (0.5 + point.y / 0.1).clamp(0.0, 1.0);
        let rows = (arm.positions().iter()).map(|p| [(0, 1.0 - forearm(p)), (1, forearm(p))]);
        let weights = SkinWeights::from_influences(2, rows).unwrap();
        Body::new(arm, Skeleton::new(joints).unwrap(), weights).unwrap()
    }

    fn bent(body: &Body, lean: f32, angle: f32) -> PosedBody {
        let mut pose = Pose::rest(2);
        pose.rotations[0] = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), lean);
        pose.rotations[1] = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
        body.posed(&pose).unwrap()
    }

    /// Of elbows bent by half a radian to either side, and shoulders that lean as far.
    fn range(body: &Body) -> TrainedRange {
        let ends = [-0.5, 0.0, 0.5];
        let seen = ends
            .iter()
            .flat_map(|&lean| ends.map(|angle| bent(body, lean, angle)));
        TrainedRange::of(seen.map(|posed| body.pose_and_shape(&posed))).unwrap()
    }

    fn angle(body: &PosedBody) -> f32 {
        let turns = body.posed_from_rest();
        (turns[0].rotation.inverse() * turns[1].rotation).angle()
    }

    #[test]
    fn what_is_farther_out_goes_back_to_where_it_is_trusted() {
        let (body, moves) = (arm(), [true; 2]);
        let range = range(&body);
        let near = |angle: f32| {
            let found = Familiar::near(&range, &body, &bent(&body, 0.2, angle), &moves);
            found.unwrap()
        };
        assert!(near(0.7).is_none());
        let mut last = 0.0;
        for asked in [1.0, 1.2, 2.0, 3.0] {
            let found = near(asked).unwrap();
            let kept = angle(&found.body);
            // Trusted beyond the range: about MAX_TURN, of which chords are a little shorter.
            assert!((0.75..0.95).contains(&kept), "{asked}: {kept}");
            assert!(last == 0.0 || (kept - last).abs() < 1e-2, "{asked}: {kept}");
            assert!(matches!(found.reason, Unfamiliar::Pose { joint, .. } if joint == "elbow"));
            let numbers = body.pose_and_shape(&found.body);
            let joints = body.skeleton().joints();
            let left = unfamiliar(&range.excess(&numbers), joints, &moves);
            let rest = norm(&range.excess(&numbers));
            assert!(
                left.is_none() || rest < 1.01 * MAX_TURN * 2.0_f32.sqrt(),
                "{left:?}"
            );
            last = kept;
        }
    }

    #[test]
    fn nothing_jumps_where_a_joint_leaves_the_range() {
        let (body, moves) = (arm(), [true; 2]);
        let range = range(&body);
        let kept = |asked: f32| {
            let posed = bent(&body, 0.0, asked);
            let found = Familiar::near(&range, &body, &posed, &moves).unwrap();
            found.map_or(posed, |found| found.body)
        };
        let mut last = kept(0.4);
        for step in 1..100 {
            let next = kept(0.4 + 0.01 * step as f32);
            let moved = last.skin().positions().iter().zip(next.skin().positions());
            let moved = moved.map(|(a, b)| (a - b).norm()).fold(0.0, f32::max);
            // The tip is 0.35 from the elbow.
            assert!(moved < 0.01 * 0.4, "{step}: {moved}");
            last = next;
        }
    }

    #[test]
    fn a_lean_goes_back_without_a_turn_about_the_vertical() {
        let (body, moves) = (arm(), [true; 2]);
        let range = range(&body);
        let posed = bent(&body, 1.6, 0.1);
        let found = Familiar::near(&range, &body, &posed, &moves)
            .unwrap()
            .unwrap();
        let root = found.body.posed_from_rest()[0].rotation;
        let up = root.inverse() * Vector3::y();
        assert!(up.z.abs() < 1e-3, "{up}");
        assert!((0.5..0.95).contains(&root.angle()), "{}", root.angle());
        assert!((angle(&found.body) - 0.1).abs() < 1e-4);
    }

    #[test]
    fn a_body_of_another_size_keeps_part_of_it() {
        let (body, moves) = (arm(), [true; 2]);
        let range = range(&body);
        let asked = bent(&body, 0.0, 0.2);
        let skin = asked.skin().positions().iter().zip(asked.vertex_normals());
        let thick: Vec<Point3> = skin.map(|(place, normal)| place + 0.1 * normal).collect();
        let thick = body
            .fitted_by(&thick, asked.posed_from_rest().to_vec())
            .unwrap();
        let found = Familiar::near(&range, &body, &thick, &moves)
            .unwrap()
            .unwrap();
        assert!(
            matches!(found.reason, Unfamiliar::Shape { .. }),
            "{:?}",
            found.reason
        );
        let growth = |posed: &PosedBody| {
            let offsets = posed.shape_offsets().unwrap().iter().map(Vector3::norm);
            offsets.fold(0.0, f32::max)
        };
        let kept = growth(&found.body);
        assert!(
            kept > 0.5 * MAX_GROWTH && kept < 0.5 * growth(&thick),
            "{kept}"
        );
    }
}
