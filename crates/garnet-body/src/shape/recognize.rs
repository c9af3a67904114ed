//! The built-in body from its mesh alone.
//!
//! Each joint is a fixed combination `Σ w v` of vertices of the rest mesh, with weights that sum to
//! one: it moves, turns and grows with the mesh, whatever its unit and up axis. The weights were
//! fitted by ridge regression over bodies of the population (`garnet-lab make-joints`), which also
//! tells how far they are off on other bodies.

use std::borrow::Cow;
use std::sync::OnceLock;

use garnet_mesh::{Point3, TriMesh, Vector3};
use garnet_skin::{Body, Joint, PosedBody, Skeleton, SkinError};

use super::body::shared;
use super::skeleton::{JOINT_NAMES, JOINT_PARENTS, NUM_JOINTS, mirrored};
use super::template::Template;

/// Little-endian: for the joints of the middle and the left side, in order, `u16` count, then for
/// each of them `u16` vertex of the half and `f32` weight.
static STORED: &[u8] = include_bytes!("joints.bin");

/// At rest a body is its own mirror image up to this, in its extents.
const MAX_ASYMMETRY: f32 = 1e-3;

/// And the upper arms and thighs are so far from the direction of the trunk, in degrees, give or
/// take.
const REST_ARM: f32 = 45.0;
const REST_THIGH: f32 = 8.3;
const REST_KNEE: f32 = 5.0;
const REST_TOLERANCE: f32 = 7.0;

/// Meshes whose vertices are all as near as this are one body, in metres.
const SAME_BODY: f32 = 1e-4;

/// What a mesh is to the built-in body.
#[derive(Debug, Clone)]
pub enum Recognized {
    /// Another mesh.
    Stranger,
    /// The built-in body in a pose: its skeleton at rest cannot be told.
    Posed,
    /// The built-in body at rest, with skeleton and weights, in the unit and axes of the mesh.
    Rest(Box<Body>),
}

type Combination = Vec<(usize, f32)>;

fn combinations() -> &'static [Combination] {
    static COMBINATIONS: OnceLock<Vec<Combination>> = OnceLock::new();
    COMBINATIONS.get_or_init(|| {
        let mut bytes = STORED;
        let mut all = Vec::new();
        while let Some((count, rest)) = bytes.split_first_chunk() {
            bytes = rest;
            let mut combination = Vec::new();
            for _ in 0..u16::from_le_bytes(*count) {
                let (vertex, rest) = bytes
                    .split_first_chunk()
                    .expect("the stored joints are whole");
                let (weight, rest) = rest
                    .split_first_chunk()
                    .expect("the stored joints are whole");
                bytes = rest;
                combination.push((
                    usize::from(u16::from_le_bytes(*vertex)),
                    f32::from_le_bytes(*weight),
                ));
            }
            all.push(combination);
        }
        all
    })
}

/// The joints of the middle and the left side, which stand for all.
fn stored_joints() -> impl Iterator<Item = usize> {
    (0..NUM_JOINTS).filter(|&joint| mirrored(joint) >= joint)
}

/// Joints of the built-in body from the positions of its vertices at rest.
pub(crate) fn joints_of(positions: &[Point3]) -> Vec<Point3> {
    let template = Template::stored();
    let num_half = template.half.len();
    let right = |vertex: usize| {
        if vertex < template.num_middle {
            vertex
        } else {
            vertex + num_half - template.num_middle
        }
    };
    let sum = |combination: &Combination, place: &dyn Fn(usize) -> usize| {
        let parts = combination.iter();
        let total: Vector3 = parts
            .map(|&(vertex, weight)| weight * positions[place(vertex)].coords)
            .sum();
        total
    };
    let mut joints = vec![Point3::origin(); NUM_JOINTS];
    for (joint, combination) in stored_joints().zip(combinations()) {
        let [left, right] = [sum(combination, &|vertex| vertex), sum(combination, &right)];
        let other = mirrored(joint);
        if other == joint {
            joints[joint] = Point3::from(0.5 * (left + right));
        } else {
            joints[joint] = Point3::from(left);
            joints[other] = Point3::from(right);
        }
    }
    joints
}

