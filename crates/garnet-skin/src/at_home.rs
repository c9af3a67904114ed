//! A posed body where the rest body stands, and how it faces.
//!
//! How cloth hangs doesn't depend on where a body stands nor on which way it faces. A simulation
//! that starts on the body at rest would carry the cloth there first, within the same second, and
//! what a network has learned are bodies near their rest. So shifts and turns about the vertical
//! are taken off before a drape, and put on the result.

use std::borrow::Cow;

use garnet_mesh::Point3;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use crate::{Body, PosedBody, SkinError};

/// A body shifts this far sideways as part of its pose, in metres.
const OWN_SHIFT: f64 = 0.05;

/// A body comes this far above or below the ground of the rest body as part of its pose, in metres:
/// of who lies, no joint is as low as the skin.
const OWN_RISE: f64 = 0.25;

/// A body turns by this much as part of its pose, in radians: more than the pelvis does in poses of
/// the library.
const OWN_TURN: f64 = 0.45;

/// A posed body near its rest, and the way back to where it stands.
#[derive(Debug, Clone)]
pub struct BodyAtHome<'a> {
    body: Cow<'a, PosedBody>,
    /// None if the body was near its rest.
    target_from_home: Option<Isometry3<f64>>,
}

impl BodyAtHome<'_> {
    /// The body near its rest.
    pub fn body(&self) -> &PosedBody {
        &self.body
    }

    /// The body near its rest, if it was not there before.
    pub fn moved(self) -> Option<PosedBody> {
        match self.body {
            Cow::Borrowed(_) => None,
            Cow::Owned(body) => Some(body),
        }
    }

    /// Points near the rest body where they are on the target, in metres.
    pub fn to_target(&self, points: Vec<Point3>) -> Vec<Point3> {
        moved_by(self.target_from_home, points)
    }

    /// Points on the target where they are near the rest body, in metres.
    pub fn from_target(&self, points: Vec<Point3>) -> Vec<Point3> {
        moved_by(self.target_from_home.map(|way| way.inverse()), points)
    }
}

/// Points where a way leads them, if there is one.
fn moved_by(way: Option<Isometry3<f64>>, mut points: Vec<Point3>) -> Vec<Point3> {
    if let Some(way) = way {
        for point in &mut points {
            *point = (way * point.cast::<f64>()).cast();
        }
    }
    points
}

impl PosedBody {
    /// This body without the shift of its root against `rest` and without its turn about the
    /// vertical (y): drapes there are drapes here.
    ///
    /// Small shifts and turns belong to the pose and are kept, so that a body near its rest stays
    /// where it is; larger ones are kept the less the larger they are, from twice as large on not
    /// at all.
    ///
    /// # Errors
    ///
    /// [`SkinError::TransformCount`] if this is another body than `rest`; those of
    /// [`Surface::moved`](garnet_knn::Surface::moved).
    pub fn at_home(&self, rest: &Body) -> Result<BodyAtHome<'_>, SkinError> {
        let transforms = self.posed_from_rest();
        let skeleton = rest.skeleton();
        if transforms.len() != skeleton.num_joints() {
            return Err(SkinError::TransformCount {
                found: transforms.len(),
                expected: skeleton.num_joints(),
            });
        }
        let here = BodyAtHome {
            body: Cow::Borrowed(self),
            target_from_home: None,
        };
        let Some(&root) = skeleton.parents_first().first() else {
            return Ok(here);
        };
        let root_at_rest = skeleton.joints()[root].rest_position.cast::<f64>();
        let root_from_rest = transforms[root].cast::<f64>();
        let place = root_from_rest * root_at_rest;
        let shift = place - root_at_rest;
        let sideways = shift.x.hypot(shift.z);
        let ground_of = |positions| ground(rest.of_skin(positions));
        let rise = ground_of(self.skin().positions()) - ground_of(rest.rest().positions());
        let turn = turn_about_y(&root_from_rest.rotation);
        let kept = [
            kept(sideways, OWN_SHIFT),
            kept(rise, OWN_RISE),
            kept(turn, OWN_TURN),
        ];
        let is_kept = [sideways, rise, turn].into_iter().eq(kept);
        if is_kept || !kept.into_iter().all(f64::is_finite) {
            return Ok(here);
        }
        let [kept_sideways, kept_rise, kept_turn] = kept;
        let share = if sideways > 0.0 {
            kept_sideways / sideways
        } else {
            0.0
        };
        let home = nalgebra::Point3::new(
            root_at_rest.x + share * shift.x,
            place.y - (rise - kept_rise),
            root_at_rest.z + share * shift.z,
        );
        let turned =
            UnitQuaternion::from_axis_angle(&nalgebra::Vector3::y_axis(), kept_turn - turn);
        let home_from_target =
            Translation3::from(home.coords) * turned * Translation3::from(-place.coords);
        let moved = |point: &Point3| (home_from_target * point.cast::<f64>()).cast();
        let positions = self.skin().positions().iter().map(moved).collect();
        let transforms = transforms.iter();
        let transforms = transforms.map(|one| (home_from_target * one.cast::<f64>()).cast());
        Ok(BodyAtHome {
            body: Cow::Owned(self.moved(positions, transforms.collect())?),
            target_from_home: Some(home_from_target.inverse()),
        })
    }
}

/// What is kept of a quantity of which `own` belongs to the pose.
fn kept(quantity: f64, own: f64) -> f64 {
    let size = quantity.abs();
    if size <= own {
        return quantity;
    }
    (2.0 * own - size).max(0.0).copysign(quantity)
}

