//! How long and how finely a scene is simulated.

use crate::SimError;

/// How accurate a drape has to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quality {
    /// For looking: the teacher's way with contacts looked for half as often, and a third of its time to settle.
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
    /// From which share of the motion's time to which other one it is simulated: 0 to 1 for all of it.
    pub motion_part: [f32; 2],
    /// Substeps a second during the motion.
    pub motion_rate: f32,
    /// Share of the fabric's friction against skin that acts during the motion.
    pub motion_friction: f32,
    /// How the cloth settles after the motion.
    pub stages: Vec<Stage>,
    /// In how many steps at most the [reference solver](crate::reference) brings the cloth into balance
    /// after that; 0 leaves it.
    pub balance_steps: u32,
    /// How often in a frame contacts are looked for anew.
    pub refreshes_per_frame: u32,
    /// Cloth that comes near cloth is looked for at one of so many refreshes.
    pub pair_interval: u32,
    /// Hinges are projected once in so many substeps.
    pub bending_interval: u32,
    /// Into how many patches the cloth is cut, whose substeps run side by side. A drape changes with their number as
    /// it does with any order in which constraints are projected, but not with the number of threads.
    pub patches: u32,
    /// During how many frames rest lengths go from those of the start to their own. Garments that
    /// start larger than they are cut shrink onto the body instead of snapping.
    pub contraction_frames: u32,
    /// Share of their rest lengths that springs are taken to have. One projection a substep leaves springs soft, and cloth
    /// sags: at a low rate shorter ones hang as long as those of a higher rate do.
    pub length_share: f32,
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
        /// Pairs that start nearer keep the distance of the start, or at least this share of the full
        /// one: 1 for garments of one layer; less so that pockets and collars are not blown up.
        least: f32,
    },
}

/// The share of the motion's time after which the body is *midway*: halfway in time and, as it starts as gently as it
/// stops, halfway on its path.
pub const MIDWAY: f32 = 0.5;

/// Standard gravity, m/s².
pub const STANDARD_GRAVITY: f32 = 9.80665;

/// No schedule may have more substeps.
pub const MAX_SUBSTEPS: u64 = 2_000_000;

/// Substeps a second of the second and the last stage for each meter of 1/Δx.
///
/// Of 48 T-shirts one still moves in the end. At 68 with 45 and 36 frames in place of 75 and 45 three do, at 41 and 68 three to six: what is
/// stiffer in the last stage rises and slides anew. At 41 in both one moves, but the strain p99 is 2.9 in place of 2.4 % in the median.
const LAST_RATE: f32 = 54.0;

/// Extra drag of the last stage, 1/s: cloth that swings on comes to rest; cloth out of balance still
/// falls, at 0.08 m/s, sixteen times what counts as moving.
const LAST_DRAG: f32 = 120.0;

/// Extra drag of the first stage, 1/s: cloth falls at 0.25 m/s at most, and comes to its folds without
/// swinging. Without it a drape changes more when a body changes a little (ARCHITECTURE, "Patterns, the
/// teacher and data sets"); with it in all stages 5 of 100 loose T-shirts still creep in the end.
const FIRST_DRAG: f32 = 30.0;

/// Rate of [`Schedule::carry`], 1/s: from 100 to 1000 drapes of bodies that differ a little are
/// nearest to each other.
const CARRY: f32 = 300.0;

/// Stages of [`Schedule::after_arrival`]: rate for each meter of 1/Δx, drag in 1/s, and friction.
///
/// 156 validation drapes of a T-shirt that networks put where the cloth is midway ([`Schedule::after_midway`]) end 1.98 mm and 3.59° from the teacher
/// after 46 frames, with a drag of 5 and 12 in the first stage at 2.08 and 2.05 mm (3.7°), of 5 in both at 2.15 mm, of 5 and 10 at 2.21 mm; after 30, 36 and 60
/// frames at 2.45, 2.18 and 1.86 mm, 4.4, 4.0 and 3.4°. At a rate of 45 in the last stage they ended 0.15 mm farther off (36 frames, a drag of 5 in the first).
const AFTER_ARRIVAL: [[f32; 3]; 2] = [[34.0, 8.0, SHAKEN], [LAST_RATE, 0.0, 1.0]];

