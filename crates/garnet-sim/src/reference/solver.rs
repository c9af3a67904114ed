//! Cloth that moves by implicit steps.

use std::fmt;

use nalgebra::Vector3;

use super::bending::Hinges;
use super::contact::{Contact, ContactForce};
use super::face_bending::FaceBending;
use super::membrane::{Springs, Triangles};
use super::newton::{Limits, Newton, largest};
use super::obstacle::Obstacle;
use super::options::ReferenceOptions;
use super::potential::{Bending, Energies, Inertia, Membrane, Potential};
use super::self_contact::SelfContact;
use crate::layers::Layers;
use crate::rest_shape::check_count;
use crate::{Cloth, Point3, RestShape, SimError};

/// Weight of a kilogram in the unit of residuals, N. It is rounded, unlike
/// [`STANDARD_GRAVITY`](crate::STANDARD_GRAVITY), because the residuals in stored data sets and
/// reports are in this unit; no force depends on it.
const RESIDUAL_GRAVITY: f64 = 9.81;

/// Longest way of a vertex in one Newton step, in metres.
const MAX_NEWTON_STEP: f64 = 0.1;

/// How often the bounds of friction are found anew in a step in time.
const FRICTION_ROUNDS: usize = 6;

/// Nothing is farther away than this, in metres.
const MAX_COORDINATE: f64 = 1e4;

/// Cloth on an obstacle, and the state that it is in.
pub struct Reference<'a> {
    pub(super) potential: Potential<'a>,
    pub(super) newton: Newton,
    pub(super) options: ReferenceOptions,
    pub(super) x: Vec<Vector3<f64>>,
    velocities: Vec<Vector3<f64>>,
    /// Simulated time, in seconds.
    pub(super) time: f64,
}

impl fmt::Debug for Reference<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Reference")
            .field("num_vertices", &self.x.len())
            .field("options", &self.options)
            .field("time", &self.time)
            .finish_non_exhaustive()
    }
}

/// What one step did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Newton iterations, each with one factorisation.
    pub iterations: usize,
    /// Whether the equations of the step hold to the tolerance.
    pub is_solved: bool,
}

impl<'a> Reference<'a> {
    /// Cloth at rest at `start` `[vertex]`, in metres, above `obstacle`.
    ///
    /// # Errors
    ///
    /// [`SimError::Count`] for positions that do not fit, [`SimError::Exploded`] for positions that
    /// are not finite.
    pub fn new(
        cloth: &Cloth,
        start: &[Point3],
        obstacle: &'a dyn Obstacle,
        options: ReferenceOptions,
    ) -> Result<Self, SimError> {
        check_count("positions", start.len(), cloth.num_vertices())?;
        let x: Vec<Vector3<f64>> = start.iter().map(|start| start.coords.cast()).collect();
        check_places(&x, 0.0)?;
        let fabric = cloth.fabric();
        let masses: Vec<f64> = cloth.masses().iter().map(|&mass| f64::from(mass)).collect();
        let hinges = Hinges::new(cloth);
        let edges = cloth.springs().iter().map(|spring| spring.vertices);
        let pairs = edges.chain(hinges.pairs()).collect();
        let constants = [
            f64::from(fabric.thickness),
            options.contact_stiffness,
            f64::from(fabric.friction),
        ];
        let stiffness = options.contact_stiffness;
        let pairs_of = |radius| SelfContact::new(cloth, radius, stiffness);
        Ok(Self {
            potential: Potential {
                contact: Contact::new(obstacle, constants, &x, cloth.is_pinned()),
                loads: masses.iter().map(|mass| options.gravity * *mass).collect(),
                is_held: cloth.is_pinned().to_vec(),
                membrane: Membrane::Springs(Springs::new(cloth)),
                self_contact: options.self_contact.map(pairs_of),
                bending: Bending::Hinges(hinges),
                masses,
            },
            newton: Newton::new(pairs),
            velocities: vec![Vector3::zeros(); x.len()],
            options,
            x,
            time: 0.0,
        })
    }

