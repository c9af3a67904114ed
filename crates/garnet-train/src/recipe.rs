//! What the names of the paper's variants stand for.

use std::path::Path;

use garnet_net::losses::LossConfig;
use garnet_net::pose_space::deformation_name;
use garnet_net::{ModelHeader, Moment, Variant};

use crate::{Choice, TrainConfig, TrainError};

/// Names of the network variants.
const KINDS: [(&str, Variant); 5] = [
    ("naive", Variant::Naive),
    ("global", Variant::Global),
    ("local", Variant::Local),
    ("global-params", Variant::GlobalParams),
    ("local-params", Variant::LocalParams),
];

/// The moments that pose-space deformations predict.
const PREDICTED: [Moment; 4] = [
    Moment::Rest,
    Moment::Arrival,
    Moment::Falling,
    Moment::Midway,
];

/// What methods of drapes and rows of tables are called, which variants cannot be.
const RESERVED: [&str; 6] = ["auto", "lbs", "dqs", "warp", "sim", "teacher"];

/// Names of the curvature losses that a variant is fine-tuned with.
const FINE_TUNINGS: [(&str, LossConfig); 4] = [
    ("rq", LossConfig::fine_tune_rq()),
    ("mc", LossConfig::fine_tune_mc()),
    ("mcrq", LossConfig::fine_tune_mcrq()),
    ("umc", LossConfig::fine_tune_umc()),
];

/// What the name of a variant asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct Recipe {
    /// The name, as in `local-rq`.
    pub name: String,
    /// Which parts the network has; none if the kind does not tell.
    pub kind: Option<Variant>,
    /// The moment that a pose-space deformation predicts; none for networks.
    pub deformation: Option<Moment>,
    /// The variant that is fine-tuned and the losses that it is fine-tuned with; none to start from
    /// random weights.
    pub fine_tuned: Option<(String, LossConfig)>,
}

/// Learning rate of fine-tunings: more takes a network farther from where it was, for no better
/// curvature. Tried: 3e-4 and 3e-3 (docs/experiments/006-learning-rates.md).
const FINE_TUNING_RATE: f64 = 3e-4;

/// The name of a kind of network, as configurations have it.
pub fn kind_name(kind: Variant) -> &'static str {
    let known = KINDS.iter().find(|&&(_, known)| known == kind);
    known.map_or("", |&(name, _)| name)
}

/// What can be trained: the kinds of networks, and of deformations.
pub fn kind_names() -> impl Iterator<Item = &'static str> {
    let networks = KINDS.iter().map(|&(name, _)| name);
    networks.chain(PREDICTED.into_iter().map(deformation_name))
}

impl Recipe {
    /// What is trained is of a kind, one of [`kind_names`] or a fine-tuning such as `local-rq`, and
    /// has a name of its own.
    ///
    /// # Errors
    ///
    /// [`TrainError::UnknownKind`], [`TrainError::NameOfKind`] for the name of another kind, or as
    /// [`Recipe::of_name`].
    pub fn of_kind(kind: &str, name: &str) -> Result<Self, TrainError> {
        let unknown = || TrainError::UnknownKind {
            kind: kind.to_owned(),
        };
        let recipe = Self::of_name(kind).map_err(|_name| unknown())?;
        if !recipe.says_what() {
            return Err(unknown());
        }
        let named = Self::of_name(name)?;
        let asked = Self {
            name: name.to_owned(),
            ..recipe
        };
        if named.is_kind() && named != asked {
            return Err(TrainError::NameOfKind {
                name: name.to_owned(),
                kind: kind.to_owned(),
            });
        }
        Ok(asked)
    }

    /// Whether the name is that of a kind, or of a fine-tuning of one.
    fn is_kind(&self) -> bool {
        let base = self.fine_tuned.as_ref().map(|(base, _)| base.as_str());
        kind_names().any(|kind| kind == self.name || Some(kind) == base)
    }

    /// What a variant is that was trained before, by its weights.
    ///
    /// # Errors
    ///
    /// [`TrainError::Checkpoint`], or as [`Recipe::of_name`].
    pub fn of_weights(name: &str, weights: &Path) -> Result<Self, TrainError> {
        let header = ModelHeader::read(weights)?;
        let deformation = header.config.is_none().then_some(header.moment);
        Ok(Self {
            kind: header.config.map(|network| network.variant),
            deformation,
            ..Self::of_name(name)?
        })
    }

    /// Whether it says what is to be trained; a name of one's own alone does not.
    pub const fn says_what(&self) -> bool {
        self.kind.is_some() || self.fine_tuned.is_some() || self.deformation.is_some()
    }