/// For how many frames of a sixtieth of a second the first of two stages lasts at most.
///
/// With two thirds of all the drapes above end 2.62 mm from the teacher after 45 frames, 3.00 after 60, 2.43 after 30 (drags of 5 and 10): cloth
/// with a third of its friction slides on. With 10 of 46 frames they end at 2.91 mm (with 20 at 2.21; drags of 5 and 10), with 24 at 2.30 (with 20 at 2.15; of 5).
const SHAKEN_FRAMES: u32 = 20;

/// The share of all frames that it lasts at most.
const SHAKEN_SHARE: f32 = 2.0 / 3.0;

/// The stages of [`Schedule::while_falling`], whose frames are twice as long.
///
/// T-shirts that fall for 4 of these frames end 5.58 mm from the teacher's (150 test drapes), with drags of 5 and 10 5.66 mm, of 8 and 10 5.61 mm; after 7 frames
/// of half their length, where contacts are looked for almost twice as often, 5.65 mm; after 5 of three quarters (40 drapes) as far as after 4. At rates of 34 and 54 they
/// ended 0.05 mm nearer than at these with shorter springs, in a quarter more substeps. All of it holds on the 156 validation drapes, too: 4.44 mm and 7.7° in place of
/// 4.52 mm and 7.9° after the 7 frames and drags of before.
const WHILE_FALLING: [[f32; 3]; 2] = [[28.0, 10.0, SHAKEN], [45.0, 5.0, 1.0]];

/// Frames of a sixtieth of a second in one of theirs.
const FALLING_FRAME: u32 = 2;

/// Their [`Schedule::length_share`].
const FALLING_LENGTHS: f32 = 0.9975;

/// Their [`Schedule::pair_interval`]: at every second refresh they end 5.76 mm from the teacher's, at every fourth 5.77 mm (40 test drapes), and cross
/// themselves in 42 in place of 51 pairs of triangles (620); without looking for cloth on cloth they ended a fifth farther.
const FALLING_PAIR_INTERVAL: u32 = 2;

/// How long the body takes to its last place, in seconds. Cloth that had half of it, at half the rate, ended 12 mm from the
/// teacher's; that was cloth that resisted compression.
const MOTION_SECONDS: f32 = 1.0;

/// Frames of the motion and of the three stages of settling.
const TEACHER_FRAMES: [u32; 4] = [60, 45, 75, 45];

/// The same, each twice as long, in [`Quality::Fast`].
///
/// How far that ends from the teacher is measured by `cargo run --release -p garnet-data --example branching -- 5000 12`.
const FAST_FRAMES: [u32; 4] = [30, 15, 12, 6];

/// Hinges of cloth that somebody waits for are projected once in so many substeps. T-shirts that settle for 6 frames end as near to the teacher's as with
/// half of it, 5.06 and 5.07 mm (156 validation drapes); from their arrival on for 30 frames, with pairs looked for rarely, too, 4.12 and 3.93 mm (620 test
/// drapes), in three quarters of the time.
const RARELY: u32 = 4;

/// The same of refreshes at which they look for cloth on cloth, if these are a sixtieth of a second apart: 4.56 and 4.55 mm after 8 frames.
const PAIRS_RARELY: u32 = 2;

/// Rate of [`Schedule::settling`] for each meter of 1/Δx, and what cloth loses of its velocity, 1/s.
///
/// On 155 drapes of a T-shirt by a pose-space deformation, 9.3 mm from the teacher (whose cloth still resisted compression), six frames at 30, 34, 40
/// bring them to 8.2, 7.8, 7.7 mm with a drag of 30; with one of 60 they are at 7.8 and 7.6 mm. 17 is too soft:
/// cloth sags, 14.5 mm after twelve frames.
const SETTLING: [f32; 2] = [40.0, 60.0];

