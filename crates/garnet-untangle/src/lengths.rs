//! Lengths that several passes share.

/// How deep cloth may be in a part of the body and still find its way out, in metres: a little less
/// than the radius of a thigh.
///
/// A larger one frees cloth from thicker limbs, takes longer to search, and lets cloth on one side
/// of a limb be sent to the other.
pub(crate) const DEEPEST: f32 = 0.08;
