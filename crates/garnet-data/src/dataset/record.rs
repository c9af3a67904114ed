//! What is kept of bodies and scenes.

use std::collections::BTreeMap;

use garnet_drape::StoredParameters;
use garnet_mesh::Point3;
use garnet_skin::Pose;
use serde::{Deserialize, Serialize};

use crate::SceneReport;

/// A part of the data: models learn from one, are chosen on the second, and are judged on the
/// third.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Split {
    /// What models learn from.
    Train,
    /// What models are chosen by.
    Valid,
    /// What models are judged by, once.
    Test,
}

impl Split {
    /// All splits, in order.
    pub const ALL: [Self; 3] = [Self::Train, Self::Valid, Self::Test];

    /// The name in files and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Valid => "valid",
            Self::Test => "test",
        }
    }
}

/// A body of a data set.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyRecord {
    /// Its number in its split.
    pub number: u32,
    /// Where it comes from; none for meshes made elsewhere.
    pub parameters: Option<StoredParameters>,
    /// Parameters of the garment that was cut for it, in metres; empty if all wear the template.
    pub garment: BTreeMap<String, f64>,
    /// The garment that was cut for it, worn on the body at rest `[vertex]`, in metres.
    pub worn: Option<Vec<Point3>>,
}

/// A scene of a data set: a body in a pose, and how the garment lies on it.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneRecord {
    /// Number of the body in its split.
    pub body: u32,
    /// Number of the scene on the body.
    pub pose: u32,
    /// The sequence that the pose is from.
    pub sequence: String,
    /// The posed body.
    pub posed: Posed,
    /// Positions of the draped garment `[vertex]`, in metres; in a data set
    /// [until](crate::DatasetManifest::until) arrival those when the body came to its last place,
    /// until midway those when it was there.
    pub garment: Vec<Point3>,
    /// Positions of the garment when the body came to its last place, before it settled `[vertex]`,
    /// in metres; none for drapes made elsewhere or by earlier versions.
    pub arrived: Option<Vec<Point3>>,
    /// Positions of the garment when the body was [midway](garnet_sim::Moment::Midway) `[vertex]`,
    /// in metres; none as there.
    pub midway: Option<Vec<Point3>>,
    /// What the simulation measured; none for drapes made elsewhere.
    pub report: Option<SceneReport>,
}

/// How the body of a scene stands.
#[derive(Debug, Clone, PartialEq)]
pub enum Posed {
    /// A pose of a built-in body.
    Pose(Pose),
    /// Positions of a body made elsewhere `[vertex]`, in metres.
    Mesh(Vec<Point3>),
}

/// A scene that is not in the data set, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Rejection {
    /// Number of the body in its split.
    pub body: u32,
    /// Number of the scene on the body.
    pub pose: u32,
    /// The sequence that the pose is from; empty if no pose was drawn.
    pub sequence: String,
    /// Short name of the reason, to count by.
    pub kind: String,
    /// What was measured.
    pub reason: String,
}
