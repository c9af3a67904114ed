//! From anatomical angles to poses of a skeleton.
//!
//! The zero of all angles is upright standing with straight legs and hanging arms. Each bone of a
//! limb is turned from rest to there by the smallest rotation, after its parent's (`N_j`); trunk,
//! head and feet are there at rest. The angles then turn the parts of the body against each other,
//! in axes that are the body's own at zero (x left, y up, z front):
//!
//! ```text
//! W_j = P_j · N_j · F⁻¹        P_j = P_parent(j) · L_j(angles)        F: body's axes to rest axes
//! ```
//!
//! The upper arm turns against the chest, not against the collarbone: an abduction of 90 degrees is
//! level whatever the shoulder does. The shoulder girdle goes along with the arm by itself.

use garnet_skin::{Pose, Skeleton, Vector3};
use nalgebra::Vector3 as Vector;

use super::{Arm, BodyAngles, Leg, angles::ball};
use crate::motion::{Figure, RetargetError, Role, Side, smallest_rotation};

type Rotation = nalgebra::UnitQuaternion<f64>;

/// How the shoulder girdle goes along with the arm. Of the elevation beyond 30 degrees about a
/// third is the girdle's (Inman, Saunders and Abbott 1944, figure 22: 60 of 180 degrees). Skeletons
/// here have one joint for it, the collarbone's: it rises by 0.18 degrees for each degree and tilts
/// backwards by 0.20 where the arm swings forwards, together 0.27. More draws the chest up so far
/// that it grows.
const GIRDLE_ELEVATION: f64 = 0.18;
const GIRDLE_TILT: f64 = 0.20;

/// How far the girdle goes forwards with an arm that points forwards, in degrees; backwards alike.
const GIRDLE_PROTRACTION: f64 = 12.0;

/// Where the girdle begins to rise, in degrees of elevation of the arm.
const RHYTHM_START: f64 = 30.0;

/// Share of the forearm's rotation that the elbow joint takes; the wrist takes the rest.
const ELBOW_PRONATION: f64 = 0.5;

/// Height of the knee's joint above the ground in kneeling, in lengths of the leg.
const KNEE_CLEARANCE: f64 = 0.065;

/// Height of the wrist above the ground in leaning on the hand, in lengths of the leg.
const WRIST_CLEARANCE: f64 = 0.04;

/// Length of the hand beyond the wrist, in lengths of the leg (Winter 2009, figure 4.1: 0.108 of
/// the stature against 0.491).
const HAND_LENGTH: f64 = 0.2;

/// Shares of flexion, side bend and turn that a joint of the spine takes, from pelvis to chest: the
/// lumbar spine flexes, the thoracic spine turns (Kapandji volume 3: 60 of 105 degrees of flexion,
/// 5 of 40 degrees of turning are lumbar).
const SPINE_SHARES: [[f64; 3]; 3] = [[0.30, 0.25, 0.10], [0.40, 0.40, 0.35], [0.30, 0.35, 0.55]];

/// Turns [`BodyAngles`] into poses of one skeleton.
#[derive(Debug, Clone)]
pub struct Poser {
    skeleton: Skeleton,
    figure: Figure,
    body_from_rest: Rotation,
    /// `N_j` of upper arm, forearm, thigh and shank, `[side][bone]`.
    hanging: [[Rotation; 4]; 2],
    foot_clearances: [[f64; 2]; 2],
}

/// World rotations `P_j` of the parts of a body.
#[derive(Debug, Clone)]
struct Stance {
    world: Vec<Option<Rotation>>,
}

impl Poser {
    /// Finds the body in a skeleton.
    ///
    /// # Errors
    ///
    /// [`RetargetError::MissingJoints`], [`RetargetError::Apart`] or [`RetargetError::NoLegs`].
    pub fn new(skeleton: &Skeleton) -> Result<Self, RetargetError> {
        let figure = Figure::new(skeleton, "the body")?;
        let body_from_rest = figure.rest_from_body().inverse();
        let hanging = Side::BOTH.map(|side| {
            let down = |role: Role, parent: Rotation| {
                let bone = figure
                    .bone(role)
                    .map(|bone| parent * (body_from_rest * bone));
                let turned = bone.and_then(|bone| smallest_rotation(&bone, &-Vector::y()));
                turned.map_or(parent, |turned| turned * parent)
            };
            let upper_arm = down(Role::Shoulder(side), Rotation::identity());
            let thigh = down(Role::Hip(side), Rotation::identity());
            [
                upper_arm,
                down(Role::Elbow(side), upper_arm),
                thigh,
                down(Role::Knee(side), thigh),
            ]
        });
        let height = |role: Role| {
            let joint = figure.joint(role)?;
            Some((body_from_rest * figure.position(joint)).y)
        };
        let joints = 0..skeleton.num_joints();
        let heights = joints.map(|joint| (body_from_rest * figure.position(joint)).y);
        // The ball of the foot lies about 25 mm above the sole.
        let floor = heights.fold(f64::INFINITY, f64::min) - 0.03 * figure.leg_length();
        let foot_clearances = Side::BOTH.map(|side| {
            [Role::Ankle(side), Role::Foot(side)]
                .map(|role| height(role).map_or(0.0, |height| height - floor))
        });
        Ok(Self {
            skeleton: skeleton.clone(),
            figure,
            body_from_rest,
            hanging,
            foot_clearances,
        })
    }

