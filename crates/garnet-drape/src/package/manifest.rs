//! `garment.toml`: what a garment package says of itself.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use garnet_mesh::{Fingerprint, MOST_BYTES, TriMesh, read_bounded, stays_inside};
use garnet_sim::Fabric;
use serde::{Deserialize, Serialize};

use super::{MANIFEST_FILE, PackageError, StoredParameters};
use crate::{Expectation, Moment, Settling, StoredPoses};

/// One kind of network under two names.
const PARAMETERS: [&str; 2] = ["params", "global-params"];

/// What this version writes and reads.
pub const PACKAGE_SCHEMA: &str = "garnet.garment/1";

/// All that `garment.toml` holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Manifest {
    /// [`PACKAGE_SCHEMA`].
    pub schema: String,
    /// Name of the garment.
    pub name: String,
    /// Fingerprint of the topology of the template.
    pub fingerprint: String,
    /// Fingerprint of the positions of the template.
    pub positions: String,
    /// The fabric.
    pub fabric: StoredFabric,
    /// The sewing pattern, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pattern: Option<StoredPattern>,
    /// The body that the template lies on.
    pub rest_body: StoredRestBody,
    /// What its drapes cost where that was measured; see [`Variant::seconds`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cost: Option<StoredCost>,
    /// The poses that [`Variant::expected`] goes by.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub poses: Option<StoredPoses>,
    /// The trained variants.
    #[serde(default, rename = "variant", skip_serializing_if = "Vec::is_empty")]
    pub variants: Vec<Variant>,
}

impl Manifest {
    /// Makes a variant the default, and no other one; a name that there is not changes nothing.
    pub fn make_default(&mut self, name: &str) {
        let Some(name) = self.variant(name).map(|variant| variant.name.clone()) else {
            return;
        };
        for variant in &mut self.variants {
            variant.default = variant.name == name;
        }
    }

    /// Makes the variant the default that is the best on validation, and returns its name.
    ///
    /// The default stays what it is, and nothing is returned, if no variant has a score there, or
    /// it is not known how good the default is: variants of earlier versions do not say it.
    pub fn choose_default(&mut self) -> Option<String> {
        let default = self.default_variant()?;
        if default.valid_error.is_none() && !default.has_no_score() {
            return None;
        }
        let known = self.variants.iter();
        let known = known.filter_map(|variant| Some((variant.valid_error?, variant)));
        let (_, best) = known.min_by(|a, b| {
            // Of those that are equally good the default stays.
            a.0.total_cmp(&b.0).then(b.1.default.cmp(&a.1.default))
        })?;
        let name = best.name.clone();
        self.make_default(&name);
        Some(name)
    }

    /// Adds a variant, or replaces the one of its name; the first one is the default.
    pub fn add(&mut self, mut variant: Variant) {
        let same = |other: &Variant| other.name == variant.name;
        let place = self.variants.iter().position(same);
        let has_default = self.variants.iter().any(|other| other.default);
        variant.default |= !has_default || place.is_some_and(|place| self.variants[place].default);
        match place {
            Some(place) => self.variants[place] = variant,
            None => self.variants.push(variant),
        }
    }

    /// Whether the garment is cut for each wearer before it is draped.
    pub fn is_made_to_measure(&self) -> bool {
        (self.pattern.as_ref()).is_some_and(|pattern| pattern.made_to_measure)
    }

    /// The garment alone, as data sets keep it: without variants, which are trained later, and
    /// without the checksum of a file, which may be packed anew.
    #[must_use]
    pub fn of_garment(&self) -> Self {
        let mut garment = self.clone();
        garment.cost = None;
        garment.poses = None;
        garment.variants.clear();
        garment.rest_body.checksum = None;
        garment
    }

