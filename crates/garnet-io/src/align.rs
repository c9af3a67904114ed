//! Bringing a garment to its body that does not lie on it.
//!
//! Axes, units and places of garments are guessed one after the other, each guess is fitted to the
//! skin by a similarity, and the one is taken in which the cloth lies nearest to the skin, outside
//! of it, with limbs through its openings. Sleeves that stick out otherwise than the arms do are
//! tried on the body with its arms there, and brought back with them.

use std::fmt;

use garnet_body::{
    motion::{Figure, Role, Side},
    poses::{Poser, key_pose},
};
use garnet_knn::Surface;
use garnet_mesh::{Bounds, Point3, Topology, TriMesh, Vector3};
use garnet_skin::{Body, Garment, Method, SkinError, Warp, Weld};
use nalgebra::{Isometry3, SMatrix, SVector, UnitQuaternion};
use rayon::prelude::*;

use crate::{Frame, check_offsets, check_sizes};

/// Factors of lengths that other units and none make.
const UNITS: [f32; 9] = [1.0, 0.01, 0.1, 0.001, 0.0254, 0.3048, 10.0, 100.0, 1000.0];

/// Largest extents of garments that are looked at, over the height of the body.
const SIZES: [f32; 2] = [0.1, 1.3];

/// Extents that garments have in the unit that they are read in, over the height of the body: no
/// other unit is looked for. A wider range misses garments in feet.
const AS_IT_IS: [f32; 2] = [0.2, 1.05];

/// Garments with fewer openings have no sleeves.
const LEAST_SLEEVED: usize = 3;

/// The extent of a garment of unknown unit, over the height of the body.
const USUAL_SIZE: f32 = 0.45;

/// By how much garments may be of another size.
const OTHER_SIZE: [f32; 2] = [0.75, 1.35];

/// Garments of a size at an end of that range lie no farther from the skin in the mean, over the
/// height of the body, if they are of that size.
const LOOSE: f32 = 0.03;

/// A size that differs by less is that of the body.
const SAME_SIZE: f32 = 0.04;

/// Another size than that of the unit has to fit so much better.
const CLEARLY: f32 = 1.5;

/// Cloth of which 1 % of the edges grow by more than this when its arms are brought to those of the
/// body has no sleeves in that pose. Sleeves that are brought from `t_pose` to hanging arms grow by
/// half at the armpits; a dress without sleeves, by twice. A lower value refuses the former.
const PULLED_APART: f32 = 1.75;

/// Poses of the library whose arms are tried.
const ARMS: [&str; 3] = ["t_pose", "a_pose", "stand"];

/// Vertices by which guesses are compared, and by which the best are fitted.
const SAMPLES: [usize; 2] = [150, 500];

/// Steps of fitting of guesses, and of the best.
const STEPS: [usize; 2] = [10, 40];

/// How many guesses are fitted in earnest.
const NUM_BEST: usize = 6;

/// Distance of cloth from the skin that it is fitted to, over the height of the body.
const EASE: f32 = 0.006;

/// Distances beyond this count no more, over the height of the body.
const FAR: f32 = 0.12;

/// Depth in the body counts so much more than distance from it.
const INSIDE: f32 = 4.0;

/// Cloth that is deeper than this is in the body, over the height of the body.
const DEEP: f32 = 0.002;

/// Cloth that is deeper than this anywhere does not lie on the body, over the height of the body: 3
/// cm of a human figure, from which on a drape warns. Jeans that are back to front are that deep.
const TOO_DEEP: f32 = 0.018;

/// Share of a garment that may be in the body if it lies on it.
const INSIDE_SHARE: f32 = 0.15;

/// A step of fitting turns by no more than this, in radians: more may jump to another side.
const MOST_YAW: f32 = 0.15;

/// What an opening without a limb through it counts, if all are, over the height of the body.
const UNTHREADED: f32 = 0.05;

