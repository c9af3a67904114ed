//! What drapes a bound garment: the warp, a network of its package, or the simulation.

use std::path::{Path, PathBuf};

use anyhow::Context;
use garnet::{
    Draper, PosedBody,
    net::{ModelFile, Network},
    package::{
        Choice, ChoiceOptions, Expectation, GarmentPackage, Limit, Manifest, Quality, StoredPoses,
        familiarity,
    },
};

use super::{
    Bound,
    args::{Job, MethodName, NetworkChoice, Simulation, Source},
    choice::{ChoiceReport, KnownCut},
    fit::Fitting,
    method_name,
    report::{NetworkReport, SimulationReport},
    simulated::{Simulated, simulator_of},
    strained::{Draped, Remedy},
    tailored::Cut,
    warning::{Problem, Warning},
};
use crate::{
    console::Console,
    failure::{Hint, refused},
    hints::did_you_mean_or,
};

/// A garment and all that drapes it.
pub(super) struct Ready {
    pub(super) bound: Bound,
    pub(super) draper: Draper,
    pub(super) method: Method,
    /// How the method was chosen, if it was.
    pub(super) choice: Option<ChoiceReport>,
    /// How far off drapes are expected to be, if the package says so.
    expected: Option<Expected>,
    /// What tells whether the garment fits, or why that cannot be told.
    pub(super) fitting: Result<Fitting, String>,
}

/// How far from the simulation drapes of a network are expected to be.
struct Expected {
    poses: StoredPoses,
    /// None if cloth settles for another time than it was measured for.
    of_variant: Option<Expectation>,
}

/// The way in which a garment comes to a body.
pub(super) enum Method {
    /// The warp of the options.
    Warp,
    /// A network of the package.
    Network(NetworkReport),
    /// The simulation.
    Simulation(Simulated),
}

/// Whether a network drapes.
pub(super) enum Found {
    /// This one.
    Network(Box<Unbound>),
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
    /// Whether its cloth is relaxed; `None` leaves that to the variant.
    is_relaxed: Option<bool>,
}

/// Whether a garment is cut in a size, and is the package's own but for that.
fn is_of_size(cut: Option<&Cut>) -> bool {
    cut.is_some_and(|cut| cut.is_size)
}

/// That a package has no network, and what is done.
fn note_of_no_variant(job: &Job) -> String {
    let package = package_of(&job.source).map_or_else(
        || "the package".to_owned(),
        |package| format!("`{}`", package.display()),
    );
    let settled = if job.settle.is_some() {
        ", settled"
    } else {
        ""
    };
    format!("note: {package} has no trained variant: the garment is warped{settled} and untangled")
}

/// The folder of the package that is draped, if it is one.
pub(super) fn package_of(source: &Source) -> Option<&Path> {
    match source {
        Source::Files(files) => files.package.as_deref(),
        Source::Scene(_) => None,
    }
}

impl Found {
    /// Binds a garment, and reads the network that was chosen, or chooses one. What is to be within
    /// a distance is chosen by the poses, which are known once the garment is bound.
    pub(super) fn beside<T: Send>(
        job: &Job,
        cut: Option<&Cut>,
        bind: impl FnOnce() -> (anyhow::Result<Bound>, T) + Send,
    ) -> anyhow::Result<(Bound, T, (Self, Option<ChoiceReport>))> {
        if !matches!(job.limit, Some(Limit::Distance(_))) {
            let ((bound, seconds), found) = rayon::join(bind, || Self::read(job, cut, None));
            return Ok((bound?, seconds, found?));
        }
        let (bound, seconds) = bind();
        let bound = bound?;
        let found = Self::read(job, cut, Some(&bound))?;
        Ok((bound, seconds, found))
    }

