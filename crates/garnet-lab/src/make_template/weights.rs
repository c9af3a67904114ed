//! Skinning weights: bones by anatomy, smoothed by heat diffusion over the skin.

use std::error::Error;

use garnet_body::shape::{BodySurface, JOINT_NAMES, NUM_JOINTS};
use garnet_mesh::{Point3, Topology};
use garnet_skin::{ClothGraph, ScreenedPoisson};

use super::Vec3;
use super::remesh::Mesh;

/// Weights die out over this length, in metres.
const DIFFUSION: f64 = 0.014;

/// And over these around shoulders and hips: a ball joint turns by more than 100 degrees, and skin
/// at distance `r` from it turns over where weights change faster than `1 / (r · angle)`.
const SHOULDER_DIFFUSION: f64 = 0.055;
const HIP_DIFFUSION: f64 = 0.040;

/// How far around a ball joint its diffusion reaches, and over what it fades, in metres.
const SHOULDER_REACH: f64 = 0.18;
const HIP_REACH: f64 = 0.15;
const REACH_FADE: f64 = 0.06;

/// The most influences that are kept, and the least weight.
const MAX_INFLUENCES: usize = 8;
const MIN_WEIGHT: f64 = 0.004;

/// Joints and weights of a vertex.
pub(crate) type Influences = Vec<(usize, f64)>;

/// Joint and weight of each vertex of the left half.
pub(crate) fn heat(surface: &BodySurface, half: &Mesh) -> Result<Vec<Influences>, Box<dyn Error>> {
    let anatomy = Anatomy::new(surface);
    let (positions, faces, mirror) = whole(half);
    let mut columns = vec![vec![0.0; positions.len()]; NUM_JOINTS];
    for vertex in 0..half.positions.len() {
        let weights = anatomy.weights(surface, &half.positions[vertex]);
        for (joint, weight) in weights.into_iter().enumerate() {
            columns[joint][vertex] += weight;
            let other = mirror[vertex];
            if other != vertex {
                columns[mirrored(joint)][other] += weight;
            }
        }
    }
    let length = |point: &Point3| anatomy.diffusion(point);
    let smooth = diffused(&positions, &faces, length, &columns)?;
    Ok((0..half.positions.len())
        .map(|vertex| {
            let value = |joint: usize| smooth[joint][vertex];
            // What is in the middle plane follows both sides alike.
            let even = |joint: usize| {
                if mirror[vertex] == vertex {
                    0.5 * (value(joint) + value(mirrored(joint)))
                } else {
                    value(joint)
                }
            };
            kept((0..NUM_JOINTS).map(|joint| (joint, even(joint))).collect())
        })
        .collect())
}

/// How much of each vertex of the left half is arm, for the tape: with a narrower border than the
/// weights have.
pub(crate) fn arm_shares(surface: &BodySurface, half: &Mesh) -> Result<Vec<f64>, Box<dyn Error>> {
    let anatomy = Anatomy::new(surface);
    let (positions, faces, mirror) = whole(half);
    let mut column = vec![0.0; positions.len()];
    for (vertex, point) in half.positions.iter().enumerate() {
        let [trunk, head, arm, _] = surface.part_distances((*point).into());
        let is_side = f64::from(point.x > 0.1);
        let share = step(trunk.min(head) - arm, 0.030) * is_side;
        column[vertex] = share * step(anatomy.along_arm(point) - 0.005, 0.045);
        column[mirror[vertex]] = column[vertex];
    }
    let smooth = diffused(&positions, &faces, |_| DIFFUSION, &[column])?;
    Ok(smooth[0][..half.positions.len()].to_vec())
}

/// Values `[column][vertex]`, diffused over a length that depends on the place.
fn diffused(
    positions: &[Point3],
    faces: &[[u32; 3]],
    length: impl Fn(&Point3) -> f64,
    columns: &[Vec<f64>],
) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
    let topology = Topology::new(positions.len(), faces);
    let graph = ClothGraph::new(positions, faces, &topology, &[]);
    let mut area = vec![0.0; positions.len()];
    for face in faces {
        let [a, b, c] = face.map(|corner| positions[corner as usize]);
        for &corner in face {
            area[corner as usize] += f64::from((b - a).cross(&(c - a)).norm()) / 6.0;
        }
    }
    let screening = area
        .iter()
        .zip(positions)
        .map(|(area, point)| area / length(point).powi(2))
        .collect();
    Ok(ScreenedPoisson::new(&graph, screening)?.smoothed(columns))
}

