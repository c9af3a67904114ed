//! Drapes of the same scenes by several methods, beside the simulator's.
//!
//! A folder has for each scene `NAME.body.obj`, `NAME.simulated.obj` and `NAME.METHOD.obj`. Told
//! are the mean distance of vertices, the mean angle of face normals and `L_RQ` (*Gundogdu et al.
//! 2020, Eqs. 13, 17, 18*) of each method over the scenes, the last as the sum over 8, 16 and 32
//! neighbors.

use std::{
    collections::BTreeMap,
    error::Error,
    fs,
    path::{Path, PathBuf},
};

use clap::Args;
use garnet::io::ObjFile;
use garnet_mesh::{TriMesh, normal_angles, vertex_distances};
use garnet_net::losses::{LossBody, LossConfig, Losses, Term};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::Outcome;

/// The name of the simulator's drape in a folder.
const SIMULATED: &str = "simulated";

/// What to compare.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The drapes.
    folder: PathBuf,
    /// What the drapes are of, for the tables.
    #[arg(long)]
    garment: String,
    /// Write the means as JSON.
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
}

/// Means over the scenes of a folder: `garnet.compare/1`, SI units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Comparison {
    pub(crate) schema: String,
    pub(crate) garment: String,
    pub(crate) scenes: usize,
    pub(crate) methods: Vec<Compared>,
}

/// The schema of such a file.
pub(crate) const SCHEMA: &str = "garnet.compare/1";

/// The means of a method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Compared {
    pub(crate) name: String,
    /// Scenes that it has a drape of.
    pub(crate) scenes: usize,
    /// `E_dist`, in metres.
    pub(crate) distance: f64,
    /// `E_norm`, in radians.
    pub(crate) normal: f64,
    /// `L_RQ`.
    pub(crate) rayleigh: f64,
    /// The largest `E_dist` of a scene, in metres.
    pub(crate) worst: f64,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let comparison = compared(&arguments.folder, &arguments.garment)?;
    println!("{} scenes", comparison.scenes);
    println!(
        "{:<16}{:>12}{:>12}{:>12}{:>12}",
        "", "E_dist mm", "E_norm °", "L_RQ", "worst mm"
    );
    for method in &comparison.methods {
        println!(
            "{:<16}{:>12.2}{:>12.2}{:>12.2e}{:>12.2}",
            method.name,
            1e3 * method.distance,
            method.normal.to_degrees(),
            method.rayleigh,
            1e3 * method.worst
        );
    }
    if let Some(path) = &arguments.report {
        fs::write(path, serde_json::to_string_pretty(&comparison)? + "\n")?;
    }
    Ok(())
}

/// The methods of each scene of a folder.
fn scenes_of(folder: &Path) -> Result<BTreeMap<String, Vec<String>>, Box<dyn Error>> {
    let mut scenes: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        let Some((scene, method)) = name
            .strip_suffix(".obj")
            .and_then(|name| name.split_once('.'))
        else {
            continue;
        };
        let methods = scenes.entry(scene.to_owned()).or_default();
        if method != "body" && method != SIMULATED {
            methods.push(method.to_owned());
        }
    }
    Ok(scenes)
}

fn compared(folder: &Path, garment: &str) -> Result<Comparison, Box<dyn Error>> {
    let scenes = scenes_of(folder)?;
    if scenes.is_empty() {
        return Err(format!("`{}` has no `NAME.METHOD.obj`", folder.display()).into());
    }
    let scores = scenes.par_iter().map(|(scene, methods)| {
        scores(folder, scene, methods).map_err(|error| format!("`{scene}`: {error}"))
    });
    let scores: Vec<_> = scores.collect::<Result<_, String>>()?;
    let mut of_method: BTreeMap<String, Vec<[f64; 3]>> = BTreeMap::new();
    for (name, score) in scores.into_iter().flatten() {
        of_method.entry(name).or_default().push(score);
    }
    let methods = of_method.into_iter().map(|(name, scores)| {
        let mean = |number: usize| {
            scores.iter().map(|score| score[number]).sum::<f64>() / scores.len() as f64
        };
        let worst = scores.iter().map(|score| score[0]).fold(0.0, f64::max);
        let [distance, normal, rayleigh] = [mean(0), mean(1), mean(2)];
        let scenes = scores.len();
        Compared {
            name,
            scenes,
            distance,
            normal,
            rayleigh,
            worst,
        }
    });
    Ok(Comparison {
        schema: SCHEMA.to_owned(),
        garment: garment.to_owned(),
        scenes: scenes.len(),
        methods: methods.collect(),
    })
}

/// A method, its distance, angle and `L_RQ`.
type Score = (String, [f64; 3]);

/// What goes wrong on a thread.
type Failed = Box<dyn Error + Send + Sync>;

/// The methods of a scene.
fn scores(folder: &Path, scene: &str, methods: &[String]) -> Result<Vec<Score>, Failed> {
    let mesh = |name: &str| -> Result<TriMesh, Failed> {
        let file = ObjFile::read(folder.join(format!("{scene}.{name}.obj")))?;
        Ok(file.mesh()?)
    };
    let simulated = mesh(SIMULATED)?;
    let losses = Losses::new(&simulated, &LossConfig::paper())?;
    let target = losses.target(simulated.positions())?;
    let body = LossBody::new(&mesh("body")?)?;
    let mean =
        |values: &[f32]| values.iter().copied().map(f64::from).sum::<f64>() / values.len() as f64;
    let score = |method: &String| -> Result<_, Failed> {
        let drape = mesh(method)?;
        let (reference, predicted) = (simulated.positions(), drape.positions());
        let distance = mean(&vertex_distances(reference, predicted)?);
        let normal = mean(&normal_angles(simulated.faces(), reference, predicted)?);
        let report = losses.measure(predicted, &target, &body)?;
        let terms = [Term::Rayleigh8, Term::Rayleigh16, Term::Rayleigh32];
        let rayleigh = terms
            .into_iter()
            .filter_map(|term| report.value(term))
            .sum();
        Ok((method.clone(), [distance, normal, rayleigh]))
    };
    methods.iter().map(score).collect()
}

#[cfg(test)]
mod tests {
    use garnet::io;
    use garnet_mesh::{Vector3, primitives::uv_sphere};

    use super::*;

    #[test]
    fn a_drape_beside_itself_and_one_that_is_moved() {
        let folder = tempfile::tempdir().unwrap();
        let sphere = uv_sphere(16, 12, 0.2);
        let moved = sphere.positions().iter();
        let moved = moved.map(|place| place + Vector3::new(0.0, 0.003, 0.0));
        let moved = sphere.with_positions(moved.collect()).unwrap();
        for (name, mesh) in [
            ("body", &sphere),
            ("simulated", &sphere),
            ("same", &sphere),
            ("moved", &moved),
        ] {
            io::write_obj(folder.path().join(format!("one.{name}.obj")), mesh).unwrap();
        }
        let found = compared(folder.path(), "ball").unwrap();
        assert_eq!(found.scenes, 1);
        let [moved, same] = &found.methods[..] else {
            panic!("{found:?}");
        };
        assert_eq!((same.name.as_str(), same.distance), ("same", 0.0));
        assert!((moved.distance - 0.003).abs() < 1e-6, "{moved:?}");
        assert!(moved.normal < 1e-3 && moved.rayleigh < 1e-6, "{moved:?}");
        fs::remove_file(folder.path().join("one.simulated.obj")).unwrap();
        assert!(compared(folder.path(), "ball").is_err());
    }
}