    /// Whether a mesh is the template that this was written for, to the last bit of each position:
    /// variants have learned that one, in its place on its body.
    ///
    /// # Errors
    ///
    /// [`PackageError::Foreign`] with `path`, where the mesh was read.
    pub fn check_template(&self, path: &Path, mesh: &TriMesh) -> Result<(), PackageError> {
        let found = Fingerprint::of_topology(mesh).to_string();
        if found != self.fingerprint {
            let expected = &self.fingerprint;
            let what = format!("its fingerprint is {found}, `{MANIFEST_FILE}` says {expected}");
            return Err(PackageError::foreign(path, what));
        }
        let found = Fingerprint::of_positions(mesh.positions()).to_string();
        if found != self.positions {
            let what = format!("its vertices are not those that `{MANIFEST_FILE}` was written for");
            return Err(PackageError::foreign(path, what));
        }
        Ok(())
    }

    /// Refuses the rig of a package in `folder` that is not the one that was written with it.
    ///
    /// # Errors
    ///
    /// [`PackageError::Read`], or [`PackageError::Altered`].
    pub fn check_rig(&self, folder: &Path) -> Result<(), PackageError> {
        let Some(expected) = &self.rest_body.checksum else {
            return Ok(());
        };
        let path = folder.join(&self.rest_body.rig);
        let bytes =
            read_bounded(&path, MOST_BYTES).map_err(|source| PackageError::read(&path, source))?;
        PackageError::check(&path, Fingerprint::of_bytes(&bytes), expected)
    }

    /// A file that it names and that is not in its folder, if there is one.
    pub(super) fn outside(&self) -> Option<&str> {
        let mut names = self.weight_files().chain([self.rest_body.rig.as_str()]);
        names.find(|name| !stays_inside(name))
    }

    /// Refuses what is known of variants, in the manifest `path`, where it cannot be: by these
    /// numbers they are chosen.
    pub(super) fn check_numbers(&self, path: &Path) -> Result<(), PackageError> {
        let mut numbers: Vec<(String, Option<f64>, f64)> = Vec::new();
        for variant in &self.variants {
            let expected = variant.expected;
            let of_variant = [
                ("distance_error", variant.distance_error, MOST_METRES),
                ("settled_error", variant.settled_error, MOST_METRES),
                ("valid_error", variant.valid_error, MOST_METRES),
                ("seconds", variant.seconds, MOST_SECONDS),
                ("settled_seconds", variant.settled_seconds, MOST_SECONDS),
                ("flop", variant.flop, MOST_FLOP),
                (
                    "expected.distance",
                    expected.map(|e| e.distance),
                    MOST_METRES,
                ),
                ("expected.growth", expected.map(|e| e.growth), MOST_GROWTH),
                ("expected.within", expected.map(|e| e.within), MOST_RATIO),
            ];
            let name = &variant.name;
            let of_variant = of_variant.into_iter();
            numbers.extend(of_variant.map(|(field, value, max)| {
                (format!("{field}` of the variant `{name}"), value, max)
            }));
        }
        if let Some(cost) = self.cost {
            let field = |name: &str| format!("cost.{name}");
            numbers.push((field("calibration"), Some(cost.calibration), MOST_SECONDS));
            numbers.push((field("warp"), Some(cost.warp), MOST_SECONDS));
        }
        let means = self.poses.iter().flat_map(|poses| &poses.mean);
        let mean = means.copied().find(|mean| !(-1.0..=1.0).contains(mean));
        if let Some(mean) = mean {
            return Err(PackageError::Number {
                path: path.to_path_buf(),
                field: "poses.mean".to_owned(),
                value: f64::from(mean),
                min: -1.0,
                max: 1.0,
            });
        }
        for (field, value, max) in numbers {
            if let Some(value) = value.filter(|value| !(0.0..=max).contains(value)) {
                return Err(PackageError::Number {
                    path: path.to_path_buf(),
                    field,
                    value,
                    min: 0.0,
                    max,
                });
            }
        }
        Ok(())
    }

