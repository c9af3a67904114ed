//! What the hierarchy of a skeleton tells of joints whose names are unknown.
//!
//! A joint between two known ones of a limb is the one in the middle; a chain of two below a hip is
//! a leg; two long chains that are mirror images of each other are arms or legs; and the head ends
//! the chain over the neck.

use garnet_skin::{Joint, Skeleton};
use nalgebra::Vector3;

use super::{
    joint_names::{Role, Side},
    joint_search::Roles,
    rotation::Direction,
};

/// A bone is no shorter than this part of the other bone of its limb.
const MIN_BONE: f64 = 0.45;

/// Mirror images are as near as this, over the length of their chain.
const MIRRORED: f64 = 0.1;

/// A skeleton with the children of each joint.
#[derive(Debug)]
pub(super) struct Tree<'a> {
    joints: &'a [Joint],
    children: Vec<Vec<usize>>,
    /// How many joints hang on each `[joint]`, itself included.
    sizes: Vec<usize>,
}

/// Upper, middle and lower joint of a limb.
type Limb = [Role; 3];

/// Two chains that are mirror images of each other, and the joint on which they hang.
#[derive(Debug)]
struct Pair {
    stem: usize,
    /// From the stem outwards, not with it.
    chains: [Vec<usize>; 2],
    length: f64,
}

impl<'a> Tree<'a> {
    pub(super) fn new(skeleton: &'a Skeleton) -> Self {
        let joints = skeleton.joints();
        let mut children = vec![Vec::new(); joints.len()];
        let mut sizes = vec![1; joints.len()];
        for &joint in skeleton.parents_first().iter().rev() {
            if let Some(parent) = joints[joint].parent {
                sizes[parent] += sizes[joint];
            }
        }
        for (joint, found) in joints.iter().enumerate() {
            if let Some(parent) = found.parent {
                children[parent].push(joint);
            }
        }
        Self {
            joints,
            children,
            sizes,
        }
    }

    /// Adds the joints that names leave out, where there is no doubt of them.
    pub(super) fn complete(&self, roles: &mut Roles) {
        for side in Side::BOTH {
            self.complete_limb(
                [Role::Hip(side), Role::Knee(side), Role::Ankle(side)],
                roles,
            );
            let arm = [Role::Shoulder(side), Role::Elbow(side), Role::Wrist(side)];
            self.complete_limb(arm, roles);
        }
        for side in Side::BOTH {
            self.mirror(side, roles);
        }
        for limb in [leg as fn(Side) -> Limb, arm] {
            self.complete_pair(limb, roles);
        }
        self.find_limbs(roles);
        if roles[Role::Head.index()].is_none() {
            roles[Role::Head.index()] = self.head(roles);
        }
        for side in Side::BOTH {
            self.complete_collar(side, roles);
        }
    }

    /// What is between an upper arm and the trunk, on which the other arm or the head hangs, too,
    /// is a collarbone.
    fn complete_collar(&self, side: Side, roles: &mut Roles) {
        let place = Role::Collar(side).index();
        let at = |role: Role| roles[role.index()];
        let (None, Some(shoulder)) = (roles[place], at(Role::Shoulder(side))) else {
            return;
        };
        let Some(parent) = self.joints[shoulder].parent else {
            return;
        };
        let other = match side {
            Side::Left => Side::Right,
            Side::Right => Side::Left,
        };
        let others = [Role::Shoulder(other), Role::Head, Role::Hip(side)];
        let mut others = others.into_iter().filter_map(at);
        let is_of_trunk = others.any(|joint| self.upwards(joint).contains(&parent));
        if !is_of_trunk && !roles.contains(&Some(parent)) {
            roles[place] = Some(parent);
        }
    }

    fn place(&self, joint: usize) -> Direction {
        self.joints[joint].rest_position.coords.cast()
    }

    fn distance(&self, a: usize, b: usize) -> f64 {
        (self.place(a) - self.place(b)).norm()
    }

    /// The joints from a joint to its root, both included.
    fn upwards(&self, joint: usize) -> Vec<usize> {
        let mut chain = vec![joint];
        while let Some(parent) = self.joints[chain[chain.len() - 1]].parent {
            chain.push(parent);
        }
        chain
    }

