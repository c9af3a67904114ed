//! Cloth over holes: skin that was deleted under clothes leaves them without anything to lie on.
//!
//! Small holes are closed by [caps](crate::Body::skin). Where a limb or the trunk is missing, the
//! cloth itself tells where its skin was, and the skeleton how it moved: bones that are in no skin
//! are those of what is missing, and the skin lay about as far from them as the innermost cloth
//! around them does. Where the skin ends, its weights tell how far the bones are wrong.

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

/// How much farther the bones of thick limbs pull: a power of their radius. At 0 the chest follows
/// an arm beside it, at 1 a thigh the trunk.
const THICKNESS: f32 = 0.5;

/// Vertices of the skin, at most, that tell how thick limbs are.
const MOST_ASKED: usize = 4000;

/// How fast the weights of the skin around a hole lose their say inwards: the distance over which
/// it halves, over the diagonal of the body's box. More trusts the rims farther in, where other
/// joints move the skin; less leaves a step at the rims.
const RIM_REACH: f32 = 0.04;

/// How fast the say of a vertex of a rim falls with the distance, beside that of nearer ones: a
/// power.
const RIM_FALL: i32 = 4;

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
    /// Weights on the missing skin `[node]`: joints and weights of sum 1; none where nothing is
    /// missing.
    pub(crate) weights: Vec<Vec<(usize, f32)>>,
}

/// A place on a bone of missing skin.
#[derive(Debug, Clone, Copy)]
struct Place {
    joint: usize,
    point: Point3,
    /// The length of bone that it stands for, in metres.
    length: f32,
    /// Distances from it are divided by this: a power of the radius of the joint's skin.
    unit: f32,
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
        let mut all = places_on_bones(body);
        let places = missing_places(body, &all, CLEAR * scale);
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
        let over: Vec<Point3> = (nodes.iter().zip(&real))
            .filter(|&(_, &real)| real > CLEAR * scale)
            .map(|(node, _)| *node)
            .collect();
        measure(&mut all, body, &over);
        let radii = radii(&nearest, &real, CLEAR * scale, body.skeleton().num_joints());
        let mut holes = Self {
            share: Vec::with_capacity(nodes.len()),
            distance: Vec::with_capacity(nodes.len()),
            weights: Vec::with_capacity(nodes.len()),
        };
        for (real, (_, distances)) in real.into_iter().zip(&nearest) {
            let missing = distances.iter().zip(&radii).map(|(d, r)| (d - r).max(0.0));
            let missing = missing.fold(f32::INFINITY, f32::min);
            let [low, high] = NEARER.map(|distance| distance * scale);
            let t = ((real - missing - low) / (high - low)).clamp(0.0, 1.0);
            holes.share.push(t * t * (3.0 - 2.0 * t));
            holes.distance.push(real.min(missing));
        }
        let num_joints = body.skeleton().num_joints();
        let rims = Rims::of(body, &all);
        holes.weights = (nodes.iter().zip(&holes.share))
            .map(|(node, &share)| {
                let mut weights = vec![0.0; num_joints];
                if share > 0.0 {
                    add_pull(*node, &all, &mut weights);
                    rims.correct(*node, RIM_REACH * scale, &mut weights);
                }
                let weights = weights.into_iter().enumerate();
                weights.filter(|(_, weight)| *weight > 0.0).collect()
            })
            .collect();
        holes
            .share
            .iter()
            .any(|&share| share > 0.0)
            .then_some(holes)
    }
}

/// Places on the bones that lead from skin to skin.
fn places_on_bones(body: &Body) -> Vec<Place> {
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
            unit: 1.0,
        }));
    }
    places
}

