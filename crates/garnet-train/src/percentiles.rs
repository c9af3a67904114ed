//! What half and nearly all values are below.

use serde::{Deserialize, Serialize};

/// Median and 95th percentile.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Percentiles {
    /// Half are below.
    pub median: f64,
    /// 95 of 100 are below.
    pub p95: f64,
}

impl Percentiles {
    /// Of values in any order: each is one of the values; zeros of none.
    ///
    /// ```
    /// use garnet_train::Percentiles;
    ///
    /// let found = Percentiles::of(vec![3.0, 1.0, 2.0]);
    /// assert_eq!((found.median, found.p95), (2.0, 3.0));
    /// ```
    pub fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let at = |percent: usize| {
            let last = values.len().saturating_sub(1);
            values
                .get((last * percent).div_ceil(100))
                .copied()
                .unwrap_or(0.0)
        };
        Self {
            median: at(50),
            p95: at(95),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_values() {
        let values = (1..=101).rev().map(f64::from).collect();
        let expected = Percentiles {
            median: 51.0,
            p95: 96.0,
        };
        assert_eq!(Percentiles::of(values), expected);
        assert_eq!(Percentiles::of(Vec::new()), Percentiles::default());
        let one = Percentiles::of(vec![4.0]);
        assert_eq!(
            one,
            Percentiles {
                median: 4.0,
                p95: 4.0
            }
        );
    }
}
