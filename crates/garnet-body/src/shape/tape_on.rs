//! The tape around a built-in body at rest, laid wherever one likes.

use std::{borrow::Cow, f64::consts::PI};

use garnet_mesh::Point3;
use garnet_skin::{Body, PosedBody};
use nalgebra::{Isometry3, Point3 as Point, Translation3, UnitQuaternion};

use super::body::shared;
use super::primitives::Vec3;
use super::recognize::at_rest;
use super::skeleton::JOINT_NAMES;
use super::tape::{self, TapePlane};
use super::template::Template;
use super::{Measure, NUM_JOINTS};

/// A built-in body at rest, ready to be measured.
///
/// ```
/// use garnet_body::shape::{BodyParameters, Measure, ParametricBody, Tape};
///
/// let built = ParametricBody::build(&BodyParameters::new(1.0))?;
/// let tape = Tape::around(built.body()).expect("it is the built-in body");
/// let waist = tape.girth(&tape.plane(Measure::Waist));
/// assert!((waist - built.measures()[Measure::Waist]).abs() < 1e-6);
/// # Ok::<(), garnet_body::shape::ShapeError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Tape {
    /// From the world to the frame in which the body is measured: x to its left, y up from its
    /// soles.
    own_from_world: Isometry3<f64>,
    positions: Vec<Vec3>,
    joints: Vec<Vec3>,
    stature: f64,
}

/// A part of the body that cloth goes round.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tube {
    /// From the crotch, or below it, to the neck.
    Trunk,
    /// From the shoulder to the wrist.
    LeftArm,
    /// From the shoulder to the wrist.
    RightArm,
    /// From the hip to the ankle.
    LeftLeg,
    /// From the hip to the ankle.
    RightLeg,
}

impl Tube {
    /// All tubes of a body.
    pub const ALL: [Self; 5] = [
        Self::Trunk,
        Self::LeftArm,
        Self::RightArm,
        Self::LeftLeg,
        Self::RightLeg,
    ];

    /// The joints along its middle.
    const fn joints(self) -> &'static [&'static str] {
        match self {
            Self::Trunk => &["pelvis", "spine1", "spine2", "spine3", "neck"],
            Self::LeftArm => &["left_shoulder", "left_elbow", "left_wrist"],
            Self::RightArm => &["right_shoulder", "right_elbow", "right_wrist"],
            Self::LeftLeg => &["left_hip", "left_knee", "left_ankle"],
            Self::RightLeg => &["right_hip", "right_knee", "right_ankle"],
        }
    }
}

/// How far the middle of the trunk goes on below the pelvis, between the legs, in metres.
const BELOW_PELVIS: f64 = 1.0;

fn lowest(positions: &[Vec3]) -> f64 {
    positions
        .iter()
        .map(|point| point.y)
        .fold(f64::MAX, f64::min)
}

/// A body whose soles are as near to the ground as this, whose hips are as near to the middle, and
/// which is turned by less, stands where the built-in bodies do; in metres, and as a tangent.
const AT_HOME: f64 = 1e-3;

/// How far forward the hips of built-in bodies are, to within [`NEAR_HOME`], in metres.
const HIPS: f64 = -0.006;
const NEAR_HOME: f64 = 0.01;

/// From the world to the frame of a body at rest that stands, lies or faces elsewhere: x to its
/// left, y up from its soles.
pub(super) fn own_frame(positions: &[Vec3], joints: &[Vec3]) -> Isometry3<f64> {
    let upright = upright(joints);
    let [left, right] = ["left_hip", "right_hip"].map(|name| upright * joints[tape::index(name)]);
    let across = left - right;
    let floor = positions
        .iter()
        .map(|place| (upright * place).y)
        .fold(f64::MAX, f64::min);
    let middle = (left + right) / 2.0;
    let is_turned = across.x <= 0.0 || across.z.abs() > AT_HOME * across.x;
    let is_near = (middle.z - HIPS).abs() < NEAR_HOME;
    let is_upright = upright == UnitQuaternion::identity();
    let stands = is_upright && floor.abs() < AT_HOME;
    if !is_turned && stands && middle.x.abs() < AT_HOME && is_near {
        return Isometry3::identity();
    }
    // A turn about y by an angle takes x to (cos, 0, -sin).
    let turn = UnitQuaternion::from_axis_angle(&Vec3::y_axis(), across.z.atan2(across.x));
    let origin = Vec3::new(middle.x, floor, middle.z);
    let hips = Vec3::new(0.0, 0.0, HIPS);
    Isometry3::from_parts(Translation3::from(hips - turn * origin), turn * upright)
}

