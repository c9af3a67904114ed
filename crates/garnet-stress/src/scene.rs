//! Scenes at a level of an axis, all made of one package.

use std::hash::Hasher;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use fnv::FnvHasher;
use garnet_body::poses::{BodyAngles, Poser, SelfContact};
use garnet_body::shape::{BodyParameters, Measure, ParametricBody, tape_measures};
use garnet_data::{Tailor, wearer_of};
use garnet_drape::{BoundGarment, Garment, Package};
use garnet_knn::Surface;
use garnet_mesh::{Point3, TriMesh, Vector3, vertex_normals};
use garnet_skin::{Body, Pose, PosedBody, SkinWeights};
use nalgebra::{Isometry3, UnitQuaternion};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::StressError;
use crate::axis::{Axis, Kind};
use crate::child::child;
use crate::damage::{
    coarser_body, finer, finer_body, flipped, in_pieces, joined, layers, lined, resized_body,
    slivers, split, turned_in_patches, with_balls, with_fins, with_holes,
};

/// Clearance of scenes that are about something else, in metres.
const CLEARANCE: f32 = 0.002;

/// The steepest angle of arms or legs that is tried for a depth, in degrees.
const MOST_ADDUCTION: f64 = 60.0;

/// The most that thighs are raised beyond 60 degrees for a depth, in degrees.
const MOST_BEND: f64 = 100.0;

/// Halvings of the angle that gives a depth.
const HALVINGS: usize = 12;

/// A garment on a body in a pose.
pub(crate) struct Scene {
    pub(crate) garment: Arc<BoundGarment>,
    pub(crate) posed: PosedBody,
    /// In metres.
    pub(crate) clearance: f32,
    /// The skin that tells what is inside, if it is not that of the body.
    whole: Option<Surface>,
    /// What brings the scene of the first level here, where that is all that differs.
    pub(crate) moved_by: Option<Isometry3<f32>>,
    /// Vertices of the outer one of two layers, which come first; the lining has as many.
    pub(crate) num_outer: Option<usize>,
    /// The outer and the inner of two garments, of which `garment` is made in that order.
    pub(crate) garments: Option<[Arc<BoundGarment>; 2]>,
    /// Threads to drape with, where their number is the level.
    pub(crate) threads: Option<usize>,
    /// The package with another fabric, where that is what differs.
    pub(crate) package: Option<Package>,
    /// Whether the drape is to be that of the first level.
    pub(crate) is_as_first: bool,
}

impl Scene {
    /// The skin by which inside is decided.
    pub(crate) fn judge(&self) -> &Surface {
        self.whole.as_ref().unwrap_or(self.posed.skin())
    }

    /// Shorter edges count as so long, in metres.
    pub(crate) fn least_edge(&self) -> f32 {
        let lengths = self.garment.cloth().graph().rest_lengths();
        let sum: f64 = lengths.iter().map(|&length| f64::from(length)).sum();
        0.1 * (sum / lengths.len().max(1) as f64) as f32
    }

    /// How large the garment is, in metres.
    pub(crate) fn size(&self) -> f64 {
        let places = self.garment.mesh().positions();
        let (mut low, mut high) = (places[0], places[0]);
        for place in places {
            low = low.inf(place);
            high = high.sup(place);
        }
        f64::from((high - low).norm())
    }
}

/// Makes scenes of a package.
pub(crate) struct Scenes<'a> {
    package: &'a Package,
    poser: Poser,
    contact: SelfContact,
    seed: u64,
}

impl<'a> Scenes<'a> {
    pub(crate) fn new(package: &'a Package, seed: u64) -> Result<Self, StressError> {
        Ok(Self {
            package,
            poser: Poser::new(package.body().skeleton())?,
            contact: SelfContact::new(package.body())?,
            seed,
        })
    }

