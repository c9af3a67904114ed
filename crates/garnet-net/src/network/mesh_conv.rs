//! Mesh convolutions and the residual blocks of them.

use std::sync::Arc;

use burn::module::{Module, Param};
use burn::tensor::Tensor;
use garnet_kernel::{Activation, Adjacency};

use super::shared_mlp::SharedLinear;
use super::weights::WeightSource;
use crate::ops::{Engine, Op};
use crate::{GarNetConfig, UNIT};

/// What all convolutions of a garment share.
#[derive(Debug)]
pub(crate) struct Mesh<'a, M> {
    /// Who sees whom.
    pub(crate) adjacency: &'a Arc<Adjacency>,
    /// Places of the vertices `[vertex, 3]`, in units.
    pub(crate) places: &'a M,
    /// One over the mean edge length in units.
    pub(crate) scale: f32,
}

impl<'a, M> Mesh<'a, M> {
    pub(crate) fn new(config: &GarNetConfig, adjacency: &'a Arc<Adjacency>, places: &'a M) -> Self {
        Self {
            adjacency,
            places,
            scale: UNIT / config.mean_edge_length,
        }
    }
}

/// A convolution of FeaStNet whose input is joined with the places of the vertices.
///
/// ```text
/// y_i = b + 1/|N_i| Σ_j Σ_m q_m(x_i, x_j) W_m x_j,   q = softmax_m(u_m · (x_j − x_i) + c_m)
/// ```
///
/// Differences of places are divided by the mean edge length before they weigh neighbors: in
/// units, let alone metres, they are so small that q would be the same for all.
///
/// Source: *Verma et al. 2018; Gundogdu et al. 2020, section 3.5*.
#[derive(Module, Debug)]
pub(crate) struct MeshConv {
    /// `[channels + 3, heads]`; the places are last.
    pub(crate) u: Param<Tensor<2>>,
    /// `[heads]`.
    pub(crate) c: Param<Tensor<1>>,
    /// `[heads * (channels + 3), out]`.
    pub(crate) w: Param<Tensor<2>>,
    /// `[out]`.
    pub(crate) b: Param<Tensor<1>>,
}

impl MeshConv {
    pub(crate) fn new(
        inputs: usize,
        outputs: usize,
        heads: usize,
        source: &mut WeightSource,
    ) -> Self {
        let channels = inputs + 3;
        // Variance is kept where a single head counts, and lessened where all count alike. Scaled
        // for the latter, features grow from block to block as soon as heads are told apart, which
        // tells them apart the more: a new network of the paper's size then loses all but two
        // digits.
        let deviation = (1.0 / channels as f32).sqrt();
        Self {
            u: source.normal([channels, heads], (1.0 / channels as f32).sqrt()),
            c: source.zeros(heads),
            w: source.normal([heads * channels, outputs], deviation),
            b: source.zeros(outputs),
        }
    }

    /// Convolves, adds the residual, and activates.
    ///
    /// # Shapes
    ///
    /// - `features`: `[vertex, channels]`
    /// - `residual`, output: `[vertex, out]`
    pub(crate) fn forward<E: Engine>(
        &self,
        engine: &E,
        mesh: &Mesh<'_, E::Matrix>,
        features: &E::Matrix,
        residual: Option<&E::Matrix>,
    ) -> E::Matrix {
        let u = engine.with_scaled_rows(&engine.weights(&self.u), 3, mesh.scale);
        let c = engine.weights(&self.c);
        let w = engine.weights(&self.w);
        let b = engine.weights(&self.b);
        let mut inputs = vec![features, mesh.places, &u, &c, &w, &b];
        inputs.extend(residual);
        let op = Op::Feast {
            adjacency: Arc::clone(mesh.adjacency),
            has_residual: residual.is_some(),
            activation: Activation::LeakyRelu,
        };
        engine.call(op, &inputs)
    }
}

/// Convolutions with a shortcut around them.
///
/// Source: *Gundogdu et al. 2020, figure 4*.
#[derive(Module, Debug)]
pub(crate) struct ResidualBlock {
    convolutions: Vec<MeshConv>,
    /// Where widths differ, the shortcut changes them.
    shortcut: Option<SharedLinear>,
}

impl ResidualBlock {
    pub(crate) fn new(
        config: &GarNetConfig,
        [inputs, outputs]: [usize; 2],
        source: &mut WeightSource,
    ) -> Self {
        let heads = config.garment.heads;
        let conv = |number, source: &mut WeightSource| {
            let inputs = if number == 0 { inputs } else { outputs };
            MeshConv::new(inputs, outputs, heads, source)
        };
        Self {
            convolutions: (0..config.garment.convolutions)
                .map(|number| conv(number, source))
                .collect(),
            shortcut: (inputs != outputs).then(|| SharedLinear::new(inputs, outputs, source)),
        }
    }

    /// Convolves and adds the shortcut before the last activation.
    ///
    /// # Shapes
    ///
    /// - `features`: `[vertex, in]`
    /// - output: `[vertex, out]`
    pub(crate) fn forward<E: Engine>(
        &self,
        engine: &E,
        mesh: &Mesh<'_, E::Matrix>,
        features: &E::Matrix,
    ) -> E::Matrix {
        let shortcut = match &self.shortcut {
            Some(layer) => layer.forward(engine, &[features], Activation::None),
            None => features.clone(),
        };
        let last = self.convolutions.len() - 1;
        let convolutions = self.convolutions.iter().enumerate();
        convolutions.fold(features.clone(), |features, (number, convolution)| {
            let residual = (number == last).then_some(&shortcut);
            convolution.forward(engine, mesh, &features, residual)
        })
    }
}