    /// The joints that hang on a joint in a line: of several children the one with most joints.
    fn downwards(&self, joint: usize) -> Vec<usize> {
        let mut chain = Vec::new();
        let mut next = joint;
        while let Some(child) = self.main_child(next) {
            chain.push(child);
            next = child;
        }
        chain
    }

    fn main_child(&self, joint: usize) -> Option<usize> {
        let key = |&&child: &&usize| (self.sizes[child], usize::MAX - child);
        self.children[joint].iter().max_by_key(key).copied()
    }

    fn complete_limb(&self, limb: Limb, roles: &mut Roles) {
        let at = |role: Role, roles: &Roles| roles[role.index()];
        let [upper, middle, lower] = limb;
        let is_taken = |joint: usize, roles: &Roles| roles.contains(&Some(joint));
        if let (Some(first), None, Some(last)) =
            (at(upper, roles), at(middle, roles), at(lower, roles))
        {
            let between = self.upwards(last).into_iter().skip(1);
            let between: Vec<usize> = between.take_while(|&joint| joint != first).collect();
            let off =
                |joint: usize| (self.distance(first, joint) - self.distance(joint, last)).abs();
            let nearest = between
                .into_iter()
                .min_by(|&a, &b| off(a).total_cmp(&off(b)));
            roles[middle.index()] = nearest;
        }
        if let (Some(first), None, None) = (at(upper, roles), at(middle, roles), at(lower, roles)) {
            let chain = self.downwards(first);
            if let Some([middle_joint, lower_joint]) = self.two_bones(first, &chain) {
                roles[middle.index()] = Some(middle_joint);
                roles[lower.index()] = Some(lower_joint);
            }
        }
        if let (Some(first), Some(second), None) =
            (at(upper, roles), at(middle, roles), at(lower, roles))
        {
            let least = MIN_BONE * self.distance(first, second);
            let chain = self.downwards(second).into_iter();
            let mut far = chain.filter(|&joint| self.distance(second, joint) >= least);
            roles[lower.index()] = far.next().filter(|&joint| !is_taken(joint, roles));
        }
        if let (None, Some(second), Some(third)) =
            (at(upper, roles), at(middle, roles), at(lower, roles))
        {
            let least = MIN_BONE * self.distance(second, third);
            let chain = self.upwards(second).into_iter().skip(1);
            let mut far = chain.filter(|&joint| self.distance(second, joint) >= least);
            let is_limb = |joint: &usize| !is_taken(*joint, roles) && !self.is_shared(*joint);
            roles[upper.index()] = far.next().filter(is_limb);
        }
    }

    /// Whether a joint carries more than one limb: it is one of the trunk.
    fn is_shared(&self, joint: usize) -> bool {
        let long = |&&child: &&usize| self.downwards(child).len() >= 2;
        self.children[joint].iter().filter(long).count() >= 2
    }

    /// The ends of the two longest bones in a row of a limb that starts at `first`.
    fn two_bones(&self, first: usize, chain: &[usize]) -> Option<[usize; 2]> {
        let second = *chain.first()?;
        let least = MIN_BONE * self.distance(first, second);
        let mut rest = chain[1..].iter();
        let third = rest.find(|&&joint| self.distance(second, joint) >= least)?;
        Some([second, *third])
    }

    /// Finds the joints of a side that lie as the mirror images of known ones.
    fn mirror(&self, side: Side, roles: &mut Roles) {
        let of = |side: Side| {
            [
                Role::Hip(side),
                Role::Knee(side),
                Role::Ankle(side),
                Role::Shoulder(side),
                Role::Elbow(side),
                Role::Wrist(side),
            ]
        };
        let other = match side {
            Side::Left => Side::Right,
            Side::Right => Side::Left,
        };
        for (role, known) in of(side).into_iter().zip(of(other)) {
            let (None, Some(known)) = (roles[role.index()], roles[known.index()]) else {
                continue;
            };
            let place = self.place(known);
            let mirrored = Vector3::new(-place.x, place.y, place.z);
            let depth = self.upwards(known).len();
            let size = self
                .distance(known, self.upwards(known)[depth - 1])
                .max(1e-9);
            let near = (0..self.joints.len())
                .filter(|&joint| !roles.contains(&Some(joint)))
                .filter(|&joint| self.upwards(joint).len() == depth)
                .map(|joint| (joint, (self.place(joint) - mirrored).norm()))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            let near = near.filter(|&(_, distance)| distance < MIRRORED * size);
            roles[role.index()] = near.map(|(joint, _)| joint);
        }
    }

