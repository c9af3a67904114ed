//! Files as they were before several of them are written.

use std::path::PathBuf;

use garnet_mesh::{WriteError, write_atomically};

use super::PackageError;

/// Files that are to be written, with what they held; none of those that were not there.
#[derive(Debug)]
pub(super) struct Before(Vec<(PathBuf, Option<Vec<u8>>)>);

impl Before {
    /// Looks at all files before the first one is written.
    ///
    /// # Errors
    ///
    /// [`PackageError::Write`] if one is a folder, [`PackageError::Read`] if one cannot be read.
    pub(super) fn of(paths: impl IntoIterator<Item = PathBuf>) -> Result<Self, PackageError> {
        let mut files = Vec::new();
        for path in paths {
            match path.metadata() {
                Ok(metadata) if metadata.is_dir() => {
                    return Err(WriteError::IsFolder { path }.into());
                }
                Ok(metadata) if metadata.is_file() => {
                    let bytes = std::fs::read(&path);
                    let bytes = bytes.map_err(|source| PackageError::read(&path, source))?;
                    files.push((path, Some(bytes)));
                }
                // Pipes and devices keep nothing.
                Ok(_) => {}
                Err(_) => files.push((path, None)),
            }
        }
        Ok(Self(files))
    }

    /// Puts all files back; what fails here is less than why it is done, which is told.
    pub(super) fn restore(self) {
        for (path, bytes) in self.0 {
            let _ = match bytes {
                Some(bytes) if std::fs::read(&path).is_ok_and(|now| now == bytes) => Ok(()),
                Some(bytes) => write_atomically(&path, |writer| writer.write_all(&bytes)),
                None if path.is_file() => {
                    let removed = std::fs::remove_file(&path);
                    removed.map_err(|source| WriteError::Io { path, source })
                }
                None => Ok(()),
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn new_files_go_and_old_ones_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let [old, new] = ["old", "new"].map(|name| folder.path().join(name));
        std::fs::write(&old, "a").unwrap();
        let before = Before::of([old.clone(), new.clone()]).unwrap();
        std::fs::write(&old, "b").unwrap();
        std::fs::write(&new, "b").unwrap();
        before.restore();
        assert_eq!(std::fs::read(&old).unwrap(), b"a");
        assert!(!new.exists());
    }

    #[test]
    fn a_folder_in_place_of_a_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let error = Before::of([folder.path().to_path_buf()]).unwrap_err();
        assert!(matches!(
            error,
            PackageError::Write(WriteError::IsFolder { .. })
        ));
    }
}
