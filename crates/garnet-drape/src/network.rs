//! Networks that predict where cloth is, bound to a garment.

use std::path::Path;
use std::sync::Arc;

use garnet_mesh::Point3;
use garnet_net::{GarmentGraph, Model, ModelFile, ReferenceCase, SceneInput};
use garnet_sim::Moment;
use garnet_skin::{Body, PosedBody, Warp, WarpedGarment};

use crate::familiar::Familiar;
use crate::unfamiliar::{moving_joints, torn};
use crate::{BoundGarment, Error, Unfamiliar};

/// A network bound to a garment and the body that it lies on.
///
/// It stands between warp and untangling of a [`Draper`](crate::Draper), and may be shared by
/// threads.
#[derive(Debug, Clone)]
pub struct Network {
    model: Arc<Model>,
    /// What the network is told of the garment, if it is another one than the model was bound to.
    graph: Option<Arc<GarmentGraph>>,
    body: Arc<Body>,
    /// Whether each joint moves the garment.
    moves: Vec<bool>,
}

/// Where a network predicts the cloth of a scene.
#[derive(Debug, Clone)]
pub enum Predicted {
    /// Positions `[vertex]` of the garment's mesh, in metres.
    At(Vec<Point3>),
    /// The same of a body that is unlike those of the training: predicted at the edge of what the
    /// network knows, and carried from there to the body. And what is the farthest outside.
    Beyond(Vec<Point3>, Unfamiliar),
    /// Nowhere: why the network is not to be trusted.
    Unfamiliar(Unfamiliar),
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
        sewing_parameters: &[f32],
    ) -> Result<Self, Error> {
        Self::bind(ModelFile::read(weights)?, garment, sewing_parameters)
    }

    /// The same for weights that were [read](ModelFile::read) while the garment was bound.
    ///
    /// # Errors
    ///
    /// As [`Network::load`].
    pub fn bind(
        weights: ModelFile,
        garment: &BoundGarment,
        sewing_parameters: &[f32],
    ) -> Result<Self, Error> {
        let mesh = garment.mesh();
        let graph = GarmentGraph::new(mesh, sewing_parameters)?;
        let rest = garment.body().rest().positions();
        let model = Model::bind(weights, graph, mesh.positions(), rest)?;
        Ok(Self::of_model(Arc::new(model), garment))
    }

    /// A model that was bound to this garment.
    pub fn of_model(model: Arc<Model>, garment: &BoundGarment) -> Self {
        let body = Arc::clone(garment.shared_body());
        Self {
            moves: moving_joints(garment.cloth(), body.skeleton().num_joints()),
            model,
            graph: None,
            body,
        }
    }

    /// A model that was bound to a garment of the same topology: another size, another body.
    ///
    /// # Errors
    ///
    /// [`Error::Net`] for a graph of another topology, or without the sewing parameters that the
    /// network asks for.
    pub fn for_size(
        model: Arc<Model>,
        garment: &BoundGarment,
        graph: GarmentGraph,
    ) -> Result<Self, Error> {
        let graph = Arc::new(model.accepted(graph)?);
        Ok(Self {
            graph: Some(graph),
            ..Self::of_model(model, garment)
        })
    }

    /// A network of a named size with random weights: it leaves the warp as it is, but takes as
    /// long as a trained one.
    ///
    /// # Errors
    ///
    /// [`Error::Net`] for a name that there is not.
    #[cfg(feature = "network")]
    pub fn untrained(preset: &str, garment: &BoundGarment) -> Result<Self, Error> {
        use garnet_net::{BodySampling, GarNetConfig};

        let mesh = garment.mesh();
        let graph = GarmentGraph::new(mesh, &[])?;
        let config = graph.configured(GarNetConfig::preset(preset)?);
        let rest = garment.body().rest().positions();
        let sampling = BodySampling::for_garment(rest, mesh.positions(), &config)?;
        let model = Model::untrained(&config, 1, graph, sampling)?;
        Ok(Self::of_model(Arc::new(model), garment))
    }

    /// Whether it has learned garments that are cut like this one, and is told so.
    pub fn knows_cut(&self) -> bool {
        self.model.knows_cut()
    }

    /// The moment at which it predicts the cloth.
    pub fn moment(&self) -> Moment {
        self.model.moment()
    }

    /// The warp that it starts from.
    pub fn warp(&self) -> Warp {
        self.model.warp()
    }

    /// The garment warped to a posed body, as [`Network::predict`] takes it.
    ///
    /// # Errors
    ///
    /// [`Error::Skin`] if `body` is not of the body that the garment was bound to.
    pub fn warped(&self, garment: &BoundGarment, body: &PosedBody) -> Result<WarpedGarment, Error> {
        let cloth = garment.cloth();
        Ok(WarpedGarment::new(cloth, &self.body, body, self.warp())?)
    }

    /// Predicts where a warped garment is; nowhere, if the garment would be torn. Of a body that is
    /// unlike those that the network was trained on, the joints that are too far outside go back
    /// to where the network knows them, and what it predicts there is laid on the warp of the body.
    /// Bodies elsewhere than at rest are unlike them: [`PosedBody::at_home`].
    ///
    /// # Errors
    ///
    /// [`Error::Net`] for bodies with coordinates out of any range; [`Error::Skin`] if `body` is
    /// not of the body that the garment was bound to.
    pub fn predict(
        &self,
        garment: &BoundGarment,
        body: &PosedBody,
        warped: &WarpedGarment,
    ) -> Result<Predicted, Error> {
        let familiar = match self.model.range() {
            Some(range) => Familiar::near(range, &self.body, body, &self.moves)?,
            None => None,
        };
        let (predicted, reason) = match familiar {
            None => (self.asked(body, warped)?, None),
            Some(Familiar { body: near, reason }) => {
                let near_warped = self.warped(garment, &near)?;
                let predicted = self.asked(&near, &near_warped)?;
                (carried(&predicted, &near_warped, warped), Some(reason))
            }
        };
        let weld = garment.cloth().weld();
        let (before, after) = (weld.gather(&warped.positions), weld.gather(&predicted));
        Ok(match (torn(garment.cloth(), &before, &after), reason) {
            (Some(torn), _) => Predicted::Unfamiliar(torn),
            (None, Some(reason)) => Predicted::Beyond(predicted, reason),
            (None, None) => Predicted::At(predicted),
        })
    }

    /// What the network is told of a body and what it says, for other implementations. A body that
    /// is unlike those of its training is the nearest one that it knows.
    ///
    /// # Errors
    ///
    /// As [`Network::predict`].
    pub fn case(&self, garment: &BoundGarment, body: &PosedBody) -> Result<ReferenceCase, Error> {
        let near = match self.model.range() {
            Some(range) => Familiar::near(range, &self.body, body, &self.moves)?,
            None => None,
        };
        let body = near.as_ref().map_or(body, |familiar| &familiar.body);
        let warped = self.warped(garment, body)?;
        self.told(body, &warped, |input| {
            Ok(self.model.case(self.graph.as_deref(), input)?)
        })
    }

    /// What the network says of a body.
    fn asked(&self, body: &PosedBody, warped: &WarpedGarment) -> Result<Vec<Point3>, Error> {
        self.told(body, warped, |input| {
            Ok(match &self.graph {
                Some(graph) => self.model.predict_on(graph, input)?,
                None => self.model.predict(input)?,
            })
        })
    }

    /// What `ask` makes of that which the network is told of a body.
    fn told<T>(
        &self,
        body: &PosedBody,
        warped: &WarpedGarment,
        ask: impl FnOnce(&SceneInput<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let parameters = self.body.pose_and_shape(body);
        let body_normals = if self.model.needs_body_normals() {
            body.vertex_normals()
        } else {
            Vec::new()
        };
        ask(&SceneInput {
            warped: &warped.positions,
            body: body.skin().positions(),
            body_normals: &body_normals,
            world_from_root: warped.world_from_root,
            rotations: &warped.rotations,
            parameters: &parameters,
        })
    }
}

/// What was predicted beside one warp, beside another one `[vertex]`: turned as the body turns the
/// cloth from the one to the other.
fn carried(predicted: &[Point3], from: &WarpedGarment, to: &WarpedGarment) -> Vec<Point3> {
    let carried = |vertex: usize| {
        let turn = to.rotations[vertex] * from.rotations[vertex].inverse();
        to.positions[vertex] + turn * (predicted[vertex] - from.positions[vertex])
    };
    (0..predicted.len()).map(carried).collect()
}
