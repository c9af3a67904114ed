//! What the terms write their derivatives into.

/// A place or a derivative by one, in units, in double precision.
pub(crate) type Place = nalgebra::Vector3<f64>;

/// The derivative of the weighted sum of terms by each predicted place.
#[derive(Debug)]
pub(crate) struct Gradient<'a> {
    /// Sums `[vertex]`.
    pub(crate) sums: &'a mut [Place],
    /// The weight of the term at hand.
    pub(crate) weight: f64,
}

impl Gradient<'_> {
    /// Adds the derivative of the term by the place of a vertex.
    pub(crate) fn add(&mut self, vertex: u32, derivative: Place) {
        self.sums[vertex as usize] += self.weight * derivative;
    }
}

/// The unit normal of a triangle and twice its area; `None` where it has none to speak of.
pub(crate) fn unit_normal(places: &[Place], [a, b, c]: [u32; 3]) -> Option<(Place, f64)> {
    let [a, b, c] = [a, b, c].map(|vertex| places[vertex as usize]);
    let normal = (b - a).cross(&(c - a));
    let double_area = normal.norm();
    (double_area > MIN_DOUBLE_AREA).then(|| (normal / double_area, double_area))
}

/// Below this, in squared units, a triangle has no normal: (0.1 µm)².
const MIN_DOUBLE_AREA: f64 = 1e-12;

/// Derivatives by the corners of a triangle, of a value with the derivative `by_normal` by its
/// unit normal.
///
/// ```text
/// n = w / |w|,  w = (b − a) × (c − a),  ∂/∂w = (I − n nᵀ) ∂/∂n / |w|
/// ```
pub(crate) fn by_corners(
    places: &[Place],
    [a, b, c]: [u32; 3],
    (normal, double_area): (Place, f64),
    by_normal: Place,
) -> [Place; 3] {
    let [a, b, c] = [a, b, c].map(|vertex| places[vertex as usize]);
    let by_vector = (by_normal - normal * normal.dot(&by_normal)) / double_area;
    let by_b = (c - a).cross(&by_vector);
    let by_c = by_vector.cross(&(b - a));
    [-(by_b + by_c), by_b, by_c]
}