/// Patches of cloth that somebody waits for. Of two threads drapes that settle take three quarters of the time, and end as near to the
/// teacher's (155 validation T-shirts, of cloth that still resisted compression: 5.6 mm with 1 or 2). The teacher's scenes have a thread each.
const PATCHES: u32 = 2;

/// Of 11 drapes of a T-shirt of 5000 vertices 9 are in balance after 21 to 53 steps.
const BALANCE_STEPS: u32 = 60;

/// Share of the friction that acts until the cloth has come to rest the first times.
///
/// Somebody who takes up a pose moves a little all the time, and cloth slides where it would stick:
/// with all of the friction it keeps the strain of the way there.
const SHAKEN: f32 = 0.3;

/// Distance that vertices keep from each other, over the length of the edges around: at 0.75 tight
/// folds run through themselves in every other scene, at 1 sleeves are strained in the armpit.
const REPULSION: f32 = 0.85;

/// Edges are taken to be at least this long when rates are chosen, in metres.
const MIN_EDGE: f32 = 0.003;

/// In the last stage edges are taken to be at most this long, in metres: those of sewn templates are 14 to 16 mm.
///
/// Cloth that is tight gives way while its rate is below the speed of sound in it over its edges, however
/// short the length that hangs. Trousers with edges of 45 mm (a leg raised) have a strain p99 of 41 % with it, 63 %
/// without it, 24 % in balance.
const MAX_LAST_EDGE: f32 = 0.017;

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
        // Substeps a second for each meter of 1/Δx.
        let rate = |speed: f32| speed / edge_length.max(MIN_EDGE);
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
            motion_rate: rate(34.0),
            motion_friction: SHAKEN,
            stages: vec![
                stage(first, 34.0),
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
            drag: 10.0,
            carry: CARRY,
            max_speed: 8.0,
            max_push_speed: 0.2,
            gravity: STANDARD_GRAVITY,
            self_contact: SelfContact::Repulsion {
                distance: REPULSION,
                least: 0.5,
            },
        }
    }

    /// A short settling of cloth that something else has put where it belongs, but for its strain and finer
    /// folds, on a body that stands still.
    pub fn settling(edge_length: f32, frames: u32) -> Self {
        let [speed, extra_drag] = SETTLING;
        Self {
            motion_frames: 0,
            patches: PATCHES,
            pair_interval: PAIRS_RARELY,
            stages: vec![Stage {
                frames,
                rate: speed / edge_length.max(MIN_EDGE),
                extra_drag,
                friction: SHAKEN,
            }],
            ..Self::for_quality(Quality::Teacher, edge_length)
        }
    }

    /// The settling of cloth that something else has put where it is when the body comes to its last place
    /// ([`Drape::arrived`](crate::Drape::arrived)): as the teacher's, but so short that folds still move a little.
    pub fn after_arrival(edge_length: f32, frames: u32) -> Self {
        Self::by_table(&AFTER_ARRIVAL, edge_length, frames, 1)
    }

    /// The settling of cloth that something else has put most of the way from there to where it rests: `frames` of a
    /// sixtieth of a second, or one more, in frames of twice that length.
    pub fn while_falling(edge_length: f32, frames: u32) -> Self {
        let frames = frames.div_ceil(FALLING_FRAME);
        let schedule = Self::by_table(&WHILE_FALLING, edge_length, frames, FALLING_FRAME);
        Self {
            length_share: FALLING_LENGTHS,
            pair_interval: FALLING_PAIR_INTERVAL,
            ..schedule
        }
    }

    /// Two stages of so many frames in all, each `length` sixtieths of a second long.
    fn by_table(table: &[[f32; 3]; 2], edge_length: f32, frames: u32, length: u32) -> Self {
        let first = (SHAKEN_SHARE * frames as f32).round() as u32;
        let first = first.min(SHAKEN_FRAMES / length);
        let stage = |[speed, extra_drag, friction]: [f32; 3], frames: u32| Stage {
            frames,
            rate: speed / edge_length.max(MIN_EDGE),
            extra_drag,
            friction,
        };
        let whole = Self::for_quality(Quality::Teacher, edge_length);
        Self {
            motion_frames: 0,
            patches: PATCHES,
            frame_seconds: length as f32 * whole.frame_seconds,
            stages: vec![stage(table[0], first), stage(table[1], frames - first)],
            pair_interval: PAIRS_RARELY,
            bending_interval: RARELY,
            ..whole
        }
    }

    /// The same up to where the body comes to its last place: the cloth has not settled.
    #[must_use]
    pub fn until_arrival(self) -> Self {
        Self {
            stages: Vec::new(),
            balance_steps: 0,
            ..self
        }
    }

    /// The same up to where the body is [midway](MIDWAY).
    #[must_use]
    pub fn until_midway(self) -> Self {
        Self {
            motion_frames: self.midway_frame(),
            motion_part: [self.motion_part[0], MIDWAY],
            ..self.until_arrival()
        }
    }

    /// At the end of which frame the body is midway; 0 if it is so from the start, or never.
    pub(crate) fn midway_frame(&self) -> u32 {
        let [from, to] = self.motion_part;
        let share = (MIDWAY - from) / (to - from);
        (share * self.motion_frames as f32).round() as u32
    }

    /// The second half of the motion, for cloth that something else has put where it is when the body is
    /// [midway](MIDWAY), and settling as [after the arrival](Schedule::after_arrival) for about so many frames of a
    /// sixtieth of a second. Contacts are looked for as often as by the teacher, cloth on cloth half as often.
    ///
    /// With cloth on cloth looked for as often as by the teacher 156 validation drapes of a T-shirt ended as near to it, with contacts looked for half as
    /// often, as in the [fast quality](Quality::Fast), a tenth farther off.
    pub fn after_midway(edge_length: f32, frames: u32) -> Self {
        let whole = Self::from_rest(edge_length, frames);
        Self {
            motion_frames: whole.motion_frames - whole.midway_frame(),
            motion_part: [MIDWAY, 1.0],
            refreshes_per_frame: 2,
            pair_interval: 2,
            ..whole
        }
    }

    /// The same for the whole motion of cloth on the body at rest.
    pub fn from_rest(edge_length: f32, frames: u32) -> Self {
        let length = TEACHER_FRAMES[0] / FAST_FRAMES[0];
        let frames = frames.div_ceil(length);
        Self {
            stages: Self::by_table(&AFTER_ARRIVAL, edge_length, frames, length).stages,
            ..Self::for_quality(Quality::Fast, edge_length)
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

    /// Refuses schedules that cannot be followed or take forever.
    ///
    /// # Errors
    ///
    /// [`SimError::Schedule`] or [`SimError::TooManySteps`].
    pub fn check(&self) -> Result<(), SimError> {
        let mut values = vec![
            ("seconds a frame", self.frame_seconds, 1e-4, 0.1),
            ("substeps a second", self.motion_rate, 1.0, 1e6),
            (
                "refreshes a frame",
                self.refreshes_per_frame as f32,
                1.0,
                64.0,
            ),
            (
                "refreshes between searches for cloth on cloth",
                self.pair_interval as f32,
                1.0,
                64.0,
            ),
            (
                "substeps between projections of hinges",
                self.bending_interval as f32,
                1.0,
                64.0,
            ),
            ("patches", self.patches as f32, 1.0, 64.0),
            ("a motion from the share of", self.motion_part[0], 0.0, 1.0),
            ("a motion to the share of", self.motion_part[1], 0.0, 1.0),
            (
                "a part of the motion of",
                self.motion_part[1] - self.motion_part[0],
                1e-3,
                1.0,
            ),
            (
                "a share of the rest lengths of",
                self.length_share,
                0.5,
                2.0,
            ),
            ("a drag of", self.drag, 0.0, 100.0),
            ("a share of friction of", self.motion_friction, 0.0, 10.0),
            ("a rate of carrying of", self.carry, 0.0, 1e5),
            ("a greatest speed of", self.max_speed, 0.01, 1e4),
            (
                "a greatest speed of pushes of",
                self.max_push_speed,
                1e-3,
                1e4,
            ),
            ("a gravity of", self.gravity, -100.0, 100.0),
            ("steps to balance", self.balance_steps as f32, 0.0, 1000.0),
        ];
        if let SelfContact::Repulsion { distance, least } = self.self_contact {
            values.push(("a distance of cloth from cloth of", distance, 0.01, 1.0));
            values.push(("a share of it at the start of", least, 0.0, 1.0));
        }
        for stage in &self.stages {
            values.push(("substeps a second", stage.rate, 1.0, 1e6));
            values.push(("an extra drag of", stage.extra_drag, 0.0, 1000.0));
            values.push(("a share of friction of", stage.friction, 0.0, 10.0));
        }
        for (quantity, value, min, max) in values {
            if !(min..=max).contains(&value) {
                return Err(SimError::Schedule {
                    quantity,
                    value: value.into(),
                    min: min.into(),
                    max: max.into(),
                });
            }
        }
        let steps = self.num_substeps();
        if steps > MAX_SUBSTEPS {
            return Err(SimError::TooManySteps {
                steps,
                max: MAX_SUBSTEPS,
            });
        }
        Ok(())
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

    #[test]
    fn what_has_arrived_settles_for_as_many_frames_as_are_asked_for() {
        for frames in [0, 1, 2, 12, 30] {
            let schedule = Schedule::after_arrival(0.016, frames);
            assert_eq!(schedule.check(), Ok(()));
            assert_eq!(schedule.num_frames(), u64::from(frames));
        }
        let whole = Schedule::for_quality(Quality::Reference, 0.016);
        let until = whole.clone().until_arrival();
        assert_eq!(until.num_frames(), u64::from(whole.motion_frames));
        assert_eq!(until.motion_rate.to_bits(), whole.motion_rate.to_bits());
        assert_eq!(until.balance_steps, 0);
    }

    #[test]
    fn the_motion_has_two_halves() {
        let [whole, fast] =
            [Quality::Teacher, Quality::Fast].map(|quality| Schedule::for_quality(quality, 0.016));
        let until = whole.clone().until_midway();
        assert_eq!(2 * until.num_frames(), u64::from(whole.motion_frames));
        assert_eq!(until.midway_frame(), until.motion_frames);
        assert_eq!(until.check(), Ok(()));
        for frames in [0, 1, 24, 25] {
            let after = Schedule::after_midway(0.016, frames);
            assert_eq!(after.check(), Ok(()));
            assert_eq!(2 * after.motion_frames, fast.motion_frames);
            let settling = after.num_frames() - u64::from(after.motion_frames);
            assert_eq!(settling, u64::from(frames.div_ceil(2)));
            assert_eq!(after.midway_frame(), 0);
        }
        let nothing = Schedule {
            motion_part: [MIDWAY, MIDWAY],
            ..fast
        };
        assert!(matches!(nothing.check(), Err(SimError::Schedule { .. })));
    }

    #[test]
    fn endless_and_absurd_schedules_are_refused() {
        let schedule = Schedule::for_quality(Quality::Fast, 0.01);
        let endless = Schedule {
            motion_frames: u32::MAX,
            ..schedule.clone()
        };
        assert!(matches!(
            endless.check(),
            Err(SimError::TooManySteps { .. })
        ));
        let absurd = Schedule {
            frame_seconds: f32::NAN,
            ..schedule
        };
        assert!(matches!(absurd.check(), Err(SimError::Schedule { .. })));
    }
}