/// Tells places how thick the limbs are that they are in: as far from the bones of a joint as the
/// innermost of the skin around them, and of cloth over missing skin.
fn measure(places: &mut [Place], body: &Body, cloth: &[Point3]) {
    let num_joints = body.skeleton().num_joints();
    let skin: Vec<Point3> = body.of_skin(body.rest().positions()).copied().collect();
    let step = skin.len().div_ceil(MOST_ASKED).max(1);
    let mut around: Vec<Vec<f32>> = vec![Vec::new(); num_joints];
    for point in skin.iter().step_by(step).chain(cloth) {
        let nearest = places
            .iter()
            .map(|place| (place.joint, (point - place.point).norm()));
        if let Some((joint, distance)) = nearest.min_by(|a, b| a.1.total_cmp(&b.1)) {
            around[joint].push(distance);
        }
    }
    let radii: Vec<Option<f32>> = around.iter_mut().map(|all| innermost(all)).collect();
    let thinnest = radii
        .iter()
        .flatten()
        .copied()
        .fold(f32::INFINITY, f32::min);
    for place in places {
        let radius = radii[place.joint].unwrap_or(thinnest).max(1e-6);
        place.unit = radius.powf(THICKNESS);
    }
}

/// The distance that the innermost of `distances` stay below; none if there are none.
fn innermost(distances: &mut [f32]) -> Option<f32> {
    let place = (INNERMOST * distances.len() as f64) as usize;
    (!distances.is_empty()).then(|| *distances.select_nth_unstable_by(place, f32::total_cmp).1)
}

/// Those of `places` that have no skin around them.
fn missing_places(body: &Body, places: &[Place], clear: f32) -> Vec<Place> {
    let num_joints = body.skeleton().num_joints();
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
    let is_bare: Vec<bool> = (0..num_joints)
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
        innermost(&mut distances).unwrap_or(0.0)
    };
    (0..num_joints).map(radius).collect()
}

/// Adds the weights `[joint]` of a node by the bones around it, which sum to 1.
fn add_pull(node: Point3, places: &[Place], weights: &mut [f32]) {
    let distance = |place: &Place| ((node - place.point).norm() / place.unit).max(1e-6);
    let nearest = places.iter().map(distance).fold(f32::INFINITY, f32::min);
    let pull =
        |place: &Place| f64::from(place.length) * f64::from(nearest / distance(place)).powi(FALL);
    let sum: f64 = places.iter().map(pull).sum();
    for place in places {
        weights[place.joint] += (pull(place) / sum.max(f64::MIN_POSITIVE)) as f32;
    }
}

/// What bones say wrongly of the skin at the rims of holes, whose weights are known.
struct Rims {
    /// `[vertex of a rim]`
    points: Vec<Point3>,
    /// True weights less those by the bones `[vertex of a rim]`: joints and differences.
    amiss: Vec<Vec<(usize, f32)>>,
}

/// Weights that are amiss by less are not corrected.
const LEAST_AMISS: f32 = 1e-3;

impl Rims {
    fn of(body: &Body, places: &[Place]) -> Self {
        let caps = &body.skin().faces()[body.rest().num_faces()..];
        let mut vertices: Vec<u32> = caps.as_flattened().to_vec();
        vertices.sort_unstable();
        vertices.dedup();
        let vertices = vertices.into_iter().map(|vertex| vertex as usize);
        let at = |vertex: usize| body.rest().positions()[vertex];
        let points: Vec<Point3> = vertices.clone().map(at).collect();
        let amiss = vertices.zip(&points).map(|(vertex, point)| {
            let mut pull = vec![0.0; body.skeleton().num_joints()];
            add_pull(*point, places, &mut pull);
            let mut amiss: Vec<f32> = pull.into_iter().map(|weight| -weight).collect();
            for (joint, weight) in body.weights().vertex(vertex) {
                amiss[joint] += weight;
            }
            let amiss = amiss.into_iter().enumerate();
            let amiss = amiss.filter(|(_, weight)| weight.abs() > LEAST_AMISS);
            amiss.collect()
        });
        let amiss = amiss.collect();
        Self { points, amiss }
    }

