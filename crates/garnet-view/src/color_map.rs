//! From a value to a color.

use crate::{Rgb, rgb::Light};

/// A scale of colors in which equal steps of the value look like equal steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ColorMap {
    /// Dark violet over green to yellow: for amounts from zero up (van der Walt and Smith 2015).
    #[default]
    Viridis,
    /// Blue over light grey to red: for signed values, grey at zero (Moreland 2009).
    CoolWarm,
    /// Red over light grey to blue: how a garment fits, from 0 for tight to 4 for loose.
    Fit,
    /// A color for each [`Problem`], which do not blend into each other.
    Problems,
}

/// What can be wrong with a vertex of a drape, the worst last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Problem {
    /// Nothing.
    None,
    /// Cloth runs through cloth.
    ThroughCloth,
    /// The body traps it where it runs through itself.
    Trapped,
    /// It is in the skin, or on a face that crosses it.
    ThroughSkin,
}

impl Problem {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::None,
        Self::ThroughCloth,
        Self::Trapped,
        Self::ThroughSkin,
    ];

    /// The value that [`ColorMap::Problems`] shows between 0 and 3.
    pub fn value(self) -> f32 {
        f32::from(self as u8)
    }

    /// What people call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::ThroughCloth => "cloth through cloth",
            Self::Trapped => "trapped",
            Self::ThroughSkin => "through the skin",
        }
    }
}

/// How many control points a map has.
const NUM_POINTS: usize = 9;

const VIRIDIS: [Rgb; NUM_POINTS] = [
    Rgb::new(68, 1, 84),
    Rgb::new(71, 45, 123),
    Rgb::new(59, 82, 139),
    Rgb::new(44, 114, 142),
    Rgb::new(33, 145, 140),
    Rgb::new(40, 174, 128),
    Rgb::new(94, 201, 98),
    Rgb::new(173, 220, 48),
    Rgb::new(253, 231, 37),
];

const COOL_WARM: [Rgb; NUM_POINTS] = [
    Rgb::new(59, 76, 192),
    Rgb::new(98, 130, 234),
    Rgb::new(141, 176, 254),
    Rgb::new(184, 208, 249),
    Rgb::new(221, 221, 221),
    Rgb::new(245, 196, 173),
    Rgb::new(244, 154, 123),
    Rgb::new(222, 96, 77),
    Rgb::new(180, 4, 38),
];

/// [`COOL_WARM`] from its other end: what is tight is to be noticed.
const FIT: [Rgb; COOL_WARM.len()] = {
    let mut colors = COOL_WARM;
    colors.reverse();
    colors
};

/// The words of a fit, each a quarter of the scale.
const FITS: [&str; 4] = ["tight", "close", "regular", "loose"];

const PROBLEMS: [Rgb; Problem::ALL.len()] = [
    Rgb::new(201, 204, 209),
    Rgb::new(230, 159, 0),
    Rgb::new(86, 180, 233),
    Rgb::new(204, 32, 39),
];

impl ColorMap {
    /// Names of the kinds that it shows, from the lower end, each as much of the scale; none if it
    /// shows numbers.
    pub fn kinds(self) -> Vec<&'static str> {
        match self {
            Self::Viridis | Self::CoolWarm => Vec::new(),
            Self::Fit => FITS.to_vec(),
            Self::Problems => Problem::ALL.map(Problem::name).to_vec(),
        }
    }

    /// Whether colors go over into each other.
    pub const fn blends(self) -> bool {
        !matches!(self, Self::Problems)
    }

    /// The color at `position`, 0 at the lower end and 1 at the upper.
    ///
    /// Positions beyond an end take the color of that end; a position that is not a number is
    /// [`palette::NON_FINITE`](crate::palette::NON_FINITE).
    ///
    /// # Examples
    ///
    /// ```
    /// use garnet_view::{ColorMap, Rgb};
    ///
    /// assert_eq!(ColorMap::Viridis.color(1.0), Rgb::new(253, 231, 37));
    /// ```
    pub fn color(self, position: f32) -> Rgb {
        if position.is_nan() {
            return crate::palette::NON_FINITE;
        }
        let points = self.points();
        let along = position.clamp(0.0, 1.0) * (points.len() - 1) as f32;
        let along = match self {
            Self::Viridis | Self::CoolWarm | Self::Fit => along,
            Self::Problems => along.round(),
        };
        let first = points
            .iter()
            .enumerate()
            .take(points.len() - 1)
            .rev()
            .find(|(index, _)| *index as f32 <= along)
            .map_or(0, |(index, _)| index);
        let share = along - first as f32;
        let (from, to) = (points[first].channels(), points[first + 1].channels());
        let [red, green, blue] =
            [0, 1, 2].map(|channel| between(from[channel], to[channel], share));
        Rgb::new(red, green, blue)
    }

    /// Colors at equal steps of the position, ends included; between them they change evenly.
    pub(crate) const fn points(self) -> &'static [Rgb] {
        match self {
            Self::Viridis => &VIRIDIS,
            Self::CoolWarm => &COOL_WARM,
            Self::Fit => &FIT,
            Self::Problems => &PROBLEMS,
        }
    }

    /// The light at `num_steps` equally spaced positions, ends included.
    pub(crate) fn table(self, num_steps: usize) -> Vec<Light> {
        let last = num_steps.saturating_sub(1).max(1) as f32;
        (0..num_steps)
            .map(|step| self.color(step as f32 / last).to_light())
            .collect()
    }
}

#[expect(
    clippy::cast_sign_loss,
    reason = "between two codes that are not negative"
)]
fn between(from: u8, to: u8, share: f32) -> u8 {
    let (from, to) = (f32::from(from), f32::from(to));
    (from + share * (to - from)).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_beyond_the_ends_take_the_end_colors() {
        assert_eq!(ColorMap::Viridis.color(-3.0), VIRIDIS[0]);
        assert_eq!(ColorMap::Viridis.color(f32::INFINITY), VIRIDIS[8]);
        assert_eq!(ColorMap::CoolWarm.color(0.5), COOL_WARM[4]);
        assert_eq!(ColorMap::Fit.color(0.0), ColorMap::CoolWarm.color(1.0));
        assert_eq!(ColorMap::Fit.color(2.0), COOL_WARM[0]);
    }

    #[test]
    fn problems_have_a_color_each_and_none_between() {
        let last = (Problem::ALL.len() - 1) as f32;
        for (problem, color) in Problem::ALL.into_iter().zip(PROBLEMS) {
            for off in [-0.4, 0.0, 0.4] {
                assert_eq!(
                    ColorMap::Problems.color((problem.value() + off) / last),
                    color
                );
            }
        }
        assert_eq!(ColorMap::Problems.kinds().len(), PROBLEMS.len());
    }

    #[test]
    fn viridis_grows_brighter_all_the_way() {
        let weights = Light::new(0.2126, 0.7152, 0.0722);
        let table = ColorMap::Viridis.table(64);
        assert!(
            table
                .windows(2)
                .all(|pair| weights.dot(&pair[0]) < weights.dot(&pair[1]))
        );
    }
}
