//! Outputs: checked before any work is done, written whole or not at all.

use std::{
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
};

use anyhow::Context;
use garnet::{
    Skeleton,
    io::{WriteError, read_rig, remove_stale_temporaries, write_atomically},
    mesh::{MOST_BYTES, read_bounded, read_start},
    package::{FileLock, GarmentPackage, Manifest},
};
use serde::Deserialize;

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

/// Refuses a mesh that cannot be written, or whose name says that it is of another format than is
/// written.
pub(crate) fn check_obj(path: &Path) -> anyhow::Result<()> {
    check_named(path, "name a file")?;
    check_kind(path, "meshes are written as OBJ", "obj")?;
    check_file(path)
}

/// What reports say that they are, without the number of the version.
const REPORTS: [&str; 4] = [
    "garnet.drape",
    "garnet.simulate",
    "garnet.outfit",
    "garnet.eval",
];

/// And lists of hidden faces.
const HIDDEN: [&str; 1] = ["garnet.hide"];

/// Refuses a report that cannot be written, whose name says that it is of another format, or that
/// would take the place of a file that is no report.
pub(crate) fn check_report(path: &Path) -> anyhow::Result<()> {
    check_named(path, "name a file")?;
    check_kind(path, "reports are written as JSON", "json")?;
    check_file(path)?;
    if !path.is_file() || is_one_of(&REPORTS, path) {
        return Ok(());
    }
    Err(would_be_lost(path, "a file is there that is no report"))
}

/// Refuses a list of hidden faces that cannot be written, or that would take the place of a file
/// that is none. In text it has a number a line, in JSON a schema.
pub(crate) fn check_hidden(path: &Path) -> anyhow::Result<()> {
    check_named(path, "name a file")?;
    check_file(path)?;
    let is_numbers = || {
        let text = read_bounded(path, MOST_BYTES).ok().map(String::from_utf8);
        text.is_some_and(|text| {
            text.is_ok_and(|text| text.lines().all(|line| line.parse::<u64>().is_ok()))
        })
    };
    if !path.is_file() || is_one_of(&HIDDEN, path) || is_numbers() {
        return Ok(());
    }
    let what = "a file is there that lists no hidden faces";
    Err(would_be_lost(path, what))
}

/// Refuses a table that would take the place of a file that does not begin as it does.
pub(crate) fn check_table(path: &Path, beginning: &str) -> anyhow::Result<()> {
    let start = read_start(path, beginning.len() as u64).unwrap_or_default();
    if !path.is_file() || start.is_empty() || start == beginning.as_bytes() {
        return Ok(());
    }
    Err(would_be_lost(path, "a file is there that is no such table"))
}

/// Refuses a rig beside a body, which the user has not named, that would take the place of a file
/// that is none, or of the rig of another skeleton.
pub(crate) fn check_sidecar(path: &Path, skeleton: &Skeleton) -> anyhow::Result<()> {
    if !path.is_file() {
        return Ok(());
    }
    let names = |skeleton: &Skeleton| -> Vec<String> {
        let joints = skeleton.joints().iter();
        joints.map(|joint| joint.name.clone()).collect()
    };
    match read_rig(path) {
        Ok(rig) if names(&rig.skeleton) == names(skeleton) => Ok(()),
        Ok(_) => Err(would_be_lost(path, "the rig of another skeleton is there")),
        Err(_) => Err(would_be_lost(path, "a file is there that is no rig")),
    }
}

fn would_be_lost(path: &Path, what: &str) -> anyhow::Error {
    refused(
        format!("cannot write `{}`", path.display()),
        format!("{what}, and it would be lost"),
        "write into another file, or remove this one first",
    )
}

