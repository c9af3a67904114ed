//! How open the surroundings of what is seen are: creases and contacts are dark, ridges bright.
//!
//! Ambient occlusion from the picture alone (Shanmugam and Arikan 2007, with an estimator like that
//! of Bavoil and Sainz 2008): points around a pixel that rise above its tangent plane take light
//! away. Two radii work together: the smaller draws folds, the larger rounds limbs off and grounds
//! one surface on another.

use nalgebra::{Rotation2, Vector2, Vector3};
use rayon::prelude::*;

use crate::{
    clip::Piece,
    lens::Lens,
    raster::{self, Bands, Hit, Window},
    scene::Scene,
};

/// The most pixels for which it is computed; larger views are looked at more coarsely.
const MAX_PIXELS: f64 = 2e6;

/// Rows that are computed at a time.
const BAND_ROWS: usize = 16;

/// Reach, in units of the view, and strength.
const SCALES: [(f64, f64); 2] = [(0.04, 2.4), (0.17, 0.85)];

/// Points looked at for each scale.
const NUM_TAPS: usize = 14;

/// How much of the strength ridges are given, compared to creases.
const RIDGE_SHARE: f64 = 0.22;

/// The most that a ridge is brightened.
const MAX_OPENNESS: f64 = 1.3;

/// A slope below which a surface counts as flat, so that triangles do not show.
const BIAS: f64 = 0.08;

/// Half the size of the square that is averaged against noise.
const BLUR: usize = 2;

/// Half the height difference, in units of the view, at which neighbors stop to count as one
/// surface.
const SAME_SURFACE: f64 = 0.02;

/// Openness of a view on a grid of samples: 0 is closed, 1 a plane, ridges are above.
#[derive(Debug)]
pub(crate) struct Occlusion {
    window: Window,
    /// Z in the view; negative infinity where there is nothing.
    heights: Vec<f32>,
    openness: Vec<f32>,
}

impl Occlusion {
    /// Looks at `pieces` in a view of `[width, height]` pixels.
    pub(crate) fn new(scene: &Scene<'_>, pieces: &[Piece], size: [u32; 2]) -> Self {
        let [width, height] = size.map(f64::from);
        let step = (width * height / MAX_PIXELS).sqrt().max(1.0);
        let window = Window {
            origin: [0.0, 0.0],
            step,
            num_columns: whole(width / step),
            num_rows: whole(height / step),
        };
        let hits = hits(pieces, &window);
        let heights: Vec<f32> = hits
            .par_iter()
            .map(|hit| match hit.triangle {
                Hit::NOTHING => f32::NEG_INFINITY,
                _ => scene.lens.z(f64::from(hit.nearness)) as f32,
            })
            .collect();
        let probe = Probe {
            lens: &scene.lens,
            window: &window,
            heights: &heights,
            taps: taps(),
        };
        let mut openness = vec![1.0; hits.len()];
        let rows = openness.par_chunks_mut(window.num_columns);
        rows.enumerate().for_each(|(row, openness)| {
            for (column, openness) in openness.iter_mut().enumerate() {
                let hit = hits[row * window.num_columns + column];
                if hit.triangle != Hit::NOTHING {
                    let normal = scene.normal(hit.triangle, window.pixel(column, row)).cast();
                    *openness = probe.openness(column, row, &normal);
                }
            }
        });
        let mut this = Self {
            window,
            heights,
            openness,
        };
        this.openness = this.blurred();
        this
    }

    /// The openness at a pixel of the surface at `z`: that of the nearest samples of one height.
    pub(crate) fn at(&self, pixel: [f64; 2], z: f64) -> f32 {
        let place = |axis: usize| pixel[axis] / self.window.step - 0.5;
        let (x, y) = (place(0), place(1));
        let (left, above) = (x.floor(), y.floor());
        let (mut sum, mut sum_weights) = (0.0, 0.0);
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let (column, row) = (left + dx, above + dy);
            let Some(index) = self.index(column, row) else {
                continue;
            };
            let near = (1.0 - (x - column).abs()) * (1.0 - (y - row).abs()) + 1e-3;
            let weight = near * likeness(f64::from(self.heights[index]) - z);
            sum += weight * f64::from(self.openness[index]);
            sum_weights += weight;
        }
        if sum_weights > 0.0 {
            (sum / sum_weights) as f32
        } else {
            1.0
        }
    }

    #[expect(clippy::cast_sign_loss, reason = "checked to be inside")]
    fn index(&self, column: f64, row: f64) -> Option<usize> {
        let Window {
            num_columns,
            num_rows,
            ..
        } = self.window;
        let is_inside =
            column >= 0.0 && row >= 0.0 && column < num_columns as f64 && row < num_rows as f64;
        is_inside.then(|| row as usize * num_columns + column as usize)
    }

    fn blurred(&self) -> Vec<f32> {
        let Window {
            num_columns,
            num_rows,
            ..
        } = self.window;
        let mut blurred = vec![1.0; self.openness.len()];
        let rows = blurred.par_chunks_mut(num_columns);
        rows.enumerate().for_each(|(row, blurred)| {
            let rows = row.saturating_sub(BLUR)..(row + BLUR + 1).min(num_rows);
            for (column, blurred) in blurred.iter_mut().enumerate() {
                let here = self.heights[row * num_columns + column];
                if here == f32::NEG_INFINITY {
                    continue;
                }
                let columns = column.saturating_sub(BLUR)..(column + BLUR + 1).min(num_columns);
                let (mut sum, mut sum_weights) = (0.0, 0.0);
                for row in rows.clone() {
                    for index in row * num_columns + columns.start..row * num_columns + columns.end
                    {
                        let weight = likeness(f64::from(self.heights[index] - here)) as f32;
                        sum += weight * self.openness[index];
                        sum_weights += weight;
                    }
                }
                *blurred = if sum_weights > 0.0 {
                    sum / sum_weights
                } else {
                    1.0
                };
            }
        });
        blurred
    }
}

