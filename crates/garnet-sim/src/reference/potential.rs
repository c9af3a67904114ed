//! The energy that a step minimizes, with its derivatives.

use nalgebra::{Matrix3, Vector3};

use super::bending::Hinges;
use super::blocks::{Blocks, Curvature};
use super::contact::Contact;
use super::face_bending::FaceBending;
use super::membrane::{Springs, Triangles};
use super::self_contact::SelfContact;
use super::system::Pattern;

/// What resists stretching.
#[derive(Debug, Clone)]
pub(super) enum Membrane {
    Springs(Springs),
    Triangles(Triangles),
}

/// What resists bending.
#[derive(Debug, Clone)]
pub(super) enum Bending {
    Hinges(Hinges),
    Faces(FaceBending),
}

/// The pull of inertia: energy ½ m |x − target|² / h² of each vertex.
#[derive(Debug, Clone)]
pub(super) struct Inertia {
    /// Where each vertex would go free of force, in metres.
    pub(super) targets: Vec<Vector3<f64>>,
    /// 1 / h², 1/s².
    pub(super) rate_squared: f64,
}

/// The energy of cloth in contact, J.
pub(super) struct Potential<'a> {
    pub(super) masses: Vec<f64>,
    pub(super) is_held: Vec<bool>,
    pub(super) membrane: Membrane,
    pub(super) bending: Bending,
    /// Weights and other dead loads `[vertex]`, N.
    pub(super) loads: Vec<Vector3<f64>>,
    pub(super) contact: Contact<'a>,
    pub(super) self_contact: Option<SelfContact>,
}

/// The parts of the energy of cloth, J.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energies {
    /// Of stretching.
    pub membrane: f64,
    /// Of bending.
    pub bending: f64,
    /// Of weight and other dead loads, zero at the origin.
    pub loads: f64,
    /// Of the springs of contact, friction and self-contact.
    pub contact: f64,
}

impl Energies {
    /// The sum of all energies, in joules.
    pub fn total(&self) -> f64 {
        self.membrane + self.bending + self.loads + self.contact
    }
}

impl Potential<'_> {
    pub(super) fn energies(&self, x: &[Vector3<f64>]) -> Energies {
        let loads = self.loads.iter().zip(x);
        let self_contact = self.self_contact.as_ref();
        Energies {
            membrane: match &self.membrane {
                Membrane::Springs(springs) => springs.energy(x),
                Membrane::Triangles(triangles) => triangles.energy(x),
            },
            bending: match &self.bending {
                Bending::Hinges(hinges) => hinges.energy(x),
                Bending::Faces(faces) => faces.energy(x),
            },
            loads: -loads.map(|(load, x)| load.dot(x)).sum::<f64>(),
            contact: self.contact.energy(x) + self_contact.map_or(0.0, |pairs| pairs.energy(x)),
        }
    }

    /// Energy with inertia, J.
    pub(super) fn energy(&self, x: &[Vector3<f64>], inertia: &Inertia) -> f64 {
        let masses = self.masses.iter().zip(x).zip(&inertia.targets);
        let squares = masses.map(|((mass, x), target)| mass * (x - target).norm_squared());
        self.energies(x).total() + 0.5 * inertia.rate_squared * squares.sum::<f64>()
    }

    /// The gradient of the energy without inertia on all vertices, held ones too, N.
    pub(super) fn static_gradient(&self, x: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let mut gradient: Vec<Vector3<f64>> = self.loads.iter().map(|load| -load).collect();
        match &self.membrane {
            Membrane::Springs(springs) => springs.add_gradient(x, &mut gradient),
            Membrane::Triangles(triangles) => triangles.add_gradient(x, &mut gradient),
        }
        match &self.bending {
            Bending::Hinges(hinges) => hinges.add_gradient(x, &mut gradient),
            Bending::Faces(faces) => faces.add_gradient(x, &mut gradient),
        }
        self.contact.add_gradient(x, &mut gradient);
        if let Some(pairs) = &self.self_contact {
            pairs.add_gradient(x, &mut gradient);
        }
        gradient
    }

    /// The gradient with inertia, N; zero at vertices that are held.
    pub(super) fn gradient(&self, x: &[Vector3<f64>], inertia: &Inertia) -> Vec<Vector3<f64>> {
        let mut gradient = self.static_gradient(x);
        for (vertex, gradient) in gradient.iter_mut().enumerate() {
            *gradient += (x[vertex] - inertia.targets[vertex])
                * (self.masses[vertex] * inertia.rate_squared);
            if self.is_held[vertex] {
                *gradient = Vector3::zeros();
            }
        }
        gradient
    }

    /// Sums the second derivatives with inertia into `values` `[block]`, N/m.
    pub(super) fn hessian(
        &self,
        x: &[Vector3<f64>],
        inertia: &Inertia,
        curvature: Curvature,
        (pattern, values): (&Pattern, &mut [Matrix3<f64>]),
    ) {
        values.fill(Matrix3::zeros());
        let mut blocks = Blocks { pattern, values };
        match &self.membrane {
            Membrane::Springs(springs) => springs.add_hessian(x, curvature, &mut blocks),
            Membrane::Triangles(triangles) => triangles.add_hessian(x, curvature, &mut blocks),
        }
        match &self.bending {
            Bending::Hinges(hinges) => hinges.add_hessian(&mut blocks),
            Bending::Faces(faces) => faces.add_hessian(&mut blocks),
        }
        self.contact.add_hessian(x, &mut blocks);
        if let Some(pairs) = &self.self_contact {
            pairs.add_hessian(x, curvature, &mut blocks);
        }
        for (vertex, mass) in self.masses.iter().enumerate() {
            let block = Matrix3::identity() * (mass * inertia.rate_squared);
            blocks.add(vertex as u32, vertex as u32, &block);
        }
        blocks.hold(&self.is_held);
    }
}

