//! Resistance to stretching: the springs of the cloth, or triangles of an isotropic material.

use nalgebra::{Matrix3, Vector3};

use super::blocks::{Blocks, Curvature};
use crate::rest_shape::RestFace;
use crate::{Cloth, Spring};

/// Shorter edges, in metres, have no direction.
const MIN_LENGTH: f64 = 1e-12;

/// The springs of a [`Cloth`], in double precision.
#[derive(Debug, Clone)]
pub(super) struct Springs(Vec<Spring>);

impl Springs {
    pub(super) fn new(cloth: &Cloth) -> Self {
        Self(cloth.springs().to_vec())
    }

    /// Energy, J.
    pub(super) fn energy(&self, x: &[Vector3<f64>]) -> f64 {
        let energy = |spring: &Spring| {
            let [a, b] = spring.vertices.map(|vertex| x[vertex as usize]);
            let stretch = (b - a).norm() - f64::from(spring.rest_length);
            0.5 * spring.stiffness_at(stretch) * stretch * stretch
        };
        self.0.iter().map(energy).sum()
    }

    /// Adds the gradient of the energy, N.
    pub(super) fn add_gradient(&self, x: &[Vector3<f64>], gradient: &mut [Vector3<f64>]) {
        for spring in &self.0 {
            let [a, b] = spring.vertices.map(|vertex| vertex as usize);
            let along = x[b] - x[a];
            let length = along.norm().max(MIN_LENGTH);
            let stretch = length - f64::from(spring.rest_length);
            let pull = along * (spring.stiffness_at(stretch) * stretch / length);
            gradient[a] -= pull;
            gradient[b] += pull;
        }
    }

    /// Adds the second derivatives.
    pub(super) fn add_hessian(
        &self,
        x: &[Vector3<f64>],
        curvature: Curvature,
        blocks: &mut Blocks,
    ) {
        for spring in &self.0 {
            let [a, b] = spring.vertices;
            let along = x[b as usize] - x[a as usize];
            let length = along.norm().max(MIN_LENGTH);
            let direction = along / length;
            let stretch = length - f64::from(spring.rest_length);
            let stiffness = spring.stiffness_at(stretch);
            let across = curvature.of(stiffness * stretch / length);
            let axial = direction * direction.transpose();
            let block = axial * (stiffness - across) + Matrix3::identity() * across;
            blocks.add(a, a, &block);
            blocks.add(b, b, &block);
            blocks.add(a, b, &-block);
        }
    }
}

/// Triangles of an isotropic material: the same stretch of the same edges as the springs, with the
/// couplings between the three edges of a face that the springs leave out.
///
/// ```text
/// E = Σ_faces ½ A eᵀ M e,   eᵢ = lᵢ / Lᵢ − 1,   M = Q⁻ᵀ D Q⁻¹
/// ```
///
/// with D the matrix of plane stress and Q the stretches of the three edges under unit strains. For
/// an equilateral face and Poisson's ratio 1/3 M is diagonal, and this is the energy of the springs
/// of Van Gelder 1998; for all other faces it has the right moduli where the springs do not.
#[derive(Debug, Clone)]
pub(super) struct Triangles(Vec<TriangleTerm>);

#[derive(Debug, Clone, Copy)]
struct TriangleTerm {
    vertices: [u32; 3],
    rest_lengths: [f64; 3],
    /// A M, N m.
    moduli: Matrix3<f64>,
}

/// One side of a deformed face.
struct Side {
    length: f64,
    direction: Vector3<f64>,
    stretch: f64,
}

impl Triangles {
    /// Triangles with the shapes `rest`, Young's modulus times thickness `membrane` (N/m) and
    /// Poisson's ratio `poisson`.
    pub(super) fn new(faces: &[[u32; 3]], rest: &[RestFace], membrane: f64, poisson: f64) -> Self {
        let terms = faces.iter().zip(rest).map(|(&vertices, rest)| {
            let lengths = rest.sides.map(f64::from);
            TriangleTerm {
                vertices,
                rest_lengths: lengths,
                moduli: moduli(lengths, membrane, poisson),
            }
        });
        Self(terms.collect())
    }

