//! What ships: every variant of `models/tshirt`, the default of the command, and the warp of a
//! garment without a package, on one and two threads.
//!
//! - `package/cold`: opens the package and drapes once, as a process that drapes once.
//! - `package/bound`: one more drape of a garment that is opened.
//! - `package/32 bodies`: a batch of people in poses, one after another.
//! - `own/bound`: warp and untangling of a garment of 1 000 to 20 000 vertices. Networks belong to
//!   the vertices that they have learned, so that variants have one size.
//!
//! `cargo bench -p garnet-benches --bench package -- "bound/2 threads/default"` measures one;
//! `garnet-lab report benches package own` prints the tables.

use std::path::{Path, PathBuf};

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use garnet::{
    Body, Draper, Package, PosedBody,
    body::{
        poses::{PoseSampler, Poser, SelfContact},
        shape::{ParametricBody, Population},
    },
    io::ObjFile,
    package::GarmentPackage,
};
use garnet_benches::{Scene, on_threads};
use garnet_skin::Method;

/// The allocator of the command.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Vertices of garments without a package.
const SIZES: [usize; 5] = [1_000, 2_000, 5_000, 10_000, 20_000];

/// Bodies of a batch.
const BATCH: u64 = 32;

/// Seed of bodies and poses.
const SEED: u64 = 5;

/// The variants by name, and what `garnet drape` takes by itself.
fn variants() -> Vec<(String, Option<String>)> {
    let package = GarmentPackage::read(&folder()).expect("the package can be read");
    let variants = package.manifest.variants.into_iter();
    let named = variants.map(|variant| (variant.name.clone(), Some(variant.name)));
    [("default".to_owned(), None)]
        .into_iter()
        .chain(named)
        .collect()
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/tshirt")
}

fn opened(variant: Option<&str>) -> Draper {
    let package = Package::open(folder()).expect("the package can be read");
    let draper = match variant {
        Some(variant) => package.draper(variant),
        None => package.default_draper(),
    };
    draper.expect("the package has the variant")
}

fn drape(shirt: &Draper, target: &PosedBody) {
    shirt.drape(target).expect("the target is of the body");
}

/// The body of the package with a raised arm.
fn reach(body: &Body) -> PosedBody {
    let file = folder().join("../demo/reach.obj");
    let file = ObjFile::read(file).expect("the demo can be read");
    body.fitted(file.positions())
        .expect("the demo is of the body")
}

/// People of the population in sampled poses, as targets of the body of the package.
fn people(body: &Body) -> Vec<PosedBody> {
    let (population, sampler) = (Population::new(SEED), PoseSampler::new(SEED));
    let person = |number: u64| {
        let built = ParametricBody::build(&population.sample(number))
            .ok()?
            .into_body();
        let poser = Poser::new(built.skeleton()).ok()?;
        let sound = sampler.sample_for(&poser, &SelfContact::new(&built).ok()?, number);
        let posed = built.posed_positions(&sound.ok()?.pose, Method::DualQuaternion);
        body.fitted(&posed.ok()?).ok()
    };
    // A few draws of the population are bodies that cannot be.
    let people = (0..2 * BATCH).filter_map(person);
    people.take(BATCH as usize).collect()
}

fn package(criterion: &mut Criterion) {
    let variants = variants();
    let target = reach(opened(None).garment().body());
    for (name, variant) in &variants {
        let variant = variant.as_deref();
        let run = |(): &mut ()| drape(&opened(variant), &target);
        let id = BenchmarkId::from_parameter(name);
        on_threads(criterion, "package/cold", &id, || (), run);
    }
    for (name, variant) in &variants {
        let make = || opened(variant.as_deref());
        let run = |shirt: &mut Draper| drape(shirt, &target);
        let id = BenchmarkId::from_parameter(name);
        on_threads(criterion, "package/bound", &id, make, run);
    }
    for (name, variant) in &variants {
        let make = || {
            let shirt = opened(variant.as_deref());
            let people = people(shirt.garment().body());
            (shirt, people)
        };
        let run = |(shirt, people): &mut (Draper, Vec<PosedBody>)| {
            for target in people {
                drape(shirt, target);
            }
        };
        let id = BenchmarkId::from_parameter(name);
        on_threads(criterion, "package/32 bodies", &id, make, run);
    }
}

fn own(criterion: &mut Criterion) {
    for size in SIZES {
        let make = || {
            let scene = Scene::new(size);
            (Draper::new(scene.bound()), scene.posed)
        };
        let id = BenchmarkId::from_parameter(size);
        on_threads(criterion, "own/bound", &id, make, |(draper, posed)| {
            draper.drape(posed).expect("the tunic can be draped");
        });
    }
}

criterion_group!(benches, package, own);
criterion_main!(benches);
