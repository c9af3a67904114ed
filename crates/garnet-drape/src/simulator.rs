//! The simulator of a garment: ready to be draped on the way of its body to a pose.

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use garnet_mesh::{Bounds, Point3};
use garnet_sim::{
    Cloth, Collider, Drape, Event, Fabric, Motion, MovingBody, RestShape, STANDARD_GRAVITY, Scene,
    Schedule, SettleFrames, SimError, Wind, drape, settle,
};
use garnet_skin::{Body, BoundGarment, Garment, PosedBody};

pub use garnet_sim::Quality;

use crate::parts::{allowed_parts, collider};
use crate::simulated_faces::simulated_faces;
use crate::{BodyPath, GarmentPackage, Moment, PackageError, Settling};

/// Distances from the skin at rest from which on air carries cloth along, a little and wholly, in
/// metres. Lower ones hold tight cloth to the warp, which strains it and lets fewer dresses rest;
/// higher ones leave loose cloth to chance. 0 for both was tried (docs/experiments/013).
const LOOSE: [f32; 2] = [0.002, 0.006];

/// More of the vertices inside the body at rest than this, and the garment does not lie on it.
const MAX_SHARE_INSIDE: f64 = 0.3;

/// More of the vertices over holes of the body than this, and nothing holds the garment.
const MAX_OVER_HOLES: f64 = 0.1;

/// Fabric, gravity and the lengths of the simulation are those of cloth on people. Bodies whose
/// height is outside of this range, in metres, and whose limbs are as thin or thick, are dolls or
/// giants: they are simulated at the height of a person. Wider, dolls are in cloth as thick as
/// themselves; narrower, children are dressed as if they were grown up.
const PEOPLE: [f32; 2] = [0.45, 3.0];

/// The height of a person, in metres.
const PERSON: f32 = 1.72;

/// Cloth with more than this weight of a joint goes along with it.
const GOES_ALONG: f32 = 0.1;

/// The name of a quality in files and messages.
pub const fn quality_name(quality: Quality) -> &'static str {
    match quality {
        Quality::Fast => "fast",
        Quality::Teacher => "teacher",
        Quality::Reference => "reference",
    }
}

/// The quality of a name; none if there is none of that name.
///
/// ```
/// use garnet_drape::{Quality, quality_name, quality_of};
///
/// assert_eq!(quality_of(quality_name(Quality::Fast)), Some(Quality::Fast));
/// ```
pub fn quality_of(name: &str) -> Option<Quality> {
    [Quality::Fast, Quality::Teacher, Quality::Reference]
        .into_iter()
        .find(|&quality| quality_name(quality) == name)
}

/// A garment that lies on a body at rest, ready to be simulated.
///
/// Vertices at one place are simulated as one. Loose pieces, buttons say, are carried along with
/// the cloth that they sit on.
#[derive(Debug, Clone)]
pub struct Simulator {
    garment: Arc<BoundGarment>,
    /// How much larger the scene is than the one that is simulated.
    size: f32,
    /// Nodes of the garment that are simulated.
    nodes: Vec<u32>,
    /// For nodes of loose pieces: the simulated node that they follow.
    carried: Vec<(u32, u32)>,
    cloth: Cloth,
    start: Vec<Point3>,
    collider: Collider,
    allowed: Option<Vec<u32>>,
    /// The skin that each of them lies on at rest `[simulated node]`.
    likely_faces: Vec<u32>,
    /// How loose the garment is `[simulated node]`, from 0 to 1.
    looseness: Vec<f32>,
    /// Whether the garment was cut from a pattern.
    is_sewn: bool,
    /// In m/s², downwards.
    gravity: f32,
}

impl Simulator {
    /// The garment of a package.
    ///
    /// # Errors
    ///
    /// Those of [`Simulator::of_garment`], and [`PackageError::Skin`].
    pub fn new(package: &GarmentPackage) -> Result<Self, PackageError> {
        let garment = Garment::new(package.mesh.clone()).bind(&package.body)?;
        let fabric = package.manifest.fabric.fabric();
        Self::of_garment(garment, &package.body, &package.rest, &fabric)
    }

    /// A garment that was bound to `body`. The rest shape is that of its mesh.
    ///
    /// # Errors
    ///
    /// [`PackageError::InsideAtStart`] if a third of the garment is inside the body;
    /// [`PackageError::OverHoles`] if a tenth of it lies over holes of the body;
    /// [`PackageError::Sim`] for a mesh that no cloth can be, by its vertices, or constants that no
    /// fabric has.
    pub fn of_garment(
        garment: impl Into<Arc<BoundGarment>>,
        body: &Body,
        rest: &RestShape,
        fabric: &Fabric,
    ) -> Result<Self, PackageError> {
        Self::made(garment.into(), body, rest, fabric, false)
    }

