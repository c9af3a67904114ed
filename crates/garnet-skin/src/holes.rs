//! Cloth over holes: skin that was deleted under clothes leaves them without anything to lie on.
//!
//! Small holes are closed by [caps](crate::Body::skin). Where a limb or the trunk is missing, the
//! cloth itself tells where its skin was, and the skeleton how it moved: bones that are in no skin
//! are those of what is missing, and the skin lay about as far from them as the innermost cloth
//! around them does.

use garnet_knn::ClosestPoint;
use garnet_mesh::{Bounds, Point3};

use crate::{Body, Skeleton, SkinWeights};

/// Places on a bone at which it is asked whether there is skin around it.
const SAMPLES: usize = 8;

/// A bone is missing its skin if this share of its places is.
const MISSING_SHARE: f32 = 0.4;

/// Places that are farther than this outside of the skin have none around them, over the diagonal
/// of the body's box.
const CLEAR: f32 = 0.015;

/// By how much nearer than real skin the missing skin has to be for cloth to lie on it, from which
/// distance on in part and from which wholly, over the diagonal of the body's box.
const NEARER: [f32; 2] = [0.01, 0.03];

/// How fast the pull of a bone falls with the distance: a power.
const FALL: i32 = 8;

/// Of the cloth around a missing limb this share is nearer to the bone than where its skin is taken
/// to be.
const INNERMOST: f64 = 0.25;

/// Cloth that lies over holes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Holes {
    /// How much each node lies on skin that is missing `[node]`, from 0 to 1.
    pub(crate) share: Vec<f32>,
    /// How far the skin that is there or missing is from each node `[node]`, in metres.
    pub(crate) distance: Vec<f32>,
    /// Weights on the missing skin `[node]`: joints and weights of sum 1.
    pub(crate) weights: Vec<Vec<(usize, f32)>>,
}

/// A place on a bone of missing skin.
#[derive(Debug, Clone, Copy)]
struct Place {
    joint: usize,
    point: Point3,
    /// The length of bone that it stands for, in metres.
    length: f32,
}

impl Holes {
    /// What of the cloth lies over missing limbs; none if no limb is missing. `skin` is the closest
    /// skin of each node.
    pub(crate) fn of(body: &Body, nodes: &[Point3], skin: &[ClosestPoint]) -> Option<Self> {
        if body.num_rims() == 0 {
            return None;
        }
        let bounds = Bounds::of_faces(body.rest().positions(), body.rest().faces())?;
        let scale = bounds.diagonal();
        let places = missing_places(body, CLEAR * scale);
        if places.is_empty() {
            return None;
        }
        let real: Vec<f32> = skin
            .iter()
            .map(|near| near.distance_squared.sqrt())
            .collect();
        let nearest: Vec<(usize, Vec<f32>)> = nodes
            .iter()
            .map(|node| of_joints(*node, &places, body.skeleton().num_joints()))
            .collect();
        let radii = radii(&nearest, &real, CLEAR * scale, body.skeleton().num_joints());
        let mut holes = Self {
            share: Vec::with_capacity(nodes.len()),
            distance: Vec::with_capacity(nodes.len()),
            weights: Vec::with_capacity(nodes.len()),
        };
        for ((node, real), (_, distances)) in nodes.iter().zip(real).zip(&nearest) {
            let missing = distances.iter().zip(&radii).map(|(d, r)| (d - r).max(0.0));
            let missing = missing.fold(f32::INFINITY, f32::min);
            let [low, high] = NEARER.map(|distance| distance * scale);
            let t = ((real - missing - low) / (high - low)).clamp(0.0, 1.0);
            holes.share.push(t * t * (3.0 - 2.0 * t));
            holes.distance.push(real.min(missing));
            holes.weights.push(pulled(*node, &places));
        }
        holes
            .share
            .iter()
            .any(|&share| share > 0.0)
            .then_some(holes)
    }
}

