//! Why a scene cannot be read.

use std::path::{Path, PathBuf};

use garnet_mesh::{MeshDifference, MeshError, Unit};
use garnet_skin::SkinError;

use super::{Frame, PoseError};
use crate::{FileError, Misplaced, ObjError};

/// Why a scene cannot be read.
///
/// The text says what does not go; [`std::error::Error::source`] says why.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// An OBJ cannot be read.
    #[error(transparent)]
    Obj(#[from] ObjError),
    /// A rig or scene file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The mesh of an OBJ is impossible.
    #[error("cannot read `{}`", path.display())]
    Mesh {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: MeshError,
    },
    /// A mesh is out of range in the unit that was taken for it.
    #[error("{source}")]
    OutOfRange {
        /// The unit.
        unit: Unit,
        /// What is out of range.
        source: MeshError,
    },
    /// A file is no body.
    #[error("cannot make a body of `{}`", path.display())]
    NoBody {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        problem: SceneProblem,
    },
    /// There are no skeleton and weights for a body.
    #[error("there is no rig{}", of_body(body.as_deref()))]
    NoRig {
        /// The body, if one is named.
        body: Option<PathBuf>,
        /// What was looked for.
        #[source]
        problem: SceneProblem,
    },
    /// Neither a file nor the rig has the body that the garment lies on.
    #[error("there is no rest body")]
    NoRestBody {
        /// What the rig holds.
        #[source]
        problem: SceneProblem,
    },
    /// A rig is not of the rest body.
    #[error(
        "the rig `{}` does not fit the rest body `{}`", rig.display(), rest.display()
    )]
    UnfitRig {
        /// The rig.
        rig: PathBuf,
        /// The rest body.
        rest: PathBuf,
        /// How it does not fit.
        #[source]
        problem: SceneProblem,
    },
    /// A mesh is not the rest body in another pose and shape.
    #[error("`{}` has another topology than the rest body", path.display())]
    OtherTopology {
        /// The file.
        path: PathBuf,
        /// The difference.
        #[source]
        problem: SceneProblem,
    },
    /// A body is of another size than the rest body, beyond all units.
    #[error("`{}` is not of the size of the rest body", path.display())]
    OtherSize {
        /// The file.
        path: PathBuf,
        /// How much larger it is.
        #[source]
        problem: SceneProblem,
    },
    /// A body that is to be posed is not at rest.
    #[error("`{}` is not the rest body", path.display())]
    NotAtRest {
        /// The file.
        path: PathBuf,
        /// How far it is from rest.
        #[source]
        problem: SceneProblem,
    },
    /// The garment does not lie on the rest body.
    #[error("`{}` does not lie on the rest body `{}`", garment.display(), body.display())]
    Misplaced {
        /// The garment.
        garment: PathBuf,
        /// The rest body.
        body: PathBuf,
        /// Unit and axis that were taken for the garment.
        frame: Frame,
        /// The unit that was taken for the body.
        body_unit: Unit,
        /// What looks wrong.
        #[source]
        problem: Misplaced,
    },
    /// The garment cannot be brought to the rest body.
    #[error(
        "cannot bring `{}` to the rest body `{}`: at no place do its openings go round limbs and \
         its cloth lie outside",
        garment.display(),
        body.display()
    )]
    Unplaced {
        /// The garment.
        garment: PathBuf,
        /// The rest body.
        body: PathBuf,
    },
    /// A body is given where the garment is to be.
    #[error("`{}` is given as the garment", garment.display())]
    BodyAsGarment {
        /// The file.
        garment: PathBuf,
        /// What tells so.
        #[source]
        problem: SceneProblem,
    },
    /// A pose cannot be read.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// The joints of the rig are not those of a body that can be posed as asked for.
    #[error("the rig `{}` cannot be posed", rig.display())]
    Unposable {
        /// The rig.
        rig: PathBuf,
        /// What is wrong with it.
        source: PoseError,
    },
    /// The rest body cannot take the pose of a target.
    #[error("cannot pose the body as in `{}`", path.display())]
    Unfitted {
        /// The file of the target.
        path: PathBuf,
        /// What is wrong with the pose.
        source: SkinError,
    },
    /// A body or a pose is impossible.
    #[error(transparent)]
    Skin(#[from] SkinError),
}

