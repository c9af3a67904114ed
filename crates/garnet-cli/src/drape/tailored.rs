//! Garments of packages that are cut before they are draped: for whoever wears them, where variants
//! know them so, and as the user asks for.

use std::{
    collections::BTreeMap,
    ops::RangeInclusive,
    path::{Path, PathBuf},
    sync::Arc,
};

use anyhow::Context;
use garnet::{
    Body,
    body::shape::{Recognized, Tape, recognized, tape_measures, unposed},
    data::{CutOptions, Tailor, wearer_of},
    drape::Refit,
    io::{Target, TargetSource, largest_distance},
    package::GarmentPackage,
    pattern::{GarmentKind, Measures, Parameters, PatternError, Size},
};

use rayon::prelude::*;

use super::{
    all::Part,
    args::{Job, Source, SourceFiles},
    fit::Girths,
    prepared::Prepared,
    report::CutReport,
    timing::timed,
    warning::{Problem, Warning},
};
use crate::{
    cut_args::{CutArgs, SizeChoice, chosen_size, cut_on, in_size, misfit, wearer_of_size},
    failure::refused,
    wearer_rig::wearer_of_rig,
};

/// Bodies whose vertices at rest are as near as this are of one wearer, in metres.
const SAME_WEARER: f32 = 5e-3;

/// Cuts are near to that of the package, whose variants drape them, if their girth is in this range
/// of its own: two sizes to either side. Wider ranges simulate less, and drape less exactly; see
/// docs/experiments/069.
const NEAR_GIRTHS: RangeInclusive<f64> = 0.82..=1.2;

/// And if they are longer or shorter by no more than this, in metres.
const NEAR_LENGTH: f64 = 0.1;

/// Legs of jeans that reach farther below the soles are told, in metres. More tells of fewer.
const LEGS_BELOW: f64 = 0.01;

/// A garment that was cut for a wearer.
#[derive(Debug)]
pub(crate) struct Cut {
    /// The package, with the garment on the wearer at rest.
    pub(super) package: GarmentPackage,
    pub(super) report: CutReport,
    /// Where what was asked for does not fit the wearer.
    pub(super) misfit: Option<String>,
    /// The girths of those who wear it, by the files of their bodies, where they are known.
    pub(super) wearers: BTreeMap<PathBuf, Girths>,
    /// Whether variants have learned another cut.
    pub(super) is_unknown: bool,
    /// Whether that is because of its size alone.
    pub(super) is_size: bool,
    /// Whether that is so far from this one that drapes are simulated.
    pub(super) is_far: bool,
}

/// A package whose garment is cut before it is draped.
#[derive(Debug)]
pub(crate) struct Tailoring {
    folder: PathBuf,
    package: GarmentPackage,
    /// Those of the package, and what the user has changed of them.
    parameters: Parameters,
    cut: CutArgs,
    /// What was cut in a size, on the body of the package.
    made: Vec<(Option<Size>, GarmentPackage)>,
}

/// A size that was chosen for a wearer.
struct Chosen {
    size: Size,
    next: Size,
    text: String,
}

impl Tailoring {
    /// That of a job; none if the garment is draped as it is.
    ///
    /// # Errors
    ///
    /// What the user asks for that cannot be cut.
    pub(super) fn of(source: &Source) -> anyhow::Result<Option<Self>> {
        let Source::Files(files) = source else {
            return Ok(None);
        };
        let SourceFiles { package, cut, .. } = &**files;
        let Some(folder) = package else {
            return match cut.given() {
                None => Ok(None),
                Some(option) => Err(refused(
                    format!("`{option}` is given for a garment that cannot be cut anew"),
                    "it is no garment package, which has a sewing pattern",
                    "name a package, or leave the option out",
                )),
            };
        };
        let manifest = GarmentPackage::read_manifest(folder)?;
        if !manifest.is_made_to_measure() && cut.given().is_none() {
            return Ok(None);
        }
        Self::new(folder, *cut)
    }

