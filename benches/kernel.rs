//! Kernels of the network, forward and backward, on one and two threads, beside a plain matrix
//! product.
//!
//! The throughput is that of the multiplications and additions of the matrix products alone
//! ("Gelem/s" are GFLOP/s). The measure of the convolution is a product of 10000 x 1152 by 1152 x
//! 128: 80 % of its rate is the bar. `cargo bench --bench kernel -- share` prints nothing but the
//! shares, measured by turns, of the faster of two products: that of `faer`, and that of the
//! kernels themselves, a linear layer.

#![allow(clippy::print_stdout, reason = "a program that reports")]

use std::hint::black_box;
use std::time::{Duration, Instant};

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
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(800));
    for num_threads in [1, 2] {
        let pool = pool_of(num_threads);
        let id = BenchmarkId::new(format!("{num_threads} threads"), size);
        group.bench_function(id, |bencher| pool.install(|| bencher.iter(&mut run)));
    }
    group.finish();
}

fn pool_of(num_threads: usize) -> rayon::ThreadPool {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(num_threads)
        .build();
    pool.expect("threads can be made")
}

/// A product of 10000 x 1152 by 1152 x 128.
struct Product {
    a: Vec<f32>,
    b: Vec<f32>,
    c: Vec<f32>,
    workspace: Workspace,
}

impl Product {
    const SHAPE: [usize; 3] = [10_000, 1_152, 128];
    const FLOP: usize = 2 * Self::SHAPE[0] * Self::SHAPE[1] * Self::SHAPE[2];

    fn new() -> Self {
        let [rows, depth, columns] = Self::SHAPE;
        Self {
            a: numbers(rows * depth),
            b: numbers(depth * columns),
            c: vec![0.0; rows * columns],
            workspace: Workspace::new(),
        }
    }

    /// With all threads of the pool.
    fn run(&mut self) {
        let [rows, depth, columns] = Self::SHAPE;
        let c = MatMut::from_row_major_slice_mut(&mut self.c, rows, columns);
        let a = MatRef::from_row_major_slice(&self.a, rows, depth);
        let b = MatRef::from_row_major_slice(&self.b, depth, columns);
        matmul(black_box(c), Accum::Replace, a, b, 1.0, Par::rayon(0));
    }

    /// As a linear layer without bias and activation.
    fn run_as_layer(&mut self) {
        let [_, depth, columns] = Self::SHAPE;
        let layer = LinearLayer {
            out_channels: columns,
            w: &self.b,
            b: None,
            activation: Activation::None,
        };
        let parts = [LinearInput::PerRow(Features::new(&self.a, depth))];
        linear_forward(&layer, &parts, black_box(&mut self.c), &self.workspace);
    }
}

fn product(criterion: &mut Criterion) {
    let mut product = Product::new();
    let [rows, ..] = Product::SHAPE;
    on_threads(criterion, "product", rows, Product::FLOP, || product.run());
    on_threads(criterion, "product_as_layer", rows, Product::FLOP, || {
        product.run_as_layer();
    });
}

/// `FeaStNet` convolution of 128 to 128 channels with 8 heads, and all its gradients.
struct Convolution {
    adjacency: Adjacency,
    workspace: Workspace,
    x: Vec<f32>,
    y: Vec<f32>,
    dx: Vec<f32>,
    dy: Vec<f32>,
    /// `u`, `c`, `w` and `b`.
    weights: [Vec<f32>; 4],
    gradients: [Vec<f32>; 4],
}

impl Convolution {
    fn new(size: usize) -> Self {
        let weights = [
            CHANNELS * NUM_HEADS,
            NUM_HEADS,
            NUM_HEADS * CHANNELS * CHANNELS,
            CHANNELS,
        ]
        .map(numbers);
        Self {
            adjacency: grid(size),
            workspace: Workspace::new(),
            x: numbers(size * CHANNELS),
            y: vec![0.0; size * CHANNELS],
            dx: vec![0.0; size * CHANNELS],
            dy: numbers(size * CHANNELS),
            gradients: weights.clone(),
            weights,
        }
    }

