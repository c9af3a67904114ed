//! Time against accuracy of all ways to drape a garment.
//!
//! [`time_drapes`] and [`time_simulations`] give samples of single scenes, which can be kept and
//! added to; [`Figures`] are what they come to.

mod drapes;
mod front;
mod sample;
mod simulations;
mod spread;
mod targets;

pub use drapes::{NetworkCost, Task, Timing, time_drapes};
pub use front::pareto_front;
pub use sample::{Figures, Sample, Seconds, Times};
pub use simulations::{Answer, Question, time_simulations};
pub use spread::spread;
pub use targets::{header_of, targets};
