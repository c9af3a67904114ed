//! Retargeting: the motion of one skeleton on another, with the full orientation of each joint.
//!
//! Copying local angles is wrong as soon as the rest poses differ: the zero pose of the CMU
//! skeleton is a T-pose with the legs splayed by 20 degrees. Here the rest pose of the target is
//! first bent into that of the source, bone by bone from the trunk outwards, each by the smallest
//! rotation; a rotation of the source in the world then does the same to both:
//!
//! ```text
//! W_target(j) = C_j · W_source(j) · A_j
//! A_j = smallest rotation from A_parent(j) · d_target(j) to d_source(j), times A_parent(j)
//! ```
//!
//! `d` are directions of bones at rest, `W` rotations from rest to pose in the world. `W_source`
//! brings its twist along; where rest poses differ, the hinges of elbows and knees settle the turn
//! of `A_j` about the bone. `C_j` is a last smallest rotation onto the source's bone in the world:
//! the identity, unless joints in between (a second bone of the forearm) bend on their own.
//! Trunk, neck, head and collarbones are not bent into each other: where rigs put those joints is a
//! matter of taste (the CMU collarbone rises by 20 degrees at rest), and both rest poses stand
//! upright. Spines of other lengths take the rotation of the source at the same height.

use garnet_skin::{Pose, Skeleton, Vector3};

use super::{
    Figure, Motion, RetargetError, Role, Side,
    error::THE_MOTION,
    flips::Flips,
    hinges::turn_about_bone,
    rotation::{Direction, Rotation, local_rotations, smallest_rotation, unit, world_rotations},
};

/// Where the figure stands, seen from above.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum StartAt {
    /// Where the motion has it, scaled by the length of the legs.
    #[default]
    Motion,
    /// The first frame of the motion stands over the origin.
    Origin,
    /// Every frame stands over the origin.
    OriginAlways,
}

/// How to carry a motion over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RetargetOptions {
    /// Where the figure stands.
    pub start_at: StartAt,
    /// Leave joints that the recording turns over from one frame to the next as they are recorded,
    /// instead of turning them within a fifth of a second.
    pub keep_flips: bool,
}

/// A motion's skeleton fitted to another, ready to carry frames over.
#[derive(Debug, Clone)]
pub struct Retarget<'a> {
    motion: &'a Motion,
    target_skeleton: &'a Skeleton,
    source: Figure,
    target: Figure,
    /// `A_j` of each limb, by role.
    alignments: Vec<(Role, Rotation)>,
    trunk_alignment: Rotation,
    scale: f64,
    origin: Direction,
    start_at: StartAt,
    knuckles: [Vec<usize>; 2],
    flips: Flips,
    /// Joints of the target that no role names and that the source has by the same name, with the
    /// joint there and `A_j`.
    namesakes: Vec<(usize, usize, Rotation)>,
    notes: Vec<String>,
}

impl<'a> Retarget<'a> {
    /// Fits the skeleton of `motion` to `target`.
    ///
    /// # Errors
    ///
    /// [`RetargetError::MissingJoints`] if one of them is no human figure: collarbones, balls of
    /// the feet, fingers and toes may be missing. [`RetargetError::Folded`] if the motion does not
    /// tell how its joints are turned at rest.
    pub fn new(
        motion: &'a Motion,
        target: &'a Skeleton,
        options: &RetargetOptions,
    ) -> Result<Self, RetargetError> {
        let source_figure = Figure::new(&motion.skeleton, THE_MOTION)?;
        if source_figure.is_folded() {
            return Err(RetargetError::Folded);
        }
        let target_figure = Figure::new(target, "the body")?;
        let trunk_alignment =
            source_figure.rest_from_body() * target_figure.rest_from_body().inverse();
        let mut notes = Vec::new();
        for role in Role::ALL {
            if target_figure.joint(role).is_some() && source_figure.joint(role).is_none() {
                notes.push(format!(
                    "the motion has no `{}`: it follows its parent",
                    role.name()
                ));
            }
        }
        if source_figure.trunk().len() == 1 {
            notes.push("the motion has no spine: the trunk stays straight".to_owned());
        }
        let flips = if options.keep_flips {
            Flips::default()
        } else {
            Flips::find(motion)
        };
        notes.extend(flips.note(motion));
        let alignments = alignments(motion, &source_figure, &target_figure, trunk_alignment);
        let figures = [&source_figure, &target_figure];
        let skeletons = [&motion.skeleton, target];
        let mut retarget = Self {
            namesakes: namesakes(skeletons, figures, &alignments, trunk_alignment),
            alignments,
            flips,
            knuckles: Side::BOTH.map(|side| knuckles(skeletons, &source_figure, side)),
            scale: target_figure.leg_length() / source_figure.leg_length(),
            motion,
            target_skeleton: target,
            source: source_figure,
            target: target_figure,
            trunk_alignment,
            origin: Direction::zeros(),
            start_at: options.start_at,
            notes,
        };
        if options.start_at == StartAt::Origin
            && let Some(frame) = motion.frames.first()
        {
            retarget.origin = retarget.pelvis_above_origin(frame)?;
        }
        Ok(retarget)
    }