    /// Reads a name: `naive`, `global`, `local` or `global-params` start anew; `<variant>-rq`,
    /// `-mc`, `-mcrq` and `-umc` fine-tune `<variant>` with curvature losses (*Gundogdu et al.
    /// 2020, section 3.4*); `pose-space`, `arrival`, `falling` and `midway` are pose-space
    /// deformations; any other name stands for itself.
    ///
    /// # Errors
    ///
    /// [`TrainError::VariantName`] for a name that cannot be that of a file, or could be that of
    /// the flat pattern, `template.rest`; [`TrainError::ReservedName`] for the name of another
    /// method.
    pub fn of_name(name: &str) -> Result<Self, TrainError> {
        let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "-_".contains(letter);
        if name.is_empty() || !name.chars().all(is_plain) {
            return Err(TrainError::VariantName {
                name: name.to_owned(),
            });
        }
        if RESERVED.contains(&name) {
            return Err(TrainError::ReservedName {
                name: name.to_owned(),
            });
        }
        let fine_tuned = name.rsplit_once('-').and_then(|(base, ending)| {
            let found = FINE_TUNINGS.iter().find(|(name, _)| *name == ending);
            found.map(|(_, losses)| (base.to_owned(), losses.clone()))
        });
        let kind = KINDS.iter().find(|(kind, _)| *kind == name);
        let mut predicted = PREDICTED.into_iter();
        let deformation = predicted.find(|&moment| deformation_name(moment) == name);
        Ok(Self {
            name: name.to_owned(),
            kind: kind.map(|&(_, kind)| kind),
            deformation,
            fine_tuned,
        })
    }

    /// The moment that a pose-space deformation predicts; none for networks.
    pub const fn pose_space(&self) -> Option<Moment> {
        self.deformation
    }

    /// Puts what the name asks for into a configuration.
    pub fn apply(&self, config: &mut TrainConfig) {
        if let Some(kind) = self.kind {
            config.kind = kind;
        }
        if let Some((_, losses)) = &self.fine_tuned {
            config.loss = losses.clone();
            config.choose_by = Choice::Loss;
            config.learning_rate = FINE_TUNING_RATE;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_the_paper_are_understood() {
        let global = Recipe::of_name("global").unwrap();
        assert_eq!(
            (global.kind, global.fine_tuned),
            (Some(Variant::Global), None)
        );
        let tuned = Recipe::of_name("local-mcrq").unwrap();
        let expected = ("local".to_owned(), LossConfig::fine_tune_mcrq());
        assert_eq!((tuned.kind, tuned.fine_tuned), (None, Some(expected)));
        let moment = |name| Recipe::of_name(name).unwrap().pose_space();
        let names = ["pose-space", "arrival", "falling", "midway"];
        let known = [
            Moment::Rest,
            Moment::Arrival,
            Moment::Falling,
            Moment::Midway,
        ];
        assert_eq!(names.map(moment), known.map(Some));
        for name in ["local", "start", "rest"] {
            assert_eq!(moment(name), None, "{name}");
        }
        let own = Recipe::of_name("my_shirt-2").unwrap();
        assert_eq!((own.kind, own.fine_tuned), (None, None));
        assert_eq!(kind_name(Variant::GlobalParams), "global-params");
    }

    #[test]
    fn kinds_and_names_are_apart() {
        for kind in kind_names() {
            let named = Recipe::of_kind(kind, "my-shirt").unwrap();
            let known = Recipe::of_name(kind).unwrap();
            assert!(known.says_what() && named.name == "my-shirt");
            assert_eq!(
                (named.kind, named.deformation),
                (known.kind, known.deformation)
            );
        }
        let tuned = Recipe::of_kind("local-rq", "best").unwrap();
        assert_eq!(tuned.fine_tuned.unwrap().0, "local");
        for kind in ["locl", "my-shirt", "auto", ""] {
            let error = Recipe::of_kind(kind, "best").unwrap_err();
            assert!(matches!(error, TrainError::UnknownKind { .. }), "{error}");
        }
        assert!(Recipe::of_kind("local", "auto").is_err());
        for (kind, name) in [
            ("falling", "local"),
            ("falling", "midway"),
            ("local", "midway"),
            ("local", "local-rq"),
            ("local-mc", "local-rq"),
        ] {
            let error = Recipe::of_kind(kind, name).unwrap_err();
            assert!(matches!(error, TrainError::NameOfKind { .. }), "{error}");
        }
        for (kind, name) in [
            ("local", "local"),
            ("local-rq", "local-rq"),
            ("local", "mine-rq"),
        ] {
            Recipe::of_kind(kind, name).unwrap();
        }
    }

    #[test]
    fn names_of_other_files_and_methods_are_refused() {
        for name in [
            "",
            "../x",
            "a b",
            ".hidden",
            "template.rest",
            "local settled",
        ] {
            let error = Recipe::of_name(name).unwrap_err();
            assert!(matches!(error, TrainError::VariantName { .. }), "{error}");
        }
        for name in RESERVED {
            let error = Recipe::of_name(name).unwrap_err();
            assert!(matches!(error, TrainError::ReservedName { .. }), "{error}");
        }
    }
}