    /// The same with an isotropic material of Poisson's ratio `poisson` instead of springs and
    /// hinges: the right moduli of stretching and bending on every mesh, not on regular ones alone.
    ///
    /// It hangs as the heavy elastica does within 2 % on equilateral faces, on squares that are cut
    /// one way and on jittered ones (`garnet-lab physics`). Not so on squares that are cut
    /// alternately: there the vertices with four neighbors give way, and stiff cloth is a quarter
    /// too soft.
    ///
    /// # Errors
    ///
    /// As [`Cloth::new`] for the rest shape.
    pub fn with_material(
        mut self,
        cloth: &Cloth,
        rest: &RestShape,
        poisson: f64,
    ) -> Result<Self, SimError> {
        let rest = rest.faces(cloth.topology())?;
        let fabric = cloth.fabric();
        let [membrane, bending] = [fabric.membrane, fabric.bending].map(f64::from);
        let triangles = Triangles::new(cloth.faces(), &rest, membrane, poisson);
        self.potential.membrane = Membrane::Triangles(triangles);
        if bending > 0.0 {
            let faces = FaceBending::new(cloth, &rest, bending, poisson);
            let edges = cloth.springs().iter().map(|spring| spring.vertices);
            self.newton = Newton::new(edges.chain(faces.pairs()).collect());
            self.potential.bending = Bending::Faces(faces);
        }
        Ok(self)
    }

    /// Adds a dead load on a vertex, N.
    ///
    /// # Panics
    ///
    /// If there is no such vertex.
    pub fn add_load(&mut self, vertex: usize, load: Vector3<f64>) {
        self.potential.loads[vertex] += load;
    }

    /// Moves a vertex, in metres: one that is held stays there.
    ///
    /// # Panics
    ///
    /// If there is no such vertex.
    pub fn place(&mut self, vertex: usize, place: Vector3<f64>) {
        self.x[vertex] = place;
    }

    /// As [`SelfContact::of_layers`].
    pub(super) fn keep_layers(&mut self, layers: Layers) {
        let pairs = SelfContact::of_layers(layers, self.options.contact_stiffness);
        self.potential.self_contact = Some(pairs);
    }

    /// Multiplies the friction of each vertex.
    pub(super) fn scale_friction(&mut self, factor: impl Fn(usize) -> f64) {
        self.potential.contact.scale_friction(factor);
    }

    /// Holds vertices where they are, beside those that are held.
    pub(super) fn hold(&mut self, is_held: impl Fn(usize) -> bool) {
        for (vertex, held) in self.potential.is_held.iter_mut().enumerate() {
            *held |= is_held(vertex);
        }
    }

    /// Holds the vertex with the largest force left over.
    pub(super) fn hold_worst(&mut self) {
        let gradient = self.gradient();
        let free = (0..gradient.len()).filter(|&vertex| !self.potential.is_held[vertex]);
        let force = |vertex: &usize| gradient[*vertex].norm();
        if let Some(worst) = free.max_by(|a, b| force(a).total_cmp(&force(b))) {
            self.potential.is_held[worst] = true;
        }
    }

    /// How many vertices are held.
    pub(super) fn num_held(&self) -> usize {
        let held = self.potential.is_held.iter();
        held.filter(|&&is_held| is_held).count()
    }

    /// Sets the velocity of all vertices, m/s.
    pub fn set_velocities(&mut self, velocity: impl Fn(&Vector3<f64>) -> Vector3<f64>) {
        self.velocities = self.x.iter().map(velocity).collect();
    }

    /// Positions `[vertex]`, in metres.
    pub fn positions(&self) -> &[Vector3<f64>] {
        &self.x
    }

    /// Velocities of the vertices `[vertex]`, in m/s.
    pub fn velocities(&self) -> &[Vector3<f64>] {
        &self.velocities
    }

    /// Energies at the present positions.
    pub fn energies(&self) -> Energies {
        self.potential.energies(&self.x)
    }

    /// Energy of motion, J.
    pub fn kinetic_energy(&self) -> f64 {
        let masses = self.potential.masses.iter().zip(&self.velocities);
        masses
            .map(|(mass, velocity)| 0.5 * mass * velocity.norm_squared())
            .sum()
    }

    /// What the obstacle does to each vertex `[vertex]`, N.
    pub fn contact_forces(&self) -> Vec<ContactForce> {
        let vertices = self.x.iter().enumerate();
        vertices
            .map(|(vertex, x)| self.potential.contact.force(vertex, x))
            .collect()
    }

