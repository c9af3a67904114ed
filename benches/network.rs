//! The network: each preset and each variant on garments of several sizes.

#![expect(
    clippy::unwrap_used,
    reason = "the inputs are generated and known to be sound"
)]

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use garnet_mesh::primitives::{capsule, tube};
use garnet_mesh::{TriMesh, Vector3, vertex_normals};
use garnet_net::{BodySampling, GarNetConfig, GarmentGraph, Predictor, SceneInput, Variant};
use nalgebra::{Isometry3, UnitQuaternion};

const SIZES: [usize; 4] = [2_500, 5_000, 10_000, 20_000];

/// A garment around a body of 6,890 points, ready to be predicted.
struct Stage {
    template: TriMesh,
    body: TriMesh,
    normals: Vec<Vector3>,
    rotations: Vec<UnitQuaternion<f32>>,
}

impl Stage {
    fn new(num_vertices: usize) -> Self {
        let segments = (num_vertices as f32).sqrt() as usize;
        let template = tube(0.22, 0.7, segments, num_vertices / segments - 1);
        let body = capsule(0.2, 0.8, 83, 27);
        Self {
            normals: vertex_normals(body.positions(), body.faces()),
            rotations: vec![UnitQuaternion::identity(); template.num_vertices()],
            template,
            body,
        }
    }

    fn predictor(&self, config: GarNetConfig) -> Predictor {
        let garment = GarmentGraph::new(&self.template, &[]).unwrap();
        let config = garment.configured(config);
        let (rest, template) = (self.body.positions(), self.template.positions());
        let sampling = BodySampling::for_garment(rest, template, &config).unwrap();
        Predictor::untrained(&config, 1, garment, sampling).unwrap()
    }

    fn input(&self) -> SceneInput<'_> {
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

/// Neighbors, features and network, as a drape has them.
fn predict(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("predict");
    group.sample_size(10);
    for size in SIZES {
        let stage = Stage::new(size);
        for preset in ["paper", "medium", "small", "light"] {
            let mut predictor = stage.predictor(GarNetConfig::preset(preset).unwrap());
            group.bench_function(BenchmarkId::new(preset, size), |bencher| {
                bencher.iter(|| predictor.predict(&stage.input()).unwrap());
            });
        }
    }
    group.finish();
}

/// The variants of the paper's size, the network alone.
fn variants(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("forward");
    group.sample_size(10);
    let stage = Stage::new(10_000);
    for (name, variant) in [
        ("naive", Variant::Naive),
        ("global", Variant::Global),
        ("local", Variant::Local),
    ] {
        let config = GarNetConfig::preset("paper")
            .unwrap()
            .with_variant(variant, 0);
        let mut predictor = stage.predictor(config);
        predictor.prepare(&stage.input()).unwrap();
        group.bench_function(BenchmarkId::new(name, 10_000), |bencher| {
            bencher.iter(|| predictor.translations());
        });
    }
    group.finish();
}

/// What is done once a garment.
fn bind(criterion: &mut Criterion) {
    let stage = Stage::new(10_000);
    let mut group = criterion.benchmark_group("bind network");
    group.sample_size(10);
    group.bench_function("small", |bencher| {
        let config = GarNetConfig::preset("small").unwrap();
        bencher.iter_batched(
            || config.clone(),
            |config| stage.predictor(config),
            BatchSize::SmallInput,
        );
    });
    group.finish();
}

criterion_group!(benches, predict, variants, bind);
criterion_main!(benches);
