//! Golden drapes: where the warp, the simulator and the shipped variant `accurate` put cloth,
//! stored.
//!
//! Data sets and weights stand on these. Whoever changes where the simulator puts cloth raises
//! [`GENERATOR`], which `dataset.json` keeps, and writes the files anew:
//! `cargo run -p garnet-tests --bin make-golden`.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use garnet_body::poses::{Poser, key_pose};
use garnet_data::GENERATOR;
use garnet_drape::{
    BodyPath, BoundGarment, Draper, Garment, Moment, Package, Predicted, Quality, Simulator,
};
use garnet_mesh::{Point3, Vector3, write_atomically};
use garnet_sim::{Fabric, RestShape};
use garnet_skin::{Body, Pose, PosedBody, Warp};
use nalgebra::UnitQuaternion;

use crate::{mannequin, reach, tunic};

/// Stored coordinates are multiples of this, in metres.
const UNIT: f32 = 1e-6;

/// How far a drape may be from what is stored, in metres: rounding differs between machines.
pub const TOLERANCE: f32 = 1e-4;

/// At most this many vertices of a drape are stored, evenly over its numbers.
const MAX_STORED: usize = 300;

/// Spacing of the vertices of the mannequin, in metres.
const SPACING: f32 = 0.03;

/// About how many vertices the tunic has.
const TUNIC_VERTICES: usize = 1_000;

/// The joint of the mannequin that is turned in the simulation.
const WAIST: usize = 1;

/// How far, in radians.
const WAIST_TURN: f32 = 0.5;

/// The pose of the T-shirt, by its name in the library.
const SHIRT_POSE: &str = "reach_front";

/// How much of that pose the T-shirt is put into, from 0 to 1: less makes less of rounding.
const POSE_SHARE: f32 = 0.25;

/// A drape that is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Golden {
    /// A tunic, warped onto a mannequin that reaches.
    Warp,
    /// The same tunic, simulated as the teacher does while the mannequin turns its waist, until the
    /// turn is done: what follows makes much of rounding.
    Simulation,
    /// The T-shirt of the repository, predicted midway by its variant `accurate` and simulated from
    /// there until the body arrives.
    Accurate,
}

/// What a golden file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Stored {
    /// The version of what makes scenes when it was written.
    pub generator: String,
    /// Vertices of the whole garment.
    pub num_vertices: usize,
    /// Numbers of some vertices, and where they are, in metres.
    pub places: Vec<(usize, Point3)>,
}

impl Golden {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Warp, Self::Simulation, Self::Accurate];

    /// The name of its file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Warp => "warp",
            Self::Simulation => "simulation",
            Self::Accurate => "accurate",
        }
    }

    /// The file.
    pub fn file(self) -> PathBuf {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("it/golden");
        folder.join(format!("{}.txt", self.name()))
    }

    /// The drape as the present code makes it: positions `[vertex]`, in metres.
    ///
    /// # Errors
    ///
    /// What the library refuses.
    pub fn draped(self) -> Result<Vec<Point3>, Box<dyn Error>> {
        self.draped_from(0.0)
    }

    /// The same, with cloth that starts `noise` beside its place on each axis, in metres.
    ///
    /// How far the drape changes by that tells how far rounding may take it.
    ///
    /// # Errors
    ///
    /// As [`Golden::draped`].
    pub fn draped_from(self, noise: f32) -> Result<Vec<Point3>, Box<dyn Error>> {
        match self {
            Self::Warp => warped_tunic(noise),
            Self::Simulation => simulated_tunic(noise),
            Self::Accurate => shirt(noise),
        }
    }

    /// Whether [`GENERATOR`] alone decides over it: not if other weights move it, too.
    pub fn is_of_generator(self) -> bool {
        self != Self::Accurate
    }
}

impl Stored {
    /// What the file of a drape keeps of its positions `[vertex]`.
    pub fn of(positions: &[Point3]) -> Self {
        let stride = positions.len().div_ceil(MAX_STORED).max(1);
        let places = positions.iter().copied().enumerate().step_by(stride);
        Self {
            generator: GENERATOR.to_owned(),
            num_vertices: positions.len(),
            places: places.collect(),
        }
    }

    /// Reads the file of a golden drape.
    ///
    /// # Errors
    ///
    /// What the system or the text refuses.
    pub fn read(golden: Golden) -> Result<Self, Box<dyn Error>> {
        let text = std::fs::read_to_string(golden.file())?;
        let mut lines = text.lines();
        let mut head = || lines.next().and_then(|line| line.split_once(' '));
        let (Some(("generator", generator)), Some(("vertices", count))) = (head(), head()) else {
            return Err("a golden file begins with `generator` and `vertices`".into());
        };
        let place = |line: &str| -> Result<(usize, Point3), Box<dyn Error>> {
            let numbers: Vec<i32> = line.split(' ').map(str::parse).collect::<Result<_, _>>()?;
            let [vertex, x, y, z] = numbers[..] else {
                return Err(format!("`{line}` is no vertex with three coordinates").into());
            };
            let place = Point3::from([x, y, z].map(|units| units as f32 * UNIT));
            Ok((usize::try_from(vertex)?, place))
        };
        Ok(Self {
            generator: generator.to_owned(),
            num_vertices: count.parse()?,
            places: lines.map(place).collect::<Result<_, _>>()?,
        })
    }

