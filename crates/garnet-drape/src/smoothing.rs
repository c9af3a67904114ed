//! Smoothing of a take over time.
//!
//! What is smoothed is where cloth lies as the body sees it: the offset of each node from the warp,
//! turned back with the body. So cloth neither lags behind the body nor is rounded off where that
//! moves fast. The filter is a binomial window with as much of the past as of the future, which
//! delays nothing. Then the cloth is freed of penetrations as in the take itself.

use std::collections::VecDeque;
use std::time::Instant;

use garnet_mesh::{Point3, Vector3};
use garnet_skin::PosedBody;
use garnet_untangle::{UntangleOptions, Untangled};

use crate::take::{Carrier, FAR, farthest};
use crate::{Draper, Error, TakeFrame};

/// Shares of the way to the smooth cloth that are tried, one after the other, where cloth cannot go
/// all of it.
const SHARES: [f32; 3] = [1.0, 0.5, 0.25];

/// Smooth cloth may cross the skin with this share of its faces, or with as many as before.
const FEW_CROSSING: f32 = 1e-3;

/// Smooths the frames of a take over time, and gives them back in order, some frames later.
///
/// No more than a window of frames is kept.
#[derive(Debug)]
pub struct Smoothing<'a> {
    draper: &'a Draper,
    /// Weights of the frames that are so far away, in the past as in the future, from the first on.
    weights: Vec<f32>,
    /// The frames of a window.
    kept: VecDeque<Kept>,
    /// How many of them have been given back.
    given: usize,
    /// Positions `[vertex]` of the frame that was given back last, in metres.
    last: Option<Vec<Point3>>,
}

/// A frame in the window.
#[derive(Debug)]
struct Kept {
    /// Offsets from the warp `[node]` before they are smoothed, turned back to rest, in metres.
    offsets: Vec<Vector3>,
    /// The frame and its body; none once they have been given back.
    frame: Option<(PosedBody, TakeFrame)>,
}

impl<'a> Smoothing<'a> {
    /// A window of so many frames to either side; with none, frames stay as they are.
    pub fn new(draper: &'a Draper, radius: usize) -> Self {
        Self {
            draper,
            weights: binomial(radius),
            kept: VecDeque::new(),
            given: 0,
            last: None,
        }
    }

    /// Takes the next frame of the take, and gives back the one that has all of its window by now.
    ///
    /// # Errors
    ///
    /// [`Error::Skin`] or [`Error::Untangle`] if `body` is not of the body that the garment was
    /// bound to.
    ///
    /// # Panics
    ///
    /// If the frame has fewer positions than the garment.
    pub fn push(
        &mut self,
        body: PosedBody,
        frame: TakeFrame,
    ) -> Result<Option<(PosedBody, TakeFrame)>, Error> {
        let garment = self.draper.garment();
        let home = body.at_home(garment.body())?;
        let carrier = Carrier::new(self.draper, home.body())?;
        let places = home.from_target(frame.drape.positions.clone());
        let nodes = garment.cloth().weld().gather(&places);
        self.kept.push_back(Kept {
            offsets: carrier.offsets(&nodes),
            frame: Some((body, frame)),
        });
        if self.kept.len() - self.given > self.weights.len() {
            return self.next_smooth();
        }
        Ok(None)
    }

    /// Gives back the frames that are left, one a call, once all have been taken.
    ///
    /// # Errors
    ///
    /// As [`Smoothing::push`].
    pub fn next_left(&mut self) -> Result<Option<(PosedBody, TakeFrame)>, Error> {
        self.next_smooth()
    }

    /// The next frame, smoothed by what there is around it.
    fn next_smooth(&mut self) -> Result<Option<(PosedBody, TakeFrame)>, Error> {
        let now = self.given;
        let taken = self.kept.get_mut(now).and_then(|kept| kept.frame.take());
        let Some((body, mut frame)) = taken else {
            return Ok(None);
        };
        let ways = self.ways(now);
        self.given += 1;
        if self.given > self.weights.len() {
            self.kept.pop_front();
            self.given -= 1;
        }
        if ways.iter().any(|way| *way != Vector3::zeros()) {
            let start = Instant::now();
            self.smooth(&body, &mut frame, &ways)?;
            frame.drape.seconds.untangle += start.elapsed().as_secs_f64();
        }
        let last = self.last.as_ref();
        frame.step = last.map_or(0.0, |last| farthest(last, &frame.drape.positions));
        self.last = Some(frame.drape.positions.clone());
        Ok(Some((body, frame)))
    }

