//! The last step of the backward pass of the FeaStNet convolution: vertices collect what tiles sent
//! them.

use rayon::prelude::*;

use crate::adjacency_tiles::TILE_ROWS;
use crate::feast_aggregate::{HeadRows, aggregate};
use crate::feast_backward::Shape;
use crate::feast_columns::Columns;
use crate::instructions::Kernel;
use crate::lanes::{Lanes, whole};
use crate::reduce::{split_into_tiles, sum_rows};
use crate::{Adjacency, FeastGradients, FeastInput, FeastLayer, Features, Workspace};

/// Lets each vertex collect its slots, and sums the gradient of `u` over vertices.
pub(crate) fn collect(
    layer: &FeastLayer<'_>,
    input: &FeastInput<'_>,
    shape: &Shape,
    (slots, columns): (&[f32], &Columns),
    gradients: &mut FeastGradients<'_>,
    workspace: &Workspace,
) {
    let (in_channels, num_heads) = (shape.in_channels, layer.num_heads);
    let mut transposed_u = workspace.scratch(layer.u.len());
    for (channel, u) in layer.u.chunks_exact(num_heads).enumerate() {
        u.iter()
            .enumerate()
            .for_each(|(head, u)| transposed_u[head * in_channels + channel] = *u);
    }
    // A row of products for each vertex, and for each tile the sums of `dp_m x`.
    let num_vertices = input.adjacency.num_vertices();
    let mut d_products = workspace.scratch(num_vertices * shape.head_stride);
    let mut du_of_tiles = workspace.scratch(shape.num_tiles * layer.u.len());
    let channels: Vec<usize> = input.features.iter().map(|part| part.channels).collect();
    let dx = split_into_tiles(gradients.features, &channels, TILE_ROWS, shape.num_tiles);

    d_products
        .par_chunks_mut(TILE_ROWS * shape.head_stride)
        .zip(du_of_tiles.par_chunks_exact_mut(layer.u.len()))
        .zip(dx)
        .enumerate()
        .for_each(|(tile, ((d_products, du), mut dx))| {
            workspace.instructions().run(CollectTile {
                adjacency: input.adjacency,
                features: input.features,
                first_row: tile * TILE_ROWS,
                slots,
                slot_stride: shape.slot_stride,
                transposed_u: &transposed_u,
                num_heads,
                head_stride: shape.head_stride,
                d_products,
                du,
                dx: &mut dx,
            });
        });

    let mut du = workspace.scratch(layer.u.len());
    sum_rows(&du_of_tiles, &mut du);
    for (du, &row) in du.iter().zip(columns.rows()) {
        let (head, channel) = (row as usize / in_channels, row as usize % in_channels);
        gradients.u[channel * num_heads + head] = *du;
    }
}

/// What the vertices of a tile collect.
struct CollectTile<'a, 'b> {
    adjacency: &'a Adjacency,
    features: &'a [Features<'a>],
    first_row: usize,
    slots: &'a [f32],
    slot_stride: usize,
    /// `[num_heads, in_channels]`.
    transposed_u: &'a [f32],
    num_heads: usize,
    head_stride: usize,
    d_products: &'a mut [f32],
    /// `[num_heads * in_channels]`, in the order of [`Columns`].
    du: &'a mut [f32],
    dx: &'a mut [Option<&'b mut [f32]>],
}

impl Kernel for CollectTile<'_, '_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self {
            features,
            first_row,
            slots,
            slot_stride,
            num_heads,
            head_stride,
            ..
        } = self;
        let first_logit = slot_stride - head_stride;
        let in_channels = self.transposed_u.len() / num_heads;
        let num_rows = self.d_products.len() / head_stride;
        for row in 0..num_rows {
            let own_slots = self.adjacency.slots().of(first_row + row);
            let d_products = &mut self.d_products[row * head_stride..][..head_stride];
            for head in (0..head_stride).step_by(V::LANES) {
                let mut sum = V::splat(0.0);
                for &slot in own_slots {
                    sum = sum.add(V::load(
                        &slots[slot as usize * slot_stride + first_logit + head..],
                    ));
                }
                sum.store(&mut d_products[head..]);
            }

            let mut column = 0;
            for (part, dx) in features.iter().zip(self.dx.iter_mut()) {
                if let Some(dx) = dx {
                    let dx = &mut dx[row * part.channels..][..part.channels];
                    let whole = whole::<V>(part.channels);
                    let sources = Sources {
                        slots,
                        slot_stride,
                        own_slots,
                        transposed_u: self.transposed_u,
                        in_channels,
                        d_products,
                        columns: column..column + part.channels,
                    };
                    for channel in (0..whole).step_by(V::LANES) {
                        sources
                            .collected(channel, V::load)
                            .store(&mut dx[channel..]);
                    }
                    if whole < part.channels {
                        let rest = sources.collected(whole, V::load_part);
                        rest.store_part(&mut dx[whole..]);
                    }
                }
                column += part.channels;
            }
        }

        let rows: [u32; TILE_ROWS] = std::array::from_fn(|row| (first_row + row) as u32);
        let weights = HeadRows {
            values: self.d_products,
            stride: head_stride,
            num_heads,
        };
        let mut column = 0;
        for part in features {
            let sums = &mut self.du[column * num_heads..];
            aggregate::<V>(*part, &rows[..num_rows], weights, sums);
            column += part.channels;
        }
    }
}

/// What the gradient of the features of a vertex is made of.
struct Sources<'a> {
    slots: &'a [f32],
    slot_stride: usize,
    own_slots: &'a [u32],
    transposed_u: &'a [f32],
    in_channels: usize,
    /// Of the vertex, a row of heads.
    d_products: &'a [f32],
    /// Of a part of the features among those of all parts.
    columns: std::ops::Range<usize>,
}

impl Sources<'_> {
    /// The sum for the channels of a vector; a function of its own, because a closure would be
    /// compiled without the instructions of `V`.
    #[inline(always)]
    fn collected<V: Lanes>(&self, channel: usize, load: impl Fn(&[f32]) -> V) -> V {
        let (column, end) = (self.columns.start + channel, self.columns.end);
        let mut sum = V::splat(0.0);
        for &slot in self.own_slots {
            let slot = &self.slots[slot as usize * self.slot_stride..][..end];
            sum = sum.add(load(&slot[column..]));
        }
        let rows = self.transposed_u.chunks_exact(self.in_channels);
        for (u, dp) in rows.zip(self.d_products) {
            sum = V::splat(*dp).mul_add(load(&u[column..end]), sum);
        }
        sum
    }
}
