//! How the learning rate changes over a training.

use serde::{Deserialize, Serialize};

/// How the learning rate changes over a training.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Schedule {
    /// Not at all, as in the paper.
    Constant,
    /// Half a cosine down to 1 % (*Loshchilov and Hutter 2017*).
    Cosine,
    /// Down to a tenth after two thirds of the steps, to a hundredth after eight ninths.
    Steps,
}

/// The share of all steps in which the learning rate may rise.
const MOST_WARM_UP: f64 = 0.05;

/// The share of the learning rate that a cosine ends with.
const LAST: f64 = 0.01;

impl Schedule {
    /// The share of the learning rate in step `step` of `num_steps`, with `warm_up` first steps in
    /// which it rises; these are a twentieth of all at most.
    pub fn share(self, step: u64, num_steps: u64, warm_up: u32) -> f64 {
        let progress = step as f64 / num_steps.max(1) as f64;
        let share = match self {
            Self::Constant => 1.0,
            Self::Cosine => {
                let wave = f64::midpoint(1.0, (std::f64::consts::PI * progress).cos());
                LAST + (1.0 - LAST) * wave
            }
            Self::Steps if progress < 2.0 / 3.0 => 1.0,
            Self::Steps if progress < 8.0 / 9.0 => 0.1,
            Self::Steps => 0.01,
        };
        let warm_up = f64::from(warm_up).min(MOST_WARM_UP * num_steps as f64);
        let rise = (step + 1) as f64 / (warm_up + 1.0);
        share * rise.min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_start_whole_and_end_low() {
        for (schedule, last) in [(Schedule::Cosine, 0.0102), (Schedule::Steps, 0.01)] {
            assert!((schedule.share(0, 100, 0) - 1.0).abs() < 1e-12);
            assert!((schedule.share(99, 100, 0) - last).abs() < 1e-3);
        }
        assert!((Schedule::Constant.share(99, 100, 0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn rates_rise_in_the_first_steps() {
        let shares: Vec<f64> = (0..5)
            .map(|step| Schedule::Constant.share(step, 100, 3))
            .collect();
        assert_eq!(shares, [0.25, 0.5, 0.75, 1.0, 1.0]);
    }
}
