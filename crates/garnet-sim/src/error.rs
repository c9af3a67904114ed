//! What can be wrong with a scene, and what can go wrong while it runs.

use crate::Point3;
use garnet_knn::KnnError;
use garnet_mesh::MeshError;

/// What can be wrong with a fabric, a garment, a collider or a schedule, or go wrong in a run.
///
/// Fields number vertices and faces from 0; texts number the vertices of garments from 1, as OBJ
/// files do, and say so.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// A constant of the fabric is not a number or no fabric has it.
    #[error("the {quantity} of the fabric is `{value}`, but has to be from {min} to {max} {unit}")]
    Fabric {
        /// The field of [`Fabric`](crate::Fabric).
        quantity: &'static str,
        /// The value as given.
        value: f32,
        /// The smallest value allowed.
        min: f32,
        /// The largest value allowed.
        max: f32,
        /// The unit of the three.
        unit: &'static str,
    },
    /// A number of the schedule is not usable.
    #[error("the schedule asks for {quantity} `{value}`, but has to be from {min} to {max}")]
    Schedule {
        /// What it is.
        quantity: &'static str,
        /// The value as given.
        value: f64,
        /// The smallest value allowed.
        min: f64,
        /// The largest value allowed.
        max: f64,
    },
    /// The schedule has more steps than any scene needs.
    #[error("the schedule has {steps} steps; at most {max} are allowed")]
    TooManySteps {
        /// Steps of the whole schedule.
        steps: u64,
        /// The bound.
        max: u64,
    },
    /// A list has not one entry an item.
    #[error("there are {found} {what}, but {expected} are needed")]
    Count {
        /// What is listed.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there have to be.
        expected: usize,
    },
    /// The faces or positions of the garment are not usable.
    #[error("the garment is not usable: {0}")]
    Garment(#[source] MeshError),
    /// The faces or positions of the collider are not usable.
    #[error("the collider is not usable: {0}")]
    Collider(#[source] MeshError),
    /// The motion gave positions that the collider cannot take.
    #[error("the motion of the collider at time {time} is not usable: {source}")]
    Motion {
        /// Time of the motion, from 0 to 1.
        time: f32,
        /// What is wrong with the positions.
        source: KnnError,
    },
    /// The collider moves farther between two frames than cloth can follow.
    #[error(
        "vertex {vertex} of the collider moves {distance} m between two frames of the motion; at most {max} m are allowed"
    )]
    MotionTooFast {
        /// The vertex that moves farthest.
        vertex: usize,
        /// How far, in metres.
        distance: f32,
        /// The bound, in metres.
        max: f32,
    },
    /// A face of the collider has a part that a bit mask cannot hold.
    #[error("face {face} of the collider belongs to part {part}; parts are below 32")]
    PartTooLarge {
        /// Number of the face, from 0.
        face: usize,
        /// Its part.
        part: u8,
    },
    /// A face of the garment has no area at rest.
    #[error("the face of the vertices {}, {} and {} of the garment, counted from 1, has no area at rest",
        counted(corners[0]), counted(corners[1]), counted(corners[2]))]
    NoArea {
        /// Number of the face, from 0.
        face: usize,
        /// Its vertices.
        corners: [u32; 3],
    },
    /// An edge of the garment has more than two faces.
    #[error("the edge between the vertices {} and {} of the garment, counted from 1, has {num_faces} faces",
        counted(vertices[0]), counted(vertices[1]))]
    NonManifoldEdge {
        /// The ends of the edge.
        vertices: [u32; 2],
        /// How many faces it has.
        num_faces: usize,
    },
    /// The two faces at an edge of the garment look to different sides.
    #[error("the two faces at the edge between the vertices {} and {} of the garment, counted from 1, look to different sides",
        counted(vertices[0]), counted(vertices[1]))]
    InvertedFace {
        /// The two faces.
        faces: [u32; 2],
        /// The ends of the edge that they share.
        vertices: [u32; 2],
    },
    /// Two neighboring faces of the flat pattern lie on top of each other.
    #[error("faces {} and {} of the flat pattern lie on top of each other", faces[0], faces[1])]
    FoldedPattern {
        /// The two faces.
        faces: [u32; 2],
    },
    /// The two flat lengths of a sewn edge have little to do with each other.
    #[error("the seam between the vertices {} and {} of the garment, counted from 1, is {} m long on one side and {} m on the other",
        counted(vertices[0]), counted(vertices[1]), lengths[0], lengths[1])]
    SeamMismatch {
        /// The ends of the edge.
        vertices: [u32; 2],
        /// Its flat lengths in the two faces, in metres.
        lengths: [f32; 2],
    },
    /// A vertex has become infinitely fast or far.
    #[error("vertex {} of the garment, counted from 1, is at ({}, {}, {}) after {seconds} s: the simulation has broken down",
        vertex + 1, at.x, at.y, at.z)]
    Exploded {
        /// The first such vertex.
        vertex: usize,
        /// Where it is.
        at: Point3,
        /// Simulated time, in seconds.
        seconds: f32,
    },
    /// A vertex is pulled apart from its neighbors by more than any cloth holds.
    #[error("the edge between the vertices {} and {} of the garment, counted from 1, is {factor} times as long as at rest after {seconds} s",
        counted(vertices[0]), counted(vertices[1]))]
    Torn {
        /// The ends of the worst edge.
        vertices: [u32; 2],
        /// Length over rest length.
        factor: f32,
        /// Simulated time, in seconds.
        seconds: f32,
    },
    /// The observer asked to stop.
    #[error("the run was stopped after {seconds} simulated seconds")]
    Stopped {
        /// Simulated time, in seconds.
        seconds: f32,
    },
    /// The equations of an implicit step have no solution that fits into memory.
    #[error("the {size} equations of an implicit step could not be solved")]
    Unsolvable {
        /// How many there are.
        size: usize,
    },
}

/// The number of a vertex in an OBJ file.
fn counted(vertex: u32) -> u64 {
    u64::from(vertex) + 1
}

impl SimError {
    /// The same of a garment whose vertices are those that `number` gives for those of the cloth.
    ///
    /// ```
    /// use garnet_sim::SimError;
    ///
    /// let welded = SimError::NonManifoldEdge { vertices: [1, 2], num_faces: 3 };
    /// let of_mesh = welded.with_vertices(|vertex| 10 * vertex);
    /// assert_eq!(of_mesh, SimError::NonManifoldEdge { vertices: [10, 20], num_faces: 3 });
    /// assert!(of_mesh.to_string().contains("11 and 21 of the garment, counted from 1"));
    /// ```
    #[must_use]
    pub fn with_vertices(mut self, number: impl Fn(u32) -> u32) -> Self {
        match &mut self {
            Self::NoArea { corners, .. } => *corners = corners.map(number),
            Self::NonManifoldEdge { vertices, .. }
            | Self::InvertedFace { vertices, .. }
            | Self::SeamMismatch { vertices, .. }
            | Self::Torn { vertices, .. } => *vertices = vertices.map(number),
            Self::Exploded { vertex, .. } => *vertex = number(*vertex as u32) as usize,
            _ => {}
        }
        self
    }
}
