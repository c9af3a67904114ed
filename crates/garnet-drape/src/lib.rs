//! The drape: a garment is warped to a body, moved by a network, relaxed by simulation, untangled.
//!
//! A [`Garment`] that lies on a body at rest is [bound](Garment::bind) once; a [`Draper`] drapes it
//! on one posed body after the other. A [`Package`] is a garment with trained variants, and makes
//! the draper of each.
//!
//! Without features the crate warps and untangles. `package` adds garment packages, pose-space
//! deformations and the simulator; `network` adds GarNet, which runs on Burn.

mod coverage;
mod draper;
mod error;
mod garment;
mod key_frames;
mod outfit;
mod penetration;
mod refit;
mod smoothing;
mod stiff;
mod take;

mod blending;
mod body_path;
#[cfg(feature = "package")]
mod choice;
#[cfg(feature = "package")]
mod familiar;
#[cfg(feature = "package")]
mod familiarity;
#[cfg(feature = "package")]
mod fit;
#[cfg(feature = "package")]
mod following;
#[cfg(feature = "package")]
mod lock;
#[cfg(feature = "package")]
mod network;
#[cfg(feature = "package")]
mod package;
#[cfg(feature = "package")]
mod packaged;
#[cfg(feature = "package")]
mod parts;
#[cfg(feature = "package")]
mod predicted;
#[cfg(feature = "package")]
mod settling;
#[cfg(feature = "package")]
mod simulated_faces;
#[cfg(feature = "package")]
mod simulator;
#[cfg(feature = "package")]
pub mod tensors;
mod tubes;
#[cfg(feature = "package")]
mod unfamiliar;

#[cfg(feature = "package")]
pub use body_path::BodyPath;
#[cfg(feature = "package")]
pub use choice::{Candidate, Choice, ChoiceOptions, Limit, calibration};
pub use coverage::{Coverage, CoverageOptions};
pub use draper::{
    Drape, DrapeOptions, DrapeQuality, DrapeSeconds, Draper, Fallback, Placed, PlacedBy,
    Provenance, Worsened,
};
pub use error::Error;
#[cfg(feature = "package")]
pub use familiarity::{Expectation, StoredPoses, familiarity, rank_correlation};
#[cfg(feature = "package")]
pub use fit::{FinishedGirth, FitLines, FitWord, NoFit, Region, RegionFit, fit_map, wearer_tape};
pub use garment::{BoundGarment, Garment};
#[cfg(feature = "package")]
pub use garnet_sim::{Moment, MovingCloth};
pub use key_frames::{KeyFrame, KeySpacing};
#[cfg(feature = "package")]
pub use lock::{Attempt, FileLock};
#[cfg(feature = "package")]
pub use network::{Network, Predicted};
pub use outfit::{LayerCount, LayerPair, Outfit};
#[cfg(feature = "package")]
pub use package::{
    GarmentPackage, MANIFEST_FILE, Manifest, PACKAGE_SCHEMA, PackageError, PackageParts,
    StoredCost, StoredFabric, StoredParameters, StoredPattern, StoredRestBody, Variant,
    toml_problem,
};
#[cfg(feature = "package")]
pub use packaged::{MeasuredCost, Package};
#[cfg(feature = "package")]
pub use parts::collider;
pub use penetration::{Penetration, penetration};
#[cfg(feature = "package")]
pub use predicted::Progress;
pub use refit::Refit;
#[cfg(feature = "package")]
pub use settling::Settling;
#[cfg(feature = "package")]
pub use simulator::{Quality, Simulator, check_stop, quality_name, quality_of, stopping};
pub use smoothing::Smoothing;
pub use take::{StepLimit, Take, TakeFrame};
pub use tubes::{LimbOutside, Tubes};
#[cfg(feature = "package")]
pub use unfamiliar::Unfamiliar;
