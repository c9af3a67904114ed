//! Fabrics by their names.

use garnet::{
    package::StoredFabric,
    sim::{FABRIC_NAMES, Fabric},
};

use crate::{failure::refused, hints::did_you_mean_or};

/// The fabric of a name.
pub(crate) fn fabric(name: &str) -> anyhow::Result<StoredFabric> {
    let fabric = Fabric::named(name).ok_or_else(|| {
        let all = format!("the fabrics are: {}", FABRIC_NAMES.join(", "));
        refused(
            format!("there is no fabric `{name}`"),
            "it is none of the fabrics that are built in",
            did_you_mean_or(name, FABRIC_NAMES, &all),
        )
    })?;
    Ok(StoredFabric::new(name, &fabric))
}
