//! How much each head of a FeaStNet convolution takes from each neighbor.
//!
//! Rows of heads are padded to whole vectors: the offsets of the padding are so low that its
//! weights vanish.

use std::ops::Range;

use rayon::prelude::*;

use crate::adjacency_tiles::TILE_ROWS;
use crate::feast_aggregate::HeadRows;
use crate::instructions::Kernel;
use crate::lanes::Lanes;
use crate::workspace::Scratch;
use crate::{Adjacency, FeastLayer, Features, Workspace};

/// An offset that takes all weight from a head.
const NEVER: f32 = -1e30;

/// Logits so far below the largest one count no less: e^-40 is nothing beside 1 in single
/// precision, and its products with derivatives are still normal numbers, while those of e^-80, in
/// each padded row, were not (each costs a hundred cycles on some processors).
const LEAST: f32 = -40.0;

/// The products `x U` of all vertices.
pub(crate) struct Logits<'a> {
    num_heads: usize,
    stride: usize,
    /// `[num_vertices, stride]`.
    products: Scratch<'a>,
    /// `[stride]`.
    offsets: Scratch<'a>,
}

/// What the weights of an edge are made from.
#[derive(Clone, Copy)]
pub(crate) struct Attention<'a> {
    pub(crate) num_heads: usize,
    /// Length of a padded row of heads.
    pub(crate) stride: usize,
    products: &'a [f32],
    offsets: &'a [f32],
}

impl<'a> Logits<'a> {
    /// Multiplies the features of all vertices by `U`.
    pub(crate) fn new(
        layer: &FeastLayer<'_>,
        features: &[Features<'_>],
        workspace: &'a Workspace,
    ) -> Self {
        let num_heads = layer.num_heads;
        let stride = num_heads.next_multiple_of(workspace.instructions().lanes());
        let num_vertices = features
            .first()
            .map_or(0, |part| part.values.len() / part.channels.max(1));

        let mut offsets = workspace.scratch(stride);
        offsets.fill(NEVER);
        offsets[..num_heads].copy_from_slice(layer.c);
        let mut u = workspace.zeros(layer.u.len() / num_heads * stride);
        for (padded, u) in u
            .chunks_exact_mut(stride)
            .zip(layer.u.chunks_exact(num_heads))
        {
            padded[..num_heads].copy_from_slice(u);
        }
        let mut products = workspace.scratch(num_vertices * stride);
        products
            .par_chunks_mut(TILE_ROWS * stride)
            .enumerate()
            .for_each(|(tile, products)| {
                let first_row = tile * TILE_ROWS;
                workspace.instructions().run(Project {
                    features,
                    first_row,
                    u: &u,
                    stride,
                    products,
                });
            });
        Self {
            num_heads,
            stride,
            products,
            offsets,
        }
    }

    /// What kernels need of this.
    pub(crate) fn attention(&self) -> Attention<'_> {
        let (products, offsets) = (&*self.products, &*self.offsets);
        Attention {
            num_heads: self.num_heads,
            stride: self.stride,
            products,
            offsets,
        }
    }

    /// Number of values that the weights of the edges of some vertices need.
    pub(crate) fn len_of_weights(&self, adjacency: &Adjacency, rows: Range<usize>) -> usize {
        (adjacency.edges(rows.end - 1).end - adjacency.edges(rows.start).start) * self.stride
    }
}

/// Products of features of a tile with the padded `U`.
struct Project<'a> {
    features: &'a [Features<'a>],
    first_row: usize,
    u: &'a [f32],
    stride: usize,
    products: &'a mut [f32],
}

impl Kernel for Project<'_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        const ROWS: usize = 8;
        let Self {
            features,
            first_row,
            u,
            stride,
            products,
        } = self;
        let num_rows = products.len() / stride;
        let whole = num_rows - num_rows % ROWS;
        for row in (0..whole).step_by(ROWS) {
            let products = &mut products[row * stride..];
            project_rows::<V, ROWS>(features, first_row + row, u, stride, products);
        }
        for row in whole..num_rows {
            let products = &mut products[row * stride..];
            project_rows::<V, 1>(features, first_row + row, u, stride, products);
        }
    }
}

/// The exponentials of logits less the largest one.
#[inline(always)]
fn raised<V: Lanes>(below: V) -> V {
    below.max(V::splat(LEAST)).exp()
}

