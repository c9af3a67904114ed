//! The simulator: one second of substeps, one second of contacts, a whole drape, and the settling
//! of cloth that something else has put on the body.
//!
//! Substeps of a scene run on one thread; what lies between them takes all that rayon has.

use std::ops::ControlFlow;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use garnet::sim::{
    Cloth, Collider, Fabric, MovingBody, Quality, RestShape, Scene, Schedule, SelfContact,
    SettleFrames, Stage, drape, settle,
};
use garnet::{Point3, package::Moment};
use garnet_benches::{Scene as Mannequin, group};

/// About how many vertices the garments have.
const SIZES: [usize; 3] = [2_500, 5_000, 10_000];

/// A second of substeps without contacts of any kind.
fn substeps(rate: f32) -> Schedule {
    Schedule {
        motion_frames: 0,
        stages: vec![Stage {
            frames: 60,
            rate,
            extra_drag: 0.0,
            friction: 1.0,
        }],
        self_contact: SelfContact::Off,
        ..Schedule::for_quality(Quality::Teacher, 0.01)
    }
}

fn sim(criterion: &mut Criterion) {
    let mut group = group(criterion, "sim");
    group.sample_size(10);
    for size in SIZES {
        let Mannequin { tunic, body, posed } = Mannequin::new(size);
        let start = tunic.mesh.positions();
        let rest = RestShape::Worn(start.to_vec());
        let fabric = Fabric::cotton();
        let cloth = Cloth::new(tunic.mesh.faces(), start.len(), &rest, &fabric);
        let cloth = cloth.expect("a tunic is cloth");
        let skin = body.rest();
        let collider = Collider::new(skin.faces(), skin.num_vertices()).expect("a body is a mesh");
        let between = |time: f32| -> Vec<Point3> {
            let pairs = skin.positions().iter().zip(posed.skin().positions());
            pairs.map(|(from, to)| from + (to - from) * time).collect()
        };
        let free = Scene {
            cloth: &cloth,
            start,
            body: None,
        };
        let on_body = Scene {
            body: Some(MovingBody {
                collider: &collider,
                motion: &between,
                wind: None,
                allowed_parts: None,
                likely_faces: None,
            }),
            ..free
        };
        let run = |scene: &Scene<'_>, schedule: &Schedule| {
            drape(scene, schedule, &mut |_| ControlFlow::Continue(()))
        };
        group.throughput(Throughput::Elements(start.len() as u64));
        group.bench_function(BenchmarkId::new("600_substeps", size), |bencher| {
            let schedule = substeps(600.0);
            bencher.iter(|| run(&free, &schedule));
        });
        // One substep a refresh: 60 refreshes of the contacts with the body and of the cloth with
        // itself.
        group.bench_function(BenchmarkId::new("60_refreshes", size), |bencher| {
            let schedule = Schedule {
                self_contact: SelfContact::Repulsion {
                    distance: 0.75,
                    least: 0.5,
                },
                ..substeps(60.0)
            };
            bencher.iter(|| run(&on_body, &schedule));
        });
        group.bench_function(BenchmarkId::new("drape", size), |bencher| {
            let schedule = Schedule::for_quality(Quality::Teacher, cloth.mean_edge_length());
            bencher.iter(|| run(&on_body, &schedule));
        });
        group.bench_function(BenchmarkId::new("settle", size), |bencher| {
            let schedule = Schedule::after(
                Moment::Arrival,
                cloth.mean_edge_length(),
                SettleFrames {
                    count: Moment::Arrival.settle_frames(),
                    at_once: Moment::Arrival.frames_at_once(),
                },
            );
            bencher.iter(|| settle(&on_body, &schedule, &mut |_| ControlFlow::Continue(())));
        });
    }
    group.finish();
}

criterion_group!(benches, sim);
criterion_main!(benches);
