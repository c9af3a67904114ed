//! What can be wrong with a list of scenes made elsewhere, before a mesh is read.

use std::{
    collections::BTreeMap,
    path::{Component, Path, PathBuf},
};

use garnet_mesh::{Unit, UnitError};

use super::{ImportManifest, Split};

/// What is wrong with a list of scenes made elsewhere. Scenes are numbered from 1.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ImportProblem {
    /// There are none.
    #[error("it lists no scenes")]
    NoScenes,
    /// The unit is none.
    #[error("`units`: {0}")]
    Unit(#[from] UnitError),
    /// A scene is listed twice, under whatever name.
    #[error("scene {} has the meshes of scene {}: `{}` and `{}`", scenes[1], scenes[0], body_mesh.display(), garment_mesh.display())]
    Repeated {
        /// Both places in the list.
        scenes: [usize; 2],
        /// Their body.
        body_mesh: PathBuf,
        /// Their garment.
        garment_mesh: PathBuf,
    },
    /// Models would be judged by a body that they have learned from.
    #[error("the body `{body}` is in `{}` by scene {} and in `{}` by scene {}", splits[0].name(), scenes[0], splits[1].name(), scenes[1])]
    BodyInTwoSplits {
        /// Its name.
        body: String,
        /// The splits.
        splits: [Split; 2],
        /// A scene in each.
        scenes: [usize; 2],
    },
    /// Models would be judged by poses that they have learned from.
    #[error("the sequence `{sequence}` is in `{}` by scene {} and in `{}` by scene {}", splits[0].name(), scenes[0], splits[1].name(), scenes[1])]
    SequenceInTwoSplits {
        /// Its name.
        sequence: String,
        /// The splits.
        splits: [Split; 2],
        /// A scene in each.
        scenes: [usize; 2],
    },
}

/// Names, and the scene and split in which each was met first.
type FirstMet<'a> = BTreeMap<&'a str, (usize, Split)>;

impl ImportManifest {
    /// Checks all that the list itself tells, and gives the unit of its meshes.
    ///
    /// # Errors
    ///
    /// [`ImportProblem`], the first one.
    pub fn check(&self) -> Result<Unit, ImportProblem> {
        let unit = self.units.parse()?;
        if self.scenes.is_empty() {
            return Err(ImportProblem::NoScenes);
        }
        let mut meshes: BTreeMap<(PathBuf, PathBuf), usize> = BTreeMap::new();
        let (mut bodies, mut sequences) = (FirstMet::new(), FirstMet::new());
        for (number, scene) in (1..).zip(&self.scenes) {
            let pair = (plain(&scene.body_mesh), plain(&scene.garment_mesh));
            if let Some(&first) = meshes.get(&pair) {
                return Err(ImportProblem::Repeated {
                    scenes: [first, number],
                    body_mesh: scene.body_mesh.clone(),
                    garment_mesh: scene.garment_mesh.clone(),
                });
            }
            meshes.insert(pair, number);
            let split = scene.split;
            let other = |(first, other): (usize, Split)| {
                (other != split).then_some(([other, split], [first, number]))
            };
            let body = *bodies.entry(&scene.body).or_insert((number, split));
            if let Some((splits, scenes)) = other(body) {
                return Err(ImportProblem::BodyInTwoSplits {
                    body: scene.body.clone(),
                    splits,
                    scenes,
                });
            }
            if scene.sequence.is_empty() {
                continue;
            }
            let sequence = sequences.entry(&scene.sequence).or_insert((number, split));
            if let Some((splits, scenes)) = other(*sequence) {
                return Err(ImportProblem::SequenceInTwoSplits {
                    sequence: scene.sequence.clone(),
                    splits,
                    scenes,
                });
            }
        }
        Ok(unit)
    }
}

/// A path without steps that stay where they are.
fn plain(path: &Path) -> PathBuf {
    let parts = path.components();
    parts.filter(|part| *part != Component::CurDir).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ImportScene;

    fn scene(split: Split, body: &str, sequence: &str, mesh: &str) -> ImportScene {
        ImportScene {
            split,
            body: body.to_owned(),
            sequence: sequence.to_owned(),
            body_mesh: format!("{mesh}_body.obj").into(),
            garment_mesh: format!("{mesh}_garment.obj").into(),
            parameters: BTreeMap::new(),
        }
    }

    fn problem(scenes: Vec<ImportScene>) -> String {
        let manifest = ImportManifest {
            schema: "garnet.import/1".to_owned(),
            units: "m".to_owned(),
            scenes,
        };
        manifest.check().unwrap_err().to_string()
    }

    #[test]
    fn a_list_without_scenes_or_with_another_unit_is_refused() {
        assert_eq!(problem(Vec::new()), "it lists no scenes");
        let manifest = ImportManifest {
            schema: "garnet.import/1".to_owned(),
            units: "inch".to_owned(),
            scenes: Vec::new(),
        };
        let error = manifest.check().unwrap_err();
        assert!(error.to_string().contains("`units`: `inch`"), "{error}");
    }

    #[test]
    fn bodies_and_sequences_are_in_one_split() {
        let first = scene(Split::Train, "a", "walk", "1");
        let same_split = scene(Split::Train, "a", "walk", "2");
        let body = scene(Split::Test, "a", "run", "3");
        let error = problem(vec![first.clone(), same_split.clone(), body]);
        assert_eq!(
            error,
            "the body `a` is in `train` by scene 1 and in `test` by scene 3"
        );
        let sequence = scene(Split::Valid, "b", "walk", "3");
        let error = problem(vec![first.clone(), same_split, sequence]);
        assert_eq!(
            error,
            "the sequence `walk` is in `train` by scene 1 and in `valid` by scene 3"
        );
        let unnamed = [
            scene(Split::Train, "a", "", "1"),
            scene(Split::Test, "b", "", "2"),
        ];
        let manifest = ImportManifest {
            schema: "garnet.import/1".to_owned(),
            units: "mm".to_owned(),
            scenes: unnamed.into(),
        };
        assert_eq!(manifest.check(), Ok(Unit::Millimetre));
    }

    #[test]
    fn a_scene_is_listed_once_whatever_its_names() {
        let first = scene(Split::Train, "a", "walk", "1");
        let again = scene(Split::Test, "b", "run", "./1");
        let error = problem(vec![first, again]);
        assert!(
            error.starts_with("scene 2 has the meshes of scene 1"),
            "{error}"
        );
    }
}
