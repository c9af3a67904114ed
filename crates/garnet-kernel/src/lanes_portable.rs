//! Eight numbers as an array; the compiler finds the instructions.

use crate::lanes::Lanes;

/// Eight numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Portable([f32; N]);

const N: usize = 8;

impl Portable {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn reduce(self, f: impl Fn(f32, f32) -> f32) -> f32 {
        let a: [f32; 4] = std::array::from_fn(|i| f(self.0[i], self.0[i + 4]));
        f(f(a[0], a[2]), f(a[1], a[3]))
    }
}

impl Lanes for Portable {
    const LANES: usize = N;
    type Indices = [u32; N];

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self([value; N])
    }

    #[inline(always)]
    fn load(values: &[f32]) -> Self {
        Self(std::array::from_fn(|i| values[..N][i]))
    }

    #[inline(always)]
    fn load_part(values: &[f32]) -> Self {
        let mut lanes = [0.0; N];
        lanes
            .iter_mut()
            .zip(values)
            .for_each(|(lane, value)| *lane = *value);
        Self(lanes)
    }

    #[inline(always)]
    fn store(self, values: &mut [f32]) {
        values[..N].copy_from_slice(&self.0);
    }

    #[inline(always)]
    fn store_part(self, values: &mut [f32]) {
        values
            .iter_mut()
            .zip(self.0)
            .for_each(|(value, lane)| *value = lane);
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        // `f32::mul_add` is a call of the C library where the baseline has no such instruction.
        if cfg!(target_arch = "aarch64") {
            Self(std::array::from_fn(|i| {
                self.0[i].mul_add(factor.0[i], addend.0[i])
            }))
        } else {
            self.mul(factor).add(addend)
        }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn sum(self) -> f32 {
        self.reduce(|a, b| a + b)
    }

    #[inline(always)]
    fn largest(self) -> f32 {
        self.reduce(|a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn scaled_by_power(self, shifted: Self) -> Self {
        self.zip(shifted, |a, s| {
            f32::from_bits(a.to_bits().wrapping_add(s.to_bits() << 23))
        })
    }

    #[inline(always)]
    fn splat_index(index: u32) -> [u32; N] {
        [index; N]
    }

    #[inline(always)]
    fn larger(
        self,
        index: [u32; N],
        candidate: Self,
        candidate_index: [u32; N],
    ) -> (Self, [u32; N]) {
        let is_larger: [bool; N] = std::array::from_fn(|i| candidate.0[i] > self.0[i]);
        (
            Self(std::array::from_fn(|i| {
                if is_larger[i] {
                    candidate.0[i]
                } else {
                    self.0[i]
                }
            })),
            std::array::from_fn(|i| {
                if is_larger[i] {
                    candidate_index[i]
                } else {
                    index[i]
                }
            }),
        )
    }

    #[inline(always)]
    fn store_indices(indices: [u32; N], values: &mut [u32]) {
        values
            .iter_mut()
            .zip(indices)
            .for_each(|(value, index)| *value = index);
    }
}
