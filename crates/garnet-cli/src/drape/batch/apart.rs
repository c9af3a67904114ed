//! That no job writes what it or another one reads or writes.

use std::{
    collections::BTreeMap,
    ffi::OsStr,
    fmt::Display,
    path::{Path, PathBuf},
};

use garnet::{
    io::rig_beside,
    mesh::{MOST_BYTES, read_bounded},
    package::GarmentPackage,
};
use serde_json::Value;

use super::{
    super::{
        args::{DrapeArgs, stem_of},
        outputs::files_in,
        sink::CacheFile,
    },
    Problem,
};
use crate::output;

/// The files of a job, as far as its arguments tell.
#[derive(Debug, Default)]
pub(super) struct Files {
    inputs: Vec<PathBuf>,
    outputs: Vec<PathBuf>,
    /// Folders that frames of a motion go to, with what is before their number.
    frames: Vec<(PathBuf, String)>,
}

impl Files {
    pub(super) fn of(args: &DrapeArgs) -> Self {
        let input = &args.input;
        let is_package = |path: &&PathBuf| GarmentPackage::is_at(path);
        let garment = input.garment.iter().filter(is_package);
        let over = input.bodies.iter().take_while(is_package).count();
        let over = if garment.clone().next().is_some() {
            over
        } else {
            0
        };
        let (over, bodies) = input.bodies.split_at(over);
        let pose = input.pose.as_ref().map(|pose| &pose.path);
        let mut files = Self::default();
        if over.is_empty() {
            files.write(&args.output, bodies, args);
        } else {
            let garments = garment.chain(over).map(|package| stem_of(package));
            let outputs = garments.map(|name| output::name_in(&args.output, &name));
            files.outputs.extend(outputs);
        }
        if let Some(path) = &args.body_out {
            files.write(path, bodies, args);
        }
        let report = args.report.iter().filter(|path| path.as_os_str() != "-");
        let beside = report.chain(&args.hide).chain(&args.view);
        files
            .outputs
            .extend(beside.chain(&args.export_inputs).cloned());
        let joints = input.rig_args.clone().options().joints;
        let named = (input.garment.iter().chain(&input.bodies))
            .chain(&input.scene)
            .chain(&input.rig)
            .chain(&input.rest_body)
            .chain(pose)
            .chain(&joints);
        files.inputs.extend(named.cloned());
        let rigs = bodies.iter().chain(&input.rest_body);
        files.inputs.extend(rigs.map(|body| rig_beside(body)));
        files
    }

    /// Adds what goes to a path that was named for drapes or bodies.
    fn write(&mut self, path: &Path, bodies: &[PathBuf], args: &DrapeArgs) {
        let pose = args.input.pose.as_ref().map(|pose| &pose.path);
        if CacheFile::of(path).is_some() {
            self.outputs.push(path.to_path_buf());
        } else if let (true, Some(pose)) = (args.input.is_motion(), pose) {
            let name = pose.file_stem().unwrap_or(pose.as_os_str());
            let name = name.to_string_lossy().into_owned();
            self.frames.push((path.to_path_buf(), name));
        } else if bodies.len() > 1 {
            let names = bodies.iter().map(|body| output::name_in(path, body));
            self.outputs.extend(names);
        } else if output::names_folder(path) {
            let stem = bodies.first().or(pose).or(args.input.scene.as_ref());
            let stem = stem.cloned().unwrap_or_default();
            self.outputs.push(output::name_in(path, &stem));
        } else {
            self.outputs.push(path.to_path_buf());
        }
    }
}