/// What a turn about the vertical counts, and the same of other axes up or arms in another pose,
/// over the height of the body: less than any fit that is clearly better.
const TURNED: f32 = 0.0006;

/// Rims shorter than this are buttonholes, over four times the diagonal of the garment's box. A
/// higher one loses the cuffs of long sleeves that stick out, which have 0.03.
pub(crate) const LEAST_RIM: f32 = 0.02;

/// What was done with a garment to bring it to its body.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Alignment {
    /// By what its lengths were multiplied.
    pub scale: f32,
    /// Whether z was up in it, and y is now.
    pub was_z_up: bool,
    /// By how much it was turned about the vertical, in degrees.
    pub yaw: f32,
    /// By how much its middle was moved, in metres, after scaling.
    pub moved: Vector3,
    /// The pose of the library in which its arms were, if they are not those of the body.
    pub arms: Option<&'static str>,
    /// Openings of the garment, and how many of them a limb goes through.
    pub openings: [usize; 2],
    /// The mean distance of its vertices from the skin, in metres.
    pub mean_distance: f32,
}

impl fmt::Display for Alignment {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut done = Vec::new();
        if (self.scale - 1.0).abs() > 1e-4 {
            done.push(format!("its lengths multiplied by {:.4}", self.scale));
        }
        if self.was_z_up {
            done.push("turned from z up to y up".to_owned());
        }
        if self.yaw.abs() > 0.5 {
            done.push(format!(
                "turned by {:.0} degrees about the vertical",
                self.yaw
            ));
        }
        if self.moved.norm() > 1e-4 {
            let [x, y, z] = self.moved.into();
            done.push(format!("moved by {x:.3} {y:.3} {z:.3} m"));
        }
        if let Some(arms) = self.arms {
            done.push(format!("its sleeves brought from the pose `{arms}`"));
        }
        if done.is_empty() {
            done.push("nothing to do".to_owned());
        }
        let [openings, threaded] = self.openings;
        write!(
            formatter,
            "{}; limbs go through {threaded} of its {openings} openings, and it is {:.0} mm from \
             the skin in the mean",
            done.join(", "),
            1e3 * self.mean_distance
        )
    }
}

/// A garment as guessed: a turn, a scale, and a place.
#[derive(Debug, Clone, Copy)]
struct Guess {
    is_z_up: bool,
    /// Quarter turns about the vertical.
    quarters: u8,
    /// By how much it is turned besides, in radians.
    yaw: f32,
    /// From the file to the body.
    scale: f32,
    turn: UnitQuaternion<f32>,
    /// Where the middle of the garment goes.
    middle: Point3,
    /// The factor of the unit.
    unit: f32,
}

impl Guess {
    /// Whether its size is the smallest or the largest that is tried.
    fn is_at_limit(&self) -> bool {
        let [least, most] = OTHER_SIZE;
        let size = self.scale / self.unit;
        size < least * (1.0 + SAME_SIZE) || size > most * (1.0 - SAME_SIZE)
    }

    /// The turn about the vertical, in degrees.
    fn degrees(&self) -> f32 {
        [0.0, 90.0, 180.0, -90.0][usize::from(self.quarters)] + self.yaw.to_degrees()
    }

    /// The garment where it is.
    fn as_it_is(cloth: &Cloth) -> Self {
        Self {
            is_z_up: false,
            quarters: 0,
            yaw: 0.0,
            scale: 1.0,
            turn: UnitQuaternion::identity(),
            middle: cloth.center,
            unit: 1.0,
        }
    }

    fn at(&self, point: Point3, center: Point3) -> Point3 {
        self.middle + self.turn * ((point - center) * self.scale)
    }
}

/// What is free in a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Free {
    Place,
    /// The turn about the vertical, too.
    Turn,
    TurnAndSize,
}

/// What of a garment is fitted.
struct Cloth {
    positions: Vec<Point3>,
    center: Point3,
    bounds: Bounds,
    /// Vertices of each opening, in their order.
    rims: Vec<Vec<Point3>>,
}

