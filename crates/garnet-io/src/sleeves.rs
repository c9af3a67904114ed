//! Sleeves and trouser legs that hang beside their limb at rest.
//!
//! A sleeve ends at an opening that is round, from which the cloth goes to one side, as that of a
//! tube does and that round a hole does not, and leads towards a shoulder or hip. It is empty if no
//! bone goes through the opening and no skin is in its end: the face is in a hood, and legs are in
//! a skirt however wide.

use garnet_body::motion::{Figure, Role, Side};
use garnet_mesh::{Bounds, Point3, Topology, TriMesh, Vector3};
use garnet_skin::{Body, Weld};

use crate::align::{LEAST_RIM, Wearer, is_threaded};

/// An opening is round if it encloses this part of what a circle of its length does. Lower ones
/// take pockets and the rims of open coats for sleeves.
const ROUND: f32 = 0.4;

/// Cloth goes to one side of an opening if this is the mean cosine between its way and that side:
/// less than a funnel has, more than a sheet around a hole.
const TO_ONE_SIDE: f32 = 0.5;

/// Skin within so many diameters of the opening is in the end of the tube. Higher ones find the
/// shoulder in an empty short sleeve.
const END: f32 = 0.75;

/// The same of hands and feet, which sleeves may be longer than.
const LONG_END: f32 = 2.0;

/// And outside of the opening.
const BEFORE: f32 = 0.25;

/// Another opening within so many diameters makes a band or a ring of it, or an armhole.
const BAND: f32 = 0.5;

/// The way into a sleeve passes its shoulder or hip within its diameter and so much of the height
/// of the body.
const NEAR_LIMB: f32 = 0.05;

/// A sleeve that no limb goes through.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct EmptySleeve {
    /// The middle of its opening, in metres with y up.
    pub center: Point3,
    /// The joint of the limb that is nearest to it.
    pub joint: usize,
}

/// The end of a tube of cloth.
struct End {
    rim: Vec<Point3>,
    center: Point3,
    /// Unit vector into the tube.
    inward: Vector3,
    diameter: f32,
}

/// Sleeves and trouser legs of a garment through which no limb of the body goes on which it lies,
/// both in metres with y up. Of bodies that are no human figures nothing is told.
pub fn empty_sleeves(garment: &TriMesh, body: &Body) -> Vec<EmptySleeve> {
    let Ok(figure) = Figure::new(body.skeleton(), "the body") else {
        return Vec::new();
    };
    let ends = ends_of(garment);
    if ends.is_empty() {
        return Vec::new();
    }
    let limbs = limbs_of(&figure);
    let is_last = below_last(body, &figure);
    let wearer = Wearer::at_rest(body);
    let place = |joint: usize| body.skeleton().joints()[joint].rest_position;
    let found = ends.into_iter().filter_map(|end| {
        let near = end.diameter + NEAR_LIMB * wearer.height;
        let distance = |limb: &&Vec<usize>| end.distance_to_way(place(limb[0]));
        let limb = (limbs.iter()).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        if distance(&limb) > near
            || is_threaded(&end.rim, &wearer.bones)
            || end.holds(body, &is_last)
        {
            return None;
        }
        let from_center = |joint: &&usize| (place(**joint) - end.center).norm_squared();
        let joint = (limb.iter()).min_by(|a, b| from_center(a).total_cmp(&from_center(b)))?;
        Some(EmptySleeve {
            center: end.center,
            joint: *joint,
        })
    });
    found.collect()
}

/// The joints of arms and legs, shoulders and hips first.
fn limbs_of(figure: &Figure) -> Vec<Vec<usize>> {
    let limbs = Side::BOTH.into_iter().flat_map(|side| {
        let arm = [Role::Shoulder(side), Role::Elbow(side), Role::Wrist(side)];
        let leg = [Role::Hip(side), Role::Knee(side), Role::Ankle(side)];
        [arm, leg]
    });
    let joints = limbs.map(|limb| {
        limb.into_iter()
            .filter_map(|role| figure.joint(role))
            .collect()
    });
    joints
        .filter(|limb: &Vec<usize>| !limb.is_empty())
        .collect()
}

