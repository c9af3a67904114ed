//! Pushing the parts of a body apart.
//!
//! Every contact that is too deep asks its vertex to leave the other part by the shortest way. How
//! far a turn of a shoulder, elbow, hip or knee on the way between the two parts moves them against
//! each other is known from the skeleton; the smallest turns that fulfil all wishes at once are
//! taken (damped least squares, as in inverse kinematics), a few degrees at a time, and the
//! contacts measured anew. Feet that stand keep their direction.

use garnet_skin::{Point3, Pose, Skeleton, SkinError};
use nalgebra::{DMatrix, DVector, Unit, Vector3};

use super::{Contact, ContactKind, ContactReport, Part, SelfContact};
use crate::motion::{Role, Side, world_rotations};

type Rotation = nalgebra::UnitQuaternion<f64>;

/// When a pose is sound, and how it may be changed until it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeparationOptions {
    /// Depth up to which contact is light, in metres.
    pub max_depth: f32,
    /// Depth up to which flesh may meet beyond the crease of an elbow or knee, in metres.
    pub max_fold_depth: f32,
    /// Number of corrections.
    pub max_steps: u32,
    /// The largest turn of a joint in all corrections, in radians.
    pub max_turn: f64,
    /// Whether legs give way, too; if not, feet stay where they are.
    pub legs_give_way: bool,
    /// Whether poses change by as little as they have to, and hardly differ of bodies that hardly
    /// differ: all vertices that are too deep count, not the deepest ones alone, and no contact is
    /// pushed farther than to the allowed depth. It takes more corrections.
    pub is_least: bool,
    /// Room that arms leave to trunk and thighs, for cloth between them, in metres: depths of these
    /// are measured from so far outside of the skin. It fades towards the armpit.
    pub room: f32,
}

impl Default for SeparationOptions {
    fn default() -> Self {
        Self {
            max_depth: 0.010,
            max_fold_depth: 0.025,
            max_steps: 12,
            max_turn: 0.6,
            legs_give_way: true,
            is_least: false,
            room: 0.0,
        }
    }
}

impl SeparationOptions {
    /// As little as a body needs, so that bodies that are alike stand alike.
    #[must_use]
    pub fn least() -> Self {
        Self {
            max_steps: 40,
            is_least: true,
            ..Self::default()
        }
    }

    /// The same for a body that is so many times as large as a grown one.
    pub(super) fn scaled(self, scale: f32) -> Self {
        Self {
            max_depth: scale * self.max_depth,
            max_fold_depth: scale * self.max_fold_depth,
            room: scale * self.room,
            ..self
        }
    }

    /// Depth up to which a contact is light, in metres.
    fn limit(&self, contact: &Contact) -> f32 {
        match contact.kind {
            // A thigh that is bent meets the trunk beyond the crease, too, and has no lever there.
            ContactKind::Contact if self.is_least && is_at_hip(contact) => self.max_fold_depth,
            ContactKind::Contact => self.max_depth,
            ContactKind::Fold => self.max_fold_depth,
            ContactKind::Crease => f32::INFINITY,
        }
    }

    /// Whether no contact is too deep.
    pub(super) fn is_sound(&self, report: &ContactReport) -> bool {
        let mut contacts = report.contacts.iter();
        contacts.all(|contact| contact.depth <= self.limit(contact))
    }
}

/// A pose in which no contact is too deep.
#[derive(Debug, Clone, PartialEq)]
pub struct Separated {
    /// The pose.
    pub pose: Pose,
    /// Number of corrections; 0 if the pose is as it was.
    pub num_steps: u32,
    /// The largest turn of a joint, in radians.
    pub largest_turn: f64,
    /// The deepest contact that is no fold, before and after, in metres.
    pub depths: [f32; 2],
    /// The contacts of the pose.
    pub report: ContactReport,
}

/// Turn of a joint in one correction at most, in radians.
const MAX_STEP: f64 = 0.12;

/// Depth that is left, in parts of the allowed one.
const KEPT: f32 = 0.6;

/// The same of poses that change by as little as they have to.
const LEAST_KEPT: f32 = 0.99;

/// The same as [`DAMPING`] of those: more of it takes more corrections, and lets turns that hardly
/// move a contact depend less on where exactly that is.
const LEAST_DAMPING: f64 = 0.03;

/// Damping of the least squares, against squared lever arms of a few decimetres: those of a grown
/// body.
const DAMPING: f64 = 2e-3;

/// Cosine of the slope of a foot that stands.
const LEVEL: f64 = 0.95;

