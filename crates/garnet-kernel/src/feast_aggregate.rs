//! Sums over neighbors, one for each head, and their backward pass: the inner loops of a FeaStNet
//! convolution.
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

impl<'a> HeadRows<'a> {
    #[inline(always)]
    fn group<const G: usize>(&self, edge: usize, first_head: usize) -> &'a [f32; G] {
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

/// Writes `sums[m][k] = Σ_j weights[j][m] features[j][k]` for a part of the features, in the order
/// of [`Columns`](crate::feast_columns::Columns).
#[inline(always)]
pub(crate) fn aggregate<V: Lanes>(
    features: Features<'_>,
    neighbors: &[u32],
    weights: HeadRows<'_>,
    sums: &mut [f32],
) {
    for_head_groups!(weights.num_heads, aggregate_group::<V>(
        first_head => features, neighbors, weights, first_head, sums,
    ));
}

#[inline(always)]
fn aggregate_group<V: Lanes, const G: usize>(
    features: Features<'_>,
    neighbors: &[u32],
    weights: HeadRows<'_>,
    first_head: usize,
    sums: &mut [f32],
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
        let start = channel * weights.num_heads + first_head * V::LANES;
        let sums = &mut sums[start..start + G * V::LANES];
        for m in 0..G {
            group[m].store(&mut sums[m * V::LANES..]);
        }
    }
    if whole < channels {
        let rest = channels - whole;
        let mut group = [V::splat(0.0); G];
        for (edge, &neighbor) in neighbors.iter().enumerate() {
            let x = V::load_part(&features.row(neighbor as usize)[whole..]);
            let weights: &[f32; G] = weights.group(edge, first_head);
            for m in 0..G {
                group[m] = V::splat(weights[m]).mul_add(x, group[m]);
            }
        }
        let start = whole * weights.num_heads + first_head * rest;
        for m in 0..G {
            group[m].store_part(&mut sums[start + m * rest..][..rest]);
        }
    }
}

/// Where the gradients of neighbors are added up.
pub(crate) struct SlotRows<'a> {
    pub(crate) values: &'a mut [f32],
    /// Distance of two slots.
    pub(crate) stride: usize,
    /// The slot of each edge.
    pub(crate) slot_of_edge: &'a [u32],
}

impl SlotRows<'_> {
    #[inline(always)]
    fn start(&self, edge: usize) -> usize {
        self.slot_of_edge[edge] as usize * self.stride
    }
}

/// The backward pass of [`aggregate`] over all parts of the features, from gradients `d_sums` of
/// the sums.
///
/// Writes `Σ_k d_sums[m][k] features[j][k]` to `d_weights[j][m]` and adds
/// `Σ_m weights[j][m] d_sums[m][k]` to the slot of each edge.
#[inline(always)]
pub(crate) fn aggregate_backward<V: Lanes>(
    features: &[Features<'_>],
    neighbors: &[u32],
    weights: HeadRows<'_>,
    d_sums: &[f32],
    d_weights: &mut [f32],
    slots: &mut SlotRows<'_>,
) {
    for_head_groups!(weights.num_heads, aggregate_group_backward::<V>(
        first_head => features, neighbors, weights, first_head, d_sums, d_weights, slots,
    ));
}

#[inline(always)]
fn aggregate_group_backward<V: Lanes, const G: usize>(
    features: &[Features<'_>],
    neighbors: &[u32],
    weights: HeadRows<'_>,
    first_head: usize,
    d_sums: &[f32],
    d_weights: &mut [f32],
    slots: &mut SlotRows<'_>,
) {
    // With registers enough, two edges share what is loaded of the gradients.
    let pairs = if V::LANES == 16 {
        neighbors.len() / 2
    } else {
        0
    };
    for pair in 0..pairs {
        let edges = [2 * pair, 2 * pair + 1];
        edges_backward::<V, G, 2>(
            features, neighbors, weights, first_head, edges, d_sums, d_weights, slots,
        );
    }
    for edge in 2 * pairs..neighbors.len() {
        edges_backward::<V, G, 1>(
            features,
            neighbors,
            weights,
            first_head,
            [edge],
            d_sums,
            d_weights,
            slots,
        );
    }
}

#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "the inner loop, inlined")]
fn edges_backward<V: Lanes, const G: usize, const E: usize>(
    features: &[Features<'_>],
    neighbors: &[u32],
    weights: HeadRows<'_>,
    first_head: usize,
    edges: [usize; E],
    d_sums: &[f32],
    d_weights: &mut [f32],
    slots: &mut SlotRows<'_>,
) {
    let mut dots = [[V::splat(0.0); G]; E];
    let starts = edges.map(|edge| slots.start(edge));
    let weights_of_edges = edges.map(|edge| weights.group::<G>(edge, first_head));
    let mut column = 0;
    for part in features {
        let channels = part.channels;
        let whole = whole::<V>(channels);
        let rows = edges.map(|edge| part.row(neighbors[edge] as usize));
        let d_sums = &d_sums[column * weights.num_heads..][..channels * weights.num_heads];
        for channel in (0..whole).step_by(V::LANES) {
            let start = channel * weights.num_heads + first_head * V::LANES;
            let d_sums = &d_sums[start..start + G * V::LANES];
            let x: [V; E] = std::array::from_fn(|e| V::load(&rows[e][channel..]));
            let mut messages: [V; E] =
                std::array::from_fn(|e| V::load(&slots.values[starts[e] + column + channel..]));
            for m in 0..G {
                let d_sum = V::load(&d_sums[m * V::LANES..]);
                for e in 0..E {
                    dots[e][m] = d_sum.mul_add(x[e], dots[e][m]);
                    messages[e] = V::splat(weights_of_edges[e][m]).mul_add(d_sum, messages[e]);
                }
            }
            for e in 0..E {
                messages[e].store(&mut slots.values[starts[e] + column + channel..]);
            }
        }
        if whole < channels {
            let rest = channels - whole;
            let start = whole * weights.num_heads + first_head * rest;
            for e in 0..E {
                let slot = starts[e] + column + whole;
                let x = V::load_part(&rows[e][whole..]);
                let mut message = V::load_part(&slots.values[slot..slot + rest]);
                for m in 0..G {
                    let d_sum = V::load_part(&d_sums[start + m * rest..][..rest]);
                    dots[e][m] = d_sum.mul_add(x, dots[e][m]);
                    message = V::splat(weights_of_edges[e][m]).mul_add(d_sum, message);
                }
                message.store_part(&mut slots.values[slot..slot + rest]);
            }
        }
        column += channels;
    }
    for e in 0..E {
        let row = edges[e] * weights.stride;
        V::store_sums(
            dots[e],
            &mut d_weights[row + first_head..row + weights.stride],
        );
    }
}