/// Whether each joint belongs to a hand or a foot `[joint]`.
fn below_last(body: &Body, figure: &Figure) -> Vec<bool> {
    let skeleton = body.skeleton();
    let mut is_last = vec![false; skeleton.num_joints()];
    for side in Side::BOTH {
        for role in [Role::Wrist(side), Role::Ankle(side)] {
            if let Some(joint) = figure.joint(role) {
                is_last[joint] = true;
            }
        }
    }
    for &joint in skeleton.parents_first() {
        let parent = skeleton.joints()[joint].parent;
        is_last[joint] |= parent.is_some_and(|parent| is_last[parent]);
    }
    is_last
}

/// The ends of the tubes of a garment.
fn ends_of(garment: &TriMesh) -> Vec<End> {
    let Some(bounds) = Bounds::of_faces(garment.positions(), garment.faces()) else {
        return Vec::new();
    };
    let weld = Weld::new(garment.positions());
    let nodes = weld.gather(garment.positions());
    let topology = Topology::new(nodes.len(), &weld.faces(garment));
    let least = LEAST_RIM * 4.0 * bounds.diagonal();
    let rims: Vec<Vec<u32>> = (topology.boundary_loops().into_iter())
        .filter(|rim| rim.len() > 2 && length(&places(rim, &nodes)) > least)
        .collect();
    let ends = rims.iter().enumerate().filter_map(|(number, rim)| {
        let end = End::of(rim, &nodes, &topology)?;
        let others = rims
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != number);
        let mut others = others.flat_map(|(_, other)| places(other, &nodes));
        let is_near = |other: Point3| {
            let reach = BAND * end.diameter;
            end.rim.iter().any(|place| (place - other).norm() < reach)
        };
        (!others.any(is_near)).then_some(end)
    });
    ends.collect()
}

fn places(rim: &[u32], nodes: &[Point3]) -> Vec<Point3> {
    rim.iter().map(|&node| nodes[node as usize]).collect()
}

/// The sides of a closed line.
fn sides(rim: &[Point3]) -> impl Iterator<Item = (&Point3, &Point3)> {
    rim.iter().zip(rim.iter().cycle().skip(1))
}

fn length(rim: &[Point3]) -> f32 {
    sides(rim).map(|(a, b)| (b - a).norm()).sum()
}

impl End {
    /// The end of a tube at a rim of cloth, if there is one.
    fn of(rim: &[u32], nodes: &[Point3], topology: &Topology) -> Option<Self> {
        let around = places(rim, nodes);
        let length = length(&around);
        let sum: Vector3 = around.iter().map(|place| place.coords).sum();
        let center = Point3::from(sum / around.len() as f32);
        let area: Vector3 = sides(&around)
            .map(|(a, b)| 0.5 * (a - center).cross(&(b - center)))
            .sum();
        let of_circle = length * length / (4.0 * std::f32::consts::PI);
        let axis = area.try_normalize(f32::MIN_POSITIVE)?;
        if area.norm() < ROUND * of_circle {
            return None;
        }
        let way = |&node: &u32| {
            let others = topology.neighbors(node as usize).iter();
            let others = others.filter(|other| !rim.contains(other));
            let ways = others.map(|&other| nodes[other as usize] - nodes[node as usize]);
            ways.sum::<Vector3>().try_normalize(f32::MIN_POSITIVE)
        };
        let along: Vec<f32> = rim
            .iter()
            .filter_map(way)
            .map(|way| way.dot(&axis))
            .collect();
        let mean = along.iter().sum::<f32>() / along.len().max(1) as f32;
        (mean.abs() > TO_ONE_SIDE).then(|| Self {
            rim: around,
            center,
            inward: axis * mean.signum(),
            diameter: length / std::f32::consts::PI,
        })
    }