    /// What the motion lacks, for the user to read.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Length of the target's legs in lengths of the source's.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The pose of the target in a frame of the motion.
    ///
    /// # Errors
    ///
    /// [`RetargetError::FrameOutOfRange`] or [`RetargetError::Skin`].
    pub fn pose(&self, frame: usize) -> Result<Pose, RetargetError> {
        let num_frames = self.motion.frames.len();
        let Some(recorded) = self.motion.frames.get(frame) else {
            return Err(RetargetError::FrameOutOfRange { frame, num_frames });
        };
        let mended = self.flips.mended(self.motion, frame);
        let source_pose = mended.as_ref().unwrap_or(recorded);
        let world = self.target_world_rotations(source_pose)?;
        let pelvis = self.pelvis_position(source_pose)?;
        let above_origin = match self.start_at {
            StartAt::Origin => self.origin,
            StartAt::Motion => Direction::zeros(),
            StartAt::OriginAlways => self.pelvis_above_origin(source_pose)?,
        };
        let mut pose = Pose {
            root_translation: Vector3::zeros(),
            rotations: local_rotations(self.target_skeleton, &world),
        };
        let wanted = self.scale * (pelvis - above_origin);
        let joint = self.target.pelvis();
        let placed = self.target_skeleton.transforms(&pose)?[joint]
            * self.target_skeleton.joints()[joint].rest_position;
        pose.root_translation = (wanted - placed.coords.cast::<f64>()).cast::<f32>();
        Ok(pose)
    }

    /// The pelvis of the source in the world.
    fn pelvis_position(&self, pose: &Pose) -> Result<Direction, RetargetError> {
        let joint = self.source.pelvis();
        let transforms = self.motion.skeleton.transforms(pose)?;
        let position = transforms[joint] * self.motion.skeleton.joints()[joint].rest_position;
        Ok(position.coords.cast())
    }

    fn pelvis_above_origin(&self, pose: &Pose) -> Result<Direction, RetargetError> {
        let position = self.pelvis_position(pose)?;
        Ok(Direction::new(position.x, 0.0, position.z))
    }

