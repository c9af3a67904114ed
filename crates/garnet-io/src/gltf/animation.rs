//! Motions out of glTF animations.
//!
//! A clip moves nodes. Here it is sampled at its own rate, each frame's rotations are taken from
//! the bind pose of the skin in the world, and the place of the pelvis is kept; bones keep their
//! lengths.

use std::path::Path;

use garnet_body::motion::{Figure, Motion, ReadOptions};
use garnet_skin::{Joint, Pose, Skeleton, Vector3};
use gltf::json::{
    Animation, Index, Root, Skin,
    accessor::Type,
    animation::{Interpolation, Property},
    validation::Checked,
};
use nalgebra::{
    Matrix3, Matrix4, Point3, Quaternion, Rotation3, Translation3, UnitQuaternion,
    Vector3 as NaVector3,
};

use super::{
    GltfProblem,
    accessor::{self, Fractions},
    container,
    nodes::{self, Nodes},
    skeletons::checked_joints,
};
use crate::{FileProblem, json};

/// Frames a second that clips are told to have, if the distance of their keys is near to theirs.
const RATES: [f64; 8] = [24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 100.0, 120.0];

/// The rate of clips whose keys tell none.
const USUAL_RATE: f64 = 30.0;

/// Clips of more frames are refused.
const MOST_FRAMES: f64 = 1e6;

/// Seconds by which a key may be rounded.
const ROUNDING: f64 = 1e-5;

/// How far the transforms of two joints may differ and still be one of the whole skin, relative to
/// their largest entry.
const SAME_TRANSFORM: f64 = 1e-3;

/// Reads a clip: by its name, or the first one.
pub(crate) fn read_clip(
    bytes: &[u8],
    folder: &Path,
    clip: Option<&str>,
    options: &ReadOptions,
) -> Result<Motion, FileProblem> {
    let (text, binary) = container::split(bytes)?;
    let root: Root = json::parse(text)?;
    let names: Vec<String> = clip_names(&root);
    let found = match clip {
        Some(clip) => names.iter().position(|name| name == clip),
        None => (!names.is_empty()).then_some(0),
    };
    let Some(found) = found else {
        return Err(GltfProblem::NoClip {
            wanted: clip.map(str::to_owned),
            found: names,
        }
        .into());
    };
    let buffers = container::buffers(&root, binary, folder)?;
    let tracks = Tracks::read(&root, &buffers, &root.animations[found])?;
    let rest = Rest::read(&root, &buffers)?;
    let mut motion = rest.motion(&root, &tracks, options)?;
    if names.len() > 1 && clip.is_none() {
        let shown: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        let clips = shown.join(", ");
        let note =
            format!("of the clips {clips} the first is taken: `FILE:CLIP` names another one");
        motion.notes.push(note);
    }
    Ok(motion)
}

/// What the clips are called; those without a name by their number.
fn clip_names(root: &Root) -> Vec<String> {
    let clips = root.animations.iter().enumerate();
    let names = clips.map(|(number, clip)| match &clip.name {
        Some(name) => name.clone(),
        None => format!("clip{number}"),
    });
    names.collect()
}

/// The values of one property of a node over time.
struct Track {
    node: usize,
    property: Property,
    interpolation: Interpolation,
    /// Seconds, ascending.
    times: Vec<f64>,
    /// Numbers in one value: 3 or 4.
    width: usize,
    /// One value a time; tangent, value, tangent for cubic splines.
    values: Vec<f64>,
}

struct Tracks {
    all: Vec<Track>,
    start: f64,
    end: f64,
}

