//! Outputs: checked before any work is done, written whole or not at all.

use std::{
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
};

use anyhow::Context;
use garnet::io::{WriteError, remove_stale_temporaries, write_atomically};

use crate::failure::refused;

/// Refuses a file that cannot be written, so that no work is done for nothing.
pub(crate) fn check_file(path: &Path) -> anyhow::Result<()> {
    check_named(path, "name a file")?;
    if path.is_dir() {
        let path = path.to_path_buf();
        return Err(WriteError::IsFolder { path }.into());
    }
    let folder = folder_of(path);
    if !folder.is_dir() {
        return Err(WriteError::FolderMissing {
            path: path.to_path_buf(),
            folder: folder.to_path_buf(),
        }
        .into());
    }
    Ok(())
}

/// Refuses what stands for stdout.
fn check_named(path: &Path, advice: &str) -> anyhow::Result<()> {
    if path.as_os_str() != "-" {
        return Ok(());
    }
    Err(refused(
        "cannot write into `-`",
        "only reports and `--json` go to stdout",
        advice,
    ))
}

/// Refuses a folder that is a file, or that cannot be made because its own folder is missing.
pub(crate) fn check_folder(folder: &Path) -> anyhow::Result<()> {
    check_named(folder, "name a folder")?;
    if folder.is_dir() {
        return Ok(());
    }
    let shown = folder.display();
    if folder.exists() {
        return Err(refused(
            format!("cannot write into `{shown}`"),
            "it is a file, and a folder is needed",
            "name a folder with `-o`",
        ));
    }
    if !folder_of(folder).is_dir() {
        return Err(refused(
            format!("cannot write into `{shown}`"),
            format!(
                "the folder `{}` does not exist",
                folder_of(folder).display()
            ),
            "create the folder first",
        ));
    }
    Ok(())
}

/// Refuses outputs that would take the place of inputs, or of each other.
pub(crate) fn check_apart(outputs: &[&Path], inputs: &[&Path]) -> anyhow::Result<()> {
    let inputs: Vec<PathBuf> = inputs
        .iter()
        .filter_map(|path| fs::canonicalize(path).ok())
        .collect();
    let mut seen: Vec<PathBuf> = Vec::with_capacity(outputs.len());
    for output in outputs {
        let place = place_of(output);
        let shown = output.display();
        if inputs.contains(&place) {
            return Err(refused(
                format!("cannot write `{shown}`"),
                "it is one of the files that are read",
                "write into another file",
            ));
        }
        if seen.contains(&place) {
            return Err(refused(
                format!("cannot write `{shown}`"),
                "two outputs have this name",
                "give each its own file",
            ));
        }
        seen.push(place);
    }
    Ok(())
}

/// Where a file is or would be, of whose folders some may be still to be made.
fn place_of(path: &Path) -> PathBuf {
    match (fs::canonicalize(path), path.file_name()) {
        (Ok(place), _) => place,
        (Err(_), Some(name)) => place_of(folder_of(path)).join(name),
        (Err(_), None) => path.to_path_buf(),
    }
}

/// Makes a folder that was checked.
pub(crate) fn make_folder(folder: &Path) -> anyhow::Result<()> {
    if folder.is_dir() {
        return Ok(());
    }
    fs::create_dir(folder).with_context(|| format!("cannot make the folder `{}`", folder.display()))
}

/// Makes a folder that was checked, and removes the temporary files that killed runs have left in it.
pub(crate) fn open_folder(folder: &Path) -> anyhow::Result<()> {
    make_folder(folder)?;
    remove_stale_temporaries(folder);
    Ok(())
}

/// One output in `folder` for each input, named after it.
pub(crate) fn names_in(folder: &Path, inputs: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let mut outputs: Vec<PathBuf> = Vec::with_capacity(inputs.len());
    for input in inputs {
        let stem = input.file_stem().unwrap_or(OsStr::new("body"));
        let mut name = stem.to_os_string();
        name.push(".obj");
        let output = folder.join(name);
        if let Some(other) = outputs.iter().position(|earlier| *earlier == output) {
            return Err(refused(
                format!("two bodies lead to the output `{}`", output.display()),
                format!("`{}` and `{}`", inputs[other].display(), input.display()),
                "outputs are named after the bodies: drape those of one name one by one",
            ));
        }
        outputs.push(output);
    }
    Ok(outputs)
}

/// Writes a text or picture.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    write_atomically(path, |writer| writer.write_all(bytes))?;
    Ok(())
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}
