//! How long and how finely a scene is simulated.

mod check;
mod partial;

pub use self::check::MAX_SUBSTEPS;
pub use self::partial::SettleFrames;

/// How accurate a drape has to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quality {
    /// For looking: the teacher's way with contacts looked for half as often, and a third of its
    /// time to settle.
    Fast,
    /// For ground truth: still finer steps change the strain by less than poses and cut do.
    Teacher,
    /// For comparison: the teacher's way, and in the end balance, by the
    /// [reference solver](crate::reference).
    Reference,
}

/// The steps of a simulation, all counted before it begins.
///
/// No step depends on the state of the cloth: a stop that comes one step earlier for one body than
/// for the next would be a jump between their drapes. The run is the body's motion, then stages in
/// which the cloth settles on the body in its last place.
///
/// XPBD with one iteration is soft at a low rate: the strain that it adds is about 2 g L h² / Δx²
/// for a length L that hangs from edges Δx long, with substeps of h. So rates grow as 1/Δx.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// Simulated time between two frames, in seconds: how long the body takes from one position to
    /// the next, and how often events are sent.
    pub frame_seconds: f32,
    /// Into how many frames the motion is cut; 0 if the body stands still where it is at time 1.
    pub motion_frames: u32,
    /// From which share of the motion's time to which other one it is simulated: 0 to 1 for all of
    /// it.
    pub motion_part: [f32; 2],
    /// Substeps a second during the motion.
    pub motion_rate: f32,
    /// Share of the fabric's friction against skin that acts during the motion.
    pub motion_friction: f32,
    /// How the cloth settles after the motion.
    pub stages: Vec<Stage>,
    /// In how many steps at most the [reference solver](crate::reference) brings the cloth into
    /// balance after that; 0 leaves it.
    pub balance_steps: u32,
    /// How often in a frame contacts are looked for anew.
    pub refreshes_per_frame: u32,
    /// Cloth that comes near cloth is looked for at one of so many refreshes.
    pub pair_interval: u32,
    /// Hinges are projected once in so many substeps.
    pub bending_interval: u32,
    /// Into how many patches the cloth is cut, whose substeps run side by side. A drape changes
    /// with their number as it does with any order in which constraints are projected, but not with
    /// the number of threads.
    pub patches: u32,
    /// During how many frames rest lengths go from those of the start to their own. Garments that
    /// start larger than they are cut shrink onto the body instead of snapping.
    pub contraction_frames: u32,
    /// Share of their rest lengths that springs are taken to have. One projection a substep leaves
    /// springs soft, and cloth sags: at a low rate shorter ones hang as long as those of a higher
    /// rate do.
    pub length_share: f32,
    /// What corrections of the lengths of springs are multiplied by: above 1 they are over-relaxed,
    /// and springs are stiffer at the same rate; far above it cloth trembles.
    pub over_relaxation: f32,
    /// Velocity lost to the air, 1/s.
    pub drag: f32,
    /// Rate at which cloth takes the velocity of the air that goes along with the body, 1/s. Cloth
    /// that lags behind and swings finds other folds for each body: this leaves it the way that
    /// skinning would take it, and the settling has to find the folds.
    pub carry: f32,
    /// No vertex becomes faster than this, m/s.
    pub max_speed: f32,
    /// Vertices are pushed apart and out of the skin at no more than this, m/s.
    pub max_push_speed: f32,
    /// Acceleration downwards (along −y), m/s².
    pub gravity: f32,
    /// How cloth is kept from running through itself.
    pub self_contact: SelfContact,
}

/// One stage of settling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// How many frames it lasts.
    pub frames: u32,
    /// Substeps a second.
    pub rate: f32,
    /// Velocity lost beyond that which is lost to the air, 1/s.
    pub extra_drag: f32,
    /// Share of the fabric's friction against skin that acts.
    pub friction: f32,
}

/// How cloth is kept from running through itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SelfContact {
    /// Not at all.
    Off,
    /// Vertices repel each other.
    Repulsion {
        /// The distance that they keep, over the mean length of the edges around.
        distance: f32,
        /// Pairs that start nearer keep the distance of the start, or at least this share of the
        /// full one: 1 for garments of one layer; less so that pockets and collars are not blown
        /// up.
        least: f32,
    },
}

/// Gravity in production, in m/s²: the standard of the SI.
pub const STANDARD_GRAVITY: f32 = 9.80665;

/// Substeps a second of the motion and of the first stage for each metre of 1/Δx: less is cheaper,
/// and leaves more strain for the stages that follow.
const FIRST_RATE: f32 = 34.0;

/// [`Schedule::drag`], 1/s: less lets cloth swing longer, more slows what falls.
const DRAG: f32 = 10.0;

