//! The regions of a garment, and what may tell how they lie.

use garnet_mesh::Point3;
use garnet_net::pose_space::{Aspect, Cut, Feature, Features};
use garnet_skin::{Skeleton, Symmetry};

use crate::Stage;

/// Joints that move less of the garment than this have no region of their own.
const LEAST_REGION: f64 = 0.18;

/// Joints that move less of the garment than this are not told how they lean.
const LEAST_LEAN: f64 = 0.01;

/// Within this distance of the middle a vertex belongs to both halves, in metres.
const SEAM: f32 = 0.05;

/// What is fitted, and by what.
pub(super) struct Layout {
    pub(super) features: Features,
    /// How much each vertex counts in each region `[region][vertex]`: all of them, with those of
    /// their mirror images, sum up to one.
    pub(super) shares: Vec<Vec<f32>>,
}

/// A skeleton whose joints go in pairs, or alone.
struct Joints<'a> {
    skeleton: &'a Skeleton,
    symmetry: Option<Symmetry>,
    /// How much of the garment each joint moves `[joint]`.
    moves: Vec<f64>,
}

impl Layout {
    pub(super) fn of(stage: &Stage, has_mirror: bool, cuts: Option<[Cut; 2]>) -> Self {
        let template = stage.template();
        let skeleton = template.body.skeleton();
        let garment = &template.garment;
        let num_joints = skeleton.num_joints();
        let of_joint = |joint: usize| -> Vec<f32> {
            let at_node = |node: usize| {
                let weights = garment.weights().vertex(node);
                weights
                    .filter(|(of, _)| *of == joint)
                    .map(|(_, weight)| weight)
                    .sum()
            };
            let at_nodes: Vec<f32> = (0..garment.rest_nodes().len()).map(at_node).collect();
            garment.weld().scatter(&at_nodes)
        };
        let weights: Vec<Vec<f32>> = (0..num_joints).map(of_joint).collect();
        let positions = garment.mesh().positions();
        let share = |weights: &Vec<f32>| {
            let sum: f64 = weights.iter().map(|&weight| f64::from(weight)).sum();
            sum / positions.len().max(1) as f64
        };
        let joints = Joints {
            skeleton,
            symmetry: skeleton.symmetry(),
            moves: weights.iter().map(share).collect(),
        };
        let sides = if has_mirror {
            joints.symmetry.as_ref()
        } else {
            None
        };
        let shares = (joints.regions().into_iter())
            .flat_map(|region| region_shares(&region, &joints, sides, &weights, positions));
        Self {
            shares: shares.collect(),
            features: joints.features(cuts),
        }
    }
}