    /// The same of any garment that can be draped, to [settle](Simulator::settled) it: faces
    /// without area and those that are there twice are left out, those that look to another side
    /// than their neighbours are turned, and edges with more than two faces do not bend.
    ///
    /// # Errors
    ///
    /// As [`Simulator::of_garment`], but for meshes only if there is nothing to simulate.
    pub fn of_any_garment(
        garment: impl Into<Arc<BoundGarment>>,
        body: &Body,
        rest: &RestShape,
        fabric: &Fabric,
    ) -> Result<Self, PackageError> {
        Self::made(garment.into(), body, rest, fabric, true)
    }

    fn made(
        garment: Arc<BoundGarment>,
        body: &Body,
        rest: &RestShape,
        fabric: &Fabric,
        is_any: bool,
    ) -> Result<Self, PackageError> {
        let over_holes = share_over_holes(&garment);
        if over_holes > MAX_OVER_HOLES {
            return Err(PackageError::OverHoles { share: over_holes });
        }
        let flat = match rest {
            // Faces that welding makes a line are in no simulation: such a pattern is not cut.
            RestShape::Flat { corners, .. } if corners.len() == num_cut(&garment) => Some(rest),
            _ => None,
        };
        let is_any = is_any && flat.is_none();
        let faces = if is_any {
            simulated_faces(&garment)
        } else {
            cut_faces(&garment).collect()
        };
        let nodes = simulated_nodes(&garment, &faces);
        let mut number = vec![u32::MAX; garment.rest_nodes().len()];
        for (place, &node) in (0..).zip(&nodes) {
            number[node as usize] = place;
        }
        let faces: Vec<[u32; 3]> = (faces.iter())
            .map(|face| face.map(|node| number[node as usize]))
            .collect();
        let start: Vec<Point3> = nodes
            .iter()
            .map(|&node| garment.rest_nodes()[node as usize])
            .collect();
        check_start(&start, body)?;
        let size = size_of(&garment, body);
        let start = scaled(&start, 1.0 / size);
        let flat = flat.map(|rest| rest_scaled(rest, 1.0 / size));
        let rest = flat.unwrap_or_else(|| RestShape::Worn(start.clone()));
        let allowed = allowed_parts(body, garment.weights());
        let allowed = allowed.map(|all| nodes.iter().map(|&node| all[node as usize]).collect());
        let cloth = if is_any {
            Cloth::of_any_faces(&faces, nodes.len(), &rest, fabric)
        } else {
            Cloth::new(&faces, nodes.len(), &rest, fabric)
        };
        Ok(Self {
            is_sewn: matches!(rest, RestShape::Flat { .. }),
            cloth: cloth.map_err(|error| of_vertices(error, &garment, &nodes))?,
            carried: carried(&garment, &nodes),
            likely_faces: (nodes.iter())
                .map(|&node| garment.skin()[node as usize].face)
                .collect(),
            looseness: looseness(&garment, &nodes, size),
            collider: collider(body, 1.0 / size)?,
            garment,
            size,
            nodes,
            start,
            allowed,
            gravity: STANDARD_GRAVITY,
        })
    }

    /// The same under so many times the gravity of the earth.
    #[must_use]
    pub fn with_gravity(self, times: f32) -> Self {
        Self {
            gravity: times * STANDARD_GRAVITY,
            ..self
        }
    }

    /// How many vertices are simulated.
    pub fn num_simulated(&self) -> usize {
        self.nodes.len()
    }

    /// How much larger the body is than a person, for dolls and giants, which are simulated as if
    /// they were people; 1 of all others.
    pub fn size(&self) -> f32 {
        self.size
    }

    /// Whether some of the garment goes along with a joint of its body.
    pub fn is_moved_by(&self, joint: usize) -> bool {
        let weights = self.garment.weights();
        let mut nodes = (0..self.garment.rest_nodes().len()).flat_map(|node| weights.vertex(node));
        nodes.any(|(of, weight)| of == joint && weight > GOES_ALONG)
    }

