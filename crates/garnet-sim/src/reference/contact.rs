//! Contact with an obstacle and Coulomb friction on it.
//!
//! Contact is a stiff spring along the true distance, zero beyond the thickness of the cloth.
//! Friction ties each vertex that touches to an anchor by a spring in the tangent plane. The pull
//! of that spring is bounded by μ times the normal force of the step's start; what would stretch it
//! farther moves the anchor along (Cundall & Strack 1979, "A discrete numerical model for granular
//! assemblies"; return mapping of plasticity). So cloth truly sticks: at rest the anchors do not
//! move and no speed is left over. Within a step the anchors rest and friction has a potential.

use nalgebra::{Matrix3, Vector3};

use super::blocks::Blocks;
use super::obstacle::{Nearest, Obstacle};

/// Vertices that start deeper inside the obstacle, in metres, are not pushed out: the way out that
/// they would take is not the way in.
const MAX_START_DEPTH: f64 = 0.03;

/// How far from the obstacle distances are known, in metres.
const REACH: f64 = 0.03;

/// Sticking gives by this at the most, in metres: with the stiffness of contact throughout,
/// Newton's method would jump between sticking and slipping.
const ELASTIC_SLIP: f64 = 1e-5;

/// Contact of all vertices with one obstacle.
pub(super) struct Contact<'a> {
    obstacle: &'a dyn Obstacle,
    thickness: f64,
    /// Of the springs along and across the normal, N/m.
    stiffness: f64,
    /// Coefficient of friction of each vertex.
    friction: Vec<f64>,
    touches: Vec<Touch>,
}

/// What is known about one vertex.
#[derive(Debug, Clone, Copy)]
struct Touch {
    /// Where `clearance` was measured.
    place: Vector3<f64>,
    /// No part of the obstacle was nearer to `place`; infinite for vertices that are left alone.
    clearance: f64,
    grip: Option<Grip>,
}

/// Friction on a vertex during one step.
#[derive(Debug, Clone, Copy)]
struct Grip {
    anchor: Vector3<f64>,
    normal: Vector3<f64>,
    /// The largest pull, μ times the normal force at the start of the step, N.
    limit: f64,
}

/// The forces of an obstacle on a vertex, N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactForce {
    /// Along the normal, away from the obstacle.
    pub normal: Vector3<f64>,
    /// In the tangent plane.
    pub friction: Vector3<f64>,
}

impl Grip {
    fn slip(&self, x: &Vector3<f64>) -> Vector3<f64> {
        let offset = x - self.anchor;
        offset - self.normal * self.normal.dot(&offset)
    }

    /// Pull over slip while it sticks, N/m.
    fn stiffness(&self) -> f64 {
        self.limit / ELASTIC_SLIP
    }

    /// Energy, and pull over slip.
    fn pull(&self, slip: f64) -> (f64, f64) {
        if slip <= ELASTIC_SLIP {
            (0.5 * self.stiffness() * slip * slip, self.stiffness())
        } else {
            (self.limit * (slip - 0.5 * ELASTIC_SLIP), self.limit / slip)
        }
    }

    /// The same grip with its anchor as far behind as the pull allows.
    fn followed(self, x: &Vector3<f64>) -> Self {
        let slip = self.slip(x);
        let share = (ELASTIC_SLIP / slip.norm()).min(1.0);
        Self {
            anchor: x - slip * share,
            ..self
        }
    }
}

impl<'a> Contact<'a> {
    pub(super) fn new(
        obstacle: &'a dyn Obstacle,
        [thickness, stiffness, friction]: [f64; 3],
        x: &[Vector3<f64>],
        is_held: &[bool],
    ) -> Self {
        obstacle.follow(x);
        let touch = |(vertex, place): (usize, &Vector3<f64>)| {
            let nearest = obstacle.nearest(vertex, place, REACH);
            let is_lost = nearest.is_some_and(|nearest| nearest.distance < -MAX_START_DEPTH);
            Touch {
                place: *place,
                clearance: if is_lost || is_held[vertex] {
                    f64::INFINITY
                } else {
                    nearest.map_or(REACH, |nearest| nearest.distance)
                },
                grip: None,
            }
        };
        Self {
            touches: x.iter().enumerate().map(touch).collect(),
            obstacle,
            thickness,
            stiffness,
            friction: vec![friction; x.len()],
        }
    }

    /// Multiplies the coefficient of friction of each vertex.
    pub(super) fn scale_friction(&mut self, factor: impl Fn(usize) -> f64) {
        for (vertex, friction) in self.friction.iter_mut().enumerate() {
            *friction *= factor(vertex);
        }
    }

