//! The level at which each way to drape breaks.

pub use garnet_stress::{
    AXES, Axis, Broken, Cell, Hold, Measured, Method, StressError, StressOptions, holds, run,
};
