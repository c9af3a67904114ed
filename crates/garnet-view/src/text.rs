//! Lines of text.

use crate::{Image, Rgb, font, image::Rect};

/// The width of a line of text, pixels, at `scale` pixels a dot.
pub(crate) fn width(text: &str, scale: u32) -> u32 {
    let num_letters = u32::try_from(text.chars().count()).unwrap_or(u32::MAX);
    num_letters
        .saturating_mul(font::WIDTH + 1)
        .saturating_sub(1)
        .saturating_mul(scale)
}

/// The height of a line of text with its tails, pixels, at `scale` pixels a dot.
pub(crate) const fn height(scale: u32) -> u32 {
    (font::HEIGHT + font::DESCENT) * scale
}

/// Shortens a line that is wider than `max_width` pixels; dots stand for what is gone.
pub(crate) fn fitted(text: &str, scale: u32, max_width: u32) -> String {
    if width(text, scale) <= max_width {
        return text.to_owned();
    }
    let num_letters = (max_width / scale.max(1) + 1) / (font::WIDTH + 1);
    let kept = num_letters.saturating_sub(2) as usize;
    let dots = num_letters.min(2) as usize;
    text.chars()
        .take(kept)
        .chain(".".repeat(dots).chars())
        .collect()
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
pub(crate) fn draw(image: &mut Image, text: &str, pen: Pen) {
    let mut left = pen.x;
    for character in text.chars() {
        if left >= image.width() {
            return;
        }
        let glyph = font::glyph(character);
        for (row, dots) in (0..).zip(glyph.rows) {
            for column in (0..font::WIDTH).filter(|column| dots & (0x10 >> column) != 0) {
                let dot = Rect {
                    x: left.saturating_add(column * pen.scale),
                    y: pen.y.saturating_add((row + glyph.drop) * pen.scale),
                    width: pen.scale,
                    height: pen.scale,
                };
                image.fill(dot, pen.color);
            }
        }
        left = left.saturating_add((font::WIDTH + 1) * pen.scale);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::palette;

    #[test]
    fn a_line_covers_the_width_that_was_announced() {
        let mut image = Image::filled(80, 12, palette::BACKGROUND);
        let pen = Pen {
            x: 1,
            y: 1,
            scale: 1,
            color: palette::INK,
        };
        draw(&mut image, "HMMH", pen);
        let last = (0..80)
            .filter(|&x| (0..12).any(|y| image.pixel(x, y) == Some(palette::INK)))
            .max();
        assert_eq!(last, Some(width("HMMH", 1)));
    }

    #[test]
    fn a_shortened_line_fits() {
        for max_width in 0..60 {
            let line = fitted("penetration (mm)", 2, max_width);
            assert!(width(&line, 2) <= max_width, "{line:?} in {max_width}");
        }
    }
}
