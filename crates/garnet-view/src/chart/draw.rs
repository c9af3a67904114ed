//! Lays a chart out and draws it.

use plotters::{coord::Shift, prelude::*};

use super::labels::{Area, Named, Obstacles, Place, placed};
use super::sheet::{Anchor, RADIUS, Sheet};
use super::ticks::{Span, label};
use super::{Chart, Key, Mark, Scale, Stroke};
use crate::{
    Rgb, ViewError,
    canvas::Drawing,
    letters::{self, Letters},
    palette,
};

/// Width and height of a chart, in pixels.
const SIZE: (u32, u32) = (900, 580);

/// Room left of and right of the axes.
const MARGINS: [f64; 2] = [74.0, 32.0];

/// Room below the axes.
const BELOW: f64 = 62.0;

/// Height of a line of the legend.
const LEGEND_LINE: f64 = 20.0;

/// Labels of ticks are at least this far from each other.
const TICKS_APART: f64 = 34.0;

/// How wide a character of a label of a tick is, with what is between two labels.
const TICK_CHARACTER: f64 = 8.5;

/// Names farther from their marks are tied to them by a line.
const FAR: f64 = 9.0;

const GRID: Rgb = Rgb::new(226, 228, 232);
const GREY: Rgb = Rgb::new(96, 98, 104);

const TITLE: Letters = letters(20.0, true, palette::INK);
const SUBTITLE: Letters = letters(13.0, false, GREY);
const LABEL: Letters = letters(14.0, false, palette::INK);
const TICK: Letters = letters(12.5, false, palette::INK);
const NAME: Letters = letters(12.5, false, palette::INK);
const STRONG: Letters = letters(12.5, true, palette::INK);

const fn letters(size: f64, is_bold: bool, color: Rgb) -> Letters {
    Letters {
        size,
        is_bold,
        color,
    }
}

const fn solid(color: Rgb) -> Stroke {
    Stroke {
        color,
        is_dashed: false,
    }
}

/// A chart with its axes.
pub(super) struct Prepared<'a> {
    chart: &'a Chart,
    spans: [Span; 2],
    /// Where the axes are.
    frame: Area,
    /// Lines of the legend: entries with how far to the right they begin.
    legend: Vec<Vec<(usize, f64)>>,
}

impl<'a> Prepared<'a> {
    pub(super) fn new(chart: &'a Chart) -> Result<Self, ViewError> {
        letters::ready()?;
        let none = || ViewError::NoPoints {
            title: chart.title.clone(),
        };
        let scales = [chart.x.scale, chart.y.scale];
        let marks = || (chart.marks.iter()).filter(|mark| is_shown(scales, mark.at));
        let lines = || chart.lines.iter().flat_map(|line| &line.points);
        let lines = || lines().copied().filter(|&point| is_shown(scales, point));
        let x = marks().flat_map(|mark| [mark.at[0], mark.reach.unwrap_or(mark.at[0])]);
        let x = Span::around(scales[0], x.chain(lines().map(|point| point[0])));
        let y = marks().map(|mark| mark.at[1]);
        let y = y.chain(chart.levels.iter().map(|level| level.y));
        let y = Span::around(scales[1], y.chain(lines().map(|point| point[1])));
        let legend = legend(chart);
        let top = 62.0 + LEGEND_LINE * legend.len() as f64;
        let [width, height] = [SIZE.0, SIZE.1].map(f64::from);
        Ok(Self {
            chart,
            spans: [x.ok_or_else(none)?, y.ok_or_else(none)?],
            frame: Area {
                at: [MARGINS[0], top],
                size: [width - MARGINS[0] - MARGINS[1], height - top - BELOW],
            },
            legend,
        })
    }

    fn shows(&self, values: [f64; 2]) -> bool {
        is_shown([self.chart.x.scale, self.chart.y.scale], values)
    }

    /// Where values are in the picture.
    fn place(&self, values: [f64; 2]) -> Place {
        let [x, y] = [0, 1].map(|axis| self.spans[axis].place(values[axis]));
        let Area { at, size } = self.frame;
        [at[0] + x * size[0], at[1] + (1.0 - y) * size[1]]
    }

