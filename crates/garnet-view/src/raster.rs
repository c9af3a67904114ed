//! Which triangle is seen where.
//!
//! A sample sees the nearest piece that covers it. Two pieces at a common edge never both cover a
//! sample, nor leave a gap: the side of an edge is computed from its two ends in one order,
//! whichever piece asks, and a sample on an edge belongs to one side of it.

use crate::clip::Piece;

/// A grid of samples over part of a view.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Window {
    /// The pixel coordinates of the upper left corner.
    pub(crate) origin: [f64; 2],
    /// Pixels from sample to sample.
    pub(crate) step: f64,
    pub(crate) num_columns: usize,
    pub(crate) num_rows: usize,
}

/// What a sample sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hit {
    pub(crate) nearness: f32,
    /// [`Hit::NOTHING`] where no triangle is.
    pub(crate) triangle: u32,
}

impl Hit {
    pub(crate) const NOTHING: u32 = u32::MAX;

    pub(crate) const NONE: Self = Self {
        nearness: f32::NEG_INFINITY,
        triangle: Self::NOTHING,
    };
}

impl Window {
    /// The pixel coordinates of a sample.
    pub(crate) fn pixel(&self, column: usize, row: usize) -> [f64; 2] {
        [
            self.origin[0] + self.step * (column as f64 + 0.5),
            self.origin[1] + self.step * (row as f64 + 0.5),
        ]
    }
}

/// Draws pieces over `hits`, which has a row of the window after the other.
pub(crate) fn draw<'a>(pieces: impl Iterator<Item = &'a Piece>, window: &Window, hits: &mut [Hit]) {
    for piece in pieces {
        draw_piece(piece, window, hits);
    }
}

fn draw_piece(piece: &Piece, window: &Window, hits: &mut [Hit]) {
    let mut corners = piece.corners;
    if piece.is_clockwise() {
        corners.swap(1, 2);
    }
    let [[ax, ay, a], [bx, by, b], [cx, cy, c]] = corners;
    let area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    if area.partial_cmp(&0.0) != Some(std::cmp::Ordering::Less) {
        return;
    }
    let slope_x = ((b - a) * (cy - ay) - (c - a) * (by - ay)) / area;
    let slope_y = ((c - a) * (bx - ax) - (b - a) * (cx - ax)) / area;
    let (least, most) = (a.min(b).min(c), a.max(b).max(c));
    let edges = [(0, 1), (1, 2), (2, 0)].map(|(from, to)| Edge::new(corners[from], corners[to]));
    let columns = covered(ax.min(bx).min(cx), ax.max(bx).max(cx), 0, window);
    let rows = covered(ay.min(by).min(cy), ay.max(by).max(cy), 1, window);
    for row in rows {
        let y = window.pixel(0, row)[1];
        let sides = edges.map(|edge| edge.row(y));
        let row_hits = &mut hits[row * window.num_columns..][..window.num_columns];
        for column in columns.clone() {
            let x = window.pixel(column, 0)[0];
            if !edges
                .iter()
                .zip(sides)
                .all(|(edge, side)| edge.has_inside(side, x))
            {
                continue;
            }
            // A sliver has no dependable slope; its corners bound what it can be.
            let nearness = a + slope_x * (x - ax) + slope_y * (y - ay);
            let nearness = nearness.max(least).min(most) as f32;
            if nearness > row_hits[column].nearness {
                row_hits[column] = Hit {
                    nearness,
                    triangle: piece.triangle,
                };
            }
        }
    }
}

/// The samples of one axis between two pixel coordinates.
#[expect(clippy::cast_sign_loss, reason = "a float cast saturates at zero")]
fn covered(from: f64, to: f64, axis: usize, window: &Window) -> std::ops::Range<usize> {
    let count = if axis == 0 {
        window.num_columns
    } else {
        window.num_rows
    };
    let sample = |pixel: f64| (pixel - window.origin[axis]) / window.step - 0.5;
    let first = sample(from).ceil().max(0.0) as usize;
    let after = (sample(to).floor() + 1.0).max(0.0) as usize;
    first.min(count)..after.min(count)
}

/// A side of a piece whose corners run counter-clockwise on the picture.
#[derive(Debug, Clone, Copy)]
struct Edge {
    /// The end with the smaller coordinates.
    start: [f64; 2],
    along: [f64; 2],
    /// 1 if the corners of the piece run from the start to the other end, else -1.
    sign: f64,
    /// Whether samples on the edge are inside.
    has_line: bool,
}

