//! From samples to the pixels of a view.

use nalgebra::Vector3;

use crate::{
    Rgb,
    image::Rect,
    lighting::Studio,
    occlusion::Occlusion,
    raster::{self, Bands, Hit, Window},
    rgb::Light,
    scene::{Group, Scene},
};

/// Rows of pixels that are drawn at a time.
pub(crate) const BAND_ROWS: u32 = 16;

/// All that the pixels of a view depend on.
#[derive(Debug)]
pub(crate) struct Drawing<'a> {
    pub(crate) scene: &'a Scene<'a>,
    pub(crate) studio: Studio,
    pub(crate) occlusion: Occlusion,
    pub(crate) groups: &'a [Group],
    /// The bands of each group.
    pub(crate) bands: Vec<Bands>,
    pub(crate) background: Rgb,
    pub(crate) supersampling: usize,
    pub(crate) rect: Rect,
}

/// The light of a sample and what it is covered with.
#[derive(Debug, Clone, Copy)]
struct Fragment {
    nearness: f32,
    opacity: f32,
    light: Light,
}

impl Drawing<'_> {
    /// Draws one band into whole rows of the picture, `row_bytes` each.
    pub(crate) fn draw_band(&self, band: usize, rows: &mut [u8], row_bytes: usize) {
        let per_side = self.supersampling;
        let num_rows = rows.len() / row_bytes;
        let window = Window {
            origin: [0.0, f64::from(BAND_ROWS) * band as f64],
            step: 1.0 / per_side as f64,
            num_columns: self.rect.width as usize * per_side,
            num_rows: num_rows * per_side,
        };
        let hits: Vec<Vec<Hit>> = (self.groups.iter().zip(&self.bands))
            .map(|(group, bands)| {
                let mut hits = vec![Hit::NONE; window.num_columns * window.num_rows];
                raster::draw(bands.band(band, &group.pieces), &window, &mut hits);
                hits
            })
            .collect();
        let background = self.background.to_light();
        let first = 3 * self.rect.x as usize;
        let mut samples = Vec::new();
        for (row, bytes) in rows.chunks_exact_mut(row_bytes).enumerate() {
            let bytes = &mut bytes[first..][..3 * self.rect.width as usize];
            for (column, bytes) in bytes.chunks_exact_mut(3).enumerate() {
                samples.clear();
                samples.resize(per_side * per_side, background);
                let pixel = Pixel {
                    window: &window,
                    column: column * per_side,
                    row: row * per_side,
                    per_side,
                };
                if self.light_samples(&hits, &pixel, &mut samples) {
                    let mean = samples.iter().sum::<Light>() / samples.len() as f32;
                    bytes.copy_from_slice(&Rgb::from_light(mean).channels());
                }
            }
        }
    }

    /// Finds the light of all samples of a pixel; false if nothing but background is there.
    fn light_samples(&self, hits: &[Vec<Hit>], pixel: &Pixel<'_>, samples: &mut [Light]) -> bool {
        let is_empty = hits.iter().all(|hits| {
            pixel
                .indices()
                .all(|index| hits[index].triangle == Hit::NOTHING)
        });
        if is_empty {
            return false;
        }
        let (Some((opaque, covers)), Some((opaque_hits, cover_hits))) =
            (self.groups.split_first(), hits.split_first())
        else {
            return false;
        };
        self.light_group(opaque, opaque_hits, pixel, |sample, fragment| {
            samples[sample] = fragment.light;
        });
        if covers.is_empty() {
            return true;
        }
        let behind: Vec<f32> = pixel
            .indices()
            .map(|index| opaque_hits[index].nearness)
            .collect();
        let mut stacks = vec![Vec::new(); samples.len()];
        for (cover, hits) in covers.iter().zip(cover_hits) {
            self.light_group(cover, hits, pixel, |sample, fragment| {
                if fragment.nearness > behind[sample] {
                    stacks[sample].push(fragment);
                }
            });
        }
        for (light, stack) in samples.iter_mut().zip(&mut stacks) {
            stack.sort_by(|a: &Fragment, b| a.nearness.total_cmp(&b.nearness));
            for fragment in stack.iter() {
                *light = light.lerp(&fragment.light, fragment.opacity);
            }
        }
        true
    }

    /// Lights the samples of a pixel that see a group: once for each triangle, in the middle of
    /// the samples that see it.
    fn light_group(
        &self,
        group: &Group,
        hits: &[Hit],
        pixel: &Pixel<'_>,
        mut paint: impl FnMut(usize, Fragment),
    ) {
        let mut is_done = [false; (crate::MAX_SUPERSAMPLING * crate::MAX_SUPERSAMPLING) as usize];
        for (first, index) in pixel.indices().enumerate() {
            let triangle = hits[index].triangle;
            if is_done[first] || triangle == Hit::NOTHING {
                continue;
            }
            let same = || {
                let samples = pixel.indices().enumerate().skip(first);
                samples.filter(|&(_, index)| hits[index].triangle == triangle)
            };
            let mut sum = Vector3::<f64>::zeros();
            for (sample, index) in same() {
                is_done[sample] = true;
                let [x, y] = pixel.place(sample);
                sum += Vector3::new(x, y, f64::from(hits[index].nearness));
            }
            let middle = sum / same().count() as f64;
            let light = self.light(group, triangle, middle);
            for (sample, index) in same() {
                let fragment = Fragment {
                    nearness: hits[index].nearness,
                    opacity: group.opacity,
                    light,
                };
                paint(sample, fragment);
            }
        }
    }

    fn light(&self, group: &Group, triangle: u32, middle: Vector3<f64>) -> Light {
        let pixel = [middle.x, middle.y];
        let surface = self.scene.surface(triangle, pixel);
        let openness = if group.opacity < 1.0 {
            1.0
        } else {
            self.occlusion.at(pixel, self.scene.lens.z(middle.z))
        };
        self.studio.lit(&surface, openness)
    }
}

/// The samples of one pixel.
struct Pixel<'a> {
    window: &'a Window,
    /// The first column and row of samples.
    column: usize,
    row: usize,
    per_side: usize,
}

impl Pixel<'_> {
    /// Where the samples are among those of the window.
    fn indices(&self) -> impl Iterator<Item = usize> {
        let (width, first) = (self.window.num_columns, self.row * self.window.num_columns);
        let per_side = self.per_side;
        let start = first + self.column;
        (0..per_side * per_side)
            .map(move |sample| start + sample / per_side * width + sample % per_side)
    }

    /// The pixel coordinates of a sample.
    fn place(&self, sample: usize) -> [f64; 2] {
        let column = self.column + sample % self.per_side;
        self.window.pixel(column, self.row + sample / self.per_side)
    }
}
