//! The physics that the reference solver has to get right, against closed forms.
//!
//! `cargo run --release -p garnet-lab -- physics` prints what is measured here.

#![allow(
    clippy::unwrap_used,
    dead_code,
    reason = "scenes are shared with the example, which shows more than is tested"
)]

mod cantilever;
mod drapes;
mod friction;
mod hanging;
mod identities;
mod refinement;
mod row;
mod sheets;
