//! The drape: a garment is warped to a body, moved by a network, relaxed by simulation, untangled.
//!
//! A [`Garment`] that lies on a body at rest is [bound](Garment::bind) once; a [`Draper`] warps and
//! untangles it on one posed body after the other. A [`GarmentPackage`] is a garment with trained
//! networks; a [`PackagedGarment`] drapes it by one of them.

mod body_path;
mod draper;
mod error;
mod garment;
mod lock;
mod network;
mod package;
mod packaged;
mod parts;
mod penetration;
mod refit;
mod settling;
mod teacher;
pub mod tensors;
mod unfamiliar;

pub use body_path::BodyPath;
pub use draper::{Drape, DrapeOptions, Draper, Warped};
pub use error::Error;
pub use garment::{BoundGarment, Garment};
pub use garnet_sim::Moment;
pub use lock::{Attempt, FileLock};
pub use network::{Moved, Network};
pub use package::{
    GarmentPackage, MANIFEST_FILE, Manifest, PACKAGE_SCHEMA, PackageError, PackageParts,
    StoredFabric, StoredParameters, StoredPattern, StoredRestBody, Variant, toml_problem,
};
pub use packaged::{PackagedDrape, PackagedGarment};
pub use parts::collider;
pub use penetration::{Penetration, penetration};
pub use refit::Refit;
pub use settling::Settling;
pub use teacher::{Quality, Teacher, check_stop, quality_name, quality_of, stopping};
pub use unfamiliar::Unfamiliar;
