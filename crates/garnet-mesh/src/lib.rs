//! Triangle meshes: topology, normals, areas, curvatures, comparison, fingerprints; atomic writes
//! of files.
//!
//! Values are checked once, where they enter: a [`TriMesh`] holds only coordinates up to
//! [`MAX_COORDINATE`] and faces that name existing vertices. Everything else takes positions and
//! faces as slices, so that many poses share one [`Topology`].
//!
//! ```
//! use garnet_mesh::primitives::tube;
//! use garnet_mesh::{Topology, diagnose, mean_curvatures};
//!
//! let sleeve = tube(0.06, 0.25, 32, 20);
//! assert_eq!(diagnose(&sleeve).boundary_loops.len(), 2);
//!
//! let topology = Topology::new(sleeve.num_vertices(), sleeve.faces());
//! let curvatures = mean_curvatures(sleeve.positions(), &topology);
//! let halfway_up = curvatures[10 * 32];
//! assert!((halfway_up - 1.0 / (2.0 * 0.06)).abs() < 0.05);
//! ```

mod atomic;
mod boundary;
mod bounded;
mod compare;
mod curvature;
mod diagnosis;
mod edges;
mod error;
mod fingerprint;
mod kinship;
mod lists;
mod normals;
mod orientation;
pub mod primitives;
mod section;
mod subdivide;
mod topology;
mod tri_mesh;
mod units;

pub use atomic::{OpenFile, StagedFile, WriteError, remove_stale_temporaries, write_atomically};
pub use bounded::{
    MOST_BYTES, check_regular, read_at_most, read_bounded, read_start, read_text, stays_inside,
};
pub use compare::{
    RestEdge, Spread, StretchSummary, distance_error, edge_stretch, edge_stretches, normal_angles,
    normal_error, pattern_stretches, share_below, vertex_distances,
};
pub use curvature::{
    MAX_COTANGENT, gaussian_curvatures, mean_curvature_normals, mean_curvatures, mixed_areas,
};
pub use diagnosis::{Bounds, MeshDiagnosis, diagnose};
pub use error::MeshError;
pub use fingerprint::{Fingerprint, FingerprintError};
pub use kinship::{Kinship, KnownMesh, MeshDifference, kinship};
pub use normals::{face_areas, face_normals, vertex_normals};
pub use orientation::{Outward, is_inside_out, outward_faces};
pub use section::{LoopSegment, MeshLoop, plane_loops};
pub use subdivide::subdivided;
pub use topology::{Hinge, Topology};
pub use tri_mesh::{MAX_COORDINATE, TriMesh, check_range, stray_coordinate};
pub use units::{Unit, UnitError, UpAxis};

/// A point in space, in metres.
pub type Point3 = nalgebra::Point3<f32>;

/// A direction or displacement, in metres where it has a length.
pub type Vector3 = nalgebra::Vector3<f32>;