    /// The scene at a level; none where there is no such body.
    pub(crate) fn at(&self, axis: &Axis, level: f64) -> Result<Option<Scene>, StressError> {
        let mut random = self.random(axis, level);
        let scene = match axis.kind {
            Kind::Twist => self.posed(&self.twisted(level))?,
            Kind::ArmIntoTrunk | Kind::ThighIntoThigh | Kind::BellyIntoLap => {
                match self.pressed(axis.kind, level)? {
                    Some(pose) => self.posed(&pose)?,
                    None => return Ok(None),
                }
            }
            Kind::Heavy | Kind::Thin | Kind::Tall | Kind::Short | Kind::Female | Kind::Male => {
                match self.of_person(axis.kind, level)? {
                    Some(scene) => scene,
                    None => return Ok(None),
                }
            }
            Kind::HeavyCloth | Kind::SoftCloth | Kind::StiffCloth => {
                self.of_fabric(axis.kind, level as f32)?
            }
            Kind::StrongGravity => self.under_gravity(level as f32)?,
            Kind::WeakGravity => self.under_gravity((1.0 - 0.01 * level) as f32)?,
            Kind::Larger => self.scaled(level as f32)?,
            Kind::Smaller => self.scaled(1.0 / level as f32)?,
            Kind::Doll => self.resized(1.0 / level as f32)?,
            Kind::Giant => self.resized(level as f32)?,
            Kind::Child => match child(self.package.garment(), level)? {
                Some((body, mesh)) => Scene {
                    garment: Arc::new(Garment::new(mesh).bind(&body)?),
                    ..self.on(body.posed(&self.usual_pose())?)
                },
                None => return Ok(None),
            },
            Kind::FinerGarment => self.with_garment(finer(self.mesh(), level)?)?,
            Kind::FinerBody => self.with_body(&finer_body(self.package.body(), level)?)?,
            Kind::CoarserGarment => match self.coarser(level)? {
                Some(mesh) => self.with_garment(mesh)?,
                None => return Ok(None),
            },
            Kind::CoarserBody => match coarser_body(self.package.body(), level)? {
                Some(body) => self.with_body(&body)?,
                None => return Ok(None),
            },
            Kind::Noise => self.noisy(level, &mut random)?,
            Kind::Holes => self.with_holes(level, &mut random)?,
            Kind::TurnedSkin => self.turned(level, &mut random)?,
            Kind::Balls => {
                let body = with_balls(self.package.body(), level as usize, &mut random)?;
                self.with_body(&body)?
            }
            Kind::Slivers => self.with_garment(slivers(self.mesh(), level, &mut random)?)?,
            Kind::FlippedFaces => self.with_garment(flipped(self.mesh(), level, &mut random)?)?,
            Kind::SplitVertices => self.with_garment(split(self.mesh(), level, &mut random)?)?,
            Kind::Fins => self.with_garment(with_fins(self.mesh(), level, &mut random)?)?,
            Kind::Pieces => {
                self.with_garment(in_pieces(self.mesh(), level as usize, &mut random)?)?
            }
            Kind::Lining => Scene {
                num_outer: Some(self.mesh().num_vertices()),
                ..self.with_garment(lined(self.mesh(), 1e-3 * (6.0 - level as f32))?)?
            },
            Kind::TwoGarments => self.of_two_garments(1e-3 * (6.0 - level as f32))?,
            Kind::Clearance => Scene {
                clearance: (1e-3 * level) as f32,
                ..self.usual()?
            },
            Kind::Place => self.elsewhere(level as f32)?,
            Kind::Threads => Scene {
                threads: Some(level as usize),
                ..self.usual()?
            },
            Kind::Antipodal => self.antipodal(level, &mut random)?,
            Kind::UnscaledWeights => self.unscaled(level as f32)?,
            kind => self.posed(&self.bent(kind, level))?,
        };
        Ok(Some(scene))
    }

