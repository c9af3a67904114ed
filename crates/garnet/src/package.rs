//! Garment packages: a template, the body that it lies on, and trained variants.

pub use garnet_drape::{
    BodyPath, GarmentPackage, MANIFEST_FILE, Manifest, PACKAGE_SCHEMA, PackageError, PackageParts,
    Quality, Settling, StoredFabric, StoredParameters, StoredPattern, StoredRestBody, Teacher,
    Variant, quality_name, quality_of,
};
