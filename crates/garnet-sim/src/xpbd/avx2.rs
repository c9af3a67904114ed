//! Free motion and springs with vectors of eight numbers: two places side by side. The bits are those of the plain loops.

#![allow(unsafe_code, reason = "vector instructions")]

use std::arch::x86_64::{
    __m256, _CMP_GT_OQ, _mm_load_ps, _mm_store_ps, _mm256_add_ps, _mm256_blend_ps,
    _mm256_blendv_ps, _mm256_castps128_ps256, _mm256_castps256_ps128, _mm256_cmp_ps, _mm256_div_ps,
    _mm256_extractf128_ps, _mm256_insertf128_ps, _mm256_loadu_ps, _mm256_max_ps, _mm256_min_ps,
    _mm256_movemask_ps, _mm256_mul_ps, _mm256_permute_ps, _mm256_set1_ps, _mm256_setr_ps,
    _mm256_setzero_ps, _mm256_sqrt_ps, _mm256_storeu_ps, _mm256_sub_ps,
};

use crate::xpbd::particles::Push;
use crate::xpbd::quad::Quad;
use crate::xpbd::springs::{Block, TINY_SQUARED, WIDTH};

/// Springs that are projected together: each vector has numbers of one spring in its lower half, and of the one four
/// slots later in its upper half.
const SPRINGS: usize = 8;
const _: () = assert!(WIDTH.is_multiple_of(SPRINGS));

/// Projects every spring once.
///
/// # Safety
///
/// The processor has AVX2, and all vertices of the blocks are places of `offsets`.
#[target_feature(enable = "avx2")]
pub(super) unsafe fn project(blocks: &[Block], offsets: &mut [Quad]) {
    let offsets = offsets.as_mut_ptr().cast::<f32>();
    for block in blocks {
        for slot in (0..WIDTH).step_by(SPRINGS) {
            // SAFETY: as asked for; all slots are those of the block.
            unsafe { project_eight(block, slot, offsets) };
        }
    }
}

/// Projects the springs of eight slots.
///
/// # Safety
///
/// Those of [`project`], and there are so many slots from `slot` on.
#[inline]
#[target_feature(enable = "avx2")]
unsafe fn project_eight(block: &Block, slot: usize, offsets: *mut f32) {
    // Where the offset of a vertex begins.
    let place = |vertex: u32| offsets.wrapping_add(4 * vertex as usize);
    // SAFETY: vertices are places, as asked for; a quad has four numbers, aligned to 16 bytes.
    let pair = |ends: &[u32; WIDTH], spring: usize| unsafe {
        let [low, high] = [slot + spring, slot + spring + 4].map(|slot| place(ends[slot]));
        both(low, high)
    };
    // SAFETY: spans are quads.
    let span = |spring: usize| unsafe {
        let [low, high] =
            [slot + spring, slot + spring + 4].map(|slot| block.spans[slot].0.as_ptr());
        both(low, high)
    };
    // SAFETY: there are eight numbers from the slot on, as asked for.
    let of_slots = |numbers: &[f32; WIDTH]| unsafe { _mm256_loadu_ps(numbers.as_ptr().add(slot)) };

    let firsts = [0, 1, 2, 3].map(|spring| pair(&block.first, spring));
    let seconds = [0, 1, 2, 3].map(|spring| pair(&block.second, spring));
    let along = [0, 1, 2, 3].map(|spring| {
        let apart = _mm256_sub_ps(firsts[spring], seconds[spring]);
        _mm256_add_ps(span(spring), apart)
    });
    let [a, b, c, d] = along.map(|along| squared(along));
    let low = _mm256_blend_ps::<0b0010_0010>(a, b);
    let three = _mm256_blend_ps::<0b0100_0100>(low, c);
    let squares = _mm256_blend_ps::<0b1000_1000>(three, d);
    let lengths = _mm256_sqrt_ps(_mm256_add_ps(squares, _mm256_set1_ps(TINY_SQUARED)));
    let share = _mm256_div_ps(of_slots(&block.lengths), lengths);
    let relative = _mm256_sub_ps(_mm256_set1_ps(1.0), share);
    let zero = _mm256_setzero_ps();
    let shortened = _mm256_mul_ps(_mm256_min_ps(relative, zero), of_slots(&block.compressions));
    let stretch = each(_mm256_add_ps(_mm256_max_ps(relative, zero), shortened));
    let first_shares = each(of_slots(&block.first_shares));
    let second_shares = each(of_slots(&block.second_shares));
    for spring in 0..4 {
        let correction = _mm256_mul_ps(along[spring], stretch[spring]);
        let first = _mm256_mul_ps(correction, first_shares[spring]);
        let second = _mm256_mul_ps(correction, second_shares[spring]);
        let first = _mm256_sub_ps(firsts[spring], first);
        let second = _mm256_add_ps(seconds[spring], second);
        for (ends, moved) in [(&block.first, first), (&block.second, second)] {
            let [low, high] = [slot + spring, slot + spring + 4].map(|slot| place(ends[slot]));
            // SAFETY: as for `pair`.
            unsafe {
                _mm_store_ps(low, _mm256_castps256_ps128(moved));
                _mm_store_ps(high, _mm256_extractf128_ps::<1>(moved));
            }
        }
    }
}

