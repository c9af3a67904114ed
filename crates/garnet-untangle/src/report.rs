//! What untangling found and what it left.

/// What untangling found and what it left. Counts are of nodes: vertices at one place count once.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct UntangleReport {
    /// Vertices inside the body in the warp, after its strain was relaxed.
    pub inside_before: usize,
    /// The deepest of them, in metres below the nearest skin.
    pub deepest_before: f32,
    /// Vertices moved by more than a tenth of a millimetre.
    pub moved: usize,
    /// The farthest that one was moved, in metres.
    pub max_displacement: f32,
    /// Vertices caught where the body runs through itself.
    pub trapped: usize,
    /// Trapped vertices that are inside the body.
    pub trapped_inside: usize,
    /// Other vertices that are inside the body: 0 unless untangling failed.
    pub inside: usize,
    /// The deepest of them, in metres below the nearest skin.
    pub deepest: f32,
    /// Vertices that are outside and not trapped, but nearer to the skin than the clearance.
    pub below_clearance: usize,
    /// Those of them that lie between two parts of the body with too little room for twice the
    /// clearance.
    pub squeezed: usize,
    /// Smallest distance to the skin of vertices that are outside and not trapped, in metres; a
    /// lower bound where all keep the clearance.
    pub min_distance: f32,
    /// Faces that cross the skin and have no trapped vertex.
    pub crossing_faces: usize,
    /// Faces that cross the skin and have a trapped vertex.
    pub crossing_faces_trapped: usize,
    /// How often contacts were found anew.
    pub contact_rounds: usize,
    /// How often crossing triangles were lifted.
    pub crossing_rounds: usize,
}
