//! `L_RQ`: the Rayleigh quotients of neighborhoods.

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::gradient::{Gradient, Place};

/// Neighborhoods of one size: `[vertex][neighbor]`, each vertex among its own neighbors.
#[derive(Debug, Clone)]
pub(crate) struct Neighborhoods {
    pub(crate) indices: Vec<u32>,
    pub(crate) size: usize,
}

/// A neighbor whose squared distance from the centroid is below this share of the mean one has no
/// direction: its quotient is left out.
const MIN_SHARE: f64 = 1e-4;

/// The least and the greatest quotient of a neighborhood.
pub(crate) type Extremes = [f64; 2];

/// Vertices per unit of parallel work.
const CHUNK: usize = 256;

/// A neighborhood about its centroid, and the numbers of the extreme neighbors.
struct Spread {
    centered: Vec<Place>,
    covariance: Matrix3<f64>,
    extremes: Option<[(f64, usize); 2]>,
}

/// Least and greatest Rayleigh quotients `[vertex]`.
///
/// ```text
/// Σ_i  = 1/K Σ_j g_j g_jᵀ,   g_j = G_j − mean of the K neighbors
/// RQ_j = g_jᵀ Σ_i g_j / g_jᵀ g_j,   RQ_min = min_j RQ_j,   RQ_max = max_j RQ_j
/// ```
///
/// Source: *Gundogdu et al. 2020, Eq. 10 to 12*; Eq. 12 prints `min` for RQ_max, which is a
/// misprint.
pub(crate) fn rayleigh_quotients(places: &[Place], hoods: &Neighborhoods) -> Vec<Extremes> {
    let rows = hoods.indices.par_chunks(hoods.size.max(1) * CHUNK);
    let quotients = rows.flat_map_iter(|rows| {
        rows.chunks_exact(hoods.size).map(|hood| {
            let spread = spread(places, hood);
            spread
                .extremes
                .map_or([0.0; 2], |extremes| extremes.map(|extreme| extreme.0))
        })
    });
    quotients.collect()
}

/// The mean squared differences of least and greatest quotients.
///
/// ```text
/// L_RQ = 1/N Σ_i (RQ_min^P − RQ_min^G)² + (RQ_max^P − RQ_max^G)²
/// ```
///
/// The neighborhoods are those of the template. Source: *Gundogdu et al. 2020, Eq. 13*.
pub(crate) fn rayleigh_loss(
    predicted: &[Place],
    hoods: &Neighborhoods,
    target: &[Extremes],
    gradient: &mut Gradient<'_>,
) -> f64 {
    let share = 1.0 / predicted.len() as f64;
    if hoods.size == 0 {
        return 0.0;
    }
    let mut derivatives = vec![Place::zeros(); hoods.indices.len()];
    let mut values = vec![0.0; predicted.len()];
    let slots = derivatives.par_chunks_mut(hoods.size * CHUNK);
    let rows = hoods.indices.par_chunks(hoods.size * CHUNK);
    let targets = target.par_chunks(CHUNK);
    let values_of_rows = values.par_chunks_mut(CHUNK);
    (slots.zip(rows)).zip(targets.zip(values_of_rows)).for_each(
        |((slots, rows), (targets, values))| {
            let slots = slots.chunks_exact_mut(hoods.size);
            let rows = rows.chunks_exact(hoods.size);
            for ((slots, hood), (target, value)) in slots.zip(rows).zip(targets.iter().zip(values))
            {
                *value = differentiate(&spread(predicted, hood), *target, share, slots);
            }
        },
    );
    for (&vertex, &derivative) in hoods.indices.iter().zip(&derivatives) {
        gradient.add(vertex, derivative);
    }
    share * values.iter().sum::<f64>()
}

/// The term of one neighborhood, and its derivatives by the neighbors.
fn differentiate(spread: &Spread, target: Extremes, share: f64, slots: &mut [Place]) -> f64 {
    let Some(extremes) = spread.extremes else {
        return target.map(|value| value * value).iter().sum();
    };
    let size = slots.len() as f64;
    let mut value = 0.0;
    for ((quotient, extreme), target) in extremes.into_iter().zip(target) {
        let difference = quotient - target;
        value += difference * difference;
        let by_quotient = 2.0 * share * difference;
        let own = spread.centered[extreme];
        let squared = own.norm_squared();
        // By the direction itself, and by the covariance that all neighbors make.
        slots[extreme] += by_quotient * 2.0 / squared * (spread.covariance * own - quotient * own);
        for (slot, other) in slots.iter_mut().zip(&spread.centered) {
            *slot += by_quotient * 2.0 / size * own.dot(other) / squared * own;
        }
    }
    let mean = slots.iter().sum::<Place>() / size;
    for slot in slots {
        *slot -= mean;
    }
    value
}

fn spread(places: &[Place], hood: &[u32]) -> Spread {
    let size = hood.len() as f64;
    let places = hood.iter().map(|&vertex| places[vertex as usize]);
    let middle = places.clone().sum::<Place>() / size;
    let centered: Vec<Place> = places.map(|place| place - middle).collect();
    let products = centered.iter().map(|place| place * place.transpose());
    let covariance = products.sum::<Matrix3<f64>>() / size;
    let least = MIN_SHARE * covariance.trace();
    let mut extremes: Option<[(f64, usize); 2]> = None;
    for (number, place) in centered.iter().enumerate() {
        let squared = place.norm_squared();
        if squared <= least || squared <= f64::MIN_POSITIVE {
            continue;
        }
        let quotient = (place.dot(&(covariance * place)) / squared, number);
        let [low, high] = extremes.get_or_insert([quotient; 2]);
        if quotient.0 < low.0 {
            *low = quotient;
        }
        if quotient.0 > high.0 {
            *high = quotient;
        }
    }
    Spread {
        centered,
        covariance,
        extremes,
    }
}