    fn axes<DB: DrawingBackend>(&self, sheet: &Sheet<'_, DB>) -> Result<(), String>
    where
        DB::ErrorType: 'static,
    {
        let Area { at, size } = self.frame;
        let [right, bottom] = [at[0] + size[0], at[1] + size[1]];
        for axis in [0, 1] {
            let mut last = f64::INFINITY;
            for tick in self.spans[axis].ticks().into_iter().rev() {
                let far = self.spans[axis].place(tick);
                let ends = if axis == 0 {
                    let x = at[0] + far * size[0];
                    [[x, at[1]], [x, bottom]]
                } else {
                    let y = bottom - far * size[1];
                    [[at[0], y], [right, y]]
                };
                sheet.line(&ends, solid(GRID), 1.0)?;
                let along = far * size[axis];
                let text = label(tick);
                let room = if axis == 0 {
                    TICKS_APART.max(TICK_CHARACTER * text.chars().count() as f64)
                } else {
                    0.6 * TICKS_APART
                };
                if last - along < room {
                    continue;
                }
                last = along;
                match axis {
                    0 => sheet.text(&text, [ends[1][0], bottom + 7.0], Anchor::Top, TICK)?,
                    _ => sheet.text(&text, [at[0] - 8.0, ends[0][1]], Anchor::Right, TICK)?,
                }
            }
        }
        let corner = [[at[0], at[1]], [at[0], bottom], [right, bottom]];
        sheet.line(&corner, solid(palette::INK), 1.25)?;
        let middle = [at[0] + 0.5 * size[0], at[1] + 0.5 * size[1]];
        let chart = self.chart;
        sheet.text(
            &chart.x.label,
            [middle[0], bottom + 31.0],
            Anchor::Top,
            LABEL,
        )?;
        sheet.text(&chart.y.label, [18.0, middle[1]], Anchor::Turned, LABEL)
    }

    fn heads<DB: DrawingBackend>(&self, sheet: &Sheet<'_, DB>) -> Result<(), String>
    where
        DB::ErrorType: 'static,
    {
        let left = MARGINS[0] - 50.0;
        sheet.text(&self.chart.title, [left, 22.0], Anchor::Left, TITLE)?;
        sheet.text(&self.chart.subtitle, [left, 45.0], Anchor::Left, SUBTITLE)?;
        for (number, line) in self.legend.iter().enumerate() {
            let y = 67.0 + LEGEND_LINE * number as f64;
            for &(entry, x) in line {
                let entry = &self.chart.legend[entry];
                let ends = [[x, y], [x + 22.0, y]];
                match entry.key {
                    Key::Mark(symbol) => sheet.symbol([x + 11.0, y], symbol)?,
                    Key::Line(stroke) => sheet.line(&ends, stroke, 1.75)?,
                    Key::Reach => sheet.line(&ends, solid(GREY), 1.0)?,
                }
                sheet.text(&entry.text, [x + 28.0, y], Anchor::Left, SUBTITLE)?;
            }
        }
        Ok(())
    }

    /// Lines and levels; returns their pieces, and the boxes of the names of levels.
    fn lines<DB: DrawingBackend>(&self, sheet: &Sheet<'_, DB>) -> Result<Obstacles, String>
    where
        DB::ErrorType: 'static,
    {
        let mut obstacles = Obstacles::default();
        let mut add = |points: &[Place]| {
            let pieces = points.windows(2).map(|ends| [ends[0], ends[1]]);
            obstacles.lines.extend(pieces);
        };
        let Area { at, size } = self.frame;
        let mut areas = Vec::new();
        for level in self
            .chart
            .levels
            .iter()
            .filter(|level| self.chart.y.scale.shows(level.y))
        {
            let y = self.place([self.spans[0].low, level.y])[1];
            let ends = [[at[0], y], [at[0] + size[0], y]];
            sheet.line(&ends, level.stroke, 1.5)?;
            add(&ends);
            let [width, height] = NAME.size_of(&level.name);
            let corner = [at[0] + 8.0, y - height - 3.0];
            let letters = Letters {
                color: level.stroke.color,
                ..NAME
            };
            let middle = [corner[0], corner[1] + 0.5 * height];
            sheet.text(&level.name, middle, Anchor::Left, letters)?;
            areas.push(Area {
                at: corner,
                size: [width, height],
            });
        }
        for line in &self.chart.lines {
            let points = line.points.iter().filter(|&&point| self.shows(point));
            let points: Vec<Place> = points.map(|&point| self.place(point)).collect();
            sheet.line(&points, line.stroke, 1.75)?;
            add(&points);
        }
        obstacles.areas = areas;
        Ok(obstacles)
    }

    fn marks<DB: DrawingBackend>(
        &self,
        sheet: &Sheet<'_, DB>,
        mut obstacles: Obstacles,
    ) -> Result<(), String>
    where
        DB::ErrorType: 'static,
    {
        let marks = self.chart.marks.iter().filter(|mark| self.shows(mark.at));
        let mut marks: Vec<_> = marks.map(|mark| (mark, self.place(mark.at))).collect();
        // Strong ones lie over the others, and their names are placed first.
        marks.sort_by_key(|(mark, _)| mark.is_strong);
        for (mark, at) in &marks {
            if let Some(reach) = mark.reach.filter(|&reach| reach > mark.at[0]) {
                let end = self.place([reach, mark.at[1]]);
                let tips = [[end[0], end[1] - 3.0], [end[0], end[1] + 3.0]];
                let stroke = solid(mark.symbol.color);
                sheet.line(&[*at, end], stroke, 1.0)?;
                sheet.line(&tips, stroke, 1.0)?;
                obstacles.lines.push([*at, end]);
            }
            obstacles.areas.push(Area::around(*at, RADIUS));
        }
        let letters = |mark: &Mark| if mark.is_strong { STRONG } else { NAME };
        let named = marks.iter().rev();
        let named: Vec<_> = named.filter(|(mark, _)| !mark.name.is_empty()).collect();
        let names: Vec<Named> = (named.iter())
            .map(|(mark, at)| Named {
                at: *at,
                radius: RADIUS,
                size: letters(mark).size_of(&mark.name),
            })
            .collect();
        let areas = placed(&names, &obstacles, self.frame);
        for ((_, at), area) in named.iter().zip(&areas) {
            let [from, to] = area.tie(*at);
            if (to[0] - from[0]).hypot(to[1] - from[1]) > RADIUS + FAR {
                sheet.line(&[from, to], solid(GREY), 0.75)?;
            }
        }
        for (mark, at) in &marks {
            sheet.symbol(*at, mark.symbol)?;
        }
        for ((mark, _), area) in named.iter().zip(&areas) {
            let middle = [area.at[0], area.at[1] + 0.5 * area.size[1]];
            sheet.text(&mark.name, middle, Anchor::Left, letters(mark))?;
        }
        Ok(())
    }
}

impl Drawing for Prepared<'_> {
    fn size(&self) -> (u32, u32) {
        SIZE
    }

    fn draw<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        drop: f64,
    ) -> Result<(), String>
    where
        DB::ErrorType: 'static,
    {
        area.fill(&WHITE).map_err(crate::canvas::told)?;
        let sheet = Sheet { area, drop };
        self.heads(&sheet)?;
        self.axes(&sheet)?;
        let obstacles = self.lines(&sheet)?;
        self.marks(&sheet, obstacles)
    }
}

fn is_shown(scales: [Scale; 2], values: [f64; 2]) -> bool {
    (scales.iter().zip(values)).all(|(scale, value)| scale.shows(value))
}

/// Breaks the legend into lines.
fn legend(chart: &Chart) -> Vec<Vec<(usize, f64)>> {
    let left = MARGINS[0] - 50.0;
    let right = f64::from(SIZE.0) - MARGINS[1];
    let mut lines: Vec<Vec<(usize, f64)>> = Vec::new();
    let mut x = f64::INFINITY;
    for (number, entry) in chart.legend.iter().enumerate() {
        let width = 28.0 + SUBTITLE.size_of(&entry.text)[0];
        if x + width > right {
            lines.push(Vec::new());
            x = left;
        }
        if let Some(line) = lines.last_mut() {
            line.push((number, x));
        }
        x += width + 20.0;
    }
    lines
}
