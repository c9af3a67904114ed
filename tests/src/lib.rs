//! Generated bodies and garments, and an independent judge of drapes, for tests, benches and the
//! demo.
//!
//! Nothing here is read from outside: bodies are level sets of smooth unions of tapered bones,
//! garments are quad panels wrapped around them. Only sums, products and square roots are used for
//! the mannequin, so the same meshes come out on every machine, to the last bit.
//!
//! - [`mannequin`]: one smooth, closed body with 16 joints, at any resolution.
//! - [`tunic`]: a garment with sleeves on it, of quads with texture coordinates.
//! - [`capsules`]: small bodies of capsules that run through each other, and an arm.
//! - [`without`]: bodies whose skin was deleted, as under clothes.
//! - [`Judge`]: what a drape must hold, measured apart from the code that made it.
//! - [`demo`]: the files in `models/demo`.
//! - [`golden`]: drapes that are stored in `tests/it/golden`.

mod bone;
pub mod capsules;
pub mod demo;
mod form;
pub mod golden;
mod judge;
mod mannequin;
mod removed;
mod surface_nets;
mod tunic;

pub use form::Form;
pub use judge::{Judge, Judgement, trapped};
pub use mannequin::{mannequin, reach, stride};
pub use removed::without;
pub use tunic::{Tunic, tunic, tunic_on};
