//! What cloth is made of.

use crate::SimError;

/// The constants of a fabric, in SI units.
///
/// The membrane is isotropic with Poisson's ratio 1/3, which springs along the edges of a regular
/// mesh give; warp, weft and shear are not told apart.
///
/// Cloth that is pushed together gives way into folds at almost no force. Folds shorter than the
/// edges of a mesh have no place in it, so that its edges stand for them: they resist being
/// shortened by a small share of what they resist being stretched by (the immediate buckling of
/// Choi and Ko 2002, "Stable but responsive cloth"; the relaxed membrane of Pipkin 1986). With all
/// of it cloth that has too much room, over a raised shoulder say, crumples into folds of the mesh
/// that are others on every way to the same pose.
///
/// # Examples
///
/// ```
/// use garnet_sim::Fabric;
///
/// let heavy = Fabric { density: 0.3, ..Fabric::jersey() };
/// assert!(heavy.check().is_ok());
/// assert!(Fabric { density: -1.0, ..heavy }.check().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fabric {
    /// Areal density, kg/m².
    pub density: f32,
    /// Young's modulus times thickness, N/m: the force a metre of width that doubles the length.
    pub membrane: f32,
    /// The share of the membrane's stiffness that acts against being shortened, from 0 to 1: 1 for
    /// a sheet that the mesh is fine enough for.
    pub compression: f32,
    /// Bending rigidity B, N m: the moment a metre of width over the curvature.
    pub bending: f32,
    /// Coulomb's coefficient, of cloth on skin and of cloth on cloth.
    pub friction: f32,
    /// The distance that cloth keeps from skin, in metres.
    pub thickness: f32,
}

/// The distance that cloth keeps from skin unless told otherwise, in metres.
///
/// At 3 mm no vertex of a settled garment is "inside" for the nearest-vertex test of the paper
/// (GarNet++, equation 5), which is wrong for a tenth of all points at 1 mm.
pub const DEFAULT_THICKNESS: f32 = 0.003;

/// What [`Fabric::compression`] is unless told otherwise, a share of the stiffness.
///
/// Larger ones let cloth on raised shoulders crumple into folds that depend on the way there;
/// smaller ones let edges collapse. 0.004 to 1 were tried (docs/experiments/012).
pub const USUAL_COMPRESSION: f32 = 0.01;

/// The names that [`Fabric::named`] knows.
pub const FABRIC_NAMES: [&str; 6] = ["silk", "jersey", "interlock", "cotton", "knit", "denim"];

/// Smallest and largest value and unit of each constant.
const LIMITS: [(&str, f32, f32, &str); 6] = [
    ("density", 0.01, 5.0, "kg/m²"),
    ("membrane stiffness", 1.0, 1e6, "N/m"),
    ("share of the stiffness against compression", 0.0, 1.0, ""),
    ("bending rigidity", 0.0, 0.1, "N m"),
    ("friction", 0.0, 2.0, ""),
    ("thickness", 1e-4, 0.02, "m"),
];

impl Fabric {
    /// Silk or viscose: light and limp.
    ///
    /// The constants of this and the other fabrics are round numbers inside the ranges that
    /// low-stress tests of clothing fabrics give: bending and tension of Kawabata 1980, "The
    /// standardization and analysis of hand evaluation" (1 gf cm²/cm = 9.81e-5 N m), friction of
    /// textiles on skin of 0.25 to 0.45.
    pub const fn silk() -> Self {
        Self::of(0.08, 700.0, 3e-6, 0.25)
    }

    /// Single jersey, as light T-shirts are made of. Its folds are as short as the edges of a
    /// garment of 5000 vertices.
    pub const fn jersey() -> Self {
        Self::of(0.18, 300.0, 5e-6, 0.3)
    }

    /// Interlock and other double knits, as heavy T-shirts are made of: (B / ρ g)^⅓ is 27 mm, two
    /// edges of a T-shirt of 5000 vertices, so that its mesh can hold the folds.
    pub const fn interlock() -> Self {
        Self::of(0.25, 1000.0, 5e-5, 0.3)
    }

    /// The fabric of cotton shirts.
    pub const fn cotton() -> Self {
        Self::of(0.13, 1000.0, 1e-5, 0.3)
    }

    /// The knit of sweaters.
    pub const fn knit() -> Self {
        Self::of(0.30, 200.0, 2e-5, 0.4)
    }

    /// The denim of jeans.
    pub const fn denim() -> Self {
        Self::of(0.40, 2000.0, 2e-4, 0.4)
    }

    /// The fabric of one of [`FABRIC_NAMES`].
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "silk" => Some(Self::silk()),
            "jersey" => Some(Self::jersey()),
            "interlock" => Some(Self::interlock()),
            "cotton" => Some(Self::cotton()),
            "knit" => Some(Self::knit()),
            "denim" => Some(Self::denim()),
            _ => None,
        }
    }

    /// Refuses constants that no fabric has.
    ///
    /// # Errors
    ///
    /// [`SimError::Fabric`] for the first that is NaN or out of its range.
    pub fn check(&self) -> Result<(), SimError> {
        let values = [
            self.density,
            self.membrane,
            self.compression,
            self.bending,
            self.friction,
            self.thickness,
        ];
        for (value, (quantity, min, max, unit)) in values.into_iter().zip(LIMITS) {
            if !(min..=max).contains(&value) {
                return Err(SimError::Fabric {
                    quantity,
                    value,
                    min,
                    max,
                    unit,
                });
            }
        }
        Ok(())
    }

    const fn of(density: f32, membrane: f32, bending: f32, friction: f32) -> Self {
        Self {
            density,
            membrane,
            compression: USUAL_COMPRESSION,
            bending,
            friction,
            thickness: DEFAULT_THICKNESS,
        }
    }
}

impl Default for Fabric {
    /// [`Fabric::jersey`].
    fn default() -> Self {
        Self::jersey()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_named_fabric_is_sound() {
        for name in FABRIC_NAMES {
            assert_eq!(
                Fabric::named(name).map(|fabric| fabric.check()),
                Some(Ok(()))
            );
        }
        assert_eq!(Fabric::named("steel"), None);
    }

    #[test]
    fn an_absurd_constant_is_refused_by_name() {
        let absurd = Fabric {
            bending: f32::NAN,
            ..Fabric::silk()
        };
        let message = absurd.check().unwrap_err().to_string();
        assert!(message.contains("bending rigidity"), "{message}");
        let negative = Fabric {
            membrane: -5.0,
            ..Fabric::silk()
        };
        assert!(matches!(
            negative.check(),
            Err(SimError::Fabric { value: -5.0, .. })
        ));
    }
}
