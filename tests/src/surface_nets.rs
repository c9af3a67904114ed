//! The level zero of a field as a mesh: one vertex in each cell of a grid that the level runs
//! through, one square across each edge of the grid that it crosses (Gibson 1998, "Constrained
//! elastic surface nets").

use garnet::{Point3, TriMesh, Vector3};

use crate::bone::onto_level;

/// The zero level of `field` in the box from `low` to `high`, which it must not leave.
///
/// # Panics
///
/// If the field has no zero level in the box.
pub(crate) fn surface_nets(
    field: impl Fn(Point3) -> f32,
    [low, high]: [Point3; 2],
    cell: f32,
) -> TriMesh {
    let count = |axis: usize| ((high[axis] - low[axis]) / cell) as usize + 2;
    let size = [count(0), count(1), count(2)];
    let index = |[i, j, k]: [usize; 3]| (k * size[1] + j) * size[0] + i;
    let mut values = Vec::with_capacity(size.iter().product());
    for k in 0..size[2] {
        for j in 0..size[1] {
            for i in 0..size[0] {
                let offset = Vector3::new(i as f32, j as f32, k as f32);
                values.push(field(low + cell * offset));
            }
        }
    }
    let mut positions = Vec::new();
    let mut vertex_of_cell = vec![u32::MAX; values.len()];
    let mut faces = Vec::new();
    for k in 0..size[2] - 1 {
        for j in 0..size[1] - 1 {
            for i in 0..size[0] - 1 {
                let corners = cell_corners([i, j, k]);
                let at = |corner: [usize; 3]| values[index(corner)];
                let num_inside = corners.iter().filter(|&&c| at(c) < 0.0).count();
                if num_inside == 0 || num_inside == 8 {
                    continue;
                }
                vertex_of_cell[index([i, j, k])] = positions.len() as u32;
                let start = middle_of_crossings(&corners, at);
                positions.push(onto_level(&field, 0.0, low + cell * start));
            }
        }
    }
    for k in 1..size[2] - 1 {
        for j in 1..size[1] - 1 {
            for i in 1..size[0] - 1 {
                for axis in 0..3 {
                    let here = [i, j, k];
                    let mut next = here;
                    next[axis] += 1;
                    let [a, b] = [here, next].map(|corner| values[index(corner)] < 0.0);
                    if a == b {
                        continue;
                    }
                    let mut around = cells_around(here, axis).map(|c| vertex_of_cell[index(c)]);
                    if b {
                        around.reverse();
                    }
                    faces.extend(split(around, &positions));
                }
            }
        }
    }
    TriMesh::new(positions, faces).expect("the level runs through the box")
}

fn cell_corners([i, j, k]: [usize; 3]) -> [[usize; 3]; 8] {
    std::array::from_fn(|n| [i + (n & 1), j + (n >> 1 & 1), k + (n >> 2)])
}

/// The mean of the points where the sides of a cell cross the level, in cells.
fn middle_of_crossings(corners: &[[usize; 3]; 8], at: impl Fn([usize; 3]) -> f32) -> Vector3 {
    let mut sum = Vector3::zeros();
    let mut count = 0.0;
    for first in 0..8_usize {
        for axis in 0..3 {
            let second = first | 1 << axis;
            let (a, b) = (at(corners[first]), at(corners[second]));
            if second == first || (a < 0.0) == (b < 0.0) {
                continue;
            }
            let point = |n: usize| Vector3::from(corners[n].map(|value| value as f32));
            sum += point(first) + a / (a - b) * (point(second) - point(first));
            count += 1.0;
        }
    }
    sum / count
}

/// The four cells around the edge from a corner along an axis, counter-clockwise seen against it.
fn cells_around(corner: [usize; 3], axis: usize) -> [[usize; 3]; 4] {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    [[1, 1], [0, 1], [0, 0], [1, 0]].map(|[du, dv]| {
        let mut cell = corner;
        cell[u] -= du;
        cell[v] -= dv;
        cell
    })
}

/// Two triangles of a square, along its shorter diagonal.
fn split([a, b, c, d]: [u32; 4], positions: &[Point3]) -> [[u32; 3]; 2] {
    let length = |a: u32, b: u32| (positions[a as usize] - positions[b as usize]).norm_squared();
    if length(a, c) <= length(b, d) {
        [[a, b, c], [a, c, d]]
    } else {
        [[a, b, d], [b, c, d]]
    }
}
