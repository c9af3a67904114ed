//! How much each joint tells of a drape.

use faer::Mat;
use garnet_skin::{Body, Skeleton};

use super::mirror::GarmentMirror;
use super::principal::Principal;
use super::regression::{Places, Regression};
use super::scenes::left_out_with;
use crate::context::Example;

/// Numbers of a rotation are multiplied by this before the search: a quarter turn is a tenth of the
/// distance at which scenes have nothing to do with each other.
pub(super) const TURN: f64 = 0.07;

/// And offsets of the skin, in metres.
pub(super) const GROWTH: f64 = 1.4;

/// The ridge before the search.
pub(super) const RIDGE: f64 = 2e-3;

/// The logarithm of the first steps of the search, and how they shrink from round to round.
pub(super) const STEP: f64 = 0.7;
pub(super) const SHRINKING: f64 = 0.75;

/// Numbers of a joint that tell its rotation; the others tell the shape of its skin.
const NUMBERS_OF_TURN: usize = 6;

/// Groups without which the error is no larger than this times the least are left out in the end.
const TOLERANCE: f64 = 1.001;

/// Principal shapes that the search looks at.
const SHAPES: usize = 48;

/// Numbers that vary less than this over all scenes are left out.
pub(super) const LEAST_SPREAD: f32 = 1e-5;

/// What numbers of pose and shape are multiplied by, before distances between scenes are taken.
pub(super) struct Relevance {
    /// The group of each number: rotation or shape of a joint and of its partner on the other side.
    groups: Vec<usize>,
    /// Logarithms of the factors of the groups, of all numbers alike, and of the ridge.
    factors: Vec<f64>,
}

impl Relevance {
    pub(super) fn new(skeleton: &Skeleton) -> Self {
        let symmetry = skeleton.symmetry();
        let mut firsts: Vec<usize> = Vec::new();
        let mut groups = Vec::new();
        for joint in 0..skeleton.num_joints() {
            let partner = (symmetry.as_ref()).map_or(joint, |symmetry| symmetry.joints[joint]);
            let first = joint.min(partner);
            let known = firsts.iter().position(|known| *known == first);
            let place = known.unwrap_or_else(|| {
                firsts.push(first);
                firsts.len() - 1
            });
            let numbers = 0..Body::NUMBERS_A_JOINT;
            groups.extend(numbers.map(|number| 2 * place + usize::from(number >= NUMBERS_OF_TURN)));
        }
        let mut factors = vec![0.0; 2 * firsts.len() + 2];
        factors[2 * firsts.len() + 1] = RIDGE.ln();
        Self { groups, factors }
    }

    /// Added to the diagonal of the covariances.
    pub(super) fn ridge(&self) -> f64 {
        self.factors[self.factors.len() - 1].exp()
    }

    /// What each number is multiplied by; zero where it never changes, on both sides if there is a
    /// mirror.
    pub(super) fn scales(&self, examples: &[&Example], mirror: Option<&GarmentMirror>) -> Vec<f32> {
        let all = self.factors[self.factors.len() - 2];
        let scale = |number: usize, group: usize| {
            let values = || examples.iter().map(|example| example.parameters[number]);
            let low = values().fold(f32::INFINITY, f32::min);
            let high = values().fold(f32::NEG_INFINITY, f32::max);
            if high - low < LEAST_SPREAD || self.factors[group] == f64::NEG_INFINITY {
                return 0.0;
            }
            let unit = if group.is_multiple_of(2) {
                TURN
            } else {
                GROWTH
            };
            (unit * (self.factors[group] + all).exp()) as f32
        };
        let groups = self.groups.iter().enumerate();
        let mut scales: Vec<f32> = groups
            .map(|(number, &group)| scale(number, group))
            .collect();
        if let Some(mirror) = mirror {
            mirror.even_out(&mut scales);
        }
        scales
    }

    /// Finds the factors by which bodies and sequences that are left out are missed least, one
    /// factor after the other, and leaves out what makes no difference.
    ///
    /// `searched` are some of the scenes `all` of which the principal shapes are. `go_on` is told
    /// the rounds that are done and the error, the root of the mean square over the vertices, in
    /// metres.
    pub(super) fn search(
        &mut self,
        searched: &[&Example],
        all: &[&Example],
        principal: &Principal,
        mirror: Option<&GarmentMirror>,
        go_on: &mut dyn FnMut(u32, f64) -> bool,
    ) {
        let rows: Vec<usize> = (all.iter().enumerate())
            .filter(|(_, example)| searched.iter().any(|found| found.scene == example.scene))
            .map(|(row, _)| row)
            .collect();
        let num_shapes = principal.shares.ncols().min(SHAPES);
        let shares = Mat::from_fn(rows.len(), num_shapes, |row, shape| {
            principal.shares[(rows[row], shape)]
        });
        let parity = &principal.parity[..num_shapes];
        let num_vertices = all.first().map_or(1, |example| example.draped.len());
        let metres = 1.0 / (num_vertices as f64).sqrt();
        let with = left_out_with(searched);
        let error = |relevance: &Self| {
            let places = places(searched, &relevance.scales(searched, mirror), mirror);
            let found = Regression::new(&places, &shares, parity, relevance.ridge());
            let missed = found.map(|found| metres * mean_root(&found.left_out(&with)));
            missed.filter(|missed| missed.is_finite())
        };
        let Some(mut least) = error(self) else {
            return;
        };
        let mut step = STEP;
        let mut round = 0;
        while go_on(round, least) {
            for number in 0..self.factors.len() {
                let before = self.factors[number];
                for change in [step, -step] {
                    self.factors[number] = before + change;
                    match error(self) {
                        Some(found) if found < least => {
                            least = found;
                            break;
                        }
                        _ => self.factors[number] = before,
                    }
                }
            }
            step *= SHRINKING;
            round += 1;
        }
        for group in 0..self.factors.len() - 2 {
            let before = std::mem::replace(&mut self.factors[group], f64::NEG_INFINITY);
            match error(self) {
                Some(found) if found < TOLERANCE * least => {}
                _ => self.factors[group] = before,
            }
        }
    }
}

/// Where each scene is among all, and its mirror image `[scene, number that is not left out]`.
pub(super) fn places(
    examples: &[&Example],
    scales: &[f32],
    mirror: Option<&GarmentMirror>,
) -> Places {
    let kept: Vec<usize> = (0..scales.len()).filter(|&at| scales[at] > 0.0).collect();
    let scaled = |number: &dyn Fn(usize, usize) -> f32| {
        Mat::from_fn(examples.len(), kept.len(), |row, column| {
            f64::from(scales[kept[column]] * number(row, kept[column]))
        })
    };
    Places {
        own: scaled(&|row, number| examples[row].parameters[number]),
        mirrored: mirror.map(|mirror| {
            scaled(&|row, number| {
                let (other, sign) = mirror.numbers().0[number];
                sign * examples[row].parameters[other]
            })
        }),
    }
}

/// The mean length of the rows.
pub(super) fn mean_root(rows: &Mat<f64>) -> f64 {
    let lengths = (0..rows.nrows()).map(|row| rows.row(row).norm_l2());
    lengths.sum::<f64>() / rows.nrows().max(1) as f64
}
