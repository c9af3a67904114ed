//! The gait cycle.
//!
//! Angles of hip, knee and ankle over a stride at natural speed, as read from the curves of Perry
//! and Burnfield, *Gait Analysis*, 2nd edition 2010, chapters 3 to 6, at the borders of their
//! phases (initial contact 0 %, loading 12 %, mid stance 31 %, terminal stance 50 %, pre-swing 62
//! %, initial swing 75 %, mid swing 87 %). For comparison: Winter, *The Biomechanics and Motor
//! Control of Human Gait*, 1991, table 3.3(b). Pelvis and arms: Murray, Drought and Kory 1964 and
//! Murray 1967: the pelvis turns 5 and drops 4 degrees to each side, the shoulder swings from 24
//! degrees of extension to 8 of flexion, the elbow bends between 16 and 40 degrees.
//!
//! The numbers were entered without these books at hand and are not checked against them; expect
//! single angles to be off by 5 degrees or so.

use std::f64::consts::TAU;

use super::{Arm, Bend, BodyAngles, Leg};

/// A point of a curve: share of the stride from one contact of the heel to the next, degrees.
type Node = (f64, f64);

const HIP: [Node; 9] = [
    (0.00, 22.0),
    (0.07, 21.0),
    (0.20, 9.0),
    (0.31, -2.0),
    (0.50, -18.0),
    (0.62, -8.0),
    (0.75, 16.0),
    (0.86, 26.0),
    (0.94, 24.0),
];

const KNEE: [Node; 9] = [
    (0.00, 4.0),
    (0.07, 13.0),
    (0.13, 18.0),
    (0.25, 10.0),
    (0.40, 4.0),
    (0.50, 11.0),
    (0.62, 40.0),
    (0.72, 61.0),
    (0.90, 14.0),
];

const ANKLE: [Node; 9] = [
    (0.00, 0.0),
    (0.06, -6.0),
    (0.15, 0.0),
    (0.31, 6.0),
    (0.46, 10.0),
    (0.55, -3.0),
    (0.63, -17.0),
    (0.75, -5.0),
    (0.88, 1.0),
];

/// How level the sole is held by the ground.
const SOLE: [Node; 6] = [
    (0.00, 0.0),
    (0.10, 1.0),
    (0.30, 1.0),
    (0.42, 0.0),
    (0.60, 0.0),
    (0.85, 0.0),
];

/// How a figure walks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaitCycle {
    /// Speed against the natural one, about 1.35 m/s: 0.5 strolls, 1.5 hurries. Strides grow with
    /// the square root of the speed (Grieve 1968), and with them all swings.
    pub speed: f64,
    /// How far the arms swing against the natural swing; 0 holds them still.
    pub arm_swing: f64,
}

impl Default for GaitCycle {
    fn default() -> Self {
        Self {
            speed: 1.0,
            arm_swing: 1.0,
        }
    }
}

impl GaitCycle {
    /// The pose at a phase: 0 as the left heel meets the ground, 0.5 as the right one does; only
    /// the fraction counts.
    pub fn angles(&self, phase: f64) -> BodyAngles {
        let stride = self.speed.clamp(0.1, 3.0).sqrt();
        let phase = if phase.is_finite() { phase } else { 0.0 };
        let cos = |shift: f64| (TAU * (phase - shift)).cos();
        let pelvis = Bend {
            flexion: 3.0 * stride + (2.0 * TAU * phase).cos(),
            // The side that swings drops, most in the other leg's loading.
            side: -4.0 * stride * cos(0.15),
            turn: -5.0 * stride * cos(0.0),
        };
        BodyAngles {
            pelvis,
            spine: Bend {
                flexion: 1.0,
                side: 4.0 * stride * cos(0.15),
                turn: 8.0 * stride * cos(0.0),
            },
            neck: Bend {
                flexion: -2.0,
                side: 0.0,
                turn: -3.0 * stride * cos(0.0),
            },
            // The legs stay in their planes while the pelvis drops and turns.
            legs: [
                leg(phase, stride, pelvis.side, pelvis.turn),
                leg(phase + 0.5, stride, -pelvis.side, -pelvis.turn),
            ],
            arms: [
                arm(phase, stride * self.arm_swing),
                arm(phase + 0.5, stride * self.arm_swing),
            ],
            hands_planted: false,
        }
    }
}

