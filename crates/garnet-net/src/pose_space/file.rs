//! The file of a pose-space deformation.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use garnet_mesh::write_atomically;
use garnet_sim::Moment;
use safetensors::SafeTensors;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use super::{
    Exchange, Features, Layer, Mirror, PoseSpace, PoseSpaceParts, Region, RegionMirror, Regions,
    Told,
};
use crate::weight_file::{self, Header};
use crate::{CheckpointError, Precision, TrainedRange, UNIT};

/// The schema of files whose numbers are stored as they are.
const SCHEMA: &str = "garnet-pose-space/2";

/// The schema of files with shapes and weights of 8 bits, which earlier versions do not read.
const PACKED: &str = "garnet-pose-space/3";

/// Whether a schema is that of a pose-space deformation.
pub(crate) fn is_pose_space(schema: &str) -> bool {
    [SCHEMA, PACKED].contains(&schema)
}

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
    /// The moment at which it predicts the cloth.
    #[serde(
        rename = "aim",
        default,
        skip_serializing_if = "Moment::is_rest",
        deserialize_with = "predicted"
    )]
    pub moment: Moment,
    /// See [`PoseSpace::ridge`].
    pub ridge: f64,
    /// What networks of regions are told; none if scenes tell the shares of the shapes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub features: Option<Features>,
    /// How it was fitted.
    pub record: serde_json::Value,
    /// Scores by name.
    pub scores: BTreeMap<String, f64>,
}

/// Refuses the start, which nothing predicts.
fn predicted<'de, D: Deserializer<'de>>(reader: D) -> Result<Moment, D::Error> {
    match Moment::deserialize(reader)? {
        Moment::Start => Err(D::Error::custom("nothing predicts the start")),
        moment => Ok(moment),
    }
}

/// A tensor to be stored: name, shape, numbers, precision.
type Stored<'a> = (String, Vec<usize>, Cow<'a, [f32]>, Precision);

/// Names of the tensors of a [`Mirror`].
const MIRROR: &str = "mirror";
const PARITY: &str = "parity";

/// And of the mirror images of vertices: corners and weights.
const IMAGES: &str = "images";

impl Header for PoseSpaceHeader {
    const SCHEMA: &'static str = SCHEMA;
    const PACKED: &'static str = PACKED;

    fn schema(&mut self) -> &mut String {
        &mut self.schema
    }

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
        let tensors = match &self.told {
            Told::ByScenes(parts) => of_scenes(parts, precision),
            Told::ByRegions(regions) => of_regions(regions, precision),
        };
        let stored: Vec<_> = (tensors.into_iter())
            .flat_map(|(name, shape, numbers, precision)| precision.stored(name, shape, &numbers))
            .collect();
        let mut views = Vec::with_capacity(stored.len());
        for tensor in &stored {
            views.push((tensor.name.as_str(), tensor.view(path)?));
        }
        let mut header = PoseSpaceHeader {
            schema: SCHEMA.to_owned(),
            garment: self.garment.to_string(),
            unit: UNIT,
            checksum: String::new(),
            range: self.range.clone(),
            moment: self.moment,
            ridge: self.ridge,
            features: self.regions().map(|regions| regions.features.clone()),
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

    /// Reads a deformation from its file.
    ///
    /// # Errors
    ///
    /// [`CheckpointError`] by name for a file that is truncated, altered, foreign, or of another
    /// version.
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
        let reading = Reading { path, tensors };
        let space = match header.features {
            None => Self::new(reading.parts()?, garment, header.range, header.ridge),
            Some(features) => Self::of_regions(reading.regions(features)?, garment, header.range),
        };
        let space = space.map_err(|source| CheckpointError::Config {
            path: path.to_path_buf(),
            source,
        })?;
        Ok(Self {
            moment: header.moment,
            record: header.record,
            scores: header.scores,
            checksum: header.checksum,
            ..space
        })
    }
}

