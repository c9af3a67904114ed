//! The backward pass of the FeaStNet convolution.
//!
//! Weights and aggregates are made again, tile by tile. With `z' = y' Wᵀ` the gradients of features
//! and logits are added up in the slots of the tile, in the order of its edges; afterwards each
//! vertex collects its slots. Gradients of weights are summed over fixed blocks of tiles, then over
//! blocks.

use rayon::prelude::*;

use crate::adjacency_tiles::TILE_ROWS;
use crate::feast::AggregateTile;
use crate::feast_aggregate::{SlotRows, aggregate_backward};
use crate::feast_attention::{Attention, Logits};
use crate::feast_collect::collect;
use crate::instructions::Kernel;
use crate::lanes::Lanes;
use crate::matmul::{MatrixMut, MatrixRef};
use crate::reduce::{split_into_tiles, sum_rows};
use crate::{Activation, FeastInput, FeastLayer, Workspace, check};

/// Blocks of tiles at most: each needs memory for the gradient of `w`.
const MAX_BLOCKS: usize = 16;

/// Gradients of a FeaStNet convolution; what is there before is overwritten.
#[derive(Debug)]
pub struct FeastGradients<'a> {
    /// Of each part of the features, `[num_vertices, channels]`, where it is wanted.
    pub features: &'a mut [Option<&'a mut [f32]>],
    /// Of the residual, `[num_vertices, out_channels]`, if it is wanted.
    pub residual: Option<&'a mut [f32]>,
    /// `[in_channels, num_heads]`.
    pub u: &'a mut [f32],
    /// `[num_heads]`.
    pub c: &'a mut [f32],
    /// `[num_heads * in_channels, out_channels]`.
    pub w: &'a mut [f32],
    /// `[out_channels]`.
    pub b: &'a mut [f32],
}

/// Computes all gradients from the output `y` of [`feast_forward`](crate::feast_forward) and its
/// gradient `dy`.
///
/// `y` is read only where the layer has an activation; it may be empty else.
///
/// # Panics
///
/// Panics if the length of a slice does not fit the shapes given with the types.
pub fn feast_backward(
    layer: &FeastLayer<'_>,
    input: &FeastInput<'_>,
    (y, dy): (&[f32], &[f32]),
    gradients: &mut FeastGradients<'_>,
    workspace: &Workspace,
) {
    check_gradients(layer, input, (y, dy), gradients);
    let adjacency = input.adjacency;
    let shape = Shape::new(layer, input, workspace);
    let logits = Logits::new(layer, input.features, workspace);
    let columns = input.columns(layer, workspace);
    let w = columns.ordered(layer.w, layer.out_channels, workspace);

    // Per tile: slots, and sums of the gradients of offsets and bias.
    let mut slots = workspace.zeros(adjacency.tiles().num_slots() * shape.slot_stride);
    let mut sums = workspace.zeros(shape.num_tiles * shape.sum_stride);
    let mut dw_of_blocks = workspace.zeros(shape.num_blocks * layer.w.len());
    let residual = &mut [gradients.residual.as_deref_mut()];
    let mut residuals = split_into_tiles(
        residual,
        &[layer.out_channels],
        shape.tiles_per_block * TILE_ROWS,
        shape.num_blocks,
    )
    .into_iter();

    let mut blocks = Vec::with_capacity(shape.num_blocks);
    let (mut slots_left, mut sums_left) = (&mut *slots, &mut *sums);
    for (block, dw) in dw_of_blocks.chunks_exact_mut(layer.w.len()).enumerate() {
        let first_tile = block * shape.tiles_per_block;
        let tiles = first_tile..(first_tile + shape.tiles_per_block).min(shape.num_tiles);
        let num_slots = adjacency.tiles().num_slots_of(tiles.clone());
        let (slots, others) = slots_left.split_at_mut(num_slots * shape.slot_stride);
        slots_left = others;
        let (sums, others) = sums_left.split_at_mut(tiles.len() * shape.sum_stride);
        sums_left = others;
        let d_residual = residuals.next().and_then(|mut outputs| outputs.remove(0));
        blocks.push(Block {
            tiles,
            slots,
            sums,
            dw,
            d_residual,
        });
    }
    blocks.into_par_iter().for_each(|block| {
        block.run(layer, input, (&w, y, dy), &logits, workspace);
    });

    let mut sum = workspace.scratch(shape.sum_stride);
    sum_rows(&sums, &mut sum);
    gradients.c.copy_from_slice(&sum[..layer.num_heads]);
    gradients.b.copy_from_slice(&sum[shape.head_stride..]);
    let mut dw = workspace.scratch(layer.w.len());
    sum_rows(&dw_of_blocks, &mut dw);
    columns.restore(&dw, gradients.w, layer.out_channels);
    drop((dw, dw_of_blocks));
    collect(
        layer,
        input,
        &shape,
        (&slots, &columns),
        gradients,
        workspace,
    );
}

