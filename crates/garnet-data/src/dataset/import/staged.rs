//! Shards that come to their places when all are written.

use std::{
    fs,
    path::{Path, PathBuf},
};

use garnet_mesh::Fingerprint;

use super::{DatasetManifest, Layout, Shard};
use crate::DataError;
use crate::dataset::{lock::Lock, shard::shard_name};

/// Shards beside a data set; they are removed if the value is dropped before they are published.
pub(super) struct Staged {
    layout: Layout,
    /// Where each shard is, and where it belongs.
    moves: Vec<(PathBuf, PathBuf)>,
    is_folder_new: bool,
    /// Given back before the folder is removed.
    lock: Option<Lock>,
}

impl Staged {
    /// Takes the folder of a data set, unless it holds another one.
    pub(super) fn new(layout: Layout, dataset: &DatasetManifest) -> Result<Self, DataError> {
        check_folder(&layout, dataset)?;
        let is_folder_new = !layout.folder.exists();
        let lock = Lock::of_part(&layout, (0, 1))?;
        Ok(Self {
            layout,
            moves: Vec::new(),
            is_folder_new,
            lock: Some(lock),
        })
    }

    pub(super) fn write(
        &mut self,
        shard: &Shard,
        number: u32,
        dataset: Fingerprint,
    ) -> Result<(), DataError> {
        let name = shard_name(shard.split, number);
        let place = self.layout.pieces().join(name);
        let target = self.layout.shard(shard.split, number);
        self.moves.push((place.clone(), target));
        shard.write(&place, dataset)
    }

    /// Puts the shards into their places, and the manifest beside them.
    pub(super) fn publish(mut self, dataset: &DatasetManifest) -> Result<(), DataError> {
        let shards = self.layout.shards();
        fs::create_dir_all(&shards).map_err(|source| DataError::folder(&shards, source))?;
        for (place, target) in std::mem::take(&mut self.moves) {
            fs::rename(&place, &target).map_err(|source| DataError::folder(&target, source))?;
        }
        self.is_folder_new = false;
        dataset.write(&self.layout.manifest())
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        // Nobody can be told that a file stays: the next import writes over it.
        for (place, _) in &self.moves {
            let _ = fs::remove_file(place);
        }
        self.lock = None;
        if self.is_folder_new {
            let _ = fs::remove_dir(&self.layout.folder);
        }
    }
}

/// Refuses a folder with another data set, or with shards of one.
fn check_folder(layout: &Layout, dataset: &DatasetManifest) -> Result<(), DataError> {
    let path = layout.manifest();
    if path.exists() {
        DatasetManifest::read(&path)?.check_same(dataset, &path)?;
    }
    if !layout.shards().is_dir() {
        return Ok(());
    }
    layout.found()?.iter().try_for_each(|path| {
        let read = Shard::read_named(path, dataset.fingerprint(), dataset.bodies_per_shard);
        match read {
            // What is damaged is written anew if it is one of those that are imported.
            Err(DataError::Tensors { .. }) if is_among(path, dataset) => Ok(()),
            read => read.map(|_| ()),
        }
    })
}

/// Whether a data set has a shard of this name.
fn is_among(path: &Path, dataset: &DatasetManifest) -> bool {
    use crate::Split;
    Split::ALL.into_iter().any(|split| {
        let shards = dataset.bodies.of(split).div_ceil(dataset.bodies_per_shard);
        let mut names = (0..shards).map(|number| shard_name(split, number));
        names.any(|name| path.file_name().is_some_and(|found| found == name.as_str()))
    })
}