/// Finds the built-in body in a mesh of any unit and up axis.
///
/// ```
/// use garnet_body::shape::{BodyParameters, ParametricBody, Recognized, recognized};
///
/// let built = ParametricBody::build(&BodyParameters::new(1.0))?;
/// let Recognized::Rest(body) = recognized(built.body().rest()) else {
///     panic!("the built-in body is recognized");
/// };
/// assert_eq!(body.skeleton().num_joints(), 22);
/// # Ok::<(), garnet_body::shape::ShapeError>(())
/// ```
///
/// # Panics
///
/// Never: the template has a weight for every vertex.
pub fn recognized(mesh: &TriMesh) -> Recognized {
    if !is_ours(mesh) {
        return Recognized::Stranger;
    }
    let joints = joints_of(mesh.positions());
    if !is_at_rest(mesh.positions(), &joints) {
        return Recognized::Posed;
    }
    Recognized::Rest(Box::new(with_joints(mesh, joints)))
}

/// Whether a mesh has the vertices and faces of the built-in body.
fn is_ours(mesh: &TriMesh) -> bool {
    // Vertices that no face names may have been added.
    let has_vertices = mesh.num_vertices() == shared().weights.num_vertices();
    has_vertices && mesh.faces() == Template::stored().faces
}

/// How many times as large a mesh of the built-in body is as one of 1.72 m, in any pose: by the
/// edges of one half. None of other meshes.
pub fn times_as_large(mesh: &TriMesh) -> Option<f32> {
    let template = Template::stored();
    if !is_ours(mesh) {
        return None;
    }
    let half = template.half.len() as u32;
    let of_half = |face: &&[u32; 3]| face.iter().all(|&vertex| vertex < half);
    let faces = || template.faces.iter().filter(of_half);
    let of_template = |vertex: u32| Vector3::from(template.half[vertex as usize].map(|x| x as f32));
    let of_mesh = |vertex: u32| mesh.positions()[vertex as usize].coords;
    let around = |place: &dyn Fn(u32) -> Vector3| -> f32 {
        let edges = faces().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        edges.map(|[a, b]| (place(a) - place(b)).norm()).sum()
    };
    Some(around(&of_mesh) / around(&of_template))
}

/// The built-in body of a mesh at rest and its joints.
fn with_joints(mesh: &TriMesh, joints: Vec<Point3>) -> Body {
    let named = JOINT_NAMES.iter().zip(JOINT_PARENTS).zip(joints);
    let joints = named.map(|((name, parent), rest_position)| Joint {
        name: (*name).to_owned(),
        parent,
        rest_position,
    });
    let skeleton = Skeleton::new(joints.collect()).expect("the built-in joints form a tree");
    let body = Body::new(mesh.clone(), skeleton, shared().weights.clone());
    body.expect("the template has a weight for every vertex")
}

/// The trunk of who stands at rest points up: the cosine of 25 degrees.
const UPRIGHT: f32 = 0.9;

/// A shape is told from a pose so many times at most, each time from a body of the size of the one
/// before.
const MOST_ROUNDS: usize = 3;

/// Bodies whose bones differ by a smaller share in length are of one size. A lower value takes more
/// rounds.
const SAME_LENGTH: f32 = 0.01;

/// The built-in body at rest whose skin in some pose is at `target` `[vertex]`, in metres; `body`
/// is the built-in body in any shape, at rest.
///
/// None if the target is `body` itself in a pose, or `body` is none of ours: the shape of others
/// is not known at the joints.
///
/// # Errors
///
/// Those of [`Body::fitted`].
pub fn unposed(body: &Body, target: &[Point3]) -> Result<Option<Body>, SkinError> {
    if !is_ours(body.rest()) {
        return Ok(None);
    }
    if stands_at_rest(body, target) {
        return Ok(placed(body, target.to_vec()));
    }
    let found = at_rest(body, body.fitted(target)?)?;
    Ok(found.and_then(|(places, _)| placed(body, symmetric(places))))
}

