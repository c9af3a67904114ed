//! How much of a garment is inside a body.

use garnet_knn::Surface;
use garnet_mesh::Point3;

/// How much of a garment is inside a body, wherever the body runs through itself as well.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Penetration {
    /// Vertices whose winding number is above 0.5.
    pub inside: usize,
    /// The deepest of them, in metres below the nearest skin.
    pub deepest: f32,
}

/// Tests positions `[vertex]` of a garment, in metres, against a body's skin.
///
/// # Examples
///
/// ```
/// use garnet_drape::penetration;
/// use garnet_knn::Surface;
/// use garnet_mesh::primitives::{icosphere, tube};
///
/// let ball = Surface::new(&icosphere(3, 0.2));
/// let belt = tube(0.19, 0.02, 32, 2);
/// let found = penetration(belt.positions(), &ball);
/// assert_eq!(found.inside, belt.num_vertices());
/// assert!((found.deepest - 0.01).abs() < 1e-3);
/// ```
pub fn penetration(positions: &[Point3], skin: &Surface) -> Penetration {
    let is_inside = skin.contains_all(positions);
    let pairs = positions.iter().zip(is_inside);
    let inside: Vec<Point3> = pairs
        .filter(|(_, inside)| *inside)
        .map(|(p, _)| *p)
        .collect();
    let closest = skin.closest_all(&inside);
    let depths = closest
        .iter()
        .map(|closest| closest.distance_squared.sqrt());
    Penetration {
        inside: inside.len(),
        deepest: depths.fold(0.0, f32::max),
    }
}
