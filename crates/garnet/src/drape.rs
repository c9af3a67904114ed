//! The steps of a drape, for those who time or replace them.

pub use garnet_drape::{
    Coverage, CoverageOptions, LimbOutside, Placed, PlacedBy, Refit, StepLimit, Take, TakeFrame,
    Tubes,
};