fn kept(mut weights: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    weights.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    weights.truncate(MAX_INFLUENCES);
    weights.retain(|&(_, weight)| weight > MIN_WEIGHT);
    let sum: f64 = weights.iter().map(|&(_, weight)| weight).sum();
    weights
        .iter()
        .map(|&(joint, weight)| (joint, weight / sum))
        .collect()
}

fn mirrored(joint: usize) -> usize {
    let name = JOINT_NAMES[joint];
    let other = if name.starts_with("left") {
        name.replace("left", "right")
    } else {
        name.replace("right", "left")
    };
    JOINT_NAMES
        .iter()
        .position(|&name| name == other)
        .expect("both sides have all joints")
}

/// Positions and faces of both halves, and the mirror image of each vertex of the left one.
fn whole(half: &Mesh) -> (Vec<Point3>, Vec<[u32; 3]>, Vec<usize>) {
    let (count, middle) = (half.positions.len(), half.num_middle());
    let mirror: Vec<usize> = (0..count)
        .map(|vertex| {
            if vertex < middle {
                vertex
            } else {
                vertex + count - middle
            }
        })
        .collect();
    let left = half.positions.iter().map(|p| Point3::from(p.cast::<f32>()));
    let right = half.positions[middle..]
        .iter()
        .map(|p| Point3::new(-p.x as f32, p.y as f32, p.z as f32));
    let other = |&[a, b, c]: &[u32; 3]| [a, c, b].map(|corner| mirror[corner as usize] as u32);
    let faces = half
        .faces
        .iter()
        .copied()
        .chain(half.faces.iter().map(other))
        .collect();
    (left.chain(right).collect(), faces, mirror)
}

/// Where one bone hands over to the next.
struct Anatomy {
    joints: Vec<Vec3>,
    fingertip: Vec3,
}

