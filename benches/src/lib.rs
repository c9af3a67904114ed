//! The scene of the benches: a tunic on a striding mannequin, at growing numbers of vertices.
//!
//! The mannequin has about 13 000 vertices. The garment touches it at shoulders and armpits, and at
//! the thighs, so that real contacts are found and solved. Times are wall time of one operation on
//! all threads that rayon takes: `RAYON_NUM_THREADS` sets how many.

use std::time::Duration;

use criterion::{BenchmarkGroup, BenchmarkId, Criterion, SamplingMode, measurement::WallTime};
use garnet::{Body, BoundGarment, Garment, PosedBody};
use garnet_tests::{Tunic, mannequin, stride, tunic};

/// About how many vertices the garments have.
pub const SIZES: [usize; 4] = [2_500, 5_000, 10_000, 50_000];

/// About how many points the body of networks has.
pub const NUM_BODY_POINTS: usize = 6_890;

/// Spacing of the mannequin's vertices, in metres.
const SPACING: f32 = 0.0132;

/// A garment on a body, and the body's pose to drape it on.
#[derive(Debug)]
pub struct Scene {
    /// The garment.
    pub tunic: Tunic,
    /// The body at rest.
    pub body: Body,
    /// The body in the pose of [`stride`].
    pub posed: PosedBody,
}

impl Scene {
    /// A scene whose garment has about `num_vertices` vertices.
    ///
    /// # Panics
    ///
    /// Never: the pose is one of the mannequin.
    pub fn new(num_vertices: usize) -> Self {
        let body = mannequin(SPACING);
        let posed = body
            .posed(&stride())
            .expect("the pose has the joints of the mannequin");
        Self {
            tunic: tunic(num_vertices),
            body,
            posed,
        }
    }

    /// The garment, bound.
    ///
    /// # Panics
    ///
    /// Never: the tunic lies on the mannequin.
    pub fn bound(&self) -> BoundGarment {
        let garment = Garment::new(self.tunic.mesh.clone());
        garment
            .bind(&self.body)
            .expect("the tunic lies on the mannequin")
    }
}

/// A group that measures for a second or two an operation.
pub fn group<'a>(criterion: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(20);
    group.warm_up_time(Duration::from_millis(300));
    group.measurement_time(Duration::from_millis(1_500));
    group
}

/// Runs a bench in a pool of one and of two threads, for a second or so, or ten times; what it runs
/// on is made only for what the filter lets through.
///
/// # Panics
///
/// If no threads can be made.
pub fn on_threads<T: Send>(
    criterion: &mut Criterion,
    name: &str,
    id: &BenchmarkId,
    make: impl Fn() -> T + Sync,
    run: impl Fn(&mut T) + Sync,
) {
    for num_threads in [1, 2] {
        let mut group = criterion.benchmark_group(format!("{name}/{num_threads} threads"));
        group
            .sampling_mode(SamplingMode::Flat)
            .sample_size(10)
            .warm_up_time(Duration::from_millis(100))
            .measurement_time(Duration::from_millis(600));
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(num_threads)
            .build();
        let pool = pool.expect("threads can be made");
        let mut made = None;
        group.bench_function(id.clone(), |bencher| {
            pool.install(|| {
                let made = made.get_or_insert_with(&make);
                bencher.iter(|| run(made));
            });
        });
        group.finish();
    }
}