    fn target_world_rotations(&self, source_pose: &Pose) -> Result<Vec<Rotation>, RetargetError> {
        let source_world = world_rotations(&self.motion.skeleton, source_pose);
        let transforms = self.motion.skeleton.transforms(source_pose)?;
        let joints = self.motion.skeleton.joints();
        let position = |joint: usize| -> Direction {
            (transforms[joint] * joints[joint].rest_position)
                .coords
                .cast()
        };
        let num_joints = self.target_skeleton.num_joints();
        let mut wanted: Vec<Option<Rotation>> = vec![None; num_joints];

        self.set_chain(
            &mut wanted,
            &source_world,
            [self.source.trunk(), self.target.trunk()],
        );
        let mut necks = [self.source.neck().to_vec(), self.target.neck().to_vec()];
        if necks[0].is_empty() {
            necks[0] = vec![self.source.chest()];
        }
        if !necks[1].is_empty() {
            self.set_chain(&mut wanted, &source_world, [&necks[0], &necks[1]]);
        }
        for (role, alignment) in &self.alignments {
            let (Some(from), Some(to)) = (self.source.joint(*role), self.target.joint(*role))
            else {
                continue;
            };
            let mut rotation = source_world[from] * alignment;
            let bones = self.source.bone_joints(*role).zip(self.target.bone(*role));
            let is_bone = self.source.bone(*role).is_some();
            if let Some(((start, end), bone)) = bones.filter(|_| is_bone) {
                let direction = position(end) - position(start);
                if let Some(last) = smallest_rotation(&(rotation * bone), &direction) {
                    rotation = last * rotation;
                }
            }
            if let Role::Wrist(side) = *role {
                rotation = self.bend_of_palm(side, from, source_world[from], position) * rotation;
            }
            wanted[to] = Some(rotation);
        }
        for &(from, to, alignment) in &self.namesakes {
            wanted[to] = Some(source_world[from] * alignment);
        }

        let mut world = vec![Rotation::identity(); num_joints];
        for &index in self.target_skeleton.parents_first() {
            let parent = self.target_skeleton.joints()[index].parent;
            // Joints above the pelvis stay, others that nobody moves follow their parents.
            world[index] = match (wanted[index], parent) {
                (Some(rotation), _) => rotation,
                (None, Some(parent)) => world[parent],
                (None, None) => Rotation::identity(),
            };
        }
        Ok(world)
    }

    /// What the bones of the palm turn the hand beyond the wrist, in the world.
    fn bend_of_palm(
        &self,
        side: Side,
        wrist: usize,
        wrist_rotation: Rotation,
        position: impl Fn(usize) -> Direction,
    ) -> Rotation {
        let knuckles = &self.knuckles[side.index()];
        let mut rest = Direction::zeros();
        let mut posed = Direction::zeros();
        for &knuckle in knuckles {
            rest += self.source.position(knuckle) - self.source.position(wrist);
            posed += position(knuckle) - position(wrist);
        }
        smallest_rotation(&(wrist_rotation * rest), &posed).unwrap_or_else(Rotation::identity)
    }

    /// Gives the joints of a chain the rotations of another at the same part of its length.
    fn set_chain(
        &self,
        wanted: &mut [Option<Rotation>],
        source_world: &[Rotation],
        [source, target]: [&[usize]; 2],
    ) {
        let source_parts = middles(&self.source, source);
        let target_parts = middles(&self.target, target);
        for (index, (&joint, &part)) in target.iter().zip(&target_parts).enumerate() {
            let rotation = if index == 0 {
                // The first and the last one carry legs and arms: they are met exactly.
                source_world[source[0]]
            } else if index + 1 == target.len() {
                source_world[source[source.len() - 1]]
            } else {
                rotation_at(source, &source_parts, part, source_world)
            };
            wanted[joint] = Some(rotation * self.trunk_alignment);
        }
    }
}

/// The joints at the far ends of the bones of a palm, where a rig has such bones and the target has
/// none of these names, which take part in the motion themselves.
fn knuckles([skeleton, target]: [&Skeleton; 2], figure: &Figure, side: Side) -> Vec<usize> {
    let wrist = figure.joint(Role::Wrist(side));
    let joints = skeleton.joints();
    let is_palm = |joint: usize| {
        let name = &joints[joint].name;
        joints[joint].parent == wrist
            && name.to_ascii_lowercase().contains("carpal")
            && target.find(name).is_none()
    };
    let hangs_on_palm = |&joint: &usize| joints[joint].parent.is_some_and(is_palm);
    (0..joints.len()).filter(hangs_on_palm).collect()
}

/// The rotation of a chain at a part of its length.
fn rotation_at(chain: &[usize], parts: &[f64], part: f64, world: &[Rotation]) -> Rotation {
    let after = parts.iter().position(|&other| other >= part);
    match after {
        Some(0) => world[chain[0]],
        None => world[chain[chain.len() - 1]],
        Some(after) => {
            let (low, high) = (parts[after - 1], parts[after]);
            let share = if high > low {
                (part - low) / (high - low)
            } else {
                1.0
            };
            let (from, to) = (world[chain[after - 1]], world[chain[after]]);
            from.try_slerp(&to, share, 1e-9).unwrap_or(to)
        }
    }
}

