//! Files that the user names: whole, no larger than is said, and neither pipes nor devices.

use std::path::Path;

use anyhow::Context;
use garnet::mesh::{MOST_BYTES, read_bounded, read_start, read_text};

/// All bytes of a file, up to [`MOST_BYTES`].
pub(crate) fn bytes(path: &Path) -> anyhow::Result<Vec<u8>> {
    read_bounded(path, MOST_BYTES).with_context(|| cannot(path))
}

/// The text of a file, up to [`MOST_BYTES`].
pub(crate) fn text(path: &Path) -> anyhow::Result<String> {
    read_text(path, MOST_BYTES).with_context(|| cannot(path))
}

/// The first bytes of a file, `most` at most.
pub(crate) fn start(path: &Path, most: u64) -> anyhow::Result<Vec<u8>> {
    read_start(path, most).with_context(|| cannot(path))
}

/// Refuses a pipe or a device that a file or a folder names, and not the user.
pub(crate) fn check_regular(path: &Path) -> anyhow::Result<()> {
    if !path.exists() {
        return Ok(());
    }
    garnet::mesh::check_regular(path).with_context(|| cannot(path))
}

fn cannot(path: &Path) -> String {
    format!("cannot read `{}`", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stderr::Failure;

    #[test]
    fn what_is_no_text_is_told_by_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        std::fs::write(&path, b"1\n2\n\xff\n").unwrap();
        assert_eq!(start(&path, 2).unwrap(), b"1\n");
        let failure = Failure::new(&text(&path).unwrap_err());
        assert!(failure.error.contains("a.txt"), "{failure:?}");
        assert_eq!(failure.causes, ["line 3 is no text in UTF-8"]);
        assert!(start(folder.path(), 2).is_err() && bytes(folder.path()).is_err());
    }

    #[test]
    #[cfg(unix)]
    fn devices_and_files_without_end_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let large = folder.path().join("large");
        let file = std::fs::File::create(&large).unwrap();
        // Six gigabytes that take no room.
        if file.set_len(6 << 30).is_ok() {
            let failure = Failure::new(&bytes(&large).unwrap_err());
            assert!(
                failure.causes[0].contains("are read at most"),
                "{failure:?}"
            );
        }
        for read in [bytes, |path: &Path| start(path, 4)] {
            let failure = Failure::new(&read(Path::new("/dev/zero")).unwrap_err());
            assert_eq!(failure.causes, ["it is a pipe or a device, not a file"]);
            assert!(failure.hint.is_some());
        }
    }
}