    /// The skeleton that is posed.
    pub fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    /// The pose of these angles. Legs that stand on the ground reach it: the one that is longer
    /// bends until both do, or a lunge rises. Elbows bend before hands run into the ground. The
    /// pelvis is above the origin; the lowest joint is about as high above y = 0 as the skin asks
    /// for.
    pub fn pose(&self, angles: &BodyAngles) -> Pose {
        let angles = self.planted(angles);
        self.placed(&self.stance(&angles))
    }

    /// The angles with legs and hands that reach the ground.
    fn planted(&self, angles: &BodyAngles) -> BodyAngles {
        let mut angles = *angles;
        if angles.legs.iter().all(|leg| leg.is_planted) {
            let heights = Side::BOTH.map(|side| self.leg_height(&angles, side));
            let lower = usize::from(heights[1] < heights[0]);
            // A lunge on a straight leg rises; what is left to do, the bend of the longer leg does.
            let knees = angles.legs.map(|leg| leg.knee);
            if knees[lower] < 15.0 && knees[1 - lower] > 30.0 {
                self.level(&mut angles, lower, 1 - lower, straightened);
            }
            self.level(&mut angles, lower, lower, bent);
        }
        if angles.hands_planted {
            let given = angles;
            let lean = |angles: &mut BodyAngles, lean: f64| {
                angles.pelvis.flexion = given.pelvis.flexion + lean;
            };
            // Leaning forwards brings the hands down.
            let turn = first_crossing(-30.0, 30.0, |turn| {
                lean(&mut angles, turn);
                let legs = Side::BOTH.map(|side| self.leg_height(&angles, side));
                legs[0].min(legs[1]) - self.hand_height(&angles)
            });
            lean(&mut angles, turn);
        } else if angles.legs.iter().any(|leg| leg.is_planted) {
            let given = angles.arms;
            let bend = first_crossing(0.0, 90.0, |bend| {
                for (arm, given) in angles.arms.iter_mut().zip(given) {
                    arm.elbow = (given.elbow + bend).min(150.0);
                }
                let legs = Side::BOTH.map(|side| self.leg_height(&angles, side));
                self.hand_height(&angles)
                    - HAND_LENGTH * self.figure.leg_length()
                    - legs[0].min(legs[1])
            });
            for (arm, given) in angles.arms.iter_mut().zip(given) {
                arm.elbow = (given.elbow + bend).min(150.0);
            }
        }
        angles
    }

    /// Changes leg `moved` until leg `lower` is as high as the other.
    fn level(
        &self,
        angles: &mut BodyAngles,
        lower: usize,
        moved: usize,
        change: fn(Leg, f64) -> Leg,
    ) {
        let given = angles.legs[moved];
        let amount = first_crossing(0.0, 40.0, |amount| {
            angles.legs[moved] = change(given, amount);
            let heights = Side::BOTH.map(|side| self.leg_height(angles, side));
            heights[lower] - heights[1 - lower]
        });
        angles.legs[moved] = change(given, amount);
    }

    /// Height of what is lowest of a leg, above the pelvis, in metres.
    fn leg_height(&self, angles: &BodyAngles, side: Side) -> f64 {
        let pose = self.unplaced(&self.stance(angles));
        let Ok(transforms) = self.skeleton.transforms(&pose) else {
            return 0.0;
        };
        let [ankle, ball] = self.foot_clearances[side.index()];
        let clearances = [
            (Role::Ankle(side), ankle),
            (Role::Foot(side), ball),
            (Role::Knee(side), KNEE_CLEARANCE * self.figure.leg_length()),
        ];
        let heights = clearances.into_iter().filter_map(|(role, clearance)| {
            let joint = self.figure.joint(role)?;
            let position = transforms[joint] * self.skeleton.joints()[joint].rest_position;
            Some(f64::from(position.y) - clearance)
        });
        heights.fold(f64::INFINITY, f64::min)
    }