    /// The gradient of the static energy `[vertex]`, N: minus the force on a free vertex, and the
    /// force that holds one that is held.
    pub fn gradient(&self) -> Vec<Vector3<f64>> {
        self.potential.static_gradient(&self.x)
    }

    /// The largest force left over on a free vertex, over the mean weight of a vertex.
    pub fn residual(&self) -> f64 {
        largest(&self.free_gradient()) / self.mean_weight()
    }

    /// The root of the mean square of the forces left over, over the mean weight of a vertex.
    pub fn rms_residual(&self) -> f64 {
        let gradient = self.free_gradient();
        let squares: f64 = gradient.iter().map(Vector3::norm_squared).sum();
        (squares / gradient.len() as f64).sqrt() / self.mean_weight()
    }

    fn free_gradient(&self) -> Vec<Vector3<f64>> {
        let gradient = self.gradient().into_iter().zip(&self.potential.is_held);
        gradient
            .filter(|(_, is_held)| !**is_held)
            .map(|(gradient, _)| gradient)
            .collect()
    }

    fn mean_weight(&self) -> f64 {
        let masses = &self.potential.masses;
        RESIDUAL_GRAVITY * masses.iter().sum::<f64>() / masses.len() as f64
    }

    /// Moves on by `seconds`: one step of implicit Euler.
    ///
    /// # Errors
    ///
    /// [`SimError::Exploded`] or [`SimError::Unsolvable`].
    pub fn step(&mut self, seconds: f64) -> Result<Step, SimError> {
        let before = self.x.clone();
        let targets = self.x.iter().zip(&self.velocities);
        let targets = targets
            .map(|(x, velocity)| x + velocity * seconds)
            .collect();
        let step = self.minimize(targets, seconds, FRICTION_ROUNDS)?;
        for (vertex, velocity) in self.velocities.iter_mut().enumerate() {
            *velocity = (self.x[vertex] - before[vertex]) / seconds;
        }
        self.time += seconds;
        Ok(step)
    }

    /// Moves on by `seconds` from rest, and forgets the speeds that this takes: a way down the
    /// energy that cannot overshoot. With long steps cloth stays in balance while it is moved.
    ///
    /// # Errors
    ///
    /// As [`Reference::step`].
    pub fn descend(&mut self, seconds: f64) -> Result<Step, SimError> {
        self.velocities.fill(Vector3::zeros());
        self.minimize(self.x.clone(), seconds, 1)
    }

    /// Solves the equations of a step; what friction may pull is found in at most `rounds`.
    fn minimize(
        &mut self,
        targets: Vec<Vector3<f64>>,
        seconds: f64,
        rounds: usize,
    ) -> Result<Step, SimError> {
        self.potential.contact.advance(&self.x);
        let inertia = Inertia {
            targets,
            rate_squared: 1.0 / (seconds * seconds),
        };
        let limits = Limits {
            force: 0.3 * self.options.tolerance * self.mean_weight(),
            iterations: self.options.max_iterations,
            step: MAX_NEWTON_STEP,
        };
        let mut iterations = 0;
        let mut round = 0;
        loop {
            let potential = &mut self.potential;
            let minimum = self
                .newton
                .minimize(potential, &inertia, &mut self.x, limits)?;
            check_places(&self.x, self.time)?;
            iterations += minimum.iterations;
            round += 1;
            let is_last = round == rounds || !minimum.is_reached;
            if is_last || self.potential.contact.tighten(&self.x) <= limits.force {
                return Ok(Step {
                    iterations,
                    is_solved: minimum.is_reached,
                });
            }
        }
    }
}

fn check_places(x: &[Vector3<f64>], time: f64) -> Result<(), SimError> {
    let is_lost = |x: &Vector3<f64>| !x.iter().all(|axis| axis.abs() < MAX_COORDINATE);
    match x.iter().position(is_lost) {
        None => Ok(()),
        Some(vertex) => Err(SimError::Exploded {
            vertex,
            at: Point3::from(x[vertex].cast::<f32>()),
            seconds: time as f32,
        }),
    }
}
