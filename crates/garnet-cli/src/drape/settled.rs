//! Settling of what a network has put, by simulation.

use std::sync::atomic::AtomicBool;

use anyhow::Context;
use garnet::{
    Moment, Point3, PosedBody, Warped,
    package::{Settling, Teacher},
};

use super::{Bound, args::Job, simulated::teacher_of, timing::timed};

/// A garment that settles.
pub(super) struct Settler {
    teacher: Teacher,
    settling: Settling,
}

impl Settler {
    /// Cloth that settles as is said, or for as long as was asked for; none if for no time, but where the body has to
    /// go on first.
    pub(super) fn find(
        bound: &Bound,
        job: &Job,
        settling: Settling,
    ) -> anyhow::Result<Option<Self>> {
        let settling = asked(settling, job);
        if !settling.takes_time() {
            return Ok(None);
        }
        let (teacher, _) = teacher_of(bound, None, &job.source)?;
        Ok(Some(Self { teacher, settling }))
    }

    /// The same cloth where it settles as is said, or for as long as was asked for.
    pub(super) fn of(self, settling: Settling, job: &Job) -> Self {
        Self {
            settling: asked(settling, job),
            ..self
        }
    }

    /// For how many frames of a sixtieth of a second.
    pub(super) fn frames(&self) -> u32 {
        self.settling.frames
    }

    /// The garment settled, and how long that took, in seconds.
    pub(super) fn settled(
        &self,
        bound: &Bound,
        posed: &PosedBody,
        put: &Warped,
    ) -> anyhow::Result<(Warped, f64)> {
        self.run(bound, posed, &put.positions(&bound.garment), self.settling)
    }

    /// The garment simulated all the way from where it lies on the body at rest, and how long that took, in seconds.
    pub(super) fn whole_way(
        &self,
        bound: &Bound,
        posed: &PosedBody,
    ) -> anyhow::Result<(Warped, f64)> {
        let settling = Settling {
            from: Moment::Start,
            ..self.settling
        };
        self.run(bound, posed, bound.garment.mesh().positions(), settling)
    }

    fn run(
        &self,
        bound: &Bound,
        posed: &PosedBody,
        from: &[Point3],
        settling: Settling,
    ) -> anyhow::Result<(Warped, f64)> {
        let stop = AtomicBool::new(false);
        let (settled, seconds) = timed(|| {
            let settled = (self.teacher).settled(&bound.body, posed, from, settling, &stop);
            settled.context("the cloth does not settle")
        });
        Ok((
            Warped::settled(&bound.garment, &settled?, settling),
            seconds,
        ))
    }
}

/// For as long as was asked for, or as is said.
fn asked(settling: Settling, job: &Job) -> Settling {
    Settling {
        frames: job.settle.unwrap_or(settling.frames),
        ..settling
    }
}
