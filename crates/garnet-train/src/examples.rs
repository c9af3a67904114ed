//! The scenes of a split in memory.

use garnet_data::Split;

use crate::subject::{Example, Subject};
use crate::{Stage, TrainError, TrainEvent};

/// Reads and warps all scenes of a split.
pub(crate) fn examples(
    stage: &Stage,
    subject: &Subject,
    split: Split,
    observer: &mut dyn FnMut(TrainEvent),
) -> Result<Vec<Example>, TrainError> {
    let total = stage.num_scenes(split)?;
    let mut examples = Vec::with_capacity(total);
    stage.for_each(split, |staged| subject.example(&staged), &mut |example| {
        examples.push(example);
        let done = examples.len();
        observer(TrainEvent::Read { split, done, total });
    })?;
    Ok(examples)
}