    /// The files with the weights of all variants.
    pub fn weight_files(&self) -> impl Iterator<Item = &str> {
        self.variants.iter().flat_map(|variant| {
            let of_sizes = variant.weights_of_sizes.iter();
            of_sizes.chain([&variant.weights]).map(String::as_str)
        })
    }

    /// The variant of a name, which may be an [alias](Variant::aliases).
    pub fn variant(&self, name: &str) -> Option<&Variant> {
        let by_name = |name: &str| self.variants.iter().find(|variant| variant.name == name);
        let is_alias = |variant: &&Variant| variant.aliases.iter().any(|alias| alias == name);
        // Training calls the kind `params` which the paper calls `Global-Params`.
        let is_parameters = PARAMETERS.contains(&name);
        by_name(name)
            .or_else(|| self.variants.iter().find(is_alias))
            .or_else(|| {
                PARAMETERS
                    .into_iter()
                    .filter(|_| is_parameters)
                    .find_map(by_name)
            })
    }

    /// Where the weights of a variant are in a package.
    ///
    /// # Errors
    ///
    /// [`PackageError::NoVariant`] with those that there are.
    pub fn weights_of(&self, folder: &Path, name: &str) -> Result<PathBuf, PackageError> {
        if let Some(variant) = self.variant(name) {
            return Ok(folder.join(&variant.weights));
        }
        let names = (self.variants.iter()).map(|variant| format!("`{}`", variant.name));
        let names: Vec<String> = names.collect();
        Err(PackageError::NoVariant {
            name: name.to_owned(),
            known: if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(", ")
            },
        })
    }

    /// The same for a size beside the template, if the variant [has such
    /// weights](Variant::weights_of_sizes).
    ///
    /// # Errors
    ///
    /// As [`Manifest::weights_of`].
    pub fn weights_of_sizes(&self, folder: &Path, name: &str) -> Result<PathBuf, PackageError> {
        let variant = self.variant(name);
        match variant.and_then(|variant| variant.weights_of_sizes.as_ref()) {
            Some(of_sizes) => Ok(folder.join(of_sizes)),
            None => self.weights_of(folder, name),
        }
    }

    /// The sewing parameters of the pattern, in the order of their names; none without a pattern.
    pub fn sewing_parameters(&self) -> Vec<f32> {
        let pattern = self.pattern.iter();
        let values = pattern.flat_map(|pattern| pattern.parameters.values());
        values.map(|&value| value as f32).collect()
    }

    /// The variant that is taken if none is asked for.
    pub fn default_variant(&self) -> Option<&Variant> {
        let mut variants = self.variants.iter();
        variants
            .find(|variant| variant.default)
            .or(self.variants.first())
    }
}

/// More than a mean distance of vertices may be, in metres.
const MOST_METRES: f64 = 100.0;
/// And the time of a drape, in seconds.
const MOST_SECONDS: f64 = 1e5;
/// And its operations.
const MOST_FLOP: f64 = 1e18;
/// And by how much the logarithm of the error grows, per radian.
const MOST_GROWTH: f64 = 10.0;
/// And how far off of what is expected drapes are.
const MOST_RATIO: f64 = 1e3;

/// A fabric as files hold it, in SI units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredFabric {
    /// What it is called.
    pub name: String,
    /// Areal density, kg/m².
    pub density: f32,
    /// Young's modulus times thickness, N/m.
    pub membrane: f32,
    /// The share of it that acts against being shortened; in files without it, of earlier
    /// versions, 1.
    #[serde(default = "whole", skip_serializing_if = "is_whole")]
    pub compression: f32,
    /// Bending rigidity, N m.
    pub bending: f32,
    /// Coulomb's coefficient.
    pub friction: f32,
    /// The distance that cloth keeps from skin, in metres.
    pub thickness: f32,
}

const fn whole() -> f32 {
    1.0
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde passes a reference"
)]
const fn is_whole(share: &f32) -> bool {
    *share >= 1.0
}

