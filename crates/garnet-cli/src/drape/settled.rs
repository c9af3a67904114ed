//! Settling of what a network has put, by simulation.

use std::sync::atomic::AtomicBool;

use anyhow::Context;
use garnet::{
    PosedBody, Warped,
    data::{BodyPath, Put, Teacher},
};

use super::{Bound, args::Job, simulated::teacher_of, timing::timed};

/// How cloth settles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settling {
    /// Where it was put.
    pub(super) put: Put,
    /// For how many frames of a sixtieth of a second.
    pub(super) frames: u32,
}

impl Settling {
    /// For as long as cloth does by default that was put so.
    pub(super) const fn of(put: Put) -> Self {
        Self {
            put,
            frames: put.frames(),
        }
    }
}

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
        let frames = job.settle.unwrap_or(settling.frames);
        if frames == 0 && settling.put != Put::Midway {
            return Ok(None);
        }
        let (teacher, _) = teacher_of(bound, None, &job.source)?;
        Ok(Some(Self { teacher, settling }.of(settling, job)))
    }

    /// The same cloth where it settles as is said, or for as long as was asked for.
    pub(super) fn of(self, settling: Settling, job: &Job) -> Self {
        let frames = job.settle.unwrap_or(settling.frames);
        Self {
            settling: Settling { frames, ..settling },
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
        let from = put.positions(&bound.garment);
        let stop = AtomicBool::new(false);
        let Settling { put, frames } = self.settling;
        let (settled, seconds) = timed(|| {
            let settled = if put == Put::Midway {
                let path = BodyPath::to_posed(&bound.body, posed);
                self.teacher.resumed(&path, &from, frames, &stop)
            } else {
                let skin = posed.skin().positions();
                self.teacher.settled(skin, &from, put, frames, &stop)
            };
            settled.context("the cloth does not settle")
        });
        Ok((Warped::at(&bound.garment, &settled?), seconds))
    }
}