/// A body in a pose.
pub(crate) struct Wearer {
    arms: Option<&'static str>,
    transforms: Option<Vec<Isometry3<f32>>>,
    skin: Surface,
    /// Bones, the last ones of limbs longer.
    pub(crate) bones: Vec<[Point3; 2]>,
    pub(crate) height: f32,
    /// Middles and heights that tops and bottoms of garments are tried at.
    tops: Vec<Point3>,
    bottoms: Vec<Point3>,
}

/// The garment on the body, if there is a way to bring it there, and what was done: nothing with
/// one that lies on it.
///
/// Both are in metres with y up, as far as that is known.
///
/// # Errors
///
/// Those of skinning, for a body or garment out of any range.
pub fn aligned(garment: &TriMesh, body: &Body) -> Result<Option<(TriMesh, Alignment)>, SkinError> {
    let Some(cloth) = Cloth::new(garment) else {
        return Ok(None);
    };
    let at_rest = Wearer::at_rest(body);
    if let Some(alignment) = cloth.as_it_is(garment, body, &at_rest) {
        return Ok(Some((garment.clone(), alignment)));
    }
    if let Some(found) = cloth.in_place(garment, body, &at_rest) {
        return Ok(Some(found));
    }
    let mut wearers = vec![at_rest];
    // A skirt has no sleeves whose pose could be another one.
    let has_sleeves = cloth.rims.len() >= LEAST_SLEEVED;
    for arms in ARMS.into_iter().filter(|_| has_sleeves) {
        wearers.extend(Wearer::posed(body, arms)?);
    }
    let guesses = cloth.guesses(&wearers[0]);
    let mut found: Vec<(f32, Guess)> = guesses
        .par_iter()
        .map(|guess| cloth.fitted(guess, &wearers[0], SAMPLES[0], STEPS[0], Free::Place))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(NUM_BEST);
    let tried: Vec<(usize, Guess)> = (0..wearers.len())
        .flat_map(|wearer| found.iter().map(move |&(_, guess)| (wearer, guess)))
        .collect();
    let fitted = tried.par_iter().map(|&(wearer, guess)| {
        let (score, guess) = cloth.fitted_simply(&guess, &wearers[wearer]);
        (score, wearer, guess)
    });
    let mut fitted: Vec<(f32, usize, Guess)> = fitted.collect();
    fitted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let center = cloth.center;
    let mut best = None;
    for (_, wearer, guess) in fitted {
        let placed = garment.positions().iter().map(|p| guess.at(*p, center));
        let Ok(placed) = garment.with_positions(placed.collect()) else {
            continue;
        };
        let wearer = &wearers[wearer];
        let mesh = match &wearer.transforms {
            Some(transforms) => brought_back(&placed, body, wearer, transforms)?,
            None => Some(placed),
        };
        if let Some(mesh) = mesh {
            best = Some((mesh, wearer, guess));
            break;
        }
    }
    let Some((mesh, wearer, guess)) = best else {
        return Ok(None);
    };
    // What is best may be no place to be bound at.
    if Cloth::new(&mesh).is_none_or(|placed| placed.lies_on(body).is_none()) {
        return Ok(None);
    }
    let mean_distance = mean_distance(&mesh, body);
    if guess.is_at_limit() && mean_distance > LOOSE * wearer.height {
        // It would be smaller or larger yet, if that were tried.
        return Ok(None);
    }
    let alignment = Alignment {
        scale: guess.scale,
        was_z_up: guess.is_z_up,
        yaw: guess.degrees(),
        moved: guess.middle - turned_center(&guess, center),
        arms: wearer.arms,
        openings: [cloth.rims.len(), cloth.num_threaded(&guess, wearer)],
        mean_distance,
    };
    Ok(Some((mesh, alignment)))
}

