//! Resistance to bending of faces: the hinges of the cloth, coupled so that each face resists its
//! curvature as an isotropic plate does, whatever the mesh.

use nalgebra::{DMatrix, Matrix3, Vector2, Vector3};

use super::blocks::Blocks;
use crate::rest_shape::RestFace;
use crate::{BendingHinge, Cloth};

/// Hinges and their couplings: in each face energy ½ Σᵢⱼ gᵢⱼ bᵢ · bⱼ with the bends b = Σₘ wₘ xₘ of
/// the hinges at the sides of a face.
///
/// A surface of curvature S bends the hinges of a face by b = Q S. The energy of the face is the
/// least that a plate with these bends has: g = A (Q D⁻¹ Qᵀ)⁻¹ with the plate's D and the area A.
/// Sides at a boundary have no hinge, and no moment.
#[derive(Debug, Clone)]
pub(super) struct FaceBending {
    hinges: Vec<HingeShape>,
    couplings: Vec<Coupling>,
}

#[derive(Debug, Clone, Copy)]
struct HingeShape {
    vertices: [u32; 4],
    weights: [f64; 4],
}

/// g of two hinges, summed over the faces that have both, N/m.
#[derive(Debug, Clone, Copy)]
struct Coupling {
    hinges: [usize; 2],
    stiffness: f64,
}

impl FaceBending {
    /// Plates of bending rigidity `bending` (N m, of a strip with free sides) and Poisson's ratio
    /// `poisson`.
    pub(super) fn new(cloth: &Cloth, rest: &[RestFace], bending: f64, poisson: f64) -> Self {
        let topology = cloth.topology();
        let mut hinges_of_face: Vec<Vec<usize>> = vec![Vec::new(); cloth.faces().len()];
        let mut next = 0;
        for edge in 0..topology.edges().len() {
            if let &[first, second] = topology.edge_faces(edge) {
                hinges_of_face[first as usize].push(next);
                hinges_of_face[second as usize].push(next);
                next += 1;
            }
        }
        let mut couplings = Vec::new();
        for (face, numbers) in hinges_of_face.iter().enumerate() {
            let at = Placed::new(cloth, rest, face);
            let rows: Vec<Vector3<f64>> = numbers
                .iter()
                .map(|&hinge| at.bends(&cloth.hinges()[hinge]))
                .collect();
            let size = rows.len();
            let compliance = compliance(bending, poisson);
            let matrix = DMatrix::from_fn(size, size, |i, j| rows[i].dot(&(compliance * rows[j])));
            let Some(inverse) = matrix.try_inverse() else {
                continue;
            };
            for i in 0..size {
                for j in 0..size {
                    couplings.push(Coupling {
                        hinges: [numbers[i], numbers[j]],
                        stiffness: inverse[(i, j)] * f64::from(rest[face].area),
                    });
                }
            }
        }
        let shape = |hinge: &BendingHinge| {
            let [_, b, c, d] = hinge.weights.map(f64::from);
            HingeShape {
                vertices: hinge.vertices,
                weights: [-(b + c + d), b, c, d],
            }
        };
        Self {
            hinges: cloth.hinges().iter().map(shape).collect(),
            couplings,
        }
    }

    fn bends(&self, x: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let bend = |hinge: &HingeShape| {
            let origin = x[hinge.vertices[0] as usize];
            let offset = |m: usize| (x[hinge.vertices[m] as usize] - origin) * hinge.weights[m];
            offset(1) + offset(2) + offset(3)
        };
        self.hinges.iter().map(bend).collect()
    }

