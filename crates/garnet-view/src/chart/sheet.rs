//! Strokes, symbols and letters in pixels of the chart.

use plotters::{
    coord::Shift,
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};

use super::labels::Place;
use super::{Shape, Stroke, Symbol};
use crate::{
    canvas::{FINE, color, told},
    letters::Letters,
};

/// Lengths of dashes and of the gaps between them.
const DASH: [f64; 2] = [6.0, 4.0];

/// Radius of a mark.
pub(super) const RADIUS: f64 = 5.5;

/// Where the place of a text is in it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Anchor {
    /// At the left, half way up.
    Left,
    /// At the right, half way up.
    Right,
    /// In the middle above it.
    Top,
    /// In the middle, the text running upwards.
    Turned,
}

/// What is drawn on.
pub(super) struct Sheet<'a, DB: DrawingBackend> {
    pub(super) area: &'a DrawingArea<DB, Shift>,
    /// By how much of their size texts are moved down.
    pub(super) drop: f64,
}

impl<DB: DrawingBackend> Sheet<'_, DB>
where
    DB::ErrorType: 'static,
{
    pub(super) fn text(
        &self,
        text: &str,
        at: Place,
        anchor: Anchor,
        letters: Letters,
    ) -> Result<(), String> {
        let pos = match anchor {
            Anchor::Left => Pos::new(HPos::Left, VPos::Center),
            Anchor::Right => Pos::new(HPos::Right, VPos::Center),
            Anchor::Top => Pos::new(HPos::Center, VPos::Top),
            Anchor::Turned => Pos::new(HPos::Center, VPos::Center),
        };
        let mut font = letters.font(FINE);
        if matches!(anchor, Anchor::Turned) {
            font = font.transform(FontTransform::Rotate270);
        }
        let ink = color(letters.color);
        let style = TextStyle::from(font).pos(pos).color(&ink);
        let drop = self.drop * letters.size;
        let at = match anchor {
            Anchor::Turned => [at[0] + drop, at[1]],
            _ => [at[0], at[1] + drop],
        };
        self.area.draw_text(text, &style, units(at)).map_err(told)
    }

    /// A line of a width in pixels.
    pub(super) fn line(&self, points: &[Place], stroke: Stroke, width: f64) -> Result<(), String> {
        let style = color(stroke.color).stroke_width((width * f64::from(FINE)) as u32);
        let pieces = if stroke.is_dashed {
            dashes(points)
        } else {
            vec![points.to_vec()]
        };
        for piece in pieces {
            let path: Vec<(i32, i32)> = piece.into_iter().map(units).collect();
            self.area
                .draw(&PathElement::new(path, style))
                .map_err(told)?;
        }
        Ok(())
    }

    pub(super) fn symbol(&self, at: Place, symbol: Symbol) -> Result<(), String> {
        let ink = color(symbol.color);
        self.shape(at, symbol.shape, RADIUS, ink)?;
        if symbol.is_filled {
            return Ok(());
        }
        self.shape(at, symbol.shape, RADIUS - inset(symbol.shape), WHITE)
    }

    fn shape(&self, at: Place, shape: Shape, radius: f64, ink: RGBColor) -> Result<(), String> {
        let corner = |x: f64, y: f64| units([at[0] + x * radius, at[1] + y * radius]);
        let corners = match shape {
            Shape::Circle => {
                let radius = (radius * f64::from(FINE)).round() as i32;
                let circle = Circle::new(units(at), radius, ink.filled());
                return self.area.draw(&circle).map_err(told);
            }
            Shape::Square => vec![(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            Shape::Triangle => vec![(0.0, -1.2), (1.15, 0.85), (-1.15, 0.85)],
            Shape::Diamond => vec![(0.0, -1.25), (1.25, 0.0), (0.0, 1.25), (-1.25, 0.0)],
        };
        let corners: Vec<(i32, i32)> = corners.into_iter().map(|(x, y)| corner(x, y)).collect();
        self.area
            .draw(&Polygon::new(corners, ink.filled()))
            .map_err(told)
    }
}

/// How much smaller the white inside of a mark is, so that its rim has an even width.
fn inset(shape: Shape) -> f64 {
    match shape {
        Shape::Circle | Shape::Square => 1.9,
        Shape::Triangle | Shape::Diamond => 2.4,
    }
}

/// Cuts a line into dashes.
fn dashes(points: &[Place]) -> Vec<Vec<Place>> {
    let mut pieces = Vec::new();
    let mut phase = 0.0;
    for ends in points.windows(2) {
        let [from, to] = [ends[0], ends[1]];
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let at = |way: f64| [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * way / length);
        let period = DASH[0] + DASH[1];
        let mut start = -phase;
        while start < length {
            let end = (start + DASH[0]).min(length);
            if end > 0.0 {
                pieces.push(vec![at(start.max(0.0)), at(end)]);
            }
            start += period;
        }
        phase = (phase + length) % period;
    }
    pieces
}

fn units(place: Place) -> (i32, i32) {
    let [x, y] = place.map(|value| (value * f64::from(FINE)).round() as i32);
    (x, y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_go_on_round_corners() {
        let pieces = dashes(&[[0.0, 0.0], [8.0, 0.0], [8.0, 12.0]]);
        let expected = [[[0.0, 0.0], [6.0, 0.0]], [[8.0, 2.0], [8.0, 8.0]]];
        for (piece, expected) in pieces.iter().zip(expected) {
            for (place, expected) in piece.iter().zip(expected) {
                assert!((place[0] - expected[0]).hypot(place[1] - expected[1]) < 1e-12);
            }
        }
        assert_eq!(pieces.len(), expected.len());
    }
}
