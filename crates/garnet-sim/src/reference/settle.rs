//! Cloth coming to rest.

use std::ops::ControlFlow;

use super::solver::Reference;
use crate::SimError;

/// Longer steps than this, in seconds, have no inertia to speak of.
const MAX_STEP: f64 = 100.0;

/// No step gets shorter, in seconds.
const MIN_STEP: f64 = 1e-3;

/// Newton iterations after which the next step is longer, and after which it is shorter.
const EASY: usize = 12;

/// How a settling ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settled {
    /// Steps taken.
    pub steps: usize,
    /// Newton iterations of all steps.
    pub iterations: usize,
    /// The largest force left over on a free vertex, over the mean weight of a vertex.
    pub residual: f64,
    /// The root of the mean square of the same.
    pub rms_residual: f64,
    /// Whether the residual is below the tolerance.
    pub is_settled: bool,
}

impl Reference<'_> {
    /// Lets the cloth come to rest: steps without speed that get longer while they are easy.
    ///
    /// Cloth that is not in balance after
    /// [`ReferenceOptions::max_steps`](super::ReferenceOptions::max_steps) is no error: the answer
    /// says so.
    ///
    /// # Errors
    ///
    /// [`SimError::Exploded`] or [`SimError::Unsolvable`].
    pub fn settle(&mut self) -> Result<Settled, SimError> {
        self.settle_watched(&mut |_, _| ControlFlow::Continue(()))
    }

    /// The same; `observer` is told the steps that are done and the residual, and may break off.
    ///
    /// # Errors
    ///
    /// As [`Reference::settle`], and [`SimError::Stopped`].
    pub fn settle_watched(
        &mut self,
        observer: &mut dyn FnMut(usize, f64) -> ControlFlow<()>,
    ) -> Result<Settled, SimError> {
        let mut seconds = self.options.first_step;
        let (mut iterations, mut creased) = (0, 0);
        for steps in 0..=self.options.max_steps {
            self.potential.contact.advance(&self.x);
            if let Some(pairs) = &mut self.potential.self_contact {
                pairs.look(&self.x);
            }
            let residual = self.residual();
            let is_settled = residual <= self.options.tolerance;
            if is_settled || steps == self.options.max_steps {
                return Ok(Settled {
                    steps,
                    iterations,
                    residual,
                    rms_residual: self.rms_residual(),
                    is_settled,
                });
            }
            if observer(steps, residual).is_break() {
                return Err(SimError::Stopped {
                    seconds: self.time as f32,
                });
            }
            let step = self.descend(seconds)?;
            iterations += step.iterations;
            if !step.is_solved {
                let is_stalled = step.iterations < self.options.max_iterations;
                if is_stalled && creased < self.options.max_creased {
                    self.hold_worst();
                    creased += 1;
                    continue;
                }
                seconds = (0.25 * seconds).max(MIN_STEP);
            } else if step.iterations <= EASY {
                seconds = (2.0 * seconds).min(MAX_STEP);
            }
        }
        unreachable!("the last round returns")
    }
}
