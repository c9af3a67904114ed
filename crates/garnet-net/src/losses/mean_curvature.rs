//! `L_MC`: mean-curvature normals.
#![allow(
    clippy::needless_range_loop,
    reason = "corners and vertices index several arrays"
)]

use garnet_mesh::Topology;

use super::gradient::{Gradient, Place};

/// A vertex with less than this share of the target's mean mixed area is left out.
const MIN_AREA_SHARE: f64 = 1e-3;

/// Sums of a mesh that make its curvatures.
pub(crate) struct Curved {
    /// Σ_j (cot α + cot β)(G_j − G_i) `[vertex]`.
    sums: Vec<Place>,
    /// Mixed areas `[vertex]`, squared units.
    areas: Vec<f64>,
}

/// Curvature normals of a target, and which vertices have one.
#[derive(Debug, Clone, Default)]
pub(crate) struct TargetCurvature {
    normals: Vec<Place>,
    is_usable: Vec<bool>,
    min_area: f64,
}

impl TargetCurvature {
    /// Those of a mesh; boundary vertices and slivers have none.
    pub(crate) fn new(places: &[Place], topology: &Topology, max_cotangent: f64) -> Self {
        let curved = Curved::new(places, topology.faces(), max_cotangent);
        let total: f64 = curved.areas.iter().sum();
        let num_used = curved.areas.iter().filter(|&&area| area > 0.0).count();
        let min_area = MIN_AREA_SHARE * total / num_used.max(1) as f64;
        let is_usable: Vec<bool> = (curved.areas.iter().enumerate())
            .map(|(vertex, &area)| area > min_area && !topology.is_boundary(vertex))
            .collect();
        let normals = (0..places.len()).map(|vertex| {
            if is_usable[vertex] {
                curved.sums[vertex] / curved.areas[vertex]
            } else {
                Place::zeros()
            }
        });
        Self {
            normals: normals.collect(),
            is_usable,
            min_area,
        }
    }

    /// The normals `[vertex]`, in 1/unit; zero where there is none.
    #[cfg(test)]
    pub(crate) fn normals(&self) -> &[Place] {
        &self.normals
    }
}

/// The mean squared difference of mean-curvature normals.
///
/// ```text
/// κ_MC^i = 1/A_mixed Σ_j (cot α_ij + cot β_ij)(G_j − G_i)
/// L_MC   = 1/N Σ_i ‖κ_MC^P − κ_MC^G‖²
/// ```
///
/// Cotangents are clamped, with no derivative where they are: they have no bound on slivers, where
/// the paper's own training diverged. Boundary vertices count as equal.
///
/// Source: *Gundogdu et al. 2020, Eq. 9 and 14; Meyer et al. 2003, section 3.3*.
pub(crate) fn mean_curvature_loss(
    predicted: &[Place],
    faces: &[[u32; 3]],
    target: &TargetCurvature,
    max_cotangent: f64,
    gradient: &mut Gradient<'_>,
) -> f64 {
    let share = 1.0 / predicted.len() as f64;
    let curved = Curved::new(predicted, faces, max_cotangent);
    let mut value = 0.0;
    let mut by_sums = vec![Place::zeros(); predicted.len()];
    let mut by_areas = vec![0.0; predicted.len()];
    for vertex in 0..predicted.len() {
        if !target.is_usable[vertex] {
            continue;
        }
        // A collapsed vertex is measured by the least area, so that the value stays bounded.
        let area = curved.areas[vertex].max(target.min_area);
        let normal = curved.sums[vertex] / area;
        let difference = normal - target.normals[vertex];
        value += difference.norm_squared();
        let by_normal = 2.0 * share * difference;
        by_sums[vertex] = by_normal / area;
        if curved.areas[vertex] > target.min_area {
            by_areas[vertex] = -by_normal.dot(&normal) / area;
        }
    }
    for &face in faces {
        let sums = face.map(|vertex| by_sums[vertex as usize]);
        let areas = face.map(|vertex| by_areas[vertex as usize]);
        let corners = face.map(|vertex| predicted[vertex as usize]);
        let by_corners = Triangle::new(corners, max_cotangent).differentiate(sums, areas);
        for (vertex, derivative) in face.into_iter().zip(by_corners) {
            gradient.add(vertex, derivative);
        }
    }
    share * value
}

impl Curved {
    fn new(places: &[Place], faces: &[[u32; 3]], max_cotangent: f64) -> Self {
        let mut curved = Self {
            sums: vec![Place::zeros(); places.len()],
            areas: vec![0.0; places.len()],
        };
        for &face in faces {
            let corners = face.map(|vertex| places[vertex as usize]);
            let triangle = Triangle::new(corners, max_cotangent);
            let shares = triangle.area_shares();
            for corner in 0..3 {
                let [next, last] = others(corner).map(|other| face[other] as usize);
                let part = triangle.cotangents[corner] * triangle.side(corner);
                curved.sums[next] += part;
                curved.sums[last] -= part;
                curved.areas[face[corner] as usize] += shares[corner];
            }
        }
        curved
    }
}

