//! Rigs as npz: the container that `NeuralClothSim` users have.

use std::{
    collections::BTreeSet,
    io::{self, Cursor, Write},
    path::Path,
};

use garnet_mesh::{TriMesh, WriteError, write_atomically};
use garnet_skin::{Joint, Point3, Pose, Rig, Skeleton, SkinError, SkinWeights, Vector3};
use nalgebra::UnitQuaternion;
use zip::{CompressionMethod, DateTime, ZipWriter, write::SimpleFileOptions};

use super::{
    ArrayProblem, FileError,
    npy::{self, NpyArray},
    npz::NpzFile,
    rig_smpl,
};

const REQUIRED: [&str; 5] = ["vertices", "faces", "blend_weights", "joints", "parents"];

/// Reads a rig from an npz archive.
///
/// | key | shape | |
/// |---|---|---|
/// | `vertices` | `[V, 3]` | rest positions, in metres |
/// | `faces` | `[F, 3]` | vertex numbers, from 0 |
/// | `blend_weights` | `[V, J]` | weight of each joint |
/// | `joints` | `[J, 3]` | rest positions of the joints, in metres |
/// | `parents` | `[J]` | joint numbers; a root has -1 (also as the largest unsigned number) or itself |
/// | `rest_pose` | `[J, 3]` or `[3 J]`, optional | axis-angle, radians |
/// | `joint_names` | `[J]`, optional | without it joints are `joint_0`, `joint_1` … |
/// | `joint_roles` | `[J]`, optional | what joints are, where names do not tell: `left_knee`, or nothing |
///
/// Models of the SMPL family are read, too: `v_template`, `f`, `weights`, `kintree_table` and
/// `J_regressor` (dense or sparse), in their mean shape.
///
/// Floats and integers of any width and byte order, in C or Fortran order, stored or deflated.
/// `vertices` and `joints` are read as the pose zero. `rest_pose` is the pose that the garments of
/// this body are modelled on: it becomes [`Rig::rest_pose`], and nothing where it is zero.
///
/// # Errors
///
/// [`FileError`] with the keys that are missing, or the key whose array is damaged, of another
/// shape, or holds impossible values.
pub fn read_rig_npz(path: impl AsRef<Path>) -> Result<Rig, FileError> {
    read_rig_npz_with(path.as_ref(), &[])
}

/// The same, in a shape of a model of the SMPL family.
pub(super) fn read_rig_npz_with(path: &Path, betas: &[f64]) -> Result<Rig, FileError> {
    let mut npz = NpzFile::open(path)?;
    if npz.keys().iter().any(|key| key == rig_smpl::TEMPLATE) {
        return rig_smpl::read(&mut npz, betas);
    }
    npz.require(&REQUIRED)?;
    if !betas.is_empty() {
        let asked = betas.len();
        return Err(npz.failed(super::FileProblem::NoBetas { found: 0, asked }));
    }
    let vertices = points(&required(&mut npz, "vertices", &[None, Some(3)])?);
    let vertices = vertices.map_err(|problem| npz.wrong("vertices", problem))?;
    let faces = faces(&required(&mut npz, "faces", &[None, Some(3)])?);
    let faces = faces.map_err(|problem| npz.wrong("faces", problem))?;
    let mesh = TriMesh::new(vertices, faces).map_err(|error| npz.failed(error.into()))?;

    let skeleton = skeleton(&mut npz)?;
    let num_joints = skeleton.num_joints();
    let shape = [Some(mesh.num_vertices()), Some(num_joints)];
    let dense = required(&mut npz, "blend_weights", &shape)?.floats();
    let dense = dense.map_err(|problem| npz.wrong("blend_weights", problem))?;
    let dense: Vec<f32> = dense.into_iter().map(|value| value as f32).collect();
    let weights = SkinWeights::from_dense(num_joints, &dense);
    Ok(Rig {
        rest: Some(mesh),
        weights: weights.map_err(|error| npz.failed(error.into()))?,
        rest_pose: rest_pose(&mut npz, num_joints)?,
        skeleton,
    })
}

/// The array of a key that is there; `None` in `shape` fits any length.
pub(super) fn required(
    npz: &mut NpzFile,
    key: &str,
    shape: &[Option<usize>],
) -> Result<NpyArray, FileError> {
    let Some(array) = npz.array(key)? else {
        npz.require(&[key])?;
        return Err(npz.failed(super::FileProblem::UnknownFormat));
    };
    let fits = |(&found, expected): (&usize, &Option<usize>)| {
        expected.is_none_or(|length| length == found)
    };
    if array.shape.len() == shape.len() && array.shape.iter().zip(shape).all(fits) {
        return Ok(array);
    }
    let axes = shape
        .iter()
        .map(|axis| axis.map_or("_".to_owned(), |length| length.to_string()));
    let expected = format!("[{}]", axes.collect::<Vec<_>>().join(", "));
    let found = array.shape;
    Err(npz.wrong(key, ArrayProblem::Shape { found, expected }))
}