    /// How far a point is from the way that leads into the tube.
    fn distance_to_way(&self, point: Point3) -> f32 {
        let offset = point - self.center;
        let along = offset.dot(&self.inward).max(0.0);
        (offset - along * self.inward).norm()
    }

    /// Whether skin of a body is in it; `is_last` `[joint]` are those of hands and feet.
    fn holds(&self, body: &Body, is_last: &[bool]) -> bool {
        let weights = body.weights();
        let mut skin = (0_usize..).zip(body.skin().positions());
        skin.any(|(vertex, place)| {
            let offset = place - self.center;
            let depth = offset.dot(&self.inward) / self.diameter;
            let is_of_last =
                || vertex < weights.num_vertices() && is_last[weights.heaviest(vertex)];
            (-BEFORE..LONG_END).contains(&depth)
                && self.goes_round(offset)
                && (depth < END || is_of_last())
        })
    }

    /// Whether the opening goes round what is at `offset` from its middle, seen along the tube.
    fn goes_round(&self, offset: Vector3) -> bool {
        let first = (self.rim[0] - self.center).cross(&self.inward);
        let second = self.inward.cross(&first);
        let seen = |offset: Vector3| [offset.dot(&first), offset.dot(&second)];
        let [x, y] = seen(offset);
        let crossings = sides(&self.rim).filter(|(a, b)| {
            let [[ax, ay], [bx, by]] = [a, b].map(|place| seen(*place - self.center));
            (ay > y) != (by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay)
        });
        crossings.count() % 2 == 1
    }
}

#[cfg(test)]
mod tests {
    use garnet_mesh::primitives::{capsule, grid, tube};
    use garnet_skin::{Joint, Skeleton, SkinWeights};
    use nalgebra::{Isometry3, Rotation3};

    use super::*;

    /// Meshes as one.
    fn joined(parts: &[TriMesh]) -> TriMesh {
        let (mut places, mut faces) = (Vec::new(), Vec::new());
        for part in parts {
            let first = places.len() as u32;
            places.extend_from_slice(part.positions());
            faces.extend(
                part.faces()
                    .iter()
                    .map(|face| face.map(|corner| corner + first)),
            );
        }
        TriMesh::new(places, faces).unwrap()
    }

    fn moved(mesh: &TriMesh, turn: f32, [x, y]: [f32; 2]) -> TriMesh {
        let turn = Isometry3::from_parts(
            Vector3::new(x, y, 0.0).into(),
            Rotation3::from_axis_angle(&Vector3::z_axis(), turn).into(),
        );
        let places = mesh.positions().iter().map(|place| turn * place).collect();
        mesh.with_positions(places).unwrap()
    }