    /// Adds to the weights `[joint]` of a node what is amiss at the rims, less with the distance,
    /// which halves it over `reach`, in metres. They sum to 1 after that, too.
    fn correct(&self, node: Point3, reach: f32, weights: &mut [f32]) {
        let distance = |point: &Point3| (node - point).norm().max(1e-6);
        let nearest = self.points.iter().map(distance);
        let nearest = nearest.fold(f32::INFINITY, f32::min);
        if !nearest.is_finite() {
            return;
        }
        let say = |point: &Point3| (nearest / distance(point)).powi(RIM_FALL);
        let sum: f32 = self.points.iter().map(say).sum();
        let fade = reach * reach / (reach * reach + nearest * nearest);
        for (point, amiss) in self.points.iter().zip(&self.amiss) {
            let part = fade * say(point) / sum;
            for &(joint, amiss) in amiss {
                weights[joint] += part * amiss;
            }
        }
        for weight in weights.iter_mut() {
            *weight = weight.max(0.0);
        }
        let sum: f32 = weights.iter().sum();
        for weight in weights.iter_mut() {
            *weight /= sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Joint;
    use garnet_mesh::primitives::tube;
    use garnet_mesh::{TriMesh, Vector3};

    /// A thick limb beside a thin one, each round a bone of 0.6 m; skin has the weights of the
    /// first joint below `change`, of the second above it, and of the last at its end.
    fn limbs(change: f32, missing: impl Fn(Point3) -> bool) -> Body {
        let parts = [(0.15, 0.0), (0.03, 0.35)];
        let (mut places, mut faces, mut rows) = (Vec::new(), Vec::new(), Vec::new());
        let mut joints = Vec::new();
        for (part, (radius, x)) in parts.into_iter().enumerate() {
            let mesh = tube(radius, 0.6, 32, 24);
            let first = places.len() as u32;
            places.extend(mesh.positions().iter().map(|p| p + Vector3::x() * x));
            faces.extend(mesh.faces().iter().map(|face| face.map(|v| v + first)));
            for place in mesh.positions() {
                let number = usize::from(place.y > change) + usize::from(place.y > 0.28);
                rows.push([(3 * part + number, 1.0)]);
            }
            for (number, y) in [-0.3, 0.0, 0.3].into_iter().enumerate() {
                joints.push(Joint {
                    name: format!("{part} {number}"),
                    parent: (number > 0)
                        .then(|| joints.len() - 1)
                        .or((part > 0).then_some(0)),
                    rest_position: Point3::new(x, y, 0.0),
                });
            }
        }
        let middle = |face: &&[u32; 3]| {
            let sum: Vector3 = face.iter().map(|&v| places[v as usize].coords).sum();
            Point3::from(sum / 3.0)
        };
        let kept = faces.iter().filter(|face| !missing(middle(face))).copied();
        let mesh = TriMesh::new(places.clone(), kept.collect()).unwrap();
        let weights = SkinWeights::from_influences(joints.len(), rows).unwrap();
        Body::new(mesh, Skeleton::new(joints).unwrap(), weights).unwrap()
    }

    fn weights_at(body: &Body, places: &[Place], at: Point3, reach: f32) -> Vec<f32> {
        let mut weights = vec![0.0; body.skeleton().num_joints()];
        add_pull(at, places, &mut weights);
        Rims::of(body, places).correct(at, reach, &mut weights);
        weights
    }

    #[test]
    fn thick_limbs_pull_farther_than_thin_ones() {
        let body = limbs(0.0, |_| false);
        let mut places = places_on_bones(&body);
        // Beside the skin of the thick limb, and nearer to the bone of the thin one.
        let at = Point3::new(0.18, 0.15, 0.0);
        let share = |places: &[Place]| {
            let mut weights = vec![0.0; body.skeleton().num_joints()];
            add_pull(at, places, &mut weights);
            assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
            weights[3..].iter().sum::<f32>()
        };
        let before = share(&places);
        measure(&mut places, &body, &[]);
        let after = share(&places);
        assert!(before > 0.5 && after < 0.1, "{before} {after}");
    }

    #[test]
    fn rims_tell_what_bones_say_wrongly() {
        // The skin changes its joint above the place where the bones say so.
        let body = limbs(0.1, |place| {
            place.y > 0.06 && place.y < 0.2 && place.x < 0.2
        });
        let mut places = places_on_bones(&body);
        measure(&mut places, &body, &[]);
        let rim = Point3::new(0.15, 0.05, 0.0);
        let far = weights_at(&body, &places, rim, 1e-6);
        let near = weights_at(&body, &places, rim, 0.1);
        // At the rim the weights are those of the skin; without reach, those of the bones.
        assert!(near[0] > 0.95, "{near:?}");
        assert!(near[0] > far[0] + 0.1, "{near:?} {far:?}");
        assert!((near.iter().sum::<f32>() - 1.0).abs() < 1e-5);
    }
}