/// A turn of a joint about an axis in the world.
#[derive(Debug, Clone, Copy)]
struct Turn {
    joint: usize,
    axis: Vector3<f64>,
    weight: f64,
    /// Whether the joint bends about this axis alone.
    is_hinge: bool,
}

impl SelfContact {
    /// The pose with its parts apart; none if that takes more than the options allow.
    ///
    /// # Errors
    ///
    /// Those of [`Skeleton::transforms`].
    pub fn separated(
        &self,
        pose: &Pose,
        options: &SeparationOptions,
    ) -> Result<Option<Separated>, SkinError> {
        let options = &options.scaled(self.scale());
        let mut pose = pose.clone();
        let given_pose = pose.clone();
        let mut first_depth = None;
        for num_steps in 0..=options.max_steps {
            let all = if options.is_least {
                self.all_contacts(&pose)?
            } else {
                Vec::new()
            };
            let report = if options.is_least {
                Self::report_of_all(&all)
            } else {
                self.report_with_room(&pose, options.room)?
            };
            let first = *first_depth.get_or_insert(report.depth());
            let largest_turn = largest_turn(&given_pose, &pose);
            if largest_turn > options.max_turn {
                return Ok(None);
            }
            if options.is_sound(&report) {
                return Ok(Some(Separated {
                    num_steps,
                    largest_turn,
                    depths: [first, report.depth()],
                    pose,
                    report,
                }));
            }
            if options.is_least {
                self.push_least(&mut pose, &all, options)?;
            } else {
                self.push(&mut pose, &report, options)?;
            }
        }
        Ok(None)
    }

    /// Turns joints so that vertices that are too deep in another part leave it. The options are
    /// those for the size of the body.
    pub(super) fn push(
        &self,
        pose: &mut Pose,
        report: &ContactReport,
        options: &SeparationOptions,
    ) -> Result<(), SkinError> {
        // Contacts that are nearly too deep are kept from becoming so.
        let above = |contact: &Contact| contact.depth - KEPT * options.limit(contact);
        let wishes = report
            .contacts
            .iter()
            .filter(|contact| above(contact) > 0.0);
        let wishes: Vec<(Contact, f64)> = wishes
            .map(|contact| (*contact, f64::from(above(contact))))
            .collect();
        let body = self.body();
        let skeleton = body.skeleton();
        let transforms = skeleton.transforms(pose)?;
        let position = |joint: usize| -> Vector3<f64> {
            (transforms[joint] * skeleton.joints()[joint].rest_position)
                .coords
                .cast()
        };
        let turns = self.turns(position, options.legs_give_way);
        let mut levers: DMatrix<f64> = DMatrix::zeros(wishes.len(), turns.len());
        let mut lengths: DVector<f64> = DVector::zeros(wishes.len());
        for (row, (contact, length)) in wishes.iter().enumerate() {
            let Some(out) = self.way_out(contact, &turns, position) else {
                continue;
            };
            lengths[row] = *length;
            let ends = [
                (contact.vertex, contact.position, 1.0),
                (contact.exit_vertex, contact.exit, -1.0),
            ];
            for (vertex, point, sign) in ends {
                let joint = body.weights().heaviest(vertex as usize);
                for (column, turn) in turns.iter().enumerate() {
                    if hangs_on(skeleton, joint, turn.joint) {
                        let arm = point.coords.cast() - position(turn.joint);
                        levers[(row, column)] +=
                            sign * turn.weight * turn.axis.cross(&arm).dot(&out);
                    }
                }
            }
        }
        let damping = DAMPING * f64::from(self.scale()).powi(2);
        let mut square: DMatrix<f64> = &levers * levers.transpose();
        for index in 0..wishes.len() {
            square[(index, index)] += damping;
        }
        let Some(factor) = square.cholesky() else {
            return Ok(());
        };
        let turned: DVector<f64> = levers.transpose() * factor.solve(&lengths);
        self.apply(pose, &turns, &turned, position);
        Ok(())
    }

