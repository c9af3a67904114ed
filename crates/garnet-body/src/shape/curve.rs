//! Smooth curves through a few numbers, fast to evaluate.

/// Samples of a curve.
const NUM_SAMPLES: usize = 128;

/// `K` functions of a parameter from 0 to 1 that pass close by given values, without ridges.
///
/// Monotone cubic interpolation keeps the values from overshooting, but bends abruptly at each of
/// them, which shows as a ridge on a lofted surface. So its samples are smoothed with a Gaussian
/// and interpolated by uniform cubic splines.
#[derive(Debug, Clone)]
pub(crate) struct Curves<const K: usize> {
    /// Spline coefficients, one before the first sample and two after the last.
    samples: Vec<[f64; K]>,
}

impl<const K: usize> Curves<K> {
    /// Curves near `values[station]` at the rising parameters `stations`, smoothed with a standard
    /// deviation of `smoothing`.
    pub(crate) fn new(stations: &[f64], values: &[[f64; K]], smoothing: f64) -> Self {
        let slopes = slopes(stations, values);
        let step = 1.0 / (NUM_SAMPLES - 1) as f64;
        let reach = (3.0 * smoothing / step).ceil() as usize;
        let raw: Vec<[f64; K]> = (0..NUM_SAMPLES + 2 * reach)
            .map(|sample| (sample as f64 - reach as f64) * step)
            .map(|parameter| interpolated(stations, values, &slopes, parameter))
            .collect();
        let weight = |offset: usize| {
            let distance = (offset as f64 - reach as f64) * step / smoothing.max(1e-9);
            (-0.5 * distance * distance).exp()
        };
        let weights: Vec<f64> = (0..=2 * reach).map(weight).collect();
        let total: f64 = weights.iter().sum();
        let mut samples: Vec<[f64; K]> = (0..NUM_SAMPLES)
            .map(|sample| {
                let mut sums = [0.0; K];
                for (value, weight) in raw[sample..].iter().zip(&weights) {
                    for k in 0..K {
                        sums[k] += weight * value[k];
                    }
                }
                sums.map(|sum| sum / total)
            })
            .collect();
        let mirrored = |a: [f64; K], b: [f64; K]| std::array::from_fn(|k| 2.0 * a[k] - b[k]);
        let before = mirrored(samples[0], samples[1]);
        let after = mirrored(samples[NUM_SAMPLES - 1], samples[NUM_SAMPLES - 2]);
        samples.insert(0, before);
        samples.push(after);
        samples.push(after);
        Self { samples }
    }

    /// The values at a parameter, which is held within 0 to 1.
    pub(crate) fn at(&self, parameter: f64) -> [f64; K] {
        let place = parameter.clamp(0.0, 1.0) * (NUM_SAMPLES - 1) as f64;
        let cell = (place as usize).min(NUM_SAMPLES - 2);
        let s = place - cell as f64;
        let [a, b, c, d] = [0, 1, 2, 3].map(|offset| &self.samples[cell + offset]);
        // Uniform Catmull-Rom. A plain loop: it is the innermost of all.
        let mut values = [0.0; K];
        for k in 0..K {
            let slope_b = 0.5 * (c[k] - a[k]);
            let slope_c = 0.5 * (d[k] - b[k]);
            let rise = c[k] - b[k];
            values[k] = b[k]
                + s * (slope_b
                    + s * (3.0 * rise - 2.0 * slope_b - slope_c
                        + s * (slope_b + slope_c - 2.0 * rise)));
        }
        values
    }
}

/// Slopes of monotone cubic interpolation: Fritsch and Butland 1984, as in PCHIP.
fn slopes<const K: usize>(stations: &[f64], values: &[[f64; K]]) -> Vec<[f64; K]> {
    let last = stations.len() - 1;
    let width = |cell: usize| stations[cell + 1] - stations[cell];
    let secant = |cell: usize, k: usize| (values[cell + 1][k] - values[cell][k]) / width(cell);
    (0..=last)
        .map(|station| {
            std::array::from_fn(|k| {
                if station == 0 || station == last {
                    return secant(station.min(last - 1), k);
                }
                let (left, right) = (secant(station - 1, k), secant(station, k));
                if left * right <= 0.0 {
                    return 0.0;
                }
                let (h_left, h_right) = (width(station - 1), width(station));
                let weight_left = 2.0 * h_right + h_left;
                let weight_right = h_right + 2.0 * h_left;
                (weight_left + weight_right) / (weight_left / left + weight_right / right)
            })
        })
        .collect()
}

fn interpolated<const K: usize>(
    stations: &[f64],
    values: &[[f64; K]],
    slopes: &[[f64; K]],
    parameter: f64,
) -> [f64; K] {
    let last = stations.len() - 1;
    if parameter <= stations[0] {
        return values[0];
    }
    if parameter >= stations[last] {
        return values[last];
    }
    let cell = stations.partition_point(|&station| station <= parameter) - 1;
    let width = stations[cell + 1] - stations[cell];
    let s = (parameter - stations[cell]) / width;
    std::array::from_fn(|k| {
        let (start, end) = (values[cell][k], values[cell + 1][k]);
        let (out, into) = (slopes[cell][k] * width, slopes[cell + 1][k] * width);
        let rise = end - start;
        start + s * (out + s * (3.0 * rise - 2.0 * out - into + s * (out + into - 2.0 * rise)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_stays_straight() {
        let curve = Curves::new(&[0.0, 0.2, 0.7, 1.0], &[[0.0], [0.2], [0.7], [1.0]], 0.02);
        for step in 2..=8 {
            let parameter = f64::from(step) / 10.0;
            approx::assert_relative_eq!(curve.at(parameter)[0], parameter, epsilon = 1e-3);
        }
    }

    #[test]
    fn smoothing_takes_a_ridge_away_and_keeps_the_ends() {
        let stations = [0.0, 0.5, 1.0];
        let values = [[1.0], [2.0], [1.0]];
        let sharp = Curves::new(&stations, &values, 0.0);
        let smooth = Curves::new(&stations, &values, 0.08);
        assert!((sharp.at(0.5)[0] - 2.0).abs() < 0.01);
        assert!(smooth.at(0.5)[0] < 2.0 && smooth.at(0.5)[0] > 1.9);
        assert!((smooth.at(0.0)[0] - 1.0).abs() < 0.1);
    }
}
