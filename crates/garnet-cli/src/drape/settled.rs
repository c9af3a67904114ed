//! Settling of what a network has put, by simulation.

use std::sync::atomic::AtomicBool;

use anyhow::Context;
use garnet::{
    PosedBody, Warped,
    data::{SETTLE_FRAMES, Teacher},
};

use super::{
    Bound,
    args::{Job, Source},
    simulated::teacher_of,
    timing::timed,
};

/// A garment that settles.
pub(super) struct Settler {
    teacher: Teacher,
    frames: u32,
}

impl Settler {
    /// For as long as was asked for, or else for as long as garments do that gain by it; none if for no
    /// time.
    pub(super) fn find(bound: &Bound, job: &Job, gains: bool) -> anyhow::Result<Option<Self>> {
        let frames = job.settle.unwrap_or(if gains { SETTLE_FRAMES } else { 0 });
        if frames == 0 {
            return Ok(None);
        }
        Self::new(bound, &job.source, frames).map(Some)
    }

    fn new(bound: &Bound, source: &Source, frames: u32) -> anyhow::Result<Self> {
        let (teacher, _) = teacher_of(bound, None, source)?;
        Ok(Self { teacher, frames })
    }

    /// For how many frames of a sixtieth of a second.
    pub(super) fn frames(&self) -> u32 {
        self.frames
    }

    /// The garment settled, and how long that took, in seconds.
    pub(super) fn settled(
        &self,
        bound: &Bound,
        posed: &PosedBody,
        put: &Warped,
    ) -> anyhow::Result<(Warped, f64)> {
        let from = put.positions(&bound.garment);
        let skin = posed.skin().positions();
        let stop = AtomicBool::new(false);
        let (settled, seconds) = timed(|| {
            let settled = self.teacher.settled(skin, &from, self.frames, &stop);
            settled.context("the cloth does not settle")
        });
        Ok((Warped::at(&bound.garment, &settled?), seconds))
    }
}