    /// Simulates the garment while the body goes along its path, and until it rests. Bodies that
    /// end far from where they rest are to come [home](PosedBody::at_home) first.
    ///
    /// The result's positions are those of the garment's mesh `[vertex]`. `observer` is told how
    /// far it is, with the positions at the end of each frame; `stop` ends it.
    ///
    /// # Errors
    ///
    /// [`PackageError::Stopped`], or [`PackageError::Sim`] if the cloth flies apart.
    pub fn drape(
        &self,
        path: &BodyPath,
        quality: Quality,
        stop: &AtomicBool,
        observer: &mut dyn FnMut(Event<'_>),
    ) -> Result<Drape, PackageError> {
        self.drape_by(path, self.schedule(quality), stop, observer)
    }

    /// The schedule of a quality for this garment.
    pub fn schedule(&self, quality: Quality) -> Schedule {
        Schedule::for_quality(quality, self.cloth.mean_edge_length())
    }

    /// Simulates the garment as far as is said: until the body comes to its last place, both
    /// positions of the result are [`Drape::arrived`] of [`Simulator::drape`]; until it is
    /// [midway](Moment::Midway), [`Drape::midway`] is that of it.
    ///
    /// # Errors
    ///
    /// As [`Simulator::drape`].
    pub fn until(
        &self,
        path: &BodyPath,
        quality: Quality,
        until: Moment,
        stop: &AtomicBool,
    ) -> Result<Drape, PackageError> {
        let schedule = self.schedule(quality).until(until);
        self.drape_by(path, schedule, stop, &mut |_| {})
    }

    /// [`Simulator::drape`] by a schedule that is none of the qualities'.
    ///
    /// # Errors
    ///
    /// As [`Simulator::drape`], and [`PackageError::Sim`] for a schedule that cannot be followed.
    pub fn drape_by(
        &self,
        path: &BodyPath,
        schedule: Schedule,
        stop: &AtomicBool,
        observer: &mut dyn FnMut(Event<'_>),
    ) -> Result<Drape, PackageError> {
        let schedule = self.layered(schedule);
        let run = |scene: &Scene<'_>| drape(scene, &schedule, &mut stopping(stop, observer));
        let result = self.on_way(path, &self.start, run);
        check_stop(stop)?;
        let mut result = result.map_err(|error| of_vertices(error, &self.garment, &self.nodes))?;
        result.positions = self.vertices(&result.positions);
        result.arrived = self.vertices(&result.arrived);
        result.midway = self.vertices(&result.midway);
        Ok(result)
    }

    /// Runs a scene in which the body goes along a path and the garment starts at `start`
    /// `[simulated node]`.
    fn on_way<T>(&self, path: &BodyPath, start: &[Point3], run: impl FnOnce(&Scene<'_>) -> T) -> T {
        let motion = |time: f32| self.simulated_skin(path.positions(time));
        let offsets = self.garment.shape_offsets_nodes(path.shape());
        let carried =
            |time: f32| self.simulated(&path.carried_nodes(&self.garment, &offsets, time));
        run(&self.scene(start, &motion, &carried))
    }

    /// Runs a scene in which the body moves and the air goes along, and the garment was put on as
    /// it lies at rest.
    pub(crate) fn with_scene<T>(
        &self,
        motion: &Motion<'_>,
        air: &Motion<'_>,
        run: impl FnOnce(&Scene<'_>) -> T,
    ) -> T {
        run(&self.scene(&self.start, motion, air))
    }

    fn scene<'a>(
        &'a self,
        start: &'a [Point3],
        motion: &'a Motion<'a>,
        air: &'a Motion<'a>,
    ) -> Scene<'a> {
        Scene {
            cloth: &self.cloth,
            start,
            body: Some(MovingBody {
                collider: &self.collider,
                motion,
                wind: Some(Wind {
                    motion: air,
                    looseness: &self.looseness,
                }),
                allowed_parts: self.allowed.as_deref(),
                likely_faces: None,
            }),
        }
    }

    /// The garment.
    pub(crate) fn garment(&self) -> &BoundGarment {
        &self.garment
    }

    /// Positions of the simulated nodes of those of the garment's mesh `[vertex]`.
    pub(crate) fn of_vertices(&self, vertices: &[Point3]) -> Vec<Point3> {
        self.simulated(&self.garment.weld().gather(vertices))
    }

    /// What a simulation says of its nodes, said of the vertices of the garment's mesh.
    pub(crate) fn named(&self, error: SimError) -> SimError {
        of_vertices(error, &self.garment, &self.nodes)
    }

    /// Simulates a garment that something else has put on its way to a posed body, a network say,
    /// until the body has arrived and the cloth has settled for a while: it gives way where it is
    /// strained, leaves the skin, and finds its finer folds.
    ///
    /// `body` is that which the garment was bound to, `posed` the same in its last place,
    /// [at home](PosedBody::at_home): the body goes there from its rest within a second; `from` and
    /// the result are the positions of the garment's mesh `[vertex]`, in metres. Where nothing
    /// [takes time](Settling::takes_time) the result is `from`.
    ///
    /// # Examples
    ///
    /// ```no_run
    /// use std::{path::Path, sync::atomic::AtomicBool};
    ///
    /// use garnet_drape::{PackageError, GarmentPackage, Moment, Settling, Simulator};
    /// use garnet_mesh::Point3;
    /// use garnet_skin::PosedBody;
    ///
    /// fn settled(target: &PosedBody, from: &[Point3]) -> Result<Vec<Point3>, PackageError> {
    ///     let package = GarmentPackage::read(Path::new("models/tshirt"))?;
    ///     let simulator = Simulator::new(&package)?;
    ///     let (settling, stop) = (Settling::of(Moment::Rest), AtomicBool::new(false));
    ///     simulator.settled(&package.body, target, from, settling, &stop)
    /// }
    /// ```
    ///
    /// # Errors
    ///
    /// [`PackageError::Stopped`], or [`PackageError::Sim`] if the cloth flies apart.
    ///
    /// # Panics
    ///
    /// If there are fewer positions than vertices.
    pub fn settled(
        &self,
        body: &Body,
        posed: &PosedBody,
        from: &[Point3],
        settling: Settling,
        stop: &AtomicBool,
    ) -> Result<Vec<Point3>, PackageError> {
        let ended = self.settled_and_falling(body, posed, from, settling, stop)?;
        Ok(ended.0)
    }

    /// The same, and the share of the simulated cloth that is [falling](FALLING) in the last frame.
    pub(crate) fn settled_and_falling(
        &self,
        body: &Body,
        posed: &PosedBody,
        from: &[Point3],
        settling: Settling,
        stop: &AtomicBool,
    ) -> Result<(Vec<Point3>, f32), PackageError> {
        if !settling.takes_time() {
            return Ok((from.to_vec(), 0.0));
        }
        let moment = settling.from;
        let edge_length = self.cloth.mean_edge_length();
        let frames = SettleFrames {
            count: settling.frames,
            at_once: settling.at_once,
        };
        let schedule = self.layered(Schedule::after(moment, edge_length, frames));
        let at_nodes = self.garment.weld().gather(from);
        let start = self.simulated(&at_nodes);
        let run = |scene: &Scene<'_>| settled(scene, &schedule, stop);
        let result = if moment.is_on_way() {
            let path = BodyPath::to_posed(body, posed);
            self.on_way(&path, &start, run)
        } else {
            run(&Scene {
                cloth: &self.cloth,
                start: &start,
                body: Some(MovingBody {
                    collider: &self.collider,
                    motion: &|_| self.simulated_skin(posed.skin().positions().to_vec()),
                    wind: None,
                    allowed_parts: self.allowed.as_deref(),
                    likely_faces: moment.lies_near_rest().then_some(&self.likely_faces),
                }),
            })
        };
        check_stop(stop)?;
        let (result, falling) =
            result.map_err(|error| of_vertices(error, &self.garment, &self.nodes))?;
        Ok((self.moved(&at_nodes, &result), falling))
    }

    /// A schedule as the layers of the garment and its gravity ask for it.
    pub(crate) fn layered(&self, mut schedule: Schedule) -> Schedule {
        schedule.gravity = self.gravity;
        if self.is_sewn {
            schedule.of_one_layer()
        } else {
            schedule
        }
    }

    /// Positions of the simulated nodes of those of all nodes `[node]`, in the simulated scene.
    pub(crate) fn simulated(&self, at_nodes: &[Point3]) -> Vec<Point3> {
        let nodes = self.nodes.iter();
        nodes
            .map(|&node| at_nodes[node as usize] / self.size)
            .collect()
    }

    /// Positions of the skin `[vertex]` in the simulated scene.
    pub(crate) fn simulated_skin(&self, skin: Vec<Point3>) -> Vec<Point3> {
        if is_one(self.size) {
            skin
        } else {
            scaled(&skin, 1.0 / self.size)
        }
    }

    /// Positions of the garment's mesh `[vertex]`, in metres, of those of the simulated nodes
    /// `[simulated node]` in the simulated scene, as a simulation tells them.
    pub fn vertices(&self, simulated_nodes: &[Point3]) -> Vec<Point3> {
        self.moved(self.garment.rest_nodes(), simulated_nodes)
    }

    /// Positions of the garment's mesh `[vertex]` once the simulated nodes are no more at `from`
    /// `[node]`: loose pieces go with what they follow.
    fn moved(&self, from: &[Point3], simulated: &[Point3]) -> Vec<Point3> {
        let mut at_nodes = from.to_vec();
        for (&node, &position) in self.nodes.iter().zip(simulated) {
            at_nodes[node as usize] = position * self.size;
        }
        for &(node, follows) in &self.carried {
            let moved = at_nodes[follows as usize] - from[follows as usize];
            at_nodes[node as usize] += moved;
        }
        self.garment.weld().scatter(&at_nodes)
    }
}

/// Where the cloth of a scene comes to, unless it is stopped, and how much of it is falling then.
fn settled(
    scene: &Scene<'_>,
    schedule: &Schedule,
    stop: &AtomicBool,
) -> Result<(Vec<Point3>, f32), SimError> {
    let (mut last, mut falling) = (Vec::new(), 0.0);
    let mut watch = |event: Event<'_>| {
        let Event::Frame {
            num_done,
            num_frames,
            positions,
            ..
        } = event
        else {
            return;
        };
        if num_done + 1 == num_frames {
            last = positions.to_vec();
        } else if num_done == num_frames && !last.is_empty() {
            falling = falling_share(&last, positions, schedule.frame_seconds);
        }
    };
    // On a thread of rayon's: another thread would wait to be woken each time that all of them have
    // looked for contacts.
    let positions = rayon::scope(|_| settle(scene, schedule, &mut stopping(stop, &mut watch)))?;
    Ok((positions, falling))
}

/// The share of vertices that go down faster than [`FALLING`], from 0 to 1.
fn falling_share(before: &[Point3], after: &[Point3], seconds: f32) -> f32 {
    let pairs = before.iter().zip(after);
    let falling = pairs.filter(|(before, after)| before.y - after.y > FALLING * seconds);
    falling.count() as f32 / before.len().max(1) as f32
}

/// What a simulation says of its nodes, said of the vertices of the garment's mesh: of the first
/// one at each place.
fn of_vertices(error: SimError, garment: &BoundGarment, nodes: &[u32]) -> SimError {
    let node_of_vertex = garment.weld().node_of_vertex();
    error.with_vertices(|simulated| {
        let node = nodes[simulated as usize];
        let vertex = node_of_vertex.iter().position(|&other| other == node);
        vertex.expect("a node is at the place of a vertex") as u32
    })
}

/// An observer that ends the simulation once `stop` is set.
pub fn stopping<'a>(
    stop: &'a AtomicBool,
    observer: &'a mut dyn FnMut(Event<'_>),
) -> impl FnMut(Event<'_>) -> ControlFlow<()> + 'a {
    |event| {
        observer(event);
        if stop.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

/// The faces between nodes of a garment, without those of loose pieces.
fn cut_faces(garment: &BoundGarment) -> impl Iterator<Item = [u32; 3]> {
    let is_piece = garment.is_piece();
    let faces = garment.faces().iter().copied();
    faces.filter(|face| !face.iter().any(|&node| is_piece[node as usize]))
}

fn num_cut(garment: &BoundGarment) -> usize {
    cut_faces(garment).count()
}

/// The nodes of cloth that is simulated, in their order.
fn simulated_nodes(garment: &BoundGarment, faces: &[[u32; 3]]) -> Vec<u32> {
    let mut is_simulated = vec![false; garment.rest_nodes().len()];
    for &node in faces.as_flattened() {
        is_simulated[node as usize] = true;
    }
    let nodes = (0_u32..).zip(is_simulated);
    nodes
        .filter_map(|(node, is_simulated)| is_simulated.then_some(node))
        .collect()
}

/// The share of the nodes that lie over holes of the body.
fn share_over_holes(garment: &BoundGarment) -> f64 {
    let count = garment.rest_nodes().len();
    let over = (0..count)
        .filter(|&node| garment.is_over_hole(node))
        .count();
    over as f64 / count.max(1) as f64
}

/// How much larger a body is than a person; 1 unless it is a doll or a giant.
fn size_of(garment: &BoundGarment, body: &Body) -> f32 {
    let rest = body.rest();
    let bounds = Bounds::of_faces(rest.positions(), rest.faces()).unwrap_or_default();
    let height = bounds.extent().max();
    let is_person = is_one(garment.scale()) || (PEOPLE[0]..=PEOPLE[1]).contains(&height);
    if is_person || height <= 0.0 {
        1.0
    } else {
        height / PERSON
    }
}

/// Cloth that goes down faster than this falls, m/s: so fast it is after a hundredth of a second of
/// free fall. Less takes hems that swing to rest for falling.
const FALLING: f32 = 0.12;

/// Whether lengths stay as they are.
pub(crate) fn is_one(scale: f32) -> bool {
    (scale - 1.0).abs() < f32::EPSILON
}

fn scaled(places: &[Point3], by: f32) -> Vec<Point3> {
    places.iter().map(|place| place * by).collect()
}

fn rest_scaled(rest: &RestShape, by: f32) -> RestShape {
    let mut rest = rest.clone();
    if let RestShape::Flat { corners, .. } = &mut rest {
        for length in corners.as_flattened_mut().as_flattened_mut() {
            *length *= by;
        }
    }
    rest
}

/// How loose the garment is at each node, by its distance from the skin at rest.
fn looseness(garment: &BoundGarment, nodes: &[u32], size: f32) -> Vec<f32> {
    let [tight, loose] = LOOSE.map(|distance| distance * size);
    let distance = |&node: &u32| garment.skin()[node as usize].distance_squared.sqrt();
    let distances = nodes.iter().map(distance);
    distances
        .map(|distance| ((distance - tight) / (loose - tight)).clamp(0.0, 1.0))
        .collect()
}

/// Whether the work goes on.
///
/// # Errors
///
/// [`PackageError::Stopped`] once `stop` is set.
pub fn check_stop(stop: &AtomicBool) -> Result<(), PackageError> {
    if stop.load(Ordering::Relaxed) {
        return Err(PackageError::Stopped);
    }
    Ok(())
}

/// The simulated node that each node of a loose piece follows: the nearest of that part of the
/// cloth which is nearest to the piece. A buckle between shirt and trousers is not torn between
/// them.
fn carried(garment: &BoundGarment, nodes: &[u32]) -> Vec<(u32, u32)> {
    let part = garment.topology().components();
    let mut is_simulated = vec![false; part.len()];
    for &node in nodes {
        is_simulated[node as usize] = true;
    }
    let is_named = |node: u32| !garment.topology().vertex_faces(node as usize).is_empty();
    let pieces = (0_u32..).zip(is_simulated);
    let pieces: Vec<u32> = pieces
        .filter(|&(node, is_simulated)| !is_simulated && is_named(node))
        .map(|(node, _)| node)
        .collect();
    let nearest = |piece: u32, is_meant: &dyn Fn(u32) -> bool| {
        let place = garment.rest_nodes()[piece as usize];
        let found = nodes.iter().copied().filter(|&node| is_meant(node));
        let found = found.map(|node| {
            (
                (garment.rest_nodes()[node as usize] - place).norm_squared(),
                node,
            )
        });
        found.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    // Of each piece, how far from it the nearest cloth is, and which part that belongs to.
    let mut hosts: HashMap<u32, (f32, u32)> = HashMap::new();
    for &piece in &pieces {
        let Some((distance, node)) = nearest(piece, &|_| true) else {
            continue;
        };
        let host = (distance, part[node as usize]);
        let of_piece = hosts.entry(part[piece as usize]).or_insert(host);
        if distance < of_piece.0 {
            *of_piece = host;
        }
    }
    let follows = |&piece: &u32| {
        let (_, host) = hosts.get(&part[piece as usize])?;
        let (_, node) = nearest(piece, &|node| part[node as usize] == *host)?;
        Some((piece, node))
    };
    pieces.iter().filter_map(follows).collect()
}

fn check_start(start: &[Point3], body: &Body) -> Result<(), PackageError> {
    let skin = body.skin();
    if !skin.is_closed() {
        return Ok(());
    }
    let is_inside = skin.contains_all(start);
    let inside = is_inside.iter().filter(|&&is_inside| is_inside).count();
    if inside as f64 <= MAX_SHARE_INSIDE * start.len() as f64 {
        return Ok(());
    }
    let depths = start
        .iter()
        .zip(&is_inside)
        .filter(|&(_, &is_inside)| is_inside);
    let depths = depths.map(|(&point, _)| skin.closest(point).distance_squared.sqrt());
    Err(PackageError::InsideAtStart {
        inside,
        vertices: start.len(),
        deepest: depths.fold(0.0, f32::max),
    })
}
