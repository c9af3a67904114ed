//! A trained network as a way to drape.

use std::path::PathBuf;

use anyhow::Context;
use garnet::{
    BoundGarment, Draper, ModelFile, Moved, Network, PosedBody, Warped,
    package::{BodyPath, GarmentPackage, Manifest, Settling},
};

use super::{
    Bound,
    args::{NetworkChoice, Source},
    report::NetworkReport,
    timing::timed,
};
use crate::failure::{Hint, refused};

/// The variant that other commands call `params`.
const PARAMETERS: [&str; 2] = ["params", "global-params"];

/// A garment that a network drapes.
pub(super) struct Learned {
    network: Network,
    name: String,
    weights: PathBuf,
    settling: Settling,
    settles: bool,
}

/// Whether a network drapes.
pub(super) enum Found<T = Learned> {
    /// This one.
    Network(Box<T>),
    /// None was asked for.
    NotAsked,
    /// The package has none, and none was asked for by name.
    NoneInPackage,
}

/// A network that was read, for a garment that need not be bound yet.
pub(super) struct Unbound {
    manifest: Manifest,
    name: String,
    weights: PathBuf,
    file: ModelFile,
}

impl Unbound {
    /// The network that was chosen.
    pub(super) fn find(choice: &NetworkChoice, source: &Source) -> anyhow::Result<Found<Self>> {
        let package = match source {
            Source::Files(files) => files.package.as_deref(),
            Source::Scene(_) => None,
        };
        let (folder, name) = match (choice, package) {
            (NetworkChoice::None, _) | (NetworkChoice::Default, None) => {
                return Ok(Found::NotAsked);
            }
            (NetworkChoice::Default, Some(folder)) => (folder, None),
            (NetworkChoice::Named(name), Some(folder)) => (folder, Some(name.as_str())),
            (NetworkChoice::Named(name), None) => {
                return Err(refused(
                    format!("there is no network `{name}`"),
                    "the garment is no garment package, which trained networks are in",
                    "drape a package, or choose --method auto, lbs, dqs, warp or sim",
                ));
            }
        };
        let manifest = GarmentPackage::read_manifest(folder)?;
        let Some(name) = chosen(&manifest, name) else {
            return Ok(Found::NoneInPackage);
        };
        let weights = manifest.weights_of(folder, &name).hint(|| {
            "`--method` takes auto, lbs, dqs, warp, sim or a variant of the package; `garnet train` \
             adds variants"
                .to_owned()
        })?;
        let file = ModelFile::read(&weights).with_context(|| cannot_use(&name))?;
        Ok(Found::Network(Box::new(Self {
            manifest,
            name,
            weights,
            file,
        })))
    }

    /// The network for the garment that is draped.
    fn bound_to(self, bound: &Bound) -> anyhow::Result<Learned> {
        let parameters = self.manifest.sewing_parameters();
        let (garment, body) = match &bound.refit {
            Some(refit) => (refit.garment(), refit.own()),
            None => (&bound.garment, &bound.body),
        };
        let network = Network::bind(self.file, garment, body, &parameters);
        let network = network.with_context(|| cannot_use(&self.name))?;
        let from = network.moment();
        let variant = self.manifest.variant(&self.name);
        let frames = variant.and_then(|variant| variant.settle_frames);
        let settles = variant.is_some_and(|variant| variant.settling(from).takes_time());
        Ok(Learned {
            network,
            settles,
            settling: Settling {
                from,
                frames: frames.unwrap_or(from.settle_frames()),
            },
            name: self.name,
            weights: self.weights,
        })
    }
}

impl Found<Unbound> {
    /// The same for the garment that is draped.
    pub(super) fn bound_to(self, bound: &Bound) -> anyhow::Result<Found> {
        Ok(match self {
            Self::Network(network) => Found::Network(Box::new(network.bound_to(bound)?)),
            Self::NotAsked => Found::NotAsked,
            Self::NoneInPackage => Found::NoneInPackage,
        })
    }
}

fn cannot_use(name: &str) -> String {
    format!("cannot use the network `{name}`")
}

impl Learned {
    /// The network that was chosen.
    pub(super) fn find(
        bound: &Bound,
        choice: &NetworkChoice,
        source: &Source,
    ) -> anyhow::Result<Found> {
        Unbound::find(choice, source)?.bound_to(bound)
    }

    /// What the report names the method.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// How its drapes settle, if they do.
    pub(super) fn settling(&self) -> Settling {
        self.settling
    }

    /// Whether it predicts the cloth while the body is on its way, which is not on the body.
    pub(super) fn is_on_way(&self) -> bool {
        self.settling.from.is_on_way()
    }

    /// Whether its drapes come nearer to the teacher when they settle, or are none before.
    pub(super) fn settles(&self) -> bool {
        self.settles
    }

    pub(super) fn report(&self) -> NetworkReport {
        NetworkReport {
            variant: self.name.clone(),
            weights: self.weights.display().to_string(),
        }
    }

    /// Warps and moves, or falls back to the warp; tells how long the network took, in seconds.
    pub(super) fn drape(
        &mut self,
        bound: &Bound,
        posed: &PosedBody,
    ) -> anyhow::Result<(Moved, f64)> {
        if !self.is_on_way() {
            return self.drape_on(bound, posed);
        }
        let path = BodyPath::to_posed(&bound.body, posed);
        let on_way = path.posed(&bound.body, self.settling.from.motion_share())?;
        let (mut moved, seconds) = self.drape_on(bound, &on_way)?;
        if moved.fallback.is_some() {
            moved.garment = Draper::new().warp(&bound.garment, posed)?;
        }
        Ok((moved, seconds))
    }

    /// As [`Learned::drape`], of a body where the network tells of the cloth.
    fn drape_on(&mut self, bound: &Bound, posed: &PosedBody) -> anyhow::Result<(Moved, f64)> {
        let Some(refit) = &bound.refit else {
            return self.moved(&bound.garment, posed);
        };
        let stand_in = refit.stand_in(posed.skin().positions())?;
        let (moved, seconds) = self.moved(refit.garment(), &stand_in)?;
        if moved.fallback.is_some() {
            let garment = Draper::new().warp(&bound.garment, posed)?;
            return Ok((Moved { garment, ..moved }, seconds));
        }
        let places = moved.garment.positions(refit.garment());
        let moved = Moved {
            garment: Warped::at(&bound.garment, &places),
            ..moved
        };
        Ok((moved, seconds))
    }

    fn moved(&mut self, garment: &BoundGarment, posed: &PosedBody) -> anyhow::Result<(Moved, f64)> {
        let warped = self.network.warped(garment, posed)?;
        let (moved, seconds) = timed(|| self.network.moved(garment, posed, &warped));
        Ok((moved?, seconds))
    }
}

/// The name of the variant that is asked for, or of the default one.
fn chosen(manifest: &Manifest, name: Option<&str>) -> Option<String> {
    let Some(name) = name else {
        return manifest
            .default_variant()
            .map(|variant| variant.name.clone());
    };
    let is_alias = PARAMETERS.contains(&name) && manifest.variant(name).is_none();
    let alias = PARAMETERS
        .into_iter()
        .find(|alias| manifest.variant(alias).is_some());
    Some(alias.filter(|_| is_alias).unwrap_or(name).to_owned())
}
