//! Reading files of others: whole, regular, and no larger than is said.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Component, Path};

/// The largest file that other files may name: weights, shards, buffers.
pub const MOST_BYTES: u64 = 1 << 30;

/// Reads a file that another file names, or that stands in a folder of a known form: pipes and
/// devices, which may never end, are refused, as are files of more than `most` bytes.
///
/// # Errors
///
/// Those of the system, and [`ErrorKind::InvalidInput`] for what is refused.
///
/// # Examples
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("a.bin");
/// std::fs::write(&path, [7; 9])?;
/// assert_eq!(garnet_mesh::read_bounded(&path, 9)?, [7; 9]);
/// assert!(garnet_mesh::read_bounded(&path, 8).is_err());
/// assert!(garnet_mesh::read_bounded(folder.path(), 8).is_err());
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn read_bounded(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    check_regular(path)?;
    read_at_most(path, most)
}

/// The first bytes of a regular file, `most` at most.
///
/// # Errors
///
/// Those of the system, and [`ErrorKind::InvalidInput`] for pipes and devices.
pub fn read_start(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    check_regular(path)?;
    let mut start = Vec::new();
    File::open(path)?.take(most).read_to_end(&mut start)?;
    Ok(start)
}

/// Refuses pipes and devices before they are opened: to open a pipe may take for ever.
///
/// # Errors
///
/// Those of the system, and [`ErrorKind::InvalidInput`] for what is refused.
pub fn check_regular(path: &Path) -> io::Result<()> {
    let data = fs::metadata(path)?;
    if data.is_file() || data.is_dir() {
        return Ok(());
    }
    let why = "it is a pipe or a device, not a file";
    Err(io::Error::new(ErrorKind::InvalidInput, why))
}

/// Reads a file that the user names, which may be a pipe, if it has no more than `most` bytes.
///
/// # Errors
///
/// Those of the system, and [`ErrorKind::InvalidInput`] for a larger one.
///
/// # Examples
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("a.json");
/// std::fs::write(&path, "{}")?;
/// assert_eq!(garnet_mesh::read_at_most(&path, 2)?, b"{}");
/// assert!(garnet_mesh::read_at_most(&path, 1).is_err());
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn read_at_most(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let too_large = |bytes: u64| {
        let why = format!("it has {bytes} bytes or more, and {most} are read at most");
        io::Error::new(ErrorKind::InvalidInput, why)
    };
    let data = fs::metadata(path)?;
    if data.is_file() && data.len() > most {
        return Err(too_large(data.len()));
    }
    let mut bytes = Vec::new();
    File::open(path)?
        .take(most.saturating_add(1))
        .read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(too_large(bytes.len() as u64));
    }
    Ok(bytes)
}

/// The text of a file that another file names, as [`read_bounded`] reads it.
///
/// # Errors
///
/// Those of [`read_bounded`], and [`ErrorKind::InvalidData`] with the line that is no UTF-8.
///
/// # Examples
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("a.toml");
/// std::fs::write(&path, b"a = 1\nb = \xff")?;
/// let error = garnet_mesh::read_text(&path, 99).unwrap_err();
/// assert_eq!(error.to_string(), "line 2 is no text in UTF-8");
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(read_bounded(path, most)?).map_err(|error| {
        let before = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = before.split(|byte| *byte == b'\n').count();
        let why = format!("line {line} is no text in UTF-8");
        io::Error::new(ErrorKind::InvalidData, why)
    })
}

/// Whether a name in a file stays in the folder of that file: it is not absolute and never goes up.
///
/// ```
/// use garnet_mesh::stays_inside;
///
/// assert!(stays_inside("weights/fast.bin"));
/// assert!(!stays_inside("../fast.bin") && !stays_inside("/dev/zero") && !stays_inside(""));
/// ```
pub fn stays_inside(name: &str) -> bool {
    let mut parts = Path::new(name).components().peekable();
    parts.peek().is_some()
        && parts.all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;

    #[test]
    fn devices_and_folders_are_refused() {
        let error = read_bounded(Path::new("/dev/zero"), 8).unwrap_err();
        assert!(error.to_string().contains("a pipe or a device"), "{error}");
        let folder = tempfile::tempdir().unwrap();
        assert!(read_bounded(folder.path(), 8).is_err());
        let missing = read_bounded(&folder.path().join("none"), 8).unwrap_err();
        assert_eq!(missing.kind(), ErrorKind::NotFound);
    }

    #[test]
    fn a_sparse_file_is_refused_by_its_size() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sparse");
        File::create(&path).unwrap().set_len(6 << 30).unwrap();
        let error = read_bounded(&path, MOST_BYTES).unwrap_err();
        assert!(error.to_string().contains("6442450944 bytes"), "{error}");
    }
}
