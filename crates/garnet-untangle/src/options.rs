//! What the user may ask of untangling.

/// What the user may ask of untangling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UntangleOptions {
    /// Smallest distance between cloth and skin, in metres. More hides coarse triangles and looks
    /// thicker; what does not fit between two parts of the body is squeezed.
    pub clearance: f32,
    /// Edges are brought to at most this length over their rest length. Lower is slacker cloth that
    /// leaves its place more.
    pub max_stretch: f32,
    /// Edges are brought to at least this length over their rest length. Higher smooths folds away.
    pub min_stretch: f32,
    /// Edges are so while more than 0.5 % of them are longer than this over their rest length.
    /// Infinite for none.
    pub relax_beyond: f32,
    /// Over which length of cloth a push dies out, in metres. Longer is smoother and moves more
    /// cloth, shorter keeps folds and strains the cloth around a push.
    pub push_length: f32,
    /// How often contacts are found anew while the cloth is pushed out.
    pub contact_rounds: usize,
    /// How often cloth whose triangles still cross the skin is lifted further.
    pub crossing_rounds: usize,
    /// What each lifted face may add to the stretch of torn edges beyond what counts as torn: tears
    /// of whole patches are mended afterwards. Higher frees more faces and may tear cloth. Tried: 0
    /// to 0.1 (docs/experiments/075).
    pub lift_excess: f32,
    /// Whether cloth is on the right side of the skin but for millimetres: it then leaves by the
    /// skin nearest to it. Where it is trapped it stays where it is, and between two walls that
    /// leave it too little room, in the middle.
    pub keeps_sides: bool,
}

impl Default for UntangleOptions {
    fn default() -> Self {
        Self {
            clearance: 0.002,
            max_stretch: 1.1,
            min_stretch: 0.6,
            relax_beyond: 1.21,
            push_length: 0.08,
            contact_rounds: 5,
            crossing_rounds: 6,
            lift_excess: 0.05,
            keeps_sides: false,
        }
    }
}

/// Predicted drapes are relaxed to this length over the rest length. Tried: 1.03 and 1.1
/// (docs/experiments/010).
const DRAPED_STRETCH: f32 = 1.03;

/// Predicted drapes are relaxed while too many edges are longer than this over their rest length.
const DRAPED_RELAX_BEYOND: f32 = 1.05;

/// Pushes into predicted drapes die out within this, in metres: less than into warps, which are
/// deeper in the skin. Tried: 20 to 80 mm (docs/experiments/010). Below 50 mm cloth tears under
/// arms.
const DRAPED_PUSH_LENGTH: f32 = 0.05;

/// Pushes into simulated cloth die out within this, in metres: about the length of a fold. Tried:
/// 15 to 50 mm (docs/experiments/011). Longer ones let more of the cloth cross itself.
const SIMULATED_PUSH_LENGTH: f32 = 0.02;

impl UntangleOptions {
    /// The same for garments that lie as a network predicts: they have hardly more strain than
    /// cloth has, and lie in the skin by millimetres here and there, where a warp is strained and
    /// may lie in it by centimetres.
    #[must_use]
    pub fn for_drapes(self) -> Self {
        Self {
            max_stretch: self.max_stretch.min(DRAPED_STRETCH),
            relax_beyond: self.relax_beyond.min(DRAPED_RELAX_BEYOND),
            push_length: self.push_length.min(DRAPED_PUSH_LENGTH),
            ..self
        }
    }

    /// The same for garments that were simulated: they lie as cloth does, so that edges are kept as
    /// they are, and are too near to the skin here and there alone, on their side of it
    /// (docs/experiments/011).
    #[must_use]
    pub fn for_simulated(self) -> Self {
        Self {
            min_stretch: 0.0,
            relax_beyond: f32::INFINITY,
            // It has no patches in the skin, and steps of motions would grow.
            lift_excess: 0.0,
            keeps_sides: true,
            push_length: self.push_length.min(SIMULATED_PUSH_LENGTH),
            ..self
        }
    }
}