    /// Writes the file of a golden drape.
    ///
    /// # Errors
    ///
    /// What the system refuses.
    pub fn write(&self, golden: Golden) -> Result<(), Box<dyn Error>> {
        let Self {
            generator,
            num_vertices,
            places,
        } = self;
        let mut text = format!("generator {generator}\nvertices {num_vertices}\n");
        for (vertex, place) in places {
            let [x, y, z] = [place.x, place.y, place.z].map(|value| (value / UNIT).round() as i32);
            writeln!(text, "{vertex} {x} {y} {z}")?;
        }
        write_atomically(golden.file(), |out| out.write_all(text.as_bytes()))?;
        Ok(())
    }

    /// How far a vertex is from where it was stored at most, in metres; infinite for another
    /// garment.
    pub fn farthest(&self, positions: &[Point3]) -> f32 {
        if positions.len() != self.num_vertices || self.places.is_empty() {
            return f32::INFINITY;
        }
        let distance = |&(vertex, place): &(usize, Point3)| (positions[vertex] - place).norm();
        self.places.iter().map(distance).fold(0.0, f32::max)
    }
}

fn warped_tunic(noise: f32) -> Result<Vec<Point3>, Box<dyn Error>> {
    let body = mannequin(SPACING);
    let garment = bound_tunic(&body, noise)?;
    Ok(garment.warped(&body.posed(&reach())?, Warp::Shape)?)
}

fn simulated_tunic(noise: f32) -> Result<Vec<Point3>, Box<dyn Error>> {
    let body = mannequin(SPACING);
    let garment = bound_tunic(&body, noise)?;
    let mut pose = Pose::rest(body.skeleton().num_joints());
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), WAIST_TURN);
    pose.rotations[WAIST] = turn;
    let path = BodyPath::to_posed(&body, &body.posed(&pose)?);
    let (cloth, rest) = (
        Arc::clone(garment.shared_cloth()),
        RestShape::Worn(Vec::new()),
    );
    let simulator = Simulator::of_garment(cloth, &body, &rest, &Fabric::cotton())?;
    let stop = AtomicBool::new(false);
    let drape = simulator.until(&path, Quality::Teacher, Moment::Arrival, &stop)?;
    Ok(drape.positions)
}

/// The shirt of `models/tshirt` on its own body, not untangled.
fn shirt(noise: f32) -> Result<Vec<Point3>, Box<dyn Error>> {
    let package = Package::open(Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/tshirt"))?;
    let body = package.body();
    let draper = package.draper("accurate")?;
    let options = draper.options().with_relax_frames(0);
    let draper = draper.with_options(options);
    let pose = key_pose(SHIRT_POSE).ok_or("the library has the pose")?;
    let mut pose = Poser::new(body.skeleton())?.pose(&pose.angles);
    for rotation in &mut pose.rotations {
        *rotation = UnitQuaternion::identity().slerp(rotation, POSE_SHARE);
    }
    pose.root_translation *= POSE_SHARE;
    let target = body.posed(&pose)?;
    if noise > 0.0 {
        let home = target.at_home(body)?;
        return Ok(home.to_target(placed_from(&draper, home.body(), noise)?));
    }
    let placed = draper.place(&target, &AtomicBool::new(false))?;
    if placed.provenance().relaxed_from != Some(Moment::Midway) {
        return Err("the shirt was not simulated from midway".into());
    }
    Ok(placed.positions(package.garment()))
}

/// What [`Draper::place`] does for a body at home, with noise on what the network predicts.
fn placed_from(
    draper: &Draper,
    target: &PosedBody,
    noise: f32,
) -> Result<Vec<Point3>, Box<dyn Error>> {
    let (garment, relaxation) = (draper.garment(), draper.relaxation());
    let (Some(network), Some(simulator)) = (draper.network(), draper.simulator()) else {
        return Err("the variant has a network and is simulated".into());
    };
    let body = garment.body();
    let on_way = BodyPath::to_posed(body, target).posed(body, Moment::Midway.motion_share())?;
    let warped = network.warped(garment, &on_way)?;
    let Predicted::At(predicted) = network.predict(garment, &on_way, &warped)? else {
        return Err("the network knows such poses".into());
    };
    let from = disturbed(&predicted, noise);
    let stop = AtomicBool::new(false);
    Ok(simulator.settled(body, target, &from, relaxation, &stop)?)
}

/// The tunic on the mannequin.
fn bound_tunic(body: &Body, noise: f32) -> Result<BoundGarment, Box<dyn Error>> {
    let mesh = tunic(TUNIC_VERTICES).mesh;
    let mesh = mesh.with_positions(disturbed(mesh.positions(), noise))?;
    Ok(Garment::new(mesh).bind(body)?)
}

/// Each place `noise` aside on each axis, in metres, to one side or the other by its number.
fn disturbed(places: &[Point3], noise: f32) -> Vec<Point3> {
    let places = (0_u32..).zip(places);
    let aside = |(vertex, place): (u32, &Point3)| {
        let bits = vertex.wrapping_mul(0x9E37_79B9) >> 29;
        let sides = [0, 1, 2].map(|axis| (bits >> axis & 1) as f32 * 2.0 - 1.0);
        place + noise * Vector3::from(sides)
    };
    places.map(aside).collect()
}