fn points(array: &NpyArray) -> Result<Vec<Point3>, ArrayProblem> {
    let values = array.floats()?;
    let rows = values.chunks_exact(3);
    Ok(rows
        .map(|row| Point3::new(row[0] as f32, row[1] as f32, row[2] as f32))
        .collect())
}

pub(super) fn faces(array: &NpyArray) -> Result<Vec<[u32; 3]>, ArrayProblem> {
    let mut corners = Vec::new();
    for (index, value) in array.integers()?.into_iter().enumerate() {
        corners.push(
            u32::try_from(value).map_err(|_out_of_range| ArrayProblem::Value {
                index,
                value: value as f64,
                expected: "a vertex number",
            })?,
        );
    }
    let rows = corners.chunks_exact(3);
    Ok(rows.map(|row| [row[0], row[1], row[2]]).collect())
}

/// A name that two joints have: poses would turn one of them alone.
fn twice(names: &[String]) -> Option<&str> {
    let mut seen = BTreeSet::new();
    let mut names = names.iter().map(String::as_str);
    names.find(|name| !seen.insert(*name))
}

fn skeleton(npz: &mut NpzFile) -> Result<Skeleton, FileError> {
    let array = required(npz, "joints", &[None, Some(3)])?;
    let positions = points(&array).map_err(|problem| npz.wrong("joints", problem))?;
    let num_joints = positions.len();
    let parents = parents(&required(npz, "parents", &[Some(num_joints)])?);
    let parents = parents.map_err(|problem| npz.wrong("parents", problem))?;
    let names = match npz.array("joint_names")? {
        Some(array) => array.texts().and_then(|names| match names.len() {
            length if length == num_joints => Ok(names),
            _ => Err(ArrayProblem::Shape {
                found: array.shape.clone(),
                expected: format!("[{num_joints}]"),
            }),
        }),
        None => Ok((0..num_joints)
            .map(|joint| format!("joint_{joint}"))
            .collect()),
    };
    let names = names.map_err(|problem| npz.wrong("joint_names", problem))?;
    if let Some(name) = twice(&names) {
        let name = name.to_owned();
        return Err(npz.wrong("joint_names", ArrayProblem::Twice { name }));
    }
    let joints = names.into_iter().zip(parents).zip(positions);
    let joints = joints.map(|((name, parent), rest_position)| Joint {
        name,
        parent,
        rest_position,
    });
    let skeleton = Skeleton::new(joints.collect()).map_err(|error| npz.failed(error.into()))?;
    let Some(array) = npz.array("joint_roles")? else {
        return Ok(skeleton);
    };
    let roles = array.texts();
    let roles = roles.map_err(|problem| npz.wrong("joint_roles", problem))?;
    let labels = roles.into_iter().enumerate();
    let labels = labels.filter(|(_, role)| !role.is_empty());
    Ok(skeleton.with_labels(labels.map(|(joint, role)| (role, joint))))
}

fn parents(array: &NpyArray) -> Result<Vec<Option<usize>>, ArrayProblem> {
    let mut parents = Vec::new();
    for (joint, value) in array.integers()?.into_iter().enumerate() {
        let is_root =
            value == -1 || value == i64::from(u32::MAX) || Some(value) == array.wrapped_minus_one;
        let parent = usize::try_from(value).ok();
        if parent.is_none() && !is_root {
            return Err(ArrayProblem::Value {
                index: joint,
                value: value as f64,
                expected: "a joint number, or -1 for a root",
            });
        }
        parents.push(parent.filter(|&parent| parent != joint && !is_root));
    }
    Ok(parents)
}

fn rest_pose(npz: &mut NpzFile, num_joints: usize) -> Result<Option<Pose>, FileError> {
    let Some(array) = npz.array("rest_pose")? else {
        return Ok(None);
    };
    let values = array
        .floats()
        .map_err(|problem| npz.wrong("rest_pose", problem))?;
    if values.len() != 3 * num_joints {
        let problem = ArrayProblem::Shape {
            found: array.shape,
            expected: format!("[{num_joints}, 3]"),
        };
        return Err(npz.wrong("rest_pose", problem));
    }
    if values.iter().all(|&value| value == 0.0) {
        return Ok(None);
    }
    let mut pose = Pose::rest(num_joints);
    for (index, row) in values.chunks_exact(3).enumerate() {
        let axis_angle = nalgebra::Vector3::new(row[0], row[1], row[2]);
        let rotation = UnitQuaternion::from_scaled_axis(axis_angle);
        if !rotation.coords.iter().all(|value| value.is_finite()) {
            let problem = ArrayProblem::Value {
                index: 3 * index,
                value: axis_angle.norm(),
                expected: "a finite axis-angle",
            };
            return Err(npz.wrong("rest_pose", problem));
        }
        pose.rotations[index] = rotation.cast();
    }
    Ok(Some(pose))
}

