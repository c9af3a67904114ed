//! A network from a file learns on as the one that was written.

use std::path::Path;

use burn::optim::{AdamConfig, GradientsParams, ModuleOptimizer};
use burn::tensor::{Bytes, Device};
use garnet_net::{
    BodySampling, Checkpoint, GarNet, GarNetConfig, GarmentGraph, Precision, ReferenceStage, Scene,
    surrogate,
};

/// One scene that pulls all vertices the same way.
struct Lesson {
    garment: GarmentGraph,
    sampling: BodySampling,
    scene: Scene,
    device: Device,
}

impl Lesson {
    fn new() -> (Self, GarNetConfig) {
        let stage = ReferenceStage::new(60, 80);
        let (config, garment, sampling) = stage.bound(GarNetConfig::preset("tiny").unwrap());
        let scene = Scene::new(&config, &garment, &sampling, &stage.input()).unwrap();
        let device = Device::flex().autodiff();
        let lesson = Self {
            garment,
            sampling,
            scene,
            device,
        };
        (lesson, config)
    }

    fn step(&self, adam: &mut ModuleOptimizer, net: GarNet) -> GarNet {
        let output = net.forward(&self.garment, &self.sampling, &self.scene, &self.device);
        let pull = vec![1e-3; 3 * self.scene.num_vertices()];
        let gradients = GradientsParams::from_grads(surrogate(output, pull).backward(), &net);
        adam.step(1e-3, net, gradients)
    }

    fn bytes(&self, model: &GarNet) -> Vec<u8> {
        let checkpoint = Checkpoint {
            model: model.clone(),
            garment: self.garment.fingerprint(),
            range: None,
            pose_space: None,
            record: serde_json::Value::Null,
            scores: std::collections::BTreeMap::new(),
        };
        let bytes = checkpoint.to_bytes(Path::new("on"), Precision::F32);
        bytes.unwrap()
    }

    fn loaded(&self, bytes: &[u8]) -> GarNet {
        let loaded = Checkpoint::from_bytes(Path::new("on"), bytes.to_vec(), &self.device);
        loaded.unwrap().model
    }
}

#[test]
fn a_loaded_network_learns_on_with_the_state_of_its_optimizer() {
    let (lesson, config) = Lesson::new();
    let mut adam = AdamConfig::new().init();
    let mut net = config.init(5, &lesson.device).unwrap();
    // The last layer starts at zero and lets no derivative through in the first step.
    for _ in 0..3 {
        net = lesson.step(&mut adam, net);
    }
    let (weights, moments) = (lesson.bytes(&net), adam.into_bytes().unwrap());
    let expected = lesson.bytes(&lesson.step(&mut adam, net));

    let adam = AdamConfig::new().init();
    let mut adam = adam
        .from_bytes(Bytes::from_bytes_vec(moments.to_vec()))
        .unwrap();
    let found = lesson.step(&mut adam, lesson.loaded(&weights));
    assert!(lesson.bytes(&found) == expected, "the step is another one");

    let mut forgetful = AdamConfig::new().init();
    let found = lesson.step(&mut forgetful, lesson.loaded(&weights));
    assert!(
        lesson.bytes(&found) != expected,
        "the moments count for nothing"
    );
}
