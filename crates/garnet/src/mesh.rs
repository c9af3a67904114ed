//! Triangle meshes: diagnosis, comparison, strain, simple shapes.

pub use garnet_mesh::{
    Bounds, Fingerprint, Kinship, KnownMesh, MAX_COORDINATE, MOST_BYTES, MeshDiagnosis,
    MeshDifference, MeshError, StretchSummary, Unit, UnitError, UpAxis, check_regular, diagnose,
    edge_stretch, edge_stretches, is_inside_out, kinship, pattern_stretches, primitives,
    read_bounded, read_start, read_text, vertex_distances,
};
