//! Kernels of the network, forward and backward, on one and two threads, beside a plain matrix product.
//!
//! The throughput is that of the multiplications and additions of the matrix products alone ("Gelem/s" are
//! GFLOP/s). `kernel/product` is the measure of `kernel/feast_forward`: 80 % of its rate is the bar.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use garnet_kernel::{
    Activation, Adjacency, FeastGradients, FeastInput, FeastLayer, Features, LinearGradients,
    LinearInput, LinearLayer, NeighborTable, Workspace, feast_backward, feast_forward,
    global_max_forward, linear_backward, linear_forward, neighbor_max_backward,
    neighbor_max_forward, neighbor_mean_backward, neighbor_mean_forward,
};

/// Vertices of the grids.
const SIZES: [usize; 4] = [2_500, 5_000, 10_000, 20_000];

const CHANNELS: usize = 128;
const NUM_HEADS: usize = 8;

/// Numbers in `[-1, 1)`, the same in each run.
fn numbers(len: usize) -> Vec<f32> {
    let mut state = 1_u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 8_388_608.0 - 1.0
    };
    (0..len).map(|_| next()).collect()
}

/// The one-rings of a grid of 50 columns, six neighbors a vertex inside.
fn grid(num_vertices: usize) -> Adjacency {
    let columns = 50;
    let faces: Vec<[u32; 3]> = (0..(num_vertices - columns) as u32)
        .filter(|vertex| vertex % columns as u32 != columns as u32 - 1)
        .flat_map(|v| {
            let below = v + columns as u32;
            [[v, v + 1, below], [v + 1, below + 1, below]]
        })
        .collect();
    Adjacency::from_faces(num_vertices, &faces).expect("the grid is valid")
}

/// Runs a bench in a pool of one and of two threads.
fn on_threads(
    criterion: &mut Criterion,
    name: &str,
    size: usize,
    flop: usize,
    mut run: impl FnMut() + Send,
) {
    let mut group = criterion.benchmark_group(format!("kernel/{name}"));
    group
        .throughput(Throughput::Elements(flop as u64))
        .sample_size(20);
    for num_threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(num_threads)
            .build();
        let pool = pool.expect("threads can be made");
        let id = BenchmarkId::new(format!("{num_threads} threads"), size);
        group.bench_function(id, |bencher| pool.install(|| bencher.iter(&mut run)));
    }
    group.finish();
}

/// A product of 10000 x 1152 by 1152 x 128 with all threads of the pool.
fn product(criterion: &mut Criterion) {
    let (rows, depth, columns) = (10_000, 1_152, 128);
    let (a, b) = (numbers(rows * depth), numbers(depth * columns));
    let mut c = vec![0.0; rows * columns];
    on_threads(
        criterion,
        "product",
        rows,
        2 * rows * depth * columns,
        || {
            let c = MatMut::from_row_major_slice_mut(&mut c, rows, columns);
            let a = MatRef::from_row_major_slice(&a, rows, depth);
            let b = MatRef::from_row_major_slice(&b, depth, columns);
            matmul(black_box(c), Accum::Replace, a, b, 1.0, Par::rayon(0));
        },
    );
}

/// `FeaStNet` convolution of 128 to 128 channels with 8 heads.
fn feast(criterion: &mut Criterion) {
    for size in SIZES {
        let adjacency = grid(size);
        let x = numbers(size * CHANNELS);
        let dy = numbers(size * CHANNELS);
        let (u, c) = (numbers(CHANNELS * NUM_HEADS), numbers(NUM_HEADS));
        let (w, b) = (numbers(NUM_HEADS * CHANNELS * CHANNELS), numbers(CHANNELS));
        let layer = FeastLayer {
            num_heads: NUM_HEADS,
            out_channels: CHANNELS,
            u: &u,
            c: &c,
            w: &w,
            b: &b,
            activation: Activation::LeakyRelu,
        };
        let features = [Features::new(&x, CHANNELS)];
        let input = FeastInput {
            adjacency: &adjacency,
            features: &features,
            residual: None,
        };
        let workspace = Workspace::new();
        let flop = 2 * size * w.len();

        let mut y = vec![0.0; size * CHANNELS];
        on_threads(criterion, "feast_forward", size, flop, || {
            feast_forward(&layer, &input, &mut y, &workspace);
        });
        let (mut dx, mut du, mut dc) = (x.clone(), u.clone(), c.clone());
        let (mut dw, mut db) = (w.clone(), b.clone());
        on_threads(criterion, "feast_backward", size, 2 * flop, || {
            let mut gradients = FeastGradients {
                features: &mut [Some(&mut dx)],
                residual: None,
                u: &mut du,
                c: &mut dc,
                w: &mut dw,
                b: &mut db,
            };
            feast_backward(&layer, &input, (&y, &dy), &mut gradients, &workspace);
        });
    }
}