impl Tracks {
    fn read(root: &Root, buffers: &[Vec<u8>], clip: &Animation) -> Result<Self, FileProblem> {
        let mut tracks = Vec::new();
        for channel in &clip.channels {
            let (property, width) = match channel.target.path {
                Checked::Valid(Property::Rotation) => (Property::Rotation, 4),
                Checked::Valid(property @ (Property::Translation | Property::Scale)) => {
                    (property, 3)
                }
                _ => continue,
            };
            let out_of_range = |part, index, count| GltfProblem::OutOfRange {
                user: "the animation".to_owned(),
                part,
                index,
                count,
            };
            let sampler = channel.sampler.value();
            let count = clip.samplers.len();
            let sampler = clip.samplers.get(sampler);
            let sampler =
                sampler.ok_or_else(|| out_of_range("sampler", channel.sampler.value(), count))?;
            let node = channel.target.node.value();
            if node >= root.nodes.len() {
                return Err(out_of_range("node", node, root.nodes.len()).into());
            }
            let wrong = |what| GltfProblem::Animation { what };
            let Checked::Valid(interpolation) = sampler.interpolation else {
                return Err(wrong("a sampler has an unknown interpolation").into());
            };
            let kind = if width == 4 { Type::Vec4 } else { Type::Vec3 };
            let read =
                |index, kind| accessor::read(root, buffers, index, kind, Fractions::AsDeclared);
            let times = read(sampler.input.value(), Type::Scalar)?.values;
            let values = read(sampler.output.value(), kind)?.values;
            let rows = times.len() * rows_of_key(interpolation);
            if times.is_empty() || values.len() != rows * width {
                return Err(wrong("a sampler has another number of values than of times").into());
            }
            let is_ascending = times.windows(2).all(|pair| pair[0] < pair[1]);
            let is_finite = times.iter().chain(&values).all(|value| value.is_finite());
            if !is_ascending || !is_finite {
                return Err(
                    wrong("the times of a sampler do not ascend, or a value is no number").into(),
                );
            }
            if property == Property::Rotation && !are_rotations(&values, interpolation) {
                return Err(
                    wrong("a key is a quaternion of length zero, which is no rotation").into(),
                );
            }
            tracks.push(Track {
                node,
                property,
                interpolation,
                times,
                width,
                values,
            });
        }
        let ends = |track: &Track| (track.times[0], track.times[track.times.len() - 1]);
        let start = tracks
            .iter()
            .map(|track| ends(track).0)
            .fold(f64::INFINITY, f64::min);
        let end = tracks
            .iter()
            .map(|track| ends(track).1)
            .fold(f64::NEG_INFINITY, f64::max);
        if tracks.is_empty() {
            return Err(GltfProblem::Animation {
                what: "the clip moves no node",
            }
            .into());
        }
        Ok(Self {
            all: tracks,
            start,
            end,
        })
    }

    /// Frames a second, by the median distance of keys.
    fn rate(&self) -> f64 {
        let pairs = self.all.iter().flat_map(|track| track.times.windows(2));
        let mut steps: Vec<f64> = pairs.map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        let Some(&step) = steps.get(steps.len() / 2) else {
            return USUAL_RATE;
        };
        let is_near = |rate: &f64| (rate * step - 1.0).abs() < 0.02;
        RATES.into_iter().find(is_near).unwrap_or(USUAL_RATE)
    }
}

impl Track {
    /// The value at a time; the first and last one hold before and after.
    fn at(&self, time: f64) -> [f64; 4] {
        let after = self.times.partition_point(|&key| key <= time + ROUNDING);
        let is_cubic = self.interpolation == Interpolation::CubicSpline;
        let each = rows_of_key(self.interpolation);
        let row = |key: usize, part: usize| {
            let start = (key * each + part) * self.width;
            let mut row = [0.0; 4];
            row[..self.width].copy_from_slice(&self.values[start..start + self.width]);
            row
        };
        let value = |key: usize| row(key, usize::from(is_cubic));
        let last = self.times.len() - 1;
        if after == 0 || after > last {
            return value(if after == 0 { 0 } else { last });
        }
        let before = after - 1;
        let span = self.times[after] - self.times[before];
        let share = ((time - self.times[before]) / span).clamp(0.0, 1.0);
        let [from, to] = [value(before), value(after)];
        match self.interpolation {
            Interpolation::Step => from,
            Interpolation::Linear if self.property == Property::Rotation => {
                let turned = rotation(from).try_slerp(&rotation(to), share, 1e-9);
                let [x, y, z, w] = turned.unwrap_or_else(|| rotation(to)).coords.into();
                [x, y, z, w]
            }
            Interpolation::Linear => mixed(from, 1.0 - share, to, share),
            Interpolation::CubicSpline => {
                let (t, t2) = (share, share * share);
                let t3 = t2 * t;
                let values = mixed(from, 2.0 * t3 - 3.0 * t2 + 1.0, to, 3.0 * t2 - 2.0 * t3);
                let [out_of, into] = [row(before, 2), row(after, 0)];
                let tangents = mixed(out_of, span * (t3 - 2.0 * t2 + t), into, span * (t3 - t2));
                mixed(values, 1.0, tangents, 1.0)
            }
        }
    }
}

fn mixed(a: [f64; 4], of_a: f64, b: [f64; 4], of_b: f64) -> [f64; 4] {
    [0, 1, 2, 3].map(|place| a[place] * of_a + b[place] * of_b)
}

/// A key of a cubic spline is a value between two tangents.
const fn rows_of_key(interpolation: Interpolation) -> usize {
    match interpolation {
        Interpolation::CubicSpline => 3,
        Interpolation::Linear | Interpolation::Step => 1,
    }
}

/// Whether all keys of a track of quaternions have a length; tangents need none.
fn are_rotations(values: &[f64], interpolation: Interpolation) -> bool {
    let every = rows_of_key(interpolation);
    let mut keys = values.chunks_exact(4).skip(every / 2).step_by(every);
    keys.all(|key| key.iter().any(|value| value.abs() > LEAST_ROTATION))
}