/// The first job, by its number from 0, that writes the list itself, or what it or another one
/// reads or writes.
pub(super) fn first_meeting(
    list: &Path,
    names: &[String],
    jobs: &[Files],
) -> Option<(usize, Problem)> {
    const OTHER: &str = "write into another file, or do what goes on from it in a list of its own";
    const OWN: &str = "give each job an output of its own";
    let list = output::place_of(list);
    let readers = readers(jobs);
    let mut writers: BTreeMap<PathBuf, usize> = BTreeMap::new();
    let mut motions: BTreeMap<(PathBuf, String), usize> = BTreeMap::new();
    let too = |other: usize, job: usize, shown: &dyn Display| {
        if other == job {
            format!("two of its outputs are `{shown}`")
        } else {
            format!("{} has the output `{shown}`, too", names[other])
        }
    };
    for (job, files) in jobs.iter().enumerate() {
        for path in &files.outputs {
            let (place, shown) = (output::place_of(path), path.display());
            if place == list {
                let cause = format!("its output `{shown}` is the list of jobs");
                return Some((job, Problem::new(cause, "write into another file")));
            }
            if let Some(&reader) = readers.get(&place) {
                let cause = format!("its output `{shown}` is read by {}", names[reader]);
                return Some((job, Problem::new(cause, OTHER)));
            }
            if let Some(other) = writers.insert(place, job) {
                return Some((job, Problem::new(too(other, job, &shown), OWN)));
            }
        }
        for (folder, name) in &files.frames {
            let place = (output::place_of(folder), name.clone());
            if let Some(other) = motions.insert(place, job) {
                let shown = folder.display();
                return Some((job, Problem::new(too(other, job, &shown), OWN)));
            }
        }
    }
    let met = |(place, &other): (&PathBuf, &usize)| {
        let job = motions
            .get(&frame_of(place)?)
            .filter(|job| **job != other)?;
        let cause = format!(
            "`{}` of {} has the name of one of its frames",
            place.display(),
            names[other]
        );
        Some((
            *job,
            Problem::new(cause, "name another folder with `output`"),
        ))
    };
    readers.iter().chain(&writers).find_map(met)
}

/// The places that are read, each with the first job that reads it.
fn readers(jobs: &[Files]) -> BTreeMap<PathBuf, usize> {
    let mut readers = BTreeMap::new();
    let mut known: BTreeMap<&Path, Vec<PathBuf>> = BTreeMap::new();
    for (job, files) in jobs.iter().enumerate() {
        for path in &files.inputs {
            let named = known.entry(path).or_insert_with(|| named_by(path));
            for path in std::iter::once(path).chain(named.iter()) {
                readers.entry(output::place_of(path)).or_insert(job);
            }
        }
    }
    readers
}

/// The files of a package, or those that a scene, a rig or a glTF names; what cannot be read is
/// told when its job is done.
fn named_by(path: &Path) -> Vec<PathBuf> {
    if GarmentPackage::is_at(path) {
        return files_in(path).unwrap_or_default();
    }
    let kind = path
        .extension()
        .and_then(OsStr::to_str)
        .map(str::to_lowercase);
    let mut named = Vec::new();
    if let (Some("json" | "gltf"), Some(folder)) = (kind.as_deref(), path.parent()) {
        let bytes = read_bounded(path, MOST_BYTES).unwrap_or_default();
        let value = serde_json::from_slice(&bytes).unwrap_or_default();
        add_files(&value, folder, &mut named);
    }
    named
}

/// Adds the files beside a document that its texts name.
fn add_files(value: &Value, folder: &Path, named: &mut Vec<PathBuf>) {
    match value {
        Value::String(text) => {
            let path = folder.join(text);
            if path.is_file() {
                named.push(path);
            }
        }
        Value::Array(values) => values
            .iter()
            .for_each(|value| add_files(value, folder, named)),
        Value::Object(values) => values
            .values()
            .for_each(|value| add_files(value, folder, named)),
        Value::Null | Value::Bool(_) | Value::Number(_) => {}
    }
}

/// The folder of a file that has the name of a frame, `NAME_0000.obj`, and that name.
fn frame_of(place: &Path) -> Option<(PathBuf, String)> {
    let name = place.file_name()?.to_str()?.strip_suffix(".obj")?;
    let (name, number) = name.rsplit_once('_')?;
    let is_number = number.len() >= 4 && number.bytes().all(|digit| digit.is_ascii_digit());
    is_number.then(|| {
        (
            place.parent().unwrap_or(place).to_path_buf(),
            name.to_owned(),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_frames_are_told_from_others() {
        let place = |folder: &str, name: &str| Some((PathBuf::from(folder), name.to_owned()));
        assert_eq!(frame_of(Path::new("/a/walk_0012.obj")), place("/a", "walk"));
        assert_eq!(frame_of(Path::new("/a/a_b_12345.obj")), place("/a", "a_b"));
        for other in [
            "/a/walk.obj",
            "/a/walk_12.obj",
            "/a/walk_0012.glb",
            "/a/walk_00x2.obj",
        ] {
            assert_eq!(frame_of(Path::new(other)), None, "{other}");
        }
    }
}
