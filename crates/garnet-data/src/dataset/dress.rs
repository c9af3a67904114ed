//! Bodies of the population, dressed and posed.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

use garnet_body::{
    poses::{PoseSampler, Poser, SelfContact},
    shape::{BodyParameters, ParametricBody, Population, tape_measures},
};
use garnet_drape::{BodyPath, GarmentPackage, PackageError, Simulator, StoredParameters};
use garnet_pattern::Wearer;

use super::generate::DatasetOptions;
use super::manifest::Sizing;
use super::record::{BodyRecord, Posed, SceneRecord};
use crate::tailor::{Tailor, values};
use crate::wearer::{self, Fitting};
use crate::{DataError, Moment, SceneReport};

/// Dresses bodies of the population.
pub(super) struct Dresser<'a> {
    package: &'a GarmentPackage,
    options: DatasetOptions,
    population: Population,
    /// Drapes the template.
    template: Simulator,
    /// Cuts garments to measure.
    tailor: Option<Tailor>,
    /// Whom the template fits.
    fitting: Option<Fitting>,
}

/// What became of a scene.
pub(super) enum Outcome {
    /// It is in the data set; its numbers are still to be set.
    Accepted(Box<SceneRecord>),
    /// It is not.
    Rejected {
        /// The sequence that the pose is from.
        sequence: String,
        /// Short name of the reason.
        kind: &'static str,
        /// What was measured.
        reason: String,
    },
}

/// A body of the population with the garment for it.
pub(super) struct Dressed {
    parameters: BodyParameters,
    ready: Result<Ready, (&'static str, String)>,
}

struct Ready {
    body: garnet_skin::Body,
    poser: Poser,
    contact: SelfContact,
    /// A simulator of its own, if the garment was cut for it.
    own: Option<Own>,
}

struct Own {
    simulator: Simulator,
    garment: BTreeMap<String, f64>,
    worn: Vec<garnet_mesh::Point3>,
}

impl<'a> Dresser<'a> {
    pub(super) fn new(
        package: &'a GarmentPackage,
        options: &DatasetOptions,
    ) -> Result<Self, DataError> {
        let tailor = match options.sizing {
            Sizing::OneSize if options.vary.is_empty() => {
                if tape_measures(&package.body).is_none() {
                    let vertices = package.body.rest().num_vertices();
                    return Err(DataError::ForeignBody { vertices });
                }
                None
            }
            Sizing::OneSize => return Err(DataError::VariedTemplate),
            Sizing::MadeToMeasure => {
                let tailor = Tailor::of_package(package)?.ok_or(DataError::NoPattern)?;
                options.vary.check(tailor.parameters())?;
                Some(tailor.with_size(None))
            }
        };
        Ok(Self {
            package,
            options: options.clone(),
            population: Population::new(options.seed),
            template: Simulator::new(package)?,
            tailor,
            fitting: Fitting::of_package(package)?,
        })
    }

    /// Whether the garment fits a body of the population: by the chest, waist and hip that it is
    /// given. Garments without a pattern fit all.
    pub(super) fn fits(&self, parameters: &BodyParameters) -> bool {
        let fitting = self.fitting.as_ref();
        self.tailor.is_some() || fitting.is_none_or(|fitting| fitting.fits(parameters))
    }

    /// Builds a body, and cuts and fits the garment if each has its own.
    pub(super) fn dressed(&self, index: u64, stop: &AtomicBool) -> Dressed {
        let parameters = self.population.sample(index);
        let ready = self.ready(index, &parameters, stop);
        Dressed { parameters, ready }
    }

    /// The tailor with the parameters of a body.
    fn varied(&self, tailor: &Tailor, body: u64) -> Result<Tailor, DataError> {
        let DatasetOptions { seed, vary, .. } = &self.options;
        let parameters = vary.drawn(tailor.parameters(), *seed, body)?;
        Ok(tailor.clone().with_parameters(parameters))
    }

