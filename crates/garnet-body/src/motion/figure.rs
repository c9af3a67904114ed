//! The human figure in a skeleton: which joint is which, and where the body's axes point at rest.

use garnet_skin::Skeleton;
use nalgebra::{Matrix3, Rotation3, Vector3};

use super::{
    RetargetError, Role, Side,
    joint_names::NUM_ROLES,
    joint_search::find_roles,
    rotation::{Direction, Rotation, unit},
};

/// How many names an error lists.
const NUM_LISTED_NAMES: usize = 24;

/// A direction within 15 degrees of an axis is that axis.
const ON_AXIS: f64 = 0.966;

/// The joints of a human figure in a skeleton.
///
/// Limbs and head are those that [`Skeleton::labels`] names, else those whose names are known (see
/// [`role_names`](super::role_names)), else those that the hierarchy tells; pelvis, spine and neck
/// are found by what hangs on them: the pelvis is the joint on which both legs and both arms hang,
/// the chest the joint on which both arms and the head hang.
#[derive(Debug, Clone)]
pub struct Figure {
    roles: [Option<usize>; NUM_ROLES],
    trunk: Vec<usize>,
    neck: Vec<usize>,
    positions: Vec<Direction>,
    rest_from_body: Rotation,
    leg_length: f64,
    has_other_sides: bool,
}

/// Legs and trunk of a figure that stands or sits at rest point apart by more than this, in
/// radians.
const LEAST_OPENED: f64 = 1.2;

impl Figure {
    /// Finds the figure in `skeleton`; `whose` (`the motion`, `the body`) is for the error.
    ///
    /// # Errors
    ///
    /// [`RetargetError::MissingJoints`], [`RetargetError::Apart`] or [`RetargetError::NoLegs`].
    pub fn new(skeleton: &Skeleton, whose: &'static str) -> Result<Self, RetargetError> {
        let joints = skeleton.joints();
        let (roles, has_other_sides) = find_roles(skeleton);
        let is_missing = |role: &Role| role.is_required() && roles[role.index()].is_none();
        let missing: Vec<&str> = Role::ALL
            .into_iter()
            .filter(is_missing)
            .map(Role::name)
            .collect();
        if !missing.is_empty() {
            let names = joints.iter().take(NUM_LISTED_NAMES);
            let of_role = |role: Role| {
                let joint = roles[role.index()]?;
                Some((role.name(), joints[joint].name.clone()))
            };
            return Err(RetargetError::MissingJoints {
                whose,
                missing,
                mapped: Role::ALL.into_iter().filter_map(of_role).collect(),
                found: names.map(|joint| joint.name.clone()).collect(),
            });
        }
        let chain_of = |role: Role| match roles[role.index()] {
            Some(joint) => ancestors(skeleton, joint),
            None => Vec::new(),
        };
        let [left, right] = Side::BOTH.map(|side| chain_of(Role::Shoulder(side)));
        let head = chain_of(Role::Head);
        let common = |a: &[usize], b: &[usize]| {
            last_common(a, b).ok_or_else(|| RetargetError::Apart {
                whose,
                a: name_of(skeleton, a),
                b: name_of(skeleton, b),
            })
        };
        common(&left, &right)?;
        let chest = common(&shared(&left, &right), &head)?;
        let [left_leg, right_leg] = Side::BOTH.map(|side| chain_of(Role::Hip(side)));
        common(&left_leg, &right_leg)?;
        let pelvis = common(&shared(&left_leg, &right_leg), &shared(&left, &head))?;

        let below = |joint: usize, chain: &[usize]| {
            let start = chain.iter().position(|&other| other == joint);
            start.map_or_else(Vec::new, |start| chain[start..].to_vec())
        };
        let mut trunk = below(pelvis, &head);
        let end = trunk.iter().position(|&joint| joint == chest);
        let mut neck = trunk.split_off(end.map_or(trunk.len(), |end| end + 1));
        neck.pop();
        let positions: Vec<Direction> = joints
            .iter()
            .map(|joint| joint.rest_position.coords.cast())
            .collect();
        let mut figure = Self {
            roles,
            trunk,
            neck,
            positions,
            rest_from_body: Rotation::identity(),
            leg_length: 0.0,
            has_other_sides,
        };
        figure.leg_length = figure.measured_leg_length();
        if !(figure.leg_length > 1e-6 && figure.leg_length.is_finite()) {
            return Err(RetargetError::NoLegs { whose });
        }
        figure.rest_from_body = figure.axes();
        Ok(figure)
    }

