//! Random numbers.

use rand::Rng;

/// A number from 0 to 1, without 1: the same on every machine for the same bits of the source.
pub fn uniform(source: &mut impl Rng) -> f64 {
    (source.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}
