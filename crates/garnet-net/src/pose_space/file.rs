//! The file of a pose-space deformation.

use std::collections::BTreeMap;
use std::path::Path;

use garnet_mesh::write_atomically;
use safetensors::SafeTensors;
use safetensors::tensor::TensorView;
use serde::{Deserialize, Serialize};

use super::{Aim, Mirror, PoseSpace, PoseSpaceParts};
use crate::weight_file::{self, Header, not_safetensors};
use crate::{CheckpointError, Precision, TrainedRange, UNIT};

/// The schema that this version reads and writes.
pub(crate) const SCHEMA: &str = "garnet-pose-space/2";

/// What the file of a pose-space deformation says about itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PoseSpaceHeader {
    /// The version of the file.
    pub schema: String,
    /// The garment, as [`Fingerprint`](garnet_mesh::Fingerprint) writes it.
    pub garment: String,
    /// The length unit of networks that start from it, in metres; offsets are in metres.
    pub unit: f32,
    /// Checksum of this text without it, and of names and numbers.
    pub checksum: String,
    /// The poses and shapes that it was fitted to.
    pub range: TrainedRange,
    /// What it tells.
    #[serde(default, skip_serializing_if = "Aim::is_rest")]
    pub aim: Aim,
    /// See [`PoseSpace::ridge`].
    pub ridge: f64,
    /// How it was fitted.
    pub record: serde_json::Value,
    /// Scores by name.
    pub scores: BTreeMap<String, f64>,
}

/// Names of the tensors of a [`Mirror`].
const MIRROR: &str = "mirror";
const PARITY: &str = "parity";

impl Header for PoseSpaceHeader {
    const SCHEMA: &'static str = SCHEMA;

    fn checksum(&mut self) -> &mut String {
        &mut self.checksum
    }

    fn unit(&self) -> f32 {
        self.unit
    }
}

impl PoseSpace {
    /// The bytes of the file `path`; the checksum is known from then on.
    ///
    /// # Errors
    ///
    /// [`CheckpointError::NotFinite`] for numbers that are none.
    pub fn to_bytes(
        &mut self,
        path: &Path,
        precision: Precision,
    ) -> Result<Vec<u8>, CheckpointError> {
        let parts = &self.parts;
        let num_scenes = parts.centers.len() / self.kept.len().max(1);
        let (num_shapes, num_vertices) = (self.num_shapes(), self.num_vertices());
        // Large weights cancel each other: rounded to halves they would move a drape by centimetres.
        let single = Precision::F32;
        let mut tensors = vec![
            ("scales", vec![parts.scales.len()], &parts.scales, single),
            (
                "centers",
                vec![num_scenes, self.kept.len()],
                &parts.centers,
                precision,
            ),
            (
                "weights",
                vec![num_scenes, num_shapes],
                &parts.weights,
                single,
            ),
            ("mean", vec![num_vertices, 3], &parts.mean, single),
            (
                "shapes",
                vec![num_shapes, num_vertices, 3],
                &parts.shapes,
                precision,
            ),
        ];
        let (numbers, parity);
        if let Some(mirror) = &parts.mirror {
            let pairs = mirror.numbers.iter();
            numbers = pairs
                .flat_map(|&(number, sign)| [number as f32, sign])
                .collect();
            parity = mirror.parity.clone();
            tensors.push((MIRROR, vec![mirror.numbers.len(), 2], &numbers, single));
            tensors.push((PARITY, vec![num_shapes], &parity, single));
        }
        let stored: Vec<_> = (tensors.into_iter())
            .map(|(name, shape, numbers, precision)| {
                (name, shape, precision.dtype(), precision.stored(numbers))
            })
            .collect();
        let mut views = Vec::with_capacity(stored.len());
        for (name, shape, dtype, bytes) in &stored {
            let view = TensorView::new(*dtype, shape.clone(), bytes);
            views.push((*name, view.map_err(|source| not_safetensors(path, source))?));
        }
        let mut header = PoseSpaceHeader {
            schema: SCHEMA.to_owned(),
            garment: self.garment.to_string(),
            unit: UNIT,
            checksum: String::new(),
            range: self.range.clone(),
            aim: self.aim,
            ridge: self.ridge,
            record: self.record.clone(),
            scores: self.scores.clone(),
        };
        let bytes = weight_file::to_bytes(path, &mut header, views)?;
        self.checksum = header.checksum;
        Ok(bytes)
    }