    fn hand_height(&self, angles: &BodyAngles) -> f64 {
        let pose = self.unplaced(&self.stance(angles));
        let Ok(transforms) = self.skeleton.transforms(&pose) else {
            return 0.0;
        };
        let heights = Side::BOTH.into_iter().filter_map(|side| {
            let joint = self.figure.joint(Role::Wrist(side))?;
            let position = transforms[joint] * self.skeleton.joints()[joint].rest_position;
            Some(f64::from(position.y) - WRIST_CLEARANCE * self.figure.leg_length())
        });
        heights.fold(f64::INFINITY, f64::min)
    }

    fn stance(&self, angles: &BodyAngles) -> Stance {
        let mut stance = Stance {
            world: vec![None; self.skeleton.num_joints()],
        };
        let turn = Rotation::from_scaled_axis(Vector::y() * angles.pelvis.turn.to_radians());
        let tilt = Rotation::from_scaled_axis(Vector::x() * angles.pelvis.flexion.to_radians());
        let side = Rotation::from_scaled_axis(Vector::z() * -angles.pelvis.side.to_radians());
        let pelvis = turn * tilt * side;

        let trunk = self.figure.trunk();
        stance.world[self.figure.pelvis()] = Some(pelvis);
        let shares = spine_shares(trunk.len().saturating_sub(1));
        let bend = angles.spine.rotation_vector();
        let mut chest = pelvis;
        for (&joint, [flexion, side, turn]) in trunk.iter().skip(1).zip(shares) {
            let local = Vector::new(flexion * bend.x, turn * bend.y, side * bend.z);
            chest *= Rotation::from_scaled_axis(local);
            stance.world[joint] = Some(chest);
        }
        if let Some(head) = self.figure.joint(Role::Head) {
            let neck = self.figure.neck();
            let part = angles.neck.rotation_vector() / (neck.len() + 1) as f64;
            let mut world = chest;
            for &joint in neck.iter().chain([&head]) {
                world *= Rotation::from_scaled_axis(part);
                stance.world[joint] = Some(world);
            }
        }
        for side in Side::BOTH {
            self.set_arm(&mut stance, chest, &angles.arms[side.index()], side);
            self.set_leg(&mut stance, pelvis, &angles.legs[side.index()], side);
        }
        for rotation in stance.world.iter_mut().flatten() {
            *rotation *= self.body_from_rest;
        }
        stance
    }

    fn set_arm(&self, stance: &mut Stance, chest: Rotation, arm: &Arm, side: Side) {
        let sign = side.sign();
        let [upper_arm_hangs, forearm_hangs, _, _] = self.hanging[side.index()];
        let elevation = arm.flexion.hypot(arm.abduction);
        let raised = (elevation - RHYTHM_START).max(0.0);
        let elevated = arm.shrug + GIRDLE_ELEVATION * raised;
        let tilted = GIRDLE_TILT * raised * arm.flexion / elevation.max(1.0);
        let forward = -(ball([arm.flexion, arm.abduction, 0.0], side) * Vector::y()).z;
        let protracted = arm.protraction + GIRDLE_PROTRACTION * forward;
        let collar = Vector::new(-tilted, -sign * protracted, sign * elevated).map(f64::to_radians);
        let turned = |rotation: Rotation, axis: Vector<f64>, degrees: f64| {
            rotation * Rotation::from_scaled_axis(axis * degrees.to_radians())
        };
        let upper_arm = chest * ball([arm.flexion, arm.abduction, arm.rotation], side);
        let forearm = turned(upper_arm, Vector::x(), -arm.elbow);
        // Pronation turns the thumb of a hanging arm from the front inwards.
        let forearm = turned(
            forearm,
            Vector::y(),
            -sign * arm.pronation * ELBOW_PRONATION,
        );
        let hand = turned(
            forearm,
            Vector::y(),
            -sign * arm.pronation * (1.0 - ELBOW_PRONATION),
        );
        // At zero the palm faces the thigh and the thumb the front.
        let bend = Vector::new(-arm.deviation, 0.0, -sign * arm.wrist).map(f64::to_radians);
        let hand = hand * Rotation::from_scaled_axis(bend);
        stance.set(
            &self.figure,
            Role::Collar(side),
            chest * Rotation::from_scaled_axis(collar),
        );
        stance.set(
            &self.figure,
            Role::Shoulder(side),
            upper_arm * upper_arm_hangs,
        );
        stance.set(&self.figure, Role::Elbow(side), forearm * forearm_hangs);
        stance.set(&self.figure, Role::Wrist(side), hand * forearm_hangs);
    }

