//! The steps of a drape, for those who time or replace them.

pub use garnet_drape::{
    Coverage, CoverageOptions, KeyFrame, KeySpacing, LayerCount, LayerPair, LimbOutside, Outfit,
    Placed, PlacedBy, Refit, Smoothing, StepLimit, Take, TakeFrame, Tubes,
};
#[cfg(feature = "package")]
pub use garnet_drape::{
    FinishedGirth, FitLines, FitWord, NoFit, Region, RegionFit, fit_map, wearer_tape,
};