    /// Draws of a level, which depend on the name of the axis: other axes may come and go.
    fn random(&self, axis: &Axis, level: f64) -> ChaCha8Rng {
        let mut hash = FnvHasher::default();
        hash.write(axis.name.as_bytes());
        let seed = self.seed ^ hash.finish() ^ level.to_bits().rotate_left(17);
        ChaCha8Rng::seed_from_u64(seed)
    }

    fn mesh(&self) -> &TriMesh {
        self.package.garment().mesh()
    }

    /// Joints bent from the body at rest, where nothing is wrong; arms, from where they hang.
    fn bent(&self, kind: Kind, degrees: f64) -> Pose {
        let mut pose = self.poser.pose(&bent(kind, degrees));
        if !matches!(
            kind,
            Kind::ShoulderUp | Kind::ShoulderBeyond | Kind::AllBeyond
        ) {
            let start = self.poser.pose(&bent(kind, 0.0));
            for (turn, before) in pose.rotations.iter_mut().zip(&start.rotations) {
                *turn *= before.inverse();
            }
            pose.root_translation = Vector3::zeros();
        }
        pose
    }

    fn at_rest(&self) -> Pose {
        Pose::rest(self.package.body().skeleton().num_joints())
    }

    /// The pose of scenes whose meshes are damaged.
    fn usual_pose(&self) -> Pose {
        self.poser.pose(&usual())
    }

    fn usual(&self) -> Result<Scene, StressError> {
        self.posed(&self.usual_pose())
    }

    fn posed(&self, pose: &Pose) -> Result<Scene, StressError> {
        Ok(self.on(self.package.body().posed(pose)?))
    }

    fn on(&self, posed: PosedBody) -> Scene {
        Scene {
            garment: Arc::clone(self.package.garment()),
            posed,
            clearance: CLEARANCE,
            whole: None,
            moved_by: None,
            num_outer: None,
            garments: None,
            threads: None,
            package: None,
            is_as_first: false,
        }
    }

    /// An upper arm turned about itself.
    fn twisted(&self, degrees: f64) -> Pose {
        let mut pose = self.at_rest();
        let skeleton = self.package.body().skeleton();
        let elbow = skeleton.find("left_elbow");
        let parent = elbow.and_then(|elbow| skeleton.joints()[elbow].parent);
        if let (Some(elbow), Some(shoulder)) = (elbow, parent) {
            let joints = skeleton.joints();
            let bone = joints[elbow].rest_position - joints[shoulder].rest_position;
            if let Some(axis) = nalgebra::Unit::try_new(bone, 1e-9) {
                let turn = UnitQuaternion::from_axis_angle(&axis, degrees.to_radians() as f32);
                pose.rotations[shoulder] *= turn;
            }
        }
        pose
    }

