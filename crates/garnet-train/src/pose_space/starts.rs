//! How a deformation would have told each scene of the training without its body and sequence.
//!
//! A file beside the training of the deformation: networks that start from it learn from that, and
//! need it no more once they are trained.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use garnet_mesh::{Fingerprint, MOST_BYTES, read_bounded, write_atomically};
use garnet_net::PoseSpace;
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};
use serde::{Deserialize, Serialize};

use crate::{SceneName, TrainError};

/// What this version writes and reads.
const SCHEMA: &str = "garnet.starts/1";

/// The metadata key of the JSON text.
const KEY: &str = "garnet";

/// The shares of each scene of the training.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Starts {
    /// Checksum of the deformation.
    pose_space: String,
    /// The share of each shape, in metres, by body and pose.
    shares: BTreeMap<(u32, u32), Vec<f32>>,
}

/// What a file says about itself.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    schema: String,
    pose_space: String,
    /// Of the deformation's checksum and of the numbers.
    checksum: String,
}

/// The file in the folder of a training.
fn file(folder: &Path) -> PathBuf {
    folder.join("starts.safetensors")
}

impl Starts {
    /// Of a deformation that was saved; there are as many rows as scenes, or none.
    pub(super) fn of(space: &PoseSpace, scenes: &[SceneName], left_out: &[Vec<f32>]) -> Self {
        let rows = scenes.iter().zip(left_out);
        Self {
            pose_space: space.checksum().to_owned(),
            shares: rows
                .map(|(scene, shares)| ((scene.body, scene.pose), shares.clone()))
                .collect(),
        }
    }

    /// Of a scene, if it is known.
    pub(super) fn of_scene(&self, scene: SceneName) -> Option<&[f32]> {
        (self.shares.get(&(scene.body, scene.pose))).map(Vec::as_slice)
    }

