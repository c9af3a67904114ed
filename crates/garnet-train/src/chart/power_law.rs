//! How costs grow.

use serde::Serialize;

/// `y = factor · x^exponent`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PowerLaw {
    /// The value at 1.
    pub factor: f64,
    /// How fast it grows.
    pub exponent: f64,
}

impl PowerLaw {
    /// Through points above zero, by least squares of the logarithms; none without two different
    /// places.
    ///
    /// ```
    /// use garnet_train::chart::PowerLaw;
    ///
    /// let law = PowerLaw::fit(&[[1.0, 3.0], [2.0, 12.0], [10.0, 300.0]]).unwrap();
    /// assert!((law.exponent - 2.0).abs() < 1e-9 && (law.at(3.0) - 27.0).abs() < 1e-9);
    /// ```
    pub fn fit(points: &[[f64; 2]]) -> Option<Self> {
        let logarithms = points.iter().map(|point| point.map(f64::ln));
        let logarithms = logarithms.filter(|point| point.iter().all(|value| value.is_finite()));
        let logarithms: Vec<[f64; 2]> = logarithms.collect();
        let count = logarithms.len() as f64;
        let [x, y] = [0, 1].map(|axis| {
            let sum: f64 = logarithms.iter().map(|point| point[axis]).sum();
            sum / count
        });
        let mut products = [0.0; 2];
        for point in &logarithms {
            products[0] += (point[0] - x) * (point[0] - x);
            products[1] += (point[0] - x) * (point[1] - y);
        }
        if logarithms.len() < 2 || products[0] < 1e-12 {
            return None;
        }
        let exponent = products[1] / products[0];
        Some(Self {
            factor: (y - exponent * x).exp(),
            exponent,
        })
    }

    /// Its value.
    pub fn at(self, x: f64) -> f64 {
        self.factor * x.powf(self.exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exact_law_is_recovered() {
        let law = PowerLaw {
            factor: 2.5e-6,
            exponent: 1.37,
        };
        let points = [1e3, 2e3, 5e3, 2e4, 5e4].map(|x| [x, law.at(x)]);
        let found = PowerLaw::fit(&points).unwrap();
        assert!((found.exponent - law.exponent).abs() < 1e-9);
        assert!((found.factor / law.factor - 1.0).abs() < 1e-9);
    }

    #[test]
    fn two_places_are_needed() {
        assert_eq!(PowerLaw::fit(&[]), None);
        assert_eq!(PowerLaw::fit(&[[1.0, 2.0], [1.0, 3.0]]), None);
        assert_eq!(PowerLaw::fit(&[[1.0, 2.0], [2.0, 0.0]]), None);
    }
}
