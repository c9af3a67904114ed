//! Pose-space deformation: drapes of the training, interpolated by how alike poses and shapes are.
//!
//! ```text
//! G_P = M + R (m + S c),   c = Σ_i [k(|x − x_i|) + p k(|x̄ − x_i|)] w_i,   k(d) = (1 + √3 d) e^{−√3 d}
//! ```
//!
//! x are the scaled numbers of pose and shape, x_i those of the scenes that it was fitted to, m and
//! S the mean offset and the principal shapes of their offsets from the warp M, R the skinning
//! rotations. Where left and right of body and garment are alike, each scene also tells what its
//! mirror image looks like: x̄ are the numbers of the mirrored body, and the parity p of a shape is
//! 1 if it is the same in the mirror, −1 if it changes its sign; 0 without a mirror.
//!
//! Or the shares of the shapes are told by small networks, one for each region of the garment
//! ([`Regions`]): with many scenes they are nearer, and their files do not grow with the scenes.
//!
//! Source: *Lewis, Cordner and Fong 2000* (pose-space deformation), *Kry, James and Pai 2002* (its
//! principal shapes), *Rasmussen and Williams 2006, equation 4.17* (the covariance of Matérn, ν =
//! 3/2).

mod features;
mod file;
mod regions;

pub use features::{Aspect, Cut, Feature, Features};
pub use file::PoseSpaceHeader;
pub(crate) use file::is_pose_space;
pub use regions::{Image, Layer, Region, RegionMirror, Regions, predicted, silu};

use std::collections::BTreeMap;

use garnet_mesh::{Fingerprint, Point3, Vector3};
use garnet_sim::Moment;
use nalgebra::UnitQuaternion;
use rayon::prelude::*;

use crate::{Cost, NetError, TrainedRange};

/// The name of the variant, and of its file, that predicts where cloth is at a moment: that of the
/// moment, or `pose-space` for where it rests.
pub const fn deformation_name(moment: Moment) -> &'static str {
    match moment {
        Moment::Rest => "pose-space",
        _ => moment.name(),
    }
}

/// Vertices that are moved together.
const CHUNK: usize = 512;

/// A pose-space deformation with all that its file says.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseSpace {
    /// The garment it was fitted for.
    pub garment: Fingerprint,
    /// The poses and shapes that it was fitted to.
    pub range: TrainedRange,
    /// The moment at which it predicts the cloth.
    pub moment: Moment,
    /// Added to the diagonal of the covariances in the fit: the variance of what poses and shapes
    /// do not tell, over that of what they tell.
    pub ridge: f64,
    /// How it was fitted.
    pub record: serde_json::Value,
    /// Scores by name.
    pub scores: BTreeMap<String, f64>,
    /// Checksum of its file; empty until it was written or read.
    checksum: String,
    told: Told,
}

/// What tells the shares of the shapes.
#[derive(Debug, Clone, PartialEq)]
enum Told {
    /// Scenes, by how alike they are.
    ByScenes(PoseSpaceParts),
    /// Networks.
    ByRegions(Regions),
}

/// The numbers of a [`PoseSpace`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PoseSpaceParts {
    /// What each number of pose and shape is multiplied by `[number]`; zero leaves it out.
    pub scales: Vec<f32>,
    /// Scaled numbers of the scenes `[scene][number that is not left out]`.
    pub centers: Vec<f32>,
    /// Weights `[scene][shape]`.
    pub weights: Vec<f32>,
    /// Mean offset `[vertex][3]`, in metres, in the skinning frames.
    pub mean: Vec<f32>,
    /// Principal shapes `[shape][vertex][3]`, each of norm 1.
    pub shapes: Vec<f32>,
    /// How left and right are exchanged, if they are alike.
    pub mirror: Option<Mirror>,
}

/// How left and right are exchanged.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mirror {
    /// In the numbers of pose and shape.
    pub numbers: Exchange,
    /// 1 for shapes that are the same in the mirror, −1 for those that change their sign `[shape]`.
    pub parity: Vec<f32>,
}

/// How left and right are exchanged in the numbers of pose and shape: for each the one that takes
/// its place, and its sign `[number]`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Exchange(pub Vec<(usize, f32)>);

impl Exchange {
    /// The numbers of the mirrored body `[number]`.
    ///
    /// # Panics
    ///
    /// If there are other numbers than the exchange knows.
    pub fn of(&self, parameters: &[f32]) -> Vec<f32> {
        let numbers = self.0.iter();
        numbers
            .map(|&(number, sign)| sign * parameters[number])
            .collect()
    }