/// The mean distance of vertices from the skin, in metres.
fn mean_distance(garment: &TriMesh, body: &Body) -> f32 {
    let near = body.skin().closest_all(garment.positions());
    let sum: f64 = near
        .iter()
        .map(|near| f64::from(near.distance_squared.sqrt()))
        .sum();
    (sum / near.len().max(1) as f64) as f32
}

/// How many openings a garment has, and through how many of them a limb of the body goes on which
/// it lies.
pub fn threaded_openings(garment: &TriMesh, body: &Body) -> [usize; 2] {
    let Some(cloth) = Cloth::new(garment) else {
        return [0, 0];
    };
    let as_it_is = Guess::as_it_is(&cloth);
    let wearer = Wearer::at_rest(body);
    [cloth.rims.len(), cloth.num_threaded(&as_it_is, &wearer)]
}

/// Where the middle of a garment is that was scaled and turned about the origin alone.
fn turned_center(guess: &Guess, center: Point3) -> Point3 {
    Point3::from(guess.turn * (center.coords * guess.scale))
}

/// Cloth on the body in another pose, brought to its rest with the arms; none if that pulls it
/// apart, as what has armholes and no sleeves.
fn brought_back(
    cloth: &TriMesh,
    body: &Body,
    wearer: &Wearer,
    transforms: &[Isometry3<f32>],
) -> Result<Option<TriMesh>, SkinError> {
    let Ok(rest) = body.rest().with_positions(wearer.skin.positions().to_vec()) else {
        return Ok(None);
    };
    let skeleton = body.skeleton();
    let skeleton = skeleton.placed(|joint, of| transforms[joint] * of.rest_position)?;
    let posed = Body::new(rest, skeleton, body.weights().clone())?;
    let bound = Garment::new(cloth.clone()).bind(&posed)?;
    let back = transforms.iter().map(Isometry3::inverse).collect();
    let at_rest = posed.fitted_by(body.rest().positions(), back)?;
    let nodes = bound.warped_nodes(&at_rest, Warp::Shape)?;
    let Ok(brought) = cloth.with_positions(bound.weld().scatter(&nodes)) else {
        return Ok(None);
    };
    let lengths = |mesh: &TriMesh| -> Vec<f32> {
        let nodes = bound.weld().gather(mesh.positions());
        let edges = bound.topology().edges().iter();
        let edges = edges.map(|edge| edge.map(|node| nodes[node as usize]));
        edges.map(|[a, b]| (b - a).norm()).collect()
    };
    let pairs = lengths(&brought).into_iter().zip(lengths(cloth));
    let mut stretches: Vec<f32> = pairs.map(|(now, before)| now / before.max(1e-9)).collect();
    let at = stretches.len() * 99 / 100;
    if stretches.len() <= at {
        return Ok(Some(brought));
    }
    let (_, &mut high, _) = stretches.select_nth_unstable_by(at, f32::total_cmp);
    Ok((high < PULLED_APART).then_some(brought))
}

impl Cloth {
    fn new(garment: &TriMesh) -> Option<Self> {
        let bounds = Bounds::of_faces(garment.positions(), garment.faces())?;
        let weld = Weld::new(garment.positions());
        let nodes = weld.gather(garment.positions());
        let topology = Topology::new(nodes.len(), &weld.faces(garment));
        let least = LEAST_RIM * 4.0 * bounds.diagonal();
        let rims = topology.boundary_loops().into_iter().map(|rim| {
            let rim: Vec<Point3> = rim.iter().map(|&node| nodes[node as usize]).collect();
            let ends = rim.iter().zip(rim.iter().cycle().skip(1));
            let length: f32 = ends.map(|(a, b)| (b - a).norm()).sum();
            (length, rim)
        });
        let rims = rims.filter(|(length, rim)| *length > least && rim.len() > 2);
        let named: Vec<Point3> = (0..nodes.len())
            .filter(|&node| !topology.vertex_faces(node).is_empty())
            .map(|node| nodes[node])
            .collect();
        Some(Self {
            positions: named,
            center: bounds.min + 0.5 * bounds.extent(),
            rims: rims.map(|(_, rim)| rim).collect(),
            bounds,
        })
    }

