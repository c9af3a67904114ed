//! Pose-space deformations in regions: a small network tells each.
//!
//! A sleeve lies as its own arm and the trunk lie, whatever the other arm does: what counts is
//! found for each region apart, by Gaussian processes that leave bodies and sequences out, and the
//! network of the region is told as much of each feature. Where left and right are alike there are
//! regions of the left alone, and each scene counts as its mirror image, too.

mod distil;
mod layout;
mod network;
mod samples;
mod search;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

use faer::Mat;
use garnet_net::pose_space::{
    Aspect, Cut, Feature, Features, Region, RegionMirror, Regions, predicted,
};
use rayon::prelude::*;

use super::folds::Fold;
use super::mirror::GarmentMirror;
use super::principal::principal_of;
use super::scenes::evenly;
use super::{PoseSpaceConfig, TrainEvent};
use crate::{Stage, TrainError};
pub(super) use network::HIDDEN_LAYERS;
pub(super) use samples::{Sample, samples_of};
use search::Search;

/// Vertices that count less than this in a region are not of it.
const LEAST_SHARE: f32 = 0.04;

/// Principal shapes that the search looks at.
const SEARCHED_SHAPES: usize = 48;

/// Numbers that networks are told are as many times those by which Gaussian processes tell scenes
/// apart: first layers begin with random weights, and few of them are steep.
const GAIN: f64 = 20.0;

/// All that is the same for all regions.
struct Ground<'a> {
    samples: &'a [Sample],
    features: Features,
    owners: Vec<usize>,
    center: Vec<f32>,
    /// The numbers of the features of each sample, then of its mirror image.
    numbers: Vec<Vec<f32>>,
    /// The offsets from the mean of each sample, then of its mirror image `[3 vertex]`.
    offsets: Vec<Vec<f32>>,
    /// Samples by which relevance is found.
    searched: Vec<usize>,
}

/// What a fit comes to.
pub(super) struct Fitted {
    pub(super) regions: Regions,
    /// The share of each shape, in metres, as fits tell it that have not seen the sample
    /// `[sample][shape]`: of all regions, and with a mirror of their images. Zeros for samples that
    /// no fold is for.
    pub(super) left_out: Vec<Vec<f32>>,
}

/// Fits the regions of a garment, and once more for each fold.
///
/// Folds keep shapes, relevance and mean, which are of all samples: it is the networks that know
/// drapes by heart.
pub(super) fn fitted(
    asked: &PoseSpaceConfig,
    seed: u64,
    stage: &Stage,
    samples: &[Sample],
    folds: &[Fold],
    observer: &mut dyn FnMut(TrainEvent),
    stop: &AtomicBool,
) -> Result<Fitted, TrainError> {
    let mirror = asked.mirror.then(|| GarmentMirror::of(stage)).flatten();
    let cuts = if asked.cuts { cuts_of(samples) } else { None };
    let layout = layout::Layout::of(stage, mirror.is_some(), cuts);
    let mut ground = Ground::new(layout.features, samples, mirror.as_ref(), asked)?;
    let mean = ground.centered();
    let of = layout.shares.len() as u32;
    let passes = distil::passes(asked) + asked.passes * folds.len() as u32;
    let (teller, told) = mpsc::channel();
    let regions = std::thread::scope(|scope| {
        let work = || {
            let shares = layout.shares.par_iter().enumerate();
            let regions = shares.map_with(teller, |teller, (number, share)| {
                let region = number as u32;
                let tell = &mut |told: Told| {
                    // Nobody listens any more only after a panic.
                    teller.send((region, told)).is_ok() && !stop.load(Ordering::Relaxed)
                };
                let seed = seed.wrapping_add(u64::from(region));
                ground.region(asked, share, seed, folds, tell)
            });
            regions.collect::<Vec<(Region, Vec<Vec<f32>>)>>()
        };
        let worker = scope.spawn(work);
        for (region, told) in told {
            observer(told.event([asked.rounds, passes], region, of));
        }
        worker.join()
    });
    if stop.load(Ordering::Relaxed) {
        return Err(TrainError::Stopped);
    }
    let regions = regions.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    let Ground {
        features, center, ..
    } = ground;
    // The images of all regions follow after all regions.
    let sides = 1 + usize::from(mirror.is_some());
    let of_sample = |sample: usize| -> Vec<f32> {
        let sides = (0..sides).map(|side| side * samples.len() + sample);
        let rows = sides.flat_map(|row| regions.iter().map(move |(_, told)| &told[row]));
        rows.flatten().copied().collect()
    };
    let left_out = if folds.is_empty() {
        Vec::new()
    } else {
        (0..samples.len()).map(of_sample).collect()
    };
    let regions = Regions {
        features,
        center,
        mean,
        regions: regions.into_iter().map(|(region, _)| region).collect(),
        mirror: mirror.map(|mirror| RegionMirror {
            numbers: mirror.numbers().clone(),
            images: mirror.images().to_vec(),
        }),
    };
    Ok(Fitted { regions, left_out })
}