    /// Turns joints by as little as leads vertices that are too deep out of another part, all of
    /// them counted by how far they are too deep.
    fn push_least(
        &self,
        pose: &mut Pose,
        all: &[Vec<Contact>],
        options: &SeparationOptions,
    ) -> Result<(), SkinError> {
        let body = self.body();
        let skeleton = body.skeleton();
        let transforms = skeleton.transforms(pose)?;
        let position = |joint: usize| -> Vector3<f64> {
            (transforms[joint] * skeleton.joints()[joint].rest_position)
                .coords
                .cast()
        };
        let turns = self.turns(position, options.legs_give_way);
        let moves: Vec<Vec<bool>> = turns
            .iter()
            .map(|turn| {
                let joints = 0..skeleton.num_joints();
                joints
                    .map(|joint| hangs_on(skeleton, joint, turn.joint))
                    .collect()
            })
            .collect();
        // How much of a vertex goes along with a turn.
        let share = |vertex: u32, column: usize| -> f64 {
            let weights = body.weights().vertex(vertex as usize);
            let moved = weights.filter(|&(joint, _)| moves[column][joint]);
            moved.map(|(_, weight)| f64::from(weight)).sum()
        };
        let mut square: DMatrix<f64> = DMatrix::identity(turns.len(), turns.len());
        square *= LEAST_DAMPING * f64::from(self.scale()).powi(2);
        let mut wished: DVector<f64> = DVector::zeros(turns.len());
        for contacts in all {
            let above = |contact: &Contact| {
                f64::from(contact.depth - LEAST_KEPT * options.limit(contact)).max(0.0)
            };
            let sum: f64 = contacts.iter().map(above).sum();
            for contact in contacts.iter().filter(|contact| above(contact) > 0.0) {
                let Some(out) = self.way_out(contact, &turns, position) else {
                    continue;
                };
                let lever = |(column, turn): (usize, &Turn)| {
                    let at = |point: Point3| {
                        let arm = point.coords.cast() - position(turn.joint);
                        turn.weight * turn.axis.cross(&arm).dot(&out)
                    };
                    let of_exit = contact.exit_corners.iter();
                    let of_exit =
                        of_exit.map(|&(vertex, part)| f64::from(part) * share(vertex, column));
                    share(contact.vertex, column) * at(contact.position)
                        - of_exit.sum::<f64>() * at(contact.exit)
                };
                let row = DVector::from_iterator(turns.len(), turns.iter().enumerate().map(lever));
                let weight = above(contact) / sum;
                square.ger(weight, &row, &row, 1.0);
                wished.axpy(weight * above(contact), &row, 1.0);
            }
        }
        if let Some(factor) = square.cholesky() {
            self.apply(pose, &turns, &factor.solve(&wished), position);
        }
        Ok(())
    }

    /// Turns joints of a pose, by no more than a step; feet that stand keep their direction.
    fn apply(
        &self,
        pose: &mut Pose,
        turns: &[Turn],
        turned: &DVector<f64>,
        position: impl Fn(usize) -> Vector3<f64>,
    ) {
        let skeleton = self.body().skeleton();
        let mut world = world_rotations(skeleton, pose);
        let feet = self.standing_feet(&world, position);
        let feet: Vec<(usize, Rotation)> = feet.map(|foot| (foot, world[foot])).collect();
        let mut vectors = vec![Vector3::<f64>::zeros(); skeleton.num_joints()];
        for (turn, amount) in turns.iter().zip(turned.iter()) {
            vectors[turn.joint] += turn.axis * (turn.weight * amount);
        }
        let mut own = vec![Rotation::identity(); skeleton.num_joints()];
        for &joint in skeleton.parents_first() {
            let vector = vectors[joint];
            let length = vector.norm();
            let vector = if length > MAX_STEP {
                vector * (MAX_STEP / length)
            } else {
                vector
            };
            let above = skeleton.joints()[joint]
                .parent
                .map_or_else(Rotation::identity, |parent| own[parent]);
            own[joint] = above * Rotation::from_scaled_axis(vector);
            world[joint] = own[joint] * world[joint];
        }
        for (foot, rotation) in feet {
            set_subtree(skeleton, &mut world, foot, rotation);
        }
        for (joint, rotation) in pose.rotations.iter_mut().enumerate() {
            let parent = skeleton.joints()[joint].parent;
            let parent = parent.map_or_else(Rotation::identity, |parent| world[parent]);
            let local = parent.inverse() * world[joint];
            *rotation = nalgebra::UnitQuaternion::new_normalize(local.into_inner().cast());
        }
    }

