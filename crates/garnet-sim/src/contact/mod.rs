//! Cloth on skin: which place of the skin each vertex is held out of, and how.

mod contacts;
mod grounds;
mod plane;
mod seeker;
mod skin;
mod triangle;
mod unrest;

pub(crate) use contacts::{Contacts, Interval};
pub(crate) use grounds::Grounds;
pub(crate) use plane::{Plane, project};
pub(crate) use skin::Skin;
