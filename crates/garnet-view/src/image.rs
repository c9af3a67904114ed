//! The finished picture and its file.

use std::{
    io::{self, Write},
    path::Path,
};

use ::image::{
    Delay, ExtendedColorType, Frame, ImageEncoder, RgbaImage,
    codecs::{
        gif::{GifEncoder, Repeat},
        png::{CompressionType, FilterType, PngEncoder},
    },
};

use crate::{Rgb, ViewError};

/// Pixels in sRGB, row by row from the upper left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<u8>,
}

impl Image {
    /// An image of one color.
    pub(crate) fn filled(width: u32, height: u32, color: Rgb) -> Self {
        let num_pixels = width as usize * height as usize;
        Self {
            width,
            height,
            pixels: color.channels().repeat(num_pixels),
        }
    }

    /// Width in pixels.
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// Red, green and blue of each pixel.
    ///
    /// # Shapes
    ///
    /// - output: `[height, width, 3]`
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// The color at column `x` and row `y`, or nothing outside.
    pub fn pixel(&self, x: u32, y: u32) -> Option<Rgb> {
        let start = self.start(x, y)?;
        let channels = self.pixels.get(start..start + 3)?;
        Some(Rgb::new(channels[0], channels[1], channels[2]))
    }

    /// Paints the part of a rectangle that lies inside.
    pub(crate) fn fill(&mut self, rect: Rect, color: Rgb) {
        let right = rect.x.saturating_add(rect.width).min(self.width);
        let bottom = rect.y.saturating_add(rect.height).min(self.height);
        for y in rect.y..bottom {
            for x in rect.x..right {
                if let Some(start) = self.start(x, y) {
                    self.pixels[start..start + 3].copy_from_slice(&color.channels());
                }
            }
        }
    }

    /// Lays a color over a pixel by a share from 0 to 1.
    pub(crate) fn mix(&mut self, [x, y]: [u32; 2], color: Rgb, share: f32) {
        let Some(start) = self.start(x, y) else {
            return;
        };
        for (below, above) in self.pixels[start..start + 3]
            .iter_mut()
            .zip(color.channels())
        {
            let [from, to] = [*below, above].map(f32::from);
            *below = (from + share * (to - from)).round() as u8;
        }
    }

    /// The bytes of the rows `from..to`.
    pub(crate) fn rows_mut(&mut self, from: u32, to: u32) -> &mut [u8] {
        let row = 3 * self.width as usize;
        let to = to.min(self.height) as usize;
        &mut self.pixels[(from as usize).min(to) * row..to * row]
    }

    fn start(&self, x: u32, y: u32) -> Option<usize> {
        let inside = x < self.width && y < self.height;
        inside.then(|| 3 * (y as usize * self.width as usize + x as usize))
    }

    /// Packs the image as PNG.
    ///
    /// # Errors
    ///
    /// [`ViewError::Encode`].
    pub fn to_png_bytes(&self) -> Result<Vec<u8>, ViewError> {
        let mut bytes = Vec::new();
        PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Adaptive)
            .write_image(
                &self.pixels,
                self.width,
                self.height,
                ExtendedColorType::Rgb8,
            )
            .map_err(|source| ViewError::Encode { source })?;
        Ok(bytes)
    }

    /// Writes the image as PNG; an interrupted or failed write leaves what was there before.
    ///
    /// # Errors
    ///
    /// [`ViewError::Encode`] or [`ViewError::Write`].
    pub fn write_png(&self, path: &Path) -> Result<(), ViewError> {
        let bytes = self.to_png_bytes()?;
        replace_file(path, &bytes).map_err(|source| ViewError::Write {
            path: path.to_owned(),
            source,
        })
    }
}

/// Writes images of one size as an animated GIF that begins again at its end.
pub struct GifWriter<W: Write> {
    encoder: GifEncoder<W>,
    delay: Delay,
}

impl<W: Write> std::fmt::Debug for GifWriter<W> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("GifWriter")
    }
}