    /// Offsets from the skin and normals there `[vertex]`, of any length, of cloth that lies on the
    /// body; none if it does not.
    fn lies_on(&self, body: &Body) -> Option<(Vec<Vector3>, Vec<Vector3>)> {
        let bounds = Bounds::of_faces(body.rest().positions(), body.rest().faces())?;
        check_sizes(&self.bounds, &bounds, Frame::OURS).ok()?;
        let skin = body.skin();
        let offset = |point: &Point3| {
            let near = skin.closest(*point);
            (point - near.point, skin.pseudonormal(&near))
        };
        let (offsets, normals): (Vec<_>, Vec<_>) = self.positions.iter().map(offset).unzip();
        check_offsets(&self.positions, &offsets, &normals, &bounds).ok()?;
        Some((offsets, normals))
    }

    /// A garment that lies on the body with limbs through its openings; none if it does not.
    fn as_it_is(&self, garment: &TriMesh, body: &Body, wearer: &Wearer) -> Option<Alignment> {
        let (offsets, normals) = self.lies_on(body)?;
        let sides = offsets.iter().zip(&normals);
        let depths = sides.filter(|(offset, normal)| offset.dot(normal) < 0.0);
        let depths = depths.map(|(offset, _)| offset.norm() / wearer.height);
        let inside: Vec<f32> = depths.filter(|&depth| depth > DEEP).collect();
        if inside.len() as f32 > INSIDE_SHARE * offsets.len() as f32
            || inside.iter().any(|&depth| depth > TOO_DEEP)
        {
            return None;
        }
        let threaded = self.num_threaded(&Guess::as_it_is(self), wearer);
        (threaded == self.rims.len()).then(|| Alignment {
            scale: 1.0,
            was_z_up: false,
            yaw: 0.0,
            moved: Vector3::zeros(),
            arms: None,
            openings: [self.rims.len(), threaded],
            mean_distance: mean_distance(garment, body),
        })
    }

    /// The garment with other axes and in another unit, if it lies on the body then where it is:
    /// the one that lies nearest.
    fn in_place(
        &self,
        garment: &TriMesh,
        body: &Body,
        wearer: &Wearer,
    ) -> Option<(TriMesh, Alignment)> {
        let guesses = self.guesses(wearer).into_iter();
        let unmoved = guesses.filter(|guess| guess.middle == turned_center(guess, self.center));
        let found = unmoved.filter_map(|guess| {
            let places = garment.positions().iter();
            let places = places.map(|p| guess.at(*p, self.center)).collect();
            let placed = garment.with_positions(places).ok()?;
            let alignment = Self::new(&placed)?.as_it_is(&placed, body, wearer)?;
            let (score, _) = self.fitted(&guess, wearer, SAMPLES[1], 0, Free::Place);
            let alignment = Alignment {
                scale: guess.scale,
                was_z_up: guess.is_z_up,
                yaw: guess.degrees(),
                ..alignment
            };
            Some((score, placed, alignment))
        });
        let best = found.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map(|(_, placed, alignment)| (placed, alignment))
    }

