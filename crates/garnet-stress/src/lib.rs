//! The level at which each way to drape breaks.
//!
//! Each [`Axis`] makes a scene of a package worse by degrees: a bent joint, a heavier body, noise
//! on the skin. Each [`Method`] drapes it, and every drape is judged in the same way: whether its
//! coordinates are finite, whether a free vertex is inside the body, whether an edge is three times
//! as long as at rest, whether cloth jumps. A cell of the table is the level at which the first of
//! these breaks.

mod axis;
mod child;
mod damage;
mod error;
mod method;
mod scene;
mod suite;
mod verdict;

pub use axis::{AXES, Axis};
pub use damage::without_patches;
pub use error::StressError;
pub use method::Method;
pub use suite::{Cell, Hold, StressOptions, holds, run};
pub use verdict::{Broken, Measured};