/// How hard the encoder looks for colors, 1 to 30: higher is faster and coarser.
const COLOR_SPEED: i32 = 10;

impl<W: Write> GifWriter<W> {
    /// Begins a file of so many frames a second; the format rounds to hundredths of a second, and
    /// programs show at most 50.
    ///
    /// # Errors
    ///
    /// [`ViewError::Encode`].
    pub fn new(writer: W, fps: f64) -> Result<Self, ViewError> {
        let mut encoder = GifEncoder::new_with_speed(writer, COLOR_SPEED);
        encoder
            .set_repeat(Repeat::Infinite)
            .map_err(|source| ViewError::Encode { source })?;
        let milliseconds = (1e3 / fps.clamp(1e-2, 50.0)).round() as u32;
        Ok(Self {
            encoder,
            delay: Delay::from_numer_denom_ms(milliseconds, 1),
        })
    }

    /// Adds a frame.
    ///
    /// # Errors
    ///
    /// [`ViewError::Encode`].
    pub fn push(&mut self, image: &Image) -> Result<(), ViewError> {
        let (pixels, _) = image.pixels.as_chunks::<3>();
        let pixels = pixels
            .iter()
            .flat_map(|&[r, g, b]| [r, g, b, 255])
            .collect();
        let Some(buffer) = RgbaImage::from_raw(image.width, image.height, pixels) else {
            return Ok(());
        };
        let frame = Frame::from_parts(buffer, 0, 0, self.delay);
        self.encoder
            .encode_frame(frame)
            .map_err(|source| ViewError::Encode { source })
    }
}

/// Part of an image, in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rect {
    pub(crate) x: u32,
    pub(crate) y: u32,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

fn replace_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        // A temporary file is private by default; a picture is as readable as any new file.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder
        .prefix(".garnet-")
        .suffix(".png")
        .tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.persist(path)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_written_picture_reads_back_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        let mut image = Image::filled(7, 5, Rgb::new(1, 2, 3));
        let rect = Rect {
            x: 5,
            y: 1,
            width: 9,
            height: 1,
        };
        image.fill(rect, Rgb::new(200, 100, 50));
        image.write_png(&path).unwrap();
        let read = ::image::open(&path).unwrap().to_rgb8();
        assert_eq!(read.dimensions(), (7, 5));
        assert_eq!(read.as_raw(), image.pixels());
        assert_eq!(image.pixel(6, 1), Some(Rgb::new(200, 100, 50)));
        assert_eq!(image.pixel(7, 1), None);
    }

    #[test]
    fn a_gif_has_its_frames_and_their_time() {
        use ::image::{AnimationDecoder, codecs::gif::GifDecoder};

        let mut bytes = Vec::new();
        let mut gif = GifWriter::new(&mut bytes, 25.0).unwrap();
        let colors = [Rgb::new(200, 0, 0), Rgb::new(0, 0, 200)];
        for color in colors {
            gif.push(&Image::filled(8, 6, color)).unwrap();
        }
        drop(gif);
        let decoder = GifDecoder::new(io::Cursor::new(bytes)).unwrap();
        let frames = decoder.into_frames().collect_frames().unwrap();
        assert_eq!(frames.len(), 2);
        for (frame, color) in frames.iter().zip(colors) {
            assert_eq!(frame.delay().numer_denom_ms(), (40, 1));
            assert_eq!(frame.buffer().dimensions(), (8, 6));
            let [r, g, b, _] = frame.buffer().get_pixel(3, 3).0;
            for (found, expected) in [r, g, b].into_iter().zip(color.channels()) {
                assert!(found.abs_diff(expected) < 8, "{found} {expected}");
            }
        }
    }

    #[test]
    fn a_failed_write_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("taken")).unwrap();
        let image = Image::filled(1, 1, Rgb::new(0, 0, 0));
        let error = image.write_png(&folder.path().join("taken")).unwrap_err();
        assert!(matches!(error, ViewError::Write { .. }));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
