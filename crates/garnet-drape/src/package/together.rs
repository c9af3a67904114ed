//! The files of a package, all of which are written before one is in its place.

use std::{
    fs,
    path::{Path, PathBuf},
};

use garnet_mesh::StagedFile;

use super::PackageError;

/// Files under temporary names, with their places. Dropped, they leave the folder as it is.
#[derive(Debug)]
pub(super) struct Together {
    /// All but the manifest.
    pub(super) parts: Vec<(PathBuf, StagedFile)>,
    /// A file of an older package that this one does not have; it need not be there.
    pub(super) surplus: Option<PathBuf>,
    /// What tells that all others are there.
    pub(super) manifest: (PathBuf, StagedFile),
}

impl Together {
    /// Removes the old manifest, puts the files into their places, the new manifest last, and
    /// returns their places.
    ///
    /// # Errors
    ///
    /// [`PackageError::Folder`] or [`PackageError::Write`]: some files are then in their places,
    /// and the manifest is not.
    pub(super) fn put(self) -> Result<Vec<PathBuf>, PackageError> {
        let (place, manifest) = self.manifest;
        // A link stays, and with it the place that the new manifest comes to.
        if let Ok(old) = fs::canonicalize(&place) {
            remove(&old)?;
        }
        let mut written = Vec::with_capacity(self.parts.len() + 1);
        for (path, part) in self.parts {
            part.put()?;
            written.push(path);
        }
        if let Some(surplus) = &self.surplus {
            remove(surplus)?;
        }
        manifest.put()?;
        written.push(place);
        Ok(written)
    }
}

/// Removes a file if there is one; pipes and devices stay.
fn remove(path: &Path) -> Result<(), PackageError> {
    if !path.is_file() {
        return Ok(());
    }
    fs::remove_file(path).map_err(|source| PackageError::folder(path, source))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [&str; 3] = ["template", "rest", "manifest"];

    /// Files whose text is `text`, without the surplus one.
    fn staged(folder: &Path, text: &str) -> Together {
        let [template, rest, manifest] = NAMES.map(|name| folder.join(name));
        let stage = |path: &Path| {
            StagedFile::new(path, |writer| writer.write_all(text.as_bytes())).unwrap()
        };
        Together {
            parts: vec![(template.clone(), stage(&template))],
            surplus: Some(rest),
            manifest: (manifest.clone(), stage(&manifest)),
        }
    }

    fn texts(folder: &Path) -> [Option<String>; 3] {
        NAMES.map(|name| fs::read_to_string(folder.join(name)).ok())
    }

    #[test]
    fn nothing_is_in_its_place_before_all_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        for name in NAMES {
            fs::write(folder.join(name), "old").unwrap();
        }
        let old = || Some("old".to_owned());
        let files = staged(folder, "new");
        assert_eq!(texts(folder), [old(), old(), old()]);
        drop(files);
        assert_eq!(fs::read_dir(folder).unwrap().count(), 3);
        let written = staged(folder, "new").put().unwrap();
        let new = || Some("new".to_owned());
        assert_eq!(texts(folder), [new(), None, new()]);
        assert_eq!(
            written,
            ["template", "manifest"].map(|name| folder.join(name))
        );
        assert_eq!(fs::read_dir(folder).unwrap().count(), 2);
    }

    #[test]
    fn files_that_do_not_all_come_to_their_places_have_no_manifest() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        fs::write(folder.join("manifest"), "old").unwrap();
        let files = staged(folder, "new");
        fs::create_dir_all(folder.join("template/in the way")).unwrap();
        files.put().unwrap_err();
        assert_eq!(texts(folder), [None, None, None]);
    }

    #[cfg(unix)]
    #[test]
    fn a_manifest_that_is_a_link_stays_one() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        fs::write(folder.join("elsewhere"), "old").unwrap();
        std::os::unix::fs::symlink("elsewhere", folder.join("manifest")).unwrap();
        staged(folder, "new").put().unwrap();
        let elsewhere = fs::read_to_string(folder.join("elsewhere")).unwrap();
        assert_eq!(elsewhere, "new");
        assert!(folder.join("manifest").is_symlink());
    }
}
