//! What is made worse, and by how much.

use serde::Serialize;

/// One way in which scenes get harder.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Axis {
    /// Its name in arguments and files.
    pub name: &'static str,
    /// What is made worse, in words.
    pub title: &'static str,
    /// The unit of its levels.
    pub unit: &'static str,
    /// The level up to which ours are to hold.
    pub bar: f64,
    /// Whether even simple methods hold: it checks that nothing is broken.
    pub is_sanity_check: bool,
    #[serde(skip)]
    pub(crate) kind: Kind,
    #[serde(skip)]
    levels: &'static [f64],
    #[serde(skip)]
    quick: &'static [f64],
}

/// What is done to a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Elbow,
    Knee,
    Hip,
    ShoulderUp,
    Trunk,
    AllJoints,
    Twist,
    ArmIntoTrunk,
    ThighIntoThigh,
    BellyIntoLap,
    Stride,
    ShoulderBeyond,
    NeckBeyond,
    AllBeyond,
    Heavy,
    Thin,
    Larger,
    Smaller,
    Doll,
    Giant,
    Child,
    FinerGarment,
    FinerBody,
    CoarserGarment,
    CoarserBody,
    Noise,
    Holes,
    TurnedSkin,
    Balls,
    Slivers,
    FlippedFaces,
    SplitVertices,
    Fins,
    Pieces,
    Lining,
    TwoGarments,
    Clearance,
    Tall,
    Short,
    Female,
    Male,
    HeavyCloth,
    SoftCloth,
    StiffCloth,
    StrongGravity,
    WeakGravity,
    Place,
    Threads,
    Antipodal,
    UnscaledWeights,
}

impl Kind {
    /// Whether levels are degrees of one motion, in which cloth must not jump.
    pub(crate) fn is_motion(self) -> bool {
        matches!(
            self,
            Self::Elbow
                | Self::Knee
                | Self::Hip
                | Self::ShoulderUp
                | Self::Trunk
                | Self::AllJoints
                | Self::Twist
                | Self::Stride
                | Self::ShoulderBeyond
                | Self::NeckBeyond
                | Self::AllBeyond
        )
    }

    /// Whether scenes are of the package's garment on its body, so that its networks can drape.
    pub(crate) fn is_of_package(self) -> bool {
        !matches!(
            self,
            Self::Doll
                | Self::Giant
                | Self::Child
                | Self::FinerGarment
                | Self::FinerBody
                | Self::CoarserGarment
                | Self::CoarserBody
                | Self::Holes
                | Self::TurnedSkin
                | Self::Balls
                | Self::Slivers
                | Self::FlippedFaces
                | Self::SplitVertices
                | Self::Fins
                | Self::Pieces
                | Self::Lining
                | Self::TwoGarments
                | Self::UnscaledWeights
        )
    }
}

const DEGREES: &str = "degrees";

const BY_TEN: &[f64] = &[
    0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0, 100.0, 110.0, 120.0, 130.0, 140.0,
    150.0, 160.0, 170.0,
];

const FEW: &[f64] = &[0.0, 60.0, 120.0, 150.0];

const BEYOND: &[f64] = &[0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0];

const fn bend(name: &'static str, title: &'static str, kind: Kind, bar: f64) -> Axis {
    Axis {
        name,
        title,
        unit: DEGREES,
        bar,
        is_sanity_check: false,
        kind,
        levels: BY_TEN,
        quick: FEW,
    }
}