    /// A figure whose arms hang.
    fn body() -> Body {
        let place = |name: &str, parent: Option<usize>, [x, y]: [f32; 2]| Joint {
            name: name.to_owned(),
            parent,
            rest_position: Point3::new(x, y, 0.0),
        };
        let mut joints = vec![
            place("pelvis", None, [0.0, 1.0]),
            place("spine1", Some(0), [0.0, 1.3]),
            place("neck", Some(1), [0.0, 1.5]),
            place("head", Some(2), [0.0, 1.6]),
        ];
        for (side, x) in [("left", 1.0), ("right", -1.0)] {
            let first = joints.len();
            for (number, (name, at)) in [
                ("shoulder", [0.2, 1.4]),
                ("elbow", [0.25, 1.1]),
                ("wrist", [0.28, 0.85]),
                ("hip", [0.1, 0.95]),
                ("knee", [0.1, 0.5]),
                ("ankle", [0.1, 0.1]),
            ]
            .into_iter()
            .enumerate()
            {
                let parent = match number {
                    0 => 1,
                    3 => 0,
                    _ => first + number - 1,
                };
                joints.push(place(
                    &format!("{side}_{name}"),
                    Some(parent),
                    [x * at[0], at[1]],
                ));
            }
        }
        let trunk = moved(&capsule(0.15, 0.4, 24, 12), 0.0, [0.0, 1.2]);
        let head = moved(&capsule(0.1, 0.1, 16, 8), 0.0, [0.0, 1.65]);
        let arm = capsule(0.05, 0.55, 16, 24);
        let leg = capsule(0.08, 0.85, 16, 24);
        let mut parts = vec![trunk, head];
        for x in [1.0, -1.0] {
            parts.push(moved(&arm, x * 0.12, [x * 0.24, 1.12]));
            parts.push(moved(&leg, 0.0, [x * 0.1, 0.5]));
        }
        let mesh = joined(&parts);
        let nearest = |place: &Point3| {
            let far = |joint: &&Joint| (joint.rest_position - place).norm_squared();
            let near = joints.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
            let near = near.map_or("", |joint| joint.name.as_str());
            let found = joints.iter().position(|joint| joint.name == near);
            [(found.unwrap(), 1.0)]
        };
        let rows: Vec<[(usize, f32); 1]> = mesh.positions().iter().map(nearest).collect();
        let weights = SkinWeights::from_influences(joints.len(), rows).unwrap();
        Body::new(mesh, Skeleton::new(joints).unwrap(), weights).unwrap()
    }

    /// The sleeve of a left arm that is raised by so much, in radians; its upper end is closed.
    fn sleeve(raised: f32) -> TriMesh {
        let tube = tube(0.08, 0.4, 24, 12);
        let places = tube.positions().iter().map(|place| {
            let is_upper = place.y > 0.199;
            let radius = if is_upper { 0.0 } else { 1.0 };
            Point3::new(radius * place.x, place.y - 0.2, radius * place.z)
        });
        let closed = tube.with_positions(places.collect()).unwrap();
        moved(&closed, raised, [0.2, 1.4])
    }

    #[test]
    fn sleeves_are_empty_where_the_arm_is_beside_them() {
        let body = body();
        for (raised, count) in [(0.12, 0), (1.57, 1), (0.9, 1)] {
            let found = empty_sleeves(&sleeve(raised), &body);
            assert_eq!(found.len(), count, "{raised}: {found:?}");
        }
        let found = empty_sleeves(&sleeve(1.57), &body)[0];
        assert!((found.center - Point3::new(0.6, 1.4, 0.0)).norm() < 1e-2);
        let name = &body.skeleton().joints()[found.joint].name;
        assert!(name.starts_with("left_"), "{name}");
    }

    #[test]
    fn skirts_capes_holes_and_bands_are_no_empty_sleeves() {
        let body = body();
        let skirt = moved(&tube(0.3, 0.7, 32, 16), 0.0, [0.0, 0.7]);
        // The hem is below the feet.
        let gown = moved(&tube(0.6, 1.3, 32, 16), 0.0, [0.0, 0.5]);
        let cape = moved(&grid(10, 12, [0.5, 1.2]), 0.0, [0.0, 0.9]);
        let band = moved(&tube(0.08, 0.03, 24, 2), 1.57, [0.6, 1.4]);
        for garment in [skirt, gown, cape, band] {
            assert_eq!(empty_sleeves(&garment, &body), []);
        }
        // A sheet with a hole in it, beside the shoulder.
        let sheet = grid(12, 12, [0.6, 0.6]);
        let middle = |face: &[u32; 3]| {
            let corners = face.map(|corner| sheet.positions()[corner as usize].coords);
            corners.iter().sum::<Vector3>() / 3.0
        };
        let faces = sheet
            .faces()
            .iter()
            .filter(|face| middle(face).norm() > 0.12);
        let torn = TriMesh::new(sheet.positions().to_vec(), faces.copied().collect()).unwrap();
        assert_eq!(empty_sleeves(&moved(&torn, 0.0, [0.5, 1.4]), &body), []);
    }
}