    /// Finds what is missing of arms or legs of which some joints are known: the longest chains
    /// that mirror each other and go through these.
    fn complete_pair(&self, limb: fn(Side) -> Limb, roles: &mut Roles) {
        let known = Side::BOTH.map(|side| limb(side).map(|role| roles[role.index()]));
        let num_known = known.as_flattened().iter().flatten().count();
        if num_known == 0 || num_known == known.as_flattened().len() {
            return;
        }
        let fits = |joints: &[Option<usize>; 3], chain: &[usize]| {
            let Some(found) = self.limb_of(chain) else {
                return false;
            };
            let mut pairs = joints.iter().zip(found);
            pairs.all(|(known, found)| known.is_none_or(|known| known == found))
        };
        let pairs = self.pairs().into_iter().flat_map(|pair| {
            let Pair {
                stem,
                chains: [a, b],
                length,
            } = pair;
            [[a.clone(), b.clone()], [b, a]].map(|chains| Pair {
                stem,
                chains,
                length,
            })
        });
        let found = pairs
            .filter(|pair| {
                let mut sides = known.iter().zip(&pair.chains);
                sides.all(|(joints, chain)| fits(joints, chain))
            })
            .max_by(|a, b| a.length.total_cmp(&b.length));
        let Some(pair) = found else { return };
        for ((side, known), chain) in Side::BOTH.into_iter().zip(&known).zip(&pair.chains) {
            let missing = known.iter().any(Option::is_none);
            let is_free =
                |joint: &usize| known.contains(&Some(*joint)) || !roles.contains(&Some(*joint));
            let found = self
                .limb_of(chain)
                .filter(|found| found.iter().all(is_free));
            if missing && found.is_some() {
                self.name_chain(chain, limb(side), side, roles);
            }
        }
    }

    /// Finds arms or legs of which no joint is known: long chains that mirror each other.
    fn find_limbs(&self, roles: &mut Roles) {
        let is_unknown = |limb: fn(Side) -> Limb, roles: &Roles| {
            let mut all = Side::BOTH.into_iter().flat_map(limb);
            all.all(|role| roles[role.index()].is_none())
        };
        let (no_arms, no_legs) = (is_unknown(arm, roles), is_unknown(leg, roles));
        if !no_arms && !no_legs {
            return;
        }
        let mut pairs = self.pairs();
        pairs.sort_by(|a, b| b.length.total_cmp(&a.length));
        let is_free = |pair: &&Pair| {
            let mut joints = pair.chains.iter().flatten();
            !joints.any(|joint| roles.contains(&Some(*joint)))
        };
        let free: Vec<&Pair> = pairs.iter().filter(is_free).collect();
        let (legs, arms) = match (no_legs, no_arms, free.as_slice()) {
            (true, true, [a, b, ..]) => {
                // The trunk grows from the legs to the arms.
                if self.upwards(b.stem).contains(&a.stem) {
                    (Some(*a), Some(*b))
                } else {
                    (Some(*b), Some(*a))
                }
            }
            (true, false, [a, ..]) => (Some(*a), None),
            (false, true, [a, ..]) => (None, Some(*a)),
            _ => return,
        };
        let ends = self.trunk_ends(legs, arms, roles);
        let Some(left) = ends.and_then(|[low, high]| self.left(low, high, legs, roles)) else {
            return;
        };
        for (pair, limb) in [(legs, leg as fn(Side) -> Limb), (arms, arm)] {
            let Some(pair) = pair else { continue };
            let across = self.place(pair.chains[0][0]) - self.place(pair.chains[1][0]);
            let order = if across.dot(&left) >= 0.0 {
                [0, 1]
            } else {
                [1, 0]
            };
            for (side, chain) in Side::BOTH.into_iter().zip(order) {
                self.name_chain(&pair.chains[chain], limb(side), side, roles);
            }
        }
    }