    /// Multiplications and additions of the forward product.
    fn flop(&self) -> usize {
        2 * self.adjacency.num_vertices() * self.weights[2].len()
    }

    fn layer(&self) -> FeastLayer<'_> {
        let [u, c, w, b] = &self.weights;
        FeastLayer {
            num_heads: NUM_HEADS,
            out_channels: CHANNELS,
            u,
            c,
            w,
            b,
            activation: Activation::LeakyRelu,
        }
    }

    fn forward(&mut self) {
        let mut y = std::mem::take(&mut self.y);
        let input = FeastInput {
            adjacency: &self.adjacency,
            features: &[Features::new(&self.x, CHANNELS)],
            residual: None,
        };
        feast_forward(&self.layer(), &input, &mut y, &self.workspace);
        self.y = y;
    }

    fn backward(&mut self) {
        let mut dx = std::mem::take(&mut self.dx);
        let [mut u, mut c, mut w, mut b] = std::mem::take(&mut self.gradients);
        let input = FeastInput {
            adjacency: &self.adjacency,
            features: &[Features::new(&self.x, CHANNELS)],
            residual: None,
        };
        let mut gradients = FeastGradients {
            features: &mut [Some(&mut dx)],
            residual: None,
            u: &mut u,
            c: &mut c,
            w: &mut w,
            b: &mut b,
        };
        let outputs = (self.y.as_slice(), self.dy.as_slice());
        feast_backward(
            &self.layer(),
            &input,
            outputs,
            &mut gradients,
            &self.workspace,
        );
        (self.dx, self.gradients) = (dx, [u, c, w, b]);
    }
}

fn feast(criterion: &mut Criterion) {
    for size in SIZES {
        let mut convolution = Convolution::new(size);
        let flop = convolution.flop();
        on_threads(criterion, "feast_forward", size, flop, || {
            convolution.forward();
        });
        on_threads(criterion, "feast_backward", size, 2 * flop, || {
            convolution.backward();
        });
    }
}

/// Prints how much of the rate of the product a convolution reaches, the three measured by turns.
fn shares(_: &mut Criterion) {
    const TURNS: usize = 15;
    let filter = std::env::args().skip(1).find(|text| !text.starts_with('-'));
    if filter.is_some_and(|filter| !"kernel/share".contains(&filter)) {
        return;
    }
    let mut product = Product::new();
    let mut convolution = Convolution::new(10_000);
    let flop = convolution.flop();
    for num_threads in [1, 2] {
        let mut seconds = [const { Vec::new() }; 4];
        pool_of(num_threads).install(|| {
            for _ in 0..TURNS {
                let mut take = |number: usize, run: &mut dyn FnMut()| {
                    let start = Instant::now();
                    run();
                    seconds[number].push(start.elapsed().as_secs_f64());
                };
                take(0, &mut || product.run());
                take(1, &mut || product.run_as_layer());
                take(2, &mut || convolution.forward());
                take(3, &mut || convolution.backward());
            }
        });
        let [by_faer, as_layer, forward, backward] = seconds.map(|mut seconds| {
            seconds.sort_by(f64::total_cmp);
            seconds[TURNS / 2]
        });
        let rate = Product::FLOP as f64 / by_faer.min(as_layer);
        let share = |flop: usize, seconds: f64| 100.0 * flop as f64 / seconds / rate;
        println!(
            "kernel/share, {num_threads} threads: product {:.0} GFLOP/s; convolution forward {:.0} %, \
             backward {:.0} % of it",
            rate / 1e9,
            share(flop, forward),
            share(2 * flop, backward),
        );
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

criterion_group!(benches, product, feast, linear, pooling, shares);
criterion_main!(benches);
