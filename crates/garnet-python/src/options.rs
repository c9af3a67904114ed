//! How a garment is draped: arguments that all drapes take.

use garnet::{Draper, Warp};
use pyo3::{exceptions::PyValueError, prelude::*};

/// The keyword arguments of a drape.
#[derive(Default)]
pub(crate) struct Options {
    /// A variant, a warp, or `None` for the default.
    pub(crate) method: Option<String>,
    /// Metres.
    pub(crate) clearance: Option<f64>,
    pub(crate) untangle: bool,
    /// Frames of a sixtieth of a second.
    pub(crate) settle: Option<u32>,
}

/// The largest clearance, in metres: beyond it cloth is no longer worn.
const MAX_CLEARANCE: f64 = 0.1;

impl Options {
    /// The warp that a method names; `None` if it names none.
    pub(crate) fn warp(&self) -> Option<Warp> {
        match self.method.as_deref() {
            Some("warp") => Some(Warp::Shape),
            Some("dqs") => Some(Warp::DualQuaternion),
            Some("lbs") => Some(Warp::Linear),
            _ => None,
        }
    }

    /// A draper with these options.
    ///
    /// # Errors
    ///
    /// `ValueError` for a clearance out of its range.
    pub(crate) fn applied(&self, draper: &Draper) -> PyResult<Draper> {
        let mut options = *draper.options();
        if let Some(warp) = self.warp() {
            options = options.with_warp(warp);
        }
        if let Some(clearance) = self.clearance {
            if !(0.0..=MAX_CLEARANCE).contains(&clearance) {
                return Err(PyValueError::new_err(format!(
                    "clearance must be from 0 to {MAX_CLEARANCE} metres, found {clearance}"
                )));
            }
            options = options.with_clearance(clearance as f32);
        }
        if let Some(frames) = self.settle {
            options = options.with_relax_frames(frames);
        }
        if !self.untangle {
            options = options.without_untangling();
        }
        Ok(draper.clone().with_options(options))
    }
}