    /// Refuses another count, and numbers that there are not.
    fn check(&self, expected: usize) -> Result<(), NetError> {
        NetError::check_count("mirrored numbers", self.0.len(), expected)?;
        let within = self.0.iter().filter(|(number, _)| *number < expected);
        NetError::check_count("mirrored numbers", within.count(), expected)
    }
}

/// The covariance of two scenes from the squared distance of their scaled numbers.
pub fn covariance(squared: f64) -> f64 {
    let distance = (3.0 * squared).sqrt();
    (1.0 + distance) * (-distance).exp()
}

impl PoseSpaceParts {
    /// How many principal shapes there are.
    pub fn num_shapes(&self) -> usize {
        self.shapes.len() / self.mean.len().max(1)
    }

    /// The numbers that count, scaled.
    ///
    /// # Errors
    ///
    /// [`NetError::Count`] for another count of numbers than that of the scales.
    pub fn scaled(&self, parameters: &[f32]) -> Result<Vec<f32>, NetError> {
        NetError::check_count("parameters", parameters.len(), self.scales.len())?;
        let pairs = self.scales.iter().zip(parameters);
        Ok(pairs
            .filter(|&(&scale, _)| scale > 0.0)
            .map(|(scale, number)| scale * number)
            .collect())
    }

    fn shares(&self, parameters: &[f32]) -> Result<Vec<f32>, NetError> {
        let mut sums = self.sums(&self.scaled(parameters)?);
        if let Some(mirror) = &self.mirror {
            let mirrored = self.sums(&self.scaled(&mirror.numbers.of(parameters))?);
            let mirrored = mirrored.iter().zip(&mirror.parity);
            for (sum, (mirrored, parity)) in sums.iter_mut().zip(mirrored) {
                *sum += parity * mirrored;
            }
        }
        Ok(sums)
    }

    /// The weights of the scenes, by how alike they are to a place `[shape]`.
    fn sums(&self, place: &[f32]) -> Vec<f32> {
        let mut sums = vec![0.0_f32; self.num_shapes()];
        if place.is_empty() || sums.is_empty() {
            return sums;
        }
        let centers = self.centers.chunks_exact(place.len());
        for (center, weights) in centers.zip(self.weights.chunks_exact(sums.len())) {
            let squared: f32 = center
                .iter()
                .zip(place)
                .map(|(a, b)| (a - b) * (a - b))
                .sum();
            let alike = covariance(f64::from(squared)) as f32;
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum += alike * weight;
            }
        }
        sums
    }

    /// The offsets from the warp in the skinning frames `[vertex]`, in metres.
    fn offsets(&self, shares: &[f32]) -> Vec<Vector3> {
        let mut offsets = self.mean.clone();
        offsets
            .par_chunks_mut(3 * CHUNK)
            .enumerate()
            .for_each(|(number, offsets)| {
                let first = 3 * CHUNK * number;
                let shapes = self.shapes.chunks_exact(self.mean.len());
                for (shape, share) in shapes.zip(shares) {
                    let part = &shape[first..first + offsets.len()];
                    for (offset, number) in offsets.iter_mut().zip(part) {
                        *offset += share * number;
                    }
                }
            });
        let (offsets, _) = offsets.as_chunks::<3>();
        offsets
            .iter()
            .map(|&offset| Vector3::from(offset))
            .collect()
    }
}

impl PoseSpace {
    /// Puts the numbers of a fit together.
    ///
    /// # Errors
    ///
    /// [`NetError::Count`] where their counts do not agree.
    pub fn new(
        parts: PoseSpaceParts,
        garment: Fingerprint,
        range: TrainedRange,
        ridge: f64,
    ) -> Result<Self, NetError> {
        let kept = parts.scales.iter().filter(|&&scale| scale > 0.0).count();
        let check = NetError::check_count;
        let num_shapes = parts.num_shapes();
        let num_scenes = parts.centers.len() / kept.max(1);
        let coordinates = 3 * (parts.mean.len() / 3);
        check("coordinates of the mean", parts.mean.len(), coordinates)?;
        let coordinates = num_shapes * parts.mean.len();
        check("coordinates of shapes", parts.shapes.len(), coordinates)?;
        let numbers = num_scenes * kept;
        check("numbers of scenes", parts.centers.len(), numbers)?;
        check("weights", parts.weights.len(), num_scenes * num_shapes)?;
        if let Some(Mirror { numbers, parity }) = &parts.mirror {
            numbers.check(parts.scales.len())?;
            check("parities", parity.len(), num_shapes)?;
        }
        let told = Told::ByScenes(parts);
        Ok(Self::of(told, garment, range, ridge))
    }