/// Shorter quaternions are no rotations.
const LEAST_ROTATION: f64 = 1e-9;

fn rotation([x, y, z, w]: [f64; 4]) -> UnitQuaternion<f64> {
    let quaternion = Quaternion::new(w, x, y, z);
    if quaternion.norm() > LEAST_ROTATION {
        UnitQuaternion::new_normalize(quaternion)
    } else {
        UnitQuaternion::identity()
    }
}

/// The joints of the skin, and how they stand in the bind pose.
struct Rest {
    skeleton: Skeleton,
    nodes: Vec<usize>,
    order: Vec<usize>,
    parents: Vec<Option<usize>>,
    /// Of each joint, in the world.
    rotations: Vec<UnitQuaternion<f64>>,
}

impl Rest {
    fn read(root: &Root, buffers: &[Vec<u8>]) -> Result<Self, FileProblem> {
        let hierarchy = Nodes::new(root)?;
        // The skin with the most joints is that of the body.
        let skin = root.skins.iter().max_by_key(|skin| skin.joints.len());
        let skin: &Skin = skin.ok_or(GltfProblem::NoSkin)?;
        let count = root.nodes.len();
        let nodes = checked_joints(root, skin)?;
        let shown = |node: &usize| hierarchy.world_from_node[*node];
        let bind = match skin.inverse_bind_matrices {
            Some(matrices) => {
                let index = matrices.value();
                let fractions = Fractions::AsDeclared;
                let rows = accessor::read(root, buffers, index, Type::Mat4, fractions)?;
                bind_poses(root, &hierarchy, &nodes, &rows)?
            }
            None => nodes.iter().map(shown).collect(),
        };
        let mut joint_of_node = vec![None; count];
        for (joint, &node) in nodes.iter().enumerate().rev() {
            joint_of_node[node] = Some(joint);
        }
        let joints = nodes.iter().zip(&bind).map(|(&node, bind)| Joint {
            name: nodes::name(root, node),
            parent: hierarchy.nearest_ancestor(node, |node| joint_of_node[node]),
            rest_position: bind.transform_point(&Point3::origin()).cast(),
        });
        let skeleton = Skeleton::new(joints.collect())?;
        let mut order: Vec<usize> = (0..count)
            .filter(|&node| hierarchy.parents[node].is_none())
            .collect();
        let mut next = 0;
        while let Some(&node) = order.get(next) {
            let children = root.nodes[node].children.iter().flatten();
            order.extend(children.map(Index::value));
            next += 1;
        }
        Ok(Self {
            skeleton,
            nodes,
            order,
            parents: hierarchy.parents,
            rotations: bind.iter().map(turn_of).collect(),
        })
    }

    /// The frames of a clip, in metres and y up.
    fn motion(
        self,
        root: &Root,
        tracks: &Tracks,
        options: &ReadOptions,
    ) -> Result<Motion, FileProblem> {
        let rate = tracks.rate();
        let count = ((tracks.end - tracks.start) * rate).round() + 1.0;
        if !(1.0..=MOST_FRAMES).contains(&count) {
            return Err(GltfProblem::Animation {
                what: "the clip has too many frames",
            }
            .into());
        }
        let pelvis = Figure::new(&self.skeleton, "the motion").map_or(0, |figure| figure.pelvis());
        let mut frames = Vec::with_capacity(count as usize);
        for number in 0..count as usize {
            let time = tracks.start + number as f64 / rate;
            frames.push(self.pose(&self.world(root, tracks, time.min(tracks.end)), pelvis)?);
        }
        let mut motion = Motion::in_metres(&self.skeleton, frames, options)?;
        motion.frame_time = Some(1.0 / rate);
        Ok(motion)
    }

    /// Where each node stands at a time.
    fn world(&self, root: &Root, tracks: &Tracks, time: f64) -> Vec<Matrix4<f64>> {
        let mut locals: Vec<[Option<[f64; 4]>; 3]> = vec![[None; 3]; root.nodes.len()];
        for track in &tracks.all {
            let place = match track.property {
                Property::Translation => 0,
                Property::Rotation => 1,
                _ => 2,
            };
            locals[track.node][place] = Some(track.at(time));
        }
        let mut world = vec![Matrix4::identity(); root.nodes.len()];
        for &node in &self.order {
            let local = local(&root.nodes[node], &locals[node]);
            world[node] = match self.parents[node] {
                Some(parent) => world[parent] * local,
                None => local,
            };
        }
        world
    }

