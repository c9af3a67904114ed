//! What may be wrong with a garment on the body that wears it.

use std::path::Path;

use garnet::{
    Point3,
    data::Tailor,
    mesh::{StretchSummary, pattern_stretches},
    package::GarmentPackage,
    pattern::Wearer,
};

use crate::{cut_args::misfit, drape::WarningReport};

/// Edges of a garment that fits are stretched by less than this, but for 1 % of them.
const MAX_STRAIN: f32 = 0.15;

/// A garment that hangs lower than this under the soles does not hold, in metres.
const MAX_BELOW: f32 = 0.02;

/// Where the garment does not fit, is strained, or has fallen.
pub(super) fn warnings(
    tailor: &Tailor,
    wearer: &Wearer,
    package: &GarmentPackage,
    folder: &Path,
) -> anyhow::Result<Vec<WarningReport>> {
    let strain = strain(package)?;
    let strained = (strain > MAX_STRAIN).then(|| {
        let percent = 100.0 * strain;
        let text = format!(
            "1 % of the edges of the garment are stretched by more than {percent:.0} % on this body: it is too small"
        );
        ("strain", text)
    });
    let lowest = |positions: &[Point3]| positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
    let below = lowest(package.body.rest().positions()) - lowest(package.mesh.positions());
    let fallen = (below > MAX_BELOW).then(|| {
        let below = 100.0 * below;
        let text = format!("the garment hangs {below:.0} cm lower than the soles of the body");
        ("below_floor", text)
    });
    let misfit = misfit(
        tailor.parameters(),
        (tailor.size(), &wearer.measures),
        &wearer.measures,
    );
    let misfit = misfit.map(|text| ("misfit", text));
    let found = [misfit, strained, fallen].into_iter().flatten();
    let path = GarmentPackage::template_at(folder).display().to_string();
    let warnings = found.map(|(kind, text)| WarningReport {
        kind,
        path: path.clone(),
        count: None,
        text,
        severity: 0.0,
    });
    Ok(warnings.collect())
}

/// The strain that 1 % of the edges exceed, without those of ribs and waistbands.
pub(super) fn strain(package: &GarmentPackage) -> anyhow::Result<f32> {
    let Some(edges) = package.flat_edges()? else {
        return Ok(0.0);
    };
    let stretches = pattern_stretches(package.mesh.positions(), &edges)?;
    Ok(StretchSummary::of(stretches).p99 - 1.0)
}
