//! `NumPy`'s archives of arrays.

use std::{
    fs::File,
    io::{self, BufReader, Read},
    path::{Path, PathBuf},
};

use zip::{ZipArchive, result::ZipError};

use super::{ArrayProblem, FileError, FileProblem, npy::NpyArray};

/// The largest array that is unpacked: an archive may claim anything. A quarter of an hour of an
/// AMASS recording has 170 MB.
const MAX_ARRAY_BYTES: u64 = 1 << 28;

/// An npz archive, whose arrays are read one at a time.
#[derive(Debug)]
pub struct NpzFile {
    path: PathBuf,
    archive: ZipArchive<BufReader<File>>,
}

impl NpzFile {
    /// Opens an archive, stored or deflated.
    ///
    /// # Errors
    ///
    /// [`FileError`] if the file cannot be read or is no sound zip archive.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref().to_path_buf();
        let archive = opened(&path)
            .and_then(|file| ZipArchive::new(BufReader::new(file)).map_err(FileProblem::Archive));
        match archive {
            Ok(archive) => Ok(Self { path, archive }),
            Err(problem) => Err(FileError { path, problem }),
        }
    }

    /// The names of the arrays, sorted.
    pub fn keys(&self) -> Vec<String> {
        let names = self.archive.file_names().filter_map(Result::ok);
        let mut keys: Vec<String> = names
            .filter_map(|name| name.strip_suffix(".npy").map(str::to_owned))
            .collect();
        keys.sort();
        keys
    }

    /// Checks that keys are there.
    ///
    /// # Errors
    ///
    /// [`FileProblem::MissingKeys`] with what is missing and what was found.
    pub fn require(&self, keys: &[&str]) -> Result<(), FileError> {
        let found = self.keys();
        let is_missing = |key: &&&str| !found.iter().any(|name| name == **key);
        let missing: Vec<String> = keys
            .iter()
            .filter(is_missing)
            .map(|key| (*key).to_owned())
            .collect();
        if missing.is_empty() {
            return Ok(());
        }
        Err(self.failed(FileProblem::MissingKeys { missing, found }))
    }

    /// Reads the array of a key; none if it is not there.
    ///
    /// # Errors
    ///
    /// [`FileProblem::Array`] if the entry is damaged or no array of numbers or text,
    /// [`FileProblem::Pickled`] if it is an object of Python.
    pub fn array(&mut self, key: &str) -> Result<Option<NpyArray>, FileError> {
        match self.unpacked(key) {
            Ok(Some(bytes)) => match NpyArray::parse(&bytes) {
                Ok(array) => Ok(Some(array)),
                Err(ArrayProblem::ElementType { descr }) if is_object(&descr) => {
                    let key = key.to_owned();
                    Err(self.failed(FileProblem::Pickled { key }))
                }
                Err(problem) => Err(self.wrong(key, problem)),
            },
            Ok(None) => Ok(None),
            Err(problem) => Err(self.wrong(key, problem)),
        }
    }

    fn unpacked(&mut self, key: &str) -> Result<Option<Vec<u8>>, ArrayProblem> {
        let unpack = |reason: String| ArrayProblem::Unpack { reason };
        let entry = match self.archive.by_name(&format!("{key}.npy")) {
            Ok(entry) => entry,
            Err(ZipError::FileNotFound) => return Ok(None),
            Err(error) => return Err(unpack(error.to_string())),
        };
        // What it says of itself is looked at before anything is unpacked, and not believed.
        if entry.size() > MAX_ARRAY_BYTES {
            return Err(ArrayProblem::TooLarge {
                limit: MAX_ARRAY_BYTES,
            });
        }
        let mut bytes = Vec::new();
        let read = entry.take(MAX_ARRAY_BYTES + 1).read_to_end(&mut bytes);
        read.map_err(|error| unpack(error.to_string()))?;
        if bytes.len() as u64 > MAX_ARRAY_BYTES {
            return Err(ArrayProblem::TooLarge {
                limit: MAX_ARRAY_BYTES,
            });
        }
        Ok(Some(bytes))
    }

    /// The error that an array is wrong.
    pub fn wrong(&self, key: &str, problem: ArrayProblem) -> FileError {
        self.failed(FileProblem::Array {
            key: key.to_owned(),
            problem,
        })
    }

    pub(super) fn failed(&self, problem: FileProblem) -> FileError {
        FileError {
            path: self.path.clone(),
            problem,
        }
    }
}

/// A file with something in it.
fn opened(path: &Path) -> Result<File, FileProblem> {
    let file = File::open(path)?;
    let data = file.metadata()?;
    if data.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory).into());
    }
    if data.is_file() && data.len() == 0 {
        return Err(FileProblem::Empty);
    }
    Ok(file)
}

/// Whether an element type is that of objects of Python, which are pickled.
fn is_object(descr: &str) -> bool {
    descr
        .trim_start_matches(['|', '<', '>', '='])
        .starts_with('O')
}
