//! The bar that tells which color stands for which value.

use crate::{
    Image, Rgb, ViewError,
    image::Rect,
    palette,
    prepared::Legend,
    text::{self, Pen},
};

/// Width of the colored bar, dots of a letter.
const BAR_WIDTH: u32 = 9;

/// Space between parts, dots of a letter.
const GAP: u32 = 4;

/// Values that are named, ends included.
const NUM_TICKS: u32 = 5;

/// The widest that a label may be, letters; a longer one is shortened.
const MAX_LABEL: usize = 24;

/// The width that bars need, pixels; none without legends.
pub(crate) fn width(legends: &[Legend<'_>], scale: u32) -> u32 {
    let widths = legends.iter().map(|legend| {
        let ticks = ticks(legend).into_iter();
        let ticks = ticks.map(|(_, text)| text::width(&text, scale));
        let bar = (BAR_WIDTH + 2 * GAP) * scale + ticks.max().unwrap_or(0);
        let label: String = legend.label.chars().take(MAX_LABEL).collect();
        bar.max(text::width(&label, scale)) + 2 * GAP * scale
    });
    widths.max().unwrap_or(0)
}

/// Draws a label, and a bar with ticks below it.
pub(crate) fn draw(
    image: &mut Image,
    legend: &Legend<'_>,
    place: Rect,
    scale: u32,
) -> Result<(), ViewError> {
    let line = text::height(scale);
    let left = place.x + GAP * scale;
    let bar_height = (place.height / 10 * 7).min(place.height.saturating_sub(5 * line));
    let label_y = place.y + (place.height - bar_height).saturating_sub(2 * line) / 2;
    let top = label_y + 2 * line;
    let write = |image: &mut Image, text: &str, [x, y]: [u32; 2]| {
        let color = palette::INK;
        text::draw(image, text, Pen { x, y, scale, color })
    };
    let label = text::fitted(legend.label, scale, place.width.saturating_sub(GAP * scale));
    write(image, &label, [left, label_y])?;
    if bar_height == 0 {
        return Ok(());
    }
    for row in 0..bar_height {
        let line = Rect {
            x: left,
            y: top + row,
            width: BAR_WIDTH * scale,
            height: 1,
        };
        image.fill(line, bar_color(legend, row, bar_height));
    }
    for (share, text) in ticks(legend) {
        let y = top + ((bar_height - 1) as f32 * (1.0 - share)).round() as u32;
        let mark = Rect {
            x: left + BAR_WIDTH * scale,
            y: y.saturating_sub(scale / 2),
            width: 2 * scale,
            height: scale,
        };
        image.fill(mark, palette::INK);
        let x = mark.x + mark.width + GAP * scale / 2;
        let y = y.saturating_sub(text::HEIGHT * scale / 2);
        write(image, &text, [x, y])?;
    }
    Ok(())
}

/// The color of a row of a bar, from the upper end.
fn bar_color(legend: &Legend<'_>, row: u32, bar_height: u32) -> Rgb {
    let last = bar_height.saturating_sub(1).max(1);
    let share = 1.0 - row as f32 / last as f32;
    let num_kinds = legend.map.kinds().len();
    if num_kinds == 0 || legend.map.blends() {
        return legend.map.color(share);
    }
    // As much of the bar for each kind.
    let kind = (share * num_kinds as f32)
        .floor()
        .min((num_kinds - 1) as f32);
    legend.map.color(kind / (num_kinds - 1) as f32)
}

/// What is named along a bar: the share of it that is below, and its text.
fn ticks(legend: &Legend<'_>) -> Vec<(f32, String)> {
    let kinds = legend.map.kinds();
    if kinds.is_empty() {
        let tick = |tick: u32| {
            (
                tick as f32 / (NUM_TICKS - 1) as f32,
                tick_text(legend, tick),
            )
        };
        return (0..NUM_TICKS).map(tick).collect();
    }
    let count = kinds.len() as f32;
    let kinds = kinds.into_iter().enumerate();
    let tick = |(kind, name): (usize, &str)| ((kind as f32 + 0.5) / count, name.to_owned());
    kinds.map(tick).collect()
}

fn tick_text(legend: &Legend<'_>, tick: u32) -> String {
    let (low, high) = (f64::from(legend.low), f64::from(legend.high));
    let share = f64::from(tick) / f64::from(NUM_TICKS - 1);
    short_number(low + (high - low) * share, (high - low).abs())
}

/// A number with three digits of the range that it is part of.
fn short_number(value: f64, range: f64) -> String {
    let largest = value.abs().max(range);
    if value == 0.0 || value.abs() < 1e-6 * range {
        return "0".to_owned();
    }
    if !(1e-3..1e5).contains(&largest) {
        return format!("{value:.1e}");
    }
    let decimals = (2.0 - range.log10().floor()).clamp(0.0, 6.0);
    let text = format!("{value:.*}", whole(decimals));
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[expect(clippy::cast_sign_loss, reason = "clamped before")]
fn whole(number: f64) -> usize {
    number as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ColorMap;

    const LEGEND: Legend<'_> = Legend {
        map: ColorMap::Viridis,
        low: -0.5,
        high: 2.0,
        label: "strain (%)",
    };

    #[test]
    fn the_ends_of_the_bar_have_the_colors_and_names_of_the_ends_of_the_range() {
        assert_eq!(bar_color(&LEGEND, 0, 100), ColorMap::Viridis.color(1.0));
        assert_eq!(bar_color(&LEGEND, 99, 100), ColorMap::Viridis.color(0.0));
        assert_eq!(tick_text(&LEGEND, 0), "-0.5");
        assert_eq!(tick_text(&LEGEND, NUM_TICKS - 1), "2");
    }

    #[test]
    fn kinds_are_named_where_their_color_is() {
        let legend = Legend {
            map: ColorMap::Problems,
            low: 0.0,
            high: 3.0,
            label: "problems",
        };
        for (kind, (share, name)) in ticks(&legend).into_iter().enumerate() {
            assert_eq!(name, crate::Problem::ALL[kind].name());
            let row = (100.0 * (1.0 - share)) as u32;
            let color = ColorMap::Problems.color(kind as f32 / 3.0);
            assert_eq!(bar_color(&legend, row, 101), color, "{name}");
        }
    }

    #[test]
    fn numbers_are_as_short_as_their_range_allows() {
        assert_eq!(short_number(12.3456, 20.0), "12.3");
        assert_eq!(short_number(100.0, 200.0), "100");
        assert_eq!(short_number(1.0e-9, 2.0e-9), "1.0e-9");
        assert_eq!(short_number(1.0e-12, 3.0), "0");
    }
}
