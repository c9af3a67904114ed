//! Eight numbers in an AVX register, with FMA.
//!
//! Every function here is inlined into one that is compiled for AVX2 and FMA and called only where
//! the processor has them (`InstructionSet::run`): that is the condition of safety of all the
//! intrinsics.

#![allow(unsafe_code, reason = "vector instructions")]

use std::arch::x86_64::{
    __m128, __m256, __m256i, _CMP_GT_OQ, _mm_add_ps, _mm_add_ss, _mm_cvtss_f32, _mm_max_ps,
    _mm_max_ss, _mm_movehl_ps, _mm_shuffle_ps, _mm256_add_epi32, _mm256_add_ps, _mm256_blendv_ps,
    _mm256_castps_si256, _mm256_castps256_ps128, _mm256_castsi256_ps, _mm256_cmp_ps,
    _mm256_extractf128_ps, _mm256_fmadd_ps, _mm256_loadu_ps, _mm256_loadu_si256,
    _mm256_maskload_ps, _mm256_maskstore_epi32, _mm256_maskstore_ps, _mm256_max_ps, _mm256_mul_ps,
    _mm256_set1_epi32, _mm256_set1_ps, _mm256_slli_epi32, _mm256_storeu_ps, _mm256_sub_ps,
};

use crate::lanes::Lanes;

/// Eight numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Avx2(__m256);

const N: usize = 8;

/// Lanes are chosen by sign bits; a window that starts at `8 - len` chooses the first `len`.
static WINDOW: [i32; 16] = [-1, -1, -1, -1, -1, -1, -1, -1, 0, 0, 0, 0, 0, 0, 0, 0];

/// A mask of the first `len` lanes, all for `len` from 8 on.
#[inline(always)]
fn first_lanes(len: usize) -> __m256i {
    let window = &WINDOW[N - len.min(N)..][..N];
    // SAFETY: the instructions exist (head of this file); the window has 8 values.
    unsafe { _mm256_loadu_si256(window.as_ptr().cast()) }
}

#[inline(always)]
fn halves(value: __m256) -> (__m128, __m128) {
    // SAFETY: the instructions exist (head of this file).
    unsafe {
        (
            _mm256_castps256_ps128(value),
            _mm256_extractf128_ps::<1>(value),
        )
    }
}

// SAFETY of all blocks below: the instructions exist (head of this file); loads and stores of whole
// vectors are preceded by a check of the length, those of parts touch no lane beyond the slice.
impl Lanes for Avx2 {
    const LANES: usize = N;
    type Indices = __m256i;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_set1_ps(value) })
    }

    #[inline(always)]
    fn load(values: &[f32]) -> Self {
        let values = &values[..N];
        // SAFETY: see above.
        Self(unsafe { _mm256_loadu_ps(values.as_ptr()) })
    }

    #[inline(always)]
    fn load_part(values: &[f32]) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_maskload_ps(values.as_ptr(), first_lanes(values.len())) })
    }

    #[inline(always)]
    fn store(self, values: &mut [f32]) {
        let values = &mut values[..N];
        // SAFETY: see above.
        unsafe { _mm256_storeu_ps(values.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn store_part(self, values: &mut [f32]) {
        // SAFETY: see above.
        unsafe { _mm256_maskstore_ps(values.as_mut_ptr(), first_lanes(values.len()), self.0) }
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_add_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_sub_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_mul_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_fmadd_ps(self.0, factor.0, addend.0) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_max_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn sum(self) -> f32 {
        let (low, high) = halves(self.0);
        // SAFETY: see above.
        unsafe {
            let four = _mm_add_ps(low, high);
            let two = _mm_add_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_add_ss(two, _mm_shuffle_ps::<1>(two, two)))
        }
    }

    #[inline(always)]
    fn largest(self) -> f32 {
        let (low, high) = halves(self.0);
        // SAFETY: see above.
        unsafe {
            let four = _mm_max_ps(low, high);
            let two = _mm_max_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_max_ss(two, _mm_shuffle_ps::<1>(two, two)))
        }
    }

    #[inline(always)]
    fn scaled_by_power(self, shifted: Self) -> Self {
        // SAFETY: see above.
        unsafe {
            let exponent = _mm256_slli_epi32::<23>(_mm256_castps_si256(shifted.0));
            Self(_mm256_castsi256_ps(_mm256_add_epi32(
                _mm256_castps_si256(self.0),
                exponent,
            )))
        }
    }

    #[inline(always)]
    fn splat_index(index: u32) -> __m256i {
        // SAFETY: see above.
        unsafe { _mm256_set1_epi32(index.cast_signed()) }
    }

    #[inline(always)]
    fn larger(self, index: __m256i, candidate: Self, candidate_index: __m256i) -> (Self, __m256i) {
        // SAFETY: see above.
        unsafe {
            let is_larger = _mm256_cmp_ps::<_CMP_GT_OQ>(candidate.0, self.0);
            let indices = _mm256_blendv_ps(
                _mm256_castsi256_ps(index),
                _mm256_castsi256_ps(candidate_index),
                is_larger,
            );
            (
                Self(_mm256_blendv_ps(self.0, candidate.0, is_larger)),
                _mm256_castps_si256(indices),
            )
        }
    }

    #[inline(always)]
    fn store_indices(indices: __m256i, values: &mut [u32]) {
        // SAFETY: see above.
        unsafe {
            _mm256_maskstore_epi32(
                values.as_mut_ptr().cast(),
                first_lanes(values.len()),
                indices,
            );
        }
    }
}
