//! Shards that come to their places when all are written.

use std::{
    fs,
    path::{Path, PathBuf},
};

use garnet_mesh::Fingerprint;

use super::{DatasetManifest, Layout, Shard};
use crate::DataError;
use crate::dataset::{lock::Lock, shard::shard_name};

/// Shards beside a data set. If the value is dropped before all are published they are removed, and
/// those whose places they took come back.
pub(super) struct Staged {
    layout: Layout,
    /// Where each shard is, and where it belongs.
    moves: Vec<(PathBuf, PathBuf)>,
    /// Places that are taken while the manifest is not yet written, and where what was there is
    /// now.
    taken: Vec<(PathBuf, Option<PathBuf>)>,
    /// Folders that were not there, inner ones first.
    new_folders: Vec<PathBuf>,
    /// Given back before the folders are removed.
    lock: Option<Lock>,
}

impl Staged {
    /// Takes the folder of a data set, unless it holds another one.
    pub(super) fn new(layout: Layout, dataset: &DatasetManifest) -> Result<Self, DataError> {
        check_folder(&layout, dataset)?;
        let mut new_folders = vec![layout.shards(), layout.folder.clone()];
        new_folders.retain(|folder| !folder.exists());
        let lock = Lock::of_part(&layout, (0, 1))?;
        Ok(Self {
            layout,
            moves: Vec::new(),
            taken: Vec::new(),
            new_folders,
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
    ///
    /// # Errors
    ///
    /// [`DataError::Folder`] or [`DataError::Write`]: all shards and the manifest are then as they
    /// were, or, where the system refuses that, too, what was in the place of a shard is in
    /// `unfinished`.
    pub(super) fn publish(mut self, dataset: &DatasetManifest) -> Result<(), DataError> {
        let shards = self.layout.shards();
        fs::create_dir_all(&shards).map_err(|source| DataError::folder(&shards, source))?;
        for (place, target) in &self.moves {
            let failed = |source| DataError::folder(target, source);
            let mut before = None;
            if target.is_file() {
                fs::rename(target, aside(place)).map_err(failed)?;
                before = Some(aside(place));
            }
            // Told first: what was there comes back even if the new one does not come.
            self.taken.push((target.clone(), before));
            fs::rename(place, target).map_err(failed)?;
        }
        dataset.write(&self.layout.manifest())?;
        self.taken.clear();
        self.new_folders.clear();
        for (place, _) in &self.moves {
            // Also what a killed import has left; nobody can be told that one stays.
            let _ = fs::remove_file(aside(place));
        }
        Ok(())
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        // Nobody can be told what fails here: it is less than why it is done.
        for (target, before) in &self.taken {
            let _ = match before {
                Some(before) => fs::rename(before, target),
                None => fs::remove_file(target),
            };
        }
        // Those that are in their places are no longer here; the next import writes over one that
        // stays.
        for (place, _) in &self.moves {
            let _ = fs::remove_file(place);
        }
        self.lock = None;
        for folder in &self.new_folders {
            let _ = fs::remove_dir(folder);
        }
    }
}

/// Where the shard is meanwhile whose place is taken by that at `place`.
fn aside(place: &Path) -> PathBuf {
    place.with_extension("before")
}

/// Refuses a folder whose manifest is that of another data set, of whatever scenes `dataset` is
/// made.
pub(super) fn check_manifest(layout: &Layout, dataset: &DatasetManifest) -> Result<(), DataError> {
    let path = layout.manifest();
    if !path.exists() {
        return Ok(());
    }
    let found = DatasetManifest::read(&path)?;
    let asked = DatasetManifest {
        imported: found.imported.clone(),
        ..dataset.clone()
    };
    found.check_same(&asked, &path)
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
            Err(DataError::Tensors { .. } | DataError::Altered { .. })
                if is_among(path, dataset) =>
            {
                Ok(())
            }
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

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::{Limits, Split};

    fn dataset() -> DatasetManifest {
        let manifest = json!({
            "schema": crate::DATASET_SCHEMA,
            "generator": "0",
            "garment": {
                "schema": "garnet.garment/1", "name": "shirt", "fingerprint": "", "positions": "",
                "fabric": {
                    "name": "jersey", "density": 0.2, "membrane": 100.0, "bending": 1e-5,
                    "friction": 0.3, "thickness": 0.002
                },
                "rest_body": {"rig": "body.rig.npz"}
            },
            "seed": 0,
            "bodies": {"train": 1, "valid": 0, "test": 1},
            "poses": 1,
            "quality": null,
            "sizing": "one-size",
            "limits": Limits::default(),
            "bodies_per_shard": 10
        });
        serde_json::from_value(manifest).unwrap()
    }

    #[test]
    fn what_was_imported_tells_data_sets_apart_and_older_ones_keep_their_text() {
        let older = dataset();
        let text = serde_json::to_string(&older).unwrap();
        assert!(!text.contains("imported"), "{text}");
        let imported = DatasetManifest {
            imported: Some("cbf29ce484222325".to_owned()),
            ..dataset()
        };
        assert_ne!(older.fingerprint(), imported.fingerprint());
        let error = older.check_same(&imported, Path::new("dataset.json"));
        let error = error.unwrap_err().to_string();
        assert!(
            error.contains("imported content that was not told"),
            "{error}"
        );
    }

    #[test]
    fn imported_and_simulated_scenes_are_told_apart_before_their_seeds() {
        let simulated = DatasetManifest {
            seed: 5,
            quality: Some("fast".to_owned()),
            ..dataset()
        };
        let error = simulated.check_same(&dataset(), Path::new("dataset.json"));
        let error = error.unwrap_err().to_string();
        assert_eq!(
            error,
            "`dataset.json` holds a data set with scenes of the kind `simulated`, asked for is `imported`"
        );
    }

    /// Shards of both splits beside a data set in a folder.
    fn staged(folder: &Path) -> Staged {
        let layout = Layout {
            folder: folder.to_path_buf(),
        };
        let dataset = dataset();
        let mut staged = Staged::new(layout, &dataset).unwrap();
        for split in [Split::Train, Split::Test] {
            let shard = Shard::new(split);
            staged.write(&shard, 0, dataset.fingerprint()).unwrap();
        }
        staged
    }

    #[test]
    fn shards_whose_manifest_cannot_be_written_go_again() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("out");
        let staged = staged(&folder);
        fs::create_dir(folder.join("dataset.json")).unwrap();
        staged.publish(&dataset()).unwrap_err();
        fs::remove_dir(folder.join("dataset.json")).unwrap();
        // Nothing else is in it.
        fs::remove_dir(&folder).unwrap();
    }

    #[test]
    fn shards_that_others_took_the_place_of_come_back() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("out");
        staged(&folder).publish(&dataset()).unwrap();
        let train = folder.join("shards/train_0000.safetensors");
        // Damaged, so that it is written anew.
        fs::write(&train, "damaged").unwrap();
        let again = staged(&folder);
        let test = folder.join("shards/test_0000.safetensors");
        fs::remove_file(&test).unwrap();
        fs::create_dir_all(test.join("in the way")).unwrap();
        let error = again.publish(&dataset()).unwrap_err();
        assert!(matches!(error, DataError::Folder { .. }), "{error}");
        assert_eq!(fs::read(&train).unwrap(), b"damaged");
        assert!(!folder.join("unfinished").exists());

        fs::remove_dir_all(&test).unwrap();
        staged(&folder).publish(&dataset()).unwrap();
        assert_ne!(fs::read(&train).unwrap(), b"damaged");
        assert!(test.is_file() && !folder.join("unfinished").exists());
    }
}