impl Joints<'_> {
    fn partner(&self, joint: usize) -> usize {
        (self.symmetry.as_ref()).map_or(joint, |symmetry| symmetry.joints[joint])
    }

    /// The first of a joint and its partner.
    fn first(&self, joint: usize) -> usize {
        joint.min(self.partner(joint))
    }

    fn parent(&self, joint: usize) -> Option<usize> {
        self.skeleton.joints()[joint].parent
    }

    /// Joints with their partners, those that move little put to their parents `[region][joint]`.
    fn regions(&self) -> Vec<Vec<usize>> {
        let count = self.moves.len();
        let mut regions: Vec<Vec<usize>> = vec![Vec::new(); count];
        for joint in 0..count {
            regions[self.first(joint)].push(joint);
        }
        let share = |region: &[usize]| region.iter().map(|&joint| self.moves[joint]).sum::<f64>();
        let order = self.skeleton.parents_first();
        for &joint in order.iter().rev() {
            let Some(parent) = self.parent(joint) else {
                continue;
            };
            if self.first(joint) == joint && share(&regions[joint]) < LEAST_REGION {
                let joints = std::mem::take(&mut regions[joint]);
                regions[self.first(parent)].extend(joints);
            }
        }
        regions.retain(|region| share(region) > 0.0);
        regions.sort_by(|a, b| share(b).total_cmp(&share(a)));
        // What is left of a root that moves little goes with the largest region.
        if regions.len() > 1 && share(&regions[regions.len() - 1]) < LEAST_REGION {
            let last = regions.pop().unwrap_or_default();
            regions[0].extend(last);
        }
        regions
    }

    /// Whether all joints are one of two.
    fn is_paired(&self, region: &[usize]) -> bool {
        region.iter().all(|&joint| self.partner(joint) != joint)
    }

    /// The joint from which those limbs go that move most of the garment; the root if there are
    /// none.
    fn hub(&self) -> usize {
        let root = self.skeleton.parents_first()[0];
        let mut below = self.moves.clone();
        for &joint in self.skeleton.parents_first().iter().rev() {
            if let Some(parent) = self.parent(joint) {
                below[parent] += below[joint];
            }
        }
        let forks = (0..self.moves.len()).filter_map(|joint| {
            let (parent, partner) = (self.parent(joint)?, self.partner(joint));
            (joint < partner && self.parent(partner) == Some(parent))
                .then(|| (below[joint] + below[partner], parent))
        });
        let most = forks.max_by(|a, b| a.0.total_cmp(&b.0));
        most.map_or(root, |(_, parent)| parent)
    }

    fn features(&self, cuts: Option<[Cut; 2]>) -> Features {
        let hub = self.hub();
        let of_cut = cuts.map(|_| Feature {
            joint: hub,
            aspect: Aspect::Cut,
        });
        let mut all = Vec::from_iter(of_cut);
        let partners_move = |joint: usize| self.moves[joint].max(self.moves[self.partner(joint)]);
        for joint in 0..self.moves.len() {
            let mut push = |aspect| all.push(Feature { joint, aspect });
            push(Aspect::Shape);
            push(Aspect::Turn);
            if joint != hub {
                push(Aspect::AgainstHub);
            }
            if joint == hub || (partners_move(joint) > LEAST_LEAN && self.parent(joint).is_some()) {
                push(Aspect::Up);
            }
        }
        Features {
            parents: (0..self.moves.len())
                .map(|joint| self.parent(joint))
                .collect(),
            hub,
            all,
            cuts,
        }
    }
}

/// How much each vertex counts in a region: in its left half, if there are sides. Without sides,
/// regions of partners are two.
fn region_shares(
    region: &[usize],
    joints: &Joints<'_>,
    sides: Option<&Symmetry>,
    weights: &[Vec<f32>],
    positions: &[Point3],
) -> Vec<Vec<f32>> {
    let sum = |joints: &mut dyn Iterator<Item = usize>| {
        let mut sums = vec![0.0_f32; positions.len()];
        for joint in joints {
            for (sum, weight) in sums.iter_mut().zip(&weights[joint]) {
                *sum += weight;
            }
        }
        sums
    };
    let is_left = |joint: usize| {
        let all = joints.skeleton.joints();
        all[joint].rest_position.x > all[joints.partner(joint)].rest_position.x
    };
    let one_side = |left: bool| {
        let all = region.iter().copied();
        sum(&mut all.filter(|&joint| is_left(joint) == left))
    };
    match (joints.is_paired(region), sides) {
        (true, Some(_)) => vec![one_side(true)],
        (true, None) => vec![one_side(true), one_side(false)],
        (false, None) => vec![sum(&mut region.iter().copied())],
        (false, Some(symmetry)) => {
            let mut sums = sum(&mut region.iter().copied());
            for (share, place) in sums.iter_mut().zip(positions) {
                let across = (0.5 + 0.5 * (place.x - symmetry.x) / SEAM).clamp(0.0, 1.0);
                *share *= across * across * (3.0 - 2.0 * across);
            }
            vec![sums]
        }
    }
}

#[cfg(test)]
mod tests {
    use garnet_skin::Joint;

    use super::*;

    const PELVIS: usize = 0;
    const CHEST: usize = 1;
    const LEFT_ARM: usize = 2;
    const RIGHT_ARM: usize = 3;
    const LEFT_HAND: usize = 4;
    const LEFT_LEG: usize = 6;

