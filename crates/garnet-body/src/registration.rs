//! Two bodies of different topologies, point by point.
//!
//! A garment that lies on one body, and a network that was trained on it, are of use on another
//! body once each vertex of the first has its place on the second. The first is brought into the
//! rest pose of the second by the names of its joints, its bones stretched to their lengths, and
//! its skin drawn onto the other skin in rounds: each vertex to the closest face that looks the
//! same way, the moves smoothed over the skin, less from round to round (non-rigid ICP, *Amberg et
//! al. 2007*, with the stiffness as a membrane).

use garnet_mesh::{Point3, Topology, Vector3, face_normals, vertex_normals};
use garnet_skin::{Body, Pose, Skeleton};
use nalgebra::Matrix3;
use rayon::prelude::*;

use crate::motion::{
    Direction, Figure, Motion, Retarget, RetargetError, RetargetOptions, Role, Side, StartAt,
    world_rotations,
};

/// How strongly neighbors hold each other back, round by round.
const STIFFNESS: [f64; 7] = [100.0, 30.0, 10.0, 4.0, 1.5, 0.6, 0.3];

/// A vertex is drawn by skin no farther than this, in metres, round by round.
const REACH: [f32; 7] = [0.10, 0.10, 0.08, 0.06, 0.05, 0.04, 0.04];

/// Sweeps of Jacobi's method by which moves are smoothed.
const SWEEPS: usize = 60;

/// The least cosine of the angle between normals of points that belong together.
const SAME_WAY: f32 = 0.4;

/// Where each vertex of a body is on the skin of another one.
#[derive(Debug, Clone)]
pub struct Registration {
    /// Corners of the face of the other body `[vertex]`.
    corners: Vec<[u32; 3]>,
    /// Weights of them `[vertex]`.
    weights: Vec<[f32; 3]>,
    /// `[vertex]`, in metres.
    gaps: Vec<f32>,
}

/// An affine map.
#[derive(Debug, Clone, Copy)]
struct Affine {
    linear: Matrix3<f64>,
    shift: Direction,
}

impl Registration {
    /// Registers `own` with `other`, both at rest. Bodies of the same faces meet vertex by vertex.
    ///
    /// # Errors
    ///
    /// [`RetargetError`] if one of the skeletons is no human figure.
    pub fn new(own: &Body, other: &Body) -> Result<Self, RetargetError> {
        let (faces, skin) = (own.rest().faces(), other.skin());
        if faces == skin.faces() && own.rest().num_vertices() == other.rest().num_vertices() {
            return Ok(Self::of_twins(own.rest().num_vertices()));
        }
        let topology = Topology::new(own.rest().num_vertices(), faces);
        let other_normals = face_normals(skin.positions(), skin.faces());
        let closest = |place: &Point3, normal: &Vector3, reach: f32| {
            let same_way = |face: u32| other_normals[face as usize].dot(normal) > SAME_WAY;
            skin.closest_where(*place, reach, same_way)
        };
        let mut places = stance(own, other.skeleton())?;
        for (&stiffness, &reach) in STIFFNESS.iter().zip(&REACH) {
            let normals = vertex_normals(&places, faces);
            let pulls = places.par_iter().zip(&normals);
            let pulls = pulls.map(|(place, normal)| {
                closest(place, normal, reach).map(|found| (found.point - place).cast())
            });
            let moves = smoothed(&pulls.collect::<Vec<_>>(), &topology, stiffness);
            for (place, step) in places.iter_mut().zip(moves) {
                *place += step.cast::<f32>();
            }
        }
        let normals = vertex_normals(&places, faces);
        let found = places.par_iter().zip(&normals).map(|(place, normal)| {
            let near = closest(place, normal, REACH[0]);
            near.unwrap_or_else(|| skin.closest(*place))
        });
        let found: Vec<_> = found.collect();
        Ok(Self {
            corners: (found.iter())
                .map(|found| skin.faces()[found.face as usize])
                .collect(),
            weights: found.iter().map(|found| found.barycentric).collect(),
            gaps: found
                .iter()
                .map(|found| found.distance_squared.sqrt())
                .collect(),
        })
    }

    /// Of two bodies of the same topology.
    fn of_twins(num_vertices: usize) -> Self {
        Self {
            corners: (0..num_vertices as u32).map(|vertex| [vertex; 3]).collect(),
            weights: vec![[1.0, 0.0, 0.0]; num_vertices],
            gaps: vec![0.0; num_vertices],
        }
    }

