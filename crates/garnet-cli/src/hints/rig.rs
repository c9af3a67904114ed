//! Advice for what can be wrong with rigs, poses and motions.

use std::error::Error as StdError;

use garnet::{
    body::motion::RetargetError,
    io::{ArrayProblem, FileProblem, GltfProblem, MotionProblem},
    skin::SkinError,
};

use super::{
    did_you_mean,
    mesh::{for_io, for_mesh, for_obj},
};

/// The mesh or animation of a file that a name may be meant for.
pub(super) fn for_names(link: &(dyn StdError + 'static)) -> Option<String> {
    let of_motion = link.downcast_ref::<MotionProblem>();
    let of_motion = of_motion.and_then(|problem| match problem {
        MotionProblem::File(problem) => Some(&**problem),
        _ => None,
    });
    let FileProblem::Gltf(
        GltfProblem::NoMesh { name, found }
        | GltfProblem::NoClip {
            wanted: Some(name),
            found,
        },
    ) = link.downcast_ref::<FileProblem>().or(of_motion)?
    else {
        return None;
    };
    did_you_mean(name, found.iter().map(String::as_str))
}

pub(super) fn for_motion(problem: &MotionProblem) -> Option<&'static str> {
    match problem {
        MotionProblem::Io(source) => for_io(source),
        MotionProblem::NotARotation { .. } | MotionProblem::RowsOrColumns { .. } => Some(
            "write poses as axis-angle `[frames, n, 3]`, or as whole rotation matrices \
             `[frames, n, 3, 3]`",
        ),
        MotionProblem::TurnsOverAndOver { .. } => {
            Some("rotations are in radians; multiply degrees by pi / 180")
        }
        MotionProblem::NotAnAngle { .. } => {
            Some("export the motion again, or correct the number: rotations are in degrees")
        }
        MotionProblem::File(problem)
            if matches!(
                **problem,
                FileProblem::Pickled { .. } | FileProblem::Pickle | FileProblem::Empty
            ) =>
        {
            for_file(problem)
        }
        _ => Some(
            "motions are BVH, npz with `poses` as in AMASS, GLB with an animation, or pose JSON; a file that ends early was \
             not copied whole",
        ),
    }
}

/// The map of joints that was found, for a skeleton that lacks some.
pub(super) fn for_joints(error: &RetargetError) -> Option<String> {
    let map = error.joint_map()?;
    if !error.is_of_body() {
        let hint = "rename those of the motion that are marked `?`";
        return Some(format!("{hint}; found: {map}"));
    }
    Some(format!(
        "name the joints marked `?` in a JSON file, and give it with `--joints`; found: {map}"
    ))
}

pub(super) fn for_retarget(error: &RetargetError) -> Option<&'static str> {
    match error {
        RetargetError::FrameOutOfRange { .. } | RetargetError::NoFrames { .. } => {
            Some("`garnet info` tells how many frames a motion has")
        }
        RetargetError::Folded => Some(
            "export the motion anew with a rest pose that stands, as a T-pose: some recorders lay \
             every bone along one axis",
        ),
        RetargetError::NoFrameTime { .. } => Some("count in frames, and leave out `--fps`"),
        RetargetError::StepOfSamples { .. } => Some("leave out the step, or `--fps`"),
        RetargetError::MissingJoints { .. } if error.is_of_body() => Some(
            "poses of the library and motions find joints by the names that SMPL, CMU, MakeHuman, Mixamo and \
             Blender give them: rename those of the rig, or write a pose file for its own names",
        ),
        RetargetError::MissingJoints { .. } => Some(
            "joints are known by the names that SMPL, CMU, MakeHuman, Mixamo and Blender give them; \
             rename those of the motion",
        ),
        _ if error.is_of_body() => Some(
            "poses of the library and motions are for human figures: write a pose file for this rig",
        ),
        _ => None,
    }
}

