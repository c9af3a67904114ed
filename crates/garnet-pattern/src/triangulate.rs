//! A panel's outline to well-shaped triangles.

use std::collections::VecDeque;

use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2 as SpadePoint, Triangulation as _};

use crate::curve::{Point2, distance, lerp};

/// Rounds of smoothing, each followed by a new triangulation.
const ROUNDS: usize = 12;

/// Interior points keep this distance from the outline, in edge lengths.
const MARGIN: f64 = 0.55;

/// Points of a panel, those of the outline first, and counter-clockwise triangles.
#[derive(Debug, Clone)]
pub(crate) struct Triangles {
    pub(crate) points: Vec<Point2>,
    pub(crate) faces: Vec<[u32; 3]>,
}

/// Triangulates the inside of a counter-clockwise outline with edges of about `edge` metres.
///
/// Interior points start as a hexagonal lattice and move to the area-weighted mean of the
/// circumcenters of their triangles, with a new Delaunay triangulation in every round: optimal
/// Delaunay triangulations (Chen 2004).
pub(crate) fn triangulated(
    outline: &[Point2],
    edge: f64,
    smooth: bool,
) -> Result<Triangles, String> {
    let mut points = outline.to_vec();
    points.extend(lattice(outline, edge));
    let mut faces = delaunay(&points, outline.len())?;
    for _ in 0..if smooth { ROUNDS } else { 0 } {
        relax(&mut points, outline.len(), &faces);
        faces = delaunay(&points, outline.len())?;
    }
    Ok(Triangles { points, faces })
}

pub(crate) fn lattice(outline: &[Point2], edge: f64) -> Vec<Point2> {
    let low = |axis: usize| outline.iter().map(|p| p[axis]).fold(f64::MAX, f64::min);
    let high = |axis: usize| outline.iter().map(|p| p[axis]).fold(f64::MIN, f64::max);
    let row_height = edge * 0.75_f64.sqrt();
    let mut points = Vec::new();
    let mut row = 0_usize;
    loop {
        let y = low(1) + (row as f64 + 0.9) * row_height;
        if y > high(1) {
            return points;
        }
        let mut x = low(0) + edge * if row.is_multiple_of(2) { 0.5 } else { 1.0 };
        while x < high(0) {
            if is_inside(outline, [x, y]) && to_outline(outline, [x, y]) > MARGIN * edge {
                points.push([x, y]);
            }
            x += edge;
        }
        row += 1;
    }
}

pub(crate) fn is_inside(outline: &[Point2], point: Point2) -> bool {
    let mut inside = false;
    let mut a = outline[outline.len() - 1];
    for &b in outline {
        if (a[1] > point[1]) != (b[1] > point[1]) {
            let crossing = a[0] + (b[0] - a[0]) * (point[1] - a[1]) / (b[1] - a[1]);
            inside ^= point[0] < crossing;
        }
        a = b;
    }
    inside
}

fn to_outline(outline: &[Point2], point: Point2) -> f64 {
    let mut least = f64::MAX;
    let mut a = outline[outline.len() - 1];
    for &b in outline {
        let along = [b[0] - a[0], b[1] - a[1]];
        let size = along[0] * along[0] + along[1] * along[1];
        let dot = (point[0] - a[0]) * along[0] + (point[1] - a[1]) * along[1];
        let share = (dot / size.max(1e-18)).clamp(0.0, 1.0);
        least = least.min(distance(
            point,
            [a[0] + share * along[0], a[1] + share * along[1]],
        ));
        a = b;
    }
    least
}

