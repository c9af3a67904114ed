//! Nearest neighbours and proximity: k-NN, closest point on a mesh, signed distance, triangle
//! intersections.
//!
//! Two values are made once and asked often: a [`VertexTree`] over points and a [`Surface`] over
//! triangles. Both are immutable while asked, so all threads may share them.
//!
//! ```
//! use garnet_knn::Surface;
//! use garnet_mesh::{Point3, TriMesh};
//!
//! let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let mesh = TriMesh::new(corners.map(Point3::from).to_vec(), faces)?;
//! let tetrahedron = Surface::new(&mesh);
//!
//! assert!(tetrahedron.contains(Point3::new(0.1, 0.1, 0.1)));
//! assert_eq!(tetrahedron.signed_distance(Point3::new(0.2, 0.2, 0.125)).distance, -0.125);
//! assert_eq!(tetrahedron.self_intersections(), Vec::<[u32; 2]>::new());
//! # Ok::<(), garnet_mesh::MeshError>(())
//! ```

mod aabb;
mod adjacency;
mod bvh;
mod bvh_build;
mod closest;
mod closest_on_triangle;
mod crossings;
mod error;
mod intersections;
mod lanes;
mod pair_filter;
mod passages;
mod pseudonormals;
mod room;
#[cfg(test)]
mod shapes;
mod solid_angle;
mod surface;
mod torn;
mod traps;
mod triangle_pair;
mod vertex_tree;
mod winding;

pub use closest::ClosestPoint;
pub use closest_on_triangle::Feature;
pub use error::KnnError;
pub use passages::Passage;
pub use pseudonormals::SignedDistance;
pub use room::{PROBE_DISTANCE, Room};
pub use surface::Surface;
pub use torn::TORN_STRETCH;
pub use traps::{SLIT_DEPTH, TRAP_DISTANCE, Traps};
pub use vertex_tree::{Neighbor, NeighborTable, VertexTree};