    /// All axes, units and places.
    fn guesses(&self, wearer: &Wearer) -> Vec<Guess> {
        let extent = self.bounds.extent();
        let size = extent.max() / wearer.height;
        let is_usual = |factor: &f32| (SIZES[0]..SIZES[1]).contains(&(factor * size));
        let mut units: Vec<f32> = UNITS.into_iter().filter(is_usual).collect();
        if (AS_IT_IS[0]..AS_IT_IS[1]).contains(&size) {
            // In another unit it would be of a size that garments have, too: a skirt in metres is
            // an anklet in feet.
            units = vec![1.0];
        }
        if units.is_empty() {
            units.push(USUAL_SIZE / size);
        }
        let mut guesses = Vec::new();
        for is_z_up in [false, true] {
            let upright = if is_z_up {
                UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -std::f32::consts::FRAC_PI_2)
            } else {
                UnitQuaternion::identity()
            };
            for quarters in 0..4_u8 {
                let angle = f32::from(quarters) * std::f32::consts::FRAC_PI_2;
                let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle) * upright;
                for &unit in &units {
                    let half = 0.5 * unit * if is_z_up { extent.z } else { extent.y };
                    let mut guess = Guess {
                        is_z_up,
                        quarters,
                        yaw: 0.0,
                        scale: unit,
                        turn,
                        middle: Point3::origin(),
                        unit,
                    };
                    let as_it_is = turned_center(&guess, self.center);
                    let below = wearer.tops.iter().map(|top| top - Vector3::y() * half);
                    let above = wearer.bottoms.iter().map(|low| low + Vector3::y() * half);
                    for middle in std::iter::once(as_it_is).chain(below).chain(above) {
                        guess.middle = middle;
                        guesses.push(guess);
                    }
                }
            }
        }
        guesses
    }

    /// A guess fitted in earnest, and what it is like: lower is better. Its turn and its size are
    /// those that were guessed, unless others are clearly better.
    fn fitted_simply(&self, guess: &Guess, wearer: &Wearer) -> (f32, Guess) {
        let fit = |guess: &Guess, free| self.fitted(guess, wearer, SAMPLES[1], STEPS[1], free);
        let free = fit(guess, Free::TurnAndSize);
        let turned = fit(guess, Free::Turn);
        let from = Guess {
            middle: free.1.middle,
            ..*guess
        };
        let fixed = fit(&from, Free::Place);
        // A size that is about that of the body is.
        let is_same = (free.1.scale / guess.unit - 1.0).abs() < SAME_SIZE;
        let is_as_good = |simple: f32, other: f32| simple < CLEARLY * other;
        if is_as_good(fixed.0, turned.0) && (is_same || is_as_good(fixed.0, free.0)) {
            fixed
        } else if is_same || is_as_good(turned.0, free.0) {
            turned
        } else {
            free
        }
    }

    /// A guess fitted to the skin in some steps, and what it is like: lower is better.
    fn fitted(
        &self,
        guess: &Guess,
        wearer: &Wearer,
        samples: usize,
        steps: usize,
        free: Free,
    ) -> (f32, Guess) {
        let stride = self.positions.len().div_ceil(samples).max(1);
        let points: Vec<Point3> = self.positions.iter().step_by(stride).copied().collect();
        let mut guess = *guess;
        let mut best = (f32::INFINITY, guess);
        for step in 0..=steps {
            let (cost, change) = self.step(&points, &guess, wearer, free);
            let score = cost + self.rank(&guess, wearer);
            if score < best.0 {
                best = (score, guess);
            }
            if step == steps {
                break;
            }
            guess.middle += Vector3::new(change[0], change[1], change[2]);
            if free == Free::Turn || free == Free::TurnAndSize {
                // A large step would leave the turn that was guessed.
                let yaw = change[4].clamp(-MOST_YAW, MOST_YAW);
                guess.turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), yaw) * guess.turn;
                guess.yaw += yaw;
            }
            if free == Free::TurnAndSize {
                let [least, most] = OTHER_SIZE.map(|factor| factor * guess.unit);
                guess.scale = (guess.scale * (1.0 + change[3])).clamp(least, most);
            }
        }
        best
    }

    /// The mean cost of points, and the move, growth and turn about the vertical that lower it.
    fn step(
        &self,
        points: &[Point3],
        guess: &Guess,
        wearer: &Wearer,
        free: Free,
    ) -> (f32, SVector<f32, 5>) {
        let (ease, far) = (EASE * wearer.height, FAR * wearer.height);
        let mut square = SMatrix::<f32, 5, 5>::identity() * 1e-4;
        let mut wished = SVector::<f32, 5>::zeros();
        let mut sum = 0.0;
        for point in points {
            let place = guess.at(*point, self.center);
            let near = wearer.skin.closest(place);
            let offset = place - near.point;
            let is_inside = offset.dot(&wearer.skin.pseudonormal(&near)) < 0.0;
            let distance = near.distance_squared.sqrt();
            let signed = if is_inside { -distance } else { distance };
            let miss = signed - ease;
            let weight = if miss < 0.0 { INSIDE } else { 1.0 };
            sum += weight * miss.abs().min(far);
            let Some(way) = offset.try_normalize(1e-9) else {
                continue;
            };
            let way = if is_inside { -way } else { way };
            // What is far tells less.
            let weight = weight / (1.0 + (miss / (0.25 * far)).powi(2));
            let from_middle = place - guess.middle;
            let growth = way.dot(&from_middle);
            let yaw = way.dot(&Vector3::y().cross(&from_middle));
            let row = SVector::<f32, 5>::new(way.x, way.y, way.z, growth, yaw);
            square += row * row.transpose() * (weight / points.len() as f32);
            wished -= row * (weight * miss / points.len() as f32);
        }
        if free == Free::Place {
            // Nothing is left to a turn.
            square[(4, 4)] += 1e6;
        }
        let change = square.cholesky().map(|factor| factor.solve(&wished));
        let cost = sum / points.len().max(1) as f32;
        (cost, change.unwrap_or_else(SVector::zeros))
    }

    /// What counts besides distances.
    fn rank(&self, guess: &Guess, wearer: &Wearer) -> f32 {
        let rims = self.rims.len();
        let bare = rims - self.num_threaded(guess, wearer);
        let turns = [guess.is_z_up, guess.quarters != 0, guess.quarters % 2 == 1];
        let turns = turns.into_iter().filter(|&is_turned| is_turned).count();
        let arms = usize::from(wearer.arms.is_some());
        wearer.height
            * (UNTHREADED * bare as f32 / rims.max(1) as f32 + TURNED * (turns + arms) as f32)
    }

    /// How many openings a limb goes through.
    fn num_threaded(&self, guess: &Guess, wearer: &Wearer) -> usize {
        let is_threaded = |rim: &&Vec<Point3>| {
            let rim: Vec<Point3> = rim.iter().map(|p| guess.at(*p, self.center)).collect();
            is_threaded(&rim, &wearer.bones)
        };
        self.rims.iter().filter(is_threaded).count()
    }
}