    /// Arms or thighs pressed inwards, or thighs raised against a bent trunk, until they run so
    /// deep into each other; none if they never do.
    fn pressed(&self, kind: Kind, millimetres: f64) -> Result<Option<Pose>, StressError> {
        let pose = |degrees: f64| {
            let mut angles = BodyAngles::default();
            let (legs, arms) = (&mut angles.legs, &mut angles.arms);
            match kind {
                Kind::ArmIntoTrunk => arms
                    .iter_mut()
                    .for_each(|arm| arm.abduction = 20.0 - degrees),
                Kind::BellyIntoLap => {
                    for (leg, arm) in legs.iter_mut().zip(arms) {
                        (leg.flexion, arm.abduction) = (60.0 + degrees, 70.0);
                    }
                    angles.spine.flexion = 40.0;
                }
                _ => {
                    angles = usual();
                    angles
                        .legs
                        .iter_mut()
                        .for_each(|leg| leg.abduction = 10.0 - degrees);
                }
            }
            self.poser.pose(&angles)
        };
        let is_in_lap = kind == Kind::BellyIntoLap;
        let depth = |degrees: f64| -> Result<f64, StressError> {
            let report = self.contact.report(&pose(degrees))?;
            let depth = if is_in_lap {
                report.crease_depth()
            } else {
                report.depth()
            };
            Ok(f64::from(depth))
        };
        let is_deep = |degrees: f64| -> Result<bool, StressError> {
            Ok(depth(degrees)? >= 1e-3 * millimetres)
        };
        if millimetres <= 0.0 {
            return Ok(Some(pose(0.0)));
        }
        let most = if is_in_lap { MOST_BEND } else { MOST_ADDUCTION };
        if !is_deep(most)? {
            return Ok(None);
        }
        let (mut low, mut high) = (0.0, most);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if is_deep(middle)? {
                high = middle;
            } else {
                low = middle;
            }
        }
        Ok(Some(pose(high)))
    }

    /// A body of another mass, stature or sex; none for bodies that are not built in, or one that
    /// nobody has.
    fn of_person(&self, kind: Kind, level: f64) -> Result<Option<Scene>, StressError> {
        let body = self.package.body();
        let Some(measures) = tape_measures(body) else {
            return Ok(None);
        };
        let (mut sex, mut stature, mut bmi) = (0.5, measures[Measure::Stature], 22.0);
        match kind {
            Kind::Thin => bmi -= level,
            Kind::Tall => stature = level,
            Kind::Short => stature = 1.7 - level,
            Kind::Female => sex += 0.5 * level,
            Kind::Male => sex -= 0.5 * level,
            _ => bmi = level,
        }
        let parameters = BodyParameters::new(sex).with(Measure::Stature, stature);
        let Ok(other) = ParametricBody::build(&parameters.with_bmi(bmi)) else {
            return Ok(None);
        };
        let target = other.body().posed(&self.at_rest())?;
        Ok(Some(self.on(body.fitted(target.skin().positions())?)))
    }

    /// The garment of a fabric that is so many times heavier, easier to stretch, or stiffer.
    fn of_fabric(&self, kind: Kind, times: f32) -> Result<Scene, StressError> {
        let mut content = self.package.content().clone();
        let fabric = &mut content.manifest.fabric;
        match kind {
            Kind::HeavyCloth => fabric.density *= times,
            Kind::SoftCloth => fabric.membrane /= times,
            _ => fabric.bending *= times,
        }
        let package = self.package.with_content(content)?;
        Ok(Scene {
            package: Some(package),
            ..self.usual()?
        })
    }

    /// The usual scene under so many times the gravity of the earth.
    fn under_gravity(&self, times: f32) -> Result<Scene, StressError> {
        Ok(Scene {
            package: Some(self.package.with_gravity(times)?),
            ..self.usual()?
        })
    }

    /// The usual scene, with turns of some joints given by their other quaternion.
    fn antipodal(&self, percent: f64, random: &mut ChaCha8Rng) -> Result<Scene, StressError> {
        let mut pose = self.usual_pose();
        for turn in &mut pose.rotations {
            if random.random_range(0.0..100.0) < percent {
                *turn = UnitQuaternion::new_unchecked(-turn.into_inner());
            }
        }
        Ok(Scene {
            is_as_first: true,
            ..self.posed(&pose)?
        })
    }

    /// The usual scene, on a body whose weights have another sum.
    fn unscaled(&self, sum: f32) -> Result<Scene, StressError> {
        let body = self.package.body();
        let weights = body.weights();
        let rows = (0..body.rest().num_vertices()).map(|vertex| {
            let row = weights.vertex(vertex);
            row.map(|(joint, weight)| (joint, sum * weight))
        });
        let weights = SkinWeights::from_influences(body.skeleton().num_joints(), rows)?;
        let body = Body::new(body.rest().clone(), body.skeleton().clone(), weights)?;
        Ok(Scene {
            is_as_first: true,
            ..self.with_body(&body)?
        })
    }

    fn scaled(&self, size: f32) -> Result<Scene, StressError> {
        let body = self.package.body();
        let posed = body.posed(&self.at_rest())?;
        let places = posed.skin().positions().iter();
        let places: Vec<Point3> = places.map(|place| place * size).collect();
        Ok(self.on(body.fitted(&places)?))
    }

    fn noisy(&self, millimetres: f64, random: &mut ChaCha8Rng) -> Result<Scene, StressError> {
        let body = self.package.body();
        let posed = body.posed(&self.at_rest())?;
        let skin = posed.skin();
        let normals = vertex_normals(skin.positions(), skin.faces());
        let mut bell = || {
            (0..3)
                .map(|_| random.random_range(-1.0..1.0_f32))
                .sum::<f32>()
        };
        let places = skin.positions().iter().zip(&normals);
        // The sum of three such numbers has variance one.
        let places =
            places.map(|(place, normal)| place + (1e-3 * millimetres as f32 * bell()) * normal);
        let places: Vec<Point3> = places.collect();
        Ok(self.on(body.fitted(&places)?))
    }

    /// The garment cut anew with fewer vertices; none if it is from no pattern.
    fn coarser(&self, times: f64) -> Result<Option<TriMesh>, StressError> {
        if times <= 1.0 {
            return Ok(Some(self.mesh().clone()));
        }
        let body = self.package.body();
        let wearer = wearer_of(body).and_then(Result::ok);
        let tailor = Tailor::of_package(self.package.content())?;
        let (Some(tailor), Some(wearer)) = (tailor, wearer) else {
            return Ok(None);
        };
        let count = (self.mesh().num_vertices() as f64 / times) as usize;
        let fabric = self.package.manifest().fabric.clone();
        let size = tailor.size();
        // Patterns have a least number of vertices.
        let Ok(tailor) = Tailor::new(tailor.parameters().clone(), count, fabric) else {
            return Ok(None);
        };
        let tailor = tailor.with_size(size);
        let worn = tailor.dress(body, &wearer, &AtomicBool::new(false))?;
        Ok(Some(TriMesh::new(worn.positions, worn.sewn.faces)?))
    }

    fn with_garment(&self, mesh: TriMesh) -> Result<Scene, StressError> {
        let garment = Garment::new(mesh).bind(self.package.body())?;
        Ok(Scene {
            garment: Arc::new(garment),
            ..self.usual()?
        })
    }

    /// The garment, and one of the same cut so far over it, in metres.
    fn of_two_garments(&self, apart: f32) -> Result<Scene, StressError> {
        let [outer, inner] = layers(self.mesh(), [apart, 0.0])?;
        let both = joined(&outer, &inner)?;
        let bind = |mesh| Garment::new(mesh).bind(self.package.body()).map(Arc::new);
        Ok(Scene {
            garments: Some([bind(outer)?, bind(inner)?]),
            ..self.with_garment(both)?
        })
    }

    fn with_body(&self, body: &Body) -> Result<Scene, StressError> {
        let garment = Garment::new(self.mesh().clone()).bind(body)?;
        let posed = body.posed(&self.usual_pose())?;
        Ok(Scene {
            garment: Arc::new(garment),
            posed,
            ..self.usual()?
        })
    }

    fn with_holes(&self, percent: f64, random: &mut ChaCha8Rng) -> Result<Scene, StressError> {
        let body = self.package.body();
        let whole = body.posed(&self.usual_pose())?.skin().clone();
        let rest = with_holes(body.rest(), percent, random)?;
        let body = Body::new(rest, body.skeleton().clone(), body.weights().clone())?;
        Ok(Scene {
            whole: Some(whole),
            ..self.with_body(&body)?
        })
    }

    fn turned(&self, percent: f64, random: &mut ChaCha8Rng) -> Result<Scene, StressError> {
        let body = self.package.body();
        let whole = body.posed(&self.usual_pose())?.skin().clone();
        let rest = turned_in_patches(body.rest(), percent, random)?;
        let body = Body::new(rest, body.skeleton().clone(), body.weights().clone())?;
        Ok(Scene {
            whole: Some(whole),
            ..self.with_body(&body)?
        })
    }

    /// Garment, body and clearance in another size.
    fn resized(&self, times: f32) -> Result<Scene, StressError> {
        let body = resized_body(self.package.body(), times)?;
        let places = self.mesh().positions().iter().map(|place| place * times);
        let mesh = TriMesh::new(places.collect(), self.mesh().faces().to_vec())?;
        let garment = Garment::new(mesh).bind(&body)?;
        Ok(Scene {
            garment: Arc::new(garment),
            clearance: CLEARANCE * times,
            ..self.on(body.posed(&self.usual_pose())?)
        })
    }

    fn elsewhere(&self, metres: f32) -> Result<Scene, StressError> {
        let body = self.package.body();
        let here = self.usual_pose();
        let mut there = here.clone();
        let root = body
            .skeleton()
            .parents_first()
            .first()
            .copied()
            .unwrap_or(0);
        if metres > 0.0 {
            // About the vertical: cloth hangs down.
            let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 2.0);
            there.rotations[root] = turn * there.rotations[root];
            there.root_translation += Vector3::new(0.6, 0.0, -0.8) * metres;
        }
        let (before, after) = (body.posed(&here)?, body.posed(&there)?);
        let moved = after.posed_from_rest()[root] * before.posed_from_rest()[root].inverse();
        Ok(Scene {
            moved_by: Some(moved),
            ..self.on(after)
        })
    }
}

