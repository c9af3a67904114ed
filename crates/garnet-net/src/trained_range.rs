//! What a network has seen.

use serde::{Deserialize, Serialize};

/// The least and the greatest of the numbers that tell poses and shapes, over all scenes that a
/// network was trained on; whoever trains and whoever asks agree on the numbers.
///
/// ```
/// use garnet_net::TrainedRange;
///
/// let range = TrainedRange::of([[0.0, 1.0], [0.5, -1.0]]).unwrap();
/// assert_eq!(range.excess(&[0.75, 0.0]), [0.25, 0.0]);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainedRange {
    low: Vec<f32>,
    high: Vec<f32>,
}

impl TrainedRange {
    /// Of the numbers of each scene; none without scenes.
    pub fn of(scenes: impl IntoIterator<Item = impl AsRef<[f32]>>) -> Option<Self> {
        let mut scenes = scenes.into_iter();
        let first = scenes.next()?.as_ref().to_vec();
        let mut range = Self {
            low: first.clone(),
            high: first,
        };
        for scene in scenes {
            let ends = range.low.iter_mut().zip(&mut range.high);
            for ((low, high), &number) in ends.zip(scene.as_ref()) {
                *low = low.min(number);
                *high = high.max(number);
            }
        }
        Some(range)
    }

    /// The middle of each number's range.
    pub fn middle(&self) -> Vec<f32> {
        let ends = self.low.iter().zip(&self.high);
        ends.map(|(low, high)| f32::midpoint(*low, *high)).collect()
    }

    /// As [`TrainedRange::excess`], of some of the numbers, from the `first` one on.
    pub fn excess_from(&self, first: usize, numbers: &[f32]) -> Vec<f32> {
        let ends = self.low.iter().zip(&self.high).skip(first);
        ends.zip(numbers)
            .map(|((low, high), number)| (low - number).max(number - high).max(0.0))
            .collect()
    }

    /// How far outside each number is, above or below; as many as both have.
    pub fn excess(&self, numbers: &[f32]) -> Vec<f32> {
        let ends = self.low.iter().zip(&self.high);
        ends.zip(numbers)
            .map(|((low, high), number)| (low - number).max(number - high).max(0.0))
            .collect()
    }
}
