//! The backward pass of linear layers.
//!
//! Gradients of inputs are products within tiles of rows. Each panel of the gradient of the weights
//! is a product over all rows, or, where there are few panels, a sum of products over fixed blocks
//! of rows. Of a broadcast part only the sum over rows matters, which is the gradient of the bias.

use rayon::prelude::*;

use crate::linear::TILE_ROWS;
use crate::matmul::{MatrixMut, MatrixRef};
use crate::reduce::{split_into_tiles, sum_rows};
use crate::{Activation, Features, LinearInput, LinearLayer, Workspace, check};

/// Input channels whose weight gradients are one product.
const PANEL_CHANNELS: usize = 256;

/// As many products at least, if there are rows enough: work for several threads.
const MIN_PRODUCTS: usize = 8;

/// Rows of a block at least, so that its product is more work than adding it up.
const MIN_BLOCK_ROWS: usize = 512;

/// Gradients of a linear layer; what is there before is overwritten.
#[derive(Debug)]
pub struct LinearGradients<'a> {
    /// Of each part of the input, where it is wanted: `[rows, channels]`, or `[channels]` of a
    /// broadcast part.
    pub parts: &'a mut [Option<&'a mut [f32]>],
    /// `[in_channels, out_channels]`.
    pub w: &'a mut [f32],
    /// `[out_channels]`, if it is wanted.
    pub b: Option<&'a mut [f32]>,
}

/// Computes all gradients from the output `y` of [`linear_forward`](crate::linear_forward) and its
/// gradient `dy`.
///
/// `y` is read only where the layer has an activation; it may be empty else.
///
/// # Panics
///
/// Panics if the length of a slice does not fit the shapes given with the types.
pub fn linear_backward(
    layer: &LinearLayer<'_>,
    parts: &[LinearInput<'_>],
    (y, dy): (&[f32], &[f32]),
    gradients: &mut LinearGradients<'_>,
    workspace: &Workspace,
) {
    let out_channels = layer.out_channels;
    check_gradients(layer, parts, (y, dy), gradients);
    let rows = dy.len() / out_channels;
    let num_tiles = rows.div_ceil(TILE_ROWS);

    // Gradients of the sums before the activation: `dy` itself where there is none.
    let mut own_d_sum = workspace.scratch(if layer.activation == Activation::None {
        0
    } else {
        dy.len()
    });
    let mut db_of_tiles = workspace.zeros(num_tiles * out_channels);
    let channels: Vec<usize> = parts.iter().map(LinearInput::channels).collect();
    let mut per_row: Vec<Option<&mut [f32]>> = (parts.iter().zip(gradients.parts.iter_mut()))
        .map(|(part, gradient)| match part {
            LinearInput::PerRow(_) => gradient.as_deref_mut(),
            LinearInput::Broadcast(_) => None,
        })
        .collect();
    let dx_of_tiles = split_into_tiles(&mut per_row, &channels, TILE_ROWS, num_tiles);
    let mut d_sum_of_tiles = own_d_sum.chunks_mut(TILE_ROWS * out_channels);
    let tiles: Vec<_> = (dx_of_tiles
        .into_iter()
        .zip(db_of_tiles.chunks_exact_mut(out_channels)))
    .map(|(dx, db)| (dx, db, d_sum_of_tiles.next()))
    .collect();
    tiles
        .into_par_iter()
        .enumerate()
        .for_each(|(tile, (dx, db, own_d_sum))| {
            let outputs = tile * TILE_ROWS * out_channels
                ..dy.len().min((tile + 1) * TILE_ROWS * out_channels);
            let dy = &dy[outputs.clone()];
            let d_sum = match own_d_sum {
                None => dy,
                Some(d_sum) => {
                    layer.activation.gradient(&y[outputs], dy, d_sum);
                    d_sum
                }
            };
            for d_sum in d_sum.chunks_exact(out_channels) {
                db.iter_mut()
                    .zip(d_sum)
                    .for_each(|(db, d_sum)| *db += d_sum);
            }
            let d_sum = MatrixRef::new(d_sum, dy.len() / out_channels, out_channels);
            for ((part, w), dx) in layer.parts(parts).zip(dx) {
                if let Some(dx) = dx {
                    MatrixMut::new(dx, dy.len() / out_channels, part.channels())
                        .set_product(d_sum, w.transposed());
                }
            }
        });

    let mut db = workspace.scratch(out_channels);
    sum_rows(&db_of_tiles, &mut db);
    let d_sum = if layer.activation == Activation::None {
        dy
    } else {
        &own_d_sum
    };
    let d_sum = MatrixRef::new(d_sum, rows, out_channels);
    gradient_of_weights(parts, d_sum, &db, gradients.w, workspace);
    for ((part, w), gradient) in layer.parts(parts).zip(gradients.parts.iter_mut()) {
        if let (LinearInput::Broadcast(_), Some(gradient)) = (part, gradient) {
            MatrixMut::new(gradient, part.channels(), 1)
                .set_product(w, MatrixRef::new(&db, out_channels, 1));
        }
    }
    if let Some(b) = &mut gradients.b {
        b.copy_from_slice(&db);
    }
}

/// A panel of the gradient of the weights: some input channels of one part, over a block of rows.
struct Panel<'a> {
    part: Features<'a>,
    first_channel: usize,
    first_row: usize,
    dw: &'a mut [f32],
}