/// The constrained Delaunay triangles inside the outline, which is the first points in order.
fn delaunay(points: &[Point2], outline: usize) -> Result<Vec<[u32; 3]>, String> {
    let mut mesh = ConstrainedDelaunayTriangulation::<SpadePoint<f64>>::new();
    let mut handles: Vec<FixedVertexHandle> = Vec::with_capacity(points.len());
    for (number, &[x, y]) in points.iter().enumerate() {
        let handle = mesh
            .insert(SpadePoint::new(x, y))
            .map_err(|error| error.to_string())?;
        if handle.index() != number {
            return Err(format!("point {number} lies on another"));
        }
        handles.push(handle);
    }
    for number in 0..outline {
        let (a, b) = (handles[number], handles[(number + 1) % outline]);
        if !mesh.can_add_constraint(a, b) {
            return Err(format!("the outline crosses itself at point {number}"));
        }
        mesh.add_constraint(a, b);
    }
    // Flood from the triangles on the left of the outline.
    let mut is_inside = vec![false; mesh.num_all_faces()];
    let mut queue = VecDeque::new();
    for number in 0..outline {
        let (a, b) = (handles[number], handles[(number + 1) % outline]);
        let Some(side) = mesh.get_edge_from_neighbors(a, b) else {
            return Err(format!("the outline runs through a point at {number}"));
        };
        queue.extend(side.face().as_inner().map(|face| face.fix()));
    }
    while let Some(face) = queue.pop_front() {
        if std::mem::replace(&mut is_inside[face.index()], true) {
            continue;
        }
        for side in mesh.face(face).adjacent_edges() {
            if !side.is_constraint_edge() {
                queue.extend(side.rev().face().as_inner().map(|face| face.fix()));
            }
        }
    }
    let inside = mesh.inner_faces().filter(|face| is_inside[face.index()]);
    let mut faces: Vec<[u32; 3]> = inside
        .map(|face| face.vertices().map(|vertex| vertex.index() as u32))
        .map(|[a, b, c]| match a.min(b).min(c) {
            least if least == a => [a, b, c],
            least if least == b => [b, c, a],
            _ => [c, a, b],
        })
        .collect();
    faces.sort_unstable();
    Ok(faces)
}

fn relax(points: &mut [Point2], outline: usize, faces: &[[u32; 3]]) {
    moved_to_means(points, outline, faces, circumcenter);
}

/// Moves interior points to the area-weighted mean of the centroids of their triangles: large
/// triangles give to small ones.
pub(crate) fn settle(points: &mut [Point2], outline: usize, faces: &[[u32; 3]]) {
    moved_to_means(points, outline, faces, centroid);
}

fn moved_to_means(
    points: &mut [Point2],
    outline: usize,
    faces: &[[u32; 3]],
    center: impl Fn(Point2, Point2, Point2) -> Point2,
) {
    let mut sums = vec![[0.0; 3]; points.len()];
    for face in faces {
        let [a, b, c] = face.map(|vertex| points[vertex as usize]);
        let area = doubled_area(a, b, c).max(0.0);
        let center = center(a, b, c);
        for vertex in face {
            let sum = &mut sums[*vertex as usize];
            sum[0] += area * center[0];
            sum[1] += area * center[1];
            sum[2] += area;
        }
    }
    for (point, [x, y, area]) in points.iter_mut().zip(sums).skip(outline) {
        if area > 0.0 {
            *point = [x / area, y / area];
        }
    }
}

fn centroid(a: Point2, b: Point2, c: Point2) -> Point2 {
    [(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0]
}

/// The circumcenter of a triangle, drawn back to its centroid where that lies far off.
fn circumcenter(a: Point2, b: Point2, c: Point2) -> Point2 {
    let centroid = centroid(a, b, c);
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    let cross = 2.0 * (u[0] * v[1] - u[1] * v[0]);
    let (uu, vv) = (u[0] * u[0] + u[1] * u[1], v[0] * v[0] + v[1] * v[1]);
    if cross <= 1e-15 {
        return centroid;
    }
    let found = [
        a[0] + (v[1] * uu - u[1] * vv) / cross,
        a[1] + (u[0] * vv - v[0] * uu) / cross,
    ];
    let away = distance(found, centroid);
    let most = 0.25 * uu.max(vv).sqrt();
    lerp(centroid, found, (most / away.max(1e-15)).min(1.0))
}

/// Twice the area of a triangle, positive if it is counter-clockwise.
pub(crate) fn doubled_area(a: Point2, b: Point2, c: Point2) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_is_filled_with_good_triangles() {
        let side = |a: Point2, b: Point2| (0..10).map(move |i| lerp(a, b, f64::from(i) / 10.0));
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let outline: Vec<Point2> = (0..4)
            .flat_map(|i| side(corners[i], corners[(i + 1) % 4]))
            .collect();
        let mesh = triangulated(&outline, 0.1, true).unwrap();
        let areas = mesh.faces.iter().map(|face| {
            let [a, b, c] = face.map(|vertex| mesh.points[vertex as usize]);
            doubled_area(a, b, c) / 2.0
        });
        let total: f64 = areas.clone().sum();
        assert!((total - 1.0).abs() < 1e-9, "{total}");
        assert!(areas.fold(1.0, f64::min) > 0.002);
    }

    #[test]
    fn an_outline_that_crosses_itself_is_refused() {
        let outline = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert!(triangulated(&outline, 0.3, false).is_err());
    }
}