/// Places on bones that have no skin around them: of those that lead from skin to skin.
fn missing_places(body: &Body, clear: f32) -> Vec<Place> {
    let skeleton = body.skeleton();
    let leads = leads_to_skin(skeleton, body.weights());
    let joints = skeleton.joints();
    let mut places: Vec<Place> = Vec::new();
    for (joint, of) in joints.iter().enumerate() {
        let Some(parent) = of.parent.filter(|&parent| leads[joint] && leads[parent]) else {
            continue;
        };
        let (from, to) = (joints[parent].rest_position, of.rest_position);
        let length = (to - from).norm() / SAMPLES as f32;
        places.extend((0..SAMPLES).map(|sample| Place {
            joint: parent,
            point: from + (to - from) * ((sample as f32 + 0.5) / SAMPLES as f32),
            length,
        }));
    }
    let points: Vec<Point3> = places.iter().map(|place| place.point).collect();
    let is_inside = body.skin().contains_all(&points);
    let is_missing: Vec<bool> = (points.iter().zip(is_inside))
        .map(|(point, is_inside)| {
            !is_inside && body.skin().closest(*point).distance_squared > clear * clear
        })
        .collect();
    let count = |joint: usize, only_missing: bool| {
        let of_joint = places.iter().zip(&is_missing);
        let of_joint = of_joint.filter(|(place, _)| place.joint == joint);
        of_joint
            .filter(|&(_, &missing)| missing || !only_missing)
            .count()
    };
    let is_bare: Vec<bool> = (0..joints.len())
        .map(|joint| count(joint, true) as f32 >= MISSING_SHARE * count(joint, false) as f32)
        .collect();
    let found = places.iter().zip(&is_missing);
    let found = found.filter(|&(place, &missing)| missing && is_bare[place.joint]);
    found.map(|(place, _)| *place).collect()
}

/// Whether each joint `[joint]` is at or below the lowest one that all skin hangs on, and has skin
/// at or below itself.
fn leads_to_skin(skeleton: &Skeleton, weights: &SkinWeights) -> Vec<bool> {
    let joints = skeleton.joints();
    let mut has_skin = vec![false; joints.len()];
    for vertex in 0..weights.num_vertices() {
        has_skin[weights.heaviest(vertex)] = true;
    }
    let total = has_skin.iter().filter(|&&has| has).count();
    let mut below: Vec<usize> = has_skin.iter().map(|&has| usize::from(has)).collect();
    for &joint in skeleton.parents_first().iter().rev() {
        if let Some(parent) = joints[joint].parent {
            below[parent] += below[joint];
        }
    }
    // Above the lowest joint that all hangs on, a joint has no skin and a child with all of it.
    let mut is_above = vec![false; joints.len()];
    for joint in joints.iter().enumerate() {
        let (index, of) = joint;
        if let Some(parent) = of.parent {
            is_above[parent] |= below[index] == total;
        }
    }
    (0..joints.len())
        .map(|joint| below[joint] > 0 && !is_above[joint])
        .collect()
}

/// The joint with the place nearest to a node, and the distance of the nearest place of each
/// `[joint]`; infinite of those without.
fn of_joints(node: Point3, places: &[Place], num_joints: usize) -> (usize, Vec<f32>) {
    let mut distances = vec![f32::INFINITY; num_joints];
    for place in places {
        let distance = &mut distances[place.joint];
        *distance = distance.min((node - place.point).norm());
    }
    let nearest = (0..num_joints).min_by(|&a, &b| distances[a].total_cmp(&distances[b]));
    (nearest.unwrap_or(0), distances)
}

/// How far missing skin is from the bones of each joint `[joint]`, in metres: as the innermost of
/// the cloth around them that is not near real skin.
fn radii(nearest: &[(usize, Vec<f32>)], real: &[f32], clear: f32, num_joints: usize) -> Vec<f32> {
    let radius = |joint: usize| {
        let around = nearest.iter().zip(real);
        let around = around.filter(|&((of, _), &real)| *of == joint && real > clear);
        let mut distances: Vec<f32> = around.map(|((_, all), _)| all[joint]).collect();
        if distances.is_empty() {
            return 0.0;
        }
        let place = (INNERMOST * distances.len() as f64) as usize;
        *distances.select_nth_unstable_by(place, f32::total_cmp).1
    };
    (0..num_joints).map(radius).collect()
}

/// Weights of a node by the bones around it.
fn pulled(node: Point3, places: &[Place]) -> Vec<(usize, f32)> {
    let nearest = places.iter().map(|place| (node - place.point).norm());
    let nearest = nearest.fold(f32::INFINITY, f32::min).max(1e-6);
    let pull = |place: &Place| {
        let distance = (node - place.point).norm().max(1e-6);
        f64::from(place.length) * f64::from(nearest / distance).powi(FALL)
    };
    let sum: f64 = places.iter().map(pull).sum();
    let mut weights: Vec<(usize, f32)> = Vec::new();
    for place in places {
        let weight = (pull(place) / sum.max(f64::MIN_POSITIVE)) as f32;
        match weights.iter_mut().find(|(joint, _)| *joint == place.joint) {
            Some((_, all)) => *all += weight,
            None => weights.push((place.joint, weight)),
        }
    }
    weights
}
