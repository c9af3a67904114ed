//! Triangle meshes: OBJ in and lossless out, topology, normals, areas, curvatures, comparison.

mod error;
mod topology;
mod tri_mesh;

pub use error::MeshError;
pub use topology::Topology;
pub use tri_mesh::TriMesh;

/// A point in space, in metres.
pub type Point3 = nalgebra::Point3<f32>;

/// A direction or displacement, in metres where it has a length.
pub type Vector3 = nalgebra::Vector3<f32>;
