//! Average precision: which share of the vertices and normals is within a threshold.

use serde::Serialize;

/// Steps of a curve.
const STEPS: usize = 100;

/// Largest distance of a curve, in metres.
const MAX_DISTANCE: f64 = 0.05;

/// Largest angle of a curve, in radians.
const MAX_ANGLE: f64 = std::f64::consts::FRAC_PI_4;

/// The shares under growing thresholds, the first one being zero.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Curve {
    /// In metres or radians.
    pub thresholds: Vec<f64>,
    /// From 0 to 1.
    pub shares: Vec<f64>,
}

/// The curves of a method (*Gundogdu et al. 2020, Fig. 9*).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Curves {
    /// Of the distances of vertices, in metres.
    pub distance: Curve,
    /// Of the angles of face normals, in radians.
    pub normal: Curve,
}

/// Counts values by the first threshold that they are under.
#[derive(Debug, Clone)]
pub(crate) struct Counts {
    max: f64,
    under: Vec<u64>,
    total: u64,
}

impl Counts {
    pub(crate) fn of_distances() -> Self {
        Self::new(MAX_DISTANCE)
    }

    pub(crate) fn of_angles() -> Self {
        Self::new(MAX_ANGLE)
    }

    fn new(max: f64) -> Self {
        Self {
            max,
            under: vec![0; STEPS],
            total: 0,
        }
    }

    pub(crate) fn add(&mut self, values: &[f32]) {
        self.total += values.len() as u64;
        for &value in values {
            let step = f64::from(value) / self.max * STEPS as f64;
            // What is beyond the last threshold, or no number, is under none.
            if step >= 0.0 && step < STEPS as f64 {
                self.under[step as usize] += 1;
            }
        }
    }

    pub(crate) fn curve(&self) -> Curve {
        let total = self.total.max(1) as f64;
        let mut sum = 0;
        let mut shares = vec![0.0];
        for count in &self.under {
            sum += count;
            shares.push(sum as f64 / total);
        }
        let threshold = |step| self.max * f64::from(step) / STEPS as f64;
        Curve {
            thresholds: (0..=STEPS as u32).map(threshold).collect(),
            shares,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_rise_to_those_within_the_last_threshold() {
        let mut counts = Counts::of_distances();
        counts.add(&[0.0001, 0.0249, 0.0251, 0.2, f32::NAN]);
        let curve = counts.curve();
        assert_eq!((curve.thresholds.len(), curve.shares.len()), (101, 101));
        assert!(curve.shares.is_sorted());
        let at = |threshold: f64| {
            let place = curve
                .thresholds
                .iter()
                .position(|t| (t - threshold).abs() < 1e-9);
            curve.shares[place.unwrap()]
        };
        for (threshold, share) in [(0.0, 0.0), (0.0005, 0.2), (0.025, 0.4), (0.05, 0.6)] {
            assert!((at(threshold) - share).abs() < 1e-12, "{threshold}");
        }
    }
}
