//! Pictures that are laid over surfaces.

use std::io::Cursor;

use image::{
    ColorType, ImageDecoder, ImageError, Limits,
    codecs::{jpeg::JpegDecoder, png::PngDecoder},
    error::{ImageFormatHint, LimitError, LimitErrorKind, UnsupportedError},
};

use crate::{Rgb, ViewError, rgb::Light};

/// Pictures of more pixels each way are refused.
const MAX_SIDE: u32 = 16_384;

/// Bytes that a picture may take while it is read.
const MAX_BYTES: usize = 1 << 30;

/// A picture that is laid over a surface: itself, and smaller copies for surfaces far away.
///
/// It repeats itself beyond its borders.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// Each half as large as the one before; the last is one pixel.
    levels: Vec<Level>,
}

#[derive(Debug, Clone, PartialEq)]
struct Level {
    size: [u32; 2],
    /// `[y, x]`, from above.
    pixels: Vec<Rgb>,
}

impl Texture {
    /// Reads a PNG or JPEG. What it has of transparency is left out.
    ///
    /// # Errors
    ///
    /// [`ViewError::Decode`].
    pub fn decode(bytes: &[u8]) -> Result<Self, ViewError> {
        let read = match bytes {
            [0xff, 0xd8, ..] => JpegDecoder::new(Cursor::new(bytes)).and_then(pixels_of),
            _ => PngDecoder::new(Cursor::new(bytes)).and_then(pixels_of),
        };
        let (size, pixels) = read.map_err(|source| ViewError::Decode { source })?;
        Ok(Self::new(size, pixels))
    }

    /// Of one pixel or more.
    fn new(size: [u32; 2], pixels: Vec<Rgb>) -> Self {
        let mut levels = vec![Level { size, pixels }];
        while let Some(smaller) = levels.last().and_then(Level::halved) {
            levels.push(smaller);
        }
        Self { levels }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.levels[0].size
    }

    /// The color at texture coordinates, of which v counts from below, where a pixel of the picture
    /// that is drawn covers an area of so many pixels of this one.
    pub(crate) fn light(&self, [u, v]: [f64; 2], covered: f64) -> Light {
        if !(u.is_finite() && v.is_finite()) {
            return Light::repeat(0.0);
        }
        let finest = 0.5 * covered.max(1.0).log2();
        let level = if finest.is_finite() { finest } else { 0.0 };
        let last = self.levels.len() - 1;
        let level = (0..last).find(|&number| level < number as f64 + 1.0);
        self.levels[level.unwrap_or(last)].light([u, 1.0 - v])
    }
}

/// Width, height and the colors of all pixels of a picture.
fn pixels_of(mut decoder: impl ImageDecoder) -> Result<([u32; 2], Vec<Rgb>), ImageError> {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES as u64);
    decoder.set_limits(limits)?;
    let (width, height) = decoder.dimensions();
    let color = decoder.color_type();
    let too_large = || ImageError::Limits(LimitError::from_kind(LimitErrorKind::DimensionError));
    let length = usize::try_from(decoder.total_bytes()).unwrap_or(usize::MAX);
    if width == 0 || height == 0 || length > MAX_BYTES {
        return Err(too_large());
    }
    let mut bytes = vec![0; length];
    decoder.read_image(&mut bytes)?;
    let deep = match color {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => 1,
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => 2,
        _ => {
            let unsupported = UnsupportedError::from(ImageFormatHint::Unknown);
            return Err(ImageError::Unsupported(unsupported));
        }
    };
    // Of two bytes the one that counts more.
    let high = if cfg!(target_endian = "little") {
        deep - 1
    } else {
        0
    };
    let pixel = usize::from(color.bytes_per_pixel());
    let [green, blue] = if color.has_color() {
        [deep, 2 * deep]
    } else {
        [0, 0]
    };
    let colors = bytes.chunks_exact(pixel).map(|pixel| {
        let [red, green, blue] = [0, green, blue].map(|channel| pixel[channel + high]);
        Rgb::new(red, green, blue)
    });
    Ok(([width, height], colors.collect()))
}