    /// Pairs of vertices that are coupled.
    pub(super) fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.couplings.iter().flat_map(|coupling| {
            let [a, b] = coupling.hinges.map(|hinge| self.hinges[hinge].vertices);
            a.into_iter().flat_map(move |a| b.map(|b| [a, b]))
        })
    }

    /// Energy, J.
    pub(super) fn energy(&self, x: &[Vector3<f64>]) -> f64 {
        let bends = self.bends(x);
        let energy = |coupling: &Coupling| {
            let [a, b] = coupling.hinges.map(|hinge| bends[hinge]);
            0.5 * coupling.stiffness * a.dot(&b)
        };
        self.couplings.iter().map(energy).sum()
    }

    /// Adds the gradient of the energy, N.
    pub(super) fn add_gradient(&self, x: &[Vector3<f64>], gradient: &mut [Vector3<f64>]) {
        let bends = self.bends(x);
        let mut moments = vec![Vector3::zeros(); bends.len()];
        for coupling in &self.couplings {
            let [a, b] = coupling.hinges;
            moments[a] += bends[b] * coupling.stiffness;
        }
        for (hinge, moment) in self.hinges.iter().zip(moments) {
            for (&vertex, &weight) in hinge.vertices.iter().zip(&hinge.weights) {
                gradient[vertex as usize] += moment * weight;
            }
        }
    }

    /// Adds the second derivatives, which are the same at all positions.
    pub(super) fn add_hessian(&self, blocks: &mut Blocks) {
        for coupling in &self.couplings {
            let [a, b] = coupling.hinges.map(|hinge| self.hinges[hinge]);
            for (&row, &row_weight) in a.vertices.iter().zip(&a.weights) {
                for (&column, &column_weight) in b.vertices.iter().zip(&b.weights) {
                    // The sum has both orders of every pair of vertices: one is enough.
                    if row >= column {
                        let entry = coupling.stiffness * row_weight * column_weight;
                        blocks.add(row, column, &(Matrix3::identity() * entry));
                    }
                }
            }
        }
    }
}

/// D⁻¹ on curvatures along x, along y and of twist, 1/(N m).
fn compliance(bending: f64, poisson: f64) -> Matrix3<f64> {
    let twist = 0.5 * (1.0 + poisson);
    Matrix3::new(1.0, -poisson, 0.0, -poisson, 1.0, 0.0, 0.0, 0.0, twist) / bending
}

/// A face and its neighbors, laid flat.
struct Placed {
    places: Vec<(u32, Vector2<f64>)>,
}

impl Placed {
    fn new(cloth: &Cloth, rest: &[RestFace], face: usize) -> Self {
        let topology = cloth.topology();
        let corners = cloth.faces()[face];
        let [ab, bc, ca] = rest[face].sides.map(f64::from);
        let x = (ab * ab + ca * ca - bc * bc) / (2.0 * ab);
        let y = (ca * ca - x * x).max(0.0).sqrt();
        let own = [Vector2::zeros(), Vector2::new(ab, 0.0), Vector2::new(x, y)];
        let mut places: Vec<(u32, Vector2<f64>)> = corners.into_iter().zip(own).collect();
        for side in 0..3 {
            let ends = [corners[side], corners[(side + 1) % 3]];
            let edge = [ends[0].min(ends[1]), ends[0].max(ends[1])];
            let Ok(edge) = topology.edges().binary_search(&edge) else {
                continue;
            };
            let neighbors = topology.edge_faces(edge).iter();
            for &other in neighbors.filter(|&&other| other as usize != face) {
                let other_corners = cloth.faces()[other as usize];
                let cotangents = rest[other as usize].cotangents();
                let cotangent = |vertex: u32| {
                    let slot = other_corners.iter().position(|&corner| corner == vertex);
                    slot.map_or(0.0, |slot| f64::from(cotangents[slot]))
                };
                let along = own[(side + 1) % 3] - own[side];
                let outward = Vector2::new(along.y, -along.x);
                let height = 1.0 / (cotangent(ends[0]) + cotangent(ends[1]));
                let place = own[side] + along * (height * cotangent(ends[0])) + outward * height;
                let third = other_corners.iter().find(|corner| !ends.contains(corner));
                places.extend(third.map(|&third| (third, place)));
            }
        }
        Self { places }
    }

    /// How much unit curvatures bend a hinge of the face, in metres.
    fn bends(&self, hinge: &BendingHinge) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for (&vertex, &weight) in hinge.vertices.iter().zip(&hinge.weights) {
            let place = self.places.iter().find(|(placed, _)| *placed == vertex);
            let p = place.map_or_else(Vector2::zeros, |&(_, place)| place);
            sum += Vector3::new(0.5 * p.x * p.x, 0.5 * p.y * p.y, p.x * p.y) * f64::from(weight);
        }
        sum
    }
}