/// Writes the gradient of the weights, in as many products as there is work for.
fn gradient_of_weights(
    parts: &[LinearInput<'_>],
    d_sum: MatrixRef<'_>,
    db: &[f32],
    dw: &mut [f32],
    workspace: &Workspace,
) {
    let (rows, _) = d_sum.shape();
    let panels = parts.iter().map(|part| match part {
        LinearInput::PerRow(part) => part.channels.div_ceil(PANEL_CHANNELS),
        LinearInput::Broadcast(_) => 0,
    });
    let num_blocks = MIN_PRODUCTS.div_ceil(panels.sum::<usize>().max(1));
    let block_rows = rows.div_ceil(num_blocks).max(MIN_BLOCK_ROWS);
    if rows <= block_rows {
        gradients_of_weights(parts, d_sum, block_rows, db, dw);
    } else {
        let mut dw_of_blocks = workspace.scratch(rows.div_ceil(block_rows) * dw.len());
        gradients_of_weights(parts, d_sum, block_rows, db, &mut dw_of_blocks);
        sum_rows(&dw_of_blocks, dw);
    }
}

/// Writes one gradient of the weights for each block of rows, one after the other.
fn gradients_of_weights(
    parts: &[LinearInput<'_>],
    d_sum: MatrixRef<'_>,
    block_rows: usize,
    db: &[f32],
    dw_of_blocks: &mut [f32],
) {
    let (rows, out_channels) = d_sum.shape();
    let len: usize = parts.iter().map(LinearInput::channels).sum::<usize>() * out_channels;
    let mut panels = Vec::new();
    for (block, mut left) in dw_of_blocks.chunks_mut(len.max(1)).enumerate() {
        for part in parts {
            let dw;
            (dw, left) = left.split_at_mut(part.channels() * out_channels);
            match part {
                LinearInput::Broadcast(_) if block > 0 => dw.fill(0.0),
                LinearInput::Broadcast(vector) => {
                    for (dw, x) in dw.chunks_exact_mut(out_channels).zip(*vector) {
                        dw.iter_mut().zip(db).for_each(|(dw, db)| *dw = x * db);
                    }
                }
                LinearInput::PerRow(part) => {
                    let chunks = dw.chunks_mut(PANEL_CHANNELS * out_channels).enumerate();
                    panels.extend(chunks.map(|(panel, dw)| Panel {
                        part: *part,
                        first_channel: panel * PANEL_CHANNELS,
                        first_row: block * block_rows,
                        dw,
                    }));
                }
            }
        }
    }
    panels.into_par_iter().for_each(
        |Panel {
             part,
             first_channel,
             first_row,
             dw,
         }| {
            let channels = dw.len() / out_channels;
            if rows == 0 {
                dw.fill(0.0);
                return;
            }
            let num_rows = block_rows.min(rows - first_row);
            let first = first_row * part.channels + first_channel;
            let x = MatrixRef::strided(&part.values[first..], num_rows, channels, part.channels);
            let d_sum = d_sum.rows(first_row..first_row + num_rows);
            MatrixMut::new(dw, channels, out_channels).set_product(x.transposed(), d_sum);
        },
    );
}

#[track_caller]
fn check_gradients(
    layer: &LinearLayer<'_>,
    parts: &[LinearInput<'_>],
    (y, dy): (&[f32], &[f32]),
    gradients: &LinearGradients<'_>,
) {
    let rows = dy.len() / layer.out_channels.max(1);
    layer.check(parts, rows);
    check::shape("dy", dy, rows, layer.out_channels);
    if layer.activation != Activation::None || !y.is_empty() {
        check::shape("y", y, rows, layer.out_channels);
    }
    check::shape(
        "gradient of w",
        gradients.w,
        layer.w.len() / layer.out_channels,
        layer.out_channels,
    );
    if let Some(b) = &gradients.b {
        check::shape("gradient of b", b, 1, layer.out_channels);
    }
    assert!(
        gradients.parts.len() == parts.len(),
        "gradients of {} parts of the input, expected {}",
        gradients.parts.len(),
        parts.len()
    );
    for (part, gradient) in parts.iter().zip(gradients.parts.iter()) {
        let rows = if matches!(part, LinearInput::PerRow(_)) {
            rows
        } else {
            1
        };
        if let Some(gradient) = gradient {
            check::shape("gradient of a part", gradient, rows, part.channels());
        }
    }
}