/// Whether a file is a document of an earlier run of one of these schemas, or empty.
fn is_one_of(schemas: &[&str], path: &Path) -> bool {
    #[derive(Deserialize)]
    struct Document {
        schema: String,
    }
    let Ok(bytes) = read_bounded(path, MOST_BYTES) else {
        return false;
    };
    let document: Option<Document> = serde_json::from_slice(&bytes).ok();
    let is_ours = |document: Document| {
        let (name, _) = document.schema.split_once('/').unwrap_or_default();
        schemas.contains(&name)
    };
    bytes.is_empty() || document.is_some_and(is_ours)
}

/// How drapes can be written.
const DRAPES: [&str; 5] = ["obj", "glb", "pc2", "mdd", "npz"];

/// Refuses a drape that cannot be written, or whose name says that it is of another format than is
/// written.
pub(crate) fn check_drape(path: &Path) -> anyhow::Result<()> {
    check_named(path, "name a file")?;
    check_kinds(
        path,
        "drapes are written as OBJ, GLB, PC2, MDD or npz",
        &DRAPES,
    )?;
    check_file(path)
}

/// Refuses a picture that cannot be written, or whose name says that it is of another format than
/// PNG, or GIF for an animation.
pub(crate) fn check_picture(path: &Path) -> anyhow::Result<()> {
    check_named(path, "name a file")?;
    check_kinds(path, "pictures are PNG, animated ones GIF", &["png", "gif"])?;
    check_file(path)
}

/// Refuses a page that cannot be written, or whose name says that it is of another format than is
/// written.
pub(crate) fn check_page(path: &Path) -> anyhow::Result<()> {
    check_named(path, "name a file")?;
    check_kinds(path, "pages are HTML", &["html", "htm"])?;
    check_file(path)
}

fn check_kind(path: &Path, what: &str, kind: &str) -> anyhow::Result<()> {
    check_kinds(path, what, &[kind])
}

/// Refuses a name that is of none of some kinds; one without an extension says nothing.
pub(crate) fn check_kinds(path: &Path, what: &str, kinds: &[&str]) -> anyhow::Result<()> {
    let extension = path.extension().map(OsStr::to_string_lossy);
    match extension {
        Some(extension)
            if !kinds
                .iter()
                .any(|kind| extension.eq_ignore_ascii_case(kind)) =>
        {
            Err(refused(
                format!("cannot write `{}`", path.display()),
                format!("{what}, not {extension}"),
                format!("name a file that ends with {}", either(kinds)),
            ))
        }
        _ => Ok(()),
    }
}

/// Extensions as people list them.
fn either(kinds: &[&str]) -> String {
    match kinds {
        [] => String::new(),
        [kind] => format!(".{kind}"),
        [first @ .., last] => format!(".{} or .{last}", first.join(", .")),
    }
}

/// Whether a name is that of a folder, be it there or not: it ends with a separator.
pub(crate) fn names_folder(path: &Path) -> bool {
    let text = path.as_os_str().to_string_lossy();
    text.ends_with(std::path::is_separator)
}

/// Extensions of files that people may mean when a folder is needed.
const KINDS_OF_FILES: [&str; 39] = [
    "3ds", "3mf", "abc", "blend", "bvh", "c4d", "csv", "dae", "fbx", "gif", "glb", "gltf", "hip",
    "html", "jpg", "json", "ma", "max", "mb", "mdd", "mp4", "npy", "npz", "obj", "off", "pc2",
    "ply", "png", "stl", "svg", "txt", "usd", "usda", "usdc", "usdz", "vrm", "wrl", "x3d", "zip",
];

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
    // Without a separator at its end, with which a file looks as if it were not there.
    let folder = folder.components().as_path();
    if folder.is_dir() {
        return Ok(());
    }
    let shown = folder.display();
    if folder.exists() {
        return Err(refused(
            format!("cannot write into `{shown}`"),
            "it is a file, and a folder is needed",
            "name another folder",
        ));
    }
    let parent = folder_of(folder);
    if !parent.is_dir() {
        let parent_shown = parent.display();
        let (why, hint) = if parent.exists() {
            (
                format!("`{parent_shown}` is a file, and a folder is needed"),
                "name another folder",
            )
        } else {
            (
                format!("the folder `{parent_shown}` does not exist"),
                "create the folder first",
            )
        };
        return Err(refused(format!("cannot write into `{shown}`"), why, hint));
    }
    Ok(())
}