    fn ready(
        &self,
        index: u64,
        parameters: &BodyParameters,
        stop: &AtomicBool,
    ) -> Result<Ready, (&'static str, String)> {
        let no_body = |error: &dyn std::fmt::Display| ("body", error.to_string());
        let built = ParametricBody::build(parameters).map_err(|error| no_body(&error))?;
        let own = match &self.tailor {
            None => None,
            Some(tailor) => {
                let worn = wearer::wearer(built.body(), built.measures())
                    .map_err(DataError::from)
                    .and_then(|wearer| {
                        own(&self.varied(tailor, index)?, built.body(), &wearer, stop)
                    });
                Some(worn.map_err(|error| ("wearing", error.to_string()))?)
            }
        };
        let body = built.into_body();
        Ok(Ready {
            poser: Poser::new(body.skeleton()).map_err(|error| no_body(&error))?,
            contact: SelfContact::new(&body).map_err(|error| no_body(&error))?,
            body,
            own,
        })
    }
}

impl Dressed {
    /// What the data set keeps of the body.
    pub(super) fn record(&self, number: u32) -> BodyRecord {
        let own = self
            .ready
            .as_ref()
            .ok()
            .and_then(|ready| ready.own.as_ref());
        BodyRecord {
            number,
            parameters: Some(StoredParameters::from(&self.parameters)),
            garment: own.map_or_else(BTreeMap::new, |own| own.garment.clone()),
            worn: own.map(|own| own.worn.clone()),
        }
    }

    /// Drapes the garment on the body in a pose.
    pub(super) fn drape(
        &self,
        dresser: &Dresser<'_>,
        sampler: &PoseSampler,
        number: u64,
        stop: &AtomicBool,
    ) -> Outcome {
        let ready = match &self.ready {
            Ok(ready) => ready,
            Err((kind, reason)) => return rejected("", kind, reason.clone()),
        };
        let sound = match sampler.sample_for(&ready.poser, &ready.contact, number) {
            Ok(sound) => sound,
            Err(error) => return rejected("", "pose", error.to_string()),
        };
        let options = &dresser.options;
        let (simulator, from) = match &ready.own {
            Some(own) => (&own.simulator, &ready.body),
            None => (&dresser.template, &dresser.package.body),
        };
        let draped = BodyPath::to_shape(from, &ready.body, &sound.pose)
            .map_err(PackageError::from)
            .and_then(|path| simulator.until(&path, options.quality, options.until, stop));
        let drape = match draped {
            Ok(drape) => drape,
            Err(error) => return rejected(sound.sequence, "simulation", error.to_string()),
        };
        let report = SceneReport::from(&drape.report);
        let limits = if options.until.is_rest() {
            options.limits
        } else {
            options.limits.of_arrivals()
        };
        if let Some((kind, reason)) = limits.violation(&report) {
            return rejected(sound.sequence, kind, reason);
        }
        Outcome::Accepted(Box::new(SceneRecord {
            body: 0,
            pose: 0,
            sequence: sound.sequence.to_owned(),
            posed: Posed::Pose(sound.pose),
            garment: match options.until {
                Moment::Midway => drape.midway.clone(),
                _ => drape.positions,
            },
            arrived: options.until.is_rest().then_some(drape.arrived),
            midway: (options.until != Moment::Midway).then_some(drape.midway),
            report: Some(report),
        }))
    }
}

fn own(
    tailor: &Tailor,
    body: &garnet_skin::Body,
    wearer: &Wearer,
    stop: &AtomicBool,
) -> Result<Own, DataError> {
    let worn = tailor.dress(body, wearer, stop)?;
    Ok(Own {
        simulator: tailor.simulator(&worn, body)?,
        garment: values(&worn.sewn.parameters),
        worn: worn.positions,
    })
}

fn rejected(sequence: &str, kind: &'static str, reason: String) -> Outcome {
    Outcome::Rejected {
        sequence: sequence.to_owned(),
        kind,
        reason,
    }
}
