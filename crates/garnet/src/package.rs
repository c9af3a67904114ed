//! Garment packages: a template, the body that it lies on, and trained variants.

pub use garnet_drape::{
    Attempt, BodyPath, Candidate, Choice, ChoiceOptions, Expectation, FileLock, GarmentPackage,
    Limit, MANIFEST_FILE, Manifest, MeasuredCost, Moment, MovingCloth, PACKAGE_SCHEMA,
    PackageError, PackageParts, Progress, Quality, Settling, Simulator, StoredCost, StoredFabric,
    StoredParameters, StoredPattern, StoredPoses, StoredRestBody, Variant, familiarity,
    quality_name, quality_of, rank_correlation,
};