/// As [`check_folder`], and refuses a new folder whose name is that of a file, which was meant
/// perhaps.
pub(crate) fn check_output_folder(folder: &Path) -> anyhow::Result<()> {
    check_new_folder(folder, "name a folder with `-o`, or end the name with `/`")
}

/// As [`check_output_folder`], of several drapes, which may go into one file, too.
pub(crate) fn check_drape_folder(folder: &Path) -> anyhow::Result<()> {
    let advice = "name a folder, or a file of all frames that ends with .pc2, .mdd, .npz or .glb";
    check_new_folder(folder, advice)
}

fn check_new_folder(folder: &Path, advice: &str) -> anyhow::Result<()> {
    let extension = folder.extension().map(OsStr::to_string_lossy);
    let kind = extension.filter(|found| {
        let mut kinds = KINDS_OF_FILES.into_iter();
        kinds.any(|kind| found.eq_ignore_ascii_case(kind))
    });
    match kind {
        Some(kind) if !folder.exists() && !names_folder(folder) => Err(refused(
            format!("cannot write into `{}`", folder.display()),
            format!("it has the name of a file ({kind}), and a folder is needed"),
            advice,
        )),
        _ => check_folder(folder),
    }
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

/// The files of a garment package that are read, its weights among them.
pub(crate) fn files_of_package(folder: &Path, manifest: &Manifest) -> Vec<PathBuf> {
    let fixed = GarmentPackage::file_names().into_iter().map(PathBuf::from);
    let weights = manifest.weight_files().map(PathBuf::from);
    let rig = PathBuf::from(&manifest.rest_body.rig);
    let all = fixed.chain(weights).chain([rig]);
    all.map(|name| folder.join(name)).collect()
}

/// The files of a data set: its manifest and its shards.
pub(crate) fn files_of_dataset(folder: &Path) -> Vec<PathBuf> {
    let shards = fs::read_dir(folder.join("shards")).into_iter().flatten();
    let shards = shards.filter_map(|entry| Some(entry.ok()?.path()));
    std::iter::once(folder.join("dataset.json"))
        .chain(shards)
        .collect()
}

/// Takes a folder that is there for this run alone, until the value is dropped: other runs of the
/// same kind would mix their files with those of this one.
pub(crate) fn lock_folder(folder: &Path) -> anyhow::Result<FileLock> {
    Ok(FileLock::take(&folder.join("garnet.lock"), folder)?)
}

/// Where a file is or would be, of whose folders some may be still to be made.
pub(crate) fn place_of(path: &Path) -> PathBuf {
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
    match fs::create_dir(folder) {
        // Another part of the same work has made it meanwhile.
        Err(_) if folder.is_dir() => Ok(()),
        made => made.with_context(|| format!("cannot make the folder `{}`", folder.display())),
    }
}

/// Makes a folder that was checked, and removes the temporary files that killed runs have left in
/// it.
pub(crate) fn open_folder(folder: &Path) -> anyhow::Result<()> {
    make_folder(folder)?;
    remove_stale_temporaries(folder);
    Ok(())
}

/// The OBJ in a folder that is named after an input.
pub(crate) fn name_in(folder: &Path, input: &Path) -> PathBuf {
    let mut name = input
        .file_stem()
        .unwrap_or(OsStr::new("body"))
        .to_os_string();
    name.push(".obj");
    folder.join(name)
}

/// One output in `folder` for each input, named after it.
pub(crate) fn names_in(folder: &Path, inputs: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let mut outputs: Vec<PathBuf> = Vec::with_capacity(inputs.len());
    for input in inputs {
        let output = name_in(folder, input);
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