/// From 1 for the same height to 0; what is infinitely far does not count.
fn likeness(difference: f64) -> f64 {
    let ratio = difference / SAME_SURFACE;
    if ratio.is_finite() {
        1.0 / (1.0 + ratio * ratio * ratio * ratio)
    } else {
        0.0
    }
}

#[expect(clippy::cast_sign_loss, reason = "a float cast saturates at zero")]
fn whole(length: f64) -> usize {
    (length.ceil() as usize).max(1)
}

fn hits(pieces: &[Piece], window: &Window) -> Vec<Hit> {
    let num_columns = window.num_columns;
    let bands = Bands::new(
        pieces,
        window.step * BAND_ROWS as f64,
        window.num_rows.div_ceil(BAND_ROWS),
    );
    let mut hits = vec![Hit::NONE; num_columns * window.num_rows];
    let chunks = hits.par_chunks_mut(num_columns * BAND_ROWS);
    chunks.enumerate().for_each(|(band, hits)| {
        let first_row = (band * BAND_ROWS) as f64;
        let window = Window {
            origin: [0.0, first_row * window.step],
            num_rows: hits.len() / num_columns,
            ..*window
        };
        raster::draw(bands.band(band, pieces), &window, hits);
    });
    hits
}

/// What openness is computed from.
struct Probe<'a> {
    lens: &'a Lens,
    window: &'a Window,
    heights: &'a [f32],
    /// Directions of the taps, and their distances as a share of the reach.
    taps: [(Vector2<f64>, f64); NUM_TAPS],
}

impl Probe<'_> {
    /// The openness at one sample before averaging.
    ///
    /// With the slope `s` and the distance `d` of a tap, and the reach `r`:
    ///
    /// ```text
    /// 1 - strength * mean(2 (1 - d²/r²) crease(s))    crease(s) = s above 0, less for a ridge below 0
    /// ```
    fn openness(&self, column: usize, row: usize, normal: &Vector3<f64>) -> f32 {
        let (lens, window) = (self.lens, self.window);
        let z = f64::from(self.heights[row * window.num_columns + column]);
        let here = lens.point(window.pixel(column, row), z);
        let turn = Rotation2::new(std::f64::consts::TAU * noise(column, row));
        let center = Vector2::new(column as f64, row as f64);
        let mut openness = 1.0;
        for (reach, strength) in SCALES {
            let reach_in_samples = reach * lens.pixels_at(z) / window.step;
            let mut closed = 0.0;
            for (direction, share) in self.taps {
                let place = center + turn * direction * (reach_in_samples * share + 0.7);
                let Some((index, pixel)) = sample(window, place.x.round(), place.y.round()) else {
                    continue;
                };
                let rise = lens.point(pixel, f64::from(self.heights[index])) - here;
                let distance_squared = rise.norm_squared();
                let fade = 1.0 - distance_squared / (reach * reach);
                if fade > 0.0 && distance_squared > 0.0 {
                    let slope = rise.dot(normal) / distance_squared.sqrt();
                    let (crease, ridge) = ((slope - BIAS).max(0.0), (-slope - BIAS).max(0.0));
                    closed += fade * (crease - RIDGE_SHARE * ridge);
                }
            }
            let mean = closed / NUM_TAPS as f64;
            openness *= (1.0 - strength * 2.0 * mean).clamp(0.0, MAX_OPENNESS);
        }
        openness as f32
    }
}

/// A spiral of golden angles.
fn taps() -> [(Vector2<f64>, f64); NUM_TAPS] {
    std::array::from_fn(|tap| {
        let (sin, cos) = (2.399_963_229_7 * tap as f64).sin_cos();
        let share = (tap as f64 + 0.5) / NUM_TAPS as f64;
        (Vector2::new(cos, sin), share)
    })
}

#[expect(clippy::cast_sign_loss, reason = "checked to be inside")]
fn sample(window: &Window, x: f64, y: f64) -> Option<(usize, [f64; 2])> {
    let is_inside =
        x >= 0.0 && y >= 0.0 && x < window.num_columns as f64 && y < window.num_rows as f64;
    is_inside.then(|| {
        let (column, row) = (x as usize, y as usize);
        (row * window.num_columns + column, window.pixel(column, row))
    })
}

/// A number from 0 to 1 that differs as much as possible between neighbors (Jimenez 2014).
fn noise(column: usize, row: usize) -> f64 {
    let fraction = |value: f64| value - value.floor();
    let slant = fraction(0.067_110_56 * column as f64 + 0.005_837_15 * row as f64);
    fraction(52.982_918_9 * slant)
}
