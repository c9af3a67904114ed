//! What can be wrong with a glTF file.

/// What can be wrong with a glTF file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GltfProblem {
    /// The GLB container ends early or contradicts itself.
    #[error("the GLB container is cut off or damaged: {what}")]
    Container {
        /// What does not fit.
        what: &'static str,
    },
    /// Another version than 2.
    #[error("the version is {found}, expected 2")]
    Version {
        /// The version of the file.
        found: String,
    },
    /// An extension without which the mesh cannot be read.
    #[error("it needs the extension `{name}`, which is not read; export without mesh compression")]
    Extension {
        /// Name of the extension.
        name: String,
    },
    /// An extension that the file needs, and that is not known: what it changes would be missing.
    #[error(
        "it needs the extension `{name}`, which is not known; those that a file may need are {}",
        super::extensions::listed()
    )]
    UnknownExtension {
        /// Name of the extension.
        name: String,
    },
    /// No mesh has a name that was asked for.
    #[error("there is no skinned mesh `{name}`; there are {}", listed(found))]
    NoMesh {
        /// The name.
        name: String,
        /// Names that there are.
        found: Vec<String>,
    },
    /// No node has a mesh and a skin.
    #[error("no mesh has a skin")]
    NoSkin,
    /// All meshes are points or lines.
    #[error("its meshes are made of points or lines, without a triangle")]
    NoTriangles,
    /// There is no such animation.
    #[error("{}", no_clip(wanted.as_deref(), found))]
    NoClip {
        /// The name that was asked for.
        wanted: Option<String>,
        /// The names that there are.
        found: Vec<String>,
    },
    /// An animation cannot be read.
    #[error("the animation: {what}")]
    Animation {
        /// What is wrong with it.
        what: &'static str,
    },
    /// Something names a part that does not exist.
    #[error("{user} names {part} {index}, but there are {count}")]
    OutOfRange {
        /// What names it.
        user: String,
        /// What kind of part it is.
        part: &'static str,
        /// Its number, from 0.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A buffer cannot be had.
    #[error("buffer {buffer}: {what}")]
    Buffer {
        /// Number of the buffer, from 0.
        buffer: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// An accessor reads outside its buffer or is of the wrong type.
    #[error("accessor {accessor}: {what}")]
    Accessor {
        /// Number of the accessor, from 0.
        accessor: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// A primitive cannot be read.
    #[error("primitive {primitive} of the mesh: {what}")]
    Primitive {
        /// Number of the primitive, from 0.
        primitive: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// Its primitives name vertices again and again.
    #[error("its primitives have more than {most} vertices or faces")]
    TooLarge {
        /// How many are read at most.
        most: usize,
    },
    /// The nodes are no forest.
    #[error("node {node} (`{name}`) is its own ancestor, or a child of two nodes")]
    CyclicNodes {
        /// Number of the node, from 0.
        node: usize,
        /// Its name.
        name: String,
    },
    /// The skin says nothing of its rest pose, or something impossible.
    #[error("the skin: {what}")]
    Skin {
        /// What is wrong with it.
        what: &'static str,
    },
    /// The inverse bind matrix of a joint has no inverse.
    #[error("the inverse bind matrix of joint `{joint}` has no inverse")]
    SingularBindMatrix {
        /// Name of the joint.
        joint: String,
    },
}

fn listed(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    quoted.join(", ")
}

fn no_clip(wanted: Option<&str>, found: &[String]) -> String {
    match (wanted, found.is_empty()) {
        (_, true) => "it has no animation".to_owned(),
        (Some(wanted), false) => {
            format!("it has no clip `{wanted}`; its clips are {}", listed(found))
        }
        (None, false) => "no clip was named".to_owned(),
    }
}
