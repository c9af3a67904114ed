//! What may be wrong with a garment on the body that wears it.

use std::path::Path;

use garnet::{
    Point3,
    data::Tailor,
    mesh::{StretchSummary, pattern_stretches},
    package::GarmentPackage,
    pattern::{Ease, Wearer},
};

use crate::drape::WarningReport;

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
    let misfit = misfit(tailor, wearer).map(|text| ("misfit", text));
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

/// Where the garment is too tight or too wide.
fn misfit(tailor: &Tailor, wearer: &Wearer) -> Option<String> {
    let fit = tailor.fit(wearer);
    let bad = fit.eases.iter().filter(|ease| !ease.is_allowed());
    let bad: Vec<String> = bad.map(shown).collect();
    if bad.is_empty() {
        return None;
    }
    let bad = bad.join(", ");
    let Some(size) = tailor.size() else {
        return Some(format!(
            "with these parameters the garment does not fit: {bad}"
        ));
    };
    let advice = match tailor.parameters().best_size(&wearer.measures) {
        Some(best) => format!("size {best} fits best"),
        None => "no size fits; without `--size` it is cut to measure".to_owned(),
    };
    Some(format!(
        "size {size} does not fit this body: {bad}; {advice}"
    ))
}

fn shown(ease: &Ease) -> String {
    let [low, high] = ease.allowed.map(|share| 100.0 * share);
    let wanted = if high.is_finite() {
        format!("{low:.0} to {high:.0} %")
    } else {
        format!("{low:.0} % and more")
    };
    format!(
        "its {} has an ease of {:.0} % ({wanted} fits)",
        ease.place,
        100.0 * ease.share
    )
}