    fn set_leg(&self, stance: &mut Stance, pelvis: Rotation, leg: &Leg, side: Side) {
        let [_, _, thigh_hangs, shank_hangs] = self.hanging[side.index()];
        let about_x = |degrees: f64| Rotation::from_scaled_axis(Vector::x() * degrees.to_radians());
        let thigh = pelvis * ball([leg.flexion, leg.abduction, leg.rotation], side);
        let shank = thigh * about_x(leg.knee);
        let mut foot = shank * about_x(-leg.ankle);
        if leg.sole > 0.0 {
            let left = shank * Vector::x();
            let heading = -left.z.atan2(left.x);
            let level = Rotation::from_scaled_axis(Vector::y() * heading);
            foot = foot
                .try_slerp(&level, leg.sole.min(1.0), 1e-9)
                .unwrap_or(level);
        }
        stance.set(&self.figure, Role::Hip(side), thigh * thigh_hangs);
        stance.set(&self.figure, Role::Knee(side), shank * shank_hangs);
        stance.set(&self.figure, Role::Ankle(side), foot);
        stance.set(&self.figure, Role::Foot(side), foot);
    }

    /// The pose with its root where it is at rest.
    fn unplaced(&self, stance: &Stance) -> Pose {
        let mut world = vec![Rotation::identity(); self.skeleton.num_joints()];
        let mut pose = Pose::rest(self.skeleton.num_joints());
        for &index in self.skeleton.parents_first() {
            let parent = self.skeleton.joints()[index]
                .parent
                .map(|parent| world[parent]);
            let parent = parent.unwrap_or_else(Rotation::identity);
            world[index] = stance.world[index].unwrap_or(parent);
            let local = parent.inverse() * world[index];
            pose.rotations[index] =
                nalgebra::UnitQuaternion::new_normalize(local.into_inner().cast());
        }
        pose
    }

    fn placed(&self, stance: &Stance) -> Pose {
        let mut pose = self.unplaced(stance);
        let Ok(transforms) = self.skeleton.transforms(&pose) else {
            return pose;
        };
        let at = |joint: usize| transforms[joint] * self.skeleton.joints()[joint].rest_position;
        let pelvis = at(self.figure.pelvis());
        let lowest = (0..self.skeleton.num_joints()).map(|joint| f64::from(at(joint).y));
        let lowest = lowest.fold(f64::INFINITY, f64::min);
        let ball = self.foot_clearances[0][1];
        pose.root_translation = Vector3::new(-pelvis.x, (ball - lowest) as f32, -pelvis.z);
        pose
    }
}

impl Stance {
    fn set(&mut self, figure: &Figure, role: Role, rotation: Rotation) {
        if let Some(joint) = figure.joint(role) {
            self.world[joint] = Some(rotation);
        }
    }
}

/// A leg that bends without moving its foot out of the line from the hip.
fn bent(leg: Leg, degrees: f64) -> Leg {
    Leg {
        flexion: leg.flexion + degrees,
        knee: leg.knee + 2.0 * degrees,
        ..leg
    }
}

/// A leg whose thigh comes down while its shank keeps its direction.
fn straightened(leg: Leg, degrees: f64) -> Leg {
    let swing = leg.flexion.hypot(leg.abduction);
    let kept = if swing > degrees {
        1.0 - degrees / swing
    } else {
        0.0
    };
    Leg {
        flexion: kept * leg.flexion,
        abduction: kept * leg.abduction,
        knee: (leg.knee - degrees).max(0.0),
        ..leg
    }
}

/// Heights that differ by less are level, in metres.
const LEVEL: f64 = 1e-3;

/// The first place at which a height that starts below zero reaches it; the start if it is there
/// already, the end if it never does.
fn first_crossing(start: f64, end: f64, mut function: impl FnMut(f64) -> f64) -> f64 {
    const STEPS: u32 = 8;
    if function(start) >= -LEVEL {
        return start;
    }
    let at = |step: u32| start + (end - start) * f64::from(step) / f64::from(STEPS);
    let Some(step) = (1..=STEPS).find(|&step| function(at(step)) >= 0.0) else {
        return end;
    };
    let (mut low, mut high) = (at(step - 1), at(step));
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if function(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Shares of a spine with `num_joints` joints above the pelvis, `[joint][flexion, side, turn]`.
fn spine_shares(num_joints: usize) -> Vec<[f64; 3]> {
    if num_joints == SPINE_SHARES.len() {
        return SPINE_SHARES.to_vec();
    }
    vec![[1.0 / num_joints.max(1) as f64; 3]; num_joints]
}