    /// The vertices of the own body on the other one, whose vertices are `places`, in any pose.
    ///
    /// # Panics
    ///
    /// If there are fewer places than the other body has vertices.
    pub fn carried(&self, places: &[Point3]) -> Vec<Point3> {
        let pairs = self.corners.iter().zip(&self.weights);
        let place = |(corners, weights): (&[u32; 3], &[f32; 3])| {
            let parts = corners.iter().zip(weights);
            let sum: Vector3 = parts
                .map(|(&corner, &weight)| weight * places[corner as usize].coords)
                .sum();
            Point3::from(sum)
        };
        pairs.map(place).collect()
    }

    /// How far each vertex was from the place that it was given, `[vertex]`, in metres.
    pub fn gaps(&self) -> &[f32] {
        &self.gaps
    }
}

/// The vertices of a body in the rest pose of another skeleton, with its lengths of bones.
fn stance(own: &Body, other: &Skeleton) -> Result<Vec<Point3>, RetargetError> {
    let skeleton = own.skeleton();
    let motion = Motion {
        skeleton: other.clone(),
        frames: vec![Pose::rest(other.num_joints())],
        frame_time: None,
        notes: Vec::new(),
    };
    let options = RetargetOptions {
        start_at: StartAt::Origin,
        ..RetargetOptions::default()
    };
    let pose = Retarget::new(&motion, skeleton, &options)?.pose(0)?;
    let rotations = world_rotations(skeleton, &pose);
    let figures = [
        Figure::new(skeleton, "the body of the garment")?,
        Figure::new(other, "the body")?,
    ];
    let targets = targets(&figures, skeleton.num_joints());
    let stretches = stretches(&figures, skeleton.num_joints());
    let mut maps: Vec<Option<Affine>> = vec![None; skeleton.num_joints()];
    for &joint in skeleton.parents_first() {
        let parent = skeleton.joints()[joint]
            .parent
            .and_then(|parent| maps[parent]);
        let rest = skeleton.joints()[joint].rest_position.coords.cast::<f64>();
        let turn = rotations[joint].to_rotation_matrix().into_inner();
        let linear = turn * stretches[joint];
        maps[joint] = match (targets[joint], parent) {
            (Some(target), _) => Some(Affine {
                linear,
                shift: target - linear * rest,
            }),
            (None, Some(parent)) => Some(Affine {
                linear,
                shift: parent.linear * rest + parent.shift - linear * rest,
            }),
            (None, None) => Some(Affine {
                linear,
                shift: Direction::zeros(),
            }),
        };
    }
    let place = |(vertex, rest): (usize, &Point3)| {
        let mut sum = Direction::zeros();
        for (joint, weight) in own.weights().vertex(vertex) {
            if let Some(map) = maps[joint] {
                let at = map.linear * rest.coords.cast::<f64>() + map.shift;
                sum += f64::from(weight) * at;
            }
        }
        Point3::from(sum.cast::<f32>())
    };
    Ok(own
        .rest()
        .positions()
        .iter()
        .enumerate()
        .map(place)
        .collect())
}

/// Where the joints of the first figure are in the second, `[joint]`; none for those that follow
/// their parents.
fn targets(figures: &[Figure; 2], num_joints: usize) -> Vec<Option<Direction>> {
    let [own, other] = figures;
    let mut targets = vec![None; num_joints];
    let is_limb = |role: &Role| !matches!(role, Role::Collar(_));
    for role in Role::ALL.into_iter().filter(is_limb) {
        if let (Some(from), Some(to)) = (own.joint(role), other.joint(role)) {
            targets[from] = Some(other.position(to));
        }
    }
    // Where rigs put chest, neck and collarbones is a matter of taste: they are put at the same
    // share of the way from the pelvis to between the shoulders, and on to the head.
    let [[low, mid, high], [to_low, to_mid, to_high]] = [axis(own), axis(other)];
    let collars = Side::BOTH.map(|side| own.joint(Role::Collar(side)));
    let between = own.trunk().iter().chain(own.neck()).copied();
    for joint in between.chain(collars.into_iter().flatten()) {
        let place = own.position(joint);
        let share = |from: Direction, to: Direction| {
            let way = to - from;
            (place - from).dot(&way) / way.norm_squared().max(1e-12)
        };
        let trunk = share(low, mid);
        let (on_axis, target) = if trunk <= 1.0 {
            (
                low + trunk * (mid - low),
                to_low + trunk * (to_mid - to_low),
            )
        } else {
            let neck = share(mid, high);
            (
                mid + neck * (high - mid),
                to_mid + neck * (to_high - to_mid),
            )
        };
        targets[joint] = Some(target + (place - on_axis));
    }
    targets
}

/// Pelvis, the middle between the shoulders, and head.
fn axis(figure: &Figure) -> [Direction; 3] {
    let at = |role: Role| figure.joint(role).map(|joint| figure.position(joint));
    let shoulders = Side::BOTH.map(|side| at(Role::Shoulder(side)).unwrap_or_default());
    [
        figure.position(figure.pelvis()),
        0.5 * (shoulders[0] + shoulders[1]),
        at(Role::Head).unwrap_or_default(),
    ]
}

