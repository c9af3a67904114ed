//! Garments that are cut for whoever wears them: those of packages whose variants know them so.

use std::sync::{Arc, atomic::AtomicBool};

use anyhow::Context;
use garnet::{
    Body, Point3,
    body::shape::{tape_measures, unposed},
    data::recut,
    io::{Target, TargetSource},
    package::GarmentPackage,
};

use super::{
    all::Part,
    args::{Job, Source},
    prepared::Prepared,
    ready::package_of,
    report::CutReport,
    timing::timed,
    warning::{Problem, Warning},
};
use crate::failure::refused;

/// Bodies whose vertices at rest are as near as this are of one wearer, in metres.
const SAME_WEARER: f32 = 5e-3;

/// A garment that was cut for a wearer.
#[derive(Debug)]
pub(crate) struct Cut {
    /// The package, with the garment on the wearer at rest.
    pub(super) package: GarmentPackage,
    pub(super) report: CutReport,
}

/// The package of a job whose garment is cut for each wearer.
pub(super) fn tailored_package(source: &Source) -> anyhow::Result<Option<GarmentPackage>> {
    let Some(folder) = package_of(source) else {
        return Ok(None);
    };
    let manifest = GarmentPackage::read_manifest(folder)?;
    if !manifest.is_made_to_measure() {
        return Ok(None);
    }
    Ok(Some(GarmentPackage::read(folder)?))
}

/// What is draped together: all targets, or those of one wearer each, of garments that are cut for
/// each wearer.
pub(super) fn by_wearer(
    mut prepared: Prepared,
    part: Part,
    job: &Job,
) -> anyhow::Result<Vec<(Prepared, Part)>> {
    let Some(package) = prepared.tailored.take() else {
        return Ok(vec![(prepared, part)]);
    };
    if prepared.refit.is_some() {
        let reason = "the measures of bodies of this topology are not known";
        prepared.warn_of_cut(reason.to_owned());
        return Ok(vec![(prepared, part)]);
    }
    let wearers = prepared.targets.iter();
    let wearers: Vec<Wearer> = wearers
        .map(|target| Wearer::of(target, &prepared.body))
        .collect::<anyhow::Result<_>>()?;
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
            group.dress(wearer, &package)?;
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

/// Who wears the garment.
enum Wearer {
    /// The body that the scene has at rest.
    Own,
    /// One of another shape, at rest.
    Other(Box<Body>),
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
        if let Some(other) = unposed(body, places).with_context(cannot)? {
            return Ok(Self::Other(Box::new(other)));
        }
        let has_other_shape = target.posed(body)?.shape_offsets().is_some();
        Ok(if has_other_shape {
            Self::Unknown
        } else {
            Self::Own
        })
    }

    fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Own, Self::Own) => true,
            (Self::Other(a), Self::Other(b)) => {
                let pairs = a.rest().positions().iter().zip(b.rest().positions());
                pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f32::max) < SAME_WEARER
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

    /// Cuts the garment for a wearer of all targets.
    fn dress(&mut self, wearer: Wearer, package: &GarmentPackage) -> anyhow::Result<()> {
        let wearer = match wearer {
            Wearer::Unknown => {
                self.warn_of_cut("the shape of the body is none that has measures".to_owned());
                return Ok(());
            }
            // It lies there already.
            Wearer::Own if !self.is_on_other => return Ok(()),
            Wearer::Own => self.body.clone(),
            Wearer::Other(body) => *body,
        };
        let (Some(target), Some(measures)) = (self.targets.first(), tape_measures(&wearer)) else {
            return Ok(());
        };
        let stop = AtomicBool::new(false);
        let (cut, seconds) = timed(|| recut(package, wearer, &stop));
        let cannot = || {
            let garment = self.garment_file.path().display();
            format!("cannot cut `{garment}` for `{}`", target.path.display())
        };
        let Some(cut) = cut.with_context(cannot)? else {
            return Ok(());
        };
        let report = CutReport::new(target, &measures, seconds);
        self.garment = cut.mesh.clone();
        self.body = cut.body.clone();
        for target in &mut self.targets {
            // How the joints of the other body moved says nothing of those of this one.
            if let TargetSource::Transforms(places, _) = &mut target.source {
                let places: Vec<Point3> = std::mem::take(places);
                target.source = TargetSource::Vertices(places);
            }
        }
        self.cut = Some(Arc::new(Cut {
            package: cut,
            report,
        }));
        Ok(())
    }
}
