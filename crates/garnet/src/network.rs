//! Learned drapes: a network between the warp and the untangling.

use std::path::Path;

use garnet_net::{BodySampling, GarNetConfig, GarmentGraph, Predictor, SceneInput, Start, Variant};
use garnet_skin::{Body, PosedBody, Warp, WarpedGarment};

use crate::{BoundGarment, Error, Warped};

/// A network bound to a garment and the body that it lies on.
///
/// It takes the place of [`Draper::warp`](crate::Draper::warp): what it gives is still to be
/// untangled.
#[derive(Debug)]
pub struct Network {
    predictor: Predictor,
    body: Body,
}

impl Network {
    /// Reads the weights of a network that was trained for this garment.
    ///
    /// `sewing_parameters` are those of the garment in the order of their names; networks that do
    /// not ask for them leave them out.
    ///
    /// # Errors
    ///
    /// [`Error::Weights`] for a file that is truncated, altered, foreign, or of another garment;
    /// [`Error::Net`] for sewing parameters that are no numbers.
    pub fn load(
        weights: impl AsRef<Path>,
        garment: &BoundGarment,
        body: &Body,
        sewing_parameters: &[f32],
    ) -> Result<Self, Error> {
        let mesh = garment.mesh();
        let graph = GarmentGraph::new(mesh, sewing_parameters)?;
        let rest = body.rest().positions();
        Ok(Self {
            predictor: Predictor::load(weights, graph, mesh.positions(), rest)?,
            body: body.clone(),
        })
    }

    /// A network of a named size with random weights: it leaves the warp as it is, but takes as long
    /// as a trained one.
    ///
    /// # Errors
    ///
    /// [`Error::Net`] for a name that there is not.
    pub fn untrained(preset: &str, garment: &BoundGarment, body: &Body) -> Result<Self, Error> {
        let mesh = garment.mesh();
        let graph = GarmentGraph::new(mesh, &[])?;
        let config = graph.configured(GarNetConfig::preset(preset)?);
        let rest = body.rest().positions();
        let sampling = BodySampling::for_garment(rest, mesh.positions(), &config)?;
        Ok(Self {
            predictor: Predictor::untrained(&config, 1, graph, sampling)?,
            body: body.clone(),
        })
    }

    /// What the network starts from.
    pub fn warp(&self) -> Warp {
        match self.predictor.model().config().start {
            Start::DualQuaternion => Warp::DualQuaternion,
            Start::Shape => Warp::Shape,
        }
    }

    /// The garment warped to a posed body, as [`Network::moved`] takes it.
    ///
    /// # Errors
    ///
    /// [`Error::Skin`] if `body` is not of the body that the garment was bound to.
    pub fn warped(&self, garment: &BoundGarment, body: &PosedBody) -> Result<WarpedGarment, Error> {
        Ok(WarpedGarment::new(
            &garment.cloth,
            &self.body,
            body,
            self.warp(),
        )?)
    }

    /// A warped garment, moved to where the network puts it.
    ///
    /// # Errors
    ///
    /// [`Error::Net`] for bodies with coordinates out of any range.
    pub fn moved(
        &mut self,
        garment: &BoundGarment,
        body: &PosedBody,
        warped: &WarpedGarment,
    ) -> Result<Warped, Error> {
        let parameters = match self.predictor.model().config().variant {
            Variant::GlobalParams => self.body.pose_and_shape(body),
            _ => Vec::new(),
        };
        let moved = self.predictor.predict(&SceneInput {
            warped: &warped.positions,
            body: body.skin().positions(),
            body_normals: &warped.body_normals,
            world_from_root: warped.world_from_root,
            rotations: &warped.rotations,
            parameters: &parameters,
        })?;
        Ok(Warped::at(garment, &moved))
    }
}
