//! New directions for the `vn` lines of faces that moved.

use super::file::ObjFile;
use super::scan::NO_NORMAL;
use super::words::Words;
use garnet_mesh::{Point3, Vector3};

type Vector = nalgebra::Vector3<f64>;

/// The `vn` lines that moved polygons name, with their new directions of length 1, sorted.
///
/// A direction is the mean of the normals of the polygons whose corners name the line, weighted
/// with the angles at those corners. A line on the inner side of its polygons stays there. Lines
/// without a new direction (all polygons without area) are left out.
pub(crate) fn moved_normals(file: &ObjFile, positions: &[Point3]) -> Vec<(u32, Vector3)> {
    let parsed = file.parsed();
    let mut is_moved = vec![false; parsed.normal_starts.len()];
    for polygon in 0..file.num_polygons() {
        let corners = parsed.corners(polygon);
        let moves = |&vertex: &u32| positions[vertex as usize] != parsed.positions[vertex as usize];
        if file.polygon(polygon).iter().any(moves) {
            for &normal in &parsed.corner_normals[corners] {
                // Names of normals that the file does not have are tolerated.
                if let Some(flag) = is_moved.get_mut(normal as usize) {
                    *flag = true;
                }
            }
        }
    }
    if !is_moved.contains(&true) {
        return Vec::new();
    }
    let new_sums = corner_normal_sums(file, positions, &is_moved);
    let old_sums = corner_normal_sums(file, &parsed.positions, &is_moved);
    let mut normals = Vec::new();
    for (normal, (new, old)) in new_sums.into_iter().zip(old_sums).enumerate() {
        let start = parsed.normal_starts[normal] as usize;
        let (Some(direction), Some(written)) = (
            new.try_normalize(f64::MIN_POSITIVE),
            written_vector(file.source(), start),
        ) else {
            continue;
        };
        let side = if written.dot(&old) < 0.0 { -1.0 } else { 1.0 };
        normals.push((normal as u32, (side * direction).cast::<f32>()));
    }
    normals
}

/// `[normal]` sum of the polygon normals over the corners that name it, times the corner angles.
fn corner_normal_sums(file: &ObjFile, positions: &[Point3], is_wanted: &[bool]) -> Vec<Vector> {
    let parsed = file.parsed();
    let at = |vertex: u32| positions[vertex as usize].coords.cast::<f64>();
    let mut sums = vec![Vector::zeros(); is_wanted.len()];
    for polygon in 0..file.num_polygons() {
        let vertices = file.polygon(polygon);
        let names = &parsed.corner_normals[parsed.corners(polygon)];
        let wants = |&normal: &u32| is_wanted.get(normal as usize) == Some(&true);
        if names[0] == NO_NORMAL && !names.iter().any(wants) {
            continue;
        }
        let Some(face_normal) = polygon_normal(vertices, at) else {
            continue;
        };
        let num_corners = vertices.len();
        for (corner, name) in names.iter().enumerate().filter(|(_, name)| wants(name)) {
            let here = at(vertices[corner]);
            let to_next = at(vertices[(corner + 1) % num_corners]) - here;
            let to_previous = at(vertices[(corner + num_corners - 1) % num_corners]) - here;
            sums[*name as usize] += to_next.angle(&to_previous) * face_normal;
        }
    }
    sums
}

/// The unit normal of a polygon that need not be flat (Newell's method).
fn polygon_normal(vertices: &[u32], at: impl Fn(u32) -> Vector) -> Option<Vector> {
    let origin = at(vertices[0]);
    let mut sum = Vector::zeros();
    for side in vertices[1..].windows(2) {
        sum += (at(side[0]) - origin).cross(&(at(side[1]) - origin));
    }
    sum.try_normalize(f64::MIN_POSITIVE)
}

fn written_vector(source: &[u8], start: usize) -> Option<Vector> {
    let mut words = Words::new(source, start);
    let mut component = || {
        let text = std::str::from_utf8(words.next_word()?).ok()?;
        text.parse::<f64>().ok()
    };
    Some(Vector::new(component()?, component()?, component()?))
}