/// Sizes of the tables of the backward pass.
pub(crate) struct Shape {
    pub(crate) in_channels: usize,
    pub(crate) head_stride: usize,
    /// Columns of a slot: gradients of the features, padded, then of the logits.
    pub(crate) slot_stride: usize,
    /// Columns of the sums of a tile: offsets, then bias.
    pub(crate) sum_stride: usize,
    pub(crate) num_tiles: usize,
    pub(crate) tiles_per_block: usize,
    pub(crate) num_blocks: usize,
}

impl Shape {
    fn new(layer: &FeastLayer<'_>, input: &FeastInput<'_>, workspace: &Workspace) -> Self {
        let in_channels = input.in_channels();
        let head_stride = layer
            .num_heads
            .next_multiple_of(workspace.instructions().lanes());
        let num_tiles = input.adjacency.tiles().len();
        let tiles_per_block = num_tiles.div_ceil(MAX_BLOCKS).max(1);
        Self {
            in_channels,
            head_stride,
            slot_stride: slot_stride(in_channels, head_stride),
            sum_stride: head_stride + layer.out_channels,
            num_tiles,
            tiles_per_block,
            num_blocks: num_tiles.div_ceil(tiles_per_block),
        }
    }
}

/// Slots begin and end at cache lines.
fn slot_stride(in_channels: usize, head_stride: usize) -> usize {
    (in_channels.next_multiple_of(16) + head_stride).next_multiple_of(16)
}

/// Consecutive tiles, handled by one thread.
struct Block<'a> {
    tiles: std::ops::Range<usize>,
    slots: &'a mut [f32],
    sums: &'a mut [f32],
    dw: &'a mut [f32],
    d_residual: Option<&'a mut [f32]>,
}

impl Block<'_> {
    fn run(
        mut self,
        layer: &FeastLayer<'_>,
        input: &FeastInput<'_>,
        (w, y, dy): (&[f32], &[f32], &[f32]),
        logits: &Logits<'_>,
        workspace: &Workspace,
    ) {
        let tiles = input.adjacency.tiles();
        let (in_channels, out_channels) = (input.in_channels(), layer.out_channels);
        let depth = layer.num_heads * in_channels;
        let attention = logits.attention();
        let slot_stride = slot_stride(in_channels, attention.stride);
        let sum_stride = attention.stride + out_channels;
        let first_row = tiles.rows(self.tiles.start).start;
        let mut z = workspace.scratch(TILE_ROWS * depth);
        let mut d_sum = workspace.scratch(TILE_ROWS * out_channels);
        let mut slots = self.slots;

        for (tile, sums) in self.tiles.zip(self.sums.chunks_exact_mut(sum_stride)) {
            let rows = tiles.rows(tile);
            let outputs = rows.start * out_channels..rows.end * out_channels;
            let z = &mut z[..rows.len() * depth];
            let d_sum = &mut d_sum[..outputs.len()];
            let y = if y.is_empty() { y } else { &y[outputs.clone()] };
            layer.activation.gradient(y, &dy[outputs.clone()], d_sum);
            if let Some(d_residual) = &mut self.d_residual {
                d_residual[outputs.start - first_row * out_channels..][..d_sum.len()]
                    .copy_from_slice(d_sum);
            }
            let (dc, db) = sums.split_at_mut(attention.stride);
            for d_sum in d_sum.chunks_exact(out_channels) {
                db.iter_mut()
                    .zip(d_sum)
                    .for_each(|(db, d_sum)| *db += d_sum);
            }

            let len_of_weights = logits.len_of_weights(input.adjacency, rows.clone());
            let mut weights = workspace.scratch(len_of_weights);
            let mut d_weights = workspace.zeros(len_of_weights);
            workspace.instructions().run(AggregateTile {
                attention,
                input,
                first_row: rows.start,
                weights: &mut weights,
                z,
            });
            let d_sums = MatrixRef::new(d_sum, rows.len(), out_channels);
            MatrixMut::new(self.dw, depth, out_channels)
                .add_product(MatrixRef::new(z, rows.len(), depth).transposed(), d_sums);
            // The aggregates are done with: their gradients take their place.
            let w = MatrixRef::new(w, depth, out_channels);
            MatrixMut::new(z, rows.len(), depth).set_product(d_sums, w.transposed());

            let tile_slots;
            (tile_slots, slots) =
                slots.split_at_mut(tiles.num_slots_of(tile..tile + 1) * slot_stride);
            workspace.instructions().run(ScatterTile {
                attention,
                input,
                first_row: rows.start,
                weights: &weights,
                d_weights: &mut d_weights,
                dz: z,
                slots: tile_slots,
                slot_stride,
                dc,
            });
        }
    }
}

