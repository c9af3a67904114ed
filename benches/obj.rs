//! Reading and writing an OBJ, from bytes to bytes.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use garnet::io::ObjFile;
use garnet_benches::{SIZES, group};
use garnet_tests::tunic;

fn obj(criterion: &mut Criterion) {
    let mut group = group(criterion, "obj");
    for size in SIZES {
        let bytes = tunic(size).to_obj().into_bytes();
        let file = ObjFile::parse(bytes.clone(), "tunic.obj").expect("generated text is an OBJ");
        group.throughput(Throughput::Bytes(bytes.len() as u64));
        group.bench_function(BenchmarkId::new("read", size), |bencher| {
            bencher.iter(|| ObjFile::parse(bytes.clone(), "tunic.obj"));
        });
        group.bench_function(BenchmarkId::new("write", size), |bencher| {
            bencher.iter(|| file.bytes_with_positions(file.positions()));
        });
    }
    group.finish();
}

criterion_group!(benches, obj);
criterion_main!(benches);
