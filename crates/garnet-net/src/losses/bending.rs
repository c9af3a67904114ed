//! `L_bend`: distances between vertices two edges apart.

use super::gradient::{Gradient, Place};

/// The mean absolute change of distance over the two-ring pairs N₂.
///
/// ```text
/// L_bend = 1/|N₂| Σ_{i,k} | ‖G_i^P − G_k^P‖ − ‖G_i^G − G_k^G‖ |
/// ```
///
/// Source: *Gundogdu et al. 2020, Eq. 7*.
pub(crate) fn bending_loss(
    predicted: &[Place],
    pairs: &[[u32; 2]],
    target_lengths: &[f64],
    gradient: &mut Gradient<'_>,
) -> f64 {
    let share = 1.0 / pairs.len().max(1) as f64;
    let mut sum = 0.0;
    for (&[i, k], target) in pairs.iter().zip(target_lengths) {
        let between = predicted[i as usize] - predicted[k as usize];
        let length = between.norm();
        let change = length - target;
        sum += change.abs();
        if length > 0.0 && change != 0.0 {
            let derivative = share * change.signum() / length * between;
            gradient.add(i, derivative);
            gradient.add(k, -derivative);
        }
    }
    share * sum
}

/// The distances of pairs.
pub(crate) fn pair_lengths(places: &[Place], pairs: &[[u32; 2]]) -> Vec<f64> {
    let length = |&[i, k]: &[u32; 2]| (places[i as usize] - places[k as usize]).norm();
    pairs.iter().map(length).collect()
}
