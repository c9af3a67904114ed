//! When cloth is torn.

/// An edge of cloth that is longer than this over its length at rest is *torn*: no fabric stretches
/// so far. It was sent to different sides of a limb, or a network was wrong.
///
/// This is the one definition of the word; what tears far more is said in multiples of it. A lower
/// limit mends and warns of cloth that is tight alone, as over a shoulder of a raised arm.
pub const TORN_STRETCH: f32 = 2.0;
