//! Whether the garment fits, in reports and as a line for people.

use std::{f32::consts::FRAC_PI_8, sync::Arc};

use garnet::{
    BoundGarment, Point3, PosedBody,
    body::shape::{Recognized, Tape, recognized, unposed},
    data::finished_girths,
    drape::{FitLines, NoFit, RegionFit, fit_map, wearer_tape},
    io::Target,
    package::GarmentPackage,
    sim::RestShape,
};
use serde::Serialize;

use super::{Bound, args::Source, ready::package_of};
use crate::wearer_rig::{TOLD, wearer_of_rig};

/// The lines at which a garment is measured, and the girths of the rest body.
pub(super) struct Fitting {
    lines: FitLines,
    at_rest: Tape,
    /// The cloth as it was cut.
    rest: Option<RestShape>,
}

/// The girths of who wears a garment.
#[derive(Debug, Clone)]
pub(super) struct Girths {
    pub(super) tape: Arc<Tape>,
    /// Whether they were told from the skin in a pose, and may be some centimetres off.
    pub(super) is_told: bool,
}

/// How a garment fits its wearer.
#[derive(Debug)]
pub(super) struct FoundFit {
    pub(super) regions: Vec<RegionReport>,
    /// Whether the girths of the wearer were told from the skin in a pose.
    pub(super) is_told: bool,
}

/// Bodies of other topologies stand in a pose where a joint is turned farther than this against
/// the first. A larger value takes more of them for bodies at rest.
const POSED: f32 = FRAC_PI_8;

/// Whether a body stands in a pose, by its joints.
fn is_posed(body: &PosedBody) -> bool {
    let mut turns = body.posed_from_rest().iter().map(|it| it.rotation);
    let Some(first) = turns.next() else {
        return false;
    };
    turns.any(|turn| turn.angle_to(&first) > POSED)
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
    fn wearer(&self, (bound, target): (&Bound, &Target), body: &PosedBody) -> Option<Girths> {
        let known = bound
            .cut
            .as_ref()
            .and_then(|cut| cut.wearers.get(&target.path));
        if known.is_some() {
            return known.cloned();
        }
        let girths = |tape, is_told| Girths {
            tape: Arc::new(tape),
            is_told,
        };
        if body.shape_offsets().is_none() {
            return Some(girths(self.at_rest.clone(), false));
        }
        let skin = body.skin().positions();
        if let Some(refit) = &bound.refit {
            let stand_in = refit.stand_in(skin).ok()?;
            let tape = wearer_tape(refit.own(), &stand_in)?;
            return Some(girths(tape, is_posed(body)));
        }
        if let Some(tape) = wearer_of_rig(&target.path, skin).and_then(|it| Tape::around(&it)) {
            return Some(girths(tape, false));
        }
        let own = bound.garment.body();
        let mesh = own.rest().with_positions(skin.to_vec()).ok()?;
        let is_told = matches!(recognized(&mesh), Recognized::Posed);
        let at_rest = unposed(own, skin).ok().flatten();
        let tape = at_rest.and_then(|it| Tape::around(&it));
        Some(girths(tape.or_else(|| wearer_tape(own, body))?, is_told))
    }

    /// How the garment fits on a body, with its vertices at `positions` `[vertex]`, in metres; none
    /// where the girths of that body cannot be found.
    pub(super) fn of(
        &self,
        on: (&Bound, &Target),
        positions: &[Point3],
        body: &PosedBody,
    ) -> Option<FoundFit> {
        let wearer = self.wearer(on, body)?;
        let nodes = garment(on.0).cloth().weld().gather(positions);
        let fits = self.lines.fit(&wearer.tape, &nodes);
        Some(FoundFit {
            regions: fits.into_iter().map(RegionReport::from).collect(),
            is_told: wearer.is_told,
        })
    }

    /// The same at each vertex `[vertex]`, as a heat map.
    pub(super) fn levels(&self, on: (&Bound, &Target), body: &PosedBody) -> Option<Vec<f32>> {
        let wearer = self.wearer(on, body)?;
        fit_map(garment(on.0), self.rest.as_ref(), &wearer.tape).ok()
    }
}

/// The garment on the body that its girths are measured on.
fn garment(bound: &Bound) -> &BoundGarment {
    (bound.refit.as_ref()).map_or(&*bound.garment, |refit| refit.garment())
}

/// One line for all regions, `is_told` of girths that were told from the skin in a pose.
pub(super) fn line(regions: &[RegionReport], is_told: bool) -> String {
    let shown = regions.iter().map(|found| {
        let centimetres = (100.0 * found.ease_m).round() as i64;
        format!("{} {} ({centimetres:+} cm)", found.region, found.fit)
    });
    let shown = shown.collect::<Vec<_>>().join(", ");
    if is_told {
        format!("fit: {shown}; {TOLD}")
    } else {
        format!("fit: {shown}")
    }
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
            line(&regions, false),
            "fit: chest regular (+9 cm), waist tight (-2 cm), hip tight (+0 cm)"
        );
        let told = line(&regions[..1], true);
        assert!(told.starts_with("fit: chest regular (+9 cm); as told from its pose"));
    }
}
