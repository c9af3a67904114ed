//! Regions of a garment, each told by a small network of its own.

use garnet_mesh::Vector3;
use rayon::prelude::*;

use super::Exchange;
use super::features::{Cut, Features};
use crate::{Cost, NetError};

/// Where the mirror image of a vertex is: the corners of a triangle, and their weights.
pub type Image = ([u32; 3], [f32; 3]);

/// A garment in regions.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Regions {
    /// What the networks are told.
    pub features: Features,
    /// The mean of each number of the features `[number]`.
    pub center: Vec<f32>,
    /// Mean offset `[vertex][3]`, in metres, in the skinning frames.
    pub mean: Vec<f32>,
    /// The regions; with a mirror those of the left side and the left half of what is in the
    /// middle.
    pub regions: Vec<Region>,
    /// How left and right are exchanged, if they are alike.
    pub mirror: Option<RegionMirror>,
}

/// How the regions of the left are those of the right.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RegionMirror {
    /// In the numbers of pose and shape.
    pub numbers: Exchange,
    /// Where the mirror image of each vertex is `[vertex]`.
    pub images: Vec<Image>,
}

/// A region, and the network that tells its offsets from the mean.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Region {
    /// Its vertices.
    pub vertices: Vec<u32>,
    /// What each feature is multiplied by `[feature]`; zero leaves it out.
    pub scales: Vec<f32>,
    /// Offsets that the network tells shares of `[shape][vertex of the region][3]`.
    pub shapes: Vec<f32>,
    /// The layers; between them is the sigmoid linear unit.
    pub layers: Vec<Layer>,
}

/// A layer: y = Wᵀ x + b.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Layer {
    /// `[input][output]`.
    pub weight: Vec<f32>,
    /// `[output]`.
    pub bias: Vec<f32>,
}

impl Layer {
    /// How many numbers go in.
    pub fn num_inputs(&self) -> usize {
        self.weight.len() / self.bias.len().max(1)
    }

    fn applied(&self, input: &[f32]) -> Vec<f32> {
        let mut output = self.bias.clone();
        for (number, weights) in input.iter().zip(self.weight.chunks_exact(output.len())) {
            for (sum, weight) in output.iter_mut().zip(weights) {
                *sum += number * weight;
            }
        }
        output
    }
}

/// What layers predict from [inputs](Region::inputs): the share of each shape, in metres.
pub fn predicted(layers: &[Layer], inputs: Vec<f32>) -> Vec<f32> {
    let mut values = inputs;
    for (number, layer) in layers.iter().enumerate() {
        if number > 0 {
            for value in &mut values {
                *value = silu(*value);
            }
        }
        values = layer.applied(&values);
    }
    values
}

/// The sigmoid linear unit (*Elfwing et al. 2018*).
pub fn silu(x: f32) -> f32 {
    x / (1.0 + (-x).exp())
}

impl Region {
    /// How many shapes there are.
    pub fn num_shapes(&self) -> usize {
        self.layers.last().map_or(0, |layer| layer.bias.len())
    }

    /// The inputs of the network: the numbers of features of a scale above zero, scaled.
    pub fn inputs(&self, owners: &[usize], center: &[f32], numbers: &[f32]) -> Vec<f32> {
        let numbers = numbers.iter().zip(center).zip(owners);
        let kept = numbers.filter(|&(_, &owner)| self.scales[owner] > 0.0);
        kept.map(|((number, center), &owner)| self.scales[owner] * (number - center))
            .collect()
    }

    /// The share of each shape, in metres.
    fn shares(&self, owners: &[usize], center: &[f32], numbers: &[f32]) -> Vec<f32> {
        predicted(&self.layers, self.inputs(owners, center, numbers))
    }

    /// Adds the shapes, by their shares, to the offsets of the garment `[vertex][3]`.
    fn add(&self, shares: &[f32], offsets: &mut [Vector3]) {
        let mut sums = vec![0.0_f32; 3 * self.vertices.len()];
        for (shape, share) in self.shapes.chunks_exact(sums.len().max(1)).zip(shares) {
            for (sum, number) in sums.iter_mut().zip(shape) {
                *sum += share * number;
            }
        }
        let (sums, _) = sums.as_chunks::<3>();
        for (&vertex, &sum) in self.vertices.iter().zip(sums) {
            offsets[vertex as usize] += Vector3::from(sum);
        }
    }
}

