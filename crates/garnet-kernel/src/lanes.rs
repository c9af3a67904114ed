//! A vector of numbers, the vocabulary in which kernels are written once for all instruction sets.
//!
//! (The crate `pulp` has the same idea. Its plain vectors call the C library for each fused
//! multiply-add where the processor has none, and its partial loads are jumps into a table.)

/// `LANES` numbers that are added and multiplied at once.
pub(crate) trait Lanes: Copy {
    /// How many numbers.
    const LANES: usize;
    /// As many row numbers.
    type Indices: Copy;

    /// The same number in all lanes.
    fn splat(value: f32) -> Self;
    /// The first `LANES` numbers of a slice, which must have them.
    fn load(values: &[f32]) -> Self;
    /// At most `LANES` numbers of a slice, followed by zeros.
    fn load_part(values: &[f32]) -> Self;
    /// Writes the first `LANES` numbers of a slice, which must have them.
    fn store(self, values: &mut [f32]);
    /// Writes at most `LANES` numbers of a slice.
    fn store_part(self, values: &mut [f32]);

    /// Sums.
    fn add(self, other: Self) -> Self;
    /// Differences.
    fn sub(self, other: Self) -> Self;
    /// Products.
    fn mul(self, other: Self) -> Self;
    /// `self * factor + addend`, rounded once where the processor can.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// The larger ones.
    fn max(self, other: Self) -> Self;
    /// The sum over all lanes.
    fn sum(self) -> f32;
    /// Writes the sum over all lanes of each of some vectors; what follows in `sums` may become
    /// zero.
    #[inline(always)]
    fn store_sums<const G: usize>(vectors: [Self; G], sums: &mut [f32]) {
        for (sum, vector) in sums[..G].iter_mut().zip(vectors) {
            *sum = vector.sum();
        }
    }
    /// The largest lane.
    fn largest(self) -> f32;
    /// Multiplies by two to the power of the integer in the low bits of `shifted`.
    fn scaled_by_power(self, shifted: Self) -> Self;

    /// The same row number in all lanes.
    fn splat_index(index: u32) -> Self::Indices;
    /// Takes `candidate` and its index in the lanes where it is larger than `self`.
    fn larger(
        self,
        index: Self::Indices,
        candidate: Self,
        candidate_index: Self::Indices,
    ) -> (Self, Self::Indices);
    /// Writes at most `LANES` row numbers of a slice.
    fn store_indices(indices: Self::Indices, values: &mut [u32]);

    /// The exponential function for arguments in `[-80, 80]`, others are clamped; relative error
    /// below 2e-7.
    ///
    /// Range reduction by `ln 2` in two parts and a polynomial: Moshier, Cephes, `expf`.
    #[inline(always)]
    fn exp(self) -> Self {
        const ROUND: f32 = 12_582_912.0; // 1.5 * 2^23: adding it leaves an integer in the low bits.
        let x = self.max(Self::splat(-80.0)).min(80.0);
        let shifted = x.mul_add(Self::splat(std::f32::consts::LOG2_E), Self::splat(ROUND));
        let power = shifted.sub(Self::splat(ROUND));
        let x = power.mul_add(Self::splat(-355.0 / 512.0), x);
        let x = power.mul_add(Self::splat(2.121_944_4e-4), x);
        let mut sum = Self::splat(1.987_569_1e-4);
        for coefficient in [
            1.398_2e-3,
            8.333_452e-3,
            4.166_579_6e-2,
            1.666_666_5e-1,
            0.5,
        ] {
            sum = sum.mul_add(x, Self::splat(coefficient));
        }
        sum.mul_add(x.mul(x), x.add(Self::splat(1.0)))
            .scaled_by_power(shifted)
    }

    /// The numbers, at most `bound`.
    #[inline(always)]
    fn min(self, bound: f32) -> Self {
        let minus = Self::splat(-1.0);
        self.mul(minus).max(Self::splat(-bound)).mul(minus)
    }
}

/// Splits a range of `len` numbers into whole vectors and what is left.
#[inline(always)]
pub(crate) fn whole<V: Lanes>(len: usize) -> usize {
    len - len % V::LANES
}
