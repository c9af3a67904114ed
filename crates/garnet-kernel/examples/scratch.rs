#![allow(warnings, clippy::all, reason = "scratch")]
#![allow(unsafe_code)]
use garnet_kernel::*;
use std::time::Instant;
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/self/schedstat").unwrap();
    s.split(" ").next().unwrap().parse::<f64>().unwrap() / 1e6
}
fn best(reps: usize, mut f: impl FnMut()) -> (f64, f64) {
    f();
    let mut v: Vec<f64> = (0..reps)
        .map(|_| {
            let t = cpu();
            f();
            cpu() - t
        })
        .collect();
    v.sort_by(f64::total_cmp);
    (v[0], v[v.len() / 2])
}
fn main() {
    let n = 10000;
    let g = 100u32;
    let (cin, cout, m) = (
        128,
        128,
        std::env::args()
            .nth(2)
            .and_then(|s| s.parse().ok())
            .unwrap_or(8usize),
    );
    let threads: usize = std::env::args()
        .nth(1)
        .and_then(|s| s.parse().ok())
        .unwrap_or(1);
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .use_current_thread()
        .build_global()
        .unwrap();
    let mut faces = vec![];
    for r in 0..g - 1 {
        for c in 0..g - 1 {
            let v = r * g + c;
            faces.push([v, v + 1, v + g]);
            faces.push([v + 1, v + g + 1, v + g]);
        }
    }
    let adj = Adjacency::from_faces(n, &faces).unwrap();
    println!("edges {}", adj.num_edges());
    let mut s = 1u32;
    let mut rnd = |k: usize| {
        (0..k)
            .map(|_| {
                s = s.wrapping_mul(1664525).wrapping_add(1013904223);
                (s >> 8) as f32 / 8388608.0 - 1.0
            })
            .collect::<Vec<f32>>()
    };
    let x = rnd(n * cin);
    let u = rnd(cin * m);
    let c = rnd(m);
    let w = rnd(m * cin * cout);
    let b = rnd(cout);
    let dy = rnd(n * cout);
    let mut y = vec![0f32; n * cout];
    let za = rnd(n * 1152);
    let wb = rnd(1152 * 128);
    let layer = FeastLayer {
        num_heads: m,
        out_channels: cout,
        u: &u,
        c: &c,
        w: &w,
        b: &b,
        activation: Activation::LeakyRelu,
    };
    let feats = [Features::new(&x, cin)];
    let input = FeastInput {
        adjacency: &adj,
        features: &feats,
        residual: None,
    };
    let (mut dx, mut du, mut dc, mut dw, mut db) =
        (x.clone(), u.clone(), c.clone(), w.clone(), b.clone());
    let reps = 15;
    for round in 0..3 {
        let par = gemm::Parallelism::None;
        let (t, md) = best(reps, || unsafe {
            gemm::gemm(
                n,
                128,
                1152,
                y.as_mut_ptr(),
                1,
                128,
                false,
                za.as_ptr(),
                1,
                1152,
                wb.as_ptr(),
                1,
                128,
                0f32,
                1f32,
                false,
                false,
                false,
                par,
            )
        });
        let fl = 2.0 * (n * 1152 * 128) as f64;
        let rate = fl / t / 1e6;
        println!("[{round}] gemm {t:.2} ms (median {md:.2}) {rate:.1} GF/s");
        for is in InstructionSet::available().into_iter().rev() {
            let ws = Workspace::with_instructions(is);
            let (t, md) = best(reps, || feast_forward(&layer, &input, &mut y, &ws));
            let fl = 2.0 * (n * m * cin * cout) as f64;
            println!(
                "  {is:?} fwd {t:.2} ms (median {md:.2}) {:.1} GF/s = {:.0} % of gemm",
                fl / t / 1e6,
                fl / t / 1e6 / rate * 100.
            );
            let (t, md) = best(reps, || {
                let mut fx = [Some(&mut dx[..])];
                let mut gr = FeastGradients {
                    features: &mut fx,
                    residual: None,
                    u: &mut du,
                    c: &mut dc,
                    w: &mut dw,
                    b: &mut db,
                };
                feast_backward(&layer, &input, (&y, &dy), &mut gr, &ws)
            });
            println!(
                "  {is:?} bwd {t:.2} ms (median {md:.2}) {:.1} GF/s = {:.0} % of gemm; ws {} MB",
                2. * fl / t / 1e6,
                2. * fl / t / 1e6 / rate * 100.,
                ws.num_bytes() / 1_000_000
            );
        }
    }
}
