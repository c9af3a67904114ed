//! What a network and its losses know before any scene.

use std::sync::{Arc, OnceLock};

use garnet_mesh::{Point3, TriMesh, Vector3};
use garnet_net::losses::{LossBody, LossConfig, LossTarget, Losses};
use garnet_net::{
    BodySampling, GarNetConfig, GarmentGraph, Moment, Scene, SceneInput, SceneNeighbors,
};
use garnet_skin::{Body, WarpedGarment};

use crate::network_input::{input_of, normals_of};
use crate::{SceneName, Stage, StagedScene, TrainError};

/// What a network and its losses know before any scene.
#[derive(Debug)]
pub(crate) struct TrainingContext {
    /// What the network is made of, with what the garment decides.
    pub(crate) config: GarNetConfig,
    pub(crate) sampling: BodySampling,
    pub(crate) losses: Losses,
    /// The moment at which the examples show the cloth.
    pub(crate) moment: Moment,
    body_faces: Vec<[u32; 3]>,
}

/// What training keeps of a scene; the rest is computed anew each time.
#[derive(Debug)]
pub(crate) struct Example {
    pub(crate) scene: SceneName,
    /// The sequence that the pose is from; empty if it is from none, or if the test has it, too.
    pub(crate) sequence: String,
    /// The garment at rest `[vertex]`, in metres.
    pub(crate) rest: Arc<[Point3]>,
    pub(crate) graph: GarmentGraph,
    pub(crate) warped: WarpedGarment,
    pub(crate) body: Vec<Point3>,
    /// Unit normals of the body `[body vertex]`, if the network asks for them.
    pub(crate) body_normals: Vec<Vector3>,
    /// Of shape and pose, whether the network asks for them or not.
    pub(crate) parameters: Vec<f32>,
    /// Where the simulator has the cloth `[vertex]`, in metres: what a model is to predict.
    pub(crate) draped: Vec<Point3>,
    /// Found when the scene is first prepared: the search takes longer than all other preparation.
    pub(crate) neighbors: OnceLock<Option<SceneNeighbors>>,
    /// The same of its mirror image.
    pub(crate) mirrored_neighbors: OnceLock<Option<SceneNeighbors>>,
}

/// An example as a step of training takes it.
#[derive(Debug)]
pub(crate) struct Prepared {
    pub(crate) scene: Scene,
    pub(crate) target: LossTarget,
    pub(crate) body: LossBody,
}

impl TrainingContext {
    /// Fits a configuration to the garment of a stage.
    pub(crate) fn new(
        stage: &Stage,
        mut config: GarNetConfig,
        loss: &LossConfig,
    ) -> Result<Self, TrainError> {
        let package = &stage.package;
        config.mean_edge_length = stage.template().graph.mean_edge_length();
        if config.has_body_parameters() {
            let joints = package.body.skeleton().num_joints();
            config.num_body_parameters = joints * Body::NUMBERS_A_JOINT;
        }
        Self::of_meshes(&package.mesh, package.body.rest(), config, loss)
    }

    /// Of a garment that lies on a body at rest, for a configuration that fits it.
    pub(crate) fn of_meshes(
        garment: &TriMesh,
        body: &TriMesh,
        config: GarNetConfig,
        loss: &LossConfig,
    ) -> Result<Self, TrainError> {
        config.validate()?;
        let (rest, template) = (body.positions(), garment.positions());
        Ok(Self {
            sampling: BodySampling::for_garment(rest, template, &config)?,
            losses: Losses::new(garment, loss)?,
            moment: Moment::Rest,
            body_faces: body.faces().to_vec(),
            config,
        })
    }

    /// What is kept of a scene.
    pub(crate) fn example(&self, staged: &StagedScene) -> Result<Example, TrainError> {
        let worn = &staged.worn;
        let graph = worn.graph.clone();
        let posed = staged.posed_for(self.moment)?;
        Ok(Example {
            scene: staged.name,
            sequence: staged.sequence.clone(),
            rest: Arc::clone(&worn.rest),
            graph: match self.config.num_sewing_parameters {
                0 => graph.with_sewing_parameters(&[])?,
                _ => graph,
            },
            warped: staged.warped(self.config.start.warp(), &posed)?,
            body: posed.skin().positions().to_vec(),
            body_normals: normals_of(&posed, self.config.needs_body_normals()),
            parameters: worn.body.pose_and_shape(&posed),
            draped: staged.cloth_at(self.moment)?.into_owned(),
            neighbors: OnceLock::new(),
            mirrored_neighbors: OnceLock::new(),
        })
    }

    /// The arrays of the network and what the losses compare with.
    pub(crate) fn prepared(&self, example: &Example) -> Result<Prepared, TrainError> {
        let body = TriMesh::new(example.body.clone(), self.body_faces.clone())?;
        let (config, graph, input) = (&self.config, &example.graph, example.input());
        let scene = match example.neighbors.get() {
            Some(Some(known)) => Scene::of_neighbors(config, graph, &self.sampling, &input, known)?,
            _ => Scene::new(config, graph, &self.sampling, &input)?,
        };
        example.neighbors.get_or_init(|| scene.neighbors());
        Ok(Prepared {
            scene,
            target: self.losses.target(&example.draped)?,
            body: LossBody::new(&body)?,
        })
    }
}

impl AsRef<Self> for Example {
    fn as_ref(&self) -> &Self {
        self
    }
}

impl Example {
    /// The scene as networks take it.
    pub(crate) fn input(&self) -> SceneInput<'_> {
        input_of(
            &self.warped,
            &self.body,
            &self.body_normals,
            &self.parameters,
        )
    }
}