    /// The direction in which the vertex of a contact shall leave the other part: the shortest way,
    /// and the way that opens the joint for a fold.
    fn way_out(
        &self,
        contact: &Contact,
        turns: &[Turn],
        position: impl Fn(usize) -> Vector3<f64>,
    ) -> Option<Unit<Vector3<f64>>> {
        let shortest = (contact.exit - contact.position).cast::<f64>();
        let [tested, within] = contact.parts;
        let is_below = tested.parent() == Some(within);
        let hinge = if is_below { tested } else { within }.joint();
        let joint = hinge.and_then(|role| self.figure().joint(role));
        let hinge = turns
            .iter()
            .find(|turn| turn.is_hinge && Some(turn.joint) == joint);
        let way = match hinge.filter(|_| contact.kind == ContactKind::Fold) {
            Some(turn) => {
                let arm = contact.position.coords.cast() - position(turn.joint);
                // The axis is the one about which the joint closes.
                let closes = turn.axis.cross(&arm);
                if is_below { -closes } else { closes }
            }
            None => shortest,
        };
        Unit::try_new(way, 1e-6)
    }

    /// Ankles of feet that are level and as low as the other one.
    fn standing_feet(
        &self,
        world: &[Rotation],
        position: impl Fn(usize) -> Vector3<f64>,
    ) -> impl Iterator<Item = usize> {
        let up = self.figure().rest_from_body() * Vector3::y();
        let feet = Side::BOTH.map(|side| self.figure().joint(Role::Ankle(side)));
        let feet = feet.map(|foot| foot.map(|foot| (foot, position(foot).y)));
        let low = feet.iter().flatten().map(|(_, height)| *height);
        let low = low.fold(f64::INFINITY, f64::min) + 0.1 * self.figure().leg_length();
        let stands = |&(foot, height): &(usize, f64)| height <= low && (world[foot] * up).y > LEVEL;
        let standing: Vec<_> = feet.into_iter().flatten().filter(stands).collect();
        standing.into_iter().map(|(foot, _)| foot)
    }

    fn turns(&self, position: impl Fn(usize) -> Vector3<f64>, legs_give_way: bool) -> Vec<Turn> {
        let num_limbs = if legs_give_way { 2 } else { 1 };
        let mut turns = Vec::new();
        for side in Side::BOTH {
            // Arms give way before legs.
            let roots = [(Role::Shoulder(side), 1.0), (Role::Hip(side), 0.5)];
            for (role, weight) in roots.into_iter().take(num_limbs) {
                let Some(joint) = self.figure().joint(role) else {
                    continue;
                };
                for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
                    turns.push(Turn {
                        joint,
                        axis,
                        weight,
                        is_hinge: false,
                    });
                }
            }
            let hinges = [
                (
                    Role::Shoulder(side),
                    Role::Elbow(side),
                    Role::Wrist(side),
                    0.7,
                ),
                (Role::Hip(side), Role::Knee(side), Role::Ankle(side), 0.5),
            ];
            for (above, role, end, weight) in hinges.into_iter().take(num_limbs) {
                let joints = [above, role, end].map(|role| self.figure().joint(role));
                let [Some(above), Some(joint), Some(end)] = joints else {
                    continue;
                };
                let bones = [
                    position(joint) - position(above),
                    position(end) - position(joint),
                ];
                // A straight limb has no axis to bend about, nor need of one.
                let across = bones[0].cross(&bones[1]);
                let least = 0.1 * bones[0].norm() * bones[1].norm();
                if let Some(axis) = Unit::try_new(across, least.max(1e-9)) {
                    let axis = axis.into_inner();
                    turns.push(Turn {
                        joint,
                        axis,
                        weight,
                        is_hinge: true,
                    });
                }
            }
        }
        turns
    }
}

fn is_at_hip(contact: &Contact) -> bool {
    matches!(
        contact.parts,
        [Part::Thigh(_), Part::Trunk] | [Part::Trunk, Part::Thigh(_)]
    )
}

fn hangs_on(skeleton: &Skeleton, joint: usize, ancestor: usize) -> bool {
    let mut next = Some(joint);
    while let Some(joint) = next {
        if joint == ancestor {
            return true;
        }
        next = skeleton.joints()[joint].parent;
    }
    false
}

/// Gives a joint a rotation in the world and turns what hangs on it along.
fn set_subtree(skeleton: &Skeleton, world: &mut [Rotation], root: usize, rotation: Rotation) {
    let turn = rotation * world[root].inverse();
    for (joint, world) in world.iter_mut().enumerate() {
        if hangs_on(skeleton, joint, root) {
            *world = turn * *world;
        }
    }
}

/// The largest angle between local rotations of two poses, in radians.
fn largest_turn(a: &Pose, b: &Pose) -> f64 {
    let angles = a.rotations.iter().zip(&b.rotations).map(|(a, b)| {
        let turn = a.inverse() * b;
        2.0 * f64::from(turn.vector().norm()).atan2(f64::from(turn.w.abs()))
    });
    angles.fold(0.0, f64::max)
}
