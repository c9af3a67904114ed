//! Cloth on skin: which place of the skin each vertex is held out of, and how.

mod plane;
mod skin;
mod tracker;
mod triangle;

pub(crate) use plane::{ContactLaw, project};
pub(crate) use skin::Skin;
pub(crate) use tracker::{Contacts, Reach};