    /// Ends a step at `x` and begins the next: moves the anchors that were pulled too hard, lets
    /// those go that touch no more and sets the bounds of the pulls from the present forces.
    pub(super) fn advance(&mut self, x: &[Vector3<f64>]) {
        self.obstacle.follow(x);
        for (vertex, place) in x.iter().enumerate() {
            if self.touches[vertex].clearance.is_infinite() {
                continue;
            }
            let nearest = self.obstacle.nearest(vertex, place, REACH);
            let touch = &mut self.touches[vertex];
            touch.place = *place;
            touch.clearance = nearest.map_or(REACH, |nearest| nearest.distance);
            let grip = self.grip(vertex, nearest);
            self.touches[vertex].grip = grip.map(|grip| grip.followed(place));
        }
    }

    /// Sets the bounds of the pulls from the forces at `x` and leaves the anchors where they are.
    /// Gives the largest change of a bound, N.
    pub(super) fn tighten(&mut self, x: &[Vector3<f64>]) -> f64 {
        let mut largest = 0.0_f64;
        for (vertex, place) in x.iter().enumerate() {
            let depth = self.depth(vertex, place);
            let nearest = depth.map(|(depth, normal)| Nearest {
                distance: self.thickness - depth,
                normal,
            });
            let grip = self.grip(vertex, nearest);
            let limit = |grip: Option<Grip>| grip.map_or(0.0, |grip| grip.limit);
            largest = largest.max((limit(grip) - limit(self.touches[vertex].grip)).abs());
            self.touches[vertex].grip = grip;
        }
        largest
    }

    /// The grip of a vertex that is pressed as `nearest` says. A new one starts from where the
    /// vertex was when the step began.
    fn grip(&self, vertex: usize, nearest: Option<Nearest>) -> Option<Grip> {
        let Nearest { distance, normal } = nearest?;
        let depth = self.thickness - distance;
        let Touch { place, grip, .. } = self.touches[vertex];
        (depth > 0.0).then(|| Grip {
            anchor: grip.map_or(place, |grip| grip.anchor),
            normal,
            limit: self.friction[vertex] * self.stiffness * depth,
        })
    }

    /// How deep a vertex lies inside the thickness around the obstacle, and the normal there.
    fn depth(&self, vertex: usize, x: &Vector3<f64>) -> Option<(f64, Vector3<f64>)> {
        let touch = &self.touches[vertex];
        if touch.clearance - (x - touch.place).norm() > self.thickness {
            return None;
        }
        // Looked for as far as a vertex may be inside: deeper ones must not be lost to a step that
        // is too long.
        let nearest = self.obstacle.nearest(vertex, x, REACH)?;
        let depth = self.thickness - nearest.distance;
        (depth > 0.0).then_some((depth, nearest.normal))
    }

    /// Energy, J.
    pub(super) fn energy(&self, x: &[Vector3<f64>]) -> f64 {
        let energy = |(vertex, touch): (usize, &Touch)| {
            let depth = self
                .depth(vertex, &x[vertex])
                .map_or(0.0, |(depth, _)| depth);
            let friction = touch
                .grip
                .map_or(0.0, |grip| grip.pull(grip.slip(&x[vertex]).norm()).0);
            0.5 * self.stiffness * depth * depth + friction
        };
        self.touches.iter().enumerate().map(energy).sum()
    }

    /// The forces on a vertex.
    pub(super) fn force(&self, vertex: usize, x: &Vector3<f64>) -> ContactForce {
        let normal = self.depth(vertex, x);
        let friction = self.touches[vertex]
            .grip
            .map_or_else(Vector3::zeros, |grip| {
                let slip = grip.slip(x);
                -slip * grip.pull(slip.norm()).1
            });
        ContactForce {
            normal: normal.map_or_else(Vector3::zeros, |(depth, normal)| {
                normal * (self.stiffness * depth)
            }),
            friction,
        }
    }

    /// Adds the gradient of the energy, N.
    pub(super) fn add_gradient(&self, x: &[Vector3<f64>], gradient: &mut [Vector3<f64>]) {
        for (vertex, (x, gradient)) in x.iter().zip(gradient).enumerate() {
            let force = self.force(vertex, x);
            *gradient -= force.normal + force.friction;
        }
    }

    /// Adds the second derivatives, without the curvature of the obstacle: over the depths that
    /// occur it is nothing beside the stiffness.
    pub(super) fn add_hessian(&self, x: &[Vector3<f64>], blocks: &mut Blocks) {
        for (vertex, touch) in self.touches.iter().enumerate() {
            let mut block = Matrix3::zeros();
            if let Some((_, normal)) = self.depth(vertex, &x[vertex]) {
                block += normal * normal.transpose() * self.stiffness;
            }
            if let Some(grip) = touch.grip {
                let slip = grip.slip(&x[vertex]);
                let length = slip.norm();
                let (_, pull) = grip.pull(length);
                let tangent = Matrix3::identity() - grip.normal * grip.normal.transpose();
                block += tangent * pull;
                if length > ELASTIC_SLIP {
                    let direction = slip / length;
                    block -= direction * direction.transpose() * pull;
                }
            }
            blocks.add(vertex as u32, vertex as u32, &block);
        }
    }
}
