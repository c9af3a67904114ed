//! Files appear whole or not at all.

use std::{
    collections::BTreeSet,
    ffi::OsStr,
    fs::{self, DirEntry, File, OpenOptions},
    io::{self, BufWriter, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
    sync::Mutex,
    time::Duration,
};

use tempfile::NamedTempFile;

/// Why an output could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The folder of the output is not there.
    #[error("cannot write `{}`: output folder `{}` {}", path.display(), folder.display(), missing(folder))]
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

/// How a folder is not there.
fn missing(folder: &Path) -> &'static str {
    if folder.exists() {
        "is a file"
    } else {
        "does not exist"
    }
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
    StagedFile::new(path, write)?.put()
}

/// A file that is written, but not in its place yet: it lies under a temporary name beside it.
///
/// If the value is dropped the temporary file goes, and its place is as it was. With several of
/// them all that takes time, and most that can fail, is done before the first one is in its place.
#[derive(Debug)]
pub struct StagedFile {
    /// As it was named.
    path: PathBuf,
    /// The temporary file and its place; none for pipes and devices, which are written at once.
    staged: Option<(NamedTempFile, PathBuf)>,
}

impl StagedFile {
    /// Writes a file beside its place, as [`write_atomically`] does.
    ///
    /// # Errors
    ///
    /// [`WriteError`] if the folder is missing or the system refuses, or what `write` returns.
    pub fn new(
        path: impl AsRef<Path>,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<Self, WriteError> {
        let mut file = OpenFile::create(path)?;
        match write(&mut file) {
            Ok(()) => file.close(),
            Err(source) => Err(file.failed(source)),
        }
    }

    /// Puts the file into its place, instead of the one that is there.
    ///
    /// # Errors
    ///
    /// [`WriteError::Io`] if the system refuses; the place is then as it was.
    pub fn put(self) -> Result<(), WriteError> {
        let Self { path, staged } = self;
        let Some((temporary, target)) = staged else {
            return Ok(());
        };
        match temporary.persist(target) {
            Ok(_) => Ok(()),
            Err(error) => Err(WriteError::Io {
                path,
                source: error.error,
            }),
        }
    }
}

/// A file that is being written, piece by piece, under a temporary name beside its place.
///
/// If the value is dropped the temporary file goes, and its place is as it was.
///
/// # Examples
///
/// ```
/// use std::io::Write;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("frames.bin");
/// let mut file = garnet_mesh::OpenFile::create(&path)?;
/// file.write_all(b"one")?;
/// file.write_all(b"two")?;
/// assert!(!path.exists());
/// file.close()?.put()?;
/// assert_eq!(std::fs::read(&path)?, b"onetwo");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct OpenFile {
    /// As it was named.
    path: PathBuf,
    writer: Open,
}

/// Where the bytes go.
#[derive(Debug)]
enum Open {
    /// Into a temporary file, for its place, with the permissions of the one that is there.
    Temporary(BufWriter<NamedTempFile>, PathBuf, Option<fs::Permissions>),
    /// Into a pipe or device.
    Through(BufWriter<File>),
}

impl OpenFile {
    /// Begins a file under a temporary name beside its place.
    ///
    /// # Errors
    ///
    /// [`WriteError`] if the folder is missing or the system refuses.
    pub fn create(path: impl AsRef<Path>) -> Result<Self, WriteError> {
        let path = path.as_ref();
        let failed = |source| WriteError::Io {
            path: path.to_path_buf(),
            source,
        };
        let (target, permissions) = match fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => {
                return Err(WriteError::IsFolder {
                    path: path.to_path_buf(),
                });
            }
            Ok(metadata) if !metadata.is_file() => {
                let file = OpenOptions::new().write(true).open(path).map_err(failed)?;
                return Ok(Self {
                    path: path.to_path_buf(),
                    writer: Open::Through(BufWriter::new(file)),
                });
            }
            Ok(metadata) => {
                // A file that may not be written must not be replaced either.
                OpenOptions::new().write(true).open(path).map_err(failed)?;
                let target = fs::canonicalize(path).map_err(failed)?;
                (target, Some(metadata.permissions()))
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
                (target, None)
            }
        };
        sweep_once(folder_of(&target));
        let temporary = temporary_in(folder_of(&target)).map_err(failed)?;
        Ok(Self {
            path: path.to_path_buf(),
            writer: Open::Temporary(BufWriter::new(temporary), target, permissions),
        })
    }

    /// The path, as it was named.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The error that the system refused to write it.
    pub fn failed(&self, source: io::Error) -> WriteError {
        WriteError::Io {
            path: self.path.clone(),
            source,
        }
    }

    /// The file is written: it is still to be [put](StagedFile::put) into its place.
    ///
    /// # Errors
    ///
    /// [`WriteError::Io`] if the system refuses.
    pub fn close(self) -> Result<StagedFile, WriteError> {
        let Self { path, writer } = self;
        match closed(writer) {
            Ok(staged) => Ok(StagedFile { path, staged }),
            Err(source) => Err(WriteError::Io { path, source }),
        }
    }
}

fn closed(writer: Open) -> io::Result<Option<(NamedTempFile, PathBuf)>> {
    match writer {
        Open::Temporary(writer, target, permissions) => {
            let temporary = writer
                .into_inner()
                .map_err(io::IntoInnerError::into_error)?;
            if let Some(permissions) = permissions {
                temporary.as_file().set_permissions(permissions)?;
            }
            Ok(Some((temporary, target)))
        }
        Open::Through(mut writer) => {
            writer.flush()?;
            Ok(None)
        }
    }
}