    fn new(folder: &Path, cut: CutArgs) -> anyhow::Result<Option<Self>> {
        let package = GarmentPackage::read(folder)?;
        let cannot = || format!("cannot cut the garment of `{}` anew", folder.display());
        let tailor = Tailor::of_package(&package).with_context(cannot)?;
        let Some(tailor) = tailor.filter(|_| tape_measures(&package.body).is_some()) else {
            return match cut.given() {
                None => Ok(None),
                Some(option) => Err(refused(
                    cannot(),
                    "it was not made from a sewing pattern on a body whose measures are known",
                    format!("leave out `{option}`"),
                )),
            };
        };
        let mut parameters = tailor.parameters().clone();
        match cut.set_in(&mut parameters) {
            Err(error @ PatternError::UnknownParameter { .. }) => {
                return Err(refused(
                    cannot(),
                    error.to_string(),
                    "leave the option out; `garnet info` shows how a package is cut",
                ));
            }
            set => set.with_context(cannot)?,
        }
        Ok(Some(Self {
            folder: folder.to_path_buf(),
            package,
            parameters,
            cut,
            made: Vec::new(),
        }))
    }

    /// Whether variants know the garment as it is cut for each wearer.
    pub(super) fn is_to_measure(&self) -> bool {
        self.package.manifest.is_made_to_measure()
    }

    /// Whether the size is chosen by the wearer.
    pub(super) fn is_chosen(&self) -> bool {
        self.cut.size == Some(SizeChoice::Auto)
    }

    /// Whether the user has asked for another cut.
    pub(super) fn is_asked_for(&self) -> bool {
        self.cut.given().is_some()
    }

    fn named(&self) -> Option<Size> {
        match self.cut.size {
            Some(SizeChoice::Named(size)) => Some(size),
            Some(SizeChoice::Auto) | None => None,
        }
    }

    /// The size for a wearer, if it is to be chosen and the measures can be told.
    fn chosen_for(&self, wearer: &Body) -> anyhow::Result<Option<Chosen>> {
        if !self.is_chosen() {
            return Ok(None);
        }
        let Some(wearer) = wearer_of(wearer).transpose()? else {
            return Ok(None);
        };
        let chosen = chosen_size(&self.parameters, &wearer.measures);
        Ok(chosen.map(|([size, next], text)| Chosen { size, next, text }))
    }

    /// The garment in a size, on a body.
    fn cut_on(&self, body: Body, size: Option<Size>) -> anyhow::Result<(GarmentPackage, f64)> {
        let options = CutOptions {
            size,
            parameters: Some(self.parameters.clone()),
        };
        let (cut, seconds) = timed(|| cut_on(&self.package, body, &options));
        Ok((cut?, seconds))
    }

    /// The garment on the body that it is cut for, in the size for `wearer` if it is chosen by
    /// that; cut to measure, on `wearer`.
    pub(super) fn cut_for(&mut self, wearer: Option<&Body>, target: &Path) -> anyhow::Result<Cut> {
        let chosen = wearer.map(|wearer| self.chosen_for(wearer)).transpose()?;
        let chosen = chosen.flatten();
        let size = chosen.as_ref().map(|chosen| chosen.size).or(self.named());
        let made = self.made.iter().find(|(other, ..)| *other == size);
        let to_measure = wearer.filter(|_| self.is_to_measure() && size.is_none());
        let (package, seconds) = if let Some(wearer) = to_measure {
            self.cut_on(wearer.clone(), None)?
        } else if let Some((_, package)) = made {
            (package.clone(), 0.0)
        } else {
            let (package, seconds) = self.cut_on_own(size)?;
            self.made.push((size, package.clone()));
            (package, seconds)
        };
        let is_chosen = chosen.is_some();
        let report = self.report(target, wearer, (size, chosen), seconds);
        let misfit = wearer.and_then(|wearer| self.misfit(size, wearer, is_chosen));
        Ok(self.cut(package, report, size, misfit))
    }