/// The first fusion layer: 704 channels of the vertex and 1024 of the whole scene to 512.
fn linear(criterion: &mut Criterion) {
    let (own, global, out) = (704, 1_024, 512);
    for size in SIZES {
        let (x, scene, dy) = (numbers(size * own), numbers(global), numbers(size * out));
        let (w, b) = (numbers((own + global) * out), numbers(out));
        let activation = Activation::LeakyRelu;
        let layer = LinearLayer {
            out_channels: out,
            w: &w,
            b: Some(&b),
            activation,
        };
        let parts = [
            LinearInput::PerRow(Features::new(&x, own)),
            LinearInput::Broadcast(&scene),
        ];
        let workspace = Workspace::new();
        let flop = 2 * size * own * out;

        let mut y = vec![0.0; size * out];
        on_threads(criterion, "linear_forward", size, flop, || {
            linear_forward(&layer, &parts, &mut y, &workspace);
        });
        let (mut dx, mut d_scene) = (x.clone(), scene.clone());
        let (mut dw, mut db) = (w.clone(), b.clone());
        on_threads(criterion, "linear_backward", size, 2 * flop, || {
            let mut gradients = LinearGradients {
                parts: &mut [Some(&mut dx), Some(&mut d_scene)],
                w: &mut dw,
                b: Some(&mut db),
            };
            linear_backward(&layer, &parts, (&y, &dy), &mut gradients, &workspace);
        });
    }
}

/// Pooling of 128 channels over 15 and 16 of 689 body points, and over all vertices.
fn pooling(criterion: &mut Criterion) {
    let num_points = 689;
    for size in SIZES {
        let table = |k: usize| {
            let neighbors = (0..size * k)
                .map(|i| ((i / k * num_points / size + i % k * 7) % num_points) as u32);
            NeighborTable::new(num_points, k, neighbors.collect()).expect("points are in range")
        };
        let (nearest, averaged) = (table(15), table(16));
        let (x, dy) = (numbers(num_points * CHANNELS), numbers(size * CHANNELS));
        let (x, dy) = (Features::new(&x, CHANNELS), Features::new(&dy, CHANNELS));
        let (mut y, mut largest) = (vec![0.0; size * CHANNELS], vec![0; size * CHANNELS]);
        let mut dx = vec![0.0; num_points * CHANNELS];
        let workspace = Workspace::new();
        let terms = size * CHANNELS * 15;

        on_threads(criterion, "neighbor_max_forward", size, terms, || {
            neighbor_max_forward(&nearest, x, &mut y, &mut largest, &workspace);
        });
        on_threads(criterion, "neighbor_max_backward", size, terms, || {
            neighbor_max_backward(&nearest, &largest, dy, &mut dx, &workspace);
        });
        on_threads(criterion, "neighbor_mean_forward", size, terms, || {
            neighbor_mean_forward(&averaged, x, &mut y, &workspace);
        });
        on_threads(criterion, "neighbor_mean_backward", size, terms, || {
            neighbor_mean_backward(&averaged, dy, &mut dx, &workspace);
        });
        let (mut top, mut rows) = (vec![0.0; CHANNELS], vec![0; CHANNELS]);
        on_threads(
            criterion,
            "global_max_forward",
            size,
            size * CHANNELS,
            || {
                global_max_forward(dy, &mut top, &mut rows, &workspace);
            },
        );
    }
}

criterion_group!(benches, product, feast, linear, pooling);
criterion_main!(benches);
