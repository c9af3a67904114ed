//! The kernels against plain `f64` arithmetic, central differences, other implementations and
//! themselves.

#![allow(
    clippy::doc_markdown,
    reason = "FeaStConv and torch_geometric are names"
)]
#![allow(clippy::float_cmp, reason = "pooling copies values")]
#![allow(
    clippy::needless_for_each,
    clippy::needless_range_loop,
    reason = "formulas with indices"
)]

mod dispatch;
mod feast;
mod linear;
mod pooling;
mod reference;
mod shapes;
mod torch_geometric;
mod values;
