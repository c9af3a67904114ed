//! What a fit keeps of a scene.

use garnet_net::pose_space::Cut;

use super::super::offsets::offsets_of;
use crate::context::Example;

/// What a fit keeps of a scene.
#[derive(Debug, Clone)]
pub(in crate::pose_space) struct Sample {
    /// The number of its data set, and of its body there.
    pub(in crate::pose_space) body: (usize, u32),
    /// The sequence of its pose.
    pub(in crate::pose_space) sequence: String,
    /// Pose and shape.
    pub(in crate::pose_space) parameters: Vec<f32>,
    /// Of its garment.
    pub(in crate::pose_space) cut: Cut,
    /// From the warp, in the skinning frames `[vertex][3]`, in metres.
    pub(in crate::pose_space) offsets: Vec<f32>,
}

/// What a fit keeps of the scenes of a data set.
pub(in crate::pose_space) fn samples_of(set: usize, examples: &[Example]) -> Vec<Sample> {
    let samples = examples.iter().map(|example| Sample {
        body: (set, example.scene.body),
        sequence: example.sequence.clone(),
        parameters: example.parameters.clone(),
        cut: *example.graph.cut(),
        offsets: offsets_of(example),
    });
    samples.collect()
}
