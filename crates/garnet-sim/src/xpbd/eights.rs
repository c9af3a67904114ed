//! Free motion, springs and hinges with vectors of eight numbers: two vertices side by side. The
//! bits are those of the plain loops.

#![expect(
    clippy::inline_always,
    reason = "vector instructions are inlined into functions that may use them alone"
)]

use std::arch::x86_64::{__m256, _CMP_GT_OQ};

use pulp::cast;
use pulp::x86::V3;

use crate::xpbd::bending::Row;
use crate::xpbd::particles::Push;
use crate::xpbd::quad::Quad;
use crate::xpbd::springs::{Block, TINY_SQUARED, WIDTH};

/// Springs that are projected together: each vector has numbers of one spring in its lower half,
/// and of the one four slots later in its upper half.
const SPRINGS: usize = 8;
const _: () = assert!(WIDTH.is_multiple_of(SPRINGS));

/// Projects every spring once, if the processor can; tells whether it did.
pub(super) fn project(blocks: &[Block], offsets: &mut [Quad]) -> bool {
    let Some(simd) = V3::try_new() else {
        return false;
    };
    simd.vectorize(
        #[inline(always)]
        || {
            for block in blocks {
                for slot in (0..WIDTH).step_by(SPRINGS) {
                    project_eight(simd, block, slot, offsets);
                }
            }
        },
    );
    true
}

/// Projects the springs of eight slots.
#[inline(always)]
fn project_eight(simd: V3, block: &Block, slot: usize, offsets: &mut [Quad]) {
    let avx = simd.avx;
    let firsts = ends(simd, &block.first, slot, offsets);
    let seconds = ends(simd, &block.second, slot, offsets);
    let [a, b, c, d] = [0, 1, 2, 3];
    let along = |spring: usize| {
        let span = both(
            simd,
            block.spans[slot + spring],
            block.spans[slot + spring + 4],
        );
        avx._mm256_add_ps(span, avx._mm256_sub_ps(firsts[spring], seconds[spring]))
    };
    let along = [along(a), along(b), along(c), along(d)];
    let low = avx._mm256_blend_ps::<0b0010_0010>(squared(simd, along[a]), squared(simd, along[b]));
    let high = avx._mm256_blend_ps::<0b1000_1000>(squared(simd, along[c]), squared(simd, along[d]));
    let squares = avx._mm256_blend_ps::<0b1100_1100>(low, high);
    let tiny = avx._mm256_set1_ps(TINY_SQUARED);
    let lengths = avx._mm256_sqrt_ps(avx._mm256_add_ps(squares, tiny));
    let share = avx._mm256_div_ps(eight(&block.lengths, slot), lengths);
    let relative = avx._mm256_sub_ps(avx._mm256_set1_ps(1.0), share);
    let zero = avx._mm256_setzero_ps();
    let shortened = avx._mm256_mul_ps(
        avx._mm256_min_ps(relative, zero),
        eight(&block.compressions, slot),
    );
    let stretch = avx._mm256_add_ps(avx._mm256_max_ps(relative, zero), shortened);
    let stretch = each(simd, stretch);
    let first_shares = each(simd, eight(&block.first_shares, slot));
    let second_shares = each(simd, eight(&block.second_shares, slot));
    for spring in [a, b, c, d] {
        let correction = avx._mm256_mul_ps(along[spring], stretch[spring]);
        let first = avx._mm256_mul_ps(correction, first_shares[spring]);
        let second = avx._mm256_mul_ps(correction, second_shares[spring]);
        let first = avx._mm256_sub_ps(firsts[spring], first);
        let second = avx._mm256_add_ps(seconds[spring], second);
        for (ends, moved) in [(&block.first, first), (&block.second, second)] {
            let [low, high] = [ends[slot + spring], ends[slot + spring + 4]];
            [offsets[low as usize], offsets[high as usize]] = quads(moved);
        }
    }
}

/// Projects every hinge once, if the processor can; tells whether it did. Of an even number of rows
/// each two share no vertex.
pub(super) fn bend(rows: &[Row], offsets: &mut [Quad]) -> bool {
    let Some(simd) = V3::try_new() else {
        return false;
    };
    simd.vectorize(
        #[inline(always)]
        || {
            let avx = simd.avx;
            let (pairs, _) = rows.as_chunks::<2>();
            for [low, high] in pairs {
                let [la, lb, lc, ld] = low.vertices.map(|vertex| vertex as usize);
                let [ha, hb, hc, hd] = high.vertices.map(|vertex| vertex as usize);
                let a = both(simd, offsets[la], offsets[ha]);
                let b = both(simd, offsets[lb], offsets[hb]);
                let c = both(simd, offsets[lc], offsets[hc]);
                let d = both(simd, offsets[ld], offsets[hd]);
                let [wa, wb, wc, wd] = each(simd, both(simd, low.weights, high.weights));
                let [ra, rb, rc, rd] = each(simd, both(simd, low.responses, high.responses));
                let base = both(simd, low.base, high.base);
                let first = avx._mm256_add_ps(base, avx._mm256_mul_ps(a, wa));
                let first = avx._mm256_add_ps(first, avx._mm256_mul_ps(b, wb));
                let second = avx._mm256_add_ps(avx._mm256_mul_ps(c, wc), avx._mm256_mul_ps(d, wd));
                let fold = avx._mm256_add_ps(first, second);
                [offsets[la], offsets[ha]] =
                    quads(avx._mm256_add_ps(a, avx._mm256_mul_ps(fold, ra)));
                [offsets[lb], offsets[hb]] =
                    quads(avx._mm256_add_ps(b, avx._mm256_mul_ps(fold, rb)));
                [offsets[lc], offsets[hc]] =
                    quads(avx._mm256_add_ps(c, avx._mm256_mul_ps(fold, rc)));
                [offsets[ld], offsets[hd]] =
                    quads(avx._mm256_add_ps(d, avx._mm256_mul_ps(fold, rd)));
            }
        },
    );
    true
}