    /// The garment on `wearer`, in a size or to measure; none if the wearer has no measures.
    fn cut_to(&self, wearer: Body, target: &Path) -> anyhow::Result<Option<Cut>> {
        if tape_measures(&wearer).is_none() {
            return Ok(None);
        }
        let chosen = self.chosen_for(&wearer)?;
        let size = chosen.as_ref().map(|chosen| chosen.size).or(self.named());
        let (package, seconds) = self.cut_on(wearer, size)?;
        let is_chosen = chosen.is_some();
        let report = self.report(target, Some(&package.body), (size, chosen), seconds);
        let misfit = self.misfit(size, &package.body, is_chosen);
        Ok(Some(self.cut(package, report, size, misfit)))
    }

    /// What was cut, and where it does not fit its wearer.
    fn cut(
        &self,
        package: GarmentPackage,
        report: CutReport,
        size: Option<Size>,
        misfit: Option<String>,
    ) -> Cut {
        let is_other = size.is_some() || !self.changed().is_empty();
        Cut {
            package,
            report,
            misfit,
            wearers: BTreeMap::new(),
            is_unknown: is_other,
            is_size: size.is_some() && self.changed().is_empty() && !self.is_to_measure(),
            is_far: is_other && self.is_far(size),
        }
    }

    /// Where what was asked for does not fit a wearer; of a size that was chosen for the wearer,
    /// the choice has told of its girths.
    fn misfit(&self, size: Option<Size>, wearer: &Body, is_chosen: bool) -> Option<String> {
        let measured = |body: &Body| Some(wearer_of(body)?.ok()?.measures);
        let wearer = measured(wearer).filter(|_| self.is_asked_for())?;
        let cut_to = if self.is_to_measure() {
            wearer
        } else {
            measured(&self.package.body)?
        };
        let girths = misfit(&self.parameters, (size, &cut_to), &wearer);
        let girths = girths.filter(|_| !is_chosen);
        let cut_to = size.map_or(cut_to, Size::measures);
        let longer = self.parameters.legs_below_soles(&cut_to, &wearer);
        let legs = longer.filter(|longer| *longer > LEGS_BELOW).map(|longer| {
            let centimetres = 100.0 * longer;
            format!(
                "its legs reach {centimetres:.0} cm below the soles of the body: there is no floor"
            )
        });
        match (girths, legs) {
            (Some(girths), Some(legs)) => Some(format!("{girths}; {legs}")),
            (girths, legs) => girths.or(legs),
        }
    }

    /// Whether a cut is wider, narrower, longer or shorter than that of the package by more than
    /// its variants are asked to know.
    fn is_far(&self, size: Option<Size>) -> bool {
        let own = Tailor::of_package(&self.package).ok().flatten();
        let wearer = wearer_of(&self.package.body).and_then(Result::ok);
        let Some((own, wearer)) = own.zip(wearer) else {
            return true;
        };
        let value = |parameters: &Parameters, name| parameters.get(name).unwrap_or(0.0);
        let girth = |parameters: &Parameters, body: &Measures| match parameters.garment() {
            GarmentKind::Jeans => body.hip * (1.0 + value(parameters, "hip-ease")),
            _ => body.chest * (1.0 + value(parameters, "chest-ease")),
        };
        let cut = size.map_or(wearer.measures, Size::measures);
        let is_to_measure = self.is_to_measure() && size.is_none();
        let wider = girth(&self.parameters, &cut) / girth(own.parameters(), &wearer.measures);
        let longer = ["length", "sleeve", "inseam"]
            .map(|name| value(&self.parameters, name) - value(own.parameters(), name));
        (!is_to_measure && !NEAR_GIRTHS.contains(&wider))
            || longer.into_iter().any(|longer| longer.abs() > NEAR_LENGTH)
    }

    /// The garment in a size on the body that this is for, as it is stored in the package, or cut;
    /// or, cut to measure, on the body of the package.
    fn cut_on_own(&self, size: Option<Size>) -> anyhow::Result<(GarmentPackage, f64)> {
        if let Some(size) = size.filter(|_| self.changed().is_empty()) {
            let (cut, seconds) = timed(|| in_size(&self.package, &self.folder, size));
            return Ok((cut?, seconds));
        }
        let of_size = size.map(|size| wearer_of_size(&self.package, size));
        let body = of_size.unwrap_or_else(|| self.package.body.clone());
        self.cut_on(body, size)
    }

