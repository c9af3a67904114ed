//! The measures a tailor takes.

/// A tape measure of the body, in metres.
///
/// Girths of the torso are horizontal, girths of the limbs perpendicular to the bone; each is the
/// perimeter of the convex hull of the section, as a tape lies. Heights are above the floor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Measure {
    /// Height of the body.
    Stature,
    /// Girth at the chest height, which is that of the nipples, but below the armpits of the rest
    /// pose: these lie below the shoulder joint by 0.074 of the stature.
    Chest,
    /// Girth under the bust: below the chest height by 0.05 of the stature.
    UnderBust,
    /// Girth at the waist height, which is that of the navel.
    Waist,
    /// Girth at the hip height, which is that of the greatest protrusion of the buttocks.
    Hip,
    /// Girth of the thigh below the crotch: 0.21 of the way from hip to knee joint.
    Thigh,
    /// Girth at the knee joint.
    Knee,
    /// Girth of the calf: 0.28 of the way from knee to ankle joint.
    Calf,
    /// Smallest girth of the shank: 0.88 of the way from knee to ankle joint.
    Ankle,
    /// Girth of the relaxed upper arm: half-way from shoulder to elbow joint. Flesh of the armpit
    /// that reaches there is pressed in.
    UpperArm,
    /// Girth of the relaxed forearm: 0.2 of the way from elbow to wrist joint.
    Forearm,
    /// Girth at the wrist: 0.95 of the way from elbow to wrist joint.
    Wrist,
    /// Girth of the neck, perpendicular to it, 0.38 of the way from neck to head joint.
    Neck,
    /// Breadth between the acromia, the bony tips of the shoulders.
    ShoulderBreadth,
    /// Length from the acromion over the elbow to the wrist.
    ArmLength,
    /// Height of the crotch.
    Inseam,
    /// Height of the acromion.
    ShoulderHeight,
    /// Height of the nipples.
    ChestHeight,
    /// Height of the navel.
    WaistHeight,
    /// Height of the greatest protrusion of the buttocks.
    HipHeight,
    /// Height of the middle of the patella.
    KneeHeight,
}

impl Measure {
    /// How many measures there are.
    pub const COUNT: usize = 21;

    /// All measures, in order.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Stature,
        Self::Chest,
        Self::UnderBust,
        Self::Waist,
        Self::Hip,
        Self::Thigh,
        Self::Knee,
        Self::Calf,
        Self::Ankle,
        Self::UpperArm,
        Self::Forearm,
        Self::Wrist,
        Self::Neck,
        Self::ShoulderBreadth,
        Self::ArmLength,
        Self::Inseam,
        Self::ShoulderHeight,
        Self::ChestHeight,
        Self::WaistHeight,
        Self::HipHeight,
        Self::KneeHeight,
    ];

    /// The girths, in order.
    pub const GIRTHS: [Self; 12] = [
        Self::Chest,
        Self::UnderBust,
        Self::Waist,
        Self::Hip,
        Self::Thigh,
        Self::Knee,
        Self::Calf,
        Self::Ankle,
        Self::UpperArm,
        Self::Forearm,
        Self::Wrist,
        Self::Neck,
    ];

    /// The name in messages and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stature => "stature",
            Self::Chest => "chest",
            Self::UnderBust => "under-bust",
            Self::Waist => "waist",
            Self::Hip => "hip",
            Self::Thigh => "thigh",
            Self::Knee => "knee",
            Self::Calf => "calf",
            Self::Ankle => "ankle",
            Self::UpperArm => "upper arm",
            Self::Forearm => "forearm",
            Self::Wrist => "wrist",
            Self::Neck => "neck",
            Self::ShoulderBreadth => "shoulder breadth",
            Self::ArmLength => "arm length",
            Self::Inseam => "inseam",
            Self::ShoulderHeight => "shoulder height",
            Self::ChestHeight => "chest height",
            Self::WaistHeight => "waist height",
            Self::HipHeight => "hip height",
            Self::KneeHeight => "knee height",
        }
    }

    /// Whether the measure is a girth.
    pub fn is_girth(self) -> bool {
        Self::GIRTHS.contains(&self)
    }
}

impl std::fmt::Display for Measure {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.name())
    }
}

/// A value for every measure, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measures([f64; Measure::COUNT]);

impl Measures {
    /// Asks `value` for each measure.
    pub fn from_fn(mut value: impl FnMut(Measure) -> f64) -> Self {
        let mut values = [0.0; Measure::COUNT];
        for measure in Measure::ALL {
            values[measure as usize] = value(measure);
        }
        Self(values)
    }

    /// Measure and value of each, in order.
    pub fn iter(&self) -> impl Iterator<Item = (Measure, f64)> + '_ {
        Measure::ALL.into_iter().zip(self.0)
    }
}

impl std::ops::Index<Measure> for Measures {
    type Output = f64;

    fn index(&self, measure: Measure) -> &f64 {
        &self.0[measure as usize]
    }
}

impl std::ops::IndexMut<Measure> for Measures {
    fn index_mut(&mut self, measure: Measure) -> &mut f64 {
        &mut self.0[measure as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_are_numbered_in_their_order() {
        for (index, measure) in Measure::ALL.into_iter().enumerate() {
            assert_eq!(measure as usize, index);
        }
        let numbers = Measures::from_fn(|measure| measure as usize as f64);
        assert!((numbers[Measure::Calf] - 7.0).abs() < f64::EPSILON);
    }
}