/// Adds what a tile sends to the vertices that it sees to its slots.
struct ScatterTile<'a> {
    attention: Attention<'a>,
    input: &'a FeastInput<'a>,
    first_row: usize,
    weights: &'a [f32],
    d_weights: &'a mut [f32],
    dz: &'a [f32],
    slots: &'a mut [f32],
    slot_stride: usize,
    dc: &'a mut [f32],
}

impl Kernel for ScatterTile<'_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self {
            attention,
            input,
            first_row,
            weights,
            d_weights,
            dz,
            slots,
            slot_stride,
            dc,
        } = self;
        let in_channels = input.in_channels();
        let stride = attention.stride;
        let first_logit = slot_stride - stride;
        let mut first_edge = 0;
        for (row, dz) in dz
            .chunks_exact(attention.num_heads * in_channels)
            .enumerate()
        {
            let edges = input.adjacency.edges(first_row + row);
            let slot_of_edge = input.adjacency.tiles().slots_of_edges(edges);
            let neighbors = input.adjacency.neighbors(first_row + row);
            let heads = first_edge * stride..(first_edge + neighbors.len()) * stride;
            let (weights, d_weights) = (&weights[heads.clone()], &mut d_weights[heads]);
            let mut slot_rows = SlotRows {
                values: slots,
                stride: slot_stride,
                slot_of_edge,
            };
            aggregate_backward::<V>(
                input.features,
                neighbors,
                attention.view(weights),
                dz,
                d_weights,
                &mut slot_rows,
            );

            // A logit is the product of the neighbor less that of the vertex, plus the offset.
            let own_slot = slot_of_edge[0] as usize * slot_stride + first_logit;
            if stride == V::LANES {
                let degree = neighbors.len() as f32;
                let mut sum = V::splat(0.0);
                for (edge, &slot) in slot_of_edge.iter().enumerate() {
                    let row = edge * V::LANES;
                    let (q, g) = (V::load(&weights[row..]), V::load(&d_weights[row..]));
                    let d_logit = Attention::logit_gradient(q, g, degree);
                    let slot = &mut slots[slot as usize * slot_stride + first_logit..];
                    V::load(slot).add(d_logit).store(slot);
                    sum = sum.add(d_logit);
                }
                let own = &mut slots[own_slot..];
                V::load(own).sub(sum).store(own);
                V::load(dc).add(sum).store(dc);
                first_edge += neighbors.len();
                continue;
            }
            attention.weigh_backward::<V>(weights, d_weights);
            for head in (0..stride).step_by(V::LANES) {
                let mut sum = V::splat(0.0);
                for (&slot, d_logits) in slot_of_edge.iter().zip(d_weights.chunks_exact(stride)) {
                    let d_logit = V::load(&d_logits[head..]);
                    let slot = &mut slots[slot as usize * slot_stride + first_logit + head..];
                    V::load(slot).add(d_logit).store(slot);
                    sum = sum.add(d_logit);
                }
                let own = &mut slots[own_slot + head..];
                V::load(own).sub(sum).store(own);
                V::load(&dc[head..]).add(sum).store(&mut dc[head..]);
            }
            first_edge += neighbors.len();
        }
    }
}

#[track_caller]
fn check_gradients(
    layer: &FeastLayer<'_>,
    input: &FeastInput<'_>,
    (y, dy): (&[f32], &[f32]),
    gradients: &FeastGradients<'_>,
) {
    input.check(layer);
    let num_vertices = input.adjacency.num_vertices();
    if layer.activation != Activation::None || !y.is_empty() {
        check::shape("y", y, num_vertices, layer.out_channels);
    }
    check::shape("dy", dy, num_vertices, layer.out_channels);
    assert!(
        gradients.features.len() == input.features.len(),
        "gradients of {} parts of the features, expected {}",
        gradients.features.len(),
        input.features.len()
    );
    for (part, gradient) in input.features.iter().zip(gradients.features.iter()) {
        if let Some(gradient) = gradient {
            check::shape(
                "gradient of features",
                gradient,
                num_vertices,
                part.channels,
            );
        }
    }
    if let Some(residual) = &gradients.residual {
        check::shape(
            "gradient of residual",
            residual,
            num_vertices,
            layer.out_channels,
        );
    }
    check::shape(
        "gradient of u",
        gradients.u,
        input.in_channels(),
        layer.num_heads,
    );
    check::shape("gradient of c", gradients.c, 1, layer.num_heads);
    check::shape(
        "gradient of w",
        gradients.w,
        layer.num_heads * input.in_channels(),
        layer.out_channels,
    );
    check::shape("gradient of b", gradients.b, 1, layer.out_channels);
}
