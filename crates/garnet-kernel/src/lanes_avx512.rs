//! Sixteen numbers in an AVX-512 register.
//!
//! Every function here is inlined into one that is compiled for AVX-512 and called only where the
//! processor has it (`InstructionSet::run`): that is the condition of safety of all the intrinsics.

#![allow(unsafe_code, reason = "vector instructions")]

use std::arch::x86_64::{
    __m512, __m512i, __mmask16, _CMP_GT_OQ, _mm512_add_epi32, _mm512_add_ps, _mm512_castpd_ps,
    _mm512_castps_pd, _mm512_castps_si512, _mm512_castsi512_ps, _mm512_cmp_ps_mask,
    _mm512_fmadd_ps, _mm512_loadu_ps, _mm512_mask_blend_epi32, _mm512_mask_blend_ps,
    _mm512_mask_storeu_epi32, _mm512_mask_storeu_ps, _mm512_maskz_loadu_ps, _mm512_maskz_mov_ps,
    _mm512_max_ps, _mm512_mul_ps, _mm512_reduce_add_ps, _mm512_reduce_max_ps, _mm512_set1_epi32,
    _mm512_set1_ps, _mm512_shuffle_f32x4, _mm512_slli_epi32, _mm512_storeu_ps, _mm512_sub_ps,
    _mm512_unpackhi_pd, _mm512_unpackhi_ps, _mm512_unpacklo_pd, _mm512_unpacklo_ps,
};

use crate::lanes::Lanes;

/// Sixteen numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Avx512(__m512);

const N: usize = 16;

/// A mask of the first `len` lanes, all for `len` from 16 on.
#[inline(always)]
fn first_lanes(len: usize) -> __mmask16 {
    if len >= N { !0 } else { (1 << len) - 1 }
}

/// The sums over all lanes of eight vectors, in the first eight lanes: a tree of shuffles that all
/// share.
#[inline(always)]
fn sums_of_eight(v: [__m512; 8]) -> __m512 {
    // SAFETY: the instructions exist (head of this file).
    unsafe {
        let two = |a, b| _mm512_add_ps(_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
        let four = |a, b| {
            let (a, b) = (_mm512_castps_pd(a), _mm512_castps_pd(b));
            _mm512_add_ps(
                _mm512_castpd_ps(_mm512_unpacklo_pd(a, b)),
                _mm512_castpd_ps(_mm512_unpackhi_pd(a, b)),
            )
        };
        // Each quarter has partial sums of the same four vectors.
        let low = four(two(v[0], v[1]), two(v[2], v[3]));
        let high = four(two(v[4], v[5]), two(v[6], v[7]));
        let halves = _mm512_add_ps(
            _mm512_shuffle_f32x4::<0b10_00_10_00>(low, high),
            _mm512_shuffle_f32x4::<0b11_01_11_01>(low, high),
        );
        _mm512_add_ps(
            _mm512_shuffle_f32x4::<0b10_00_10_00>(halves, halves),
            _mm512_shuffle_f32x4::<0b11_01_11_01>(halves, halves),
        )
    }
}

// SAFETY of all blocks below: the instructions exist (head of this file); loads and stores of whole
// vectors are preceded by a check of the length, those of parts touch no lane beyond the slice.
impl Lanes for Avx512 {
    const LANES: usize = N;
    type Indices = __m512i;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_set1_ps(value) })
    }

    #[inline(always)]
    fn load(values: &[f32]) -> Self {
        let values = &values[..N];
        // SAFETY: see above.
        Self(unsafe { _mm512_loadu_ps(values.as_ptr()) })
    }

    #[inline(always)]
    fn load_part(values: &[f32]) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_maskz_loadu_ps(first_lanes(values.len()), values.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, values: &mut [f32]) {
        let values = &mut values[..N];
        // SAFETY: see above.
        unsafe { _mm512_storeu_ps(values.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn store_part(self, values: &mut [f32]) {
        // SAFETY: see above.
        unsafe { _mm512_mask_storeu_ps(values.as_mut_ptr(), first_lanes(values.len()), self.0) }
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_add_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_sub_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_mul_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_fmadd_ps(self.0, factor.0, addend.0) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_max_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn sum(self) -> f32 {
        // SAFETY: see above.
        unsafe { _mm512_reduce_add_ps(self.0) }
    }

    #[inline(always)]
    fn store_sums<const G: usize>(vectors: [Self; G], sums: &mut [f32]) {
        let mut first = 0;
        while first < G {
            let vector = |number: usize| {
                let none = Self::splat(0.0);
                (vectors.get(first + number)).map_or(none.0, |vector| vector.0)
            };
            // SAFETY: see above.
            let eight = unsafe {
                let eight = sums_of_eight(std::array::from_fn(vector));
                Self(_mm512_maskz_mov_ps(first_lanes((G - first).min(8)), eight))
            };
            // Whole vectors, that are read again soon: what is written with a mask is slow to read.
            if sums.len() >= first + N {
                eight.store(&mut sums[first..]);
            } else {
                eight.store_part(&mut sums[first..]);
            }
            first += 8;
        }
    }

    #[inline(always)]
    fn largest(self) -> f32 {
        // SAFETY: see above.
        unsafe { _mm512_reduce_max_ps(self.0) }
    }

    #[inline(always)]
    fn scaled_by_power(self, shifted: Self) -> Self {
        // SAFETY: see above.
        unsafe {
            let exponent = _mm512_slli_epi32::<23>(_mm512_castps_si512(shifted.0));
            Self(_mm512_castsi512_ps(_mm512_add_epi32(
                _mm512_castps_si512(self.0),
                exponent,
            )))
        }
    }

    #[inline(always)]
    fn splat_index(index: u32) -> __m512i {
        // SAFETY: see above.
        unsafe { _mm512_set1_epi32(index.cast_signed()) }
    }

    #[inline(always)]
    fn larger(self, index: __m512i, candidate: Self, candidate_index: __m512i) -> (Self, __m512i) {
        // SAFETY: see above.
        unsafe {
            let is_larger = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(candidate.0, self.0);
            (
                Self(_mm512_mask_blend_ps(is_larger, self.0, candidate.0)),
                _mm512_mask_blend_epi32(is_larger, index, candidate_index),
            )
        }
    }

    #[inline(always)]
    fn store_indices(indices: __m512i, values: &mut [u32]) {
        // SAFETY: see above.
        unsafe {
            _mm512_mask_storeu_epi32(
                values.as_mut_ptr().cast(),
                first_lanes(values.len()),
                indices,
            );
        }
    }
}
