//! Names and numbers that arguments of `drape` take.

use clap::ValueEnum;
use garnet::{
    Warp,
    io::SceneUnits,
    mesh::{UnitError, UpAxis},
};

/// How the garment is brought to the body before penetrations are removed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum MethodName {
    /// The default network of the package, else the warp.
    Auto,
    /// Linear blend skinning.
    Lbs,
    /// Dual-quaternion skinning: pose only.
    Dqs,
    /// Dual-quaternion skinning and the change of the body's shape.
    Warp,
    /// The physics-based simulation that networks learn from; see `garnet simulate`.
    Sim,
    /// A variant of the package.
    Network(String),
}

impl MethodName {
    /// The names that are not those of variants.
    pub(crate) const OF_ALL: [&str; 5] = ["auto", "warp", "dqs", "lbs", "sim"];
}

/// Which network drapes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum NetworkChoice {
    /// None.
    None,
    /// That which the package names first, if it has any.
    Default,
    /// The one of this name.
    Named(String),
}

/// The axis that points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum UpName {
    /// The longer of y and z of the rest body.
    Auto,
    /// As in most programs.
    Y,
    /// As in Blender and 3ds Max.
    Z,
}

pub(crate) fn units(text: &str) -> Result<SceneUnits, String> {
    let unit = |name: &str| match name {
        "auto" => Ok(None),
        _ => name
            .parse()
            .map(Some)
            .map_err(|error: UnitError| format!("{error}, `auto`, or two of them as `cm,m`")),
    };
    let (garment, body) = text.split_once(',').unwrap_or((text, text));
    Ok(SceneUnits {
        garment: unit(garment)?,
        body: unit(body)?,
    })
}

/// A part of many drapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shard {
    /// From 1.
    pub(crate) number: usize,
    pub(crate) count: usize,
}

impl Shard {
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(number, count)| {
            Some((number.parse::<u32>().ok()?, count.parse::<u32>().ok()?))
        });
        match numbers {
            Some((number, count)) if (1..=count).contains(&number) => Ok(Self {
                number: number as usize,
                count: count as usize,
            }),
            _ => Err("expected a part and their number, as 2/8".to_owned()),
        }
    }
}
impl MethodName {
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        Ok(match text {
            "auto" => Self::Auto,
            "lbs" => Self::Lbs,
            "dqs" => Self::Dqs,
            "warp" => Self::Warp,
            "sim" => Self::Sim,
            "" => return Err("expected the name of a method".to_owned()),
            name => Self::Network(name.to_owned()),
        })
    }

    pub(super) fn warp(&self) -> Warp {
        match self {
            Self::Lbs => Warp::Linear,
            Self::Dqs => Warp::DualQuaternion,
            Self::Auto | Self::Warp | Self::Sim | Self::Network(_) => Warp::Shape,
        }
    }

    pub(super) fn network(&self) -> NetworkChoice {
        match self {
            Self::Auto => NetworkChoice::Default,
            Self::Network(name) => NetworkChoice::Named(name.clone()),
            Self::Lbs | Self::Dqs | Self::Warp | Self::Sim => NetworkChoice::None,
        }
    }
}

impl UpName {
    pub(crate) fn axis(self) -> Option<UpAxis> {
        match self {
            Self::Auto => None,
            Self::Y => Some(UpAxis::Y),
            Self::Z => Some(UpAxis::Z),
        }
    }
}

#[cfg(test)]
mod tests {
    use garnet::mesh::Unit;

    use super::*;

    #[test]
    fn units_are_one_for_all_or_one_for_each() {
        let both = |garment, body| Ok(SceneUnits { garment, body });
        assert_eq!(units("auto"), both(None, None));
        assert_eq!(
            units("cm"),
            both(Some(Unit::Centimetre), Some(Unit::Centimetre))
        );
        assert_eq!(
            units("cm,m"),
            both(Some(Unit::Centimetre), Some(Unit::Metre))
        );
        assert_eq!(units("auto,m"), both(None, Some(Unit::Metre)));
        assert!(units("inch").is_err() && units("m,").is_err());
    }
}
