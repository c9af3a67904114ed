//! Sums over neighbors, one for each head, and their backward pass: the inner loops of a FeaStNet convolution.
//!
//! Heads are taken in groups whose sums stay in registers.

use crate::Features;
use crate::lanes::{Lanes, whole};

/// A padded row of heads for each of some edges.
#[derive(Clone, Copy)]
pub(crate) struct HeadRows<'a> {
    pub(crate) values: &'a [f32],
    pub(crate) stride: usize,
    pub(crate) num_heads: usize,
}

impl HeadRows<'_> {
    #[inline(always)]
    fn group<const G: usize>(&self, edge: usize, first_head: usize) -> &[f32; G] {
        let row = &self.values[edge * self.stride + first_head..][..G];
        row.try_into().expect("the slice has G values")
    }
}

/// Heads whose sums are held in registers at once.
const GROUP: usize = 9;

/// Calls a function with the number of heads of each group as a constant.
macro_rules! for_head_groups {
    ($num_heads:expr, $function:ident::<$lanes:ident>($first_head:ident => $($argument:expr),* $(,)?)) => {{
        let num_heads = $num_heads;
        // Groups of about the same size: 16 heads are 8 and 8.
        let group = num_heads.div_ceil(num_heads.div_ceil(GROUP));
        let mut $first_head = 0;
        while $first_head < num_heads {
            let size = group.min(num_heads - $first_head);
            match size {
                1 => $function::<$lanes, 1>($($argument),*),
                2 => $function::<$lanes, 2>($($argument),*),
                3 => $function::<$lanes, 3>($($argument),*),
                4 => $function::<$lanes, 4>($($argument),*),
                5 => $function::<$lanes, 5>($($argument),*),
                6 => $function::<$lanes, 6>($($argument),*),
                7 => $function::<$lanes, 7>($($argument),*),
                8 => $function::<$lanes, 8>($($argument),*),
                _ => $function::<$lanes, 9>($($argument),*),
            }
            $first_head += size;
        }
    }};
}

/// Writes `sums[m][k] = Σ_j weights[j][m] features[j][k]`; the rows of `sums` start `sum_stride` apart.
#[inline(always)]
pub(crate) fn aggregate<V: Lanes>(
    features: Features<'_>,
    neighbors: &[u32],
    weights: HeadRows<'_>,
    sums: &mut [f32],
    sum_stride: usize,
) {
    for_head_groups!(weights.num_heads, aggregate_group::<V>(
        first_head => features, neighbors, weights, first_head, sums, sum_stride,
    ));
}

#[inline(always)]
fn aggregate_group<V: Lanes, const G: usize>(
    features: Features<'_>,
    neighbors: &[u32],
    weights: HeadRows<'_>,
    first_head: usize,
    sums: &mut [f32],
    sum_stride: usize,
) {
    let channels = features.channels;
    let whole = whole::<V>(channels);
    for channel in (0..whole).step_by(V::LANES) {
        let mut group = [V::splat(0.0); G];
        for (edge, &neighbor) in neighbors.iter().enumerate() {
            let x = V::load(&features.values[neighbor as usize * channels + channel..]);
            let weights: &[f32; G] = weights.group(edge, first_head);
            for m in 0..G {
                group[m] = V::splat(weights[m]).mul_add(x, group[m]);
            }
        }
        for m in 0..G {
            group[m].store(&mut sums[(first_head + m) * sum_stride + channel..]);
        }
    }
    if whole < channels {
        let mut group = [V::splat(0.0); G];
        for (edge, &neighbor) in neighbors.iter().enumerate() {
            let x = V::load_part(&features.row(neighbor as usize)[whole..]);
            let weights: &[f32; G] = weights.group(edge, first_head);
            for m in 0..G {
                group[m] = V::splat(weights[m]).mul_add(x, group[m]);
            }
        }
        for m in 0..G {
            let start = (first_head + m) * sum_stride;
            group[m].store_part(&mut sums[start + whole..start + channels]);
        }
    }
}

/// Where the gradients of neighbors are added up.
pub(crate) struct SlotRows<'a> {
    pub(crate) values: &'a mut [f32],
    /// Distance of two slots.
    pub(crate) stride: usize,
    /// First column of the part of the features at hand.
    pub(crate) column: usize,
    /// The slot of each edge.
    pub(crate) slot_of_edge: &'a [u32],
}

/// The backward pass of [`aggregate`], from gradients `d_sums` of its sums.
///
/// Adds `Σ_k d_sums[m][k] features[j][k]` to `d_weights[j][m]` and `Σ_m weights[j][m] d_sums[m][k]` to the
/// slot of each edge.
#[inline(always)]
pub(crate) fn aggregate_backward<V: Lanes>(
    features: Features<'_>,
    neighbors: &[u32],
    weights: HeadRows<'_>,
    (d_sums, sum_stride): (&[f32], usize),
    d_weights: &mut [f32],
    slots: &mut SlotRows<'_>,
) {
    for_head_groups!(weights.num_heads, aggregate_group_backward::<V>(
        first_head => features, neighbors, weights, first_head, (d_sums, sum_stride), d_weights, slots,
    ));
}

#[inline(always)]
fn aggregate_group_backward<V: Lanes, const G: usize>(
    features: Features<'_>,
    neighbors: &[u32],
    weights: HeadRows<'_>,
    first_head: usize,
    (d_sums, sum_stride): (&[f32], usize),
    d_weights: &mut [f32],
    slots: &mut SlotRows<'_>,
) {
    let channels = features.channels;
    let whole = whole::<V>(channels);
    let d_sums: [&[f32]; G] =
        std::array::from_fn(|m| &d_sums[(first_head + m) * sum_stride..][..channels]);
    for (edge, &neighbor) in neighbors.iter().enumerate() {
        let x = features.row(neighbor as usize);
        let slot = slots.slot_of_edge[edge] as usize * slots.stride + slots.column;
        let slot = &mut slots.values[slot..][..channels];
        let w: &[f32; G] = weights.group(edge, first_head);
        let mut dots = [V::splat(0.0); G];
        for channel in (0..whole).step_by(V::LANES) {
            let x = V::load(&x[channel..]);
            let mut message = V::load(&slot[channel..]);
            for m in 0..G {
                let d_sum = V::load(&d_sums[m][channel..]);
                dots[m] = d_sum.mul_add(x, dots[m]);
                message = V::splat(w[m]).mul_add(d_sum, message);
            }
            message.store(&mut slot[channel..]);
        }
        if whole < channels {
            let x = V::load_part(&x[whole..]);
            let mut message = V::load_part(&slot[whole..]);
            for m in 0..G {
                let d_sum = V::load_part(&d_sums[m][whole..]);
                dots[m] = d_sum.mul_add(x, dots[m]);
                message = V::splat(w[m]).mul_add(d_sum, message);
            }
            message.store_part(&mut slot[whole..]);
        }
        let d_weights = &mut d_weights[edge * weights.stride + first_head..][..G];
        for m in 0..G {
            d_weights[m] += dots[m].sum();
        }
    }
}
