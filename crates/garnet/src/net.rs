//! Networks that predict where cloth is, and their files.

pub use garnet_drape::{Network, Predicted, Unfamiliar};
pub use garnet_net::{CheckpointError, CheckpointHeader, ModelFile, NetError, ReferenceCase};