/// The built-in body at rest with its skin at `places`, its soles where those of `body` are.
fn placed(body: &Body, places: Vec<Point3>) -> Option<Body> {
    let rest = body.rest();
    let places = on_floor(places, floor(rest.positions()));
    let mesh = rest.with_positions(places).ok()?;
    let joints = joints_of(mesh.positions());
    Some(with_joints(&mesh, joints))
}

/// Whether a target is another body than `body`, at rest, upright and facing +Z: its shape needs
/// not be told apart from a pose.
fn stands_at_rest(body: &Body, target: &[Point3]) -> bool {
    let rest = body.rest();
    let largest = rest.positions().iter().zip(target);
    let largest = largest.map(|(a, b)| (a - b).norm()).fold(0.0, f32::max);
    if target.len() != rest.num_vertices() || largest < SAME_BODY {
        return false;
    }
    let joints = joints_of(target);
    let at = |name: &str| joint(&joints, name);
    let trunk = at("neck") - at("pelvis");
    let across = at("left_hip") - at("right_hip");
    let middle = &target[..Template::stored().num_middle];
    let aside = middle.iter().map(|place| place.x.abs());
    trunk.y > UPRIGHT * trunk.norm()
        && across.x > 0.0
        && aside.fold(0.0, f32::max) < MAX_ASYMMETRY * trunk.norm()
        && is_at_rest(target, &joints)
}

/// Places of vertices `[vertex]` and joints `[joint]`, in metres.
type SkinAndJoints = (Vec<Point3>, Vec<Point3>);

/// Vertices and joints at rest of who stands in `posed`, which is `body` in a pose and another
/// shape; none of the same shape, or of bodies of another topology.
///
/// # Errors
///
/// Those of [`Body::fitted`].
pub(crate) fn at_rest(
    body: &Body,
    mut posed: PosedBody,
) -> Result<Option<SkinAndJoints>, SkinError> {
    let (own, mut base) = (body.skeleton(), Cow::Borrowed(body));
    let mut found = None;
    // Bones of another length pull turns and joints aside.
    for round in 1..=MOST_ROUNDS {
        let Some(next) = carried_to_rest(&base, &posed) else {
            break;
        };
        let length = own.placed(|joint, _| next.1[joint])?.length_of_bones();
        found = Some(next);
        let change = length / base.skeleton().length_of_bones() - 1.0;
        if change.abs() < SAME_LENGTH || round == MOST_ROUNDS {
            break;
        }
        base = Cow::Owned(body.scaled(length / own.length_of_bones())?);
        posed = base.fitted(posed.skin().positions())?;
    }
    Ok(found)
}

/// Vertices and joints at rest by the pose in which `body` was fitted to a skin.
///
/// The skin at rest follows joint by joint from the posed one, and the joints from the skin; then
/// bones are put end to end, as long as they are in the pose.
fn carried_to_rest(body: &Body, posed: &PosedBody) -> Option<SkinAndJoints> {
    let offsets = posed.shape_offsets()?;
    let places = body.rest().positions().iter().zip(offsets);
    let places: Vec<Point3> = places.map(|(place, offset)| place + offset).collect();
    let transforms = posed.posed_from_rest();
    if places.len() != shared().weights.num_vertices() || transforms.len() != NUM_JOINTS {
        return None;
    }
    let found = joints_of(&places);
    let in_pose: Vec<Point3> = (found.iter().zip(transforms))
        .map(|(joint, transform)| transform * joint)
        .collect();
    let mut joints = found.clone();
    for (joint, parent) in JOINT_PARENTS.into_iter().enumerate() {
        let Some(parent) = parent else {
            continue;
        };
        let bone = in_pose[joint] - in_pose[parent];
        joints[joint] = joints[parent] + transforms[parent].rotation.inverse() * bone;
    }
    let moved = places.iter().enumerate().map(|(vertex, place)| {
        let shares = shared().weights.vertex(vertex);
        let shift: Vector3 = shares
            .map(|(joint, share)| share * (joints[joint] - found[joint]))
            .sum();
        place + shift
    });
    Some((moved.collect(), joints))
}

