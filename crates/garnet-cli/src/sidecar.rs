//! The rig that lies beside a body.

use std::path::{Path, PathBuf};

/// `folder/body.rig.npz` of `folder/body.obj`.
pub(crate) fn rig_beside(body: &Path) -> PathBuf {
    body.with_extension("rig.npz")
}