    /// Reads the network that was chosen, or chooses one, by the poses of what is bound, if it is.
    fn read(
        job: &Job,
        cut: Option<&Cut>,
        bound: Option<&Bound>,
    ) -> anyhow::Result<(Self, Option<ChoiceReport>)> {
        let Some(limit) = job.limit else {
            return Ok((Self::of(&job.network, &job.source, is_of_size(cut))?, None));
        };
        let Some(folder) = package_of(&job.source) else {
            return Err(refused(
                "there are no variants to choose from",
                "the garment is no garment package, which trained variants are in",
                "drape a package, or leave out `--budget` and `--tolerance`",
            ));
        };
        let is_unknown = cut.is_some_and(|cut| cut.is_unknown);
        if is_unknown && matches!(limit, Limit::Distance(_)) {
            return Err(refused(
                "`--tolerance` is given for another cut than that of the package",
                "how far drapes are from the simulation is known of the package's own cut alone",
                "leave it out, or name a variant with `--method`, or `--method sim`",
            ));
        }
        let manifest = GarmentPackage::read_manifest(folder)?;
        let mut options = ChoiceOptions::new(limit);
        options.relax_frames = job.settle;
        if let Some((bound, poses)) = bound.zip(manifest.poses.as_ref()) {
            options.far = farthest(bound, poses)?;
        }
        let choice = Choice::new(folder, &manifest, &options);
        let found = match choice.candidate() {
            Some(chosen) => {
                let is_relaxed = Some(chosen.is_relaxed);
                let name = &chosen.variant;
                let unbound = Unbound::read(folder, manifest, name, (is_relaxed, is_of_size(cut)))?;
                Self::Network(Box::new(unbound))
            }
            None => Self::NotAsked,
        };
        let known = if is_unknown {
            KnownCut::Other
        } else {
            KnownCut::Own
        };
        Ok((found, Some(ChoiceReport::new(&choice, known))))
    }

    fn of(choice: &NetworkChoice, source: &Source, is_size: bool) -> anyhow::Result<Self> {
        let (folder, name) = match (choice, package_of(source)) {
            (NetworkChoice::None, _) | (NetworkChoice::Default, None) => return Ok(Self::NotAsked),
            (NetworkChoice::Default, Some(folder)) => (folder, None),
            (NetworkChoice::Named(name), Some(folder)) => (folder, Some(name.as_str())),
            (NetworkChoice::Named(name), None) => {
                let all = "drape a package, or choose --method auto, warp, dqs, lbs or sim";
                return Err(refused(
                    format!("there is no variant `{name}`"),
                    "the garment is no garment package, which trained variants are in",
                    did_you_mean_or(name, MethodName::OF_ALL, all),
                ));
            }
        };
        let manifest = GarmentPackage::read_manifest(folder)?;
        let default = manifest
            .default_variant()
            .map(|variant| variant.name.clone());
        let Some(name) = name.map(str::to_owned).or(default) else {
            return Ok(Self::NoneInPackage);
        };
        let unbound = Unbound::read(folder, manifest, &name, (None, is_size))?;
        Ok(Self::Network(Box::new(unbound)))
    }
}

impl Unbound {
    fn read(
        folder: &Path,
        manifest: Manifest,
        name: &str,
        (is_relaxed, is_size): (Option<bool>, bool),
    ) -> anyhow::Result<Self> {
        let weights = if is_size {
            manifest.weights_of_sizes(folder, name)
        } else {
            manifest.weights_of(folder, name)
        };
        let cannot = || format!("cannot drape `{}` by `{name}`", folder.display());
        let weights = weights.with_context(cannot).hint(|| {
            let variants = manifest.variants.iter();
            let names = variants.flat_map(|variant| variant.aliases.iter().chain([&variant.name]));
            let names = names.map(String::as_str).chain(MethodName::OF_ALL);
            let all = "`--method` takes a variant of the package, auto, warp, dqs, lbs or sim; \
                       `garnet train` adds variants";
            did_you_mean_or(name, names, all)
        })?;
        let file = ModelFile::read(&weights).with_context(|| cannot_use(name))?;
        let named = manifest.variant(name).map(|variant| variant.name.clone());
        Ok(Self {
            name: named.unwrap_or_else(|| name.to_owned()),
            manifest,
            weights,
            file,
            is_relaxed,
        })
    }