/// Where a body that stands has its soles.
fn floor(positions: &[Point3]) -> f32 {
    positions
        .iter()
        .map(|place| place.y)
        .fold(f32::MAX, f32::min)
}

/// A body with its soles elsewhere: longer legs do not go into the ground.
fn on_floor(mut positions: Vec<Point3>, height: f32) -> Vec<Point3> {
    let up = height - floor(&positions);
    for place in &mut positions {
        place.y += up;
    }
    positions
}

/// The mean of a body at rest and its mirror image, which halves what a pose leaves in it.
fn symmetric(mut positions: Vec<Point3>) -> Vec<Point3> {
    let template = Template::stored();
    let half = template.half.len();
    if positions.len() < 2 * half - template.num_middle {
        return positions;
    }
    for place in &mut positions[..template.num_middle] {
        place.x = 0.0;
    }
    for left in template.num_middle..half {
        let right = left + half - template.num_middle;
        let (a, b) = (positions[left], positions[right]);
        let mean = 0.5 * Vector3::new(a.x - b.x, a.y + b.y, a.z + b.z);
        positions[left] = Point3::from(mean);
        positions[right] = Point3::new(-mean.x, mean.y, mean.z);
    }
    positions
}

/// The place of a built-in joint.
fn joint(joints: &[Point3], name: &str) -> Point3 {
    let place = JOINT_NAMES.iter().position(|other| *other == name);
    joints[place.expect("the joint is one of ours")]
}

