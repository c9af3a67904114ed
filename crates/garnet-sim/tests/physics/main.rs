//! The physics that the reference solver has to get right, against closed forms.
//!
//! `cargo run --release -p garnet-sim --example physics` prints what is measured here.

mod cantilever;
mod friction;
mod hanging;
mod row;
mod sheets;
