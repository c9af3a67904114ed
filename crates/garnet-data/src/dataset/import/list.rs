//! The scenes of a list in the order of a data set.

use std::{collections::BTreeMap, path::Path};

use garnet_mesh::Fingerprint;

use super::{BODIES_PER_SHARD, ImportManifest, SceneRecord, Split, meshes::Reader};
use crate::DataError;

/// The scenes of a list, and what reads them.
pub(super) struct List<'a> {
    manifest: &'a ImportManifest,
    /// The list, for messages.
    path: &'a Path,
    reader: Reader<'a>,
    /// All scenes, by split, body and pose.
    pub(super) places: Vec<Place>,
}

/// Where a scene is in the data set, and where in the list.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) split: Split,
    /// Number of the body in its split.
    pub(super) body: u32,
    /// Number of the scene on the body.
    pub(super) pose: u32,
    /// Place in the list, from 0.
    pub(super) index: usize,
}

impl Place {
    /// The split and the number of its shard.
    pub(super) const fn shard(&self) -> (Split, u32) {
        (self.split, self.body / BODIES_PER_SHARD)
    }
}

impl<'a> List<'a> {
    pub(super) fn new(manifest: &'a ImportManifest, path: &'a Path, reader: Reader<'a>) -> Self {
        let mut places = Vec::with_capacity(manifest.scenes.len());
        for split in Split::ALL {
            for (body, scenes) in (0..).zip(bodies_of(manifest, split).values()) {
                places.extend((0..).zip(scenes).map(|(pose, &index)| Place {
                    split,
                    body,
                    pose,
                    index,
                }));
            }
        }
        Self {
            manifest,
            path,
            reader,
            places,
        }
    }

    /// Reads and checks the meshes of a scene.
    ///
    /// # Errors
    ///
    /// [`DataError::ImportScene`].
    pub(super) fn scene(&self, place: &Place) -> Result<SceneRecord, DataError> {
        let scene = &self.manifest.scenes[place.index];
        let read = self.reader.scene(scene, place.body, place.pose);
        read.map_err(|error| self.failed(place, error))
    }

    /// The error of a scene whose meshes were others at first.
    pub(super) fn changed(&self, place: &Place) -> DataError {
        let scene = &self.manifest.scenes[place.index];
        self.failed(place, self.reader.changed(scene))
    }

    /// What tells an import from others: all that shards take from the list, and the fingerprints
    /// of `meshes`, by place.
    pub(super) fn fingerprint(&self, meshes: &[[Fingerprint; 2]]) -> Fingerprint {
        let pairs = self.places.iter().zip(meshes);
        let entries = pairs.map(|(place, meshes)| {
            let scene = &self.manifest.scenes[place.index];
            let [body_mesh, garment_mesh] = meshes.map(|print| print.to_string());
            let meshes = (body_mesh, garment_mesh);
            let named = (&scene.body, &scene.sequence, &scene.parameters);
            (scene.split, named, meshes)
        });
        let entries: Vec<_> = entries.collect();
        let text = serde_json::to_string(&entries).unwrap_or_default();
        Fingerprint::of_bytes(text.as_bytes())
    }

    fn failed(&self, place: &Place, source: DataError) -> DataError {
        DataError::ImportScene {
            path: self.path.to_path_buf(),
            scene: place.index + 1,
            body: self.manifest.scenes[place.index].body.clone(),
            source: Box::new(source),
        }
    }
}

/// Places in the list of the scenes of each body.
fn bodies_of(manifest: &ImportManifest, split: Split) -> BTreeMap<&str, Vec<usize>> {
    let mut bodies: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, scene) in manifest.scenes.iter().enumerate() {
        if scene.split == split {
            bodies.entry(&scene.body).or_default().push(index);
        }
    }
    bodies
}
