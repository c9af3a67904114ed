//! What drapes of a data set need that are made outside of it: bodies as targets, and what weights
//! say.

use std::path::Path;

use garnet_data::Split;
use garnet_net::ModelHeader;
use garnet_skin::PosedBody;

use crate::{SceneName, Stage, TrainError};

/// Reads what a weight file says about itself.
///
/// # Errors
///
/// [`TrainError::Checkpoint`].
pub fn header_of(weights: &Path) -> Result<ModelHeader, TrainError> {
    Ok(ModelHeader::read(weights)?)
}

/// The bodies of scenes, as targets of the garment of the package.
///
/// # Errors
///
/// Those of the data set.
pub fn targets(
    stage: &Stage,
    split: Split,
    scenes: &[SceneName],
) -> Result<Vec<PosedBody>, TrainError> {
    let mut bodies = Vec::new();
    let keep = |name| scenes.contains(&name);
    stage.for_each_of(split, keep, Ok, &mut |staged| {
        let places = staged.posed.skin().positions();
        bodies.push(stage.package.body.fitted(places)?);
        Ok(())
    })?;
    Ok(bodies)
}
