//! Lines of text in pictures of meshes.

use plotters::{
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};

use crate::{
    Image, Rgb, ViewError,
    canvas::told,
    letters::{Letters, PIXEL_DROP, ready},
    palette,
};

/// Size of the letters, in dots: lengths beside letters are counted in these.
const SIZE: u32 = 12;

/// Height of a capital letter, dots.
pub(crate) const HEIGHT: u32 = 8;

/// How far tails reach below the base line, dots.
const DESCENT: u32 = 3;

/// Samples along each side of a pixel of letters with one pixel a dot.
const SAMPLES: u32 = 4;

fn letters(scale: u32) -> Letters {
    Letters {
        size: f64::from(SIZE * scale),
        is_bold: false,
        color: palette::INK,
    }
}

/// The width of a line of text, pixels, at `scale` pixels a dot.
pub(crate) fn width(text: &str, scale: u32) -> u32 {
    letters(scale).size_of(text)[0].ceil() as u32
}

/// The height of a line of text with its tails, pixels, at `scale` pixels a dot.
pub(crate) const fn height(scale: u32) -> u32 {
    (HEIGHT + DESCENT) * scale
}

/// Shortens a line that is wider than `max_width` pixels; dots stand for what is gone.
pub(crate) fn fitted(text: &str, scale: u32, max_width: u32) -> String {
    if width(text, scale) <= max_width {
        return text.to_owned();
    }
    let ends = text.char_indices().map(|(end, _)| end).rev();
    let mut lines = ends.map(|end| format!("{}…", text[..end].trim_end()));
    lines
        .find(|line| width(line, scale) <= max_width)
        .unwrap_or_default()
}

/// Where and how large text is drawn: the upper left corner and pixels a dot.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pen {
    pub(crate) x: u32,
    pub(crate) y: u32,
    pub(crate) scale: u32,
    pub(crate) color: Rgb,
}

/// Draws a line of text; what lies outside of the image is cut off.
pub(crate) fn draw(image: &mut Image, text: &str, pen: Pen) -> Result<(), ViewError> {
    // The last letter may reach beyond where the next one would begin.
    let columns = width(text, pen.scale) + pen.scale;
    let columns = columns.min(image.width().saturating_sub(pen.x));
    let rows = height(pen.scale).min(image.height().saturating_sub(pen.y));
    if columns == 0 || rows == 0 {
        return Ok(());
    }
    let fine = (SAMPLES / pen.scale.max(1)).max(1);
    let size = (fine * columns, fine * rows);
    let samples = samples(text, pen.scale, fine, size)?;
    let ink = |column: u32, row: u32| {
        let rows = row * fine..(row + 1) * fine;
        let squares = rows.flat_map(|y| (column * fine..(column + 1) * fine).map(move |x| (x, y)));
        let light = squares
            .map(|(x, y)| u32::from(samples[3 * (y as usize * size.0 as usize + x as usize)]));
        1.0 - light.sum::<u32>() as f32 / (255 * fine * fine) as f32
    };
    for row in 0..rows {
        for column in 0..columns {
            image.mix([pen.x + column, pen.y + row], pen.color, ink(column, row));
        }
    }
    Ok(())
}

/// The text in black on white.
fn samples(text: &str, scale: u32, fine: u32, size: (u32, u32)) -> Result<Vec<u8>, ViewError> {
    ready()?;
    let mut samples = vec![u8::MAX; 3 * size.0 as usize * size.1 as usize];
    let letters = letters(scale);
    let style = TextStyle::from(letters.font(fine))
        .pos(Pos::new(HPos::Left, VPos::Top))
        .color(&BLACK);
    let top = (PIXEL_DROP * letters.size * f64::from(fine)).round() as i32;
    let area = BitMapBackend::with_buffer(&mut samples, size).into_drawing_area();
    let drawn = area.draw_text(text, &style, (0, top)).map_err(told);
    drawn
        .and_then(|()| area.present().map_err(told))
        .map_err(|reason| ViewError::Chart { reason })?;
    drop(area);
    Ok(samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inked(text: &str, scale: u32) -> Vec<[u32; 2]> {
        let mut image = Image::filled(120 * scale, 16 * scale, palette::BACKGROUND);
        let pen = Pen {
            x: 1,
            y: 1,
            scale,
            color: palette::INK,
        };
        draw(&mut image, text, pen).unwrap();
        let places = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| [x, y]));
        places
            .filter(|&[x, y]| image.pixel(x, y) != Some(palette::BACKGROUND))
            .collect()
    }

    #[test]
    fn a_line_covers_the_width_and_height_that_were_announced() {
        ready().unwrap();
        for scale in [1, 2, 5] {
            let places = inked("Hgjpqy|M", scale);
            let last = |axis: usize| places.iter().map(|place| place[axis]).max().unwrap();
            let end = width("Hgjpqy|M", scale);
            assert!(
                end.abs_diff(last(0)) <= 2 * scale,
                "{end} {} at {scale}",
                last(0)
            );
            assert!(last(1) <= height(scale), "{} at {scale}", last(1));
        }
        let capitals = inked("HHM", 4);
        let rows = capitals.iter().map(|place| place[1]);
        let rows = rows.clone().max().unwrap() + 1 - rows.min().unwrap();
        assert!((4 * HEIGHT).abs_diff(rows) <= 3, "{rows}");
    }

    #[test]
    fn every_printable_character_has_ink() {
        for character in ('!'..='~').chain("°±²³µ·×–—−".chars()) {
            assert!(!inked(&character.to_string(), 2).is_empty(), "{character}");
        }
    }

    #[test]
    fn a_shortened_line_fits() {
        ready().unwrap();
        for max_width in 0..60 {
            let line = fitted("penetration (mm)", 2, max_width);
            assert!(width(&line, 2) <= max_width, "{line:?} in {max_width}");
        }
        assert_eq!(fitted("ab", 1, 100), "ab");
    }
}
