//! The mesh convolution of FeaStNet.
//!
//! Verma, Boyer, Verbeek 2018, *FeaStNet: Feature-Steered Graph Convolutions for 3D Shape
//! Analysis*, equations 3 to 5, in the translation-invariant form (equation 8):
//!
//! ```text
//! y_i  = act(b + r_i + 1/|N_i| Σ_j Σ_m q_ijm x_j W_m)      j in N_i, i itself among them
//! q_ij = softmax_m(x_j U - x_i U + c)
//! ```
//!
//! with rows `x_i` and an optional residual `r`. The products `x U` are made once for each vertex.
//! A tile of vertices is aggregated for each head, `z_im = Σ_j q_ijm x_j / |N_i|`, and one matrix
//! product `z W` gives its outputs: the work is that of the product, and nothing is stored for each
//! edge.

use rayon::prelude::*;

use crate::adjacency_tiles::TILE_ROWS;
use crate::feast_aggregate::aggregate;
use crate::feast_attention::{Attention, Logits};
use crate::feast_columns::Columns;
use crate::instructions::Kernel;
use crate::lanes::Lanes;
use crate::matmul::{MatrixMut, MatrixRef};
use crate::{Activation, Adjacency, Features, Workspace, check};

/// Weights of a FeaStNet convolution.
///
/// With `torch_geometric.nn.FeaStConv`: `u` is `u.weight` transposed, `c` and `b` are `c` and
/// `bias`, and `w[m * in + k][o]` is `lin.weight[m * out + o][k]`.
#[derive(Debug, Clone, Copy)]
pub struct FeastLayer<'a> {
    /// Number of heads, `M`.
    pub num_heads: usize,
    /// Number of output channels.
    pub out_channels: usize,
    /// What steers the heads, `[in_channels, num_heads]`.
    pub u: &'a [f32],
    /// Offsets of the heads, `[num_heads]`.
    pub c: &'a [f32],
    /// Weights `W_m` one below the other, `[num_heads * in_channels, out_channels]`.
    pub w: &'a [f32],
    /// Bias, `[out_channels]`.
    pub b: &'a [f32],
    /// What is done to the sums.
    pub activation: Activation,
}

/// What a FeaStNet convolution is applied to.
#[derive(Debug, Clone, Copy)]
pub struct FeastInput<'a> {
    /// Who sees whom.
    pub adjacency: &'a Adjacency,
    /// Parts that make up the features of a vertex, each `[num_vertices, channels]`: the input
    /// channels of the layer are those of all parts in turn, and the concatenation is never formed.
    pub features: &'a [Features<'a>],
    /// Added before the activation, `[num_vertices, out_channels]`.
    pub residual: Option<&'a [f32]>,
}

impl FeastInput<'_> {
    /// Number of input channels of all parts.
    pub fn in_channels(&self) -> usize {
        self.features.iter().map(|part| part.channels).sum()
    }

    /// The order of the columns of aggregates.
    pub(crate) fn columns(&self, layer: &FeastLayer<'_>, workspace: &Workspace) -> Columns {
        let channels = self.features.iter().map(|part| part.channels);
        Columns::new(channels, layer.num_heads, workspace.instructions().lanes())
    }

    /// Asserts that input and layer fit.
    #[track_caller]
    pub(crate) fn check(&self, layer: &FeastLayer<'_>) {
        let (num_vertices, in_channels) = (self.adjacency.num_vertices(), self.in_channels());
        assert!(
            layer.num_heads > 0,
            "a FeaStNet layer needs one head at least"
        );
        assert!(
            layer.out_channels > 0,
            "a FeaStNet layer needs one output channel at least"
        );
        assert!(
            in_channels > 0,
            "a FeaStNet layer needs one input channel at least"
        );
        for part in self.features {
            part.check("features", num_vertices);
        }
        check::shape("u", layer.u, in_channels, layer.num_heads);
        check::shape("c", layer.c, 1, layer.num_heads);
        check::shape(
            "w",
            layer.w,
            layer.num_heads * in_channels,
            layer.out_channels,
        );
        check::shape("b", layer.b, 1, layer.out_channels);
        if let Some(residual) = self.residual {
            check::shape("residual", residual, num_vertices, layer.out_channels);
        }
    }
}

/// Writes the convolution to `y`, `[num_vertices, out_channels]`.
///
/// # Panics
///
/// Panics if the length of a slice does not fit the shapes given with the types.
pub fn feast_forward(
    layer: &FeastLayer<'_>,
    input: &FeastInput<'_>,
    y: &mut [f32],
    workspace: &Workspace,
) {
    input.check(layer);
    let adjacency = input.adjacency;
    let (in_channels, out_channels) = (input.in_channels(), layer.out_channels);
    check::shape("y", y, adjacency.num_vertices(), out_channels);
    let logits = Logits::new(layer, input.features, workspace);
    let depth = layer.num_heads * in_channels;
    let columns = input.columns(layer, workspace);
    let w = columns.ordered(layer.w, out_channels, workspace);
    let w = MatrixRef::new(&w, depth, out_channels);

    y.par_chunks_mut(TILE_ROWS * out_channels)
        .enumerate()
        .for_each(|(tile, y)| {
            let rows = adjacency.tiles().rows(tile);
            let mut z = workspace.scratch(rows.len() * depth);
            let mut weights = workspace.scratch(logits.len_of_weights(adjacency, rows.clone()));
            workspace.instructions().run(AggregateTile {
                attention: logits.attention(),
                input,
                first_row: rows.start,
                weights: &mut weights,
                z: &mut z,
            });

            for (row, y) in rows.clone().zip(y.chunks_exact_mut(out_channels)) {
                match input.residual {
                    None => y.copy_from_slice(layer.b),
                    Some(residual) => {
                        let residual = &residual[row * out_channels..][..out_channels];
                        y.iter_mut()
                            .zip(layer.b)
                            .zip(residual)
                            .for_each(|((y, b), r)| *y = b + r);
                    }
                }
            }
            MatrixMut::new(y, rows.len(), out_channels)
                .add_product(MatrixRef::new(&z, rows.len(), depth), w);
            layer.activation.apply(y);
        });
}

/// Weights of all edges and aggregates of all vertices of a tile.
pub(crate) struct AggregateTile<'a> {
    pub(crate) attention: Attention<'a>,
    pub(crate) input: &'a FeastInput<'a>,
    pub(crate) first_row: usize,
    /// `q / |N_i|`, a padded row of heads for each edge of the tile.
    pub(crate) weights: &'a mut [f32],
    /// `[rows of the tile, num_heads * in_channels]`, in the order of [`Columns`].
    pub(crate) z: &'a mut [f32],
}

impl Kernel for AggregateTile<'_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self {
            attention,
            input,
            first_row,
            weights,
            z,
        } = self;
        let in_channels = input.in_channels();
        let stride = attention.stride;
        let mut edge = 0;
        for (row, z) in z
            .chunks_exact_mut(attention.num_heads * in_channels)
            .enumerate()
        {
            let vertex = first_row + row;
            let neighbors = input.adjacency.neighbors(vertex);
            let weights = &mut weights[edge * stride..][..neighbors.len() * stride];
            attention.weigh::<V>(vertex, neighbors, weights);
            let mut column = 0;
            for part in input.features {
                let columns = column..column + part.channels;
                let sums = &mut z[columns.start * attention.num_heads..];
                aggregate::<V>(*part, neighbors, attention.view(weights), sums);
                column = columns.end;
            }
            edge += neighbors.len();
        }
    }
}
