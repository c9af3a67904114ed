//! Triangles that an outline squeezed get room again.

use crate::curve::{Point2, distance};
use crate::triangulate::doubled_area;

/// Rounds over all such vertices.
const ROUNDS: usize = 12;

/// Moves interior points so that the smallest angle around each becomes as large as it can.
///
/// Only points at triangles with an angle below `squeezed` degrees move, by a search in eight
/// directions with shrinking steps: a pattern without squeezed triangles stays as it is.
pub(crate) fn mend(points: &mut [Point2], outline: usize, faces: &[[u32; 3]], squeezed: f64) {
    let squeezed = squeezed.to_radians().sin();
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); points.len()];
    for (number, face) in faces.iter().enumerate() {
        for vertex in face {
            around[*vertex as usize].push(number);
        }
    }
    let worst = |points: &[Point2], vertex: usize| -> f64 {
        let sines = around[vertex]
            .iter()
            .map(|&face| least_sine(faces[face].map(|corner| points[corner as usize])));
        sines.fold(1.0, f64::min)
    };
    for _ in 0..ROUNDS {
        let mut is_moved = false;
        for vertex in outline..points.len() {
            let mut best = worst(points, vertex);
            if best >= squeezed {
                continue;
            }
            let corners = around[vertex].iter().flat_map(|&face| faces[face]);
            let others = corners.filter(|&corner| corner as usize != vertex);
            let ring: Vec<Point2> = others.map(|corner| points[corner as usize]).collect();
            let reach = ring.iter().map(|&other| distance(other, points[vertex]));
            let mut step = 0.25 * reach.fold(0.0, f64::max);
            for _ in 0..6 {
                let from = points[vertex];
                let mut better = None;
                for direction in 0..8 {
                    let angle = f64::from(direction) * std::f64::consts::FRAC_PI_4;
                    points[vertex] = [from[0] + step * angle.cos(), from[1] + step * angle.sin()];
                    let found = worst(points, vertex);
                    // Far away the angles of a ring that is folded over are the smaller the
                    // farther.
                    if found > best + 1e-9 && is_among(points[vertex], &ring) {
                        (best, better) = (found, Some(points[vertex]));
                    }
                }
                points[vertex] = better.unwrap_or(from);
                if better.is_none() {
                    step *= 0.5;
                } else {
                    is_moved = true;
                }
            }
        }
        if !is_moved {
            return;
        }
    }
}

/// Whether a point is in the box of others.
fn is_among(point: Point2, others: &[Point2]) -> bool {
    (0..2).all(|axis| {
        let along = others.iter().map(|other| other[axis]);
        let [low, high] = [
            along.clone().fold(f64::INFINITY, f64::min),
            along.fold(f64::NEG_INFINITY, f64::max),
        ];
        (low..=high).contains(&point[axis])
    })
}

/// The sine of the smallest angle of a triangle, negative if it is folded over.
pub(crate) fn least_sine([a, b, c]: [Point2; 3]) -> f64 {
    let mut sides = [distance(a, b), distance(b, c), distance(c, a)];
    sides.sort_by(f64::total_cmp);
    doubled_area(a, b, c) / (sides[1] * sides[2]).max(1e-18)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_ring_that_is_folded_over_stay_in_it() {
        let mut points = vec![[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.4, 0.5]];
        let faces = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        mend(&mut points, 4, &faces, 4.0);
        assert!(points[4].iter().all(|place| (0.0..=1.0).contains(place)));
    }

    #[test]
    fn a_squeezed_point_gets_room() {
        let mut points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.01]];
        let faces = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        mend(&mut points, 4, &faces, 22.0);
        assert!(points[4][1] > 0.2);
    }
}
