//! Charts: marks with names, lines and levels over two axes, as SVG and as pixels.

mod draw;
mod labels;
mod series;
mod sheet;
mod ticks;

use crate::{Image, Rgb, ViewError, canvas};
use draw::Prepared;
pub use series::Series;

/// Marks and lines over two axes.
///
/// What an axis cannot show is left out: numbers that are not finite and, if it is logarithmic,
/// those that are not above zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Above all.
    pub title: String,
    /// Below the title, smaller: what was measured and how.
    pub subtitle: String,
    /// The axis to the right.
    pub x: Axis,
    /// The axis upwards.
    pub y: Axis,
    /// Marks.
    pub marks: Vec<Mark>,
    /// Lines between places.
    pub lines: Vec<Line>,
    /// Lines across the whole chart.
    pub levels: Vec<Level>,
    /// What marks and lines mean.
    pub legend: Vec<Entry>,
}

/// An axis of a chart.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// What it shows, with the unit.
    pub label: String,
    /// How values are spread over it.
    pub scale: Scale,
}

/// How values are spread over an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By their logarithm.
    Logarithmic,
}

impl Axis {
    /// An axis on which equal steps are equal differences.
    pub fn linear(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            scale: Scale::Linear,
        }
    }

    /// An axis on which equal steps are equal factors.
    pub fn logarithmic(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            scale: Scale::Logarithmic,
        }
    }
}

/// A place that was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Where it is.
    pub at: [f64; 2],
    /// How far to the right a thin line goes from it.
    pub reach: Option<f64>,
    /// What is written beside it.
    pub name: String,
    /// Whether the name is written in bold letters.
    pub is_strong: bool,
    /// How it looks.
    pub symbol: Symbol,
}

/// How a mark looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Symbol {
    /// The outline.
    pub shape: Shape,
    /// The color.
    pub color: Rgb,
    /// Whether it is filled with the color.
    pub is_filled: bool,
}

/// The outline of a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A disc.
    Circle,
    /// A square.
    Square,
    /// A triangle that points upwards.
    Triangle,
    /// A square that stands on a corner.
    Diamond,
}

/// A line between places.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// The places, in order.
    pub points: Vec<[f64; 2]>,
    /// How it looks.
    pub stroke: Stroke,
}

/// How a line looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stroke {
    /// The color.
    pub color: Rgb,
    /// Whether it is broken.
    pub is_dashed: bool,
}

/// A line across the chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Its height.
    pub y: f64,
    /// What is written over it.
    pub name: String,
    /// How it looks.
    pub stroke: Stroke,
}

/// What a mark or line means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// The mark or line.
    pub key: Key,
    /// Its meaning.
    pub text: String,
}

/// A mark or line in the legend.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Key {
    /// A mark.
    Mark(Symbol),
    /// A line.
    Line(Stroke),
    /// The thin line to the right of a mark.
    Reach,
}

/// Colors that are told apart with all kinds of color vision (*Okabe and Ito 2008*).
pub mod safe {
    use crate::Rgb;

    /// Blue.
    pub const BLUE: Rgb = Rgb::new(0, 114, 178);
    /// Red towards orange.
    pub const VERMILLION: Rgb = Rgb::new(213, 94, 0);
    /// Green towards blue.
    pub const GREEN: Rgb = Rgb::new(0, 158, 115);
    /// Purple towards red.
    pub const PURPLE: Rgb = Rgb::new(204, 121, 167);
    /// Orange.
    pub const ORANGE: Rgb = Rgb::new(230, 159, 0);
    /// Light blue.
    pub const SKY: Rgb = Rgb::new(86, 180, 233);
}

impl Chart {
    /// The chart as SVG, 900 pixels wide.
    ///
    /// # Errors
    ///
    /// [`ViewError::NoPoints`] if no mark and no point of a line can be shown.
    ///
    /// # Examples
    ///
    /// ```
    /// use garnet_view::{Axis, Chart, Mark, Shape, Symbol, safe};
    ///
    /// let chart = Chart {
    ///     title: "cost and error".to_owned(),
    ///     subtitle: String::new(),
    ///     x: Axis::logarithmic("ms"),
    ///     y: Axis::logarithmic("mm"),
    ///     marks: vec![Mark {
    ///         at: [12.0, 3.5],
    ///         reach: None,
    ///         name: "warp".to_owned(),
    ///         is_strong: false,
    ///         symbol: Symbol { shape: Shape::Square, color: safe::BLUE, is_filled: true },
    ///     }],
    ///     lines: Vec::new(),
    ///     levels: Vec::new(),
    ///     legend: Vec::new(),
    /// };
    /// assert!(chart.to_svg()?.contains("warp"));
    /// assert_eq!(chart.to_image()?.width(), 1800);
    /// # Ok::<(), garnet_view::ViewError>(())
    /// ```
    pub fn to_svg(&self) -> Result<String, ViewError> {
        canvas::svg(&Prepared::new(self)?)
    }

    /// The chart as pixels, twice as many each way as the SVG has.
    ///
    /// # Errors
    ///
    /// [`ViewError::NoPoints`] if no mark and no point of a line can be shown.
    pub fn to_image(&self) -> Result<Image, ViewError> {
        canvas::image(&Prepared::new(self)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(at: [f64; 2]) -> Chart {
        let symbol = Symbol {
            shape: Shape::Circle,
            color: safe::BLUE,
            is_filled: true,
        };
        let stroke = Stroke {
            color: safe::GREEN,
            is_dashed: true,
        };
        Chart {
            title: "a title".to_owned(),
            subtitle: "a subtitle".to_owned(),
            x: Axis::logarithmic("time, ms"),
            y: Axis::logarithmic("distance, mm"),
            marks: vec![Mark {
                at,
                reach: Some(3.0 * at[0]),
                name: "local".to_owned(),
                is_strong: true,
                symbol,
            }],
            lines: vec![Line {
                points: vec![[1.0, 1.0], [20.0, f64::NAN], [30.0, 2.0]],
                stroke,
            }],
            levels: vec![Level {
                y: 0.9,
                name: "noise floor".to_owned(),
                stroke,
            }],
            legend: vec![Entry {
                key: Key::Mark(symbol),
                text: "network".to_owned(),
            }],
        }
    }

    #[test]
    fn a_chart_says_what_it_shows() {
        let svg = chart([12.0, 3.0]).to_svg().unwrap();
        let texts = [
            "a title",
            "a subtitle",
            "time, ms",
            "distance, mm",
            "local",
            "noise floor",
            "network",
            "width=\"900\"",
        ];
        for text in texts {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn the_same_chart_has_the_same_bytes() {
        let images = [0, 1].map(|_| chart([12.0, 3.0]).to_image().unwrap());
        assert_eq!(images[0], images[1]);
        let is_blue = |pixel: &[u8]| *pixel == [0, 114, 178];
        assert!(images[0].pixels().chunks(3).any(is_blue));
    }

    #[test]
    fn nothing_above_zero_is_no_chart() {
        let mut chart = chart([0.0, 3.0]);
        assert!(chart.to_svg().is_ok(), "a line alone is enough");
        chart.lines.clear();
        let error = chart.to_svg().unwrap_err();
        assert!(matches!(error, ViewError::NoPoints { .. }));
    }
}