/// The cause of a [`SceneError`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneProblem {
    /// No rig is named, and none lies beside a body.
    #[error("no rig is given, and there is no {}", listed(looked))]
    NoneBeside {
        /// Where one was looked for.
        looked: Vec<PathBuf>,
    },
    /// No rig is named, none lies beside the body, and it is not a body that is known.
    #[error(
        "no rig is given, there is no {}, and it is not the built-in body",
        listed(looked)
    )]
    Stranger {
        /// Where one was looked for.
        looked: Vec<PathBuf>,
    },
    /// The built-in body is in a pose.
    #[error("it is the built-in body in a pose, and its skeleton at rest cannot be told from that")]
    Posed,
    /// A rig has no mesh.
    #[error("`{}` holds a skeleton and weights alone", rig.display())]
    SkeletonAlone {
        /// The rig.
        rig: PathBuf,
    },
    /// Most joints lie outside the body.
    #[error("{num_outside} of its {num_joints} joints lie outside the body")]
    JointsOutside {
        /// How many.
        num_outside: usize,
        /// Of how many.
        num_joints: usize,
    },
    /// A body has another number of vertices than the rest body.
    #[error("it has {found} vertices, the rest body `{}` has {expected}", rest.display())]
    VertexCount {
        /// Vertices of the body.
        found: usize,
        /// Vertices of the rest body.
        expected: usize,
        /// The rest body.
        rest: PathBuf,
    },
    /// The vertices are in another order than those of the rest body.
    #[error("its vertices are in another order than those of the rest body `{}`", rest.display())]
    VertexOrder {
        /// The rest body.
        rest: PathBuf,
    },
    /// The vertices are in another order than those of the rig.
    #[error("its vertices are in another order than in `{}`", rig.display())]
    VertexOrderOfRig {
        /// The rig.
        rig: PathBuf,
    },
    /// The mesh differs from that of the rest body.
    #[error("{}", .0.described("the rest body"))]
    Difference(MeshDifference),
    /// Edges are too long or too short for any unit.
    #[error("its edges are {} times as long", plain(*ratio))]
    Ratio {
        /// The median of the ratios.
        ratio: f32,
    },
    /// The rest body has the same vertices and faces.
    #[error("it has the faces of the body `{}`", body.display())]
    FacesOfBody {
        /// The body.
        body: PathBuf,
    },
    /// A rig lies beside the garment, and none beside the body.
    #[error("the rig `{}` lies beside it, and there is none for `{}`", rig.display(), body.display())]
    RigOfGarment {
        /// The rig.
        rig: PathBuf,
        /// What is given as the body.
        body: PathBuf,
    },
    /// A vertex is not at its place at rest.
    #[error("a vertex is {:.1} mm away from its place at rest", 1e3 * distance)]
    Moved {
        /// The largest distance, in metres.
        distance: f32,
    },
    /// The mesh is impossible.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Skeleton, weights or pose are impossible.
    #[error(transparent)]
    Skin(#[from] SkinError),
}

fn of_body(body: Option<&Path>) -> String {
    body.map_or_else(String::new, |path| format!(" for `{}`", path.display()))
}

fn listed(paths: &[PathBuf]) -> String {
    let quoted: Vec<String> = paths
        .iter()
        .map(|path| format!("`{}`", path.display()))
        .collect();
    quoted.join(" or ")
}

/// A ratio in a few digits.
fn plain(ratio: f32) -> String {
    if (0.01..1e5).contains(&ratio) {
        format!("{ratio:.2}")
    } else {
        format!("{ratio:.1e}")
    }
}
