//! The wearer of the mean pattern.

use crate::wearer::{Landmarks, Measures, Wearer};

/// The built-in body half-way between the sexes, 1.72 m tall, with a body mass index of 23.
pub(crate) const REFERENCE: Wearer = Wearer {
    measures: Measures {
        stature: 1.720,
        chest: 0.953,
        waist: 0.833,
        hip: 0.980,
        thigh: 0.590,
        knee: 0.368,
        calf: 0.371,
        ankle: 0.218,
        upper_arm: 0.296,
        forearm: 0.268,
        wrist: 0.164,
        neck: 0.352,
        shoulder_breadth: 0.389,
        arm_length: 0.584,
        inseam: 0.828,
        shoulder_height: 1.407,
        neck_height: 1.466,
        chest_height: 1.252,
        waist_height: 1.041,
        hip_height: 0.881,
        knee_height: 0.478,
    },
    landmarks: Landmarks {
        pelvis: [0.0, 0.925, -0.012],
        spine: [
            [0.0, 1.032, -0.022],
            [0.0, 1.142, -0.029],
            [0.0, 1.277, -0.041],
        ],
        neck: [0.0, 1.466, -0.043],
        collar: [0.035, 1.395, -0.020],
        shoulder: [0.171, 1.361, -0.022],
        elbow: [0.380, 1.152, -0.028],
        wrist: [0.555, 0.966, 0.014],
        hip: [0.086, 0.882, -0.006],
        knee: [0.146, 0.470, 0.006],
        ankle: [0.184, 0.075, -0.028],
    },
};

impl Wearer {
    /// The wearer of the mean pattern: half-way between the sexes, 1.72 m tall, body mass index 23.
    pub const fn reference() -> Self {
        REFERENCE
    }
}
