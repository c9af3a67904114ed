//! Scenes: a garment on a rest body, and the body that it goes to.

use std::path::{Path, PathBuf};

use garnet_skin::{Pose, Rig, Skeleton, SkinError, SkinWeights, Vector3, rigid_from_matrix};
use nalgebra::{Isometry3, Matrix4};
use serde::Deserialize;

use super::{
    FileError, FileProblem,
    json::{self, Frame, JointJson},
    pose_json::unit_quaternion,
    rig_json::{existing, read_mesh},
    weights_json::read_weights,
};

/// Rounding that is removed from joint matrices; they are written with five digits and more.
pub(super) const MATRIX_TOLERANCE: f64 = 1e-3;

/// A `drape-scene/1` file: paths of the meshes, the skeletons, the weights and the target pose.
///
/// Positions and translations are in metres; the meshes are in the unit of the file, of which
/// [`SceneJson::metres_per_unit`] makes metres.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneJson {
    /// Name of the scene; empty if the file has none.
    pub name: String,
    /// The garment, lying on the rest body.
    pub garment: PathBuf,
    /// The rest body.
    pub rest_body: PathBuf,
    /// The target body, of the same topology.
    pub target_body: PathBuf,
    /// Metres in one unit of the meshes.
    pub metres_per_unit: f64,
    /// The skeleton in the rest body.
    pub rest_skeleton: Skeleton,
    /// The skeleton in the *unposed* target shape; none if the file does not tell it.
    pub target_skeleton: Option<Skeleton>,
    /// The weights of the body's vertices; none if the file names no weights.
    pub weights: Option<SkinWeights>,
    /// Rigid transforms from the unposed target shape to the target body, `[joint]`.
    pub posed_from_rest: Option<Vec<Isometry3<f32>>>,
    /// The same as a pose, if the file has local rotations.
    pub pose: Option<Pose>,
}

#[derive(Debug, Deserialize)]
struct Fields {
    schema: String,
    name: Option<String>,
    units: Option<String>,
    up: Option<String>,
    garment: GarmentJson,
    body_rest: BodyJson,
    body_target: BodyJson,
    weights: Option<String>,
}

#[derive(Debug, Deserialize)]
struct GarmentJson {
    mesh: String,
}

#[derive(Debug, Deserialize)]
struct BodyJson {
    mesh: String,
    joints: Option<Vec<JointJson>>,
    pose: Option<ScenePoseJson>,
}

#[derive(Debug, Deserialize)]
struct ScenePoseJson {
    local_rotation_xyzw: Option<Vec<[f64; 4]>>,
    root_translation: Option<[f64; 3]>,
    joint_transforms_row_major_4x4: Option<Vec<Vec<f64>>>,
}