/// The two corners after one.
fn others(corner: usize) -> [usize; 2] {
    [(corner + 1) % 3, (corner + 2) % 3]
}

/// How the area of a triangle is shared by its corners.
enum Sharing {
    /// By the Voronoi cells.
    Voronoi,
    /// Half for the obtuse corner.
    Obtuse(usize),
    /// Evenly, where cotangents are clamped.
    Even,
}

struct Triangle {
    corners: [Place; 3],
    cotangents: [f64; 3],
    is_clamped: [bool; 3],
    normal: Place,
    double_area: f64,
    sharing: Sharing,
}

impl Triangle {
    fn new(corners: [Place; 3], max_cotangent: f64) -> Self {
        let [a, b, c] = corners;
        let normal = (b - a).cross(&(c - a));
        let double_area = normal.norm();
        let mut cotangents = [0.0; 3];
        let mut is_clamped = [false; 3];
        let mut sharing = Sharing::Voronoi;
        for corner in 0..3 {
            let [u, v] = others(corner).map(|other| corners[other] - corners[corner]);
            let exact = match u.dot(&v) {
                0.0 => 0.0,
                cosine => cosine / double_area,
            };
            cotangents[corner] = exact.clamp(-max_cotangent, max_cotangent);
            is_clamped[corner] = exact.abs() >= max_cotangent || double_area == 0.0;
            if u.dot(&v) < 0.0 {
                sharing = Sharing::Obtuse(corner);
            }
        }
        if is_clamped.contains(&true) && !matches!(sharing, Sharing::Obtuse(_)) {
            sharing = Sharing::Even;
        }
        Self {
            corners,
            cotangents,
            is_clamped,
            normal,
            double_area,
            sharing,
        }
    }

    /// The side that faces a corner, from the next corner to the last.
    fn side(&self, corner: usize) -> Place {
        let [next, last] = others(corner);
        self.corners[last] - self.corners[next]
    }

    fn area_shares(&self) -> [f64; 3] {
        let area = self.double_area / 2.0;
        match self.sharing {
            Sharing::Even => [area / 3.0; 3],
            Sharing::Obtuse(obtuse) => {
                let mut shares = [area / 4.0; 3];
                shares[obtuse] = area / 2.0;
                shares
            }
            Sharing::Voronoi => std::array::from_fn(|corner| {
                let cells = others(corner)
                    .map(|other| self.cotangents[other] * self.side(other).norm_squared());
                (cells[0] + cells[1]) / 8.0
            }),
        }
    }

    /// Derivatives by the corners, given those by the sums and the areas of the corners.
    fn differentiate(&self, by_sums: [Place; 3], by_areas: [f64; 3]) -> [Place; 3] {
        let mut by_corners = [Place::zeros(); 3];
        let mut by_cotangents = [0.0; 3];
        for corner in 0..3 {
            let [next, last] = others(corner);
            let by_part = by_sums[next] - by_sums[last];
            by_cotangents[corner] = by_part.dot(&self.side(corner));
            by_corners[last] += self.cotangents[corner] * by_part;
            by_corners[next] -= self.cotangents[corner] * by_part;
        }
        let by_double_area = match self.sharing {
            Sharing::Even => by_areas.iter().sum::<f64>() / 6.0,
            Sharing::Obtuse(obtuse) => (by_areas.iter().sum::<f64>() + by_areas[obtuse]) / 8.0,
            Sharing::Voronoi => {
                for corner in 0..3 {
                    let [next, last] = others(corner);
                    let by_cell = (by_areas[next] + by_areas[last]) / 8.0;
                    let side = self.side(corner);
                    by_cotangents[corner] += by_cell * side.norm_squared();
                    let by_side = 2.0 * by_cell * self.cotangents[corner] * side;
                    by_corners[last] += by_side;
                    by_corners[next] -= by_side;
                }
                0.0
            }
        };
        if self.double_area == 0.0 {
            return by_corners;
        }
        let unit = self.normal / self.double_area;
        let mut by_doubled = by_double_area;
        for corner in 0..3 {
            if self.is_clamped[corner] {
                continue;
            }
            let [next, last] = others(corner);
            let [u, v] = [next, last].map(|other| self.corners[other] - self.corners[corner]);
            let by_cosine = by_cotangents[corner] / self.double_area;
            by_doubled -= by_cosine * self.cotangents[corner];
            by_corners[next] += by_cosine * v;
            by_corners[last] += by_cosine * u;
            by_corners[corner] -= by_cosine * (u + v);
        }
        for corner in 0..3 {
            // Moving a corner away from the side that faces it widens the triangle.
            by_corners[corner] += by_doubled * unit.cross(&self.side(corner));
        }
        by_corners
    }
}
