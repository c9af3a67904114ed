//! Frames of a motion, each going on from the last one, smoothed if that is asked for.

use std::{collections::VecDeque, sync::atomic::AtomicBool};

use garnet::{
    Draper, PosedBody,
    data::SceneReport,
    drape::{KeyFrame, Smoothing, Take, TakeFrame},
};

use super::{
    all::Draped,
    report::{DrapeSeconds, RepeatedSeconds, StepsReport},
};

/// The frames of a motion in order.
pub(super) struct Chain<'a> {
    take: Take<'a>,
    smoothing: Option<Smoothing<'a>>,
    /// The last key frame, with its number.
    key: Option<(usize, KeyFrame)>,
    /// What else is told of the frames that wait to be smoothed.
    waiting: VecDeque<Told>,
}

/// What is told of a frame beside its drape.
struct Told {
    number: usize,
    simulated: Option<SceneReport>,
    time: DrapeSeconds,
    repeated: Option<RepeatedSeconds>,
    /// How long untangling took before the frame went on.
    alone: f64,
}

/// A frame that has gone on from the last one.
pub(super) struct Linked {
    pub(super) number: usize,
    pub(super) draped: Draped,
    pub(super) steps: StepsReport,
}

impl<'a> Chain<'a> {
    /// Smoothed over `radius` frames to either side.
    pub(super) fn new(draper: &'a Draper, radius: usize) -> Self {
        Self {
            take: Take::new(draper),
            smoothing: (radius > 0).then(|| Smoothing::new(draper, radius)),
            key: None,
            waiting: VecDeque::new(),
        }
    }

    /// Goes on with a frame that was draped by itself, and gives the next one that is ready.
    pub(super) fn go_on(
        &mut self,
        number: usize,
        draped: Draped,
        key: Option<KeyFrame>,
    ) -> anyhow::Result<Option<Linked>> {
        let Draped {
            posed,
            drape,
            simulated,
            time,
            repeated,
        } = draped;
        let told = Told {
            number,
            simulated,
            time,
            repeated,
            alone: drape.seconds.untangle,
        };
        let frame = self.take.go_on(&posed, drape)?;
        self.key = key.map(|key| (number, key));
        self.ready(told, posed, frame)
    }

    /// Goes on with a frame between the last key and the `next`, to pose whose body took `fit`
    /// seconds.
    pub(super) fn go_between(
        &mut self,
        number: usize,
        (posed, fit): (PosedBody, f64),
        next: (usize, Option<&KeyFrame>),
        stop: &AtomicBool,
    ) -> anyhow::Result<Option<Linked>> {
        let frame = match (&self.key, next) {
            (Some((last, key)), (at, Some(next))) => {
                let share = (number - last) as f32 / (at - last) as f32;
                self.take.go_between(&posed, [key, next], share, stop)?
            }
            _ => self.take.drape(&posed, stop)?,
        };
        let told = Told {
            number,
            simulated: None,
            time: DrapeSeconds::of(&frame.drape, fit),
            repeated: None,
            alone: frame.drape.seconds.untangle,
        };
        self.ready(told, posed, frame)
    }

    /// The next frame that is ready once one more went on.
    fn ready(
        &mut self,
        told: Told,
        posed: PosedBody,
        frame: TakeFrame,
    ) -> anyhow::Result<Option<Linked>> {
        self.waiting.push_back(told);
        let ready = match &mut self.smoothing {
            Some(smoothing) => smoothing.push(posed, frame)?,
            None => Some((posed, frame)),
        };
        Ok(self.linked(ready))
    }

    /// Gives the frames that still wait once all went on, one a call.
    pub(super) fn next_left(&mut self) -> anyhow::Result<Option<Linked>> {
        let ready = match &mut self.smoothing {
            Some(smoothing) => smoothing.next_left()?,
            None => None,
        };
        Ok(self.linked(ready))
    }

    fn linked(&mut self, ready: Option<(PosedBody, TakeFrame)>) -> Option<Linked> {
        let (posed, frame) = ready?;
        let mut told = self.waiting.pop_front()?;
        told.time.untangle += frame.drape.seconds.untangle - told.alone;
        let steps = StepsReport::of(&frame);
        Some(Linked {
            number: told.number,
            draped: Draped {
                posed,
                drape: frame.drape,
                simulated: told.simulated,
                time: told.time,
                repeated: told.repeated,
            },
            steps,
        })
    }
}
