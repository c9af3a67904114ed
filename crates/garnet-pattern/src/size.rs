//! Standard sizes.

use crate::PatternError;
use crate::reference::REFERENCE;
use crate::wearer::Measures;

/// A size of ready-made garments, by the chest girth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Size {
    /// Chest of 79 cm.
    Xs,
    /// Chest of 87 cm.
    S,
    /// Chest of 95 cm: nearly the reference wearer.
    M,
    /// Chest of 103 cm.
    L,
    /// Chest of 111 cm.
    Xl,
    /// Chest of 119 cm.
    Xxl,
    /// Chest of 127 cm.
    Xxxl,
}

impl Size {
    /// All sizes, from small to large.
    pub const ALL: [Self; 7] = [
        Self::Xs,
        Self::S,
        Self::M,
        Self::L,
        Self::Xl,
        Self::Xxl,
        Self::Xxxl,
    ];

    /// The name on the label.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Xs => "xs",
            Self::S => "s",
            Self::M => "m",
            Self::L => "l",
            Self::Xl => "xl",
            Self::Xxl => "2xl",
            Self::Xxxl => "3xl",
        }
    }

    /// The measures that a garment of this size is cut for.
    ///
    /// Girths grow with the chest as they do from the thin to the heavy in the built-in
    /// population; lengths grow a little.
    pub fn measures(self) -> Measures {
        let steps = self as usize as f64 - 2.0;
        let mut size = REFERENCE.measures;
        let grow = |value: &mut f64, step: f64| *value += steps * step;
        size.chest = 0.95 + 0.08 * steps;
        grow(&mut size.waist, 0.085);
        grow(&mut size.hip, 0.065);
        grow(&mut size.thigh, 0.040);
        grow(&mut size.knee, 0.018);
        grow(&mut size.calf, 0.018);
        grow(&mut size.ankle, 0.007);
        grow(&mut size.upper_arm, 0.027);
        grow(&mut size.forearm, 0.016);
        grow(&mut size.wrist, 0.007);
        grow(&mut size.neck, 0.016);
        grow(&mut size.shoulder_breadth, 0.012);
        grow(&mut size.arm_length, 0.006);
        grow(&mut size.stature, 0.010);
        grow(&mut size.neck_height, 0.009);
        grow(&mut size.shoulder_height, 0.009);
        grow(&mut size.chest_height, 0.006);
        grow(&mut size.waist_height, 0.005);
        grow(&mut size.hip_height, 0.004);
        grow(&mut size.inseam, 0.003);
        grow(&mut size.knee_height, 0.002);
        size
    }
}

impl std::fmt::Display for Size {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.name())
    }
}

impl std::str::FromStr for Size {
    type Err = PatternError;

    fn from_str(name: &str) -> Result<Self, PatternError> {
        let wanted = name.to_lowercase();
        let mut all = Self::ALL.into_iter();
        all.find(|size| size.name() == wanted)
            .ok_or_else(|| PatternError::UnknownSize {
                name: name.to_owned(),
            })
    }
}
