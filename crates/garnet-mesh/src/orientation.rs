//! Whether a mesh is inside out.

use crate::{Bounds, Point3};

/// A mesh whose faces enclose less than this share of its box, in size, has no side that is surely
/// the inner one.
const MIN_ENCLOSED: f64 = 1e-3;

/// Whether most of the faces of a mesh look inwards: the volume that they enclose is negative. An
/// open mesh is closed by cones from the middle of its box.
///
/// ```
/// use garnet_mesh::{is_inside_out, primitives::icosphere};
///
/// let ball = icosphere(2, 1.0);
/// let turned: Vec<[u32; 3]> = ball.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
/// assert!(!is_inside_out(ball.positions(), ball.faces()));
/// assert!(is_inside_out(ball.positions(), &turned));
/// ```
///
/// # Panics
///
/// If a face names a vertex that there is not.
pub fn is_inside_out(positions: &[Point3], faces: &[[u32; 3]]) -> bool {
    let Some(bounds) = Bounds::of_faces(positions, faces) else {
        return false;
    };
    let middle = nalgebra::center(&bounds.min, &bounds.max);
    let corner = |vertex: u32| (positions[vertex as usize] - middle).cast::<f64>();
    let cones = faces.iter().map(|face| face.map(corner));
    let enclosed: f64 = cones.map(|[a, b, c]| a.cross(&b).dot(&c) / 6.0).sum();
    let extent = bounds.extent().cast::<f64>();
    enclosed < -MIN_ENCLOSED * extent.x * extent.y * extent.z
}