/// The middle of each bone of a chain as a part of the chain's length, `[joint of the chain]`. The
/// last joint carries on to the end.
fn middles(figure: &Figure, chain: &[usize]) -> Vec<f64> {
    let mut starts = vec![0.0];
    for pair in chain.windows(2) {
        let length = (figure.position(pair[1]) - figure.position(pair[0])).norm();
        starts.push(starts[starts.len() - 1] + length);
    }
    let last = starts[starts.len() - 1];
    // The chest reaches as far above its joint as a bone of the chain does on average.
    let end = last * (1.0 + 1.0 / chain.len() as f64);
    let ends = starts.iter().skip(1).copied().chain([end]);
    let middles = starts
        .iter()
        .zip(ends)
        .map(|(start, end)| 0.5 * (start + end));
    middles
        .map(|middle| if end > 0.0 { middle / end } else { 0.0 })
        .collect()
}

/// Joints that no role names (fingers, jaw, eyes), by their names in both skeletons, with the
/// alignment of the limb that they hang on.
fn namesakes(
    [source, target]: [&Skeleton; 2],
    [source_figure, target_figure]: [&Figure; 2],
    alignments: &[(Role, Rotation)],
    trunk: Rotation,
) -> Vec<(usize, usize, Rotation)> {
    let is_known = |figure: &Figure, joint: usize| {
        let has_role = |role: &Role| figure.joint(*role) == Some(joint);
        figure.trunk().contains(&joint)
            || figure.neck().contains(&joint)
            || Role::ALL.iter().any(has_role)
    };
    let mut found = Vec::new();
    for (to, joint) in target.joints().iter().enumerate() {
        let Some(from) = source.find(&joint.name) else {
            continue;
        };
        if is_known(target_figure, to) || is_known(source_figure, from) {
            continue;
        }
        // Only what hangs on the figure: nothing above the pelvis is anybody's to turn.
        let mut parent = joint.parent;
        let limb = loop {
            let Some(above) = parent else { break None };
            if is_known(target_figure, above) {
                let role =
                    |(role, _): &&(Role, Rotation)| target_figure.joint(*role) == Some(above);
                break Some(
                    alignments
                        .iter()
                        .find(role)
                        .map_or(trunk, |(_, rotation)| *rotation),
                );
            }
            parent = target.joints()[above].parent;
        };
        found.extend(limb.map(|alignment| (from, to, alignment)));
    }
    found
}

fn alignments(
    motion: &Motion,
    source: &Figure,
    target: &Figure,
    trunk: Rotation,
) -> Vec<(Role, Rotation)> {
    let hinged = |role: Role, alignment: Rotation| {
        turn_about_bone(motion, source, target, role, &trunk, &alignment) * alignment
    };
    let aligned = |role: Role, parent: Rotation| {
        let bones = source.bone(role).zip(target.bone(role));
        let bent = bones.and_then(|(to, from)| {
            let (to, from) = (unit(&to)?, unit(&from)?);
            smallest_rotation(&(parent * from), &to)
        });
        bent.map_or(parent, |bent| bent * parent)
    };
    let mut alignments = vec![(Role::Head, trunk)];
    for side in Side::BOTH {
        let upper_arm = hinged(Role::Shoulder(side), aligned(Role::Shoulder(side), trunk));
        let forearm = aligned(Role::Elbow(side), upper_arm);
        let thigh = hinged(Role::Hip(side), aligned(Role::Hip(side), trunk));
        let shank = aligned(Role::Knee(side), thigh);
        // Feet stand flat at rest, whatever the legs do.
        let foot = aligned(Role::Ankle(side), trunk);
        alignments.extend([
            (Role::Collar(side), trunk),
            (Role::Shoulder(side), upper_arm),
            (Role::Elbow(side), forearm),
            (Role::Wrist(side), forearm),
            (Role::Hip(side), thigh),
            (Role::Knee(side), shank),
            (Role::Ankle(side), foot),
            (Role::Foot(side), foot),
        ]);
    }
    alignments
}
