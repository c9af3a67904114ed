//! Weights of morph targets over time: the shapes that an animation gives to meshes.

use garnet_mesh::Point3;
use gltf::json::{
    Root,
    accessor::Type,
    animation::{Interpolation, Property},
    validation::Checked,
};

use super::{GltfProblem, rig::Reader};
use crate::FileProblem;

/// Points of all frames together that are read at most. More reads longer animations, and takes
/// more memory: twelve bytes each.
pub(super) const MOST_POINTS: usize = 1 << 26;

/// Frames of a mesh that an animation of its file moves.
#[derive(Debug)]
#[non_exhaustive]
pub struct MeshFrames {
    /// Positions `[frame][vertex]`, those of the first frame among them.
    pub positions: Vec<Vec<Point3>>,
    /// Frames a second, if there are several; of keys at unequal times, in the mean.
    pub fps: Option<f64>,
    /// Names of the nodes whose meshes change their shapes in these frames.
    pub nodes: Vec<String>,
}

/// Whether an animation changes the shape of the mesh of a node.
pub(super) fn changes_shape(root: &Root, node: usize) -> bool {
    let channels = root.animations.iter().flat_map(|clip| &clip.channels);
    let mut targets = channels.map(|channel| &channel.target);
    targets.any(|target| {
        let is_shape = matches!(target.path, Checked::Valid(Property::MorphTargetWeights));
        is_shape && target.node.value() == node
    })
}

/// The weights of the targets of one node.
struct Track {
    node: usize,
    /// Seconds, ascending.
    times: Vec<f64>,
    /// `[key][target]`.
    weights: Vec<Vec<f32>>,
    is_step: bool,
}

/// The weights of the first clip that changes shapes.
pub(super) struct Shapes {
    tracks: Vec<Track>,
    /// All times of keys, ascending.
    times: Vec<f64>,
}

/// Keys that are nearer than this are one frame, in seconds.
const SAME_TIME: f64 = 1e-5;

impl Shapes {
    /// Reads the clip; none if no clip changes a shape.
    pub(super) fn read(file: &Reader<'_>) -> Result<Option<Self>, FileProblem> {
        for clip in &file.root.animations {
            let mut tracks: Vec<Track> = Vec::new();
            for channel in &clip.channels {
                if !matches!(
                    channel.target.path,
                    Checked::Valid(Property::MorphTargetWeights)
                ) {
                    continue;
                }
                let index = channel.sampler.value();
                let sampler = clip.samplers.get(index);
                let sampler = sampler.ok_or_else(|| GltfProblem::OutOfRange {
                    user: "the animation".to_owned(),
                    part: "sampler",
                    index,
                    count: clip.samplers.len(),
                })?;
                let keys = [sampler.input.value(), sampler.output.value()];
                let track = track(
                    file,
                    channel.target.node.value(),
                    keys,
                    sampler.interpolation,
                );
                tracks.push(track?);
            }
            if !tracks.is_empty() {
                let keys = tracks.iter().flat_map(|track| &track.times);
                let mut times: Vec<f64> = keys.copied().collect();
                times.sort_by(f64::total_cmp);
                times.dedup_by(|b, a| *b - *a < SAME_TIME);
                return Ok(Some(Self { tracks, times }));
            }
        }
        Ok(None)
    }

    /// When the frames are, in seconds: at the keys of all meshes that move.
    pub(super) fn times(&self) -> &[f64] {
        &self.times
    }

    /// The nodes whose meshes change their shapes.
    pub(super) fn nodes(&self) -> impl Iterator<Item = usize> + '_ {
        self.tracks.iter().map(|track| track.node)
    }

    pub(super) fn fps(&self) -> Option<f64> {
        let times = self.times();
        let span = times[times.len() - 1] - times[0];
        (span > 0.0).then(|| ((times.len() - 1) as f64 / span).clamp(1e-3, 1e3))
    }

    /// The weights of the targets of a node at a time; none if its shape does not change.
    pub(super) fn weights(&self, node: usize, time: f64) -> Option<Vec<f32>> {
        let track = self.tracks.iter().find(|track| track.node == node)?;
        let last = track.times.len() - 1;
        let after = track.times.partition_point(|&key| key <= time + SAME_TIME);
        let before = after.saturating_sub(1).min(last);
        let from = &track.weights[before];
        if track.is_step || after == 0 || after > last || track.times[before] >= time {
            return Some(from.clone());
        }
        let span = track.times[after] - track.times[before];
        let share = ((time - track.times[before]) / span) as f32;
        let pairs = from.iter().zip(&track.weights[after]);
        Some(pairs.map(|(a, b)| a + share * (b - a)).collect())
    }
}

fn track(
    file: &Reader<'_>,
    node: usize,
    [input, output]: [usize; 2],
    interpolation: Checked<Interpolation>,
) -> Result<Track, FileProblem> {
    let wrong = |what| GltfProblem::Animation { what };
    let Checked::Valid(interpolation) = interpolation else {
        return Err(wrong("a sampler has an unknown interpolation").into());
    };
    let times = file.read(input, Type::Scalar)?.values;
    let values = file.read(output, Type::Scalar)?.values;
    let each = match interpolation {
        // A key is a value between two tangents.
        Interpolation::CubicSpline => 3,
        Interpolation::Linear | Interpolation::Step => 1,
    };
    if times.is_empty() || !values.len().is_multiple_of(each * times.len()) {
        return Err(wrong("a sampler has another number of values than of times").into());
    }
    let is_finite = times.iter().chain(&values).all(|value| value.is_finite());
    if !is_finite || !times.is_sorted_by(|a, b| a < b) {
        return Err(wrong("the times of a sampler do not ascend, or a value is no number").into());
    }
    let width = values.len() / (each * times.len());
    let key = |key: usize| {
        let start = (each * key + each / 2) * width;
        let weights = values[start..start + width].iter();
        weights.map(|&weight| weight as f32).collect()
    };
    Ok(Track {
        node,
        weights: (0..times.len()).map(key).collect(),
        times,
        is_step: interpolation == Interpolation::Step,
    })
}