/// Why a rig could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteRigError {
    /// The parts of the rig do not fit together, or there is no rest mesh.
    #[error(transparent)]
    Rig(#[from] SkinError),
    /// The system refuses.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Writes a rig with its rest mesh to an npz archive that [`read_rig_npz`] and `NumPy` read.
///
/// The file appears whole or not at all; the same rig gives the same bytes.
///
/// # Errors
///
/// [`WriteRigError`] if the rig has no rest mesh, its parts do not fit together, or the system
/// refuses.
pub fn write_rig_npz(path: impl AsRef<Path>, rig: &Rig) -> Result<(), WriteRigError> {
    let path = path.as_ref();
    let packed = rig_npz(path, rig)?;
    Ok(write_atomically(path, |writer| writer.write_all(&packed))?)
}

/// The bytes that [`write_rig_npz`] writes into the file `path`.
///
/// # Errors
///
/// [`WriteRigError`] as [`write_rig_npz`].
pub fn rig_npz(path: impl AsRef<Path>, rig: &Rig) -> Result<Vec<u8>, WriteRigError> {
    let mesh = rig.rest.as_ref().ok_or(SkinError::NoRestMesh)?;
    rig.weights.check_joints(&rig.skeleton)?;
    if rig.weights.num_vertices() != mesh.num_vertices() {
        return Err(SkinError::VertexCount {
            weights: rig.weights.num_vertices(),
            mesh: mesh.num_vertices(),
        }
        .into());
    }
    let packed = packed(mesh, rig).map_err(|source| WriteError::Io {
        path: path.as_ref().to_path_buf(),
        source,
    })?;
    Ok(packed)
}

fn packed(mesh: &TriMesh, rig: &Rig) -> io::Result<Vec<u8>> {
    let joints = rig.skeleton.joints();
    let (num_vertices, num_joints) = (mesh.num_vertices(), joints.len());
    let floats = |values: &mut dyn Iterator<Item = f32>| {
        values.flat_map(f32::to_le_bytes).collect::<Vec<u8>>()
    };
    let positions = floats(
        &mut mesh
            .positions()
            .iter()
            .flat_map(|point| <[f32; 3]>::from(point.coords)),
    );
    let corners: Vec<u8> = mesh
        .faces()
        .as_flattened()
        .iter()
        .flat_map(|corner| corner.to_le_bytes())
        .collect();
    let centers = floats(
        &mut joints
            .iter()
            .flat_map(|joint| <[f32; 3]>::from(joint.rest_position.coords)),
    );
    let parent = |joint: &Joint| {
        joint
            .parent
            .map_or(-1, |parent| i32::from(parent as u16))
            .to_le_bytes()
    };
    let parents: Vec<u8> = joints.iter().flat_map(parent).collect();
    let (names_type, names) = texts(joints.iter().map(|joint| joint.name.as_str()));
    let labels = rig.skeleton.labels();
    let role_of = |joint: usize| {
        let mut roles = labels.iter().filter(|(_, labelled)| **labelled == joint);
        roles.next().map_or("", |(role, _)| role.as_str())
    };
    let (roles_type, roles) = texts((0..num_joints).map(role_of));

    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let mut add = |key: &str, descr: &str, shape: &[usize], data: &[u8]| {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default());
        archive.start_file(format!("{key}.npy"), options)?;
        archive.write_all(&npy::encode(descr, shape, data))
    };
    add("vertices", "<f4", &[num_vertices, 3], &positions)?;
    add("faces", "<u4", &[mesh.num_faces(), 3], &corners)?;
    let dense = floats(&mut rig.weights.to_dense().into_iter());
    add("blend_weights", "<f4", &[num_vertices, num_joints], &dense)?;
    add("joints", "<f4", &[num_joints, 3], &centers)?;
    add("parents", "<i4", &[num_joints], &parents)?;
    if let Some(pose) = &rig.rest_pose {
        let axis_angles = pose
            .rotations
            .iter()
            .map(|rotation| Vector3::from(rotation.scaled_axis()));
        let data = floats(&mut axis_angles.flat_map(<[f32; 3]>::from));
        add("rest_pose", "<f4", &[pose.rotations.len(), 3], &data)?;
    }
    add("joint_names", &names_type, &[num_joints], &names)?;
    if !labels.is_empty() {
        add("joint_roles", &roles_type, &[num_joints], &roles)?;
    }
    Ok(archive.finish()?.into_inner())
}

/// Element type and bytes of an array of texts.
fn texts<'a>(texts: impl Iterator<Item = &'a str> + Clone) -> (String, Vec<u8>) {
    let longest = texts.clone().map(|text| text.chars().count()).max();
    let length = longest.unwrap_or(0).max(1);
    let padded = texts.flat_map(|text| {
        let codes = text.chars().map(u32::from).chain(std::iter::repeat(0));
        codes.take(length).flat_map(u32::to_le_bytes)
    });
    (format!("<U{length}"), padded.collect())
}
