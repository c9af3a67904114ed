//! Where packages are found that are named and not told the folder of.
//!
//! `tshirt` means the folder `tshirt` here, else a package of that name in `GARNET_MODELS`, in
//! `share/garnet/models` beside the folder of the program, or in `garnet/models` of the user's
//! data.

use std::{
    collections::BTreeSet,
    convert::Infallible,
    env, fs,
    path::{Component, Path, PathBuf},
};

use garnet::package::GarmentPackage;

use crate::{failure::refused, hints};

/// Names more folders to look in, as `PATH` does.
const VARIABLE: &str = "GARNET_MODELS";

/// The package that an argument names: for `value_parser`.
#[expect(clippy::unnecessary_wraps, reason = "as clap asks for")]
pub(crate) fn package_or_file(argument: &str) -> Result<PathBuf, Infallible> {
    let path = PathBuf::from(argument);
    let is_name = matches!(
        path.components().collect::<Vec<_>>()[..],
        [Component::Normal(_)]
    );
    if !is_name || path.exists() || argument.ends_with(['/', '\\']) {
        return Ok(path);
    }
    let found = folders().into_iter().map(|folder| folder.join(&path));
    let found = found
        .into_iter()
        .find(|folder| GarmentPackage::is_at(folder));
    Ok(found.unwrap_or(path))
}

/// What is told of a word that is neither a file nor the name of a package, as those of files are
/// with an extension; none of paths.
pub(crate) fn unknown(path: &Path) -> Option<anyhow::Error> {
    let is_word = path.components().count() == 1 && path.extension().is_none();
    if path.exists() || !is_word {
        return None;
    }
    let folders = folders();
    let entries = folders
        .iter()
        .filter_map(|folder| fs::read_dir(folder).ok());
    let packages = entries
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()));
    let packages = packages.filter(|folder| GarmentPackage::is_at(folder));
    let names = packages.filter_map(|folder| Some(folder.file_name()?.to_str()?.to_owned()));
    let names: BTreeSet<String> = names.collect();
    let meant = hints::did_you_mean(path.to_str()?, names.iter().map(String::as_str));
    let hint = match (meant, names.is_empty()) {
        (Some(meant), _) => meant,
        (None, false) => {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            format!("the packages that are found are: {}", names.join(", "))
        }
        (None, true) => {
            format!("name the folder of a package, or set `{VARIABLE}` to the folder that has it")
        }
    };
    Some(refused(
        format!("there is no garment `{}`", path.display()),
        "it is no file, and no folder of packages has one of this name",
        hint,
    ))
}

/// The folders that packages are looked for in.
fn folders() -> Vec<PathBuf> {
    let own = env::var_os(VARIABLE);
    let own = own.iter().flat_map(env::split_paths);
    let program = env::current_exe().ok();
    let beside = program.as_deref().and_then(Path::parent);
    let beside = beside.map(|folder| folder.join("../share/garnet/models"));
    let data = env::var_os("XDG_DATA_HOME").map(PathBuf::from);
    let home = || env::var_os("HOME").map(|home| PathBuf::from(home).join(".local/share"));
    let data = data
        .or_else(home)
        .map(|folder| folder.join("garnet/models"));
    own.chain(beside).chain(data).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_taken_as_they_are() {
        for path in ["models/none", "./none", "/none", "none/", "none.obj"] {
            assert_eq!(package_or_file(path), Ok(PathBuf::from(path)));
        }
    }
}