#[inline(always)]
fn project_rows<V: Lanes, const R: usize>(
    features: &[Features<'_>],
    first_row: usize,
    u: &[f32],
    stride: usize,
    products: &mut [f32],
) {
    for head in (0..stride).step_by(V::LANES) {
        let mut sums = [V::splat(0.0); R];
        let mut u = u.chunks_exact(stride);
        for part in features {
            let rows: [&[f32]; R] = std::array::from_fn(|row| part.row(first_row + row));
            for (channel, u) in (0..part.channels).zip(&mut u) {
                let u = V::load(&u[head..]);
                for (sum, row) in sums.iter_mut().zip(rows) {
                    *sum = V::splat(row[channel]).mul_add(u, *sum);
                }
            }
        }
        for (row, sum) in sums.iter().enumerate() {
            sum.store(&mut products[row * stride + head..]);
        }
    }
}

impl<'a> Attention<'a> {
    #[inline(always)]
    fn product(&self, vertex: u32) -> &'a [f32] {
        &self.products[vertex as usize * self.stride..][..self.stride]
    }

    /// Rows of heads of some edges.
    #[inline(always)]
    pub(crate) fn view<'b>(&self, weights: &'b [f32]) -> HeadRows<'b> {
        HeadRows {
            values: weights,
            stride: self.stride,
            num_heads: self.num_heads,
        }
    }

    /// Writes `q_ij / |N_i|` for each neighbor `j` of the vertex `i`.
    #[inline(always)]
    pub(crate) fn weigh<V: Lanes>(&self, vertex: usize, neighbors: &[u32], weights: &mut [f32]) {
        let own = self.product(vertex as u32);
        let share = 1.0 / neighbors.len() as f32;
        for (neighbor, weights) in neighbors.iter().zip(weights.chunks_exact_mut(self.stride)) {
            let other = self.product(*neighbor);
            if self.stride == V::LANES {
                let logits = V::load(other).sub(V::load(own)).add(V::load(self.offsets));
                let raised = raised(logits.sub(V::splat(logits.largest())));
                raised.mul(V::splat(share / raised.sum())).store(weights);
                continue;
            }
            let mut largest = V::splat(f32::MIN);
            for head in (0..self.stride).step_by(V::LANES) {
                let logits = V::load(&other[head..]).sub(V::load(&own[head..]));
                let logits = logits.add(V::load(&self.offsets[head..]));
                largest = largest.max(logits);
                logits.store(&mut weights[head..]);
            }
            let largest = V::splat(largest.largest());
            let mut sum = V::splat(0.0);
            for head in (0..self.stride).step_by(V::LANES) {
                let raised = raised(V::load(&weights[head..]).sub(largest));
                sum = sum.add(raised);
                raised.store(&mut weights[head..]);
            }
            let share = V::splat(share / sum.sum());
            for head in (0..self.stride).step_by(V::LANES) {
                V::load(&weights[head..])
                    .mul(share)
                    .store(&mut weights[head..]);
            }
        }
    }

    /// The gradients of the logits of an edge whose heads fill one vector; see
    /// [`Self::weigh_backward`].
    #[inline(always)]
    pub(crate) fn logit_gradient<V: Lanes>(weights: V, gradients: V, degree: f32) -> V {
        let mean = V::splat(degree * weights.mul(gradients).sum());
        weights.mul(gradients.sub(mean))
    }

    /// Turns `g_m = z'_im · x_j`, a row for each neighbor, into gradients of the logits.
    ///
    /// With `a = q / |N_i|` the softmax gives `a_m (g_m - |N_i| Σ_m a_m g_m)`.
    #[inline(always)]
    pub(crate) fn weigh_backward<V: Lanes>(&self, weights: &[f32], gradients: &mut [f32]) {
        let degree = (weights.len() / self.stride) as f32;
        let rows = weights
            .chunks_exact(self.stride)
            .zip(gradients.chunks_exact_mut(self.stride));
        for (weights, gradients) in rows {
            let mut sum = V::splat(0.0);
            for head in (0..self.stride).step_by(V::LANES) {
                sum = V::load(&weights[head..]).mul_add(V::load(&gradients[head..]), sum);
            }
            let mean = V::splat(degree * sum.sum());
            for head in (0..self.stride).step_by(V::LANES) {
                let gradient = V::load(&gradients[head..]).sub(mean);
                V::load(&weights[head..])
                    .mul(gradient)
                    .store(&mut gradients[head..]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes_portable::Portable;

    #[test]
    fn weights_of_padding_are_nothing_beside_others_and_normal_beside_derivatives() {
        let mut weights = [0.0; Portable::LANES];
        raised(Portable::splat(NEVER)).store(&mut weights);
        let num_heads = 64.0;
        for weight in weights {
            assert_eq!((1.0 + num_heads * weight).to_bits(), 1.0_f32.to_bits());
            assert!((1e-20 * weight).is_normal(), "{weight:e}");
        }
    }
}
