//! Charts of lines alone.

use super::{Axis, Chart, Entry, Key, Line, Stroke, safe};
use crate::{Rgb, palette};

/// A line of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What it is, for the legend.
    pub name: String,
    /// Its points, in order; those that the axes cannot show are left out.
    pub points: Vec<[f64; 2]>,
}

/// Colors of the lines, in order; when they repeat, lines are broken.
const COLORS: [Rgb; 7] = [
    safe::BLUE,
    safe::VERMILLION,
    safe::GREEN,
    safe::PURPLE,
    safe::ORANGE,
    safe::SKY,
    palette::INK,
];

impl Chart {
    /// A chart of lines, with the axes to the right and upwards.
    ///
    /// # Examples
    ///
    /// ```
    /// use garnet_view::{Axis, Chart, Series};
    ///
    /// let series = Series {
    ///     name: "train".to_owned(),
    ///     points: vec![[1.0, 0.5], [2.0, 0.05]],
    /// };
    /// let axes = [Axis::linear("epoch"), Axis::logarithmic("loss")];
    /// let svg = Chart::of_series("training", axes, &[series]).to_svg()?;
    /// assert!(svg.starts_with("<svg") && svg.contains("epoch"));
    /// # Ok::<(), garnet_view::ViewError>(())
    /// ```
    pub fn of_series(title: &str, [x, y]: [Axis; 2], series: &[Series]) -> Self {
        let stroke = |number: usize| Stroke {
            color: COLORS[number % COLORS.len()],
            is_dashed: (number / COLORS.len()) % 2 == 1,
        };
        Self {
            title: title.to_owned(),
            subtitle: String::new(),
            x,
            y,
            marks: Vec::new(),
            lines: (series.iter().enumerate())
                .map(|(number, series)| Line {
                    points: series.points.clone(),
                    stroke: stroke(number),
                })
                .collect(),
            levels: Vec::new(),
            legend: (series.iter().enumerate())
                .map(|(number, series)| Entry {
                    key: Key::Line(stroke(number)),
                    text: series.name.clone(),
                })
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ViewError;

    fn chart(points: Vec<[f64; 2]>) -> Chart {
        let name = "local".to_owned();
        let axes = [Axis::linear("threshold, cm"), Axis::logarithmic("loss")];
        Chart::of_series("a title", axes, &[Series { name, points }])
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

    #[test]
    fn lines_of_one_color_differ() {
        let series = vec![
            Series {
                name: String::new(),
                points: Vec::new()
            };
            2 * COLORS.len()
        ];
        let axes = [Axis::linear(""), Axis::linear("")];
        let lines = Chart::of_series("", axes, &series).lines;
        for (number, line) in lines.iter().enumerate() {
            assert!(
                !lines[..number]
                    .iter()
                    .any(|other| other.stroke == line.stroke)
            );
        }
    }
}