    /// The network in a draper of the garment that is draped, and what is expected of its drapes.
    fn joined(
        self,
        draper: Draper,
        bound: &Bound,
        settle: Option<u32>,
    ) -> anyhow::Result<(Draper, NetworkReport, Option<Expected>)> {
        // What is cut anew has another manifest than the one that names the variants.
        let cut = (bound.cut.as_ref()).map_or(&self.manifest, |cut| &cut.package.manifest);
        let parameters = cut.sewing_parameters();
        let garment = match &bound.refit {
            Some(refit) => refit.garment(),
            None => &bound.garment,
        };
        let network = Network::bind(self.file, garment, &parameters);
        let network = network.with_context(|| cannot_use(&self.name))?;
        let moment = network.moment();
        let relaxation = (self.manifest).relaxation(&self.name, moment, self.is_relaxed);
        let draper = draper.with_network(network, relaxation.frames);
        let variant = self.manifest.variant(&self.name);
        let usual = variant.map(|variant| variant.settling(moment).frames);
        let is_usual = settle.is_none() && usual == Some(relaxation.frames);
        // What is known is known of drapes on the body of the package.
        let poses = self.manifest.poses.clone();
        let poses = poses.filter(|_| bound.refit.is_none());
        let expected = poses.map(|poses| Expected {
            poses,
            of_variant: variant.and_then(|variant| variant.expected.filter(|_| is_usual)),
        });
        let report = NetworkReport {
            variant: self.name,
            weights: self.weights.display().to_string(),
        };
        Ok((draper, report, expected))
    }
}

/// Of more targets than this, as many are looked at.
const LOOKED_AT: usize = 64;

/// How far the targets are from the middle of the package's poses, the farthest of them, in
/// radians; none on bodies of other topologies.
fn farthest(bound: &Bound, poses: &StoredPoses) -> anyhow::Result<Option<f64>> {
    if bound.refit.is_some() {
        return Ok(None);
    }
    let step = bound.targets.len().div_ceil(LOOKED_AT).max(1);
    let mut farthest = None;
    for target in bound.targets.iter().step_by(step) {
        let posed = target.posed(bound.garment.body())?;
        let far = poses.distance_of(&posed, &bound.garment);
        farthest = farthest.into_iter().chain(far).reduce(f64::max);
    }
    Ok(farthest)
}

fn cannot_use(name: &str) -> String {
    format!("cannot use the network `{name}`")
}

/// What is to be said of dolls and giants.
fn note_of_size(size: f32) -> Option<String> {
    ((size - 1.0).abs() > f32::EPSILON).then(|| {
        format!(
            "note: the body is {size:.3} times as large as a person; it is simulated as large as \
             one, with cloth and gravity as people know them"
        )
    })
}

/// How the garment is simulated because no variant knows a cut like this, and none was asked for;
/// none if it is not.
fn simulation_of(
    bound: &Bound,
    knows_cut: bool,
    job: &Job,
    console: &Console,
) -> Option<Simulation> {
    let is_default = matches!(job.network, NetworkChoice::Default) && job.limit.is_none();
    let is_far = !knows_cut && bound.cut.as_ref().is_some_and(|cut| cut.is_far);
    let package = package_of(&job.source).map(GarmentPackage::read_manifest);
    let has_variants = matches!(package, Some(Ok(manifest)) if !manifest.variants.is_empty());
    if !is_default || !is_far || !has_variants || job.settle.is_some() {
        return None;
    }
    console.summary(
        &"note: the variants of the package have learned a cut that is far from this one: it is \
          simulated; `--method accurate` is quicker, and less exact",
    );
    Some(Simulation {
        quality: Quality::Teacher,
        fabric: job.fabric.clone(),
        frames: None,
    })
}

impl Ready {
    /// How drapes come about whose cloth was simulated after the network or the warp, or was not.
    pub(super) fn draped(&self, has_settled: bool) -> Draped {
        Draped {
            is_cut_for_wearer: self.bound.is_made_for_wearer,
            remedy: match &self.method {
                Method::Simulation(_) => Remedy::Nothing,
                Method::Warp if !has_settled => Remedy::Settle,
                Method::Warp | Method::Network(_) => Remedy::Simulate,
            },
        }
    }

