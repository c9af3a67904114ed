//! Learned drapes: a network between the warp and the untangling.

use std::path::Path;

use garnet_net::{BodySampling, GarNetConfig, GarmentGraph, Model, ModelFile, Moment, SceneInput};
use garnet_skin::{Body, PosedBody, Warp, WarpedGarment};

use crate::draper::PutBy;
use crate::unfamiliar::{moving_joints, torn, unfamiliar};
use crate::{BoundGarment, Error, Unfamiliar, Warped};

/// A network bound to a garment and the body that it lies on.
///
/// It takes the place of [`Draper::warp`](crate::Draper::warp): what it gives is still to be
/// untangled.
#[derive(Debug)]
pub struct Network {
    model: Model,
    body: Body,
    /// Whether each joint moves the garment.
    moves: Vec<bool>,
}

/// What a network makes of a warped garment.
#[derive(Debug, Clone)]
pub struct Moved {
    /// Where the garment is.
    pub garment: Warped,
    /// Why it is where the warp by pose and shape has put it, and not where the network would.
    pub fallback: Option<Unfamiliar>,
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
        Self::bind(ModelFile::read(weights)?, garment, body, sewing_parameters)
    }

    /// The same for weights that were [read](ModelFile::read) while the garment was bound.
    ///
    /// # Errors
    ///
    /// As [`Network::load`].
    pub fn bind(
        weights: ModelFile,
        garment: &BoundGarment,
        body: &Body,
        sewing_parameters: &[f32],
    ) -> Result<Self, Error> {
        let mesh = garment.mesh();
        let graph = GarmentGraph::new(mesh, sewing_parameters)?;
        let rest = body.rest().positions();
        Ok(Self {
            model: Model::bind(weights, graph, mesh.positions(), rest)?,
            body: body.clone(),
            moves: moving_joints(&garment.cloth, body.skeleton().num_joints()),
        })
    }

    /// The moment at which it predicts the cloth. Before [`Moment::Arrival`] it takes the
    /// [body on its way](crate::BodyPath::posed); before [`Moment::Rest`]
    /// [`Teacher::settled`](crate::Teacher::settled) has to go on.
    pub fn moment(&self) -> Moment {
        self.model.moment()
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
            model: Model::untrained(&config, 1, graph, sampling)?,
            body: body.clone(),
            moves: moving_joints(&garment.cloth, body.skeleton().num_joints()),
        })
    }

    /// What the network starts from.
    pub fn warp(&self) -> Warp {
        self.model.warp()
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

    /// A warped garment, moved to where the network puts it; where the body is unlike those that the
    /// network was trained on, or the garment would be torn, to where the warp by pose and shape puts it. Bodies elsewhere than at
    /// rest are unlike them: [`PosedBody::at_home`].
    ///
    /// # Errors
    ///
    /// [`Error::Net`] for bodies with coordinates out of any range.
    pub fn moved(
        &mut self,
        garment: &BoundGarment,
        body: &PosedBody,
        warped: &WarpedGarment,
    ) -> Result<Moved, Error> {
        let parameters = self.body.pose_and_shape(body);
        let joints = self.body.skeleton().joints();
        let range = self.model.range();
        let unfamiliar =
            range.and_then(|range| unfamiliar(&range.excess(&parameters), joints, &self.moves));
        if let Some(reason) = unfamiliar {
            return Self::fallen_back(garment, body, reason);
        }
        let body_normals = if self.model.needs_body_normals() {
            body.vertex_normals()
        } else {
            Vec::new()
        };
        let moved = self.model.predict(&SceneInput {
            warped: &warped.positions,
            body: body.skin().positions(),
            body_normals: &body_normals,
            world_from_root: warped.world_from_root,
            rotations: &warped.rotations,
            parameters: &parameters,
        })?;
        let weld = garment.cloth.weld();
        let (before, after) = (weld.gather(&warped.positions), weld.gather(&moved));
        if let Some(reason) = torn(&garment.cloth, &before, &after) {
            return Self::fallen_back(garment, body, reason);
        }
        Ok(Moved {
            garment: Warped {
                nodes: after,
                put_by: PutBy::Network,
            },
            fallback: None,
        })
    }

    fn fallen_back(
        garment: &BoundGarment,
        body: &PosedBody,
        reason: Unfamiliar,
    ) -> Result<Moved, Error> {
        let nodes = garment.cloth.warped(body, Warp::Shape)?;
        Ok(Moved {
            garment: Warped {
                nodes,
                put_by: PutBy::Skinning,
            },
            fallback: Some(reason),
        })
    }
}