impl Level {
    fn halved(&self) -> Option<Self> {
        let [width, height] = self.size;
        if width.max(height) <= 1 {
            return None;
        }
        let size = [width.div_ceil(2), height.div_ceil(2)];
        let rows = 0..size[1];
        let pixels = rows.flat_map(|y| (0..size[0]).map(move |x| [x, y]));
        let mean = |[x, y]: [u32; 2]| {
            let around = [[0, 0], [1, 0], [0, 1], [1, 1]];
            let sum: Light = around
                .iter()
                .map(|[dx, dy]| self.pixel([2 * x + dx, 2 * y + dy]).to_light())
                .sum();
            Rgb::from_light(sum * 0.25)
        };
        Some(Self {
            pixels: pixels.map(mean).collect(),
            size,
        })
    }

    /// A pixel; beyond the right and lower border, the last one.
    fn pixel(&self, [x, y]: [u32; 2]) -> Rgb {
        let [width, height] = self.size;
        let (x, y) = (x.min(width - 1), y.min(height - 1));
        self.pixels[y as usize * width as usize + x as usize]
    }

    /// The color between the middles of pixels, at shares of width and height.
    fn light(&self, shares: [f64; 2]) -> Light {
        let places = [0, 1].map(|axis| {
            let side = f64::from(self.size[axis]);
            let place = shares[axis].rem_euclid(1.0) * side - 0.5;
            let first = place.floor();
            let wrapped = |place: f64| wrap(place, self.size[axis]);
            (
                [wrapped(first), wrapped(first + 1.0)],
                (place - first) as f32,
            )
        });
        let [([left, right], along), ([upper, lower], down)] = places;
        let row = |y| {
            let [a, b] = [left, right].map(|x| self.pixel([x, y]).to_light());
            a.lerp(&b, along)
        };
        row(upper).lerp(&row(lower), down)
    }
}

#[expect(clippy::cast_sign_loss, reason = "the remainder is not negative")]
fn wrap(place: f64, side: u32) -> u32 {
    (place.rem_euclid(f64::from(side)) as u32).min(side - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Rgb = Rgb::new(255, 0, 0);
    const BLUE: Rgb = Rgb::new(0, 0, 255);
    const GREEN: Rgb = Rgb::new(0, 255, 0);
    const WHITE: Rgb = Rgb::new(255, 255, 255);

    #[test]
    fn coordinates_count_from_the_lower_left_corner_and_go_round() {
        let texture = Texture::new([2, 2], vec![RED, BLUE, GREEN, WHITE]);
        for (at, color) in [
            ([0.25, 0.75], RED),
            ([0.75, 0.75], BLUE),
            ([0.25, 0.25], GREEN),
            ([0.75, 0.25], WHITE),
            ([1.25, -0.25], RED),
            ([-3.75, 4.75], RED),
        ] {
            assert_eq!(Rgb::from_light(texture.light(at, 0.1)), color, "{at:?}");
        }
        let between = texture.light([0.5, 0.75], 0.1);
        assert!(
            (between - Light::new(0.5, 0.0, 0.5)).norm() < 1e-6,
            "{between}"
        );
        assert_eq!(texture.light([f64::NAN, 0.5], 1.0), Light::repeat(0.0));
    }

    #[test]
    fn from_far_away_the_mean_is_seen() {
        let black = Rgb::new(0, 0, 0);
        let checked = |at: u32| {
            if (at % 16 + at / 16).is_multiple_of(2) {
                black
            } else {
                WHITE
            }
        };
        let texture = Texture::new([16, 16], (0..256).map(checked).collect());
        assert_eq!(texture.levels.len(), 5);
        let near = texture.light([0.5 / 16.0, 0.5 / 16.0], 1.0);
        assert!((near - Light::repeat(1.0)).norm() < 1e-6, "{near}");
        for covered in [16.0, 256.0, f64::INFINITY] {
            let far = texture.light([0.3, 0.7], covered);
            let tolerance = if covered.is_finite() { 0.01 } else { 1.0 };
            assert!(
                (far - Light::repeat(0.5)).norm() < tolerance,
                "{covered}: {far}"
            );
        }
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        let error = Texture::decode(b"GARNET").unwrap_err();
        assert!(matches!(error, ViewError::Decode { .. }), "{error}");
    }
}