impl Regions {
    /// Refuses counts that do not agree.
    ///
    /// # Errors
    ///
    /// [`NetError::Count`].
    pub(super) fn check(&self) -> Result<(), NetError> {
        let check = NetError::check_count;
        self.features.check()?;
        let (owners, num_vertices) = (self.features.owners(), self.num_vertices());
        check("numbers of features", self.center.len(), owners.len())?;
        check("coordinates of the mean", self.mean.len(), 3 * num_vertices)?;
        let is_there = |vertex: u32| (vertex as usize) < num_vertices;
        for region in &self.regions {
            let vertices = region.vertices.len();
            let there = region.vertices.iter().filter(|&&vertex| is_there(vertex));
            check("vertices of a region", there.count(), vertices)?;
            check("scales", region.scales.len(), self.features.all.len())?;
            let coordinates = 3 * vertices * region.num_shapes();
            check("coordinates of shapes", region.shapes.len(), coordinates)?;
            let kept = owners.iter().filter(|&&owner| region.scales[owner] > 0.0);
            let mut inputs = kept.count();
            for layer in &region.layers {
                let weights = inputs * layer.bias.len();
                check("weights of a layer", layer.weight.len(), weights)?;
                inputs = layer.bias.len();
            }
        }
        if let Some(RegionMirror { numbers, images }) = &self.mirror {
            numbers.check(self.features.num_parameters())?;
            let sound = images.iter();
            let sound = sound.filter(|(corners, _)| corners.iter().all(|&corner| is_there(corner)));
            check("mirrored vertices", sound.count(), num_vertices)?;
        }
        Ok(())
    }

    /// How many vertices the garment has.
    pub fn num_vertices(&self) -> usize {
        self.mean.len() / 3
    }

    /// How many shares there are: those of all regions, and with a mirror those of their images.
    pub(super) fn num_shares(&self) -> usize {
        let shapes = self.regions.iter().map(Region::num_shapes);
        (1 + usize::from(self.mirror.is_some())) * shapes.sum::<usize>()
    }

    pub(super) fn cost(&self) -> Cost {
        let weights: usize = (self.regions.iter())
            .flat_map(|region| &region.layers)
            .map(|layer| layer.weight.len() + layer.bias.len())
            .sum();
        let shapes: usize = self.regions.iter().map(|region| region.shapes.len()).sum();
        let sides = 1 + u64::from(self.mirror.is_some());
        Cost {
            parameters: (weights + shapes + self.mean.len() + self.center.len()) as u64,
            // A product and a sum.
            flops: 2 * sides * (weights + shapes) as u64,
        }
    }

    /// The shares of the shapes of all regions, in metres, and of their images on the right.
    ///
    /// # Errors
    ///
    /// [`NetError::Count`] for another count of numbers than ten a joint.
    pub(super) fn shares(&self, parameters: &[f32], cut: &Cut) -> Result<Vec<f32>, NetError> {
        let owners = self.features.owners();
        let mut sides = vec![self.features.of(parameters, cut)?];
        if let Some(mirror) = &self.mirror {
            sides.push(self.features.of(&mirror.numbers.of(parameters), cut)?);
        }
        let asked: Vec<_> = (sides.iter())
            .flat_map(|numbers| self.regions.iter().map(move |region| (region, numbers)))
            .collect();
        let told = asked.par_iter();
        let told = told.map(|(region, numbers)| region.shares(&owners, &self.center, numbers));
        Ok(told.collect::<Vec<_>>().concat())
    }

    /// The offsets from the warp in the skinning frames `[vertex]`, in metres.
    pub(super) fn offsets(&self, shares: &[f32]) -> Vec<Vector3> {
        let (means, _) = self.mean.as_chunks::<3>();
        let mut offsets: Vec<Vector3> = means.iter().map(|&mean| Vector3::from(mean)).collect();
        let shares = self.add(shares, &mut offsets);
        if let Some(mirror) = &self.mirror {
            let mut left = vec![Vector3::zeros(); offsets.len()];
            self.add(shares, &mut left);
            for (offset, (corners, weights)) in offsets.iter_mut().zip(&mirror.images) {
                let corners = corners.iter().zip(weights);
                let image = corners.fold(Vector3::zeros(), |sum, (&corner, &weight)| {
                    sum + weight * left[corner as usize]
                });
                *offset += Vector3::new(-image.x, image.y, image.z);
            }
        }
        offsets
    }