    /// Writes the file in one piece: an error leaves an old one as it was.
    ///
    /// # Errors
    ///
    /// As [`PoseSpace::to_bytes`], or what the system says.
    pub fn save(&mut self, path: &Path, precision: Precision) -> Result<(), CheckpointError> {
        let bytes = self.to_bytes(path, precision)?;
        Ok(write_atomically(path, |writer| writer.write_all(&bytes))?)
    }

    /// Reads a file.
    ///
    /// # Errors
    ///
    /// [`CheckpointError`] by name for a file that is truncated, altered, foreign, or of another version.
    pub fn load(path: &Path) -> Result<Self, CheckpointError> {
        Self::from_bytes(path, &weight_file::read(path)?)
    }

    /// Reads the bytes of the file `path`.
    ///
    /// # Errors
    ///
    /// As [`PoseSpace::load`].
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Self, CheckpointError> {
        let (header, tensors) = weight_file::checked::<PoseSpaceHeader>(path, bytes)?;
        let garment = weight_file::fingerprint(path, &header.garment)?;
        let part = |name| part(path, &tensors, name);
        let mirror = match tensors.tensor(MIRROR) {
            Err(_) => None,
            Ok(_) => Some(Mirror {
                // The checksum holds these; one beyond the last is refused with the other counts.
                numbers: (part(MIRROR)?.as_chunks::<2>().0.iter())
                    .map(|&[number, sign]| (number as usize, sign))
                    .collect(),
                parity: part(PARITY)?,
            }),
        };
        let parts = PoseSpaceParts {
            scales: part("scales")?,
            centers: part("centers")?,
            weights: part("weights")?,
            mean: part("mean")?,
            shapes: part("shapes")?,
            mirror,
        };
        let space = Self::new(parts, garment, header.range, header.ridge);
        let space = space.map_err(|source| CheckpointError::Config {
            path: path.to_path_buf(),
            source,
        })?;
        Ok(Self {
            aim: header.aim,
            record: header.record,
            scores: header.scores,
            checksum: header.checksum,
            ..space
        })
    }
}

fn part(path: &Path, tensors: &SafeTensors<'_>, name: &str) -> Result<Vec<f32>, CheckpointError> {
    let view = tensors.tensor(name).ok();
    let numbers = view.and_then(|view| weight_file::numbers(&view));
    numbers.ok_or_else(|| CheckpointError::Tensor {
        path: path.to_path_buf(),
        name: name.to_owned(),
        found: "missing".to_owned(),
        expected: "one".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::small;
    use super::*;

    #[test]
    fn a_file_comes_back_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pose-space.safetensors");
        let mut space = small();
        space.scores.insert("test.distance_m".to_owned(), 0.01);
        space.save(&path, Precision::F16).unwrap();
        assert_eq!(PoseSpace::load(&path).unwrap(), space);
        space.aim = Aim::Arrival;
        space.parts.mirror = Some(Mirror {
            numbers: vec![(0, -1.0), (1, 1.0)],
            parity: vec![-1.0],
        });
        space.save(&path, Precision::F16).unwrap();
        assert_eq!(PoseSpace::load(&path).unwrap(), space);
        assert!(!space.checksum().is_empty());

        let mut bytes = std::fs::read(&path).unwrap();
        let last = bytes.len() - 1;
        bytes[last] ^= 1;
        let altered = PoseSpace::from_bytes(&path, &bytes);
        assert!(matches!(altered, Err(CheckpointError::Altered { .. })));
        let short = PoseSpace::from_bytes(&path, &bytes[..last]);
        assert!(matches!(short, Err(CheckpointError::NotSafetensors { .. })));
        let network = crate::Checkpoint::header(&path);
        assert!(matches!(network, Err(CheckpointError::Schema { .. })));
    }
}