/// A leg under a pelvis that drops to its side and turns towards it by these angles.
fn leg(phase: f64, stride: f64, drop: f64, turn: f64) -> Leg {
    let mean = 4.0;
    Leg {
        // The tilt of the pelvis comes on top of the thigh's swing.
        flexion: mean + (periodic(&HIP, phase) - mean) * stride + 2.0,
        abduction: 1.5 + drop,
        rotation: 5.0 - turn,
        knee: (periodic(&KNEE, phase) * stride.sqrt()).max(0.0),
        ankle: periodic(&ANKLE, phase) * stride.sqrt(),
        sole: periodic(&SOLE, phase).clamp(0.0, 1.0),
        is_planted: false,
    }
}

fn arm(phase: f64, swing: f64) -> Arm {
    let back = (TAU * phase).cos();
    Arm {
        flexion: -4.0 - 16.0 * swing * back,
        abduction: 12.0,
        rotation: -4.0,
        elbow: (26.0 - 12.0 * swing * back).max(5.0),
        pronation: 18.0,
        wrist: 4.0,
        ..Arm::default()
    }
}

/// The value of a closed curve through `nodes`, whose slopes are those of parabolas through each
/// node and its neighbors.
fn periodic(nodes: &[Node], phase: f64) -> f64 {
    let phase = phase - phase.floor();
    let count = nodes.len();
    let at = |index: usize| {
        // Index 0 is the last node, one stride earlier.
        let before = index + count - 1;
        let (time, value) = nodes[before % count];
        (time + (before / count) as f64 - 1.0, value)
    };
    let after = nodes
        .iter()
        .position(|&(time, _)| time > phase)
        .unwrap_or(count);
    let [p0, p1, p2, p3] = [
        at(after.saturating_sub(1)),
        at(after),
        at(after + 1),
        at(after + 2),
    ];
    let slope = |a: Node, b: Node, c: Node| {
        let (before, behind) = ((b.1 - a.1) / (b.0 - a.0), (c.1 - b.1) / (c.0 - b.0));
        (before * (c.0 - b.0) + behind * (b.0 - a.0)) / (c.0 - a.0)
    };
    let length = p2.0 - p1.0;
    let t = (phase - p1.0) / length;
    let (m1, m2) = (length * slope(p0, p1, p2), length * slope(p1, p2, p3));
    let (t2, t3) = (t * t, t * t * t);
    (2.0 * t3 - 3.0 * t2 + 1.0) * p1.1
        + (t3 - 2.0 * t2 + t) * m1
        + (3.0 * t2 - 2.0 * t3) * p2.1
        + (t3 - t2) * m2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_pass_through_their_nodes_and_close() {
        for nodes in [&HIP[..], &KNEE, &ANKLE, &SOLE] {
            for &(time, value) in nodes {
                assert!((periodic(nodes, time) - value).abs() < 1e-9, "{time}");
                assert!((periodic(nodes, time + 3.0) - value).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn curves_are_smooth() {
        const STEP: f64 = 1e-4;
        for nodes in [&HIP[..], &KNEE, &ANKLE] {
            let slope =
                |phase: f64| (periodic(nodes, phase + STEP) - periodic(nodes, phase)) / STEP;
            for step in 0..1000 {
                let phase = f64::from(step) / 1000.0;
                let jump = (slope(phase) - slope(phase - STEP)).abs();
                assert!(jump < 5.0, "the slope jumps by {jump} at {phase}");
            }
        }
    }

    #[test]
    fn half_a_stride_later_left_and_right_have_changed() {
        let gait = GaitCycle::default();
        for step in 0..20 {
            let phase = f64::from(step) / 20.0;
            let (now, later) = (gait.angles(phase), gait.angles(phase + 0.5).mirrored());
            for (now, later) in now.to_array().into_iter().zip(later.to_array()) {
                assert!((now - later).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn knees_never_bend_backwards_and_all_angles_stay_in_range() {
        for speed in [0.4, 1.0, 1.8] {
            for step in 0..200 {
                let gait = GaitCycle {
                    speed,
                    ..GaitCycle::default()
                };
                let angles = gait.angles(f64::from(step) / 200.0);
                assert!(angles.legs.iter().all(|leg| leg.knee >= 0.0));
                assert_eq!(angles.beyond_ranges(), Vec::new());
            }
        }
    }
}