    /// By how much the offsets of a kept frame change `[node]`, in metres, turned back to rest.
    ///
    /// Frames count in pairs: where one of the two is missing, at the ends, neither does. So the
    /// first and the last frame stay, and nothing is delayed.
    fn ways(&self, now: usize) -> Vec<Vector3> {
        let own = &self.kept[now].offsets;
        let mut ways = vec![Vector3::zeros(); own.len()];
        for (number, weight) in self.weights.iter().enumerate() {
            let past = now.checked_sub(number + 1).map(|at| &self.kept[at]);
            let future = self.kept.get(now + number + 1);
            let (Some(past), Some(future)) = (past, future) else {
                break;
            };
            let pairs = past.offsets.iter().zip(&future.offsets).zip(own);
            for (way, ((past, future), own)) in ways.iter_mut().zip(pairs) {
                *way += ((past - own) + (future - own)) * *weight;
            }
        }
        ways
    }

    /// Moves the cloth of a frame `ways` `[node]` as far as it stays free of the skin.
    fn smooth(
        &self,
        body: &PosedBody,
        frame: &mut TakeFrame,
        ways: &[Vector3],
    ) -> Result<(), Error> {
        let garment = self.draper.garment();
        let weld = garment.cloth().weld();
        let home = body.at_home(garment.body())?;
        let carrier = Carrier::new(self.draper, home.body())?;
        let nodes = weld.gather(&home.from_target(frame.drape.positions.clone()));
        let goal = carrier.moved(&nodes, ways, 1.0);
        let Some(options) = self.draper.options().untangle else {
            frame.drape.positions = home.to_target(weld.scatter(&goal));
            return Ok(());
        };
        let options = options.for_simulated();
        let own = frame.drape.report.as_ref();
        let few = (FEW_CROSSING * garment.cloth().faces().len() as f32) as usize;
        let most = own.map_or(0, |own| own.crossing_faces).max(few);
        for share in SHARES {
            let goal = carrier.moved(&nodes, ways, share);
            let freed = self.freed(home.body(), &goal, &options)?;
            let is_free = freed.report.inside == 0 && freed.report.crossing_faces <= most;
            if is_free && farthest(&goal, &freed.positions_nodes) <= FAR {
                frame.drape.positions = home.to_target(weld.scatter(&freed.positions_nodes));
                frame.drape.is_trapped = weld.scatter(&freed.is_trapped);
                frame.drape.report = Some(freed.report);
                break;
            }
        }
        Ok(())
    }

    fn freed(
        &self,
        body: &PosedBody,
        goal: &[Point3],
        options: &UntangleOptions,
    ) -> Result<Untangled, Error> {
        let garment = self.draper.garment();
        Ok(garment.freed(body, goal, options)?)
    }
}

/// Weights of the frames one, two, … to either side, of a binomial window of `radius`.
fn binomial(radius: usize) -> Vec<f32> {
    let mut row = vec![1.0_f64];
    for _ in 0..2 * radius {
        let sums = row.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        row = std::iter::once(0.5 * row[0])
            .chain(sums)
            .chain([0.5 * row[row.len() - 1]])
            .collect();
    }
    row[radius + 1..]
        .iter()
        .map(|&weight| weight as f32)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_those_of_binomial_coefficients() {
        assert!(binomial(0).is_empty());
        assert_eq!(binomial(1), [0.25]);
        assert_eq!(binomial(2), [4.0 / 16.0, 1.0 / 16.0]);
        assert_eq!(binomial(3), [15.0 / 64.0, 6.0 / 64.0, 1.0 / 64.0]);
    }
}
