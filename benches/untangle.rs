//! Freeing the warped garment of penetrations, with the verification of the result.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use garnet::Warp;
use garnet_benches::{SIZES, Scene, group};
use garnet_untangle::{Binding, UntangleOptions, untangle};

fn bench_untangle(criterion: &mut Criterion) {
    let mut group = group(criterion, "untangle");
    for size in SIZES {
        let scene = Scene::new(size);
        let bound = scene.bound();
        let cloth = bound.cloth();
        let binding = Binding::new(cloth).expect("the tunic can be searched");
        let warped = cloth
            .warped_nodes(&scene.posed, Warp::Shape)
            .expect("the body is that of the tunic");
        let options = UntangleOptions::default();
        group.throughput(Throughput::Elements(cloth.rest_nodes().len() as u64));
        group.bench_function(BenchmarkId::new("untangle", size), |bencher| {
            bencher.iter(|| untangle(cloth, &binding, &scene.posed, &warped, &options));
        });
    }
    group.finish();
}

criterion_group!(benches, bench_untangle);
criterion_main!(benches);