pub(super) fn for_file(problem: &FileProblem) -> Option<&'static str> {
    match problem {
        FileProblem::Io(error) => for_io(error),
        FileProblem::Empty => Some("nothing was written into it: export or copy it again"),
        FileProblem::Pickle => Some(
            "load it in Python, and save its arrays of numbers with `numpy.savez`; a sparse matrix as \
             `matrix.toarray()`",
        ),
        FileProblem::UnknownFormat => Some(
            "rigs are npz archives, GLB or glTF files with a skin, or JSON; the OBJ of the rest \
             body goes to `--rest-body`",
        ),
        FileProblem::Json { .. } | FileProblem::Field { .. } | FileProblem::ListLength { .. } => {
            Some("correct the field; `garnet drape --help` names the formats")
        }
        FileProblem::UnknownJointName { .. } | FileProblem::JointRole { .. } => {
            Some("`garnet info RIG` lists the names of the joints")
        }
        FileProblem::JointNamedTwice { .. } => Some(
            "leave out one of them, or name another joint: `garnet info RIG` lists their names",
        ),
        FileProblem::NoMeshes { .. } => {
            Some("`--mesh` is for GLB, glTF and VRM files: leave it out")
        }
        FileProblem::NotAUnitQuaternion { .. } => {
            Some("rotations are written as `[x, y, z, w]` with norm 1")
        }
        FileProblem::FrameOutOfRange { .. } => Some("name a frame as `--pose FILE:FRAME`"),
        FileProblem::NoPose | FileProblem::SeveralPoses { .. } => {
            Some("`garnet drape --help` shows the form of a pose file")
        }
        FileProblem::NotRotated { .. } => Some(
            "a pose turns joints and moves the root: take out what pulls joints apart, or give the \
             posed body in its place",
        ),
        FileProblem::MissingFile { .. } => Some("paths in a JSON file are relative to it"),
        FileProblem::MissingKeys { .. } => Some(
            "a rig has the arrays `vertices`, `faces`, `blend_weights`, `joints` and `parents`, a model of the \
             SMPL family `v_template`, `f`, `weights`, `kintree_table` and `J_regressor`",
        ),
        FileProblem::NoBetas { .. } => Some(
            "`--betas` shapes models of the SMPL family, by as many numbers as they have at most",
        ),
        FileProblem::Pickled { .. } => Some(
            "save it as a plain array of numbers: a sparse matrix as `matrix.toarray()`, other objects as \
             `numpy.asarray(object, dtype=float)`",
        ),
        FileProblem::Gltf(GltfProblem::NoMesh { .. }) => {
            Some("`garnet info` lists the meshes of a file")
        }
        FileProblem::Gltf(GltfProblem::Extension { .. }) => {
            Some("export it without compression of meshes")
        }
        FileProblem::Gltf(GltfProblem::Buffer { .. }) => Some(
            "put the files that it names beside it, or in a folder there; a GLB has all in one file; \
             a file that is cut off is to be exported again",
        ),
        FileProblem::Gltf(GltfProblem::UnknownExtension { .. }) => {
            Some("export it without this extension, or write that it is used, but not required")
        }
        FileProblem::Archive(_) => Some("the file may be cut off: copy or save it again"),
        FileProblem::Array { problem, .. } => Some(for_array(problem)),
        FileProblem::Gltf(_) => {
            Some("the file may be cut off or have no skinned mesh: export it again with its skin")
        }
        FileProblem::Skin(error) => for_skin(error),
        FileProblem::Mesh(error) => for_mesh(error),
        FileProblem::Obj(error) => for_obj(error),
        FileProblem::Other(error) => for_file(&error.problem),
        _ => None,
    }
}

pub(super) fn for_array(problem: &ArrayProblem) -> &'static str {
    match problem {
        ArrayProblem::Unpack { .. } => "the file may be cut off: copy or save it again",
        _ => "all arrays of a rig must be of the same body: save them again together",
    }
}

pub(super) fn for_skin(error: &SkinError) -> Option<&'static str> {
    match error {
        SkinError::CyclicParents { .. } | SkinError::ParentOutOfRange { .. } => {
            Some("the parents of a skeleton form a tree; a root has the parent -1")
        }
        SkinError::NoWeight { .. } => {
            Some("paint weights for every vertex of the body, then export the rig again")
        }
        SkinError::VertexCount { .. } | SkinError::JointCount { .. } => {
            Some("rig and rest body must be of the same mesh")
        }
        SkinError::NoJoints => {
            Some("export the skeleton of the body, too: a rig has one joint at least")
        }
        SkinError::NoRestMesh => Some("give the rest body with `--rest-body OBJ`"),
        SkinError::RotationCount { .. } | SkinError::TransformCount { .. } => {
            Some("the pose must be made for the skeleton of the rig")
        }
        SkinError::NotRigid { .. } => Some("bake scales of joints into the mesh before export"),
        SkinError::NonFiniteWeight { .. }
        | SkinError::NegativeWeight { .. }
        | SkinError::NonFiniteJoint { .. }
        | SkinError::FarJoint { .. } => Some("export the rig again"),
        SkinError::Singular(_) => Some("`garnet info` shows what is unusual about the garment"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use garnet::io::FileError;

    use super::*;
    use crate::hints::for_error;

    #[test]
    fn meshes_and_animations_that_are_mistyped_are_asked_about() {
        let found = || vec!["Walk".to_owned(), "Hair".to_owned()];
        let error = |problem: GltfProblem| FileError {
            path: "a.glb".into(),
            problem: problem.into(),
        };
        let of_mesh = |name: &str| GltfProblem::NoMesh {
            name: name.to_owned(),
            found: found(),
        };
        let hint = |name: &str| for_error(&error(of_mesh(name)).into()).unwrap();
        assert_eq!(hint("hiar"), "did you mean `Hair`?");
        assert_eq!(hint("body"), "`garnet info` lists the meshes of a file");
        let no_clip = GltfProblem::NoClip {
            wanted: Some("walks".to_owned()),
            found: found(),
        };
        let hint = for_error(&error(no_clip).into()).unwrap();
        assert_eq!(hint, "did you mean `Walk`?");
    }
}
