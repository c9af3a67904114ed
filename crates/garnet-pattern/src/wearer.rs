//! The person for whom a garment is cut, or who wears it.

use crate::PatternError;

/// A point in the frame of the body: metres, Y up, +Z to the front, feet on y = 0.
pub type Landmark = [f64; 3];

/// Tape measures, in metres; heights are above the floor, girths are around convex hulls.
///
/// The definitions are those of the built-in body's tape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measures {
    /// Height of the body.
    pub stature: f64,
    /// Girth at the chest height, below the armpits.
    pub chest: f64,
    /// Girth at the waist height.
    pub waist: f64,
    /// Girth at the hip height.
    pub hip: f64,
    /// Girth of the thigh below the crotch.
    pub thigh: f64,
    /// Girth at the knee.
    pub knee: f64,
    /// Girth of the calf.
    pub calf: f64,
    /// Girth of the ankle.
    pub ankle: f64,
    /// Girth of the relaxed upper arm.
    pub upper_arm: f64,
    /// Girth of the relaxed forearm.
    pub forearm: f64,
    /// Girth of the wrist.
    pub wrist: f64,
    /// Girth of the neck.
    pub neck: f64,
    /// Breadth between the acromia.
    pub shoulder_breadth: f64,
    /// Length from the acromion over the elbow to the wrist.
    pub arm_length: f64,
    /// Height of the crotch.
    pub inseam: f64,
    /// Height of the acromion.
    pub shoulder_height: f64,
    /// Height of the neck's base, where the neck leaves the shoulders: that of the neck joint.
    pub neck_height: f64,
    /// Height of the chest girth.
    pub chest_height: f64,
    /// Height of the waist girth.
    pub waist_height: f64,
    /// Height of the hip girth.
    pub hip_height: f64,
    /// Height of the knee.
    pub knee_height: f64,
}

impl Measures {
    /// Name and value of each, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, f64)> {
        [
            ("stature", self.stature),
            ("chest", self.chest),
            ("waist", self.waist),
            ("hip", self.hip),
            ("thigh", self.thigh),
            ("knee", self.knee),
            ("calf", self.calf),
            ("ankle", self.ankle),
            ("upper arm", self.upper_arm),
            ("forearm", self.forearm),
            ("wrist", self.wrist),
            ("neck", self.neck),
            ("shoulder breadth", self.shoulder_breadth),
            ("arm length", self.arm_length),
            ("inseam", self.inseam),
            ("shoulder height", self.shoulder_height),
            ("neck height", self.neck_height),
            ("chest height", self.chest_height),
            ("waist height", self.waist_height),
            ("hip height", self.hip_height),
            ("knee height", self.knee_height),
        ]
        .into_iter()
    }

    /// Checks that a body can have these measures.
    ///
    /// # Errors
    ///
    /// [`PatternError::BadWearer`].
    pub fn check(&self) -> Result<(), PatternError> {
        for (what, value) in self.iter() {
            if !(0.08..=2.6).contains(&value) {
                return Err(PatternError::BadWearer { what, value });
            }
        }
        let heights = [
            ("inseam", self.knee_height, self.inseam),
            // Buttocks may protrude most as low as the crotch.
            ("hip height", self.inseam - 0.05, self.hip_height),
            ("waist height", self.hip_height, self.waist_height),
            ("chest height", self.waist_height, self.chest_height),
            ("shoulder height", self.chest_height, self.shoulder_height),
            ("neck height", self.shoulder_height, self.neck_height),
            ("stature", self.neck_height, self.stature),
        ];
        for (what, below, value) in heights {
            if value < below + 0.01 {
                return Err(PatternError::BadWearer { what, value });
            }
        }
        Ok(())
    }

    /// The same on legs that are so many times as long: what is above them keeps its size.
    pub(crate) fn lengthen_legs(&mut self, factor: f64) {
        let longer = (factor - 1.0) * self.inseam;
        self.knee_height *= factor;
        for height in [
            &mut self.inseam,
            &mut self.hip_height,
            &mut self.waist_height,
            &mut self.chest_height,
            &mut self.shoulder_height,
            &mut self.neck_height,
            &mut self.stature,
        ] {
            *height += longer;
        }
    }

    /// The height of the shoulder joint.
    pub(crate) fn shoulder_joint_height(&self) -> f64 {
        self.shoulder_height - 0.026 * self.stature
    }

    /// The height of the armpit.
    pub(crate) fn armpit_height(&self) -> f64 {
        self.shoulder_joint_height() - 0.074 * self.stature
    }

    /// The girth that a waistband at a height is cut for: that of the trunk, or less than the hip's
    /// under a belly that is wider, since trousers that are cut for the belly fall.
    pub(crate) fn band_girth(&self, height: f64) -> f64 {
        self.trunk_girth(height).min(WIDEST_BAND * self.hip)
    }

    /// The girth of the trunk at a height between hip and chest.
    pub(crate) fn trunk_girth(&self, height: f64) -> f64 {
        if height < self.waist_height {
            let above = (height - self.hip_height) / (self.waist_height - self.hip_height);
            let share = above.clamp(0.0, 1.0).powf(HIGH_HIP);
            return self.hip + (self.waist - self.hip) * share;
        }
        crate::curve::interpolated(
            &[
                (self.waist_height, self.waist),
                (self.chest_height, self.chest),
            ],
            height,
        )
    }
}

