//! Triangle meshes: diagnosis, comparison, strain, simple shapes.

pub use garnet_mesh::{
    Bounds, Kinship, KnownMesh, MAX_COORDINATE, MeshDiagnosis, MeshDifference, MeshError,
    StretchSummary, Unit, UnitError, UpAxis, diagnose, edge_stretch, edge_stretches, is_inside_out,
    kinship, pattern_stretches, primitives, vertex_distances,
};
