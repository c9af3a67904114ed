//! Colors that go well together: a strong garment over a neutral body.

use crate::Rgb;

/// Neutral grey with a little warmth, for bodies.
pub const SKIN: Rgb = Rgb::new(190, 181, 173);

/// Garnet red, for the garment in question.
pub const GARMENT: Rgb = Rgb::new(178, 40, 62);

/// Blue, for a second garment: a reference, or the garment before a change.
pub const REFERENCE: Rgb = Rgb::new(52, 104, 176);

/// Green, for a third garment.
pub const THIRD: Rgb = Rgb::new(64, 145, 108);

/// The white behind everything, slightly toned down so that lit cloth stands out.
pub const BACKGROUND: Rgb = Rgb::new(240, 241, 243);

/// Letters and ticks.
pub const INK: Rgb = Rgb::new(48, 50, 56);

/// Wireframes over a shaded surface.
pub const WIRE: Rgb = Rgb::new(24, 24, 30);

/// A value that is infinite or not a number.
pub const NON_FINITE: Rgb = Rgb::new(255, 0, 255);