    fn report(
        &self,
        target: &Path,
        wearer: Option<&Body>,
        (size, chosen): (Option<Size>, Option<Chosen>),
        seconds: f64,
    ) -> CutReport {
        let next = chosen.as_ref().map(|chosen| chosen.next.to_string());
        CutReport {
            size: size.map(|size| size.to_string()),
            second_size: next,
            choice: chosen.map(|chosen| chosen.text),
            parameters: self.changed().into_iter().collect(),
            ..CutReport::new(target, wearer.and_then(tape_measures).as_ref(), seconds)
        }
    }

    /// Name and value of the parameters that the user has changed.
    fn changed(&self) -> Vec<(&'static str, f64)> {
        let own = Tailor::of_package(&self.package).ok().flatten();
        let pairs = self.parameters.iter().filter(|parameter| {
            let own = own
                .as_ref()
                .map(|tailor| tailor.parameters().get(parameter.spec.name));
            !matches!(own, Some(Ok(value)) if (value - parameter.value).abs() < 1e-9)
        });
        pairs
            .map(|parameter| (parameter.spec.name, parameter.value))
            .collect()
    }
}

/// Who stands in for a body of another topology at rest, as the built-in body at rest.
pub(super) fn stand_in_at_rest(refit: &Refit, other: &Body) -> anyhow::Result<Body> {
    let stand_in = refit.stand_in(other.rest().positions())?;
    let at_rest = unposed(refit.own(), stand_in.skin().positions())?;
    Ok(at_rest.unwrap_or_else(|| refit.own().clone()))
}

/// What is draped together: all targets, or those of one wearer each, of garments that are cut for
/// each wearer.
pub(super) fn by_wearer(
    mut prepared: Prepared,
    part: Part,
    job: &Job,
) -> anyhow::Result<Vec<(Prepared, Part)>> {
    let Some(mut tailoring) = prepared.tailoring.take() else {
        return Ok(vec![(prepared, part)]);
    };
    if prepared.refit.is_some() {
        let reason = "the measures of bodies of this topology are not known";
        prepared.warn_of_cut(reason.to_owned());
        return Ok(vec![(prepared, part)]);
    }
    if !tailoring.is_to_measure() && !tailoring.is_chosen() {
        prepared.dress_all(&mut tailoring)?;
        return Ok(vec![(prepared, part)]);
    }
    let wearers = prepared.wearers()?;
    let starts: Vec<usize> = (0..wearers.len())
        .filter(|&at| at == 0 || !wearers[at].is_like(&wearers[at - 1]))
        .collect();
    if starts.len() > 1 && (job.cache.is_some() || job.body_cache.is_some() || job.hide.is_some()) {
        return Err(refused(
            "bodies of several shapes do not go into one file",
            "the garment is cut for each of them",
            "drape each shape apart, or into a folder of OBJ",
        ));
    }
    let mut wearers = wearers.into_iter();
    let mut groups = Vec::new();
    let ends = starts.iter().skip(1).copied().chain([usize::MAX]);
    let mut left = prepared;
    let (warm_up, after, mut outputs) = (part.warm_up, part.after, part.outputs);
    let mut first = 0;
    for end in ends {
        let count = (end - first).min(left.targets.len());
        let rest = left.split_off(count);
        let other = outputs.split_off(count.min(outputs.len()));
        let own = std::mem::replace(&mut outputs, other);
        let mut group = std::mem::replace(&mut left, rest);
        let wearer = wearers.next();
        wearers
            .by_ref()
            .take(count.saturating_sub(1))
            .for_each(drop);
        if let Some(wearer) = wearer {
            group.dress(wearer, &mut tailoring)?;
        }
        let part = Part {
            warm_up: if first == 0 { warm_up } else { 0 },
            after: if end == usize::MAX { after } else { 0 },
            outputs: own,
        };
        groups.push((group, part));
        first = end;
    }
    Ok(groups)
}

const NOWHERE: TargetSource = TargetSource::Vertices(Vec::new());