/// By how much each joint of the first figure stretches its bone to that of the second, `[joint]`.
fn stretches(figures: &[Figure; 2], num_joints: usize) -> Vec<Matrix3<f64>> {
    let [own, other] = figures;
    let along = |bone: Direction, length: f64| {
        let direction = bone.normalize();
        let share = length / bone.norm() - 1.0;
        Matrix3::identity() + share * direction * direction.transpose()
    };
    let mut stretches = vec![Matrix3::identity(); num_joints];
    for role in Role::ALL {
        if let (Some(joint), Some(bone), Some(target)) =
            (own.joint(role), own.bone(role), other.bone(role))
        {
            stretches[joint] = along(bone, target.norm());
        }
    }
    let [[low, mid, _], [to_low, to_mid, _]] = [axis(own), axis(other)];
    let (trunk, target) = (mid - low, to_mid - to_low);
    if trunk.norm() > 1e-6 && target.norm() > 1e-6 {
        for &joint in own.trunk() {
            stretches[joint] = along(trunk, target.norm());
        }
    }
    stretches
}

/// Moves that follow the pulls and vary little from vertex to vertex.
fn smoothed(pulls: &[Option<Direction>], topology: &Topology, stiffness: f64) -> Vec<Direction> {
    let mut moves: Vec<Direction> = pulls.iter().map(|pull| pull.unwrap_or_default()).collect();
    for _ in 0..SWEEPS {
        moves = (0..moves.len())
            .into_par_iter()
            .map(|vertex| {
                let around = topology.neighbors(vertex);
                let weight = stiffness / around.len().max(1) as f64;
                let sum: Direction = around
                    .iter()
                    .map(|&other| weight * moves[other as usize])
                    .sum();
                let held = if around.is_empty() { 0.0 } else { stiffness };
                match pulls[vertex] {
                    Some(pull) => (pull + sum) / (1.0 + held),
                    None if around.is_empty() => moves[vertex],
                    None => sum / held,
                }
            })
            .collect();
    }
    moves
}

#[cfg(test)]
mod tests {
    use garnet_mesh::subdivided;
    use garnet_skin::SkinWeights;

    use super::*;
    use crate::shape::{BodyParameters, Measure, ParametricBody};

    fn built(parameters: &BodyParameters) -> Body {
        ParametricBody::build(parameters).unwrap().into_body()
    }

    #[test]
    fn a_body_of_another_topology_and_shape_is_met_where_it_is_the_same() {
        let own = built(&BodyParameters::new(0.5).with_bmi(23.0));
        let tall = BodyParameters::new(1.0).with(Measure::Stature, 1.80);
        let other = built(&tall.with_bmi(28.0));
        // Weights of the other body are not looked at.
        let fine = subdivided(other.rest()).unwrap();
        let at_root = (0..fine.num_vertices()).map(|_| [(0, 1.0)]);
        let weights = SkinWeights::from_influences(other.skeleton().num_joints(), at_root).unwrap();
        let fine = Body::new(fine, other.skeleton().clone(), weights).unwrap();

        let registration = Registration::new(&own, &fine).unwrap();
        let carried = registration.carried(fine.rest().positions());
        let distances = carried.iter().zip(other.rest().positions());
        let mut distances: Vec<f32> = distances.map(|(a, b)| (a - b).norm()).collect();
        distances.sort_by(f32::total_cmp);
        let quantile = |percent: usize| 1e3 * distances[distances.len() * percent / 100];
        println!("median {:.1} mm, p95 {:.1} mm", quantile(50), quantile(95));
        assert!(quantile(50) < 4.0 && quantile(95) < 25.0);
        let mut gaps = registration.gaps().to_vec();
        gaps.sort_by(f32::total_cmp);
        assert!(gaps[gaps.len() * 99 / 100] < 2e-3);

        // Where the other body goes, its points go.
        let shift = Vector3::new(0.3, -1.0, 2.0);
        let moved: Vec<Point3> = fine.rest().positions().iter().map(|p| p + shift).collect();
        let differences = registration.carried(&moved).into_iter().zip(&carried);
        let largest = differences
            .map(|(a, b)| (a - b - shift).norm())
            .fold(0.0, f32::max);
        assert!(largest < 1e-5);
    }

    #[test]
    fn a_body_meets_itself() {
        let own = built(&BodyParameters::new(0.5).with_bmi(23.0));
        let registration = Registration::new(&own, &own).unwrap();
        assert_eq!(
            registration.carried(own.rest().positions()),
            own.rest().positions()
        );
    }
}
