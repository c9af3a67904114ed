//! Activation functions that are fused into the layers.

/// Slope of [`Activation::LeakyRelu`] for negative arguments, that of the paper.
pub const LEAKY_SLOPE: f32 = 0.1;

/// What a layer does to its sums before it writes them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Activation {
    /// Nothing.
    #[default]
    None,
    /// `x` for positive `x`, else `0.1 x`. The derivative at zero is taken as `0.1`.
    LeakyRelu,
}

impl Activation {
    /// Replaces sums by activations.
    #[inline(always)]
    pub(crate) fn apply(self, values: &mut [f32]) {
        if self == Self::LeakyRelu {
            // The slope is below one, so the larger of both is the right one.
            values
                .iter_mut()
                .for_each(|value| *value = value.max(LEAKY_SLOPE * *value));
        }
    }

    /// Gradient of the sums from the gradient `dy` of the activations `y`.
    ///
    /// The activation keeps signs, so its output tells which branch was taken.
    #[inline(always)]
    pub(crate) fn gradient(self, y: &[f32], dy: &[f32], d_sum: &mut [f32]) {
        match self {
            Self::None => d_sum.copy_from_slice(dy),
            Self::LeakyRelu => {
                for ((d_sum, y), dy) in d_sum.iter_mut().zip(y).zip(dy) {
                    *d_sum = if *y > 0.0 { *dy } else { LEAKY_SLOPE * *dy };
                }
            }
        }
    }
}
