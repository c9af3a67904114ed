//! What the user may ask of untangling.

/// What the user may ask of untangling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UntangleOptions {
    /// Smallest distance between cloth and skin, in metres.
    pub clearance: f32,
    /// Edges of the warp are brought to at most this length over their rest length.
    pub max_stretch: f32,
    /// Edges of the warp are brought to at least this length over their rest length.
    pub min_stretch: f32,
    /// Over which length of cloth a push dies out, in metres.
    pub push_length: f32,
    /// How often contacts are found anew while the cloth is pushed out.
    pub contact_rounds: usize,
    /// How often cloth whose triangles still cross the skin is lifted further.
    pub crossing_rounds: usize,
}

impl Default for UntangleOptions {
    fn default() -> Self {
        Self {
            clearance: 0.002,
            max_stretch: 1.1,
            min_stretch: 0.6,
            push_length: 0.08,
            contact_rounds: 5,
            crossing_rounds: 6,
        }
    }
}
