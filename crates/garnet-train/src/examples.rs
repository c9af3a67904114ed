//! The scenes of a split in memory.

use garnet_data::{Protocol, Split};

use crate::context::{Example, TrainingContext};
use crate::pose_space::{self, Beginning};
use crate::{Stage, TrainError, TrainEvent};

/// Reads and warps all scenes of a split, and moves them by the pose-space deformation that a
/// network starts from, if it starts from one.
pub(crate) fn examples(
    stage: &Stage,
    context: &TrainingContext,
    split: Split,
    start: Option<&Beginning>,
    observer: &mut dyn FnMut(TrainEvent),
) -> Result<Vec<Example>, TrainError> {
    let total = stage.num_scenes(split)?;
    let mut examples = Vec::with_capacity(total);
    // Where all bodies are in the same poses, no sequence is new to the test: none is left out.
    let is_sequence_new = stage.dataset.manifest.protocol == Protocol::UnseenSequences;
    stage.for_each(
        split,
        |staged| context.example(&staged),
        &mut |mut example: Example| {
            if !is_sequence_new {
                example.sequence.clear();
            }
            examples.push(example);
            let done = examples.len();
            observer(TrainEvent::Read { split, done, total });
            Ok(())
        },
    )?;
    if let Some(beginning) = start {
        pose_space::start(beginning, stage, split, &mut examples)?;
    }
    Ok(examples)
}
