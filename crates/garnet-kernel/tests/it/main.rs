//! The kernels against plain `f64` arithmetic, central differences, other implementations and themselves.

mod dispatch;
mod feast;
mod linear;
mod pooling;
mod reference;
mod shapes;
mod torch_geometric;
mod values;
