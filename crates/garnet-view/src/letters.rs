//! The letters of all pictures: a part of `DejaVu` Sans, so that every machine draws the same.

use std::sync::OnceLock;

use plotters::style::{FontDesc, FontFamily, FontStyle, register_font};

use crate::{Rgb, ViewError, canvas::FINE};

/// The name that charts use; what shows an SVG takes its own letters of that kind.
const FAMILY: FontFamily<'static> = FontFamily::SansSerif;

/// By how much of its size the plotter draws a text higher in pixels than in an SVG.
pub(crate) const PIXEL_DROP: f64 = 0.125;

/// Letters of a size, in pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Letters {
    pub(crate) size: f64,
    pub(crate) is_bold: bool,
    pub(crate) color: Rgb,
}

impl Letters {
    /// The font, `fine` times as large.
    pub(crate) fn font(self, fine: u32) -> FontDesc<'static> {
        let style = if self.is_bold {
            FontStyle::Bold
        } else {
            FontStyle::Normal
        };
        FontDesc::new(FAMILY, self.size * f64::from(fine), style)
    }

    /// Width and height of a text, in pixels.
    pub(crate) fn size_of(self, text: &str) -> [f64; 2] {
        let (width, height) = self.font(FINE).box_size(text).unwrap_or((0, 0));
        [width, height].map(|units| f64::from(units) / f64::from(FINE))
    }
}

/// Makes the letters known to the plotter.
pub(crate) fn ready() -> Result<(), ViewError> {
    static READY: OnceLock<bool> = OnceLock::new();
    let is_ready = *READY.get_or_init(|| {
        let fonts: [(FontStyle, &'static [u8]); 2] = [
            (
                FontStyle::Normal,
                include_bytes!("../assets/DejaVuSans.ttf"),
            ),
            (
                FontStyle::Bold,
                include_bytes!("../assets/DejaVuSans-Bold.ttf"),
            ),
        ];
        fonts
            .into_iter()
            .all(|(style, bytes)| register_font(FAMILY.as_str(), style, bytes).is_ok())
    });
    if is_ready {
        return Ok(());
    }
    let reason = "the letters cannot be read".to_owned();
    Err(ViewError::Chart { reason })
}
