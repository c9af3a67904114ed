//! Triangles that an outline squeezed get room again.

use crate::curve::{Point2, distance};
use crate::triangulate::doubled_area;

/// Rounds over all such vertices.
const ROUNDS: usize = 12;

/// Moves interior points so that the smallest angle around each becomes as large as it can.
///
/// Only points at triangles with an angle below `squeezed` degrees move, by a search in eight directions with shrinking steps:
/// a pattern without squeezed triangles stays as it is.
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
            let faces_here = around[vertex].iter().map(|&face| faces[face]);
            let reach = faces_here
                .flat_map(|face| face.map(|corner| points[corner as usize]))
                .map(|corner| distance(corner, points[vertex]))
                .fold(0.0, f64::max);
            let mut step = 0.25 * reach;
            for _ in 0..6 {
                let from = points[vertex];
                let mut better = None;
                for direction in 0..8 {
                    let angle = f64::from(direction) * std::f64::consts::FRAC_PI_4;
                    points[vertex] = [from[0] + step * angle.cos(), from[1] + step * angle.sin()];
                    let found = worst(points, vertex);
                    if found > best + 1e-9 {
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

/// The sine of the smallest angle of a triangle, negative if it is folded over.
pub(crate) fn least_sine([a, b, c]: [Point2; 3]) -> f64 {
    let mut sides = [distance(a, b), distance(b, c), distance(c, a)];
    sides.sort_by(f64::total_cmp);
    doubled_area(a, b, c) / (sides[1] * sides[2]).max(1e-18)
}