impl Write for OpenFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.writer {
            Open::Temporary(writer, ..) => writer.write(bytes),
            Open::Through(writer) => writer.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.writer {
            Open::Temporary(writer, ..) => writer.flush(),
            Open::Through(writer) => writer.flush(),
        }
    }
}

/// Pipes and devices cannot be sought in.
impl Seek for OpenFile {
    fn seek(&mut self, place: SeekFrom) -> io::Result<u64> {
        match &mut self.writer {
            Open::Temporary(writer, ..) => writer.seek(place),
            Open::Through(writer) => writer.seek(place),
        }
    }
}

/// What the names of temporary files begin with.
const PREFIX: &str = ".garnet-";

/// How many letters and digits, drawn at random, follow.
const NUM_RANDOM: usize = 6;

/// A temporary file that nothing was written into for so long was left by a process that is gone.
const STALE: Duration = Duration::from_hours(1);

/// The same in any folder, of which it is not known who writes into it: some files are written
/// frame by frame, for hours.
const STALE_ANYWHERE: Duration = Duration::from_hours(24);

/// Folders that this process has swept.
static SWEPT: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Removes what killed processes have left beside a file that is to be written, once a folder.
fn sweep_once(folder: &Path) {
    let swept = SWEPT.lock();
    let is_first = swept.is_ok_and(|mut swept| swept.insert(folder.to_path_buf()));
    if is_first {
        remove_older(folder, STALE_ANYWHERE);
    }
}

/// Removes the temporary files that killed processes have left in a folder: those that were not
/// changed for an hour.
///
/// Younger ones may be those of a process that is at work. It is no error if the folder is not
/// there, or if a file cannot be removed: such files do no harm. Whatever is written removes those
/// beside it by itself, once they were not changed for a day.
pub fn remove_stale_temporaries(folder: impl AsRef<Path>) {
    remove_older(folder.as_ref(), STALE);
}

fn remove_older(folder: &Path, age: Duration) {
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        if is_temporary(&entry.file_name()) && is_older(&entry, age) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether a name is one of those that temporary files get; those of pictures have an extension,
/// too.
fn is_temporary(name: &OsStr) -> bool {
    let rest = name.to_str().and_then(|name| name.strip_prefix(PREFIX));
    let drawn = rest.and_then(|rest| rest.split('.').next());
    drawn.is_some_and(|drawn| {
        drawn.len() == NUM_RANDOM && drawn.bytes().all(|letter| letter.is_ascii_alphanumeric())
    })
}

fn is_older(entry: &DirEntry, than: Duration) -> bool {
    let Ok(metadata) = entry.metadata() else {
        return false;
    };
    let age = metadata
        .modified()
        .ok()
        .and_then(|time| time.elapsed().ok());
    metadata.is_file() && age.is_some_and(|age| age > than)
}

#[cfg(unix)]
fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    use std::os::unix::fs::PermissionsExt;
    // The process's mask applies, as for any new file.
    let permissions = fs::Permissions::from_mode(0o666);
    tempfile::Builder::new()
        .prefix(PREFIX)
        .rand_bytes(NUM_RANDOM)
        .permissions(permissions)
        .tempfile_in(folder)
}

#[cfg(not(unix))]
fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    tempfile::Builder::new()
        .prefix(PREFIX)
        .rand_bytes(NUM_RANDOM)
        .tempfile_in(folder)
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
    fn a_staged_file_is_in_its_place_when_it_is_put_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shirt.obj");
        fs::write(&path, "old").unwrap();
        let stage = || StagedFile::new(&path, |writer| writer.write_all(b"new")).unwrap();
        drop(stage());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        let staged = stage();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        staged.put().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_killed_processes_have_left_is_swept_away() {
        let folder = tempfile::tempdir().unwrap();
        let old = std::time::SystemTime::now() - 2 * STALE;
        for name in [
            ".garnet-aB3xYz",
            ".garnet-aB3xYz.png",
            ".garnet-notes",
            "shirt.obj",
        ] {
            let file = File::create(folder.path().join(name)).unwrap();
            file.set_modified(old).unwrap();
        }
        let fresh = temporary_in(folder.path()).unwrap();
        remove_stale_temporaries(folder.path());
        remove_stale_temporaries(folder.path().join("missing"));
        let names = fs::read_dir(folder.path()).unwrap();
        let mut names: Vec<_> = names.map(|entry| entry.unwrap().file_name()).collect();
        let mut expected: Vec<std::ffi::OsString> =
            vec![".garnet-notes".into(), "shirt.obj".into()];
        expected.push(fresh.path().file_name().unwrap().to_owned());
        names.sort();
        expected.sort();
        assert_eq!(names, expected);
    }

    #[test]
    fn a_file_that_is_written_sweeps_away_what_lay_beside_it_for_a_day() {
        let folder = tempfile::tempdir().unwrap();
        for (name, age) in [
            (".garnet-aB3xYz", 25 * STALE),
            (".garnet-cD4wVu", 2 * STALE),
            (".garnet-notes", 25 * STALE),
        ] {
            let file = File::create(folder.path().join(name)).unwrap();
            file.set_modified(std::time::SystemTime::now() - age)
                .unwrap();
        }
        write_atomically(folder.path().join("shirt.obj"), |_| Ok(())).unwrap();
        let names = fs::read_dir(folder.path()).unwrap();
        let mut names: Vec<_> = names.map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, [".garnet-cD4wVu", ".garnet-notes", "shirt.obj"]);
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
