//! What can go wrong in training and evaluation.

use std::path::PathBuf;

use garnet_data::{DataError, SceneRecord, Split};
use garnet_drape::PackageError;
use garnet_mesh::{MeshError, WriteError};
use garnet_net::losses::Term;
use garnet_net::{CheckpointError, NetError};
use garnet_skin::SkinError;
use garnet_untangle::UntangleError;

/// A scene of a data set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SceneName {
    /// Its split.
    pub split: Split,
    /// Number of the body in the split.
    pub body: u32,
    /// Number of the scene on the body.
    pub pose: u32,
}

impl SceneName {
    /// Of a scene of a split.
    pub(crate) fn of(split: Split, scene: &SceneRecord) -> Self {
        Self {
            split,
            body: scene.body,
            pose: scene.pose,
        }
    }
}

impl std::fmt::Display for SceneName {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { split, body, pose } = self;
        write!(formatter, "scene {pose} of {} body {body}", split.name())
    }
}

/// What can go wrong in training and evaluation.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrainError {
    /// A file cannot be read.
    #[error("cannot read `{}`", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A folder cannot be made, or a file not removed.
    #[error("cannot change `{}`", path.display())]
    Folder {
        /// The folder or file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A configuration does not parse.
    #[error("{}{reason}", path.as_ref().map_or_else(String::new, |path| format!("`{}`: ", path.display())))]
    ConfigText {
        /// The file, if it is one.
        path: Option<PathBuf>,
        /// What was expected and found, with line and column where they are known.
        reason: String,
    },
    /// A number of the configuration is out of range.
    #[error("`{field}` is `{}`, but has to be from {min} to {max}", short(*value))]
    Config {
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The smallest value allowed.
        min: f64,
        /// The largest value allowed.
        max: f64,
    },
    /// A name of a variant cannot be that of a file.
    #[error("`{name}` is no name of a variant: it may have letters, digits, `-` and `_`")]
    VariantName {
        /// The name.
        name: String,
    },
    /// Nothing of this kind can be trained.
    #[error("there is no kind `{kind}` of network or deformation")]
    UnknownKind {
        /// The kind.
        kind: String,
    },
    /// A name of a variant means something else where drapes and tables name methods.
    #[error("`{name}` is no name for a variant: methods and tables have another meaning for it")]
    ReservedName {
        /// The name.
        name: String,
    },
    /// A name is that of another kind than is trained.
    #[error("`{name}` is the name of another kind than `{kind}`")]
    NameOfKind {
        /// The name.
        name: String,
        /// The kind that is trained.
        kind: String,
    },
    /// A name is an alias, which a variant of the package had before.
    #[error("`{name}` is an older name of the variant `{variant}`")]
    OlderName {
        /// The name.
        name: String,
        /// What it is called now.
        variant: String,
    },
    /// Numbers of the configuration that are in their ranges ask for too much memory together.
    #[error(
        "{fields} together take some {found:.1} GB for each region, but have to stay below {most:.1} GB"
    )]
    Memory {
        /// Which numbers, with their values.
        fields: String,
        /// The estimate, in gigabytes.
        found: f64,
        /// The most that is allowed, in gigabytes.
        most: f64,
    },
    /// The weights of a variant would take the place of another file of the package.
    #[error(
        "the weights of `{name}` would take the place of `{file}`, another file of the package"
    )]
    Taken {
        /// The variant.
        name: String,
        /// The file in the package.
        file: String,
    },
    /// No term of the loss has a weight.
    #[error("all weights of the loss are 0: there is nothing to learn")]
    NoLoss,
    /// Weights to start from are of a network of another kind than the name of the variant says.
    #[error("`{name}` is to start from `{base}`, which is of the kind `{found}`")]
    OtherKind {
        /// The variant.
        name: String,
        /// The weights.
        base: String,
        /// Their kind.
        found: &'static str,
    },
    /// A network starts from a pose-space deformation that the package does not have.
    #[error("the network starts from a pose-space deformation, but there is no `{}`", path.display())]
    NoStart {
        /// Where it would be.
        path: PathBuf,
        /// The variant that it is.
        name: &'static str,
    },
    /// A network that is fine-tuned was trained on another pose-space deformation.
    #[error("`{base}` was trained on another pose-space deformation than the package has")]
    OtherStart {
        /// The weights.
        base: String,
    },
    /// The data set was made with another garment.
    #[error(
        "the data set is of `{found_name}` ({found}), the package of `{name}` ({expected}): {what}"
    )]
    OtherTemplate {
        /// What differs.
        what: &'static str,
        /// The garment of the data set.
        found_name: String,
        /// Its fingerprint.
        found: String,
        /// The garment of the package.
        name: String,
        /// Its fingerprint.
        expected: String,
    },
    /// A split has no scenes.
    #[error("the data set has no scenes in its split `{}`", split.name())]
    EmptySplit {
        /// The split.
        split: Split,
    },
    /// A scene does not tell where the cloth was on the way of the body.
    #[error("{scene} does not say where the garment was when {when}")]
    NotKept {
        /// The scene.
        scene: SceneName,
        /// `its body arrived` or `its body was midway`.
        when: &'static str,
    },
    /// The cloth of a data set has not settled.
    #[error("the data set of `{garment}` was not simulated until its cloth settled")]
    NotSettled {
        /// The garment.
        garment: String,
    },
    /// A pose-space deformation cannot be fitted to so few scenes.
    #[error("the data set has {found} scene{} in its split `train`, at least {needed} are needed", plural(*found))]
    FewScenes {
        /// Scenes of the training.
        found: usize,
        /// How many it takes.
        needed: usize,
    },
    /// More scenes than those of the data set for what cannot take them.
    #[error("`{}`: {what} takes no further data sets", path.display())]
    MoreScenes {
        /// The first of them.
        path: PathBuf,
        /// `a network`, or which pose-space deformation.
        what: &'static str,
    },
    /// A further data set is one that is learned from already.
    #[error("`{}` is a data set that is learned from already: its scenes would count twice", path.display())]
    SameScenes {
        /// Its folder.
        path: PathBuf,
    },
    /// A network is to start from what knows the scenes of its training by heart.
    #[error(
        "it is not known how `{name}` would have told the scenes of this data set if it had not seen them"
    )]
    CannotLeaveOut {
        /// The deformation.
        name: String,
    },
    /// No cloth holds together where weights put it.
    #[error("the cloth flies apart in all of {scenes} scenes when it is to settle")]
    FliesApart {
        /// How many.
        scenes: usize,
    },
    /// A scene holds another number of vertices than garment or body have.
    #[error("{scene}: {found} {what}, expected {expected}")]
    Count {
        /// The scene.
        scene: SceneName,
        /// What was counted.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many were expected.
        expected: usize,
    },
    /// A scene holds a coordinate that is no number.
    #[error("{scene}: {what} {index} is not finite")]
    NotFinite {
        /// The scene.
        scene: SceneName,
        /// What it belongs to.
        what: &'static str,
        /// Which one.
        index: usize,
    },
    /// A scene cannot be prepared.
    #[error("cannot prepare {scene}")]
    Scene {
        /// The scene.
        scene: SceneName,
        /// Why.
        source: Box<Self>,
    },
    /// The body of a scene cannot be built.
    #[error("its parameters are not those of a body: {reason}")]
    Body {
        /// What is wrong.
        reason: String,
    },
    /// Loss or derivatives were not finite again and again.
    #[error(
        "the training diverged in epoch {epoch}: {trouble}; {num_skipped} scenes in a row gave no step"
    )]
    Diverged {
        /// The epoch, from 1.
        epoch: u32,
        /// What was not finite in the last one.
        trouble: Trouble,
        /// How many scenes gave no step.
        num_skipped: u32,
    },
    /// A training is under way that was not asked to go on.
    #[error("a training of `{name}` is under way in `{}`, at epoch {epoch}", folder.display())]
    UnderWay {
        /// The variant.
        name: String,
        /// Where its state is.
        folder: PathBuf,
        /// Epochs that are done.
        epoch: u32,
    },
    /// There is nothing to go on with.
    #[error("there is no training of `{name}` to go on with: `{}` is not there", path.display())]
    NothingToResume {
        /// The variant.
        name: String,
        /// Where its state would be.
        path: PathBuf,
    },
    /// The state was saved by a training of another kind.
    #[error("the training in `{}` was begun with another {what}", path.display())]
    OtherTraining {
        /// The state.
        path: PathBuf,
        /// What differs.
        what: &'static str,
    },
    /// A saved state is damaged or of another version.
    #[error("`{}` is no sound state of a training: {reason}", path.display())]
    State {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// What a deformation would have told of scenes that it had not seen is damaged or of another
    /// version.
    #[error("`{}` cannot be started from: {reason}", path.display())]
    Starts {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The work was stopped from outside.
    #[error("stopped")]
    Stopped,
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A data set is not usable.
    #[error(transparent)]
    Data(Box<DataError>),
    /// A garment cannot be draped.
    #[error(transparent)]
    Drape(Box<garnet_drape::Error>),
    /// A package is not usable, or its garment not simulated.
    #[error(transparent)]
    Package(Box<PackageError>),
    /// A network cannot be made or run.
    #[error(transparent)]
    Net(#[from] NetError),
    /// Weights cannot be read or written.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// Garment and body do not fit together.
    #[error(transparent)]
    Skin(#[from] SkinError),
    /// A garment cannot be untangled.
    #[error(transparent)]
    Untangle(#[from] UntangleError),
    /// A mesh is not usable.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// What was not finite in a scene, which therefore gave no step.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Trouble {
    /// The scene.
    pub scene: SceneName,
    /// What was not finite in it.
    pub kind: TroubleKind,
}

/// What was not finite.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TroubleKind {
    /// The network gave a vertex no finite place.
    Place {
        /// The vertex.
        vertex: usize,
    },
    /// A term of the loss.
    Loss {
        /// The term.
        term: Term,
        /// The first vertex without a finite derivative, if there is one.
        vertex: Option<usize>,
    },
    /// The derivative of the loss by a place.
    Derivative {
        /// The vertex.
        vertex: usize,
    },
    /// The derivative by a weight of the network.
    Weight {
        /// The tensor.
        name: String,
    },
}

impl std::fmt::Display for Trouble {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let scene = self.scene;
        match &self.kind {
            TroubleKind::Place { vertex } => {
                write!(formatter, "{scene}: vertex {vertex} has no finite place")
            }
            TroubleKind::Loss { term, vertex } => {
                write!(
                    formatter,
                    "{scene}: the loss term `{}` is not finite",
                    term.name()
                )?;
                match vertex {
                    Some(vertex) => write!(formatter, ", nor is its derivative at vertex {vertex}"),
                    None => Ok(()),
                }
            }
            TroubleKind::Derivative { vertex } => {
                write!(
                    formatter,
                    "{scene}: the loss has no finite derivative at vertex {vertex}"
                )
            }
            TroubleKind::Weight { name } => {
                write!(
                    formatter,
                    "{scene}: weight `{name}` has no finite derivative"
                )
            }
        }
    }
}

/// A number as messages have it: hundreds of digits say less than its power of ten.
fn short(value: f64) -> String {
    if value.is_finite() && value.abs() >= 1e15 {
        return format!("{value:e}");
    }
    value.to_string()
}

const fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

impl From<DataError> for TrainError {
    fn from(source: DataError) -> Self {
        Self::Data(Box::new(source))
    }
}

impl From<garnet_drape::Error> for TrainError {
    fn from(source: garnet_drape::Error) -> Self {
        match source {
            garnet_drape::Error::Package(source) => Self::Package(source),
            source => Self::Drape(Box::new(source)),
        }
    }
}

impl From<PackageError> for TrainError {
    fn from(source: PackageError) -> Self {
        Self::Package(Box::new(source))
    }
}

impl TrainError {
    pub(crate) fn folder(path: &std::path::Path, source: std::io::Error) -> Self {
        Self::Folder {
            path: path.to_path_buf(),
            source,
        }
    }
}