impl SceneJson {
    /// Reads a `drape-scene/1` file and its weights; the meshes must be there and are not read.
    ///
    /// Paths in the file are relative to it.
    ///
    /// # Errors
    ///
    /// [`FileError`] with line and column of what does not parse, the file that is missing, or what
    /// is impossible about joints, weights or transforms.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let folder = path.parent().unwrap_or(Path::new(""));
        json::read_with(path, |bytes| Self::parse(bytes, folder))
    }

    pub(super) fn parse(bytes: &[u8], folder: &Path) -> Result<Self, FileProblem> {
        let file: Fields = json::parse(bytes)?;
        if file.schema != "drape-scene/1" {
            return Err(FileProblem::Field {
                field: "schema".to_owned(),
                found: file.schema,
                expected: "`drape-scene/1`",
            });
        }
        let frame = Frame {
            units: file.units,
            up: file.up,
        };
        let metres = frame.metres()?;
        let joints = file.body_rest.joints.unwrap_or_default();
        let rest_skeleton = json::skeleton(joints, metres)?;
        let target_joints = file.body_target.joints;
        let target_skeleton = target_joints.map(|joints| json::skeleton(joints, metres));
        let weights = match &file.weights {
            Some(name) => Some(read_weights(existing(folder, name, "the weights file")?)?),
            None => None,
        };
        if let Some(weights) = &weights {
            weights.check_joints(&rest_skeleton)?;
        }
        let pose = file.body_target.pose;
        let (posed_from_rest, pose) = match pose {
            Some(pose) => (
                transforms(&pose, &rest_skeleton, metres)?,
                rotations(&pose, &rest_skeleton, metres)?,
            ),
            None => (None, None),
        };
        Ok(Self {
            name: file.name.unwrap_or_default(),
            garment: existing(folder, &file.garment.mesh, "the garment")?,
            rest_body: existing(folder, &file.body_rest.mesh, "the rest body")?,
            target_body: existing(folder, &file.body_target.mesh, "the target body")?,
            metres_per_unit: metres,
            rest_skeleton,
            target_skeleton: target_skeleton.transpose()?,
            weights,
            posed_from_rest,
            pose,
        })
    }

    /// Reads the rest body and joins it with skeleton and weights.
    ///
    /// # Errors
    ///
    /// [`FileError`] if the rest body cannot be read or the scene names no weights.
    pub fn rig(&self) -> Result<Rig, FileError> {
        let rig = |rest| {
            let weights = self.weights.clone().ok_or_else(|| FileProblem::Field {
                field: "weights".to_owned(),
                found: "missing".to_owned(),
                expected: "the path of a weights file",
            })?;
            Ok(Rig {
                rest: Some(rest),
                skeleton: self.rest_skeleton.clone(),
                weights,
                rest_pose: None,
            })
        };
        let mesh = read_mesh(&self.rest_body, self.metres_per_unit);
        mesh.and_then(rig).map_err(|problem| FileError {
            path: self.rest_body.clone(),
            problem,
        })
    }
}

fn transforms(
    pose: &ScenePoseJson,
    skeleton: &Skeleton,
    metres: f64,
) -> Result<Option<Vec<Isometry3<f32>>>, FileProblem> {
    match &pose.joint_transforms_row_major_4x4 {
        Some(matrices) => rigid_transforms(matrices, skeleton, metres).map(Some),
        None => Ok(None),
    }
}

/// Rigid transforms of row-major 4 × 4 matrices, one a joint.
pub(super) fn rigid_transforms(
    matrices: &[Vec<f64>],
    skeleton: &Skeleton,
    metres: f64,
) -> Result<Vec<Isometry3<f32>>, FileProblem> {
    if matrices.len() != skeleton.num_joints() {
        return Err(SkinError::TransformCount {
            found: matrices.len(),
            expected: skeleton.num_joints(),
        }
        .into());
    }
    let mut transforms = Vec::with_capacity(matrices.len());
    for (index, (entries, joint)) in matrices.iter().zip(skeleton.joints()).enumerate() {
        if entries.len() != 16 {
            return Err(FileProblem::ListLength {
                field: format!("joint_transforms_row_major_4x4[{index}]"),
                found: entries.len(),
                expected: 16,
            });
        }
        let mut matrix = Matrix4::from_row_slice(entries);
        for row in 0..3 {
            matrix[(row, 3)] *= metres;
        }
        transforms.push(rigid_from_matrix(&joint.name, &matrix, MATRIX_TOLERANCE)?);
    }
    Ok(transforms)
}

fn rotations(
    pose: &ScenePoseJson,
    skeleton: &Skeleton,
    metres: f64,
) -> Result<Option<Pose>, FileProblem> {
    let Some(quaternions) = &pose.local_rotation_xyzw else {
        return Ok(None);
    };
    if quaternions.len() != skeleton.num_joints() {
        return Err(SkinError::RotationCount {
            found: quaternions.len(),
            expected: skeleton.num_joints(),
        }
        .into());
    }
    let joints = quaternions.iter().zip(skeleton.joints());
    let rotations = joints.map(|(&xyzw, joint)| unit_quaternion(&joint.name, xyzw));
    let shift = pose.root_translation.unwrap_or_default();
    Ok(Some(Pose {
        root_translation: Vector3::from(shift.map(|value| (value * metres) as f32)),
        rotations: rotations.collect::<Result<_, _>>()?,
    }))
}