impl Edge {
    fn new(from: [f64; 3], to: [f64; 3]) -> Self {
        let is_forward = (from[0], from[1]) < (to[0], to[1]);
        let (start, end) = if is_forward { (from, to) } else { (to, from) };
        Self {
            start: [start[0], start[1]],
            along: [end[0] - start[0], end[1] - start[1]],
            sign: if is_forward { -1.0 } else { 1.0 },
            has_line: is_forward,
        }
    }

    /// The part of the side test that is the same in a row.
    fn row(&self, y: f64) -> f64 {
        self.along[0] * (y - self.start[1])
    }

    fn has_inside(&self, row: f64, x: f64) -> bool {
        let side = self.sign * (row - self.along[1] * (x - self.start[0]));
        side > 0.0 || (side == 0.0 && self.has_line)
    }
}

/// Pieces sorted into horizontal bands of a view; a piece is in all bands that it touches.
#[derive(Debug)]
pub(crate) struct Bands {
    starts: Vec<usize>,
    pieces: Vec<u32>,
}

impl Bands {
    /// Sorts pieces into `num_bands` bands of `height` pixels each, from the top.
    pub(crate) fn new(pieces: &[Piece], height: f64, num_bands: usize) -> Self {
        let window = Window {
            origin: [0.0, -0.5 * height],
            step: height,
            num_columns: 0,
            num_rows: num_bands,
        };
        let bands = |piece: &Piece| {
            let [a, b, c] = piece.corners.map(|corner| corner[1]);
            // A band more on either side, so that rounding cannot lose a row.
            let slack = 1e-6 * height;
            let from = a.min(b).min(c) - height - slack;
            covered(from, a.max(b).max(c) + slack, 1, &window)
        };
        let mut starts = vec![0; num_bands + 1];
        for piece in pieces {
            for band in bands(piece) {
                starts[band + 1] += 1;
            }
        }
        for band in 0..num_bands {
            starts[band + 1] += starts[band];
        }
        let mut next = starts.clone();
        let mut sorted = vec![0; starts[num_bands]];
        for (index, piece) in (0..).zip(pieces) {
            for band in bands(piece) {
                sorted[next[band]] = index;
                next[band] += 1;
            }
        }
        Self {
            starts,
            pieces: sorted,
        }
    }

    /// The pieces of a band, in their given order.
    pub(crate) fn band<'a>(
        &'a self,
        band: usize,
        pieces: &'a [Piece],
    ) -> impl Iterator<Item = &'a Piece> {
        let range = self.starts[band]..self.starts[band + 1];
        self.pieces[range]
            .iter()
            .map(|&index| &pieces[index as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbors_leave_no_gap_and_never_share_a_sample() {
        let window = Window {
            origin: [0.0, 0.0],
            step: 0.5,
            num_columns: 40,
            num_rows: 40,
        };
        // Corners lie on samples, and edges run through them, on purpose.
        let rim = [
            [0.25, 0.25],
            [10.25, 0.25],
            [19.75, 0.25],
            [19.75, 19.75],
            [0.25, 19.75],
        ];
        let hub = [7.25, 9.75, 0.0];
        let mut counts = vec![0; 1600];
        for (index, from) in rim.iter().enumerate() {
            let to = rim[(index + 1) % rim.len()];
            let mut corners = [hub, [from[0], from[1], 0.0], [to[0], to[1], 0.0]];
            if index % 2 == 0 {
                corners.swap(0, 1);
            }
            let mut hits = vec![Hit::NONE; 1600];
            let triangle = 7;
            draw([Piece { corners, triangle }].iter(), &window, &mut hits);
            for (count, hit) in counts.iter_mut().zip(hits) {
                *count += u32::from(hit.triangle == triangle);
            }
        }
        for row in 1..39 {
            for column in 1..39 {
                assert_eq!(counts[row * 40 + column], 1, "sample {column}, {row}");
            }
        }
        assert!(counts.iter().all(|&count| count <= 1));
    }

    #[test]
    fn a_piece_is_in_every_band_that_it_touches() {
        let piece = |low, high| Piece {
            corners: [[0.0, low, 0.0], [1.0, high, 0.0], [2.0, low, 0.0]],
            triangle: 0,
        };
        let pieces = [
            piece(-5.0, -1.0),
            piece(1.0, 2.0),
            piece(3.0, 9.0),
            piece(40.0, 50.0),
        ];
        let bands = Bands::new(&pieces, 4.0, 4);
        let counts = [0, 1, 2, 3].map(|band| bands.band(band, &pieces).count());
        assert_eq!(counts, [2, 1, 1, 0]);
    }
}