    fn pose(&self, world: &[Matrix4<f64>], pelvis: usize) -> Result<Pose, FileProblem> {
        let joints = self.skeleton.joints();
        let turns: Vec<UnitQuaternion<f64>> = self
            .nodes
            .iter()
            .zip(&self.rotations)
            .map(|(&node, rest)| turn_of(&world[node]) * rest.inverse())
            .collect();
        let rotations = joints.iter().zip(&turns).map(|(joint, turn)| {
            let local = match joint.parent {
                Some(parent) => turns[parent].inverse() * turn,
                None => *turn,
            };
            UnitQuaternion::new_normalize(local.into_inner().cast::<f32>())
        });
        let mut pose = Pose {
            root_translation: Vector3::zeros(),
            rotations: rotations.collect(),
        };
        let placed = self.skeleton.transforms(&pose)?[pelvis] * joints[pelvis].rest_position;
        let wanted = world[self.nodes[pelvis]].transform_point(&Point3::origin());
        pose.root_translation = wanted.cast::<f32>() - placed;
        Ok(pose)
    }
}

/// The bind pose of each joint in the world.
fn bind_poses(
    root: &Root,
    hierarchy: &Nodes,
    nodes: &[usize],
    rows: &accessor::Rows,
) -> Result<Vec<Matrix4<f64>>, FileProblem> {
    if rows.num_rows() < nodes.len() {
        return Err(GltfProblem::Skin {
            what: "it has fewer inverse bind matrices than joints",
        }
        .into());
    }
    let mut mesh_from_bone = Vec::with_capacity(nodes.len());
    for (&node, row) in nodes.iter().zip(rows.rows()) {
        let inverse = Matrix4::from_column_slice(row).try_inverse();
        mesh_from_bone.push(inverse.ok_or_else(|| GltfProblem::SingularBindMatrix {
            joint: nodes::name(root, node),
        })?);
    }
    // What brings the skin to where the file shows it, if all joints agree; else what stands over
    // the joints, if the skin is upright by that, and nothing if not.
    let shown: Vec<Option<Matrix4<f64>>> = nodes
        .iter()
        .zip(&mesh_from_bone)
        .map(|(&node, bone)| Some(hierarchy.world_from_node[node] * bone.try_inverse()?))
        .collect();
    let first = shown
        .first()
        .copied()
        .flatten()
        .unwrap_or_else(Matrix4::identity);
    let tolerance = SAME_TRANSFORM * first.abs().max();
    let is_same = |other: &Option<Matrix4<f64>>| {
        other.is_some_and(|other| (other - first).abs().max() <= tolerance)
    };
    let world_from_mesh = if shown.iter().all(is_same) {
        first
    } else {
        let over = |node: &usize| hierarchy.parents[*node].filter(|parent| !nodes.contains(parent));
        let over = nodes.iter().find_map(over);
        let over = over.map_or_else(Matrix4::identity, |node| hierarchy.world_from_node[node]);
        let height = |by: &Matrix4<f64>| {
            let heights = mesh_from_bone
                .iter()
                .map(|bone| (by * bone).transform_point(&Point3::origin()).y);
            let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| {
                (low.min(y), high.max(y))
            });
            high - low
        };
        let scale = over.fixed_view::<3, 3>(0, 0).determinant().abs().cbrt();
        let plain = Matrix4::new_scaling(if scale > 0.0 { scale } else { 1.0 });
        if height(&over) >= height(&plain) {
            over
        } else {
            plain
        }
    };
    Ok(mesh_from_bone
        .iter()
        .map(|bone| world_from_mesh * bone)
        .collect())
}

/// The turn in a transform that may scale.
fn turn_of(transform: &Matrix4<f64>) -> UnitQuaternion<f64> {
    let mut axes: Matrix3<f64> = transform.fixed_view::<3, 3>(0, 0).into();
    if axes.determinant() < 0.0 {
        axes.column_mut(0).neg_mut();
    }
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_eps(
        &axes,
        1e-9,
        100,
        Rotation3::identity(),
    ))
}

/// The transform of a node whose translation, rotation and scale a clip may replace.
fn local(node: &gltf::json::Node, replaced: &[Option<[f64; 4]>; 3]) -> Matrix4<f64> {
    if replaced.iter().all(Option::is_none) {
        return nodes::local_transform(node);
    }
    let [translation, turned, scale] = replaced;
    let three = |given: &Option<[f64; 4]>, own: [f32; 3]| match given {
        Some([x, y, z, _]) => NaVector3::new(*x, *y, *z),
        None => NaVector3::from(own.map(f64::from)),
    };
    let translation = three(translation, node.translation.unwrap_or_default());
    let scale = three(scale, node.scale.unwrap_or([1.0; 3]));
    let own = node.rotation.unwrap_or_default().0.map(f64::from);
    let turned = rotation(turned.unwrap_or(own));
    Translation3::from(translation).to_homogeneous()
        * turned.to_homogeneous()
        * Matrix4::new_nonuniform_scaling(&scale)
}