fn is_at_rest(positions: &[Point3], joints: &[Point3]) -> bool {
    let at = |name: &str| joint(joints, name);
    let height = (at("head") - at("left_ankle")).norm();
    let template = Template::stored();
    let middle: Vector3 = positions[..template.num_middle]
        .iter()
        .map(|point| point.coords)
        .sum::<Vector3>()
        / template.num_middle as f32;
    let half = template.half.len();
    // The middle plane stands across the line between the hips.
    let across = (at("left_hip") - at("right_hip")).normalize();
    let is_mirrored =
        (template.num_middle..half)
            .zip(half..positions.len())
            .all(|(left, right)| {
                let [left, right] = [left, right].map(|vertex| positions[vertex].coords - middle);
                let mirror = left - 2.0 * across.dot(&left) * across;
                (mirror - right).norm() < MAX_ASYMMETRY * height
            });
    let trunk = at("pelvis") - at("neck");
    let is_near = |from: &str, to: &str, degrees: f32| {
        let angle = (at(to) - at(from)).angle(&trunk).to_degrees();
        (angle - degrees).abs() < REST_TOLERANCE
    };
    height > 0.0
        && is_mirrored
        && is_near("left_shoulder", "left_elbow", REST_ARM)
        && is_near("left_elbow", "left_wrist", REST_ARM)
        && is_near("left_hip", "left_knee", REST_THIGH)
        && is_near("left_knee", "left_ankle", REST_KNEE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Measure, ParametricBody, Population, tape_measures};

    /// Joints found in the mesh alone are this close, in metres.
    const MAX_JOINT_ERROR: f32 = 0.02;

    #[test]
    fn a_body_with_a_vertex_more_is_a_stranger() {
        let built = ParametricBody::build(&Population::new(77).sample(0)).unwrap();
        let (mut positions, faces) = built.body().rest().clone().into_parts();
        positions.push(Point3::origin());
        let mesh = TriMesh::new(positions, faces).unwrap();
        assert!(matches!(recognized(&mesh), Recognized::Stranger));
    }

    #[test]
    fn bodies_are_recognized_at_rest_and_joints_are_where_they_were() {
        let population = Population::new(77);
        for index in 0..6 {
            let built = ParametricBody::build(&population.sample(index)).unwrap();
            let body = built.body();
            let scaled: Vec<Point3> = body
                .rest()
                .positions()
                .iter()
                .map(|p| Point3::new(100.0 * p.x, -100.0 * p.z, 100.0 * p.y))
                .collect();
            let Recognized::Rest(found) = recognized(&body.rest().with_positions(scaled).unwrap())
            else {
                panic!("body {index} is not recognized");
            };
            let pairs = found
                .skeleton()
                .joints()
                .iter()
                .zip(body.skeleton().joints());
            for (found, joint) in pairs {
                let p = 0.01 * found.rest_position;
                let distance = (Point3::new(p.x, p.z, -p.y) - joint.rest_position).norm();
                assert!(
                    distance < MAX_JOINT_ERROR,
                    "{} of {index}: {distance}",
                    joint.name
                );
            }
        }
    }

    #[test]
    fn a_posed_body_and_another_mesh_are_told_apart() {
        let built = ParametricBody::build(&Population::new(77).sample(1)).unwrap();
        let body = built.body();
        let mut pose = garnet_skin::Pose::rest(NUM_JOINTS);
        pose.rotations[4] = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.8);
        let posed = body
            .posed_positions(&pose, garnet_skin::Method::DualQuaternion)
            .unwrap();
        let posed = body.rest().with_positions(posed).unwrap();
        assert!(matches!(recognized(&posed), Recognized::Posed));
        let ball = garnet_mesh::primitives::icosphere(2, 1.0);
        assert!(matches!(recognized(&ball), Recognized::Stranger));
    }

    /// The shape of a posed body is found back this well, but for where it stands: mean and largest
    /// distance, in metres. Where a leg ends and a foot begins is not told by a pose.
    const UNPOSED: [f32; 2] = [1.5e-2, 4e-2];

    /// And what the tape measures, in metres.
    const MAX_MEASURE: f64 = 0.015;

    #[test]
    fn the_shape_of_a_posed_body_is_found() {
        let population = Population::new(78);
        let of = |index| ParametricBody::build(&population.sample(index)).unwrap();
        let (own, other) = (of(0), of(1));
        let mut pose = garnet_skin::Pose::rest(NUM_JOINTS);
        let at = |name: &str| JOINT_NAMES.iter().position(|other| *other == name).unwrap();
        for (name, angle) in [("left_hip", -0.9), ("right_shoulder", 0.6), ("spine1", 0.3)] {
            let turn = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
            pose.rotations[at(name)] = turn;
        }
        let posed = other.body().posed(&pose).unwrap();
        let found = unposed(own.body(), posed.skin().positions()).unwrap();
        let found = found.expect("it has another shape");
        let pairs = found.rest().positions().iter();
        let apart = pairs.zip(other.body().rest().positions());
        let apart: Vec<Vector3> = apart.map(|(a, b)| a - b).collect();
        let forward = apart.iter().map(|apart| apart.z).sum::<f32>() / apart.len() as f32;
        let stands = Vector3::new(0.0, 0.0, forward);
        let distances: Vec<f32> = apart.iter().map(|apart| (apart - stands).norm()).collect();
        let mean = distances.iter().sum::<f32>() / distances.len() as f32;
        let most = distances.iter().copied().fold(0.0, f32::max);
        println!("{mean} {most}");
        assert!(mean < UNPOSED[0] && most < UNPOSED[1], "{mean} {most}");
        let [found, other] = [&found, other.body()].map(|body| tape_measures(body).unwrap());
        for measure in [Measure::Waist, Measure::Hip, Measure::Inseam] {
            let off = (found[measure] - other[measure]).abs();
            println!("{measure:?} {off}");
            assert!(off < MAX_MEASURE, "{measure:?}: {off} m");
        }
    }

    #[test]
    fn who_is_much_shorter_or_taller_is_measured_in_a_pose_too() {
        let own = ParametricBody::build(&crate::shape::BodyParameters::new(0.5)).unwrap();
        let mut pose = garnet_skin::Pose::rest(NUM_JOINTS);
        let at = |name: &str| JOINT_NAMES.iter().position(|other| *other == name).unwrap();
        for (name, angle) in [("left_hip", -0.9), ("left_knee", 0.8), ("spine1", 0.2)] {
            let turn = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
            pose.rotations[at(name)] = turn;
        }
        for (sex, stature) in [(0.0, 1.45), (0.5, 1.55), (1.0, 2.0)] {
            let parameters = crate::shape::BodyParameters::new(sex);
            let parameters = parameters.with(Measure::Stature, stature);
            let other = ParametricBody::build(&parameters).unwrap();
            let posed = other.body().posed(&pose).unwrap();
            let found = unposed(own.body(), posed.skin().positions()).unwrap();
            let found = tape_measures(&found.expect("it has another shape")).unwrap();
            for measure in [Measure::Waist, Measure::Hip, Measure::Inseam] {
                let off = (found[measure] - other.measures()[measure]).abs();
                assert!(off < 0.02, "{stature} {measure:?}: {off} m");
            }
        }
    }

    #[test]
    fn who_spreads_the_legs_is_measured_however_the_skin_was_bent() {
        let own = ParametricBody::build(&crate::shape::BodyParameters::new(0.5)).unwrap();
        // Slim ones: the two methods differ most where their legs bend.
        let others = [(1.0, 1.66, 21.0), (1.0, 1.55, 18.5), (0.0, 1.79, 21.0)];
        for (sex, stature, bmi) in others {
            let parameters = crate::shape::BodyParameters::new(sex).with_bmi(bmi);
            let parameters = parameters.with(Measure::Stature, stature);
            let other = ParametricBody::build(&parameters).unwrap();
            let body = other.body();
            let poser = crate::poses::Poser::new(body.skeleton()).unwrap();
            for name in ["goddess", "warrior_two", "squat"] {
                let pose = poser.pose(&crate::poses::key_pose(name).unwrap().angles);
                for method in [
                    garnet_skin::Method::Linear,
                    garnet_skin::Method::DualQuaternion,
                ] {
                    let skin = body.posed_positions(&pose, method).unwrap();
                    let found = unposed(own.body(), &skin).unwrap();
                    let found = tape_measures(&found.expect("it has another shape")).unwrap();
                    for measure in [Measure::Hip, Measure::Thigh, Measure::Inseam] {
                        let off = (found[measure] - other.measures()[measure]).abs();
                        println!("{name} {stature} {method:?} {measure:?} {off:.4}");
                        assert!(
                            off < 0.03,
                            "{name} {stature} {method:?} {measure:?}: {off} m"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn who_stands_at_rest_is_measured_as_it_is() {
        let own = ParametricBody::build(&Population::new(78).sample(0)).unwrap();
        for (sex, stature, bmi) in [(0.0, 2.05, 24.0), (0.0, 1.98, 20.0), (1.0, 1.50, 30.0)] {
            let parameters = crate::shape::BodyParameters::new(sex).with_bmi(bmi);
            let parameters = parameters.with(Measure::Stature, stature);
            let other = ParametricBody::build(&parameters).unwrap();
            let found = unposed(own.body(), other.body().rest().positions()).unwrap();
            let found = tape_measures(&found.expect("it has another shape")).unwrap();
            for measure in [
                Measure::Chest,
                Measure::Waist,
                Measure::Hip,
                Measure::Inseam,
            ] {
                let off = (found[measure] - other.measures()[measure]).abs();
                assert!(off < 0.01, "{stature} {measure:?}: {off} m");
            }
        }
    }

    #[test]
    fn a_body_in_its_own_shape_needs_no_other() {
        let built = ParametricBody::build(&Population::new(78).sample(0)).unwrap();
        let mut pose = garnet_skin::Pose::rest(NUM_JOINTS);
        pose.rotations[1] = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -0.5);
        let posed = built.body().posed(&pose).unwrap();
        let found = unposed(built.body(), posed.skin().positions()).unwrap();
        assert!(found.is_none());
    }
}