/// A waistband is cut no wider than for this share of the hip.
pub(crate) const WIDEST_BAND: f64 = 0.97;

/// How the girth goes from the hip (0) to the waist (1): by this power of the height between them.
/// The hips stay wide a third of the way up; of the built-in body this is within 2 % of its girths.
const HIGH_HIP: f64 = 1.6;

/// Joints of the left side and the middle of the rest pose, with the names of SMPL.
///
/// Garments are mirror images of themselves, so the right side is that of the left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landmarks {
    /// The pelvis.
    pub pelvis: Landmark,
    /// The lower, middle and upper joint of the spine.
    pub spine: [Landmark; 3],
    /// The base of the neck.
    pub neck: Landmark,
    /// The left collar.
    pub collar: Landmark,
    /// The left shoulder.
    pub shoulder: Landmark,
    /// The left elbow.
    pub elbow: Landmark,
    /// The left wrist.
    pub wrist: Landmark,
    /// The left hip.
    pub hip: Landmark,
    /// The left knee.
    pub knee: Landmark,
    /// The left ankle.
    pub ankle: Landmark,
}

impl Landmarks {
    /// Reads the joints by their SMPL names, as in `left_shoulder`.
    ///
    /// # Errors
    ///
    /// [`PatternError::BadWearer`] if one is missing.
    pub fn from_joints(joint: impl Fn(&str) -> Option<Landmark>) -> Result<Self, PatternError> {
        let find = |what: &'static str| {
            joint(what).ok_or(PatternError::BadWearer {
                what,
                value: f64::NAN,
            })
        };
        Ok(Self {
            pelvis: find("pelvis")?,
            spine: [find("spine1")?, find("spine2")?, find("spine3")?],
            neck: find("neck")?,
            collar: find("left_collar")?,
            shoulder: find("left_shoulder")?,
            elbow: find("left_elbow")?,
            wrist: find("left_wrist")?,
            hip: find("left_hip")?,
            knee: find("left_knee")?,
            ankle: find("left_ankle")?,
        })
    }

    fn named(&self) -> [(&'static str, Landmark); 12] {
        [
            ("pelvis", self.pelvis),
            ("spine1", self.spine[0]),
            ("spine2", self.spine[1]),
            ("spine3", self.spine[2]),
            ("neck", self.neck),
            ("left_collar", self.collar),
            ("left_shoulder", self.shoulder),
            ("left_elbow", self.elbow),
            ("left_wrist", self.wrist),
            ("left_hip", self.hip),
            ("left_knee", self.knee),
            ("left_ankle", self.ankle),
        ]
    }
}

/// A body at rest, as a tailor knows it: measures and landmarks.
///
/// It stands in the A-pose: arms down by about 45 degrees, legs a little apart, feet on y = 0,
/// looking along +Z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wearer {
    /// Tape measures.
    pub measures: Measures,
    /// Joints of the rest pose.
    pub landmarks: Landmarks,
}

impl Wearer {
    /// Checks measures and landmarks.
    ///
    /// # Errors
    ///
    /// [`PatternError::BadWearer`].
    pub fn check(&self) -> Result<(), PatternError> {
        self.measures.check()?;
        for (what, at) in self.landmarks.named() {
            if let Some(&value) = at.iter().find(|value| value.is_nan() || value.abs() > 3.0) {
                return Err(PatternError::BadWearer { what, value });
            }
        }
        let marks = &self.landmarks;
        let sides = [
            ("left_hip", marks.hip),
            ("left_shoulder", marks.shoulder),
            ("left_knee", marks.knee),
        ];
        for (what, at) in sides {
            if at[0] < 0.02 {
                return Err(PatternError::BadWearer { what, value: at[0] });
            }
        }
        let arm = marks.wrist[0] - marks.shoulder[0];
        if arm < 0.1 {
            return Err(PatternError::BadWearer {
                what: "left_wrist",
                value: marks.wrist[0],
            });
        }
        Ok(())
    }
}
