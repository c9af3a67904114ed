//! What can be wrong with a skeleton, its weights, a pose or a rig.

/// What can be wrong with a skeleton, its weights, a pose or a rig.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SkinError {
    /// A garment's smoothing system has no factor: its edges are too degenerate.
    #[error("the garment is too degenerate to be smoothed ({0})")]
    Singular(String),
    /// A mesh cannot be searched.
    #[error(transparent)]
    Knn(#[from] garnet_knn::KnnError),
    /// The skeleton has no joint.
    #[error("there are no joints")]
    NoJoints,
    /// More joints than can be numbered.
    #[error("{found} joints are more than the {limit} that can be numbered")]
    TooManyJoints {
        /// How many there are.
        found: usize,
        /// How many are allowed.
        limit: usize,
    },
    /// A joint names a parent that does not exist.
    #[error("joint {joint} (`{name}`) has the parent {parent}, but there are {num_joints} joints")]
    ParentOutOfRange {
        /// Number of the joint, from 0.
        joint: usize,
        /// Its name.
        name: String,
        /// The parent that it names.
        parent: usize,
        /// How many joints there are.
        num_joints: usize,
    },
    /// A joint is its own ancestor.
    #[error("joint {joint} (`{name}`) is its own ancestor")]
    CyclicParents {
        /// Number of the joint, from 0.
        joint: usize,
        /// Its name.
        name: String,
    },
    /// A joint's rest position is NaN or infinite.
    #[error("joint {joint} (`{name}`) has the coordinate `{value}`, which is not finite")]
    NonFiniteJoint {
        /// Number of the joint, from 0.
        joint: usize,
        /// Its name.
        name: String,
        /// The coordinate as found.
        value: f32,
    },
    /// A joint that moves the skin is nowhere near it.
    #[error("joint {joint} (`{name}`) is {distance} m away from the body, which is {size} m large")]
    FarJoint {
        /// Number of the joint, from 0.
        joint: usize,
        /// Its name.
        name: String,
        /// How far it is from the middle of the body, in metres.
        distance: f32,
        /// The diagonal of the body's box, in metres.
        size: f32,
    },
    /// Dense weights do not divide into rows of one weight a joint.
    #[error("{found} weights do not divide into rows of {num_joints} joints")]
    WeightCount {
        /// How many weights were given.
        found: usize,
        /// How many joints there are.
        num_joints: usize,
    },
    /// A weight is NaN or infinite.
    #[error("vertex {vertex} has the weight `{value}` for joint {joint}, which is not finite")]
    NonFiniteWeight {
        /// Number of the vertex, from 0.
        vertex: usize,
        /// Number of the joint, from 0.
        joint: usize,
        /// The weight as found.
        value: f32,
    },
    /// A weight is negative beyond rounding.
    #[error("vertex {vertex} has the negative weight {value} for joint {joint}")]
    NegativeWeight {
        /// Number of the vertex, from 0.
        vertex: usize,
        /// Number of the joint, from 0.
        joint: usize,
        /// The weight as found.
        value: f32,
    },
    /// All weights of a vertex are zero.
    #[error("vertex {vertex} follows no joint: its weights sum to {sum}")]
    NoWeight {
        /// Number of the vertex, from 0.
        vertex: usize,
        /// Sum of its weights.
        sum: f32,
    },
    /// A weight belongs to a joint that does not exist.
    #[error("vertex {vertex} has a weight for joint {joint}, but there are {num_joints} joints")]
    UnknownJoint {
        /// Number of the vertex, from 0.
        vertex: usize,
        /// The joint that it names.
        joint: usize,
        /// How many joints there are.
        num_joints: usize,
    },
    /// Weights and skeleton disagree on the number of joints.
    #[error("the weights are for {weights} joints, the skeleton has {skeleton}")]
    JointCount {
        /// Joints that the weights are for.
        weights: usize,
        /// Joints of the skeleton.
        skeleton: usize,
    },
    /// Weights and mesh disagree on the number of vertices.
    #[error("the weights are for {weights} vertices, the mesh has {mesh}")]
    VertexCount {
        /// Vertices that the weights are for.
        weights: usize,
        /// Vertices of the mesh.
        mesh: usize,
    },
    /// The rig has no rest mesh and none was given.
    #[error("the rig has no rest mesh")]
    NoRestMesh,
    /// A pose has another number of rotations than the skeleton has joints.
    #[error("the pose has {found} joint rotations, the skeleton has {expected} joints")]
    RotationCount {
        /// Rotations of the pose.
        found: usize,
        /// Joints of the skeleton.
        expected: usize,
    },
    /// Another number of transforms than the skeleton has joints.
    #[error("there are {found} joint transforms, the skeleton has {expected} joints")]
    TransformCount {
        /// Transforms given.
        found: usize,
        /// Joints of the skeleton.
        expected: usize,
    },
    /// The rotation or translation of a joint is NaN or infinite.
    #[error("the transform of joint {joint} (`{name}`) is not finite")]
    NonFiniteTransform {
        /// Number of the joint, from 0.
        joint: usize,
        /// Its name.
        name: String,
    },
    /// The matrix of a joint is not a rotation and a translation.
    #[error(
        "the transform of joint `{joint}` is not rigid: it scales, shears or mirrors by \
         {deviation:.2e}, and skinning carries rotation and translation only (tolerance \
         {tolerance:.0e})"
    )]
    NotRigid {
        /// Name of the joint.
        joint: String,
        /// Largest entry of `LᵀL - 1`, `L` the linear part, or of the last row less `0 0 0 1`; 2
        /// for a mirror.
        deviation: f64,
        /// The largest that is allowed.
        tolerance: f64,
    },
    /// A target body has another number of vertices than the rest body.
    #[error("the target has {found} vertices, the rest body has {expected}")]
    TargetCount {
        /// Vertices of the target.
        found: usize,
        /// Vertices of the rest body.
        expected: usize,
    },
    /// A target position is NaN or infinite.
    #[error("vertex {vertex} of the target is not finite")]
    NonFiniteTarget {
        /// Number of the vertex, from 0.
        vertex: usize,
    },
}
