//! `dataset.json`: what a data set is made of.

use std::path::Path;

use garnet_drape::Manifest as PackageManifest;
use garnet_mesh::{Fingerprint, write_atomically};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use super::plan::{Counts, Protocol};
use super::variations::Variations;
use crate::{DataError, Limits, Moment, error::text_of};

/// What this version writes and reads.
pub const DATASET_SCHEMA: &str = "garnet.dataset/1";

/// The version of what makes scenes, which `dataset.json` keeps.
///
/// Whoever changes what a seed gives raises it: the simulator, bodies, poses, patterns, or which
/// scenes are kept. Data sets of different versions are not one data set. Golden drapes are stored
/// with it (`tests/it/golden`), and their tests fail when the simulator moves.
pub const GENERATOR: &str = "0.1.1";

/// The field that tells where scenes are from, in messages.
const SCENES_OF_KIND: &str = "scenes of the kind";

/// `dataset.json`: all that decides over the contents of a data set, in SI units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DatasetManifest {
    /// [`DATASET_SCHEMA`].
    pub schema: String,
    /// [`GENERATOR`] of the program that made it.
    pub generator: String,
    /// The garment, as its package says.
    pub garment: PackageManifest,
    /// The seed of bodies and poses.
    pub seed: u64,
    /// Bodies in each split.
    pub bodies: Counts,
    /// Scenes on each body.
    pub poses: u32,
    /// Whether poses are [mixed](garnet_body::poses::PoseSampler::mixed) of several.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub mixed: bool,
    /// The noise of the poses' angles, as a share of the usual one.
    #[serde(default = "usual_noise", skip_serializing_if = "is_usual")]
    pub noise: f64,
    /// What validation and test have that the training has not.
    #[serde(default, skip_serializing_if = "Protocol::is_unseen_sequences")]
    pub protocol: Protocol,
    /// Quality of the simulation; none for drapes made elsewhere.
    pub quality: Option<String>,
    /// Until when scenes are simulated: until the cloth rests; until the body comes to its last
    /// place, a third of the work; or until it is midway, a fifth of it. Shorter ones are for
    /// networks that predict the cloth at that moment alone.
    #[serde(
        default,
        skip_serializing_if = "Moment::is_rest",
        deserialize_with = "end_of_simulation"
    )]
    pub until: Moment,
    /// Whether all bodies wear the template, or each a garment cut for it.
    pub sizing: Sizing,
    /// Sewing parameters that are drawn for each body.
    #[serde(default, skip_serializing_if = "Variations::is_empty")]
    pub vary: Variations,
    /// Above these a scene is rejected.
    pub limits: Limits,
    /// Bodies in a shard.
    pub bodies_per_shard: u32,
    /// Fingerprint of what was imported, as text: of the entries of the list and of the positions
    /// of all meshes. None for scenes that were simulated, and for imports of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imported: Option<String>,
}

/// Who wears which garment in a data set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sizing {
    /// All bodies wear the template: bodies that it does not fit are left out.
    OneSize,
    /// Each body wears a garment cut to its measures.
    MadeToMeasure,
}

impl Sizing {
    /// The name in files and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::OneSize => "one-size",
            Self::MadeToMeasure => "made-to-measure",
        }
    }
}

/// Noise of manifests that tell none.
const fn usual_noise() -> f64 {
    1.0
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde passes a reference"
)]
fn is_usual(noise: &f64) -> bool {
    noise.to_bits() == usual_noise().to_bits()
}

/// Refuses moments that no data set is simulated until.
fn end_of_simulation<'de, D: Deserializer<'de>>(reader: D) -> Result<Moment, D::Error> {
    let moment = Moment::deserialize(reader)?;
    match moment {
        Moment::Midway | Moment::Arrival | Moment::Rest => Ok(moment),
        Moment::Start | Moment::Falling => Err(D::Error::custom(format!(
            "no data set is simulated until `{}`",
            moment.name()
        ))),
    }
}

impl DatasetManifest {
    /// The hash that ties shards to their data set.
    pub fn fingerprint(&self) -> Fingerprint {
        let manifest = Self {
            garment: self.garment.of_garment(),
            ..self.clone()
        };
        let text = serde_json::to_string(&manifest).unwrap_or_default();
        Fingerprint::of_bytes(text.as_bytes())
    }

    /// Where its scenes are from, in messages.
    const fn kind_of_scenes(&self) -> &'static str {
        if self.quality.is_some() {
            "`simulated`"
        } else {
            "`imported`"
        }
    }

    /// Reads `dataset.json` of a folder.
    ///
    /// # Errors
    ///
    /// [`DataError::Read`], [`DataError::Text`], or [`DataError::Foreign`] for another version.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let text = text_of(path)?;
        let manifest: Self =
            serde_json::from_str(&text).map_err(|source| DataError::json(path, &source))?;
        if manifest.schema == DATASET_SCHEMA {
            return Ok(manifest);
        }
        let what = format!(
            "its schema is `{}`, not `{DATASET_SCHEMA}`",
            manifest.schema
        );
        Err(DataError::foreign(path, what))
    }

    /// Writes `dataset.json` of a folder.
    ///
    /// # Errors
    ///
    /// [`DataError::Write`].
    pub fn write(&self, path: &Path) -> Result<(), DataError> {
        let mut text =
            serde_json::to_string_pretty(self).map_err(|source| DataError::json(path, &source))?;
        text.push('\n');
        Ok(write_atomically(path, |writer| {
            writer.write_all(text.as_bytes())
        })?)
    }

    /// Refuses to go on with a data set that was asked for in another way.
    ///
    /// # Errors
    ///
    /// [`DataError::OtherDataset`] with the first difference.
    pub fn check_same(&self, asked: &Self, path: &Path) -> Result<(), DataError> {
        let pairs = |manifest: &Self| {
            [
                ("garment", manifest.garment.name.clone()),
                ("template", manifest.garment.positions.clone()),
                // An import has neither seed nor quality, which nobody has asked for then.
                (SCENES_OF_KIND, manifest.kind_of_scenes().to_owned()),
                ("seed", manifest.seed.to_string()),
                (
                    "bodies",
                    format!(
                        "{}/{}/{}",
                        manifest.bodies.train, manifest.bodies.valid, manifest.bodies.test
                    ),
                ),
                ("poses", manifest.poses.to_string()),
                ("poses mixed", manifest.mixed.to_string()),
                ("noise of poses", manifest.noise.to_string()),
                ("protocol", manifest.protocol.name().to_owned()),
                ("quality", manifest.quality.clone().unwrap_or_default()),
                ("end", manifest.until.name().to_owned()),
                ("sizing", manifest.sizing.name().to_owned()),
                ("varied parameters", manifest.vary.to_string()),
                ("limits", manifest.limits.to_string()),
                (
                    "imported content",
                    manifest
                        .imported
                        .clone()
                        .unwrap_or_else(|| "that was not told".to_owned()),
                ),
                ("version", manifest.generator.clone()),
                ("fingerprint", manifest.fingerprint().to_string()),
            ]
        };
        for ((field, found), (_, asked)) in pairs(self).into_iter().zip(pairs(asked)) {
            if found != asked {
                return Err(DataError::OtherDataset {
                    path: path.to_path_buf(),
                    field,
                    found,
                    asked,
                });
            }
        }
        Ok(())
    }
}
