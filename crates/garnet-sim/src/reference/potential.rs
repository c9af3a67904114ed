//! The energy that a step minimizes, with its derivatives.

use nalgebra::{Matrix3, Vector3};

use super::bending::Hinges;
use super::blocks::{Blocks, Curvature};
use super::contact::Contact;
use super::membrane::{Springs, Triangles};
use super::self_contact::SelfContact;
use super::system::Pattern;

/// What resists stretching.
#[derive(Debug, Clone)]
pub(super) enum Membrane {
    Springs(Springs),
    Triangles(Triangles),
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
    pub(super) hinges: Hinges,
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
    /// The sum.
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
            bending: self.hinges.energy(x),
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
        self.hinges.add_gradient(x, &mut gradient);
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
        self.hinges.add_hessian(&mut blocks);
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