    /// Writes the file; without scenes, removes that of another fit.
    pub(super) fn save(&self, folder: &Path) -> Result<(), TrainError> {
        let path = file(folder);
        if self.shares.is_empty() {
            return match std::fs::remove_file(&path) {
                Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                    Err(TrainError::folder(&path, source))
                }
                _ => Ok(()),
            };
        }
        std::fs::create_dir_all(folder).map_err(|source| TrainError::folder(folder, source))?;
        let numbers = self.shares.keys().flat_map(|&(body, pose)| [body, pose]);
        let scenes: Vec<u8> = numbers.flat_map(u32::to_le_bytes).collect();
        let numbers = self.shares.values().flatten();
        let shares: Vec<u8> = numbers.flat_map(|number| number.to_le_bytes()).collect();
        let header = Header {
            schema: SCHEMA.to_owned(),
            pose_space: self.pose_space.clone(),
            checksum: checksum(&self.pose_space, &scenes, &shares),
        };
        let unsound = |reason: String| unsound(&path, reason);
        let count = self.shares.len();
        let num_shares = shares.len() / (4 * count);
        let view = |dtype, columns, bytes| {
            TensorView::new(dtype, vec![count, columns], bytes)
                .map_err(|error| unsound(error.to_string()))
        };
        let views = [
            ("scenes", view(Dtype::U32, 2, &scenes)?),
            ("shares", view(Dtype::F32, num_shares, &shares)?),
        ];
        let text = serde_json::to_string(&header).map_err(|error| unsound(error.to_string()))?;
        let metadata = HashMap::from([(KEY.to_owned(), text)]);
        let bytes = safetensors::serialize(views, Some(metadata));
        let bytes = bytes.map_err(|error| unsound(error.to_string()))?;
        Ok(write_atomically(&path, |writer| writer.write_all(&bytes))?)
    }

    /// Reads those of a deformation; none if there are none, or those of another fit.
    ///
    /// # Errors
    ///
    /// [`TrainError::Read`], or [`TrainError::Starts`] for a damaged file.
    pub(super) fn load(folder: &Path, space: &PoseSpace) -> Result<Option<Self>, TrainError> {
        let path = file(folder);
        if !path.is_file() {
            return Ok(None);
        }
        let bytes = read_bounded(&path, MOST_BYTES).map_err(|source| TrainError::Read {
            path: path.clone(),
            source,
        })?;
        let found = Self::from_bytes(&bytes).map_err(|reason| unsound(&path, reason))?;
        let is_whole = |shares: &Vec<f32>| shares.len() == space.num_shapes();
        if found.pose_space != space.checksum() {
            return Ok(None);
        }
        if !found.shares.values().all(is_whole) {
            let expected = space.num_shapes();
            return Err(unsound(&path, format!("a scene has not {expected} shares")));
        }
        Ok(Some(found))
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(|error| error.to_string())?;
        let text = metadata.metadata().as_ref().and_then(|map| map.get(KEY));
        let text = text.ok_or_else(|| format!("it has no `{KEY}` in its metadata"))?;
        let header: Header = serde_json::from_str(text).map_err(|error| error.to_string())?;
        if header.schema != SCHEMA {
            return Err(format!("its schema is `{}`, not `{SCHEMA}`", header.schema));
        }
        let tensors = SafeTensors::deserialize(bytes).map_err(|error| error.to_string())?;
        let part = |name: &str, dtype| {
            let view = tensors.tensor(name).map_err(|error| error.to_string())?;
            match (view.dtype() == dtype, view.shape()) {
                (true, &[rows, columns]) => Ok((view, rows, columns)),
                _ => Err(format!("`{name}` is no table of its numbers")),
            }
        };
        let (scenes, num_scenes, pair) = part("scenes", Dtype::U32)?;
        let (shares, num_rows, num_shares) = part("shares", Dtype::F32)?;
        if (num_rows, pair) != (num_scenes, 2) {
            return Err(format!("it has {num_rows} rows for {num_scenes} scenes"));
        }
        let found = checksum(&header.pose_space, scenes.data(), shares.data());
        if found != header.checksum {
            let expected = header.checksum;
            return Err(format!(
                "its checksum is {found}, and was {expected} when it was written"
            ));
        }
        let mut numbers = scenes.data().as_chunks().0.iter().copied();
        let mut next = || numbers.next().map(u32::from_le_bytes);
        let rows = shares.data().chunks_exact(4 * num_shares.max(1));
        let mut all = BTreeMap::new();
        for row in rows {
            let (Some(body), Some(pose)) = (next(), next()) else {
                break;
            };
            let row: Vec<f32> = (row.as_chunks().0.iter().copied())
                .map(f32::from_le_bytes)
                .collect();
            if !row.iter().all(|number| number.is_finite()) {
                return Err(format!(
                    "pose {pose} of body {body} has a share that is none"
                ));
            }
            all.insert((body, pose), row);
        }
        Ok(Self {
            pose_space: header.pose_space,
            shares: all,
        })
    }
}

fn unsound(path: &Path, reason: String) -> TrainError {
    TrainError::Starts {
        path: path.to_path_buf(),
        reason,
    }
}

fn checksum(pose_space: &str, scenes: &[u8], shares: &[u8]) -> String {
    let sums = [scenes, shares].map(|part| Fingerprint::of_bytes(part).to_string());
    Fingerprint::of_bytes((pose_space.to_owned() + &sums.concat()).as_bytes()).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_come_back_and_damaged_ones_do_not() {
        let folder = tempfile::tempdir().unwrap();
        let starts = Starts {
            pose_space: "abc".to_owned(),
            shares: BTreeMap::from([((0, 1), vec![0.5, -0.25]), ((3, 0), vec![1.5, 2.0])]),
        };
        starts.save(folder.path()).unwrap();
        let whole = std::fs::read(file(folder.path())).unwrap();
        assert_eq!(Starts::from_bytes(&whole).unwrap(), starts);
        for bit in (0..8 * whole.len()).step_by(7) {
            let mut damaged = whole.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            let found = Starts::from_bytes(&damaged);
            // Spaces that pad the text may be others.
            assert!(found.is_err() || found == Ok(starts.clone()), "bit {bit}");
        }
        for length in 0..whole.len() {
            assert!(Starts::from_bytes(&whole[..length]).is_err(), "{length}");
        }
        let none = Starts {
            shares: BTreeMap::new(),
            ..starts
        };
        none.save(folder.path()).unwrap();
        assert!(!file(folder.path()).exists());
        none.save(folder.path()).unwrap();
    }
}
