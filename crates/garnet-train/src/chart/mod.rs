//! Time against accuracy of all ways to drape a garment, and how their costs grow.
//!
//! [`time_drapes`] and [`ask_teacher`] give samples of single scenes, which can be kept and added to;
//! [`Figures`] are what they come to. [`cost_at`] times the stages of a drape for the same garment with
//! other numbers of vertices, through which [`PowerLaw`]s are laid.

mod drapes;
mod front;
mod growth;
mod power_law;
mod sample;
mod simulations;
mod spread;

pub use drapes::{NetworkCost, Task, Timing, time_drapes};
pub use front::pareto_front;
pub use growth::{CostAt, GrowthOptions, cost_at, header_of, targets};
pub use power_law::PowerLaw;
pub use sample::{Figures, Sample, Seconds, Times};
pub use simulations::{Answer, Question, ask_teacher};
pub use spread::spread;
