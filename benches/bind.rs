//! What is computed once for a garment, and once for a target body.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use garnet_benches::{SIZES, Scene, group};
use garnet_tests::stride;

fn bind(criterion: &mut Criterion) {
    let mut group = group(criterion, "bind");
    group.sample_size(10);
    for size in SIZES {
        let scene = Scene::new(size);
        group.throughput(Throughput::Elements(scene.tunic.mesh.num_vertices() as u64));
        group.bench_function(BenchmarkId::new("bind", size), |bencher| {
            bencher.iter(|| scene.bound());
        });
    }
    group.finish();
}

/// The body alone: these do not depend on the garment.
fn body(criterion: &mut Criterion) {
    let mut group = group(criterion, "body");
    let scene = Scene::new(SIZES[0]);
    let target = scene.posed.skin().positions();
    group.bench_function("posed", |bencher| {
        bencher.iter(|| scene.body.posed(&stride()));
    });
    group.bench_function("fitted", |bencher| {
        bencher.iter(|| scene.body.fitted(target));
    });
    group.finish();
}

criterion_group!(benches, bind, body);
criterion_main!(benches);