/// Lets an even number of vertices fly on; `wind` has as many, or none.
///
/// # Safety
///
/// The processor has AVX2.
#[target_feature(enable = "avx2")]
pub(super) unsafe fn fly(push: &Push, offsets: &mut [Quad], last: &mut [Quad], wind: &[Quad]) {
    let fall = Quad([0.0, -push.gravity, 0.0, 0.0]);
    let fall = twice(&fall);
    let keep = _mm256_set1_ps(push.keep);
    let limit = _mm256_set1_ps(push.max_travel * push.max_travel);
    let nothing = _mm256_setzero_ps();
    let mut wind = wind.chunks_exact(2);
    for (offsets, last) in offsets.chunks_exact_mut(2).zip(last.chunks_exact_mut(2)) {
        let offset = load(offsets);
        let mut travel = _mm256_mul_ps(_mm256_sub_ps(offset, load(last)), keep);
        if let Some(wind) = wind.next() {
            let wind = load(wind);
            let share = _mm256_permute_ps::<0b11_11_11_11>(wind);
            let vector = _mm256_blend_ps::<0b1000_1000>(wind, nothing);
            let gained = _mm256_mul_ps(_mm256_sub_ps(vector, travel), share);
            travel = _mm256_add_ps(travel, gained);
        }
        let squares = squared(travel);
        let is_too_fast = _mm256_cmp_ps::<_CMP_GT_OQ>(squares, limit);
        if _mm256_movemask_ps(is_too_fast) != 0 {
            let slowed = _mm256_mul_ps(travel, _mm256_sqrt_ps(_mm256_div_ps(limit, squares)));
            travel = _mm256_blendv_ps(travel, slowed, is_too_fast);
        }
        store(last, offset);
        store(offsets, _mm256_add_ps(offset, _mm256_add_ps(travel, fall)));
    }
}

/// One quad two times.
#[inline]
#[target_feature(enable = "avx2")]
fn twice(quad: &Quad) -> __m256 {
    let [x, y, z, w] = quad.0;
    _mm256_setr_ps(x, y, z, w, x, y, z, w)
}

/// The first two quads.
#[inline]
#[target_feature(enable = "avx2")]
fn load(quads: &[Quad]) -> __m256 {
    let quads = &quads[..2];
    // SAFETY: two quads are eight numbers.
    unsafe { _mm256_loadu_ps(quads.as_ptr().cast()) }
}

/// Replaces the first two quads.
#[inline]
#[target_feature(enable = "avx2")]
fn store(quads: &mut [Quad], numbers: __m256) {
    let quads = &mut quads[..2];
    // SAFETY: two quads are eight numbers.
    unsafe { _mm256_storeu_ps(quads.as_mut_ptr().cast(), numbers) }
}

/// Two quads side by side.
///
/// # Safety
///
/// Four numbers can be read from each place, which is aligned to 16 bytes.
#[inline]
#[target_feature(enable = "avx2")]
unsafe fn both(low: *const f32, high: *const f32) -> __m256 {
    // SAFETY: as asked for.
    let [low, high] = unsafe { [_mm_load_ps(low), _mm_load_ps(high)] };
    _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(low), high)
}

/// The sum of the squares of each half, in all its lanes: of the first two, plus the third, plus the fourth, which is 0.
#[inline]
#[target_feature(enable = "avx2")]
fn squared(vectors: __m256) -> __m256 {
    let squares = _mm256_mul_ps(vectors, vectors);
    let of_two = _mm256_add_ps(squares, _mm256_permute_ps::<0b10_11_00_01>(squares));
    _mm256_add_ps(of_two, _mm256_permute_ps::<0b01_00_11_10>(of_two))
}

/// Each of the four numbers of both halves in all lanes of its half.
#[inline]
#[target_feature(enable = "avx2")]
fn each(numbers: __m256) -> [__m256; 4] {
    [
        _mm256_permute_ps::<0b00_00_00_00>(numbers),
        _mm256_permute_ps::<0b01_01_01_01>(numbers),
        _mm256_permute_ps::<0b10_10_10_10>(numbers),
        _mm256_permute_ps::<0b11_11_11_11>(numbers),
    ]
}