fn usual() -> BodyAngles {
    let mut angles = BodyAngles::default();
    for arm in &mut angles.arms {
        (arm.abduction, arm.flexion, arm.elbow) = (45.0, 20.0, 30.0);
    }
    for leg in &mut angles.legs {
        (leg.flexion, leg.abduction, leg.knee) = (15.0, 8.0, 20.0);
    }
    angles
}

fn bent(kind: Kind, degrees: f64) -> BodyAngles {
    let mut angles = usual();
    match kind {
        Kind::Elbow => angles.arms.iter_mut().for_each(|arm| arm.elbow = degrees),
        Kind::ShoulderUp => {
            for arm in &mut angles.arms {
                (arm.abduction, arm.flexion, arm.elbow) = (degrees + 10.0, 0.0, 0.0);
            }
        }
        Kind::ShoulderBeyond => {
            for arm in &mut angles.arms {
                (arm.abduction, arm.flexion, arm.elbow) = (15.0, -60.0 - degrees, 0.0);
            }
        }
        Kind::Knee => angles.legs.iter_mut().for_each(|leg| leg.knee = degrees),
        Kind::Hip => angles.legs.iter_mut().for_each(|leg| {
            (leg.flexion, leg.knee) = (degrees, degrees.min(90.0));
        }),
        Kind::Stride => {
            let [left, right] = &mut angles.legs;
            (left.flexion, right.flexion) = (degrees, -0.5 * degrees);
        }
        Kind::Trunk => angles.spine.flexion = degrees,
        Kind::NeckBeyond => angles.neck.flexion = 45.0 + degrees,
        Kind::AllBeyond => {
            angles.spine.flexion = 60.0 + 0.5 * degrees;
            angles.neck.flexion = 45.0 + degrees;
            for arm in &mut angles.arms {
                (arm.abduction, arm.flexion, arm.elbow) = (15.0, -60.0 - degrees, 0.0);
            }
            for leg in &mut angles.legs {
                (leg.flexion, leg.abduction, leg.knee) = (-20.0 - degrees, 45.0 + degrees, 0.0);
            }
        }
        Kind::AllJoints => {
            angles.spine.flexion = 0.6 * degrees;
            for arm in &mut angles.arms {
                (arm.flexion, arm.elbow) = (degrees, degrees);
            }
            for leg in &mut angles.legs {
                (leg.flexion, leg.knee) = (degrees, degrees);
            }
        }
        _ => {}
    }
    angles
}
