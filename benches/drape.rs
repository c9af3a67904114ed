//! One drape as users wait for it: the whole way from bytes to bytes, and one more of a bound
//! garment.

use std::sync::atomic::AtomicBool;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use garnet::io::{ObjError, ObjFile};
use garnet::{Body, Draper, Error, Garment, Point3};
use garnet_benches::{SIZES, Scene, group};

/// Reads, binds, recovers the pose, warps, untangles, and writes.
fn whole(obj: &[u8], body: &Body, target: &[Point3]) -> Result<Vec<u8>, Error> {
    let file = ObjFile::parse(obj.to_vec(), "tunic.obj")?;
    let garment = Garment::new(file.mesh()?).bind(body)?;
    let drape = Draper::new(garment).drape(&body.fitted(target)?)?;
    let written: Result<_, ObjError> = file.bytes_with_positions(&drape.positions);
    Ok(written?)
}

fn drape(criterion: &mut Criterion) {
    let never = AtomicBool::new(false);
    let mut group = group(criterion, "drape");
    group.sample_size(10);
    for size in SIZES {
        let scene = Scene::new(size);
        let obj = scene.tunic.to_obj().into_bytes();
        let target = scene.posed.skin().positions();
        let draper = Draper::new(scene.bound());
        group.throughput(Throughput::Elements(scene.tunic.mesh.num_vertices() as u64));
        group.bench_function(BenchmarkId::new("whole", size), |bencher| {
            bencher.iter(|| whole(&obj, &scene.body, target));
        });
        group.bench_function(BenchmarkId::new("warp", size), |bencher| {
            bencher.iter(|| draper.place(&scene.posed, &never));
        });
        group.bench_function(BenchmarkId::new("bound", size), |bencher| {
            bencher.iter(|| draper.drape(&scene.posed));
        });
    }
    group.finish();
}

criterion_group!(benches, drape);
criterion_main!(benches);