/// [`Schedule::max_speed`], m/s, faster than limbs move: less holds cloth back, far more lets a
/// vertex that was thrown pass through what it meets within a substep.
const MAX_SPEED: f32 = 8.0;

/// [`Schedule::max_push_speed`], m/s: less lets cloth stay inside longer, more throws it off.
const MAX_PUSH_SPEED: f32 = 0.2;

/// Share of the distance between vertices that those of several layers keep at least, which start
/// near each other: more blows pockets and collars up, less lets them run through each other.
const LEAST_REPULSION: f32 = 0.5;

/// Substeps a second of the second and the last stage for each metre of 1/Δx.
///
/// More is stiffer, and cloth that was stretched in the motion rises and slides anew; less leaves
/// more strain. Tried: 41 to 75 (docs/experiments/004-teacher-schedule.md).
pub(crate) const LAST_RATE: f32 = 54.0;

/// Extra drag of the last stage, 1/s: cloth that swings on comes to rest; cloth out of balance
/// still falls, at 0.08 m/s, sixteen times what counts as moving. Less lets it swing on.
const LAST_DRAG: f32 = 120.0;

/// Extra drag of the first stage, 1/s: cloth falls at 0.25 m/s at most, and comes to its folds
/// without swinging.
///
/// Less makes drapes of alike bodies differ more; the same in all stages leaves loose cloth
/// creeping in the end (docs/experiments/004-teacher-schedule.md).
const FIRST_DRAG: f32 = 30.0;

/// Rate of [`Schedule::carry`], 1/s: more binds cloth closer to where skinning would take it.
/// Tried: 100 to 1000 are alike (docs/experiments/004-teacher-schedule.md).
const CARRY: f32 = 300.0;

/// How long the body takes to its last place, in seconds. Less is cheaper, and cloth lags behind
/// and ends in other folds. Tried: 0.5 (docs/experiments/004-teacher-schedule.md).
const MOTION_SECONDS: f32 = 1.0;

/// Frames of the motion and of the three stages of settling. More bring more cloth to rest
/// (docs/experiments/004-teacher-schedule.md).
pub(crate) const TEACHER_FRAMES: [u32; 4] = [60, 45, 75, 45];

/// The same, each twice as long, in [`Quality::Fast`].
///
/// How far that ends from the teacher is measured by `garnet-lab branching 5000 12`.
const FAST_FRAMES: [u32; 4] = [30, 15, 12, 6];

/// Hinges of cloth that somebody waits for are projected once in so many substeps: more is cheaper
/// and leaves cloth softer in bending. Tried: 2 and 4
/// (docs/experiments/003-cloth-that-somebody-waits-for.md).
pub(crate) const RARELY: u32 = 4;

/// Patches of cloth that somebody waits for, each with a thread of its own; the teacher's scenes
/// have one each. Tried: 1 and 2 (docs/experiments/003-cloth-that-somebody-waits-for.md).
const PATCHES: u32 = 2;

/// Steps of the reference solver at most: more only for cloth that is slow to balance
/// (docs/experiments/004-teacher-schedule.md).
const BALANCE_STEPS: u32 = 60;

/// Share of the friction that acts until the cloth has come to rest the first times.
///
/// Somebody who takes up a pose moves a little all the time, and cloth slides where it would stick:
/// with all of the friction it keeps the strain of the way there.
pub(crate) const SHAKEN: f32 = 0.3;

/// Distance that vertices keep from each other, over the length of the edges around: less lets
/// tight folds run through themselves, more strains sleeves in the armpit. Tried: 0.75 to 1
/// (docs/experiments/004-teacher-schedule.md).
const REPULSION: f32 = 0.85;

/// Edges are taken to be at least this long when rates are chosen, in metres.
const MIN_EDGE: f32 = 0.003;

/// In the last stage edges are taken to be at most this long, in metres: those of sewn templates
/// are 14 to 16 mm.
///
/// Cloth that is tight gives way while its rate is below the speed of sound in it over its edges,
/// however short the length that hangs. Less is stiffer and dearer for coarse cloth
/// (docs/experiments/004-teacher-schedule.md).
const MAX_LAST_EDGE: f32 = 0.017;

/// Substeps a second for edges of `edge_length` metres, of the rate for each metre of 1/Δx.
fn rate(speed: f32, edge_length: f32) -> f32 {
    speed / edge_length.max(MIN_EDGE)
}