    /// The joints on which legs and arms hang.
    fn trunk_ends(
        &self,
        legs: Option<&Pair>,
        arms: Option<&Pair>,
        roles: &Roles,
    ) -> Option<[usize; 2]> {
        let known = |roles_of: fn(Side) -> Role| {
            let [a, b] = Side::BOTH.map(|side| roles[roles_of(side).index()]);
            let b = self.upwards(b?);
            let a = self.upwards(a?);
            a.into_iter().find(|joint| b.contains(joint))
        };
        let low = legs.map(|pair| pair.stem).or_else(|| known(Role::Hip))?;
        let high = arms
            .map(|pair| pair.stem)
            .or_else(|| known(Role::Shoulder))?;
        (low != high).then_some([low, high])
    }

    /// To the left of the body: across its height, where the toes point forward.
    fn left(
        &self,
        low: usize,
        high: usize,
        legs: Option<&Pair>,
        roles: &Roles,
    ) -> Option<Direction> {
        let up = (self.place(high) - self.place(low)).try_normalize(1e-9)?;
        let toes: Vec<Direction> = match legs {
            Some(pair) => {
                let chains = pair.chains.iter();
                let ends = chains.filter_map(|chain| {
                    let ankle = self.limb_of(chain)?[2];
                    let toe = self.main_child(ankle)?;
                    Some(self.place(toe) - self.place(ankle))
                });
                ends.collect()
            }
            None => Side::BOTH
                .into_iter()
                .filter_map(|side| {
                    let at = |role: Role| roles[role.index()];
                    let (foot, ankle) = (at(Role::Foot(side))?, at(Role::Ankle(side))?);
                    Some(self.place(foot) - self.place(ankle))
                })
                .collect(),
        };
        let forward: Direction = toes.iter().sum();
        let forward = forward - up * up.dot(&forward);
        // Without toes a body looks along +z, or -y where z points up.
        let usual = if up.z.abs() > up.y.abs() {
            -Vector3::y()
        } else {
            Vector3::z()
        };
        let forward = forward.try_normalize(1e-6).unwrap_or(usual);
        Some(up.cross(&forward))
    }

    /// Upper, middle and lower joint of a chain: the ends of its two longest bones in a row.
    fn limb_of(&self, chain: &[usize]) -> Option<[usize; 3]> {
        let least = |three: &&[usize]| {
            self.distance(three[0], three[1])
                .min(self.distance(three[1], three[2]))
        };
        let three = chain.windows(3);
        let best = three.max_by(|a, b| least(a).total_cmp(&least(b)))?;
        Some([best[0], best[1], best[2]])
    }

    fn name_chain(&self, chain: &[usize], limb: Limb, side: Side, roles: &mut Roles) {
        let Some(found) = self.limb_of(chain) else {
            return;
        };
        for (role, joint) in limb.into_iter().zip(found) {
            roles[role.index()] = Some(joint);
        }
        let place = |joint: usize| chain.iter().position(|&other| other == joint);
        let (role, next) = if let Role::Shoulder(_) = limb[0] {
            let before = place(found[0]).and_then(|place| place.checked_sub(1));
            (Role::Collar(side), before.map(|place| chain[place]))
        } else {
            let after = place(found[2]).and_then(|place| chain.get(place + 1));
            (Role::Foot(side), after.copied())
        };
        let next = next.filter(|joint| !roles.contains(&Some(*joint)));
        let own = &mut roles[role.index()];
        *own = own.or(next);
    }

    /// Chains of three joints and more that hang on one joint as mirror images of each other.
    fn pairs(&self) -> Vec<Pair> {
        let mut pairs = Vec::new();
        for (stem, children) in self.children.iter().enumerate() {
            for (number, &a) in children.iter().enumerate() {
                for &b in &children[number + 1..] {
                    let chains = [a, b].map(|first| [vec![first], self.downwards(first)].concat());
                    pairs.extend(self.pair(stem, chains));
                }
            }
        }
        pairs
    }

    fn pair(&self, stem: usize, chains: [Vec<usize>; 2]) -> Option<Pair> {
        let [a, b] = &chains;
        // Fingers and toes may be missing on one side.
        let num_compared = a.len().min(b.len()).min(4);
        if num_compared < 3 {
            return None;
        }
        let length: f64 = a
            .windows(2)
            .take(4)
            .map(|two| self.distance(two[0], two[1]))
            .sum();
        let ends = [
            self.place(a[num_compared - 1]),
            self.place(b[num_compared - 1]),
        ];
        let across = (ends[0] - ends[1]).try_normalize(1e-9)?;
        // Mirror planes are those of the axes: bodies look along one.
        let axis = across.iamax();
        let middle = self.place(stem)[axis];
        let mirrored = |place: Direction| {
            let mut place = place;
            place[axis] = 2.0 * middle - place[axis];
            place
        };
        let pairs = a.iter().zip(b).take(num_compared);
        let off = pairs.map(|(&a, &b)| (mirrored(self.place(a)) - self.place(b)).norm());
        let worst = off.fold(0.0, f64::max);
        (worst < MIRRORED * length).then_some(Pair {
            stem,
            chains,
            length,
        })
    }

