//! What charts are drawn on: an SVG, or pixels.

use plotters::{coord::Shift, prelude::*};

use crate::{
    Image, Rgb, ViewError,
    image::Rect,
    letters::{self, PIXEL_DROP},
};

/// Units of a drawing in a pixel of the chart. Plotters draw at whole units.
pub(crate) const FINE: u32 = 4;

/// Units that make a pixel of a PNG: these have twice the size, for screens that are sharper.
const UNITS_A_PIXEL: u32 = 2;

/// What can be drawn on both.
pub(crate) trait Drawing {
    /// Width and height, in pixels of the chart.
    fn size(&self) -> (u32, u32);

    /// Draws in units; texts are moved down by `drop` times their size.
    fn draw<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        drop: f64,
    ) -> Result<(), String>
    where
        DB::ErrorType: 'static;
}

/// The drawing as SVG.
pub(crate) fn svg(drawing: &impl Drawing) -> Result<String, ViewError> {
    let mut text = String::new();
    let (width, height) = drawing.size();
    let fine = (FINE * width, FINE * height);
    letters::ready()?;
    let area = SVGBackend::with_string(&mut text, fine).into_drawing_area();
    let drawn = drawing.draw(&area, 0.0);
    let drawn = drawn.and_then(|()| area.present().map_err(told));
    drop(area);
    drawn.map_err(|reason| ViewError::Chart { reason })?;
    let size = |(width, height)| format!("width=\"{width}\" height=\"{height}\"");
    Ok(text.replacen(&size(fine), &size((width, height)), 1))
}

/// The drawing as pixels.
pub(crate) fn image(drawing: &impl Drawing) -> Result<Image, ViewError> {
    let (width, height) = drawing.size();
    let fine = (FINE * width, FINE * height);
    let mut units = vec![u8::MAX; 3 * fine.0 as usize * fine.1 as usize];
    letters::ready()?;
    let area = BitMapBackend::with_buffer(&mut units, fine).into_drawing_area();
    let drawn = drawing.draw(&area, PIXEL_DROP);
    let drawn = drawn.and_then(|()| area.present().map_err(told));
    drop(area);
    drawn.map_err(|reason| ViewError::Chart { reason })?;
    Ok(shrunk(&units, fine))
}

/// The means of squares of units.
fn shrunk(units: &[u8], (width, height): (u32, u32)) -> Image {
    let (columns, rows) = (width / UNITS_A_PIXEL, height / UNITS_A_PIXEL);
    let mut image = Image::filled(columns, rows, Rgb::new(0, 0, 0));
    let mean = |column: u32, row: u32, channel: usize| {
        let mut sum = 0;
        for y in row * UNITS_A_PIXEL..(row + 1) * UNITS_A_PIXEL {
            for x in column * UNITS_A_PIXEL..(column + 1) * UNITS_A_PIXEL {
                sum += u32::from(units[3 * (y as usize * width as usize + x as usize) + channel]);
            }
        }
        (sum / (UNITS_A_PIXEL * UNITS_A_PIXEL)) as u8
    };
    for row in 0..rows {
        for column in 0..columns {
            let [red, green, blue] = [0, 1, 2].map(|channel| mean(column, row, channel));
            let pixel = Rect {
                x: column,
                y: row,
                width: 1,
                height: 1,
            };
            image.fill(pixel, Rgb::new(red, green, blue));
        }
    }
    image
}

/// The color as the plotter takes it.
pub(crate) fn color(rgb: Rgb) -> RGBColor {
    RGBColor(rgb.red, rgb.green, rgb.blue)
}

/// What the plotter says.
pub(crate) fn told(error: impl std::fmt::Display) -> String {
    error.to_string()
}
