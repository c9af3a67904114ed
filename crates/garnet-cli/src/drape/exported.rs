//! The file of what a network is told and says.

use std::path::Path;

use anyhow::Context;

use super::Ready;
use crate::failure::refused;

/// Writes what the network is told of the one target, and what it says.
pub(super) fn write(ready: &Ready, path: &Path) -> anyhow::Result<()> {
    let (Some(network), Some(report)) = (ready.draper.network(), ready.network_report()) else {
        return Err(refused(
            "`--export-inputs` has nothing to write",
            "no network drapes",
            "drape a package, and name a variant with `--method`",
        ));
    };
    let target = ready.bound.targets.first();
    let target = target.context("there is nothing to drape on")?;
    let posed = target.posed(ready.bound.garment.body())?;
    let case = ready.draper.network_case(&posed)?;
    let text = serde_json::json!({
        "schema": "garnet.inputs/1",
        "variant": report.variant,
        "moment": network.moment().name(),
    });
    let case = case.context("no network drapes")?;
    case.write(path, &text.to_string())
        .with_context(|| format!("cannot write `{}`", path.display()))
}
