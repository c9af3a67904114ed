//! Units and up axes, which OBJ files do not name, guessed from the size of bodies and garments.

use garnet_mesh::{Unit, UpAxis, Vector3};

/// Heights of bodies that a unit must lead to, in metres.
const BODY_HEIGHTS: [f32; 2] = [0.5, 2.6];

/// Largest extents of garments that a unit must lead to, in metres: a sock to a long dress.
const GARMENT_EXTENTS: [f32; 2] = [0.15, 2.4];

/// How much longer the height of a body must be than its depth to tell the two apart.
const CLEAR_RATIO: f32 = 1.5;

/// The unit in which a body of this height is 0.5 to 2.6 m tall, if there is one.
///
/// Each height fits one unit at most: the range spans less than a factor of ten.
pub fn guess_body_unit(height: f32) -> Option<Unit> {
    units_within(height, BODY_HEIGHTS).first().copied()
}

/// The units in which a garment of this largest extent is 0.15 to 2.4 m long, the longest first.
///
/// Two may fit (a dress in decimetres, a cuff in metres); the unit of the body then decides.
pub fn guess_garment_units(largest_extent: f32) -> Vec<Unit> {
    units_within(largest_extent, GARMENT_EXTENTS)
}

/// The up axis of a body with these extents along x, y and z: the longer of y and z.
///
/// Nothing if they are too alike, as of a crouching body.
pub fn guess_up_axis(extent: Vector3) -> Option<UpAxis> {
    if extent.y > CLEAR_RATIO * extent.z {
        return Some(UpAxis::Y);
    }
    (extent.z > CLEAR_RATIO * extent.y).then_some(UpAxis::Z)
}

fn units_within(length: f32, [shortest, longest]: [f32; 2]) -> Vec<Unit> {
    let fits = |unit: &Unit| (shortest..=longest).contains(&(length * unit.in_metres()));
    Unit::METRIC.into_iter().filter(fits).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_body_of_usual_height_has_one_unit() {
        for (height, unit) in [1.7, 17.0, 170.0, 1700.0].into_iter().zip(Unit::METRIC) {
            assert_eq!(guess_body_unit(height), Some(unit));
        }
        for height in [0.0, 0.2, 3e4, f32::NAN, f32::INFINITY] {
            assert_eq!(guess_body_unit(height), None);
        }
    }

    #[test]
    fn a_garment_may_fit_two_units() {
        assert_eq!(guess_garment_units(0.7), [Unit::Metre]);
        assert_eq!(guess_garment_units(2.0), [Unit::Metre, Unit::Decimetre]);
        assert_eq!(guess_garment_units(70.0), [Unit::Centimetre]);
    }

    #[test]
    fn the_up_axis_is_the_longer_of_two() {
        let guess = |x, y, z| guess_up_axis(Vector3::new(x, y, z));
        assert_eq!(guess(1.6, 1.7, 0.3), Some(UpAxis::Y));
        assert_eq!(guess(1.6, 0.3, 1.7), Some(UpAxis::Z));
        assert_eq!(guess(0.5, 0.7, 0.8), None);
    }

    proptest! {
        #[test]
        fn no_height_fits_two_units(height in 1e-3_f32..1e4) {
            prop_assert!(units_within(height, BODY_HEIGHTS).len() <= 1);
        }
    }
}
