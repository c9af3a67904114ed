//! Fabrics by their names.

use garnet::{
    package::StoredFabric,
    sim::{FABRIC_NAMES, Fabric},
};

use crate::failure::refused;

/// The fabric of a name.
pub(crate) fn fabric(name: &str) -> anyhow::Result<StoredFabric> {
    let fabric = Fabric::named(name).ok_or_else(|| {
        refused(
            format!("there is no fabric `{name}`"),
            "it is none of the fabrics that are built in",
            format!("the fabrics are: {}", FABRIC_NAMES.join(", ")),
        )
    })?;
    Ok(StoredFabric::new(name, &fabric))
}