/// The turn that stands a body up which lies along another axis, or on its head.
fn upright(joints: &[Vec3]) -> UnitQuaternion<f64> {
    let [neck, pelvis] = ["neck", "pelvis"].map(|name| joints[tape::index(name)]);
    let trunk = neck - pelvis;
    let longest = trunk.iamax();
    let mut up = Vec3::zeros();
    up[longest] = trunk[longest].signum();
    if up == Vec3::y() {
        return UnitQuaternion::identity();
    }
    // None about an axis across takes up to down: any does.
    UnitQuaternion::rotation_between(&up, &Vec3::y())
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vec3::x_axis(), PI))
}

/// A built-in body at rest that stands or faces elsewhere, brought to where built-in bodies stand,
/// and the way back; none of bodies that stand there, or are none of ours.
pub fn standing(body: &Body) -> Option<(Body, Isometry3<f32>)> {
    let own = Tape::around(body)?.own_from_world;
    if own == Isometry3::identity() {
        return None;
    }
    let moved = |place: &Point3| -> Point3 { (own * place.cast::<f64>()).cast() };
    let places = body.rest().positions().iter().map(moved).collect();
    let mesh = body.rest().with_positions(places).ok()?;
    let skeleton = body
        .skeleton()
        .placed(|_, joint| moved(&joint.rest_position));
    let standing = Body::new(mesh, skeleton.ok()?, body.weights().clone()).ok()?;
    Some((standing, own.inverse().cast()))
}

impl TapePlane {
    /// The point of the axis of the limb or trunk that lies in it, in metres, in the
    /// [frame of the body](Tape::own_places).
    pub fn center(&self) -> Point<f64> {
        self.center.into()
    }

    /// The unit normal: along the bone, or up.
    pub fn normal(&self) -> nalgebra::Vector3<f64> {
        self.normal
    }

    /// The same on the other side of the body.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let across = |v: Vec3| Vec3::new(-v.x, v.y, v.z);
        Self {
            center: across(self.center),
            normal: across(self.normal),
            ..*self
        }
    }
}

impl Tape {
    /// Of a body with the built-in topology and joints; none of another one.
    pub fn around(body: &Body) -> Option<Self> {
        let faces = &Template::stored().faces;
        if body.rest().faces() != *faces || body.skeleton().num_joints() != NUM_JOINTS {
            return None;
        }
        let joints = body.skeleton().joints().iter();
        let joints: Vec<Vec3> = joints
            .map(|joint| joint.rest_position.coords.cast())
            .collect();
        let positions = tape::doubled(body.rest().positions());
        let own_from_world = own_frame(&positions, &joints);
        Some(Self::new(own_from_world, positions, joints, None))
    }

