//! One run at a time makes a shard.

use std::{fs, path::PathBuf};

use garnet_drape::{Attempt, FileLock};
use garnet_mesh::remove_stale_temporaries;

use super::shard::Layout;
use crate::DataError;

/// How often the folder is made anew, because the run before has just removed it.
const TRIES: u32 = 100;

/// A part of a data set that this run alone writes, until the value is dropped.
///
/// Each part has a file that its run keeps locked; the system unlocks it when the process ends, in
/// whatever way. Parts of other numbers that share shards exclude each other, too.
#[derive(Debug)]
pub(super) struct Lock {
    /// None once it is given back.
    file: Option<FileLock>,
    folder: PathBuf,
}

impl Lock {
    /// Takes a part of a data set, and makes the folder for its scenes.
    ///
    /// # Errors
    ///
    /// [`DataError::InUse`] while another run writes some of its shards; [`DataError::Folder`].
    pub(super) fn of_part(layout: &Layout, part: (u32, u32)) -> Result<Self, DataError> {
        let folder = layout.pieces();
        let path = folder.join(name(part));
        for _ in 0..TRIES {
            fs::create_dir_all(&folder).map_err(|source| DataError::folder(&folder, source))?;
            let file = match FileLock::attempt(&path)? {
                Attempt::Taken(file) => file,
                Attempt::Held(process) => return Err(in_use(layout, process)),
                Attempt::Gone => continue,
            };
            let lock = Self {
                file: Some(file),
                folder,
            };
            lock.check_others(layout, part)?;
            for folder in [&layout.folder, &layout.shards(), &lock.folder] {
                remove_stale_temporaries(folder);
            }
            return Ok(lock);
        }
        Err(in_use(layout, None))
    }

    /// Refuses a part that shares shards with one that is being made, and removes what killed runs
    /// have left.
    fn check_others(&self, layout: &Layout, part: (u32, u32)) -> Result<(), DataError> {
        let failed = |source| DataError::read(&self.folder, source);
        let own = self.file.as_ref().map(FileLock::path);
        for entry in fs::read_dir(&self.folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            let other = path.file_name().and_then(|name| part_of(name.to_str()?));
            let is_other = own != Some(path.as_path());
            if is_other && other.is_some_and(|other| share_shards(part, other)) {
                FileLock::check(&path, &layout.folder)?;
            }
        }
        Ok(())
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        self.file = None;
        // Nobody can be told; a folder that still has scenes in it stays.
        let _ = fs::remove_dir(&self.folder);
    }
}

fn in_use(layout: &Layout, process: Option<u32>) -> DataError {
    DataError::InUse {
        folder: layout.folder.clone(),
        process,
    }
}

fn name((part, num_parts): (u32, u32)) -> String {
    format!("part_{}_of_{num_parts}.lock", part + 1)
}

/// The part that a file is the lock of.
fn part_of(name: &str) -> Option<(u32, u32)> {
    let name = name.strip_prefix("part_")?.strip_suffix(".lock")?;
    let (part, num_parts) = name.split_once("_of_")?;
    let part: u32 = part.parse().ok()?;
    Some((part.checked_sub(1)?, num_parts.parse().ok()?))
}

/// Whether a shard may be in both parts: those of a part are its number and the number of parts
/// apart.
fn share_shards((a, num_a): (u32, u32), (b, num_b): (u32, u32)) -> bool {
    let (mut divisor, mut rest) = (num_a, num_b);
    while rest != 0 {
        (divisor, rest) = (rest, divisor % rest);
    }
    divisor != 0 && a.abs_diff(b) % divisor == 0
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn layout(folder: &Path) -> Layout {
        Layout {
            folder: folder.to_path_buf(),
        }
    }

    #[test]
    fn parts_share_shards_if_one_number_is_in_both() {
        for num_a in 1..7 {
            for num_b in 1..7 {
                for (a, b) in (0..num_a).flat_map(|a| (0..num_b).map(move |b| (a, b))) {
                    let both = (0..num_a * num_b).any(|i| i % num_a == a && i % num_b == b);
                    assert_eq!(share_shards((a, num_a), (b, num_b)), both);
                }
            }
        }
    }

    #[test]
    fn a_part_is_taken_once_and_given_back() {
        let folder = tempfile::tempdir().unwrap();
        let layout = layout(folder.path());
        let first = Lock::of_part(&layout, (0, 2)).unwrap();
        let other = Lock::of_part(&layout, (1, 2)).unwrap();
        for part in [(0, 2), (0, 1), (2, 4)] {
            let error = Lock::of_part(&layout, part).unwrap_err();
            let this = std::process::id();
            assert!(
                matches!(error, DataError::InUse { process, .. } if process == Some(this)),
                "{error}"
            );
        }
        drop(first);
        assert!(layout.pieces().exists());
        drop(Lock::of_part(&layout, (2, 4)).unwrap());
        drop(other);
        assert!(!layout.pieces().exists());
    }

    #[test]
    fn what_a_killed_run_has_left_does_not_hold_others_up() {
        let folder = tempfile::tempdir().unwrap();
        let layout = layout(folder.path());
        fs::create_dir(layout.pieces()).unwrap();
        for part in [(0, 1), (1, 2)] {
            fs::write(layout.pieces().join(name(part)), "1").unwrap();
        }
        drop(Lock::of_part(&layout, (0, 1)).unwrap());
        assert!(!layout.pieces().exists());
    }
}
