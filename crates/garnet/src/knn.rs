//! Closest points on a mesh, and what is inside it.

pub use garnet_knn::{ClosestPoint, Surface, TORN_STRETCH, Traps, VertexTree};