    /// The points in the frame of planes and heights: x to the left of the body, y up from its
    /// soles. Those of a body that stands there are given back as they are.
    pub fn own_places<'a>(&self, points: &'a [Point3]) -> Cow<'a, [Point3]> {
        if self.own_from_world == Isometry3::identity() {
            return Cow::Borrowed(points);
        }
        let own = |point: &Point3| (self.own_from_world * point.cast::<f64>()).cast();
        Cow::Owned(points.iter().map(own).collect())
    }

    /// Of who stands in `posed`: `body` is the built-in body in any shape at rest, `posed` the same
    /// in a pose, and perhaps in another shape, which is brought back to rest. None for bodies of
    /// another topology.
    pub fn around_posed(body: &Body, posed: &PosedBody) -> Option<Self> {
        let own = Self::around(body)?;
        if posed.shape_offsets().is_none() {
            return Some(own);
        }
        let (places, joints) = at_rest(body, posed.clone()).ok()??;
        let joints = joints.iter().map(|joint| joint.coords.cast());
        Some(Self::new(
            own.own_from_world,
            tape::doubled(&places),
            joints.collect(),
            Some(lowest(&own.positions)),
        ))
    }

    /// With its soles at `floor`, if they are not where they are.
    fn new(
        own_from_world: Isometry3<f64>,
        mut positions: Vec<Vec3>,
        mut joints: Vec<Vec3>,
        floor: Option<f64>,
    ) -> Self {
        if own_from_world != Isometry3::identity() {
            for place in positions.iter_mut().chain(&mut joints) {
                *place = (own_from_world * Point::from(*place)).coords;
            }
        }
        let highest = positions
            .iter()
            .map(|point| point.y)
            .fold(f64::MIN, f64::max);
        let stature = floor.map_or(highest, |floor| highest - lowest(&positions) + floor);
        Self {
            own_from_world,
            positions,
            joints,
            stature,
        }
    }

    /// Where a girth is taken; `measure` is one of [`Measure::GIRTHS`].
    pub fn plane(&self, measure: Measure) -> TapePlane {
        tape::plane(&self.joints, self.stature, measure)
    }

    /// The height at which a girth of the trunk is taken, in metres; none of other girths.
    pub fn height(&self, measure: Measure) -> Option<f64> {
        tape::height_of(&self.joints, self.stature, measure)
    }

    /// How high the lower end of the neck is, in metres.
    ///
    /// # Panics
    ///
    /// Never: the built-in body has a neck.
    pub fn neck_height(&self) -> f64 {
        let neck = JOINT_NAMES.iter().position(|name| *name == "neck");
        self.joints[neck.expect("the built-in body has a neck")].y
    }

    /// Which share of its bone lies above the girth of a limb.
    pub fn share(measure: Measure) -> f64 {
        tape::share_of(measure)
    }

    /// The plane across the trunk at a height, in metres, for a girth of the trunk.
    pub fn trunk_plane(&self, measure: Measure, height: f64) -> TapePlane {
        tape::trunk_plane(&self.joints, measure, height)
    }

    /// The plane across the bone on which the girth of a limb of the left side is taken, a share of
    /// the way along it.
    pub fn bone_plane(&self, measure: Measure, share: f64) -> TapePlane {
        tape::bone_plane(&self.joints, measure, share)
    }

    /// The girth in a plane, in metres: the perimeter of the convex hull of the trunk without arms,
    /// or of the limb of the left side. 0 if there is none.
    pub fn girth(&self, plane: &TapePlane) -> f64 {
        let faces = &Template::stored().faces;
        tape::girth(&self.positions, faces, &shared().arm_share, plane)
    }

    /// Where the middle of a tube goes through a plane, in metres; none if it does not.
    pub fn middle_in(&self, tube: Tube, plane: &TapePlane) -> Option<Point<f64>> {
        let names = tube.joints().iter();
        let mut line: Vec<Vec3> = names.map(|name| self.joints[tape::index(name)]).collect();
        if tube == Tube::Trunk {
            line.insert(0, line[0] - BELOW_PELVIS * Vec3::y());
        }
        let height = |point: &Vec3| plane.normal.dot(&(point - plane.center));
        let through = line.windows(2).find_map(|bone| {
            let [start, end] = [height(&bone[0]), height(&bone[1])];
            let is_cut = (start >= 0.0) != (end >= 0.0);
            is_cut.then(|| bone[0] + start / (start - end) * (bone[1] - bone[0]))
        });
        through.map(Point::from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{BodyParameters, ParametricBody, Population, tape_measures};
    use garnet_skin::Pose;

    /// Girths of a person in a pose are found this well, relative: that of the chest depends on how
    /// high the armpits are, which the skin tells to a centimetre.
    const MAX_DIFFERENCE: f64 = 0.015;
    const MAX_CHEST_DIFFERENCE: f64 = 0.03;

    const FITTED: [Measure; 5] = [
        Measure::Chest,
        Measure::Waist,
        Measure::Hip,
        Measure::UpperArm,
        Measure::Thigh,
    ];

    #[test]
    fn the_tape_of_a_body_reads_its_measures() {
        let built = ParametricBody::build(&Population::new(5).sample(2)).unwrap();
        let tape = Tape::around(built.body()).unwrap();
        for measure in Measure::GIRTHS {
            let found = tape.girth(&tape.plane(measure));
            // Positions of a mesh are rounded.
            assert!(
                (found - built.measures()[measure]).abs() < 1e-6,
                "{measure}"
            );
        }
    }

    #[test]
    fn a_body_that_stands_and_faces_elsewhere_has_the_same_girths() {
        let built = ParametricBody::build(&Population::new(5).sample(3)).unwrap();
        let own = Tape::around(built.body()).unwrap();
        let turn = UnitQuaternion::from_axis_angle(&Vec3::y_axis(), 2.2);
        let away = Isometry3::from_parts(Translation3::new(3.0, -1.1, 0.7), turn);
        let away: Isometry3<f32> = away.cast();
        let moved = built.body().rest().positions().iter();
        let mesh = built.body().rest();
        let mesh = mesh.with_positions(moved.map(|place| away * place).collect());
        let skeleton = built.body().skeleton();
        let body = Body::new(
            mesh.unwrap(),
            skeleton
                .placed(|_, joint| away * joint.rest_position)
                .unwrap(),
            built.body().weights().clone(),
        );
        let body = body.unwrap();
        let measured = tape_measures(&body).unwrap();
        for (measure, truth) in built.measures().iter() {
            let found = measured[measure];
            assert!((found - truth).abs() < 2e-3, "{measure}: {found}, {truth}");
        }
        let (standing, back) = standing(&body).unwrap();
        let pairs = standing.rest().positions().iter();
        let pairs = pairs.zip(built.body().rest().positions());
        let farthest = pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f32::max);
        assert!(farthest < 2e-3, "{farthest}");
        let turned = (back.rotation * nalgebra::Vector3::z())
            .angle(&(away.rotation * nalgebra::Vector3::z()));
        assert!(turned < 1e-3, "{turned}");
        let tape = Tape::around(&body).unwrap();
        for measure in Measure::GIRTHS {
            let [found, truth] = [&tape, &own].map(|tape| tape.girth(&tape.plane(measure)));
            assert!(
                (found / truth - 1.0).abs() < 1e-3,
                "{measure}: {found}, {truth}"
            );
        }
        // Points go along into the frame of the body.
        let points = [away * Point3::new(0.2, 1.0, 0.0)];
        let places = tape.own_places(&points);
        assert!((places[0] - Point3::new(0.2, 1.0, 0.0)).xy().norm() < 1e-3);
    }

    #[test]
    fn the_skin_of_a_person_fitted_on_another_body_tells_the_girths() {
        let rest = ParametricBody::build(&BodyParameters::new(0.5)).unwrap();
        let population = Population::new(5);
        let short = BodyParameters::new(1.0).with(Measure::Stature, 1.50);
        let persons = (0..4).map(|number| population.sample(number));
        for (number, person) in persons.chain([short]).enumerate() {
            let person = ParametricBody::build(&person).unwrap();
            let mut pose = Pose::rest(NUM_JOINTS);
            pose.rotations[tape::index("left_hip")] =
                UnitQuaternion::from_axis_angle(&nalgebra::Vector3::x_axis(), -0.5);
            let posed = person.body().posed(&pose).unwrap();
            let fitted = rest.body().fitted(posed.skin().positions()).unwrap();
            assert!(fitted.shape_offsets().is_some());
            let tape = Tape::around_posed(rest.body(), &fitted).unwrap();
            for measure in FITTED {
                let [found, truth] = [tape.girth(&tape.plane(measure)), person.measures()[measure]];
                let difference = (found / truth - 1.0).abs();
                let limit = match measure {
                    Measure::Chest => MAX_CHEST_DIFFERENCE,
                    _ => MAX_DIFFERENCE,
                };
                assert!(
                    difference < limit,
                    "{measure} of {number}: {found}, {truth}"
                );
            }
        }
    }

    #[test]
    fn the_middle_of_an_arm_goes_through_its_plane_and_that_of_the_trunk_where_it_should() {
        let built = ParametricBody::build(&BodyParameters::new(0.5)).unwrap();
        let tape = Tape::around(built.body()).unwrap();
        let arm = tape.plane(Measure::UpperArm);
        let middle = tape.middle_in(Tube::LeftArm, &arm).unwrap();
        assert!((middle - arm.center()).norm() < 1e-9);
        let other = tape.middle_in(Tube::RightArm, &arm.mirrored()).unwrap();
        assert!((other.x + middle.x).abs() < 1e-4);
        let waist = tape.plane(Measure::Waist);
        let middle = tape.middle_in(Tube::Trunk, &waist).unwrap();
        assert!((middle - waist.center()).norm() < 1e-9);
        assert!(tape.middle_in(Tube::LeftLeg, &waist).is_none());
    }
}
