//! Files appear whole or not at all.

use std::{
    fs::{self, File, OpenOptions},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use tempfile::NamedTempFile;

/// Why an output could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The folder of the output is not there.
    #[error("cannot write `{}`: output folder `{}` does not exist", path.display(), folder.display())]
    FolderMissing {
        /// The output.
        path: PathBuf,
        /// Its folder.
        folder: PathBuf,
    },
    /// The output is a folder.
    #[error("cannot write `{}`: it is a folder", path.display())]
    IsFolder {
        /// The output.
        path: PathBuf,
    },
    /// The system refuses.
    #[error("cannot write `{}`", path.display())]
    Io {
        /// The output.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

/// Links of links that are followed, as in Linux.
const MAX_LINKS: usize = 40;

/// Writes a file through a temporary one in the same folder, which is then renamed.
///
/// An error or an interruption leaves the old file as it was. Symbolic links are followed: the
/// file they name is replaced, not the link. A new file gets the permissions that files usually
/// get, an old one keeps its own. Pipes and devices are written directly. The data may still be in
/// the system's cache on return: a power failure can lose it.
///
/// # Errors
///
/// [`WriteError`] if the folder is missing or the system refuses, or what `write` returns.
///
/// # Examples
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("greeting.txt");
/// garnet_mesh::write_atomically(&path, |writer| writer.write_all(b"hello"))?;
/// assert_eq!(std::fs::read(&path)?, b"hello");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_atomically(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), WriteError> {
    let path = path.as_ref();
    let failed = |source| WriteError::Io {
        path: path.to_path_buf(),
        source,
    };
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => Err(WriteError::IsFolder {
            path: path.to_path_buf(),
        }),
        Ok(metadata) if !metadata.is_file() => write_through(path, write).map_err(failed),
        Ok(metadata) => {
            // A file that may not be written must not be replaced either.
            OpenOptions::new().write(true).open(path).map_err(failed)?;
            let target = fs::canonicalize(path).map_err(failed)?;
            let permissions = Some(metadata.permissions());
            replace(&target, folder_of(&target), permissions, write).map_err(failed)
        }
        Err(_) => {
            let target = end_of_links(path).map_err(failed)?;
            let folder = folder_of(&target);
            if !folder.is_dir() {
                return Err(WriteError::FolderMissing {
                    path: path.to_path_buf(),
                    folder: folder.to_path_buf(),
                });
            }
            if target.file_name().is_none() {
                return Err(failed(io::ErrorKind::InvalidFilename.into()));
            }
            replace(&target, folder, None, write).map_err(failed)
        }
    }
}

fn replace(
    target: &Path,
    folder: &Path,
    permissions: Option<fs::Permissions>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let temporary = temporary_in(folder)?;
    let mut writer = BufWriter::new(temporary);
    write(&mut writer)?;
    let temporary = writer
        .into_inner()
        .map_err(io::IntoInnerError::into_error)?;
    if let Some(permissions) = permissions {
        temporary.as_file().set_permissions(permissions)?;
    }
    temporary.persist(target).map_err(|error| error.error)?;
    Ok(())
}

#[cfg(unix)]
fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    use std::os::unix::fs::PermissionsExt;
    // The process's mask applies, as for any new file.
    let permissions = fs::Permissions::from_mode(0o666);
    tempfile::Builder::new()
        .prefix(".garnet-")
        .permissions(permissions)
        .tempfile_in(folder)
}

#[cfg(not(unix))]
fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    tempfile::Builder::new()
        .prefix(".garnet-")
        .tempfile_in(folder)
}

fn write_through(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let file: File = OpenOptions::new().write(true).open(path)?;
    let mut writer = BufWriter::new(file);
    write(&mut writer)?;
    writer.flush()
}

/// The file that a chain of symbolic links names, which need not exist.
fn end_of_links(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_path_buf();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&target) {
            Ok(next) => target = folder_of(&target).join(next),
            Err(_) => return Ok(target),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shirt.obj");
        fs::write(&path, "old").unwrap();
        let result = write_atomically(&path, |writer| {
            writer.write_all(b"half")?;
            Err(io::Error::other("interrupted"))
        });
        assert!(matches!(result, Err(WriteError::Io { .. })));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing/shirt.obj");
        let error = write_atomically(&path, |_| Ok(())).unwrap_err();
        assert!(matches!(error, WriteError::FolderMissing { .. }));
        assert!(error.to_string().contains("missing` does not exist"));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link_and_its_file_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("target.obj");
        let link = folder.path().join("link.obj");
        std::os::unix::fs::symlink("target.obj", &link).unwrap();
        for text in ["new", "newer"] {
            write_atomically(&link, |writer| writer.write_all(text.as_bytes())).unwrap();
            assert_eq!(fs::read_to_string(&target).unwrap(), text);
            assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_new_file_has_usual_permissions_and_an_old_one_keeps_its_own() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let mode = |name: &str| {
            let metadata = fs::metadata(folder.path().join(name)).unwrap();
            metadata.permissions().mode()
        };
        fs::write(folder.path().join("plain"), "").unwrap();
        write_atomically(folder.path().join("new"), |_| Ok(())).unwrap();
        assert_eq!(mode("new"), mode("plain"));

        let private = fs::Permissions::from_mode(0o600);
        fs::set_permissions(folder.path().join("plain"), private).unwrap();
        write_atomically(folder.path().join("plain"), |_| Ok(())).unwrap();
        assert_eq!(mode("plain") & 0o777, 0o600);
    }
}