const fn axis(
    [name, title, unit]: [&'static str; 3],
    kind: Kind,
    bar: f64,
    levels: &'static [f64],
    quick: &'static [f64],
) -> Axis {
    Axis {
        name,
        title,
        unit,
        bar,
        is_sanity_check: false,
        kind,
        levels,
        quick,
    }
}

const fn sanity(axis: Axis) -> Axis {
    Axis {
        is_sanity_check: true,
        ..axis
    }
}

const DEPTHS: &[f64] = &[0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0];

const SIZES: &[f64] = &[1.0, 2.0, 5.0, 10.0];

/// All axes of the stress test.
pub const AXES: &[Axis] = &[
    bend("elbow", "both elbows bend from rest", Kind::Elbow, 150.0),
    bend("knee", "both knees bend from rest", Kind::Knee, 150.0),
    bend("hip", "both thighs rise from rest", Kind::Hip, 150.0),
    bend(
        "overhead",
        "both arms rise sideways from hanging",
        Kind::ShoulderUp,
        150.0,
    ),
    axis(
        ["trunk", "the trunk bends forwards from rest", DEGREES],
        Kind::Trunk,
        110.0,
        BY_TEN.split_at(13).0,
        &[0.0, 60.0, 110.0],
    ),
    bend(
        "joints",
        "elbows, knees, hips, shoulders and trunk bend at once from rest",
        Kind::AllJoints,
        150.0,
    ),
    axis(
        ["twist", "an upper arm turns about itself", DEGREES],
        Kind::Twist,
        360.0,
        &[
            0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0, 210.0, 240.0, 270.0, 300.0, 330.0, 360.0,
        ],
        &[0.0, 120.0, 180.0, 270.0],
    ),
    axis(
        ["arm-depth", "arms run into the trunk", "mm"],
        Kind::ArmIntoTrunk,
        60.0,
        DEPTHS,
        &[0.0, 20.0, 60.0],
    ),
    axis(
        ["thigh-depth", "thighs run into each other", "mm"],
        Kind::ThighIntoThigh,
        60.0,
        DEPTHS,
        &[0.0, 20.0, 60.0],
    ),
    axis(
        ["lap-depth", "the belly runs into the lap", "mm"],
        Kind::BellyIntoLap,
        60.0,
        DEPTHS,
        &[0.0, 20.0, 60.0],
    ),
    axis(
        ["stride", "one leg swings forwards, the other back", DEGREES],
        Kind::Stride,
        90.0,
        BEYOND,
        &[0.0, 40.0, 90.0],
    ),
    axis(
        [
            "shoulder-beyond",
            "arms swing back beyond the range of motion",
            DEGREES,
        ],
        Kind::ShoulderBeyond,
        60.0,
        BEYOND,
        &[0.0, 30.0, 60.0],
    ),
    axis(
        [
            "neck-beyond",
            "the head bends beyond the range of motion",
            DEGREES,
        ],
        Kind::NeckBeyond,
        60.0,
        BEYOND,
        &[0.0, 30.0, 60.0],
    ),
    axis(
        [
            "all-beyond",
            "arms, trunk, neck and legs bend beyond the range of motion at once",
            DEGREES,
        ],
        Kind::AllBeyond,
        30.0,
        BEYOND,
        &[0.0, 30.0],
    ),
    axis(
        ["heavy", "body mass index", "kg/m²"],
        Kind::Heavy,
        45.0,
        &[22.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0],
        &[22.0, 35.0, 45.0],
    ),
    axis(
        ["thin", "body mass index below 22 by", "kg/m²"],
        Kind::Thin,
        6.0,
        &[0.0, 2.0, 4.0, 6.0, 8.0],
        &[0.0, 4.0, 6.0],
    ),
    axis(
        ["larger", "size of the body, the garment stays", "times"],
        Kind::Larger,
        1.25,
        &[1.0, 1.1, 1.25, 1.5, 2.0, 2.5],
        &[1.0, 1.25],
    ),
    axis(
        [
            "smaller",
            "size of the body over this, the garment stays",
            "times",
        ],
        Kind::Smaller,
        1.25,
        &[1.0, 1.1, 1.25, 1.5, 2.0, 2.5],
        &[1.0, 1.25],
    ),
    axis(
        ["doll", "the whole scene is smaller", "times"],
        Kind::Doll,
        10.0,
        SIZES,
        &[1.0, 10.0],
    ),
    axis(
        ["giant", "the whole scene is larger", "times"],
        Kind::Giant,
        10.0,
        SIZES,
        &[1.0, 10.0],
    ),
    axis(
        [
            "child",
            "from an adult to a child of four, with the garment",
            "of 1",
        ],
        Kind::Child,
        1.0,
        &[0.0, 0.25, 0.5, 0.75, 1.0],
        &[0.0, 1.0],
    ),
    axis(
        ["finer-garment", "faces of the garment", "times"],
        Kind::FinerGarment,
        4.0,
        &[1.0, 4.0, 16.0],
        &[1.0, 4.0],
    ),
    axis(
        ["finer-body", "faces of the body", "times"],
        Kind::FinerBody,
        4.0,
        &[1.0, 4.0],
        &[1.0, 4.0],
    ),
    axis(
        [
            "coarser-garment",
            "vertices of the garment, one in",
            "times",
        ],
        Kind::CoarserGarment,
        4.0,
        &[1.0, 2.0, 4.0, 8.0],
        &[1.0, 4.0],
    ),
    axis(
        ["coarser-body", "vertices of the body, one in", "times"],
        Kind::CoarserBody,
        4.0,
        &[1.0, 4.0],
        &[1.0, 4.0],
    ),
    axis(
        ["noise", "noise on the body", "mm"],
        Kind::Noise,
        5.0,
        &[0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0],
        &[0.0, 2.0, 5.0],
    ),
    axis(
        [
            "holes",
            "faces of the body that are missing, in patches",
            "%",
        ],
        Kind::Holes,
        10.0,
        &[0.0, 2.0, 5.0, 10.0, 20.0, 30.0],
        &[0.0, 5.0, 10.0],
    ),
    axis(
        [
            "turned-skin",
            "faces of the body that look inwards, in patches",
            "%",
        ],
        Kind::TurnedSkin,
        10.0,
        &[0.0, 2.0, 5.0, 10.0, 20.0, 30.0],
        &[0.0, 5.0, 10.0],
    ),
    axis(
        [
            "balls",
            "balls of 6 cm that stick half out of the skin",
            "balls",
        ],
        Kind::Balls,
        4.0,
        &[0.0, 1.0, 2.0, 4.0, 8.0, 16.0],
        &[0.0, 4.0],
    ),
    axis(
        ["slivers", "faces of the garment that are slivers", "%"],
        Kind::Slivers,
        10.0,
        &[0.0, 1.0, 2.0, 5.0, 10.0],
        &[0.0, 2.0, 10.0],
    ),
    axis(
        [
            "flipped",
            "faces of the garment that look to the other side",
            "%",
        ],
        Kind::FlippedFaces,
        10.0,
        &[0.0, 1.0, 2.0, 5.0, 10.0],
        &[0.0, 2.0, 10.0],
    ),
    axis(
        ["split", "vertices of the garment that are there twice", "%"],
        Kind::SplitVertices,
        10.0,
        &[0.0, 1.0, 2.0, 5.0, 10.0],
        &[0.0, 2.0, 10.0],
    ),
    axis(
        ["fins", "edges of the garment that have three faces", "%"],
        Kind::Fins,
        10.0,
        &[0.0, 1.0, 2.0, 5.0, 10.0],
        &[0.0, 2.0, 10.0],
    ),
    axis(
        ["pieces", "loose pieces of the garment", "pieces"],
        Kind::Pieces,
        154.0,
        &[1.0, 2.0, 8.0, 32.0, 154.0],
        &[1.0, 32.0],
    ),
    axis(
        ["lining", "a lining lies nearer than 6 mm by", "mm"],
        Kind::Lining,
        4.5,
        &[0.0, 1.0, 2.0, 3.0, 4.0, 4.5, 5.0, 5.5],
        &[0.0, 3.0, 4.5],
    ),
    axis(
        [
            "two-garments",
            "a second garment lies nearer than 6 mm over the first by",
            "mm",
        ],
        Kind::TwoGarments,
        4.5,
        &[0.0, 1.0, 2.0, 3.0, 4.0, 4.5, 5.0, 5.5],
        &[0.0, 4.5],
    ),
    axis(
        ["clearance", "distance that is kept from the skin", "mm"],
        Kind::Clearance,
        10.0,
        &[0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0],
        &[0.0, 2.0, 10.0],
    ),
    axis(
        ["tall", "stature", "m"],
        Kind::Tall,
        2.0,
        &[1.7, 1.8, 1.9, 2.0, 2.1, 2.2, 2.3],
        &[1.7, 2.0],
    ),
    axis(
        ["short", "stature below 1.7 m by", "m"],
        Kind::Short,
        0.25,
        &[0.0, 0.1, 0.2, 0.25, 0.3, 0.4, 0.5],
        &[0.0, 0.25],
    ),
    axis(
        ["female", "sex of the body, from between to female", "of 1"],
        Kind::Female,
        1.0,
        &[0.0, 0.5, 1.0],
        &[0.0, 1.0],
    ),
    axis(
        ["male", "sex of the body, from between to male", "of 1"],
        Kind::Male,
        1.0,
        &[0.0, 0.5, 1.0],
        &[0.0, 1.0],
    ),
    axis(
        ["heavy-cloth", "mass of the fabric", "times"],
        Kind::HeavyCloth,
        4.0,
        &[1.0, 2.0, 4.0, 8.0],
        &[1.0, 4.0],
    ),
    axis(
        ["soft-cloth", "the fabric stretches more easily", "times"],
        Kind::SoftCloth,
        4.0,
        &[1.0, 2.0, 4.0, 8.0],
        &[1.0, 4.0],
    ),
    axis(
        ["stiff-cloth", "the fabric is stiffer in bending", "times"],
        Kind::StiffCloth,
        100.0,
        &[1.0, 10.0, 100.0, 1000.0],
        &[1.0, 100.0],
    ),
    axis(
        ["strong-gravity", "gravity", "times that of the earth"],
        Kind::StrongGravity,
        2.5,
        &[1.0, 1.5, 2.5, 5.0, 10.0],
        &[1.0, 2.5],
    ),
    axis(
        [
            "weak-gravity",
            "gravity is less than that of the earth by",
            "%",
        ],
        Kind::WeakGravity,
        84.0,
        &[0.0, 50.0, 84.0, 100.0],
        &[0.0, 84.0],
    ),
    sanity(axis(
        [
            "place",
            "the scene stands this far away, turned about the vertical",
            "m",
        ],
        Kind::Place,
        100.0,
        &[0.0, 1.0, 10.0, 100.0],
        &[0.0, 10.0],
    )),
    sanity(axis(
        ["threads", "threads", "threads"],
        Kind::Threads,
        8.0,
        &[1.0, 2.0, 4.0, 8.0],
        &[1.0, 2.0],
    )),
    sanity(axis(
        [
            "antipodal",
            "joints whose turn is given by the other one of its two quaternions",
            "%",
        ],
        Kind::Antipodal,
        100.0,
        &[0.0, 25.0, 50.0, 100.0],
        &[0.0, 50.0],
    )),
    sanity(axis(
        [
            "unscaled-weights",
            "weights of the body as the file has them are larger",
            "times",
        ],
        Kind::UnscaledWeights,
        100.0,
        &[1.0, 2.0, 10.0, 100.0],
        &[1.0, 10.0],
    )),
];

impl Axis {
    /// The axis of a name.
    ///
    /// ```
    /// use garnet_stress::Axis;
    ///
    /// assert_eq!(Axis::find("elbow").map(|axis| axis.bar), Some(150.0));
    /// assert!(Axis::find("weather").is_none());
    /// ```
    pub fn find(name: &str) -> Option<&'static Self> {
        AXES.iter().find(|axis| axis.name == name)
    }

    /// Its levels, the easiest first; of the quick form, those up to the bar alone.
    pub fn levels(&self, is_quick: bool) -> &'static [f64] {
        if is_quick { self.quick } else { self.levels }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn axes_have_names_of_their_own_and_levels_that_rise_to_the_bar() {
        let names: BTreeSet<&str> = AXES.iter().map(|axis| axis.name).collect();
        assert_eq!(names.len(), AXES.len());
        for axis in AXES {
            for levels in [axis.levels(true), axis.levels(false)] {
                assert!(
                    levels.windows(2).all(|pair| pair[0] < pair[1]),
                    "{}",
                    axis.name
                );
            }
            assert!(axis.levels(false).contains(&axis.bar), "{}", axis.name);
            let beyond = |level: &&f64| **level > axis.bar;
            assert_eq!(
                axis.levels(true).iter().filter(beyond).count(),
                0,
                "{}",
                axis.name
            );
        }
    }
}