fn of_scenes(parts: &PoseSpaceParts, precision: Precision) -> Vec<Stored<'_>> {
    let num_numbers = parts.scales.iter().filter(|&&scale| scale > 0.0).count();
    let num_scenes = parts.centers.len() / num_numbers.max(1);
    let (num_shapes, num_vertices) = (parts.num_shapes(), parts.mean.len() / 3);
    // Large weights cancel each other: rounded to halves they would move a drape by centimetres.
    let single = Precision::F32;
    let mut tensors = vec![
        ("scales", vec![parts.scales.len()], &parts.scales, single),
        (
            "centers",
            vec![num_scenes, num_numbers],
            &parts.centers,
            precision.of_places(),
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
    if let Some(mirror) = &parts.mirror {
        tensors.push((PARITY, vec![num_shapes], &mirror.parity, single));
    }
    let tensors = tensors
        .into_iter()
        .map(|(name, shape, numbers, precision)| {
            (name.to_owned(), shape, Cow::from(numbers), precision)
        });
    let mirror = parts.mirror.as_ref();
    tensors
        .chain(mirror.map(|mirror| of_exchange(&mirror.numbers)))
        .collect()
}

fn of_exchange(Exchange(pairs): &Exchange) -> Stored<'static> {
    let shape = vec![pairs.len(), 2];
    let pairs = pairs.iter();
    let numbers: Vec<f32> = pairs
        .flat_map(|&(number, sign)| [number as f32, sign])
        .collect();
    (MIRROR.to_owned(), shape, numbers.into(), Precision::F32)
}

fn of_regions(all: &Regions, precision: Precision) -> Vec<Stored<'_>> {
    let single = Precision::F32;
    let mut tensors: Vec<Stored<'_>> = vec![
        (
            "mean".to_owned(),
            vec![all.num_vertices(), 3],
            Cow::from(&all.mean),
            single,
        ),
        (
            "center".to_owned(),
            vec![all.center.len()],
            Cow::from(&all.center),
            single,
        ),
    ];
    if let Some(mirror) = &all.mirror {
        tensors.push(of_exchange(&mirror.numbers));
        let images = mirror.images.iter();
        // Corners are whole numbers below 2²⁴.
        let numbers = images.flat_map(|&([a, b, c], [u, v, w])| {
            let corners = [a, b, c].map(|corner| corner as f32);
            corners.into_iter().chain([u, v, w])
        });
        let shape = vec![mirror.images.len(), 6];
        tensors.push((
            IMAGES.to_owned(),
            shape,
            numbers.collect::<Vec<f32>>().into(),
            single,
        ));
    }
    for (number, region) in all.regions.iter().enumerate() {
        let name = |what: &str| format!("region.{number}.{what}");
        let vertices = region.vertices.iter().map(|&vertex| vertex as f32);
        let vertices: Vec<f32> = vertices.collect();
        let shape = vec![region.num_shapes(), vertices.len(), 3];
        tensors.push((name("shapes"), shape, Cow::from(&region.shapes), precision));
        let shape = vec![vertices.len()];
        tensors.push((name("vertices"), shape, vertices.into(), single));
        let shape = vec![region.scales.len()];
        tensors.push((name("scales"), shape, Cow::from(&region.scales), single));
        for (depth, layer) in region.layers.iter().enumerate() {
            let shape = vec![layer.num_inputs(), layer.bias.len()];
            let weight = Cow::from(&layer.weight);
            tensors.push((name(&format!("{depth}.weight")), shape, weight, precision));
            let bias = Cow::from(&layer.bias);
            let shape = vec![layer.bias.len()];
            tensors.push((name(&format!("{depth}.bias")), shape, bias, single));
        }
    }
    tensors
}

/// A file that is being read.
struct Reading<'a> {
    path: &'a Path,
    tensors: SafeTensors<'a>,
}