/// How far a rotation turns about y, in radians from −π to π: its twist (Dobrowolski 2015,
/// "Swing-twist decomposition in Clifford algebra").
fn turn_about_y(rotation: &UnitQuaternion<f64>) -> f64 {
    let half = rotation.j.atan2(rotation.w);
    let turn = 2.0 * half;
    turn - std::f64::consts::TAU * (turn / std::f64::consts::TAU).round()
}

/// The height of the lowest point, in metres.
fn ground<'a>(points: impl Iterator<Item = &'a Point3>) -> f64 {
    let heights = points.map(|point| f64::from(point.y));
    heights.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Joint, Pose, Skeleton, SkinWeights};
    use garnet_mesh::primitives::icosphere;
    use garnet_mesh::{TriMesh, Vector3};

    /// A ball whose two halves bend against each other.
    fn body() -> Body {
        let mesh = icosphere(2, 0.5);
        let joint = |parent, y| Joint {
            name: format!("joint at {y}"),
            parent,
            rest_position: Point3::new(0.02, y, -0.01),
        };
        let skeleton = Skeleton::new(vec![joint(None, 0.0), joint(Some(0), 0.1)]).unwrap();
        let weights = mesh.positions().iter();
        let weights = weights.flat_map(|point| {
            if point.y > 0.1 {
                [0.0, 1.0]
            } else {
                [1.0, 0.0]
            }
        });
        let weights = SkinWeights::from_dense(2, &weights.collect::<Vec<f32>>()).unwrap();
        Body::new(mesh, skeleton, weights).unwrap()
    }

    fn pose(turn: f32, shift: [f32; 3]) -> Pose {
        let tilt = UnitQuaternion::from_scaled_axis(Vector3::new(0.3, 0.0, 0.2));
        let about_y = UnitQuaternion::from_scaled_axis(Vector3::y() * turn);
        Pose {
            root_translation: Vector3::from(shift),
            rotations: vec![
                about_y * tilt,
                UnitQuaternion::from_scaled_axis(Vector3::x()),
            ],
        }
    }

    fn farthest(a: &[Point3], b: &[Point3]) -> f32 {
        let distances = a.iter().zip(b).map(|(a, b)| (a - b).norm());
        distances.fold(0.0, f32::max)
    }

    #[test]
    fn bodies_elsewhere_come_to_one_place_and_back() {
        let body = body();
        let far = [
            (1.5, [3.0, 2.0, -7.0]),
            (-2.9, [-0.2, -5.0, 0.4]),
            (3.1, [40.0, 0.8, 0.0]),
        ];
        let home = body.posed(&pose(0.0, [0.0; 3])).unwrap();
        // The turn of a tilted root is none about y alone.
        let own = home.at_home(&body).unwrap();
        assert!(matches!(own.body, Cow::Borrowed(_)));
        let mut first: Option<Vec<Point3>> = None;
        for (turn, shift) in far {
            let posed = body.posed(&pose(turn, shift)).unwrap();
            let near = posed.at_home(&body).unwrap();
            let places = near.body().skin().positions();
            let ground_at_home = ground(places.iter()) - ground(body.rest().positions().iter());
            assert!(ground_at_home.abs() < 1e-4, "{ground_at_home}");
            let first = first.get_or_insert_with(|| places.to_vec());
            assert!(farthest(first, places) < 2e-5);
            let back = near.to_target(places.to_vec());
            assert!(farthest(&back, posed.skin().positions()) < 1e-5);
            assert!(farthest(&near.from_target(back), places) < 1e-5);
            let by_transforms = body.transformed_positions(
                near.body().posed_from_rest(),
                crate::Method::DualQuaternion,
            );
            assert!(farthest(&by_transforms, places) < 2e-5);
        }
    }

    #[test]
    fn what_belongs_to_the_pose_is_kept_and_nothing_jumps() {
        let body = body();
        let posed = body.posed(&pose(0.3, [0.03, 0.0, 0.02])).unwrap();
        let near = posed.at_home(&body).unwrap();
        assert_eq!(near.body().skin().positions(), posed.skin().positions());
        let mut last: Option<Vec<Point3>> = None;
        for step in 0..400 {
            let part = step as f32 / 400.0;
            let posed = body
                .posed(&pose(1.2 * part, [0.2 * part, 0.6 * part, 0.0]))
                .unwrap();
            let near = posed.at_home(&body).unwrap();
            let places = near.body().skin().positions();
            if let Some(last) = &last {
                assert!(farthest(last, places) < 0.01);
            }
            last = Some(places.to_vec());
        }
    }

    #[test]
    fn the_shape_stays_and_another_body_is_refused() {
        let body = body();
        let taller = body.rest().positions().iter();
        let taller = taller.map(|p| Point3::new(p.x + 9.0, 1.2 * p.y, p.z));
        let taller: Vec<Point3> = taller.collect();
        let posed = body.fitted(&taller).unwrap();
        let near = posed.at_home(&body).unwrap();
        assert_eq!(near.body().shape_offsets(), posed.shape_offsets());
        let one_joint = Skeleton::new(vec![Joint {
            name: "root".to_owned(),
            parent: None,
            rest_position: Point3::origin(),
        }]);
        let mesh = TriMesh::new(
            body.rest().positions().to_vec(),
            body.rest().faces().to_vec(),
        );
        let weights = SkinWeights::from_dense(1, &vec![1.0; taller.len()]).unwrap();
        let other = Body::new(mesh.unwrap(), one_joint.unwrap(), weights).unwrap();
        assert!(posed.at_home(&other).is_err());
    }
}
