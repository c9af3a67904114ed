//! Garment packages: a template, the body that it lies on, and trained variants.

pub use garnet_drape::{
    Attempt, BodyPath, Candidate, Choice, FileLock, GarmentPackage, Limit, MANIFEST_FILE, Manifest,
    MeasuredCost, Moment, MovingCloth, PACKAGE_SCHEMA, PackageError, PackageParts, Progress,
    Quality, Settling, Simulator, StoredCost, StoredFabric, StoredParameters, StoredPattern,
    StoredRestBody, Variant, quality_name, quality_of,
};