impl StoredFabric {
    /// A fabric under a name.
    pub fn new(name: impl Into<String>, fabric: &Fabric) -> Self {
        Self {
            name: name.into(),
            density: fabric.density,
            membrane: fabric.membrane,
            compression: fabric.compression,
            bending: fabric.bending,
            friction: fabric.friction,
            thickness: fabric.thickness,
        }
    }

    /// The fabric that is simulated.
    pub const fn fabric(&self) -> Fabric {
        Fabric {
            density: self.density,
            membrane: self.membrane,
            compression: self.compression,
            bending: self.bending,
            friction: self.friction,
            thickness: self.thickness,
        }
    }
}

/// A sewing pattern as files hold it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredPattern {
    /// Which pattern: tshirt, sweater, dress, jeans.
    pub kind: String,
    /// The number of vertices that was asked for.
    pub vertices: usize,
    /// The size that was cut; none if it was cut to the measures of the rest body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<String>,
    /// Whether the trained variants know the garment cut to the measures of each wearer, and not
    /// as the template is.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub made_to_measure: bool,
    /// The parameters, in metres or without unit.
    pub parameters: BTreeMap<String, f64>,
}

/// The rest body as files hold it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredRestBody {
    /// File with mesh, skeleton and weights, in the package.
    pub rig: String,
    /// Fingerprint of its bytes, as text; none in packages of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checksum: Option<String>,
    /// Parameters, if it is a built-in body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parameters: Option<StoredParameters>,
}

/// What drapes cost on the machine where that was measured, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredCost {
    /// The time of [`calibration`](crate::calibration) there.
    pub calibration: f64,
    /// Warp and untangling of the garment, without a network.
    pub warp: f64,
}

/// A trained variant, with its measured error and cost.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Variant {
    /// Its name.
    pub name: String,
    /// Other names that it is known by.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub aliases: Vec<String>,
    /// File with its weights, in the package.
    pub weights: String,
    /// File with the weights for the sizes beside the template, in the package: of a network that
    /// is told how the garment is cut.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weights_of_sizes: Option<String>,
    /// Whether it is taken if none is asked for.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub default: bool,
    /// Mean distance to the teacher on the test split, in metres (paper, Eq. 17).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance_error: Option<f64>,
    /// The same after the cloth has settled where the variant has put it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settled_error: Option<f64>,
    /// For how many frames of a sixtieth of a second that was; by default
    /// [`Moment::settle_frames`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settle_frames: Option<u32>,
    /// Mean distance to the teacher on the validation split, in metres, of what a drape with this
    /// variant gives, settled if that settles: what the default is chosen by. Scenes whose bodies
    /// are unlike the training are left out, for they fall back. None if all are, without such a
    /// split, and for variants of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub valid_error: Option<f64>,
    /// Scenes that [`valid_error`](Self::valid_error) is the mean of; 0 if all fell back.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub valid_scenes: Option<usize>,
    /// Whether its drapes settle where it predicts cloth at rest: if that brings them nearer to
    /// the teacher on the validation split. None for variants of earlier versions, which settle if
    /// [`settled_error`](Self::settled_error) is less than
    /// [`distance_error`](Self::distance_error).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settles: Option<bool>,
    /// How far from the teacher its drapes probably are, by the pose: fitted to drapes of the
    /// validation split.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected: Option<Expectation>,
    /// Time of a drape without relaxation, in seconds, where [`Manifest::cost`] was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// The same with relaxation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settled_seconds: Option<f64>,
    /// Floating-point operations of one forward pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flop: Option<f64>,
}

impl Variant {
    /// Whether its drapes are known to come nearer to the teacher when they settle.
    pub fn gains_by_settling(&self) -> bool {
        let left = self.distance_error.unwrap_or(f64::INFINITY);
        let earlier = || self.settled_error.is_some_and(|settled| settled < left);
        self.settles.unwrap_or_else(earlier)
    }

