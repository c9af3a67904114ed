//! The reference solver: implicit steps, solved by Newton's method to a stated residual.
//!
//! It minimizes the energy of [`Cloth`](crate::Cloth), the same as the production solver, in double
//! precision: energy, gradient, second derivatives and a sparse Cholesky factor a step. It is slow,
//! makes no compromise, and says how far from balance it ended. Two uses:
//!
//! - The reference quality of [`drape`](crate::drape()) ends with it: the accurate end of the chart
//!   of speed against accuracy.
//! - [`Reference`] runs the physics tests: pinned vertices, dead loads, exact obstacles, steps in
//!   time.
//!
//! A step of length h ends at the minimum of
//!
//! ```text
//! E(x) + Σ ½ m |x − y|² / h²,   y = x₀ + h v₀
//! ```
//!
//! which is implicit Euler. Without speeds (v₀ = 0 in every step) it is a descent that cannot
//! overshoot, and with h → ∞ Newton's method on E alone: that is how [`Reference::settle`] ends.

mod balance;
mod bending;
mod blocks;
mod contact;
mod face_bending;
mod factor;
mod membrane;
mod newton;
mod obstacle;
mod options;
mod potential;
mod self_contact;
mod settle;
mod solver;
mod system;

pub use balance::Balance;
pub(crate) use balance::balance;
pub use contact::ContactForce;
pub use obstacle::{Cylinder, Disc, Nearest, Nothing, Obstacle, Plane, Sphere};
pub use options::ReferenceOptions;
pub use potential::Energies;
pub use settle::Settled;
pub use solver::{Reference, Step};