impl Reading<'_> {
    fn has(&self, name: &str) -> bool {
        self.tensors.tensor(name).is_ok()
    }

    fn part(&self, name: &str) -> Result<Vec<f32>, CheckpointError> {
        weight_file::numbers(&self.tensors, name).ok_or_else(|| CheckpointError::Tensor {
            path: self.path.to_path_buf(),
            name: name.to_owned(),
            found: "missing".to_owned(),
            expected: "one".to_owned(),
        })
    }

    fn exchange(&self) -> Result<Exchange, CheckpointError> {
        // The checksum holds these; one beyond the last is refused with the other counts.
        let numbers = self.part(MIRROR)?;
        let pairs = numbers.as_chunks::<2>().0.iter();
        let pairs = pairs.map(|&[number, sign]| (number as usize, sign));
        Ok(Exchange(pairs.collect()))
    }

    fn parts(&self) -> Result<PoseSpaceParts, CheckpointError> {
        let mirror = if self.has(MIRROR) {
            Some(Mirror {
                numbers: self.exchange()?,
                parity: self.part(PARITY)?,
            })
        } else {
            None
        };
        Ok(PoseSpaceParts {
            scales: self.part("scales")?,
            centers: self.part("centers")?,
            weights: self.part("weights")?,
            mean: self.part("mean")?,
            shapes: self.part("shapes")?,
            mirror,
        })
    }

    fn regions(&self, features: Features) -> Result<Regions, CheckpointError> {
        let mut regions = Vec::new();
        while self.has(&format!("region.{}.vertices", regions.len())) {
            regions.push(self.region(regions.len())?);
        }
        let mirror = if self.has(MIRROR) {
            let images = self.part(IMAGES)?;
            let images = images.as_chunks::<6>().0.iter();
            let image =
                |&[a, b, c, u, v, w]: &[f32; 6]| ([a, b, c].map(|corner| corner as u32), [u, v, w]);
            Some(RegionMirror {
                numbers: self.exchange()?,
                images: images.map(image).collect(),
            })
        } else {
            None
        };
        Ok(Regions {
            features,
            center: self.part("center")?,
            mean: self.part("mean")?,
            regions,
            mirror,
        })
    }

    fn region(&self, number: usize) -> Result<Region, CheckpointError> {
        let part = |what: &str| self.part(&format!("region.{number}.{what}"));
        let mut layers = Vec::new();
        while self.has(&format!("region.{number}.{}.bias", layers.len())) {
            let depth = layers.len();
            layers.push(Layer {
                weight: part(&format!("{depth}.weight"))?,
                bias: part(&format!("{depth}.bias"))?,
            });
        }
        let vertices = part("vertices")?;
        Ok(Region {
            vertices: vertices.iter().map(|&vertex| vertex as u32).collect(),
            scales: part("scales")?,
            shapes: part("shapes")?,
            layers,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::small;
    use super::*;

    #[test]
    fn a_header_names_the_moment_as_it_always_did() {
        let mut space = small();
        space.moment = Moment::Falling;
        let path = Path::new("falling.safetensors");
        let bytes = space.to_bytes(path, Precision::F32).unwrap();
        let text = String::from_utf8_lossy(&bytes).into_owned();
        // The text is a string of the metadata.
        assert!(text.contains(r#"\"aim\":\"falling\""#), "{text}");
        let read = |name: &str| predicted(&mut serde_json::Deserializer::from_str(name));
        assert_eq!(read("\"falling\"").unwrap(), Moment::Falling);
        assert!(read("\"start\"").is_err());
    }

    #[test]
    fn a_file_comes_back_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pose-space.safetensors");
        let mut space = small();
        space.scores.insert("test.distance_m".to_owned(), 0.01);
        space.save(&path, Precision::F16).unwrap();
        assert_eq!(PoseSpace::load(&path).unwrap(), space);
        space.moment = Moment::Arrival;
        let Told::ByScenes(parts) = &mut space.told else {
            unreachable!()
        };
        parts.mirror = Some(Mirror {
            numbers: Exchange(vec![(0, -1.0), (1, 1.0)]),
            parity: vec![-1.0],
        });
        space.save(&path, Precision::F16).unwrap();
        assert_eq!(PoseSpace::load(&path).unwrap(), space);
        assert!(!space.checksum().is_empty());

        // Eight bits have a schema of their own, and come back as what they were written from.
        space.save(&path, Precision::I8).unwrap();
        let packed = PoseSpace::load(&path).unwrap();
        assert_eq!(packed, space);
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(weight_file::schema(&path, &bytes).unwrap(), PACKED);
        assert_eq!(
            packed.clone().to_bytes(&path, Precision::I8).unwrap(),
            bytes
        );
        space.save(&path, Precision::F16).unwrap();

        let regions = super::super::regions::tests::small();
        let (garment, range) = (space.garment, space.range.clone());
        let mut regions = PoseSpace::of_regions(regions, garment, range).unwrap();
        regions.moment = Moment::Arrival;
        let other = folder.path().join("arrival.safetensors");
        regions.save(&other, Precision::F16).unwrap();
        assert_eq!(PoseSpace::load(&other).unwrap(), regions);

        let mut bytes = std::fs::read(&path).unwrap();
        let last = bytes.len() - 1;
        bytes[last] ^= 1;
        let altered = PoseSpace::from_bytes(&path, &bytes);
        assert!(matches!(altered, Err(CheckpointError::Altered { .. })));
        let short = PoseSpace::from_bytes(&path, &bytes[..last]);
        assert!(matches!(short, Err(CheckpointError::NotSafetensors { .. })));
        let read = weight_file::read(&path).unwrap();
        let network = weight_file::parse::<crate::CheckpointHeader>(&path, &read);
        assert!(matches!(network, Err(CheckpointError::Schema { .. })));
    }
}
