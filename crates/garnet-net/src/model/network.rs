//! Models that are networks.

use std::path::Path;

use burn::tensor::Device;
use garnet_mesh::Point3;
use garnet_sim::Moment;

use super::{Model, beside, fitting};
pub(super) use crate::Predictor as Network;
use crate::{
    BodySampling, Checkpoint, CheckpointError, GarNetConfig, GarmentGraph, NetError, PoseSpace,
    Predictor,
};

/// Whether this build runs networks: it does.
#[allow(clippy::unnecessary_wraps, reason = "other builds do not")]
pub(super) fn check(_path: &Path) -> Result<(), CheckpointError> {
    Ok(())
}

/// Binds the bytes of the file `path`.
pub(super) fn bound(
    path: &Path,
    bytes: Vec<u8>,
    garment: GarmentGraph,
    template: &[Point3],
    rest_body: &[Point3],
) -> Result<Model, CheckpointError> {
    let checkpoint = Checkpoint::from_bytes(path, bytes, &Device::flex())?;
    let start = checkpoint.model.config().start.deformation();
    let start = start.map(|moment| start_of(path, moment, &checkpoint, &garment));
    let pose_space = start.transpose()?;
    let network = Predictor::of_checkpoint(path, checkpoint, garment, template, rest_body)?;
    Ok(Model {
        pose_space,
        ..Model::from(network)
    })
}

impl From<Predictor> for Model {
    fn from(network: Predictor) -> Self {
        Self {
            range: network.range().cloned(),
            pose_space: None,
            cut: *network.garment().cut(),
            network: Some(network),
        }
    }
}

impl Model {
    /// A network with random weights from a seed; see [`Predictor::untrained`].
    ///
    /// # Errors
    ///
    /// As there.
    pub fn untrained(
        config: &GarNetConfig,
        seed: u64,
        garment: GarmentGraph,
        sampling: BodySampling,
    ) -> Result<Self, NetError> {
        Ok(Predictor::untrained(config, seed, garment, sampling)?.into())
    }
}

/// The pose-space deformation that a network starts from.
fn start_of(
    path: &Path,
    moment: Moment,
    checkpoint: &Checkpoint,
    garment: &GarmentGraph,
) -> Result<PoseSpace, CheckpointError> {
    let start = beside(path, moment);
    let space = fitting(&start, PoseSpace::load(&start)?, garment)?;
    let expected = checkpoint.pose_space.as_deref().unwrap_or("none");
    if space.checksum() == expected {
        return Ok(space);
    }
    Err(CheckpointError::OtherStart {
        path: path.to_path_buf(),
        start,
        expected: expected.to_owned(),
        found: space.checksum().to_owned(),
    })
}