/// How far a region is.
enum Told {
    /// A round of the search, and the error of what was left out, in metres.
    Searched(u32, f64),
    /// A pass of the training, and what was missed over the standard deviation.
    Learned(u32, f64),
}

impl Told {
    fn event(self, [rounds, passes]: [u32; 2], region: u32, regions: u32) -> TrainEvent {
        match self {
            Self::Searched(round, left_out) => TrainEvent::RegionSearched {
                region,
                regions,
                round,
                rounds,
                left_out,
            },
            Self::Learned(pass, loss) => TrainEvent::RegionLearned {
                region,
                regions,
                pass,
                passes,
                loss,
            },
        }
    }
}

impl<'a> Ground<'a> {
    fn new(
        features: Features,
        samples: &'a [Sample],
        mirror: Option<&GarmentMirror>,
        asked: &PoseSpaceConfig,
    ) -> Result<Self, TrainError> {
        let mut told: Vec<(Vec<f32>, Cut)> = samples
            .iter()
            .map(|s| (s.parameters.clone(), s.cut))
            .collect();
        let mut offsets: Vec<Vec<f32>> = samples.iter().map(|s| s.offsets.clone()).collect();
        if let Some(mirror) = mirror {
            let images = samples.iter();
            told.extend(images.map(|s| (mirror.numbers().of(&s.parameters), s.cut)));
            let images = samples.par_iter().map(|s| mirror.offsets(&s.offsets));
            offsets.par_extend(images);
        }
        let numbers = told
            .par_iter()
            .map(|(numbers, cut)| features.of(numbers, cut));
        let numbers: Vec<Vec<f32>> = numbers.collect::<Result<_, _>>()?;
        Ok(Self {
            samples,
            owners: features.owners(),
            center: mean_of(&numbers),
            features,
            numbers,
            offsets,
            searched: evenly(samples, asked.region_searched as usize),
        })
    }

    /// Takes the mean from the offsets.
    fn centered(&mut self) -> Vec<f32> {
        let mean = mean_of(&self.offsets);
        self.offsets.par_iter_mut().for_each(|offsets| {
            for (offset, mean) in offsets.iter_mut().zip(&mean) {
                *offset -= mean;
            }
        });
        mean
    }

