//! Line charts as SVG.

use plotters::prelude::*;

use crate::{
    Rgb, ViewError,
    canvas::{color, told},
    letters, palette,
};

/// Lines over one pair of axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Above the lines.
    pub title: String,
    /// To the right.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// The lines, the first one in the strongest color.
    pub series: Vec<Series>,
}

/// An axis of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What it shows, with the unit.
    pub label: String,
    /// How values are spread.
    pub scale: Scale,
}

/// How values are spread over an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By their logarithm; values that are not positive are left out.
    Logarithmic,
}

/// A line of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What it is, for the legend.
    pub name: String,
    /// Its points, in order; those that are not finite are left out.
    pub points: Vec<[f64; 2]>,
}

/// Width and height, in pixels.
const SIZE: (u32, u32) = (900, 540);

/// Colors of the lines, in order; they repeat.
const COLORS: [Rgb; 6] = [
    palette::GARMENT,
    palette::REFERENCE,
    palette::THIRD,
    Rgb::new(196, 128, 30),
    Rgb::new(116, 76, 160),
    palette::INK,
];

impl Chart {
    /// Draws the chart.
    ///
    /// # Errors
    ///
    /// [`ViewError::NoPoints`] if there is nothing to show.
    ///
    /// # Examples
    ///
    /// ```
    /// use garnet_view::{Axis, Chart, Scale, Series};
    ///
    /// let axis = |label: &str, scale| Axis { label: label.to_owned(), scale };
    /// let svg = Chart {
    ///     title: "training".to_owned(),
    ///     x: axis("epoch", Scale::Linear),
    ///     y: axis("loss", Scale::Logarithmic),
    ///     series: vec![Series {
    ///         name: "train".to_owned(),
    ///         points: vec![[1.0, 0.5], [2.0, 0.05]],
    ///     }],
    /// }
    /// .to_svg()?;
    /// assert!(svg.starts_with("<svg") && svg.contains("epoch"));
    /// # Ok::<(), garnet_view::ViewError>(())
    /// ```
    pub fn to_svg(&self) -> Result<String, ViewError> {
        let shown: Vec<Vec<(f64, f64)>> = (self.series.iter())
            .map(|series| {
                let placed = |&[x, y]: &[f64; 2]| Some((self.x.place(x)?, self.y.place(y)?));
                series.points.iter().filter_map(placed).collect()
            })
            .collect();
        let [x_range, y_range] = [0, 1].map(|axis| {
            let values = shown.iter().flatten();
            range(values.map(move |point| if axis == 0 { point.0 } else { point.1 }))
        });
        let (Some(x_range), Some(y_range)) = (x_range, y_range) else {
            return Err(ViewError::NoPoints {
                title: self.title.clone(),
            });
        };
        let mut svg = String::new();
        letters::ready()
            .and_then(|()| self.draw(&mut svg, &shown, [x_range, y_range]))
            .map_err(|reason| ViewError::Chart { reason })?;
        Ok(svg)
    }

    fn draw(
        &self,
        svg: &mut String,
        shown: &[Vec<(f64, f64)>],
        [x_range, y_range]: [[f64; 2]; 2],
    ) -> Result<(), String> {
        let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
        let ink = color(palette::INK);
        area.fill(&color(palette::BACKGROUND)).map_err(told)?;
        let mut chart = ChartBuilder::on(&area)
            .caption(&self.title, ("sans-serif", 22, &ink))
            .margin(12)
            .x_label_area_size(48)
            .y_label_area_size(78)
            .build_cartesian_2d(x_range[0]..x_range[1], y_range[0]..y_range[1])
            .map_err(told)?;
        chart
            .configure_mesh()
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .x_label_formatter(&|value| self.x.label_of(*value))
            .y_label_formatter(&|value| self.y.label_of(*value))
            .light_line_style(TRANSPARENT)
            .label_style(("sans-serif", 15, &ink))
            .axis_desc_style(("sans-serif", 17, &ink))
            .draw()
            .map_err(told)?;
        for (number, (series, points)) in self.series.iter().zip(shown).enumerate() {
            let style = color(COLORS[number % COLORS.len()]).stroke_width(2);
            let line = LineSeries::new(points.iter().copied(), style);
            let drawn = chart.draw_series(line).map_err(told)?;
            drawn
                .label(&series.name)
                .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 18, y)], style));
        }
        let legend = if end_high(shown, y_range) {
            SeriesLabelPosition::LowerRight
        } else {
            SeriesLabelPosition::UpperRight
        };
        chart
            .configure_series_labels()
            .position(legend)
            .label_font(("sans-serif", 16, &ink))
            .background_style(color(palette::BACKGROUND))
            .border_style(color(palette::SKIN))
            .draw()
            .map_err(told)?;
        area.present().map_err(told)
    }
}

/// Whether lines end in the upper half: the legend, on the right, then belongs below them.
fn end_high(shown: &[Vec<(f64, f64)>], [low, high]: [f64; 2]) -> bool {
    let ends: Vec<f64> = (shown.iter())
        .filter_map(|points| points.last().map(|point| point.1))
        .collect();
    ends.iter().sum::<f64>() > ends.len() as f64 * f64::midpoint(low, high)
}

impl Axis {
    /// Where a value is on the axis.
    fn place(&self, value: f64) -> Option<f64> {
        let place = match self.scale {
            Scale::Linear => value,
            Scale::Logarithmic => value.log10(),
        };
        place.is_finite().then_some(place)
    }

    fn label_of(&self, place: f64) -> String {
        match self.scale {
            Scale::Linear => format!("{}", (place * 1e6).round() / 1e6),
            Scale::Logarithmic => format!("{:.1e}", 10.0_f64.powf(place)),
        }
    }
}

/// From the least to the greatest value, with some room.
fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let ends = values.fold(None, |ends: Option<[f64; 2]>, value| {
        let [low, high] = ends.unwrap_or([value; 2]);
        Some([low.min(value), high.max(value)])
    });
    ends.map(|[low, high]| {
        let room = if high > low { 0.03 * (high - low) } else { 0.5 };
        [low - room, high + room]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: Vec<[f64; 2]>) -> Chart {
        let axis = |label: &str, scale| Axis {
            label: label.to_owned(),
            scale,
        };
        Chart {
            title: "a title".to_owned(),
            x: axis("threshold, cm", Scale::Linear),
            y: axis("loss", Scale::Logarithmic),
            series: vec![Series {
                name: "local".to_owned(),
                points,
            }],
        }
    }

    #[test]
    fn legends_keep_clear_of_where_lines_end() {
        let rising = vec![vec![(0.0, 0.0), (1.0, 0.9)], vec![(0.0, 0.0), (1.0, 1.0)]];
        let falling = vec![vec![(0.0, 1.0), (1.0, 0.1)], Vec::new()];
        assert!(end_high(&rising, [0.0, 1.0]));
        assert!(!end_high(&falling, [0.0, 1.0]));
    }

    #[test]
    fn a_chart_names_what_it_shows() {
        let svg = chart(vec![[0.0, 1.0], [1.0, 0.1], [2.0, f64::NAN], [3.0, -1.0]]);
        let svg = svg.to_svg().unwrap();
        for text in ["a title", "threshold, cm", "loss", "local", "polyline"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn a_single_point_is_enough_and_none_are_not() {
        assert!(chart(vec![[1.0, 1.0]]).to_svg().is_ok());
        let error = chart(vec![[1.0, 0.0]]).to_svg().unwrap_err();
        assert!(matches!(error, ViewError::NoPoints { .. }));
    }
}