    /// Whether it was measured on the validation split, and fell back in all scenes of it.
    pub fn has_no_score(&self) -> bool {
        self.valid_scenes == Some(0)
    }

    /// How cloth settles that this variant predicts at a moment: not at all where that is known to
    /// bring nothing.
    pub fn settling(&self, from: Moment) -> Settling {
        let settles = self.gains_by_settling() || !from.is_rest();
        let known = Settling::of_predicted(from);
        let frames = self.settle_frames.unwrap_or(known.frames);
        Settling {
            frames: if settles { frames } else { 0 },
            ..known
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest(variants: &[(&str, Option<f64>)]) -> Manifest {
        let text = format!(
            "schema = \"{PACKAGE_SCHEMA}\"\nname = \"shirt\"\nfingerprint = \"\"\npositions = \"\"\n\
             [fabric]\nname = \"silk\"\ndensity = 0.2\nmembrane = 100.0\nbending = 1e-5\nfriction = 0.3\n\
             thickness = 0.002\n[rest_body]\nrig = \"body.rig.npz\"\n"
        );
        let mut manifest: Manifest = toml::from_str(&text).unwrap();
        for &(name, valid_error) in variants {
            manifest.add(Variant {
                aliases: Vec::new(),
                seconds: None,
                settled_seconds: None,
                name: name.to_owned(),
                weights_of_sizes: None,
                weights: format!("{name}.safetensors"),
                default: false,
                distance_error: None,
                settled_error: None,
                settle_frames: None,
                valid_error,
                valid_scenes: None,
                settles: None,
                expected: None,
                flop: None,
            });
        }
        manifest
    }

    fn default_of(manifest: &Manifest) -> &str {
        let defaults = manifest.variants.iter().filter(|variant| variant.default);
        assert_eq!(defaults.count(), 1);
        &manifest.default_variant().unwrap().name
    }

    #[test]
    fn the_best_on_validation_becomes_the_default() {
        let mut found = manifest(&[("a", Some(3e-3)), ("b", Some(2e-3)), ("c", None)]);
        assert_eq!(default_of(&found), "a");
        assert_eq!(found.choose_default().as_deref(), Some("b"));
        assert_eq!(default_of(&found), "b");
        found.make_default("c");
        assert_eq!(default_of(&found), "c");
        // Nobody knows how good that is.
        assert_eq!(found.choose_default(), None);
        assert_eq!(default_of(&found), "c");
        found.make_default("d");
        assert_eq!(default_of(&found), "c");
    }

    #[test]
    fn what_has_no_score_is_the_default_only_where_nothing_has_one() {
        let mut found = manifest(&[("a", None)]);
        found.variants[0].valid_scenes = Some(0);
        assert_eq!(found.choose_default(), None);
        assert_eq!(default_of(&found), "a");
        let scored = manifest(&[("b", Some(0.5))]).variants.remove(0);
        found.add(scored);
        assert_eq!(found.choose_default().as_deref(), Some("b"));
        assert_eq!(default_of(&found), "b");
    }

    #[test]
    fn settling_is_chosen_on_validation() {
        let mut variant = manifest(&[("a", Some(3e-3))]).variants.remove(0);
        let frames = |variant: &Variant| variant.settling(Moment::Rest).frames;
        assert_eq!(frames(&variant), 0);
        // As of earlier versions.
        (variant.distance_error, variant.settled_error) = (Some(3e-3), Some(2e-3));
        assert_eq!(frames(&variant), Moment::Rest.settle_frames());
        variant.settles = Some(false);
        assert_eq!(frames(&variant), 0);
        assert!(variant.settling(Moment::Midway).frames > 0);
    }

    #[test]
    fn what_is_as_good_stays_the_default() {
        let mut found = manifest(&[("a", Some(3e-3)), ("b", Some(3e-3))]);
        for name in ["a", "b"] {
            found.make_default(name);
            assert_eq!(found.choose_default().as_deref(), Some(name));
        }
    }
}