    fn region(
        &self,
        asked: &PoseSpaceConfig,
        share: &[f32],
        seed: u64,
        folds: &[Fold],
        tell: &mut dyn FnMut(Told) -> bool,
    ) -> (Region, Vec<Vec<f32>>) {
        let vertices: Vec<u32> = (0..share.len() as u32)
            .filter(|&vertex| share[vertex as usize] > LEAST_SHARE)
            .collect();
        // Squares of the sum over a garment are the sum over its regions, if each vertex counts by
        // its share.
        let roots: Vec<f32> = vertices.iter().map(|&v| share[v as usize].sqrt()).collect();
        let weighted = Mat::<f32>::from_fn(3 * vertices.len(), self.offsets.len(), |row, scene| {
            roots[row / 3] * self.offsets[scene][3 * vertices[row / 3] as usize + row % 3]
        });
        let found = principal_of(&weighted, asked.region_shapes as usize);
        drop(weighted);
        let area: f32 = roots.iter().map(|root| root * root).sum();
        let metres = 1.0 / f64::from(area).sqrt();
        let relevance = Search {
            features: &self.features,
            owners: &self.owners,
            samples: self.samples,
            searched: &self.searched,
            numbers: &self.numbers,
        }
        .found(
            &found.shares,
            SEARCHED_SHAPES,
            asked.rounds,
            &mut |round, error| tell(Told::Searched(round, metres * error)),
        );
        let scales: Vec<f32> = relevance
            .iter()
            .map(|&relevance| (GAIN * relevance) as f32)
            .collect();
        let mut region = Region {
            vertices,
            scales,
            shapes: found.shapes,
            layers: Vec::new(),
        };
        let inputs: Vec<Vec<f32>> = (self.numbers.iter())
            .map(|numbers| region.inputs(&self.owners, &self.center, numbers))
            .collect();
        let of_all = network::Fit {
            inputs: &inputs,
            shares: &found.shares,
            scenes: &(0..inputs.len()).collect::<Vec<usize>>(),
            hidden: asked.hidden as usize,
            passes: asked.passes,
            seed,
        };
        region.layers = distil::learned(&of_all, asked, &mut |pass, loss| {
            tell(Told::Learned(pass, loss))
        });
        let count = self.samples.len();
        let mut left_out = vec![vec![0.0; found.shares.ncols()]; inputs.len()];
        for (number, fold) in (1..).zip(folds) {
            let with_images = |samples: &[usize]| -> Vec<usize> {
                let images = (0..inputs.len()).step_by(count.max(1));
                let rows = images.flat_map(|first| samples.iter().map(move |row| first + row));
                rows.collect()
            };
            // Of what nothing is known nothing is told but the mean.
            if fold.learned.is_empty() {
                continue;
            }
            let fit = network::Fit {
                scenes: &with_images(&fold.learned),
                seed: seed.wrapping_add(u64::from(number) << 32),
                ..of_all
            };
            let before = distil::passes(asked) + (number - 1) * asked.passes;
            let layers = fit.learned(&mut |pass, loss| tell(Told::Learned(before + pass, loss)));
            for row in with_images(&fold.told) {
                left_out[row] = predicted(&layers, inputs[row].clone());
            }
        }
        // A vertex is moved by as much as it counts.
        let rows = 3 * roots.len();
        for (place, number) in region.shapes.iter_mut().enumerate() {
            *number *= roots[place % rows / 3];
        }
        (region, left_out)
    }
}

/// The least and the greatest numbers of the cuts of samples.
fn cuts_of(samples: &[Sample]) -> Option<[Cut; 2]> {
    let mut cuts = samples.iter().map(|sample| sample.cut);
    let first = cuts.next()?;
    Some(cuts.fold([first, first], |[mut low, mut high], cut| {
        for ((low, high), number) in low.iter_mut().zip(&mut high).zip(cut) {
            *low = low.min(number);
            *high = high.max(number);
        }
        [low, high]
    }))
}

/// The mean of rows of the same length.
fn mean_of(rows: &[Vec<f32>]) -> Vec<f32> {
    let mut sums = vec![0.0_f64; rows.first().map_or(0, Vec::len)];
    for row in rows {
        for (sum, number) in sums.iter_mut().zip(row) {
            *sum += f64::from(*number);
        }
    }
    let count = rows.len().max(1) as f64;
    sums.iter().map(|sum| (sum / count) as f32).collect()
}

/// Whether a feature tells a rotation.
fn is_turn(feature: Feature) -> bool {
    !matches!(feature.aspect, Aspect::Shape | Aspect::Cut)
}