/// Who wears the garment.
enum Wearer {
    /// The body that the scene has at rest.
    Own,
    /// One of another shape, at rest.
    Other(Box<Body>),
    /// The same, told from the skin in a pose: some centimetres off in girths.
    Told(Box<Body>),
    /// One whose measures cannot be told.
    Unknown,
}

impl Wearer {
    fn of(target: &Target, body: &Body) -> anyhow::Result<Self> {
        let (TargetSource::Vertices(places) | TargetSource::Transforms(places, _)) = &target.source
        else {
            return Ok(Self::Own);
        };
        let cannot = || format!("cannot fit the body to `{}`", target.path.display());
        if let Some(wearer) = wearer_of_rig(&target.path, places) {
            let is_own = largest_distance(wearer.rest().positions(), body.rest().positions());
            return Ok(if is_own < SAME_WEARER {
                Self::Own
            } else {
                Self::Other(Box::new(wearer))
            });
        }
        if let Some(other) = unposed(body, places).with_context(cannot)? {
            let rest = body.rest().with_positions(places.clone())?;
            return Ok(match recognized(&rest) {
                Recognized::Posed => Self::Told(Box::new(other)),
                Recognized::Rest(_) | Recognized::Stranger => Self::Other(Box::new(other)),
            });
        }
        let has_other_shape = target.posed(body)?.shape_offsets().is_some();
        Ok(if has_other_shape {
            Self::Unknown
        } else {
            Self::Own
        })
    }

    fn is_told(&self) -> bool {
        matches!(self, Self::Told(_))
    }

    fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Own, Self::Own) => true,
            (Self::Other(a) | Self::Told(a), Self::Other(b) | Self::Told(b)) => {
                largest_distance(a.rest().positions(), b.rest().positions()) < SAME_WEARER
            }
            _ => false,
        }
    }
}

impl Prepared {
    /// Warns that the garment is not cut for its wearer.
    fn warn_of_cut(&mut self, reason: String) {
        self.warnings.push(Warning {
            path: self.garment_file.path().to_path_buf(),
            problem: Problem::NotCut(reason),
        });
    }

    /// Warns where what was asked for does not fit who wears it.
    pub(super) fn warn_of_misfit(&mut self, misfit: Option<String>, wearer: &Path) {
        self.warnings.extend(misfit.map(|text| Warning {
            path: wearer.to_path_buf(),
            problem: Problem::Misfit(text),
        }));
    }

    /// Who stands in each target.
    fn wearers(&self) -> anyhow::Result<Vec<Wearer>> {
        let targets = self.targets.par_iter();
        let wearers: Vec<anyhow::Result<Wearer>> = targets
            .map(|target| Wearer::of(target, &self.body))
            .collect();
        wearers.into_iter().collect()
    }

    /// The body of a wearer; none whose measures cannot be told.
    fn body_of<'a>(&'a self, wearer: &'a Wearer) -> Option<&'a Body> {
        match wearer {
            Wearer::Own => Some(&self.body),
            Wearer::Other(body) | Wearer::Told(body) => Some(body),
            Wearer::Unknown => None,
        }
    }

    /// The file of who wears the garment in a target.
    fn path_of(&self, wearer: &Wearer, target: &Target) -> PathBuf {
        match wearer {
            // The target is a pose of it.
            Wearer::Own => self.rest.path.clone(),
            Wearer::Other(_) | Wearer::Told(_) | Wearer::Unknown => target.path.clone(),
        }
    }