    /// The joint of a role.
    pub fn joint(&self, role: Role) -> Option<usize> {
        self.roles[role.index()]
    }

    /// Whether joints whose names say left are taken for those of the right side, because of the
    /// way in which the toes point.
    pub fn has_other_sides(&self) -> bool {
        self.has_other_sides
    }

    /// The joint on which legs and spine hang.
    pub fn pelvis(&self) -> usize {
        self.trunk.first().copied().unwrap_or(0)
    }

    /// The joint on which arms and neck hang.
    pub fn chest(&self) -> usize {
        self.trunk.last().copied().unwrap_or(0)
    }

    /// The joints from pelvis to chest, both included.
    pub fn trunk(&self) -> &[usize] {
        &self.trunk
    }

    /// The joints between chest and head.
    pub fn neck(&self) -> &[usize] {
        &self.neck
    }

    /// The joint that the built-in skeleton calls so: `left_knee`, `pelvis`, `spine2`, `neck` …
    pub fn named(&self, name: &str) -> Option<usize> {
        if let Some(role) = Role::ALL.into_iter().find(|role| role.name() == name) {
            return self.joint(role);
        }
        let spine = |number: usize| {
            // Longer and shorter spines are met at the same part of their height.
            let last = self.trunk.len().checked_sub(1).filter(|&last| last > 0)?;
            self.trunk.get(((number * last + 1) / 3).max(1)).copied()
        };
        match name {
            "pelvis" => Some(self.pelvis()),
            "spine1" => spine(1),
            "spine2" => spine(2),
            "spine3" => spine(3),
            "neck" => self.neck.first().copied(),
            _ => None,
        }
    }

    /// Thigh and shank, the mean of both sides, in metres.
    pub fn leg_length(&self) -> f64 {
        self.leg_length
    }

    /// Whether legs and trunk point about the same way at rest: no figure that stands.
    pub(crate) fn is_folded(&self) -> bool {
        let middle = |role: fn(Side) -> Role| {
            let [left, right] = Side::BOTH.map(|side| self.joint(role(side)));
            Some(0.5 * (self.position(left?) + self.position(right?)))
        };
        let angle = || {
            let legs = unit(&(middle(Role::Ankle)? - middle(Role::Hip)?))?;
            let head = self.position(self.joint(Role::Head)?);
            Some(legs.angle(&unit(&(head - self.position(self.pelvis())))?))
        };
        angle().is_some_and(|angle| angle < LEAST_OPENED)
    }

    /// Turns the body's axes (x to its left, y up, z to its front) into the axes of the rest pose.
    pub fn rest_from_body(&self) -> Rotation {
        self.rest_from_body
    }

    /// Rest position of a joint.
    pub(crate) fn position(&self, joint: usize) -> Direction {
        self.positions.get(joint).copied().unwrap_or_default()
    }

    /// The vector of a bone at rest: from the joint of `role` to the next joint of the limb.
    /// Nothing for the head, the hands, the balls of the feet and bones without length.
    pub(crate) fn bone(&self, role: Role) -> Option<Direction> {
        let (from, to) = self.bone_joints(role)?;
        let bone = self.position(to) - self.position(from);
        // A bone shorter than a thousandth of the leg has no direction.
        (bone.norm() > 1e-3 * self.leg_length).then_some(bone)
    }