    /// Brings a bound garment and what was read for it together.
    pub(super) fn new(
        mut bound: Bound,
        (found, choice): (Found, Option<ChoiceReport>),
        job: &Job,
        console: &Console,
    ) -> anyhow::Result<Self> {
        if let Some(choice) = choice.as_ref().filter(|choice| choice.is_met) {
            console.summary(&format_args!("note: {}", choice.text));
        }
        let options = if job.has_own_clearance {
            job.options
        } else {
            let scale = bound.garment.cloth().scale();
            job.options.with_clearance_scaled(scale)
        };
        let options = match bound.targets.len() {
            1 => options.simulating_strained(),
            // Frames would jump.
            _ => options,
        };
        let mut draper = Draper::new(bound.garment.clone()).with_options(options);
        if let Some(refit) = &bound.refit {
            draper = draper.with_refit(refit.clone());
        }
        let mut method = Method::Warp;
        let mut expected = None;
        let mut simulation = job.simulation.clone();
        match found {
            Found::Network(_) if simulation.is_some() => {}
            Found::Network(network) => {
                let (joined, report, known) = network.joined(draper.clone(), &bound, job.settle)?;
                let is_other = bound.cut.as_ref().is_some_and(|cut| cut.is_unknown);
                let knows_cut = is_of_size(bound.cut.as_deref())
                    && joined.network().is_some_and(|network| network.knows_cut());
                simulation = simulation_of(&bound, knows_cut, job, console);
                if simulation.is_none() {
                    if is_other && !knows_cut {
                        bound.warnings.push(Warning {
                            path: bound.garment_file.path().to_path_buf(),
                            problem: Problem::OtherCut(report.variant.clone()),
                        });
                    }
                    // What is expected is expected of the cut of the package.
                    expected = known.filter(|_| !is_other);
                    (draper, method) = (joined, Method::Network(report));
                }
            }
            Found::NotAsked => {}
            Found::NoneInPackage => console.summary(&note_of_no_variant(job)),
        }
        if let Some(simulation) = &simulation {
            let (simulator, simulated) = Simulated::new(&bound, simulation, &job.source)?;
            draper = draper.with_simulator(simulator);
            method = Method::Simulation(simulated);
        } else if draper.relaxation().takes_time() {
            match simulator_of(&bound, job.fabric.as_ref(), &job.source, true) {
                Ok((simulator, _)) => draper = draper.with_simulator(simulator),
                // A template that was cut and put on can be simulated, on its own body at least.
                Err(error) if package_of(&job.source).is_some() && bound.refit.is_none() => {
                    return Err(error).hint(|| {
                        "the package is damaged: make it anew, or take a copy of it".to_owned()
                    });
                }
                Err(error) => bound.warnings.push(Warning {
                    path: bound.garment_file.path().to_path_buf(),
                    problem: Problem::Unsettled(format!("{error:#}")),
                }),
            }
        }
        if let Some(note) = draper.simulator().and_then(|own| note_of_size(own.size())) {
            console.summary(&note);
        }
        if job.fabric.is_some() && draper.simulator().is_none() {
            console.summary(
                &"note: nothing is simulated, so that `--fabric` changes nothing; `--settle FRAMES` \
                  or `--method sim` simulates",
            );
        }
        Ok(Self {
            fitting: Fitting::new(&bound, &job.source),
            bound,
            draper,
            method,
            choice,
            expected,
        })
    }

    /// How familiar the network is with a pose, from 0 to 1, and how far from the simulation its
    /// drape is expected to be, in metres.
    pub(super) fn expectation(&self, posed: &PosedBody) -> Option<(f64, Option<f64>)> {
        let Expected { poses, of_variant } = self.expected.as_ref()?;
        let far = poses.distance_of(posed, &self.bound.garment)?;
        Some((
            familiarity(far),
            of_variant.map(|expected| expected.at(far)),
        ))
    }

    /// The name of the method in reports.
    pub(super) fn method_name(&self) -> String {
        match &self.method {
            Method::Warp => method_name(self.draper.options().warp).to_owned(),
            Method::Network(network) => network.variant.clone(),
            Method::Simulation(_) => "sim".to_owned(),
        }
    }

    /// The network, if one drapes.
    pub(super) fn network_report(&self) -> Option<NetworkReport> {
        match &self.method {
            Method::Network(network) => Some(network.clone()),
            Method::Warp | Method::Simulation(_) => None,
        }
    }

    /// The simulation, if that is the method.
    pub(super) fn simulation_report(&self) -> Option<SimulationReport> {
        match &self.method {
            Method::Simulation(simulated) => Some(simulated.report()),
            Method::Warp | Method::Network(_) => None,
        }
    }

    /// For how many frames cloth is relaxed.
    pub(super) fn relax_frames(&self) -> u32 {
        match (&self.method, self.draper.simulator()) {
            (Method::Simulation(_), _) | (_, None) => 0,
            (Method::Warp | Method::Network(_), Some(_)) => self.draper.relaxation().frames,
        }
    }
}