    /// Adds the shapes of all regions; returns the shares that are left.
    fn add<'a>(&self, mut shares: &'a [f32], offsets: &mut [Vector3]) -> &'a [f32] {
        for region in &self.regions {
            let (own, rest) = shares.split_at(region.num_shapes().min(shares.len()));
            region.add(own, offsets);
            shares = rest;
        }
        shares
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::features::{Aspect, Feature};
    use super::*;

    /// Two vertices, left and right of the middle; a region of the left one, which moves along x
    /// and y by what the left of two joints tells.
    pub(crate) fn small() -> Regions {
        let numbers = |joint: usize| (0..10).map(move |number| (10 * joint + number, 1.0));
        let mirrored = [0, 2, 1].into_iter().flat_map(numbers).collect();
        Regions {
            features: Features {
                parents: vec![None, Some(0), Some(0)],
                hub: 0,
                all: vec![Feature {
                    joint: 1,
                    aspect: Aspect::Shape,
                }],
                cuts: None,
            },
            center: vec![0.5, 0.0, 0.0, 0.0],
            mean: vec![0.0, 0.0, 0.25, 0.0, 0.0, 0.25],
            regions: vec![Region {
                vertices: vec![0],
                scales: vec![2.0],
                shapes: vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
                layers: vec![
                    Layer {
                        weight: vec![1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
                        bias: vec![0.0, 0.0],
                    },
                    Layer {
                        weight: vec![1.0, 0.0, 0.0, 1.0],
                        bias: vec![0.125, 0.0],
                    },
                ],
            }],
            mirror: Some(RegionMirror {
                numbers: Exchange(mirrored),
                images: vec![([1, 1, 1], [1.0, 0.0, 0.0]), ([0, 0, 0], [1.0, 0.0, 0.0])],
            }),
        }
    }

    #[test]
    fn the_right_is_told_by_the_right_and_mirrored() {
        let regions = small();
        regions.check().unwrap();
        let mut parameters = vec![0.0; 30];
        // Turns of no joint count here.
        for joint in 0..3 {
            parameters[10 * joint + 1] = 1.0;
        }
        parameters[16] = 1.5;
        parameters[26] = 0.5;
        parameters[27] = 0.25;
        let shares = regions.shares(&parameters, &[0.0; 3]).unwrap();
        assert_eq!(shares.len(), regions.num_shares());
        let offsets = regions.offsets(&shares);
        let left = Vector3::new(silu(2.0) + 0.125, 0.0, 0.25);
        let right = Vector3::new(-0.125, silu(0.5), 0.25);
        for (found, expected) in offsets.iter().zip([left, right]) {
            assert!((found - expected).norm() < 1e-6, "{found} {expected}");
        }
    }

    #[test]
    fn counts_that_do_not_agree_are_refused() {
        let refused = |change: &dyn Fn(&mut Regions)| {
            let mut regions = small();
            change(&mut regions);
            assert!(matches!(regions.check(), Err(NetError::Count { .. })));
        };
        refused(&|regions| regions.center.push(0.0));
        refused(&|regions| regions.mean.push(0.0));
        refused(&|regions| regions.features.hub = 3);
        refused(&|regions| regions.regions[0].vertices[0] = 2);
        refused(&|regions| regions.regions[0].scales.clear());
        refused(&|regions| regions.regions[0].shapes.truncate(5));
        refused(&|regions| regions.regions[0].layers[1].weight.truncate(3));
        refused(&|regions| regions.mirror.as_mut().unwrap().images.truncate(1));
        refused(&|regions| regions.mirror.as_mut().unwrap().numbers.0[4].0 = 30);
        assert!(small().shares(&[0.0; 20], &[0.0; 3]).is_err());
    }
}
