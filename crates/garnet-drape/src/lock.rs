//! Files that one run at a time has.

use std::{
    fs::{self, File, TryLockError},
    io::{self, Read, Write},
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use crate::PackageError;

/// How often a file is made anew, because the run before has just removed it.
const TRIES: u32 = 100;

/// How long a run waits for what another one does in a moment.
const PATIENCE: Duration = Duration::from_secs(30);

/// How long it sleeps meanwhile.
const BETWEEN_TRIES: Duration = Duration::from_millis(10);

/// A file that this run alone has, until the value is dropped: then the file goes.
///
/// It is kept locked, and holds the number of the process for the message of another run. The
/// system unlocks it when the process ends, in whatever way: a file that a killed run has left
/// holds nobody up.
#[derive(Debug)]
pub struct FileLock {
    /// Kept open, since closing it unlocks it.
    _file: File,
    path: PathBuf,
}

/// What came of one try to take a file.
#[derive(Debug)]
pub enum Attempt {
    /// It is this run's.
    Taken(FileLock),
    /// Another run has it: that of this process, if it says so.
    Held(Option<u32>),
    /// Another run has just removed it, or its folder.
    Gone,
}

impl FileLock {
    /// Takes a file of a folder that is there, by which runs that write `what` keep each other out.
    ///
    /// # Errors
    ///
    /// [`PackageError::InUse`] with `what` while another run has the file;
    /// [`PackageError::Folder`].
    pub fn take(path: &Path, what: &Path) -> Result<Self, PackageError> {
        for _ in 0..TRIES {
            match Self::attempt(path)? {
                Attempt::Taken(lock) => return Ok(lock),
                Attempt::Held(process) => return Err(in_use(what, process)),
                Attempt::Gone => {}
            }
        }
        Err(in_use(what, None))
    }

    /// As [`FileLock::take`], and waits for another run, which has the file for a moment only.
    ///
    /// # Errors
    ///
    /// As [`FileLock::take`], after half a minute.
    pub fn wait(path: &Path, what: &Path) -> Result<Self, PackageError> {
        let start = Instant::now();
        loop {
            match Self::take(path, what) {
                Err(PackageError::InUse { .. }) if start.elapsed() < PATIENCE => {
                    std::thread::sleep(BETWEEN_TRIES);
                }
                taken => return taken,
            }
        }
    }

    /// Refuses to go on while another run has a file.
    ///
    /// # Errors
    ///
    /// As [`FileLock::take`].
    pub fn check(path: &Path, what: &Path) -> Result<(), PackageError> {
        if path.exists() {
            drop(Self::take(path, what)?);
        }
        Ok(())
    }

    /// Tries once to take a file.
    ///
    /// # Errors
    ///
    /// [`PackageError::Folder`].
    pub fn attempt(path: &Path) -> Result<Attempt, PackageError> {
        let mut options = File::options();
        let opened = options.create(true).truncate(false).write(true).open(path);
        let mut file = match opened {
            Ok(file) => file,
            Err(error) if is_gone(&error, path) => return Ok(Attempt::Gone),
            Err(source) => return Err(PackageError::folder(path, source)),
        };
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Ok(Attempt::Held(process_in(path))),
            // Where the system has no locks every file can be taken.
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
            Err(TryLockError::Error(source)) => return Err(PackageError::folder(path, source)),
        }
        // Whoever had it may have removed it after it was opened here.
        if !is_at(&file, path) {
            return Ok(Attempt::Gone);
        }
        let _ = file.set_len(0);
        let _ = write!(file, "{}", std::process::id());
        Ok(Attempt::Taken(Self {
            _file: file,
            path: path.to_path_buf(),
        }))
    }

    /// Where the file is.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for FileLock {
    fn drop(&mut self) {
        // Nobody can be told; a file that stays does no harm.
        let _ = fs::remove_file(&self.path);
    }
}

/// That another run writes `what`.
fn in_use(what: &Path, process: Option<u32>) -> PackageError {
    PackageError::InUse {
        folder: what.to_path_buf(),
        process,
    }
}

/// Whether the folder of a file was removed meanwhile; one that never was is an error.
fn is_gone(error: &io::Error, path: &Path) -> bool {
    let grandparent = path.parent().and_then(Path::parent);
    error.kind() == io::ErrorKind::NotFound && grandparent.is_some_and(Path::is_dir)
}

/// The process that has written its number into a file.
fn process_in(path: &Path) -> Option<u32> {
    let mut text = String::new();
    File::open(path).ok()?.read_to_string(&mut text).ok()?;
    text.parse().ok()
}

/// Whether an open file is the one at a path.
fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let [ours, there] = [file.metadata(), fs::metadata(path)].map(|found| {
            let found = found.ok()?;
            Some((found.dev(), found.ino()))
        });
        ours.is_some() && ours == there
    }
    #[cfg(not(unix))]
    {
        let _ = file;
        path.exists()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_taken_once_and_given_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.lock");
        let lock = FileLock::take(&path, folder.path()).unwrap();
        let error = FileLock::take(&path, folder.path()).unwrap_err();
        let this = std::process::id();
        assert!(
            matches!(error, PackageError::InUse { process, .. } if process == Some(this)),
            "{error}"
        );
        assert!(FileLock::check(&path, folder.path()).is_err());
        drop(lock);
        assert!(!path.exists());
        FileLock::check(&path, folder.path()).unwrap();
        assert!(!path.exists());
    }

    #[test]
    fn what_a_killed_run_has_left_holds_nobody_up() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.lock");
        fs::write(&path, "1").unwrap();
        drop(FileLock::take(&path, folder.path()).unwrap());
        assert!(!path.exists());
    }

    #[test]
    fn one_at_a_time_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.lock");
        let count = folder.path().join("count");
        fs::write(&count, "0").unwrap();
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..20 {
                        let lock = FileLock::wait(&path, folder.path()).unwrap();
                        let before: u32 = fs::read_to_string(&count).unwrap().parse().unwrap();
                        fs::write(&count, (before + 1).to_string()).unwrap();
                        drop(lock);
                    }
                });
            }
        });
        assert_eq!(fs::read_to_string(&count).unwrap(), "80");
    }

    #[test]
    fn a_folder_that_is_not_there_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b/x.lock");
        let error = FileLock::take(&path, folder.path()).unwrap_err();
        assert!(matches!(error, PackageError::Folder { .. }), "{error}");
    }
}