    /// A trunk, two arms with hands, two legs.
    fn skeleton() -> Skeleton {
        let joint = |name: &str, parent, [x, y]: [f32; 2]| Joint {
            name: name.to_owned(),
            parent,
            rest_position: Point3::new(x, y, 0.0),
        };
        let joints = vec![
            joint("pelvis", None, [0.0, 1.0]),
            joint("chest", Some(PELVIS), [0.0, 1.3]),
            joint("left_arm", Some(CHEST), [0.2, 1.4]),
            joint("right_arm", Some(CHEST), [-0.2, 1.4]),
            joint("left_hand", Some(LEFT_ARM), [0.7, 1.4]),
            joint("right_hand", Some(RIGHT_ARM), [-0.7, 1.4]),
            joint("left_leg", Some(PELVIS), [0.1, 0.9]),
            joint("right_leg", Some(PELVIS), [-0.1, 0.9]),
        ];
        Skeleton::new(joints).unwrap()
    }

    fn joints(skeleton: &Skeleton) -> Joints<'_> {
        Joints {
            skeleton,
            symmetry: skeleton.symmetry(),
            // Hands and legs move next to nothing.
            moves: vec![0.3, 0.3, 0.18, 0.18, 0.02, 0.02, 0.0, 0.0],
        }
    }

    #[test]
    fn joints_go_with_their_partners_or_to_their_parents() {
        let skeleton = skeleton();
        let found = joints(&skeleton).regions();
        assert_eq!(found.len(), 3);
        assert_eq!(found[0], [LEFT_ARM, RIGHT_ARM, LEFT_HAND, LEFT_HAND + 1]);
        let mut trunk = found[1..].to_vec();
        trunk.sort();
        assert_eq!(trunk, [vec![PELVIS, LEFT_LEG, LEFT_LEG + 1], vec![CHEST]]);
    }

    #[test]
    fn the_hub_is_where_the_limbs_part_that_move_most() {
        let skeleton = skeleton();
        let mut joints = joints(&skeleton);
        let features = joints.features(None);
        assert_eq!(features.hub, CHEST);
        features.check().unwrap();
        let has = |joint, aspect| features.all.contains(&Feature { joint, aspect });
        assert!(has(LEFT_ARM, Aspect::AgainstHub) && has(LEFT_ARM, Aspect::Up));
        assert!(has(CHEST, Aspect::Up) && !has(CHEST, Aspect::AgainstHub));
        assert!(!has(LEFT_LEG, Aspect::Up), "they move nothing");
        joints.moves = vec![0.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3, 0.3];
        assert_eq!(joints.hub(), PELVIS, "trousers hang on the pelvis");
    }

    #[test]
    fn regions_and_their_mirror_images_are_the_garment() {
        let skeleton = skeleton();
        let joints = joints(&skeleton);
        // Vertices of the chest in the middle, near it, at the side; of an arm; half of both.
        let across = [0.0, 0.02, 0.1, 0.4, 0.2];
        let of_chest = [1.0, 1.0, 1.0, 0.0, 0.5];
        let positions: Vec<Point3> = [1.0, -1.0]
            .into_iter()
            .flat_map(|side| across.map(|x| Point3::new(side * x, 1.3, 0.0)))
            .collect();
        let mut weights = vec![vec![0.0; 10]; 8];
        for (vertex, place) in positions.iter().enumerate() {
            let chest = of_chest[vertex % 5];
            let arm = if place.x > 0.0 { LEFT_ARM } else { RIGHT_ARM };
            weights[CHEST][vertex] = chest;
            weights[arm][vertex] = 1.0 - chest;
        }
        let sums = |sides: Option<&Symmetry>| {
            let mut sums = [0.0_f32; 10];
            let mut count = 0;
            for region in joints.regions() {
                for shares in region_shares(&region, &joints, sides, &weights, &positions) {
                    for (sum, share) in sums.iter_mut().zip(&shares) {
                        *sum += share;
                    }
                    count += 1;
                }
            }
            (sums, count)
        };
        // With a mirror each region stands for its image, too; without, partners are apart.
        let (left, count) = sums(joints.symmetry.as_ref());
        assert_eq!(count, 3);
        for vertex in 0..5 {
            let both = left[vertex] + left[vertex + 5];
            assert!((both - 1.0).abs() < 1e-6, "{vertex}: {both}");
        }
        let (all, count) = sums(None);
        assert_eq!(count, 4);
        assert!(all.iter().all(|sum| (sum - 1.0).abs() < 1e-6), "{all:?}");
    }
}