    pub(super) fn energy(&self, x: &[Vector3<f64>]) -> f64 {
        let energy = |term: &TriangleTerm| {
            let stretches = Vector3::from(term.sides(x).map(|side| side.stretch));
            0.5 * stretches.dot(&(term.moduli * stretches))
        };
        self.0.iter().map(energy).sum()
    }

    pub(super) fn add_gradient(&self, x: &[Vector3<f64>], gradient: &mut [Vector3<f64>]) {
        for term in &self.0 {
            let sides = term.sides(x);
            let tensions = term.tensions(&sides);
            for (side, tension) in tensions.into_iter().enumerate() {
                let pull = sides[side].direction * tension;
                gradient[term.vertices[side] as usize] -= pull;
                gradient[term.vertices[(side + 1) % 3] as usize] += pull;
            }
        }
    }

    pub(super) fn add_hessian(
        &self,
        x: &[Vector3<f64>],
        curvature: Curvature,
        blocks: &mut Blocks,
    ) {
        for term in &self.0 {
            let sides = term.sides(x);
            let tensions = term.tensions(&sides);
            // Corner `side` starts a side and ends the one before it.
            let slope = |corner: usize, side: usize| match (corner + 3 - side) % 3 {
                0 => -sides[side].direction,
                1 => sides[side].direction,
                _ => Vector3::zeros(),
            };
            for (row, column) in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)] {
                let mut block = Matrix3::zeros();
                for i in 0..3 {
                    for j in 0..3 {
                        let modulus =
                            term.moduli[(i, j)] / (term.rest_lengths[i] * term.rest_lengths[j]);
                        block += slope(row, i) * slope(column, j).transpose() * modulus;
                    }
                }
                blocks.add(term.vertices[row], term.vertices[column], &block);
            }
            for (side, tension) in tensions.into_iter().enumerate() {
                let Side {
                    length, direction, ..
                } = sides[side];
                let across = Matrix3::identity() - direction * direction.transpose();
                let block = across * curvature.of(tension / length);
                let [a, b] = [term.vertices[side], term.vertices[(side + 1) % 3]];
                blocks.add(a, a, &block);
                blocks.add(b, b, &block);
                blocks.add(a, b, &-block);
            }
        }
    }
}

impl TriangleTerm {
    fn sides(&self, x: &[Vector3<f64>]) -> [Side; 3] {
        let corners = self.vertices.map(|vertex| x[vertex as usize]);
        [0, 1, 2].map(|side| {
            let along = corners[(side + 1) % 3] - corners[side];
            let length = along.norm().max(MIN_LENGTH);
            Side {
                length,
                direction: along / length,
                stretch: length / self.rest_lengths[side] - 1.0,
            }
        })
    }

    /// Forces along the sides, N.
    fn tensions(&self, sides: &[Side; 3]) -> [f64; 3] {
        let stretches = Vector3::from([0, 1, 2].map(|side: usize| sides[side].stretch));
        let work = self.moduli * stretches;
        [0, 1, 2].map(|side| work[side] / self.rest_lengths[side])
    }
}

/// A M of a triangle with the given sides.
fn moduli([ab, bc, ca]: [f64; 3], membrane: f64, poisson: f64) -> Matrix3<f64> {
    let x = (ab * ab + ca * ca - bc * bc) / (2.0 * ab);
    let y = (ca * ca - x * x).max(0.0).sqrt();
    let row = |along: [f64; 2], length: f64| {
        let [s, t] = along.map(|axis| axis / length);
        [s * s, t * t, s * t]
    };
    let stretches = [row([ab, 0.0], ab), row([x - ab, y], bc), row([-x, -y], ca)];
    let stretches = Matrix3::from_fn(|side, strain| stretches[side][strain]);
    let strains = stretches.try_inverse().unwrap_or_else(Matrix3::zeros);
    let scale = membrane / (1.0 - poisson * poisson);
    let shear = 0.5 * (1.0 - poisson);
    let plane_stress = Matrix3::new(1.0, poisson, 0.0, poisson, 1.0, 0.0, 0.0, 0.0, shear) * scale;
    strains.transpose() * plane_stress * strains * (0.5 * ab * y)
}