    /// Cuts the garment once for all targets, of whatever shape they are.
    fn dress_all(&mut self, tailoring: &mut Tailoring) -> anyhow::Result<()> {
        let wearers = self.wearers()?;
        let mut tapes: BTreeMap<PathBuf, Girths> = BTreeMap::new();
        let mut misfits = Vec::new();
        let mut before: Option<(&Wearer, Option<Arc<Tape>>)> = None;
        for (at, (wearer, target)) in wearers.iter().zip(&self.targets).enumerate() {
            let Some(body) = self.body_of(wearer) else {
                continue;
            };
            let same = before.as_ref().filter(|(last, _)| last.is_like(wearer));
            let tape = if let Some((_, tape)) = same {
                tape.clone()
            } else {
                if at > 0 {
                    let misfit = tailoring.misfit(tailoring.named(), body, false);
                    misfits.push((misfit, self.path_of(wearer, target)));
                }
                Tape::around(body).map(Arc::new)
            };
            let is_told = wearer.is_told();
            let girths = tape.clone().map(|tape| Girths { tape, is_told });
            tapes.extend(girths.map(|girths| (target.path.clone(), girths)));
            before = Some((wearer, tape));
        }
        for (misfit, path) in misfits {
            self.warn_of_misfit(misfit, &path);
        }
        if let Some(first) = wearers.into_iter().next() {
            self.dress(first, tailoring)?;
        }
        if let Some(cut) = self.cut.as_mut().and_then(Arc::get_mut) {
            cut.wearers = tapes;
        }
        Ok(())
    }

    /// Cuts the garment for a wearer of all targets.
    fn dress(&mut self, wearer: Wearer, tailoring: &mut Tailoring) -> anyhow::Result<()> {
        let worn_by = (self.targets.first()).map(|target| self.path_of(&wearer, target));
        let is_told = wearer.is_told();
        let wearer = match wearer {
            Wearer::Unknown if tailoring.is_asked_for() && !tailoring.is_chosen() => None,
            Wearer::Unknown => {
                self.warn_of_cut("the shape of the body is none that has measures".to_owned());
                return Ok(());
            }
            // It lies there already.
            Wearer::Own if !self.is_on_other && !tailoring.is_asked_for() => {
                self.is_made_for_wearer = true;
                return Ok(());
            }
            Wearer::Own => Some(self.body.clone()),
            Wearer::Other(body) | Wearer::Told(body) => Some(*body),
        };
        let Some(target) = self.targets.first() else {
            return Ok(());
        };
        let path = worn_by.clone().unwrap_or_else(|| target.path.clone());
        let cannot = || {
            let garment = self.garment_file.path().display();
            format!("cannot cut `{garment}` for `{}`", path.display())
        };
        let tape = wearer.as_ref().and_then(Tape::around).map(Arc::new);
        let mut cut = if tailoring.is_to_measure() {
            let wearer = wearer.unwrap_or_else(|| self.body.clone());
            let Some(cut) = tailoring.cut_to(wearer, &path).with_context(cannot)? else {
                return Ok(());
            };
            cut
        } else {
            let cut = tailoring.cut_for(wearer.as_ref(), &path);
            cut.with_context(cannot)?
        };
        cut.report.is_told = is_told;
        let paths = self.targets.iter().map(|target| target.path.clone());
        let girths = tape.map(|tape| Girths { tape, is_told });
        let worn = paths.filter_map(|path| Some((path, girths.clone()?)));
        cut.wearers = worn.collect();
        self.warn_of_misfit(cut.misfit.clone(), &worn_by.unwrap_or_default());
        self.put_on(cut)
    }

    /// Takes a garment that was cut, and the body that it lies on.
    fn put_on(&mut self, cut: Cut) -> anyhow::Result<()> {
        self.garment = cut.package.mesh.clone();
        let before = std::mem::replace(&mut self.body, cut.package.body.clone());
        let apart = largest_distance(before.rest().positions(), self.body.rest().positions());
        let is_same = apart < SAME_WEARER;
        for target in &mut self.targets {
            target.source = match std::mem::replace(&mut target.source, NOWHERE) {
                // How the joints of the other body moved says nothing of those of this one.
                TargetSource::Transforms(places, _) => TargetSource::Vertices(places),
                pose @ (TargetSource::Pose(_) | TargetSource::PoseOfRig(..)) if !is_same => {
                    target.source = pose;
                    let posed = target.posed(&before)?;
                    TargetSource::Vertices(posed.skin().positions().to_vec())
                }
                other => other,
            };
        }
        self.is_made_for_wearer = cut.report.size.is_none() && cut.report.parameters.is_empty();
        self.cut = Some(Arc::new(cut));
        Ok(())
    }
}
