//! The matrices that a network takes, for whatever runs it.

use std::sync::Arc;

use garnet_kernel::{Adjacency, NeighborTable};

use crate::{BodySampling, GarNetConfig, GarmentGraph, Scene};

/// The matrices and tables of one scene.
#[derive(Debug)]
pub(crate) struct Inputs<'a, M> {
    pub(crate) adjacency: &'a Arc<Adjacency>,
    pub(crate) averaged: &'a Arc<NeighborTable>,
    pub(crate) nearest: Option<&'a Arc<NeighborTable>>,
    /// `[vertex, 3]`.
    pub(crate) vertices: M,
    /// `[vertex, feature]`, if there are any.
    pub(crate) features: Option<M>,
    points: Option<M>,
    normals: Option<M>,
    parameters: Option<M>,
}

impl<'a, M> Inputs<'a, M> {
    /// Makes matrices of the arrays of a scene.
    pub(crate) fn new(
        config: &GarNetConfig,
        garment: &'a GarmentGraph,
        sampling: &'a BodySampling,
        scene: &'a Scene,
        matrix: impl Fn(&[f32], usize) -> M,
    ) -> Self {
        let any = |values: &[f32], columns: usize| {
            (columns > 0 && !values.is_empty()).then(|| matrix(values, columns))
        };
        Self {
            adjacency: garment.rings(),
            averaged: sampling.averaged(),
            nearest: scene.nearest.as_ref(),
            vertices: matrix(&scene.vertices, 3),
            features: any(&scene.features, config.num_vertex_features()),
            points: any(&scene.body_points, 3),
            normals: any(&scene.body_normals, 3),
            parameters: any(&scene.parameters, config.num_body_parameters),
        }
    }

    /// Points and normals of the body.
    ///
    /// # Panics
    ///
    /// If the scene has no body points.
    pub(crate) fn body(&self) -> (&M, Option<&M>) {
        let points = self.points.as_ref();
        let points = points.expect("the scene was prepared for a network with a body stream");
        (points, self.normals.as_ref())
    }

    /// Parameters of shape and pose.
    ///
    /// # Panics
    ///
    /// If the scene has none.
    pub(crate) fn parameters(&self) -> &M {
        let parameters = self.parameters.as_ref();
        parameters.expect("the scene was prepared for a network with parameters")
    }
}