    /// Puts the regions of a garment together.
    ///
    /// # Errors
    ///
    /// [`NetError::Count`] where counts do not agree.
    pub fn of_regions(
        regions: Regions,
        garment: Fingerprint,
        range: TrainedRange,
    ) -> Result<Self, NetError> {
        regions.check()?;
        Ok(Self::of(Told::ByRegions(regions), garment, range, 0.0))
    }

    fn of(told: Told, garment: Fingerprint, range: TrainedRange, ridge: f64) -> Self {
        Self {
            garment,
            range,
            moment: Moment::Rest,
            ridge,
            record: serde_json::Value::Null,
            scores: BTreeMap::new(),
            checksum: String::new(),
            told,
        }
    }

    /// The numbers, if scenes tell the shares of the shapes.
    pub fn parts(&self) -> Option<&PoseSpaceParts> {
        match &self.told {
            Told::ByScenes(parts) => Some(parts),
            Told::ByRegions(_) => None,
        }
    }

    /// The regions, if networks tell the shares of their shapes.
    pub fn regions(&self) -> Option<&Regions> {
        match &self.told {
            Told::ByScenes(_) => None,
            Told::ByRegions(regions) => Some(regions),
        }
    }

    /// Whether it has learned garments that are cut like this, and is told so.
    pub fn knows(&self, cut: &Cut) -> bool {
        self.regions()
            .is_some_and(|regions| regions.features.knows(cut))
    }

    /// Checksum of its file; empty until it was written or read.
    pub fn checksum(&self) -> &str {
        &self.checksum
    }

    /// How many vertices the garment has.
    pub fn num_vertices(&self) -> usize {
        match &self.told {
            Told::ByScenes(parts) => parts.mean.len() / 3,
            Told::ByRegions(regions) => regions.num_vertices(),
        }
    }

    /// How many shapes there are, those of the mirror images of regions among them.
    pub fn num_shapes(&self) -> usize {
        match &self.told {
            Told::ByScenes(parts) => parts.num_shapes(),
            Told::ByRegions(regions) => regions.num_shares(),
        }
    }

    /// Weights and operations of a prediction.
    pub fn cost(&self) -> Cost {
        let PoseSpaceParts {
            scales,
            centers,
            weights,
            mean,
            shapes,
            mirror,
        } = match &self.told {
            Told::ByScenes(parts) => parts,
            Told::ByRegions(regions) => return regions.cost(),
        };
        let all = [scales, centers, weights, mean, shapes].map(|part| part.len() as u64);
        Cost {
            parameters: all.iter().sum(),
            // A difference, its square and a sum; a product and a sum.
            flops: (1 + u64::from(mirror.is_some())) * (3 * all[1] + 2 * all[2])
                + 2 * all[4]
                + all[3],
        }
    }

    /// The share of each shape `[shape]`, in metres, by pose and shape of the body and by the cut
    /// of the garment.
    ///
    /// # Errors
    ///
    /// [`NetError::Count`] for another count of numbers than those that it was fitted to.
    pub fn coefficients(&self, parameters: &[f32], cut: &Cut) -> Result<Vec<f32>, NetError> {
        match &self.told {
            Told::ByScenes(parts) => parts.shares(parameters),
            Told::ByRegions(regions) => regions.shares(parameters, cut),
        }
    }

