//! Which schedules can be followed.

use super::{Schedule, SelfContact};
use crate::SimError;

/// No schedule may have more substeps.
pub const MAX_SUBSTEPS: u64 = 2_000_000;

impl Schedule {
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
            ("an over-relaxation of", self.over_relaxation, 0.1, 1.9),
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
    use crate::Quality;

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
