//! Queries of all garment vertices against a body: nearest vertices, closest points, crossings.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use garnet_benches::{SIZES, Scene, group};
use garnet_knn::{Surface, VertexTree};

/// Neighbours that the network's body stream asks for.
const NUM_NEIGHBORS: usize = 15;

fn proximity(criterion: &mut Criterion) {
    let mut group = group(criterion, "proximity");
    for size in SIZES {
        let Scene { tunic, posed, .. } = Scene::new(size);
        let points = tunic.mesh.positions();
        let skin = posed.skin();
        let tree = VertexTree::new(skin.positions()).expect("a skin is finite");
        let cloth = Surface::new(&tunic.mesh);
        group.throughput(Throughput::Elements(points.len() as u64));
        group.bench_function(BenchmarkId::new("k_nearest", size), |bencher| {
            bencher.iter(|| tree.k_nearest_all(points, NUM_NEIGHBORS));
        });
        group.bench_function(BenchmarkId::new("closest", size), |bencher| {
            bencher.iter(|| skin.closest_all(points));
        });
        group.bench_function(BenchmarkId::new("contains", size), |bencher| {
            bencher.iter(|| skin.contains_all(points));
        });
        group.bench_function(BenchmarkId::new("intersections", size), |bencher| {
            bencher.iter(|| cloth.intersections(skin));
        });
        group.bench_function(BenchmarkId::new("build", size), |bencher| {
            bencher.iter(|| Surface::new(&tunic.mesh));
        });
    }
    group.finish();
}

criterion_group!(benches, proximity);
criterion_main!(benches);