    /// The joint at the end of the chain over the neck.
    fn head(&self, roles: &Roles) -> Option<usize> {
        let [left, right] = Side::BOTH.map(|side| roles[Role::Shoulder(side).index()]);
        let (left, right) = (self.upwards(left?), self.upwards(right?));
        let chest = left.iter().copied().find(|joint| right.contains(joint))?;
        let hips = Side::BOTH.map(|side| roles[Role::Hip(side).index()]);
        let [Some(a), Some(b)] = hips else {
            return None;
        };
        let low = 0.5 * (self.place(a) + self.place(b));
        let up = (self.place(chest) - low).try_normalize(1e-9)?;
        let is_neck = |&&child: &&usize| {
            let is_arm = left.contains(&child) || right.contains(&child);
            !is_arm && !self.upwards(a).contains(&child)
        };
        let height = |joint: usize| self.height(joint, &up);
        let necks = self.children[chest].iter().filter(is_neck).copied();
        let mut head = necks.max_by(|&a, &b| height(a).total_cmp(&height(b)))?;
        if height(head) <= up.dot(&self.place(chest)) {
            return None;
        }
        // Eyes, jaw and hair hang on the head; a single tip ends it.
        while let [child] = self.children[head].as_slice() {
            if self.children[*child].is_empty() && is_tip(&self.joints[*child].name) {
                break;
            }
            head = *child;
        }
        Some(head)
    }

    /// How high the highest joint is that hangs on a joint.
    fn height(&self, joint: usize, up: &Direction) -> f64 {
        let own = up.dot(&self.place(joint));
        let below = self.downwards(joint).into_iter();
        below
            .map(|joint| up.dot(&self.place(joint)))
            .fold(own, f64::max)
    }
}

fn arm(side: Side) -> Limb {
    [Role::Shoulder(side), Role::Elbow(side), Role::Wrist(side)]
}

fn leg(side: Side) -> Limb {
    [Role::Hip(side), Role::Knee(side), Role::Ankle(side)]
}

/// Whether a name is that of the end of a bone, which carries no skin.
fn is_tip(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    let tips = ["end", "nub", "tip", "top", "site", "leaf", "eff"];
    tips.iter().any(|tip| name.contains(tip))
}

#[cfg(test)]
mod tests {
    use garnet_skin::Point3;

    use super::*;
    use crate::motion::joint_search::find_roles;

    /// Name, parent and place of the joints of a figure; the right side is mirrored.
    fn figure(rename: impl Fn(&str) -> String) -> Skeleton {
        let joints: [(&str, i32, [f32; 3]); 19] = [
            ("hips", -1, [0.0, 0.9, 0.0]),
            ("left_hip", 0, [0.1, 0.85, 0.0]),
            ("left_knee", 1, [0.12, 0.45, 0.01]),
            ("left_ankle", 2, [0.13, 0.06, -0.03]),
            ("left_toe_base", 3, [0.14, 0.01, 0.1]),
            ("right_hip", 0, [-0.1, 0.85, 0.0]),
            ("right_knee", 5, [-0.12, 0.45, 0.01]),
            ("right_ankle", 6, [-0.13, 0.06, -0.03]),
            ("right_toe_base", 7, [-0.14, 0.01, 0.1]),
            ("spine", 0, [0.0, 1.1, 0.0]),
            ("chest", 9, [0.0, 1.3, 0.0]),
            ("left_collar", 10, [0.05, 1.4, 0.0]),
            ("left_shoulder", 11, [0.18, 1.4, 0.0]),
            ("left_elbow", 12, [0.4, 1.25, 0.0]),
            ("left_wrist", 13, [0.6, 1.1, 0.05]),
            ("neck", 10, [0.0, 1.45, 0.0]),
            ("head", 15, [0.0, 1.55, 0.02]),
            ("head_end", 16, [0.0, 1.75, 0.02]),
            ("jacket", 10, [0.0, 1.3, 0.2]),
        ];
        let mut all: Vec<Joint> = Vec::new();
        for (name, parent, [x, y, z]) in joints {
            all.push(Joint {
                name: rename(name),
                parent: usize::try_from(parent).ok(),
                rest_position: Point3::new(x, y, z),
            });
        }
        for number in 11..15 {
            let joint = all[number].clone();
            let parent = if number == 11 { 10 } else { all.len() - 1 };
            let name = joints[number].0.replace("left", "right");
            let place = joint.rest_position;
            all.push(Joint {
                name: rename(&name),
                parent: Some(parent),
                rest_position: Point3::new(-place.x, place.y, place.z),
            });
        }
        Skeleton::new(all).unwrap()
    }