/// Lets an even number of vertices fly on, if the processor can, and tells whether it did; `wind`
/// has as many, or none.
pub(super) fn fly(push: Push, offsets: &mut [Quad], last: &mut [Quad], wind: &[Quad]) -> bool {
    let Some(simd) = V3::try_new() else {
        return false;
    };
    simd.vectorize(
        #[inline(always)]
        || {
            let avx = simd.avx;
            let fall = Quad([0.0, -push.gravity, 0.0, 0.0]);
            let fall = both(simd, fall, fall);
            let keep = avx._mm256_set1_ps(push.keep);
            let limit = avx._mm256_set1_ps(push.max_travel * push.max_travel);
            let (offsets, _) = offsets.as_chunks_mut::<2>();
            let (last, _) = last.as_chunks_mut::<2>();
            let mut wind = wind.as_chunks::<2>().0.iter();
            for (offset, last) in offsets.iter_mut().zip(last) {
                let from = both(simd, offset[0], offset[1]);
                let before = both(simd, last[0], last[1]);
                let mut travel = avx._mm256_mul_ps(avx._mm256_sub_ps(from, before), keep);
                if let Some(wind) = wind.next() {
                    let wind = both(simd, wind[0], wind[1]);
                    let share = avx._mm256_permute_ps::<0b11_11_11_11>(wind);
                    let vector = avx._mm256_blend_ps::<0b1000_1000>(wind, avx._mm256_setzero_ps());
                    let gained = avx._mm256_mul_ps(avx._mm256_sub_ps(vector, travel), share);
                    travel = avx._mm256_add_ps(travel, gained);
                }
                let squares = squared(simd, travel);
                let is_too_fast = avx._mm256_cmp_ps::<_CMP_GT_OQ>(squares, limit);
                if avx._mm256_movemask_ps(is_too_fast) != 0 {
                    let slower = avx._mm256_sqrt_ps(avx._mm256_div_ps(limit, squares));
                    let slowed = avx._mm256_mul_ps(travel, slower);
                    travel = avx._mm256_blendv_ps(travel, slowed, is_too_fast);
                }
                *last = *offset;
                *offset = quads(avx._mm256_add_ps(from, avx._mm256_add_ps(travel, fall)));
            }
        },
    );
    true
}

/// The offsets of one end of each of four springs from a slot on, and of the next four.
#[inline(always)]
fn ends(simd: V3, vertices: &[u32; WIDTH], slot: usize, offsets: &[Quad]) -> [__m256; 4] {
    let end = |slot: usize| {
        let [low, high] = [vertices[slot], vertices[slot + 4]];
        both(simd, offsets[low as usize], offsets[high as usize])
    };
    [end(slot), end(slot + 1), end(slot + 2), end(slot + 3)]
}

/// Two quads side by side.
#[inline(always)]
fn both(simd: V3, low: Quad, high: Quad) -> __m256 {
    let low = simd.avx._mm256_castps128_ps256(cast(low.0));
    simd.avx._mm256_insertf128_ps::<1>(low, cast(high.0))
}

/// The halves.
#[inline(always)]
fn quads(numbers: __m256) -> [Quad; 2] {
    let [low, high]: [[f32; 4]; 2] = cast(numbers);
    [Quad(low), Quad(high)]
}

/// Eight numbers from a slot on.
#[inline(always)]
fn eight(numbers: &[f32; WIDTH], slot: usize) -> __m256 {
    let (eights, _) = numbers.as_chunks::<SPRINGS>();
    cast(eights[slot / SPRINGS])
}

/// The sum of the squares of each half, in all its lanes: of the first two, plus the third, plus
/// the fourth, which is 0.
#[inline(always)]
fn squared(simd: V3, vectors: __m256) -> __m256 {
    let avx = simd.avx;
    let squares = avx._mm256_mul_ps(vectors, vectors);
    let of_two = avx._mm256_add_ps(squares, avx._mm256_permute_ps::<0b10_11_00_01>(squares));
    avx._mm256_add_ps(of_two, avx._mm256_permute_ps::<0b01_00_11_10>(of_two))
}

/// Each of the four numbers of both halves in all lanes of its half.
#[inline(always)]
fn each(simd: V3, numbers: __m256) -> [__m256; 4] {
    let avx = simd.avx;
    [
        avx._mm256_permute_ps::<0b00_00_00_00>(numbers),
        avx._mm256_permute_ps::<0b01_01_01_01>(numbers),
        avx._mm256_permute_ps::<0b10_10_10_10>(numbers),
        avx._mm256_permute_ps::<0b11_11_11_11>(numbers),
    ]
}