impl Schedule {
    /// The schedule for a garment with edges of `edge_length` metres in the mean.
    ///
    /// # Examples
    ///
    /// ```
    /// use garnet_sim::{Quality, Schedule};
    ///
    /// let coarse = Schedule::for_quality(Quality::Teacher, 0.019);
    /// let fine = Schedule::for_quality(Quality::Teacher, 0.0096);
    /// assert!(fine.num_substeps() > coarse.num_substeps());
    /// ```
    pub fn for_quality(quality: Quality, edge_length: f32) -> Self {
        let rate = |speed: f32| rate(speed, edge_length);
        let stage = |frames: u32, speed: f32| Stage {
            frames,
            rate: rate(speed),
            extra_drag: FIRST_DRAG,
            friction: SHAKEN,
        };
        let settle = |frames: u32, speed: f32| Stage {
            friction: 1.0,
            extra_drag: 0.0,
            ..stage(frames, speed)
        };
        let last = |frames: u32, speed: f32| Stage {
            extra_drag: LAST_DRAG,
            rate: speed / edge_length.clamp(MIN_EDGE, MAX_LAST_EDGE),
            ..settle(frames, speed)
        };
        let ([motion_frames, first, second, third], bending_interval) = match quality {
            Quality::Fast => (FAST_FRAMES, RARELY),
            Quality::Teacher | Quality::Reference => (TEACHER_FRAMES, 2),
        };
        Self {
            frame_seconds: MOTION_SECONDS / motion_frames as f32,
            motion_frames,
            motion_part: [0.0, 1.0],
            motion_rate: rate(FIRST_RATE),
            motion_friction: SHAKEN,
            stages: vec![
                stage(first, FIRST_RATE),
                settle(second, LAST_RATE),
                last(third, LAST_RATE),
            ],
            balance_steps: match quality {
                Quality::Fast | Quality::Teacher => 0,
                Quality::Reference => BALANCE_STEPS,
            },
            refreshes_per_frame: 1,
            pair_interval: 1,
            bending_interval,
            patches: match quality {
                Quality::Fast => PATCHES,
                Quality::Teacher | Quality::Reference => 1,
            },
            contraction_frames: 0,
            length_share: 1.0,
            over_relaxation: 1.0,
            drag: DRAG,
            carry: CARRY,
            max_speed: MAX_SPEED,
            max_push_speed: MAX_PUSH_SPEED,
            gravity: STANDARD_GRAVITY,
            self_contact: SelfContact::Repulsion {
                distance: REPULSION,
                least: LEAST_REPULSION,
            },
        }
    }

    /// The same for a garment of one layer: no two of its vertices start near each other but by the
    /// way it was put on.
    #[must_use]
    pub fn of_one_layer(mut self) -> Self {
        if let SelfContact::Repulsion { least, .. } = &mut self.self_contact {
            *least = 1.0;
        }
        self
    }

    /// Simulated seconds of the whole run.
    pub fn seconds(&self) -> f32 {
        self.num_frames() as f32 * self.frame_seconds
    }

    /// Frames of the whole run.
    pub fn num_frames(&self) -> u64 {
        let settling = self.stages.iter().map(|stage| u64::from(stage.frames));
        u64::from(self.motion_frames) + settling.sum::<u64>()
    }

    /// Substeps of the whole run.
    pub fn num_substeps(&self) -> u64 {
        let of = |frames: u32, rate: f32| {
            u64::from(frames) * u64::from(self.refreshes_per_frame) * u64::from(self.substeps(rate))
        };
        let settling = self.stages.iter().map(|stage| of(stage.frames, stage.rate));
        of(self.motion_frames, self.motion_rate) + settling.sum::<u64>()
    }

    /// Substeps from one refresh of the contacts to the next at a rate of substeps a second.
    pub(crate) fn substeps(&self, rate: f32) -> u32 {
        let between = self.frame_seconds / self.refreshes_per_frame as f32;
        ((rate * between).round() as u32).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_quality_has_a_sound_schedule_at_every_edge_length() {
        for quality in [Quality::Fast, Quality::Teacher, Quality::Reference] {
            for edge_length in [0.0, 1e-6, 0.005, 0.02, 0.5] {
                let schedule = Schedule::for_quality(quality, edge_length);
                assert_eq!(schedule.check(), Ok(()), "{quality:?} {edge_length}");
            }
        }
    }

    #[test]
    fn coarse_garments_end_as_finely_as_templates() {
        let last_rate = |edge_length| {
            let schedule = Schedule::for_quality(Quality::Teacher, edge_length);
            schedule.stages.last().unwrap().rate
        };
        assert!(last_rate(0.014) > last_rate(0.016));
        assert!(last_rate(0.016) > last_rate(0.05));
        assert_eq!(last_rate(0.05).to_bits(), last_rate(0.02).to_bits());
    }
}
