//! A first mesh of the left half: surface nets.

use garnet_body::shape::BodySurface;

use super::Vec3;
use super::remesh::Half;

/// Corner samples of a box that holds the left half, from which cells are made.
struct Grid {
    step: f64,
    counts: [usize; 3],
    values: Vec<f64>,
}

impl Grid {
    /// Corners lie at `x = ±step/2, ±3 step/2, …`, so that the first cells are cut by the middle.
    fn new(surface: &BodySurface, step: f64) -> Self {
        let size = [1.0, surface.stature() + 0.06, 0.64];
        let counts = size.map(|length| (length / step) as usize);
        let mut grid = Self {
            step,
            counts,
            values: vec![1.0; counts.iter().product()],
        };
        let [nx, ny, nz] = counts;
        for i in 0..nx {
            for j in 0..ny {
                let mut k = 0;
                while k < nz {
                    let value = surface.distance(grid.corner([i, j, k]).into());
                    // Half the distance is certainly free of surface.
                    let skip = ((0.3 * value.abs() / step) as usize).clamp(1, 40);
                    for next in k..(k + skip).min(nz) {
                        let index = grid.index([i, j, next]);
                        grid.values[index] = value;
                    }
                    k += skip;
                }
            }
        }
        grid
    }

    fn corner(&self, [i, j, k]: [usize; 3]) -> Vec3 {
        let at = |index: usize| index as f64 * self.step;
        Vec3::new(at(i) - 0.5 * self.step, at(j) - 0.03, at(k) - 0.30)
    }

    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (i * self.counts[1] + j) * self.counts[2] + k
    }

    fn is_inside(&self, corner: [usize; 3]) -> bool {
        self.values[self.index(corner)] < 0.0
    }

    /// Whether the surface passes through a cell.
    fn is_cut(&self, [i, j, k]: [usize; 3]) -> bool {
        let inside = (0..8)
            .filter(|bit| self.is_inside([i + (bit & 1), j + (bit >> 1 & 1), k + (bit >> 2 & 1)]));
        !matches!(inside.count(), 0 | 8)
    }
}

/// The surface of the left half, with its border in the middle plane.
pub(crate) fn left_half(surface: &BodySurface, step: f64) -> Half {
    let grid = Grid::new(surface, step);
    let [nx, ny, nz] = grid.counts;
    let mut vertices = vec![u32::MAX; nx * ny * nz];
    let mut half = Half::default();
    for i in 0..nx - 1 {
        for j in 0..ny - 1 {
            for k in 0..nz - 1 {
                if !grid.is_cut([i, j, k]) {
                    continue;
                }
                vertices[grid.index([i, j, k])] = half.positions.len() as u32;
                half.positions
                    .push(grid.corner([i, j, k]) + Vec3::repeat(0.5 * step));
                half.is_middle.push(i == 0);
            }
        }
    }
    for i in 1..nx - 1 {
        for j in 1..ny - 1 {
            for k in 1..nz - 1 {
                for axis in 0..3 {
                    let mut end = [i, j, k];
                    end[axis] += 1;
                    if grid.is_inside([i, j, k]) == grid.is_inside(end) {
                        continue;
                    }
                    let cell = |du: usize, dv: usize| {
                        let mut cell = [i, j, k];
                        cell[(axis + 1) % 3] -= du;
                        cell[(axis + 2) % 3] -= dv;
                        vertices[grid.index(cell)]
                    };
                    let [a, b, c, d] = [cell(1, 1), cell(0, 1), cell(0, 0), cell(1, 0)];
                    if grid.is_inside([i, j, k]) {
                        half.faces.extend([[a, b, c], [a, c, d]]);
                    } else {
                        half.faces.extend([[a, c, b], [a, d, c]]);
                    }
                }
            }
        }
    }
    half
}
