//! Moving the garment with the joints: dual-quaternion and linear blend skinning.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use garnet_benches::{SIZES, Scene, group};
use garnet_skin::{skin_dual_quaternion, skin_linear};

fn skinning(criterion: &mut Criterion) {
    let mut group = group(criterion, "skinning");
    for size in SIZES {
        let scene = Scene::new(size);
        let bound = scene.bound();
        let (rest, weights) = (bound.cloth().rest_nodes(), bound.cloth().weights());
        let transforms = scene.posed.posed_from_rest();
        group.throughput(Throughput::Elements(rest.len() as u64));
        group.bench_function(BenchmarkId::new("dual_quaternion", size), |bencher| {
            bencher.iter(|| skin_dual_quaternion(rest, weights, transforms));
        });
        group.bench_function(BenchmarkId::new("linear", size), |bencher| {
            bencher.iter(|| skin_linear(rest, weights, transforms));
        });
    }
    group.finish();
}

criterion_group!(benches, skinning);
criterion_main!(benches);