    fn check(skeleton: &Skeleton, skipped: &[Role]) {
        let expected = find_roles(&figure(str::to_owned)).0;
        let found = find_roles(skeleton).0;
        for role in Role::ALL.into_iter().filter(|role| !skipped.contains(role)) {
            assert_eq!(
                found[role.index()],
                expected[role.index()],
                "{}",
                role.name()
            );
        }
    }

    #[test]
    fn single_joints_of_unknown_names_are_found() {
        for unknown in [
            "head",
            "left_knee",
            "left_ankle",
            "left_hip",
            "left_elbow",
            "left_wrist",
            "left_shoulder",
        ] {
            let renamed = |name: &str| {
                let name = if name == unknown { "thing" } else { name };
                name.to_owned()
            };
            // A shoulder that is unknown leaves its word to the collarbone, which takes none.
            check(&figure(renamed), &[]);
        }
    }

    #[test]
    fn a_chain_of_two_below_the_hip_is_a_leg() {
        let renamed = |name: &str| match name {
            "left_knee" | "left_ankle" | "right_knee" | "right_ankle" => {
                format!("x_{}", name.len())
            }
            _ => name.to_owned(),
        };
        check(&figure(renamed), &[]);
    }

    #[test]
    fn one_side_is_found_by_the_other() {
        let renamed = |name: &str| name.replace("right", "thing");
        let skeleton = figure(renamed);
        check(&skeleton, &[Role::Foot(Side::Right)]);
    }

    #[test]
    fn what_is_between_upper_arm_and_trunk_is_a_collarbone() {
        check(&figure(|name| name.replace("collar", "bone_1")), &[]);
        // An arm that hangs on the chest has none.
        let joints = figure(str::to_owned).joints().to_vec();
        let joints = joints.into_iter().map(|mut joint| {
            if joint.name.ends_with("shoulder") {
                joint.parent = Some(10);
            }
            joint.name = joint.name.replace("collar", "bone_1");
            joint
        });
        let (roles, _) = find_roles(&Skeleton::new(joints.collect()).unwrap());
        assert_eq!(roles[Role::Collar(Side::Left).index()], None);
    }

    #[test]
    fn a_skeleton_without_any_known_name_is_found_by_its_shape() {
        let skeleton = figure(|name| {
            let sum: u32 = name.bytes().map(u32::from).sum();
            // Nothing but its name tells the end of the head's bone from the head.
            let end = if name.ends_with("_end") { "_end" } else { "" };
            format!("bone_{}{end}", sum * 7919 % 977)
        });
        check(&skeleton, &[]);
    }

    #[test]
    fn a_single_known_joint_of_a_limb_tells_the_rest() {
        for known in [
            "left_hip",
            "left_knee",
            "right_ankle",
            "left_shoulder",
            "right_elbow",
            "left_wrist",
            "head",
        ] {
            let skeleton = figure(|name| {
                if name == known || name.ends_with("_end") {
                    return name.to_owned();
                }
                let sum: u32 = name.bytes().map(u32::from).sum();
                format!("bone_{}", sum * 7919 % 977)
            });
            let at_ends = Side::BOTH.map(|side| [Role::Collar(side), Role::Foot(side)]);
            check(&skeleton, at_ends.as_flattened());
        }
    }

    #[test]
    fn labels_come_before_names() {
        let skeleton = figure(str::to_owned);
        let labels = [("head".to_owned(), 15)];
        let found = find_roles(&skeleton.with_labels(labels)).0;
        assert_eq!(found[Role::Head.index()], Some(15));
    }
}
