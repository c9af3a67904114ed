//! Whether the garment fits, in reports and as a line for people.

use garnet::{
    BoundGarment, Point3, PosedBody,
    body::shape::{Tape, unposed},
    data::finished_girths,
    drape::{FitLines, NoFit, RegionFit, fit_map, wearer_tape},
    io::Target,
    package::GarmentPackage,
    sim::RestShape,
};
use serde::Serialize;

use super::{Bound, args::Source, ready::package_of};
use crate::wearer_rig::wearer_of_rig;

/// The lines at which a garment is measured, and the girths of the rest body.
pub(super) struct Fitting {
    lines: FitLines,
    at_rest: Tape,
    /// The cloth as it was cut.
    rest: Option<RestShape>,
}

/// How a garment fits in one region. SI units.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct RegionReport {
    /// `chest`, `waist`, `hip`, `upper arm` or `thigh`.
    pub(crate) region: &'static str,
    /// `tight`, `close`, `regular` or `loose`.
    pub(crate) fit: &'static str,
    /// The girth of the body at rest.
    pub(crate) body_m: f64,
    /// The girth of the garment as it was cut.
    pub(crate) garment_m: f64,
    /// Garment less body.
    pub(crate) ease_m: f64,
    /// That over the girth of the body.
    pub(crate) ease: f64,
    /// How much longer the line round the garment is than as it was cut, as a share; none if the
    /// garment does not lie there.
    pub(crate) strain: Option<f64>,
}

impl From<RegionFit> for RegionReport {
    fn from(fit: RegionFit) -> Self {
        Self {
            region: fit.region.name(),
            fit: fit.word().name(),
            body_m: fit.body,
            garment_m: fit.garment,
            ease_m: fit.ease(),
            ease: fit.ease_share(),
            strain: fit.strain,
        }
    }
}

impl Fitting {
    /// Of the garment as its package has it cut, or as it lies on its body.
    ///
    /// # Errors
    ///
    /// Why it cannot be told, in words.
    pub(super) fn new(bound: &Bound, source: &Source) -> Result<Self, String> {
        let garment = garment(bound);
        if Tape::around(garment.body()).is_none() {
            return Err(NoFit::Stranger.to_string());
        }
        let told = |error: &dyn std::fmt::Display| error.to_string();
        let rest: Option<RestShape> = match (&bound.cut, package_of(source)) {
            (Some(cut), _) => Some(cut.package.rest.clone()),
            (None, Some(folder)) => {
                let cloth = GarmentPackage::read_cloth(folder, garment.mesh());
                Some(cloth.map_err(|error| told(&error))?.1)
            }
            (None, None) => None,
        };
        let pattern = match (&bound.cut, package_of(source)) {
            (Some(cut), _) => cut.package.manifest.pattern.clone(),
            (None, Some(folder)) => {
                let manifest = GarmentPackage::read_manifest(folder);
                manifest.map_err(|error| told(&error))?.pattern
            }
            (None, None) => None,
        };
        let finished = pattern.map(|pattern| finished_girths(&pattern, garment.body()));
        let finished = finished.transpose().map_err(|error| told(&error))?;
        let lines = FitLines::new(garment, rest.as_ref(), finished.unwrap_or_default());
        let lines = lines.map_err(|error| told(&error))?;
        let at_rest = match &bound.refit {
            Some(refit) if Tape::around(bound.garment.body()).is_none() => {
                let skin = bound.garment.body().rest().positions();
                let stand_in = refit.stand_in(skin).map_err(|error| told(&error))?;
                wearer_tape(refit.own(), &stand_in)
            }
            _ => Tape::around(bound.garment.body()),
        };
        let at_rest = at_rest.ok_or_else(|| NoFit::Stranger.to_string())?;
        Ok(Self {
            lines,
            at_rest,
            rest,
        })
    }

    /// The girths of a body at rest; none where they cannot be found.
    fn wearer(&self, (bound, target): (&Bound, &Target), body: &PosedBody) -> Option<Tape> {
        let of_rig = || {
            let wearer = wearer_of_rig(&target.path, body.skin().positions());
            wearer.as_ref().and_then(Tape::around)
        };
        let cut = bound.cut.as_ref();
        if let Some(known) = cut.and_then(|cut| cut.wearers.get(&target.path)) {
            return Some((**known).clone());
        }
        let unposed = || {
            let wearer = unposed(bound.garment.body(), body.skin().positions()).ok()??;
            Tape::around(&wearer)
        };
        match (body.shape_offsets(), &bound.refit) {
            (None, _) => Some(self.at_rest.clone()),
            (Some(_), None) => {
                (of_rig().or_else(unposed)).or_else(|| wearer_tape(bound.garment.body(), body))
            }
            (Some(_), Some(refit)) => {
                let stand_in = refit.stand_in(body.skin().positions()).ok()?;
                wearer_tape(refit.own(), &stand_in)
            }
        }
    }

    /// How the garment fits on a body, with its vertices at `positions` `[vertex]`, in metres; none
    /// where the girths of that body cannot be found.
    pub(super) fn of(
        &self,
        on: (&Bound, &Target),
        positions: &[Point3],
        body: &PosedBody,
    ) -> Option<Vec<RegionReport>> {
        let wearer = self.wearer(on, body)?;
        let nodes = garment(on.0).cloth().weld().gather(positions);
        let fits = self.lines.fit(&wearer, &nodes);
        Some(fits.into_iter().map(RegionReport::from).collect())
    }

    /// The same at each vertex `[vertex]`, as a heat map.
    pub(super) fn levels(&self, on: (&Bound, &Target), body: &PosedBody) -> Option<Vec<f32>> {
        let wearer = self.wearer(on, body)?;
        fit_map(garment(on.0), self.rest.as_ref(), &wearer).ok()
    }
}

/// The garment on the body that its girths are measured on.
fn garment(bound: &Bound) -> &BoundGarment {
    (bound.refit.as_ref()).map_or(&*bound.garment, |refit| refit.garment())
}

/// One line for all regions.
pub(super) fn line(regions: &[RegionReport]) -> String {
    let shown = regions.iter().map(|found| {
        let centimetres = (100.0 * found.ease_m).round() as i64;
        format!("{} {} ({centimetres:+} cm)", found.region, found.fit)
    });
    format!("fit: {}", shown.collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_tells_each_region_with_its_ease() {
        let found = |region, fit, ease_m| RegionReport {
            region,
            fit,
            body_m: 1.0,
            garment_m: 1.0 + ease_m,
            ease_m,
            ease: ease_m,
            strain: None,
        };
        let regions = [
            found("chest", "regular", 0.094),
            found("waist", "tight", -0.021),
            found("hip", "tight", -0.004),
        ];
        assert_eq!(
            line(&regions),
            "fit: chest regular (+9 cm), waist tight (-2 cm), hip tight (+0 cm)"
        );
    }
}