    /// The warped garment `[vertex]`, moved by mean and principal shapes, in metres.
    ///
    /// # Errors
    ///
    /// [`NetError::Count`] for a garment of another vertex count, [`NetError::Missing`] without
    /// skinning rotations, [`NetError::Diverged`] for offsets that are not finite.
    pub fn moved(
        &self,
        warped: &[Point3],
        rotations: &[UnitQuaternion<f32>],
        coefficients: &[f32],
    ) -> Result<Vec<Point3>, NetError> {
        if rotations.len() != warped.len() {
            return Err(NetError::Missing {
                what: "skinning rotations are",
                needed_by: "the pose-space deformation moves vertices in",
            });
        }
        NetError::check_count("garment vertices", warped.len(), self.num_vertices())?;
        let offsets = match &self.told {
            Told::ByScenes(parts) => parts.offsets(coefficients),
            Told::ByRegions(regions) => regions.offsets(coefficients),
        };
        let places = warped.iter().zip(rotations).zip(offsets);
        let moved: Vec<Point3> = places
            .map(|((warped, rotation), offset)| warped + rotation * offset)
            .collect();
        let is_stray = |place: &Point3| !place.iter().all(|number| number.is_finite());
        match moved.iter().position(is_stray) {
            Some(vertex) => Err(NetError::Diverged { vertex }),
            None => Ok(moved),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two scenes of one number, a garment of one vertex, one shape.
    pub(super) fn small() -> PoseSpace {
        let parts = PoseSpaceParts {
            scales: vec![0.0, 2.0],
            centers: vec![0.0, 1.0],
            weights: vec![0.5, -0.25],
            mean: vec![0.0, 0.125, 0.0],
            shapes: vec![1.0, 0.0, 0.0],
            mirror: None,
        };
        let range = TrainedRange::of([[0.0, 0.0], [1.0, 0.5]]).unwrap();
        PoseSpace::new(parts, Fingerprint::of_bytes(b"one"), range, 0.01).unwrap()
    }

    #[test]
    fn likeness_is_one_for_the_same_and_falls() {
        assert!((covariance(0.0) - 1.0).abs() < 1e-12);
        // Equation 4.17 at distance 1.
        let at_one = (1.0 + 3.0_f64.sqrt()) * (-3.0_f64.sqrt()).exp();
        assert!((covariance(1.0) - at_one).abs() < 1e-12);
        assert!(covariance(1e4) < 1e-12);
    }

    #[test]
    fn a_scene_between_two_gets_of_both() {
        let space = small();
        let found = space.coefficients(&[9.0, 0.25], &[0.0; 3]).unwrap();
        let half = covariance(0.25) as f32;
        assert!((found[0] - 0.25 * half).abs() < 1e-6);
        let quarter =
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.5 * std::f32::consts::PI);
        let moved = space
            .moved(&[Point3::new(1.0, 0.0, 0.0)], &[quarter], &[0.5])
            .unwrap();
        assert!((moved[0] - Point3::new(0.875, 0.5, 0.0)).norm() < 1e-6);
    }

    #[test]
    fn what_a_scene_tells_is_told_of_its_mirror_image() {
        let space = small();
        for parity in [1.0, -1.0] {
            let mirror = Mirror {
                numbers: Exchange(vec![(0, 1.0), (1, -1.0)]),
                parity: vec![parity],
            };
            let parts = PoseSpaceParts {
                mirror: Some(mirror),
                ..space.parts().unwrap().clone()
            };
            let mirrored = PoseSpace::new(parts, space.garment, space.range.clone(), 0.01).unwrap();
            let at = |space: &PoseSpace, number| {
                space.coefficients(&[0.0, number], &[0.0; 3]).unwrap()[0]
            };
            let expected = at(&space, 0.3) + parity * at(&space, -0.3);
            assert!((at(&mirrored, 0.3) - expected).abs() < 1e-6);
            assert!((at(&mirrored, -0.3) - parity * expected).abs() < 1e-6);
        }
        let parts = PoseSpaceParts {
            mirror: Some(Mirror {
                numbers: Exchange(vec![(2, 1.0), (1, -1.0)]),
                parity: vec![1.0],
            }),
            ..space.parts().unwrap().clone()
        };
        let range = space.range.clone();
        assert!(PoseSpace::new(parts, space.garment, range, 0.01).is_err());
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let space = small();
        assert!(matches!(
            space.coefficients(&[0.0], &[0.0; 3]),
            Err(NetError::Count {
                what: "parameters",
                found: 1,
                expected: 2
            })
        ));
        let places = [Point3::origin(); 2];
        let turns = [UnitQuaternion::identity(); 2];
        assert!(matches!(
            space.moved(&places, &turns, &[0.0]),
            Err(NetError::Count { .. })
        ));
        assert!(matches!(
            space.moved(&places, &[], &[0.0]),
            Err(NetError::Missing { .. })
        ));
        let one = [Point3::origin()];
        assert!(matches!(
            space.moved(&one, &turns[..1], &[f32::NAN]),
            Err(NetError::Diverged { vertex: 0 })
        ));
        let parts = PoseSpaceParts {
            weights: vec![0.5],
            ..space.parts().unwrap().clone()
        };
        let range = space.range.clone();
        assert!(PoseSpace::new(parts, space.garment, range, 0.01).is_err());
    }
}
