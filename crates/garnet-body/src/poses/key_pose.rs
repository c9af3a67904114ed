//! Key poses by name, and the words that the library is written in.

use super::{Arm, Bend, BodyAngles, Group, Leg, library};

/// A pose of the library, with its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeyPose {
    /// Its name.
    pub name: &'static str,
    /// Its angles.
    pub angles: BodyAngles,
}

/// All key poses of the library, by group.
pub fn key_poses() -> impl Iterator<Item = &'static KeyPose> {
    let groups = [Group::Everyday, Group::Yoga, Group::Dance, Group::Reach];
    groups.into_iter().flat_map(key_poses_of)
}

/// The key poses of a group; none of [`Group::Walk`], whose poses are those of the gait cycle.
///
/// ```
/// use garnet_body::poses::{Group, key_poses_of};
///
/// assert!(key_poses_of(Group::Yoga).iter().any(|pose| pose.name == "warrior_two"));
/// assert!(key_poses_of(Group::Walk).is_empty());
/// ```
pub const fn key_poses_of(group: Group) -> &'static [KeyPose] {
    match group {
        Group::Everyday => library::EVERYDAY,
        Group::Yoga => library::YOGA,
        Group::Dance => library::DANCE,
        Group::Reach => library::REACH,
        Group::Walk => &[],
    }
}

/// The key pose of a name.
pub fn key_pose(name: &str) -> Option<&'static KeyPose> {
    key_poses().find(|pose| pose.name == name)
}

/// Standing, arms hanging.
pub(super) const fn pose(name: &'static str) -> KeyPose {
    const NONE: Bend = bend(0.0, 0.0, 0.0);
    KeyPose {
        name,
        angles: BodyAngles {
            pelvis: NONE,
            spine: NONE,
            neck: NONE,
            legs: [STAND; 2],
            arms: [HANG; 2],
            hands_planted: false,
        },
    }
}

/// A standing leg.
pub(super) const STAND: Leg = leg(0.0, 4.0, 6.0).sole();

/// A hanging arm.
pub(super) const HANG: Arm = arm(2.0, 9.0, 0.0).elbow(12.0).pronation(20.0);

pub(super) const fn bend(flexion: f64, side: f64, turn: f64) -> Bend {
    Bend {
        flexion,
        side,
        turn,
    }
}

/// Flexion, abduction and outward rotation of the hip.
pub(super) const fn leg(flexion: f64, abduction: f64, rotation: f64) -> Leg {
    Leg {
        flexion,
        abduction,
        rotation,
        knee: 0.0,
        ankle: 0.0,
        sole: 0.0,
        is_planted: false,
    }
}

/// Flexion, abduction and outward rotation of the shoulder.
pub(super) const fn arm(flexion: f64, abduction: f64, rotation: f64) -> Arm {
    Arm {
        shrug: 0.0,
        protraction: 0.0,
        flexion,
        abduction,
        rotation,
        elbow: 0.0,
        pronation: 0.0,
        wrist: 0.0,
        deviation: 0.0,
    }
}

impl Leg {
    pub(super) const fn knee(mut self, degrees: f64) -> Self {
        self.knee = degrees;
        self
    }

    pub(super) const fn ankle(mut self, degrees: f64) -> Self {
        self.ankle = degrees;
        self
    }

    /// Stands on the whole sole.
    pub(super) const fn sole(mut self) -> Self {
        self.sole = 1.0;
        self.is_planted = true;
        self
    }

    /// Stands on toes or knee.
    pub(super) const fn planted(mut self) -> Self {
        self.is_planted = true;
        self
    }
}

impl Arm {
    pub(super) const fn elbow(mut self, degrees: f64) -> Self {
        self.elbow = degrees;
        self
    }

    pub(super) const fn pronation(mut self, degrees: f64) -> Self {
        self.pronation = degrees;
        self
    }

    /// Flexion and deviation to the thumb.
    pub(super) const fn wrist(mut self, flexion: f64, deviation: f64) -> Self {
        self.wrist = flexion;
        self.deviation = deviation;
        self
    }

    /// Elevation and protraction of the collarbone.
    pub(super) const fn collar(mut self, shrug: f64, protraction: f64) -> Self {
        self.shrug = shrug;
        self.protraction = protraction;
        self
    }
}

impl KeyPose {
    /// Tilt forwards, to the left, turn to the left of the pelvis.
    pub(super) const fn pelvis(mut self, flexion: f64, side: f64, turn: f64) -> Self {
        self.angles.pelvis = bend(flexion, side, turn);
        self
    }

    pub(super) const fn spine(mut self, flexion: f64, side: f64, turn: f64) -> Self {
        self.angles.spine = bend(flexion, side, turn);
        self
    }

    pub(super) const fn neck(mut self, flexion: f64, side: f64, turn: f64) -> Self {
        self.angles.neck = bend(flexion, side, turn);
        self
    }

    pub(super) const fn legs(mut self, left: Leg, right: Leg) -> Self {
        self.angles.legs = [left, right];
        self
    }

    pub(super) const fn both_legs(self, leg: Leg) -> Self {
        self.legs(leg, leg)
    }

    pub(super) const fn arms(mut self, left: Arm, right: Arm) -> Self {
        self.angles.arms = [left, right];
        self
    }

    pub(super) const fn both_arms(self, arm: Arm) -> Self {
        self.arms(arm, arm)
    }

    pub(super) const fn on_hands(mut self) -> Self {
        self.angles.hands_planted = true;
        self
    }
}