/// Whether a bone goes through an opening, whose vertices are in their order.
pub(crate) fn is_threaded(rim: &[Point3], bones: &[[Point3; 2]]) -> bool {
    let middle = rim.iter().map(|p| p.coords).sum::<Vector3>() / rim.len().max(1) as f32;
    let middle = Point3::from(middle);
    let ends = || rim.iter().zip(rim.iter().cycle().skip(1));
    bones.iter().any(|bone| {
        let hits = ends().filter(|&(a, b)| crosses(bone, [middle, *a, *b]));
        hits.count() % 2 == 1
    })
}

/// Whether a segment goes through a triangle.
fn crosses([from, to]: &[Point3; 2], [a, b, c]: [Point3; 3]) -> bool {
    let (way, first, second) = (to - from, b - a, c - a);
    let across = way.cross(&second);
    let det = first.dot(&across);
    if det.abs() < 1e-12 {
        return false;
    }
    let start = from - a;
    let u = start.dot(&across) / det;
    let around = start.cross(&first);
    let v = way.dot(&around) / det;
    let t = second.dot(&around) / det;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&t)
}

impl Wearer {
    pub(crate) fn at_rest(body: &Body) -> Self {
        let joints = body.skeleton().joints().iter();
        let joints: Vec<Point3> = joints.map(|joint| joint.rest_position).collect();
        Self::new(body, body.skin().clone(), &joints)
    }

