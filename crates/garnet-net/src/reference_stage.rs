//! The one scene on which networks are timed and compared.

use burn::optim::{AdamConfig, GradientsParams};
use burn::tensor::Device;
use garnet_mesh::primitives::{capsule, tube};
use garnet_mesh::{Point3, TriMesh, Vector3, vertex_normals};
use nalgebra::{Isometry3, UnitQuaternion};

use crate::{
    BodySampling, GarNet, GarNetConfig, GarmentGraph, NetError, Predictor, Scene, SceneInput,
    surrogate,
};

/// A tube around a capsule: a garment on a body, of any numbers of vertices.
#[derive(Debug)]
pub struct ReferenceStage {
    template: TriMesh,
    body: TriMesh,
    normals: Vec<Vector3>,
    rotations: Vec<UnitQuaternion<f32>>,
}

impl ReferenceStage {
    /// Of about as many vertices.
    pub fn new(num_vertices: usize, num_points: usize) -> Self {
        let [segments, meridians] =
            [num_vertices, num_points].map(|count| (count as f32).sqrt() as usize);
        let template = tube(0.22, 0.7, segments, num_vertices / segments - 1);
        let body = capsule(0.2, 0.8, meridians, meridians / 3);
        Self {
            normals: vertex_normals(body.positions(), body.faces()),
            rotations: vec![UnitQuaternion::identity(); template.num_vertices()],
            template,
            body,
        }
    }

    /// The garment at rest.
    pub fn template(&self) -> &TriMesh {
        &self.template
    }

    /// The body of the stage.
    pub fn body(&self) -> &TriMesh {
        &self.body
    }

    /// The garment as a teacher might put it: a little wider and lower.
    pub fn draped(&self) -> Vec<Point3> {
        let moved = |place: &Point3| Point3::new(1.04 * place.x, place.y - 0.01, 1.04 * place.z);
        self.template.positions().iter().map(moved).collect()
    }

    /// A new network of a completed configuration after some steps of Adam on one scene, each with
    /// derivatives of all weights and without losses; `after_step` is called after each.
    ///
    /// # Errors
    ///
    /// [`NetError`] for a configuration that is none.
    pub fn stepped(
        config: &GarNetConfig,
        (garment, sampling, scene): (&GarmentGraph, &BodySampling, &Scene),
        num_steps: usize,
        after_step: &mut dyn FnMut(),
    ) -> Result<GarNet, NetError> {
        let training = Device::flex().autodiff();
        let mut net = config.init(1, &training)?;
        let mut adam = AdamConfig::new().init();
        let pull = vec![1e-3; 3 * scene.num_vertices()];
        for _ in 0..num_steps {
            let output = net.forward(garment, sampling, scene, &training);
            let gradients = surrogate(output, pull.clone()).backward();
            let gradients = GradientsParams::from_grads(gradients, &net);
            // So small a rate that the constant pull does not drive the weights off: a network that
            // has diverged loses digits, and could not be compared with others.
            net = adam.step(1e-5, net, gradients);
            after_step();
        }
        Ok(net)
    }

    /// What a network of the configuration, which is completed, knows before any scene.
    ///
    /// # Panics
    ///
    /// If the stage has next to no vertices.
    pub fn bound(&self, config: GarNetConfig) -> (GarNetConfig, GarmentGraph, BodySampling) {
        let garment = GarmentGraph::new(&self.template, &[]).expect("the tube is a garment");
        let config = garment.configured(config);
        let (rest, template) = (self.body.positions(), self.template.positions());
        let sampling = BodySampling::for_garment(rest, template, &config);
        let sampling = sampling.expect("the body is near the garment");
        (config, garment, sampling)
    }

    /// A network with random weights, bound.
    ///
    /// # Panics
    ///
    /// If the configuration is not valid.
    pub fn predictor(&self, config: GarNetConfig) -> Predictor {
        let (config, garment, sampling) = self.bound(config);
        Predictor::untrained(&config, 1, garment, sampling).expect("the configuration is valid")
    }

    /// The scene as networks take it.
    pub fn input(&self) -> SceneInput<'_> {
        SceneInput {
            warped: self.template.positions(),
            body: self.body.positions(),
            body_normals: &self.normals,
            world_from_root: Isometry3::identity(),
            rotations: &self.rotations,
            parameters: &[],
        }
    }
}