    /// The joints at both ends of the bone of a role.
    pub(crate) fn bone_joints(&self, role: Role) -> Option<(usize, usize)> {
        let next = match role {
            Role::Shoulder(side) => Role::Elbow(side),
            Role::Elbow(side) => Role::Wrist(side),
            Role::Hip(side) => Role::Knee(side),
            Role::Knee(side) => Role::Ankle(side),
            Role::Ankle(side) => Role::Foot(side),
            Role::Head | Role::Collar(_) | Role::Wrist(_) | Role::Foot(_) => return None,
        };
        Some((self.joint(role)?, self.joint(next)?))
    }

    /// From the ankles to the head at rest.
    pub(crate) fn upward(&self) -> Direction {
        let at = |role: Role| {
            self.joint(role)
                .map_or_else(Direction::zeros, |joint| self.position(joint))
        };
        let ankles = Side::BOTH.map(|side| at(Role::Ankle(side)));
        at(Role::Head) - 0.5 * (ankles[0] + ankles[1])
    }

    fn measured_leg_length(&self) -> f64 {
        let length = |role: Role| {
            let ends = self.bone_joints(role);
            ends.map_or(0.0, |(from, to)| {
                (self.position(to) - self.position(from)).norm()
            })
        };
        let sides = Side::BOTH.map(|side| length(Role::Hip(side)) + length(Role::Knee(side)));
        0.5 * (sides[0] + sides[1])
    }

    fn axes(&self) -> Rotation {
        let between = |role: fn(Side) -> Role| {
            let at = |side| self.joint(role(side)).map(|joint| self.position(joint));
            Some(at(Side::Left)? - at(Side::Right)?)
        };
        let up = snapped(unit(&self.upward()).unwrap_or_else(Vector3::y));
        let across = |vector: Option<Direction>| {
            let vector = vector?;
            let flat = vector - up * up.dot(&vector);
            (flat.norm() > 1e-3 * self.leg_length)
                .then(|| unit(&flat))
                .flatten()
        };
        let left = across(between(Role::Hip))
            .or_else(|| across(between(Role::Shoulder)))
            .or_else(|| across(Some(Vector3::x())))
            .unwrap_or_else(Vector3::z);
        let left = snapped(left);
        let flat = left - up * up.dot(&left);
        let left = unit(&flat).unwrap_or(left);
        let front = left.cross(&up);
        let matrix = Matrix3::from_columns(&[left, up, front]);
        Rotation::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix))
    }
}

/// The joint of a skeleton that the built-in skeleton calls so, whatever its own name is.
pub fn joint_named(skeleton: &Skeleton, name: &str) -> Option<usize> {
    if let Some(role) = Role::ALL.into_iter().find(|role| role.name() == name) {
        return find_roles(skeleton).0[role.index()];
    }
    Figure::new(skeleton, "the body").ok()?.named(name)
}

/// The axis near to a direction, or the direction itself where there is none.
fn snapped(direction: Direction) -> Direction {
    for axis in 0..3 {
        if direction[axis].abs() > ON_AXIS {
            let mut snapped = Vector3::zeros();
            snapped[axis] = direction[axis].signum();
            return snapped;
        }
    }
    direction
}

/// The joints from the root to `joint`, both included.
fn ancestors(skeleton: &Skeleton, joint: usize) -> Vec<usize> {
    let mut chain = vec![joint];
    let mut next = joint;
    while let Some(parent) = skeleton.joints()[next].parent {
        chain.push(parent);
        next = parent;
    }
    chain.reverse();
    chain
}

/// What two chains from a root begin with.
fn shared(a: &[usize], b: &[usize]) -> Vec<usize> {
    let pairs = a.iter().zip(b).take_while(|(a, b)| a == b);
    pairs.map(|(&joint, _)| joint).collect()
}

fn last_common(a: &[usize], b: &[usize]) -> Option<usize> {
    shared(a, b).last().copied()
}

fn name_of(skeleton: &Skeleton, chain: &[usize]) -> String {
    let last = chain
        .last()
        .map(|&joint| skeleton.joints()[joint].name.clone());
    last.unwrap_or_default()
}