/// Rises from 0 at `-width` to 1 at `width`.
fn step(value: f64, width: f64) -> f64 {
    let share = (0.5 + 0.5 * value / width).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

impl Anatomy {
    fn new(surface: &BodySurface) -> Self {
        let joints = surface.joints();
        let position = |joint: &garnet_skin::Joint| joint.rest_position.coords.cast::<f64>();
        Self {
            joints: joints.iter().map(position).collect(),
            fingertip: surface.tips()[0].into(),
        }
    }

    fn at(&self, name: &str) -> Vec3 {
        self.joints[index(name)]
    }

    /// How far a point lies past a joint, along the mean direction of the bones that meet there.
    fn past(point: &Vec3, [before, joint, after]: [Vec3; 3]) -> f64 {
        let direction = (joint - before).normalize() + (after - joint).normalize();
        (point - joint).dot(&direction.normalize())
    }

    /// How far a point lies past the shoulder joint, along the upper arm.
    fn along_arm(&self, point: &Vec3) -> f64 {
        let [shoulder, elbow] = ["left_shoulder", "left_elbow"].map(|name| self.at(name));
        (point - shoulder).dot(&(elbow - shoulder).normalize())
    }

    /// Over what length weights die out at a point, in metres.
    fn diffusion(&self, point: &Point3) -> f64 {
        let point = Vec3::new(f64::from(point.x).abs(), point.y.into(), point.z.into());
        let near =
            |joint: &str, reach: f64| step(reach - (point - self.at(joint)).norm(), REACH_FADE);
        DIFFUSION
            + near("left_shoulder", SHOULDER_REACH) * (SHOULDER_DIFFUSION - DIFFUSION)
            + near("left_hip", HIP_REACH) * (HIP_DIFFUSION - DIFFUSION)
    }

    fn weights(&self, surface: &BodySurface, point: &Vec3) -> [f64; NUM_JOINTS] {
        let [trunk, head, arm, leg] = surface.part_distances((*point).into());
        let mut weights = [0.0; NUM_JOINTS];
        let arm_share = step(trunk.min(head) - arm - 0.030, 0.060) * f64::from(point.x > 0.1);
        let leg_share = self.leg_share(point, trunk - leg);
        self.share_arm(point, arm_share, &mut weights);
        let rest = 1.0 - weights.iter().sum::<f64>();
        self.share_leg(point, leg_share * rest, &mut weights);
        let rest = 1.0 - weights.iter().sum::<f64>();
        self.share_trunk(point, rest, &mut weights);
        weights
    }

    fn share_arm(&self, point: &Vec3, share: f64, weights: &mut [f64; NUM_JOINTS]) {
        let [collar, shoulder, elbow, wrist] =
            ["left_collar", "left_shoulder", "left_elbow", "left_wrist"].map(|name| self.at(name));
        let upper = share * step(self.along_arm(point) - 0.015, 0.060);
        let fore = upper * step(Self::past(point, [shoulder, elbow, wrist]), 0.030);
        let hand = fore
            * step(
                Self::past(point, [elbow, wrist, self.fingertip]) + 0.004,
                0.022,
            );
        weights[index("left_shoulder")] += upper - fore;
        weights[index("left_elbow")] += fore - hand;
        weights[index("left_wrist")] += hand;
        // The girdle ends below the neck.
        let neck = self.at("neck").y + 0.020 + 0.3 * (point.x - 0.06).max(0.0);
        let girdle = step(point.x - 0.70 * (collar.x + shoulder.x), 0.09)
            * step(point.y - (shoulder.y - 0.080), 0.09)
            * step(neck - point.y, 0.03);
        weights[index("left_collar")] += (1.0 - upper) * girdle;
    }

    /// How much of a point follows the thigh: below a plane from crotch to hip bone.
    fn leg_share(&self, point: &Vec3, past_trunk: f64) -> f64 {
        let hip = self.at("left_hip");
        let x = (point.x - hip.x) / 0.09;
        let back = (-point.z / 0.10).clamp(0.0, 1.0);
        let line = hip.y - 0.012 + 0.038 * x.clamp(-1.3, 1.2) - 0.022 * back;
        let below = step(line - point.y, 0.050);
        // The crotch itself belongs to the trunk.
        below * step(past_trunk + 0.035, 0.035).max(step(line - 0.09 - point.y, 0.03))
    }

    fn share_leg(&self, point: &Vec3, share: f64, weights: &mut [f64; NUM_JOINTS]) {
        let [hip, knee, ankle, foot] =
            ["left_hip", "left_knee", "left_ankle", "left_foot"].map(|name| self.at(name));
        let shank = share * step(Self::past(point, [hip, knee, ankle]), 0.036);
        let sole = shank
            * step(
                (ankle - point).dot(&Vec3::new(0.0, 0.85, -0.35)) - 0.004,
                0.026,
            );
        let forward = (foot - ankle)
            .component_mul(&Vec3::new(1.0, 0.0, 1.0))
            .normalize();
        let toes = sole * step((point - foot).dot(&forward), 0.022);
        weights[index("left_hip")] += share - shank;
        weights[index("left_knee")] += shank - sole;
        weights[index("left_ankle")] += sole - toes;
        weights[index("left_foot")] += toes;
    }

    fn share_trunk(&self, point: &Vec3, share: f64, weights: &mut [f64; NUM_JOINTS]) {
        let chain = ["pelvis", "spine1", "spine2", "spine3", "neck", "head"];
        let widths = [0.0, 0.055, 0.055, 0.055, 0.030, 0.030];
        let mut remaining = share;
        for place in 1..chain.len() {
            let joint = self.at(chain[place]);
            // Neck and head turn about planes that rise to the back.
            let tilt = if place >= 4 {
                0.35 * (point.z - joint.z)
            } else {
                0.0
            };
            let above = remaining * step(point.y - joint.y + tilt, widths[place]);
            weights[index(chain[place - 1])] += remaining - above;
            remaining = above;
        }
        weights[index("head")] += remaining;
    }
}

fn index(name: &str) -> usize {
    JOINT_NAMES
        .iter()
        .position(|&other| other == name)
        .expect("the joint is one of ours")
}