    /// The body with its arms as in a pose of the library; none if it is no human figure.
    fn posed(body: &Body, arms: &'static str) -> Result<Option<Self>, SkinError> {
        let (Ok(poser), Some(pose)) = (Poser::new(body.skeleton()), key_pose(arms)) else {
            return Ok(None);
        };
        let Ok(figure) = Figure::new(body.skeleton(), "the body") else {
            return Ok(None);
        };
        let full = poser.pose(&pose.angles);
        // The arms alone: the rest of the body stays as it is.
        let mut pose = garnet_skin::Pose::rest(body.skeleton().num_joints());
        for side in Side::BOTH {
            for role in [Role::Collar(side), Role::Shoulder(side), Role::Elbow(side)] {
                if let Some(joint) = figure.joint(role) {
                    pose.rotations[joint] = full.rotations[joint];
                }
            }
        }
        let transforms = body.skeleton().transforms(&pose)?;
        let skin = body
            .skin()
            .moved(body.posed_positions(&pose, Method::DualQuaternion)?)?;
        let joints = body.skeleton().joints().iter().zip(&transforms);
        let joints: Vec<Point3> = joints.map(|(of, moved)| moved * of.rest_position).collect();
        Ok(Some(Self {
            arms: Some(arms),
            transforms: Some(transforms),
            ..Self::new(body, skin, &joints)
        }))
    }

    fn new(body: &Body, skin: Surface, joints: &[Point3]) -> Self {
        let (low, high) = skin.bounds();
        let height = high.y - low.y;
        let of = body.skeleton().joints();
        let mut bones = Vec::new();
        for (joint, place) in joints.iter().enumerate() {
            if let Some(parent) = of[joint].parent {
                bones.push([joints[parent], *place]);
            }
            // The last bone of a limb goes on for as long as a hand or a foot.
            let is_last = of.iter().all(|other| other.parent != Some(joint));
            if let Some(before) = of[joint].parent.filter(|_| is_last) {
                let way = (place - joints[before]).try_normalize(1e-6);
                bones.extend(way.map(|way| [*place, place + way * (0.07 * height)]));
            }
        }
        let middle = low + 0.5 * (high - low);
        let at = |height: f32, of: Point3| Point3::new(of.x, height, of.z);
        let mut tops = vec![at(high.y, middle)];
        let mut bottoms = vec![at(low.y, middle)];
        if let Ok(figure) = Figure::new(body.skeleton(), "the body") {
            let pelvis = joints[figure.pelvis()];
            let neck = figure.neck().first().map_or(figure.chest(), |&neck| neck);
            let neck = joints[neck];
            tops.push(at(neck.y + 0.02 * height, neck));
            tops.push(at(pelvis.y + 0.07 * height, pelvis));
            bottoms.push(at(pelvis.y - 0.05 * height, pelvis));
            if let Some(head) = figure.joint(Role::Head) {
                bottoms.push(at(joints[head].y, joints[head]));
            }
        }
        Self {
            arms: None,
            transforms: None,
            skin,
            bones,
            height,
            tops,
            bottoms,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use garnet_mesh::primitives::tube;

    #[test]
    fn cuffs_of_sleeves_that_stick_out_are_openings_and_buttonholes_are_not() {
        let (mut places, mut faces) = (Vec::new(), Vec::new());
        // A trunk, two sleeves that end 0.8 m beside its middle, and a buttonhole.
        for (radius, at) in [(0.2, 0.0), (0.035, 0.8), (0.035, -0.8), (0.005, 0.3)] {
            let part = tube(radius, 0.4, 24, 4);
            let first = places.len() as u32;
            places.extend(part.positions().iter().map(|p| p + Vector3::x() * at));
            faces.extend(part.faces().iter().map(|face| face.map(|v| v + first)));
        }
        let garment = TriMesh::new(places, faces).unwrap();
        // Both ends of each tube but of the last.
        assert_eq!(Cloth::new(&garment).unwrap().rims.len(), 6);
    }
}
