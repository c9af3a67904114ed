//! The definitions in plain `f64` arithmetic, without a thought of speed.

use garnet_kernel::{Activation, Adjacency, LEAKY_SLOPE};

pub(crate) fn activated(activation: Activation, x: f64) -> f64 {
    match activation {
        Activation::LeakyRelu if x <= 0.0 => f64::from(LEAKY_SLOPE) * x,
        _ => x,
    }
}

/// All inputs of a FeaStNet convolution; the order of the fields is that of [`Feast::tensors`].
#[derive(Clone)]
pub(crate) struct Feast {
    pub(crate) x: Vec<f64>,
    pub(crate) u: Vec<f64>,
    pub(crate) c: Vec<f64>,
    pub(crate) w: Vec<f64>,
    pub(crate) b: Vec<f64>,
    pub(crate) residual: Vec<f64>,
}

impl Feast {
    pub(crate) fn tensors(&mut self) -> [(&'static str, &mut Vec<f64>); 6] {
        [
            ("x", &mut self.x),
            ("u", &mut self.u),
            ("c", &mut self.c),
            ("w", &mut self.w),
            ("b", &mut self.b),
            ("residual", &mut self.residual),
        ]
    }

    pub(crate) fn forward(&self, adjacency: &Adjacency, activation: Activation) -> Vec<f64> {
        let num_vertices = adjacency.num_vertices();
        let (num_heads, out) = (self.c.len(), self.b.len());
        let channels = self.x.len() / num_vertices;
        let mut y = self.residual.clone();
        for vertex in 0..num_vertices {
            let y = &mut y[vertex * out..][..out];
            y.iter_mut().zip(&self.b).for_each(|(y, b)| *y += b);
            let own = &self.x[vertex * channels..][..channels];
            let neighbors = adjacency.neighbors(vertex);
            for &neighbor in neighbors {
                let x = &self.x[neighbor as usize * channels..][..channels];
                let logits: Vec<f64> = (0..num_heads)
                    .map(|m| {
                        let steps = x.iter().zip(own).enumerate();
                        self.c[m]
                            + steps
                                .map(|(k, (x, own))| (x - own) * self.u[k * num_heads + m])
                                .sum::<f64>()
                    })
                    .collect();
                let largest = logits.iter().copied().fold(f64::MIN, f64::max);
                let raised: Vec<f64> = logits.iter().map(|logit| (logit - largest).exp()).collect();
                let sum: f64 = raised.iter().sum();
                for m in 0..num_heads {
                    let weight = raised[m] / sum / neighbors.len() as f64;
                    for k in 0..channels {
                        for (o, y) in y.iter_mut().enumerate() {
                            *y += weight * x[k] * self.w[(m * channels + k) * out + o];
                        }
                    }
                }
            }
            y.iter_mut().for_each(|y| *y = activated(activation, *y));
        }
        y
    }
}

/// `act(b + x w)` for one concatenated input.
pub(crate) fn linear(
    x: &[f64],
    w: &[f64],
    b: &[f64],
    rows: usize,
    activation: Activation,
) -> Vec<f64> {
    let (channels, out) = (x.len() / rows, b.len());
    let mut y = Vec::with_capacity(rows * out);
    for row in 0..rows {
        for o in 0..out {
            let terms = (0..channels).map(|k| x[row * channels + k] * w[k * out + o]);
            y.push(activated(activation, b[o] + terms.sum::<f64>()));
        }
    }
    y
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