#[cfg(test)]
mod tests {
    use super::super::obstacle::Plane;
    use super::super::{Reference, ReferenceOptions};
    use super::*;
    use crate::{Cloth, Fabric, RestShape};
    use garnet_mesh::primitives::grid;

    /// Analytic second derivatives against central differences of the gradient.
    const GRADIENT: f64 = 1e-3;

    /// A number from -1 to 1.
    fn noise(seed: usize) -> f64 {
        (seed as f64 * 12.9898).sin()
    }

    #[test]
    fn second_derivatives_are_those_of_the_gradient_and_symmetric() {
        let mesh = grid(4, 3, [0.08, 0.06]);
        let rest = RestShape::Worn(mesh.positions().to_vec());
        let fabric = Fabric::denim();
        let cloth = Cloth::new(mesh.faces(), mesh.num_vertices(), &rest, &fabric).unwrap();
        let plane = Plane {
            origin: Vector3::zeros(),
            normal: Vector3::z_axis(),
        };
        let options = ReferenceOptions::default();
        let springs = Reference::new(&cloth, mesh.positions(), &plane, options).unwrap();
        let material = Reference::new(&cloth, mesh.positions(), &plane, options).unwrap();
        let material = material.with_material(&cloth, &rest, 0.3).unwrap();
        for mut reference in [springs, material] {
            for (vertex, x) in reference.x.iter_mut().enumerate() {
                let seed = 3 * vertex;
                *x += Vector3::new(noise(seed), noise(seed + 1), noise(seed + 2)) * 0.002;
            }
            let x = reference.x.clone();
            let inertia = Inertia {
                targets: x.clone(),
                rate_squared: 100.0,
            };
            let all = (0..x.len() as u32).flat_map(|a| (0..a).map(move |b| [a, b]));
            let pattern = Pattern::new(x.len(), all);
            let mut values = vec![Matrix3::zeros(); pattern.num_blocks()];
            let potential = &reference.potential;
            potential.hessian(&x, &inertia, Curvature::True, (&pattern, &mut values));
            let largest = values.iter().map(Matrix3::norm).fold(0.0, f64::max);
            for column in 0..x.len() {
                for axis in 0..3 {
                    let slope = |offset: f64| {
                        let mut moved = x.clone();
                        moved[column][axis] += offset;
                        potential.gradient(&moved, &inertia)
                    };
                    let (ahead, behind) = (slope(1e-7), slope(-1e-7));
                    for row in 0..x.len() {
                        let difference = (ahead[row] - behind[row]) / 2e-7;
                        let block = values[pattern.block(row as u32, column as u32)];
                        let block = if row < column {
                            block.transpose()
                        } else {
                            block
                        };
                        let error = (difference - block.column(axis)).norm();
                        assert!(error < GRADIENT * largest, "{row} {column} {axis}: {error}");
                    }
                }
            }
        }
    }
}
