//! Models of the SMPL family as rigs: the layout that their npz files share.
//!
//! The shape is `v_template + shapedirs · betas`, and joints stand where `J_regressor` puts them in
//! that shape. Offsets that depend on the pose (`posedirs`) are left out.

use garnet_mesh::TriMesh;
use garnet_skin::{Joint, Point3, Rig, Skeleton, SkinWeights};

use super::{
    ArrayProblem, FileError, FileProblem,
    motion::JOINT_PARENTS,
    npz::NpzFile,
    rig_npz::{faces, required},
    smpl_regressor::{Size, regressor},
};

/// The array by which such a model is known.
pub(super) const TEMPLATE: &str = "v_template";

const REQUIRED: [&str; 4] = [TEMPLATE, "f", "weights", "kintree_table"];

/// Reads a model with the shape `betas`; the mean shape without any.
pub(super) fn read(npz: &mut NpzFile, betas: &[f64]) -> Result<Rig, FileError> {
    npz.require(&REQUIRED)?;
    let mut positions = floats(npz, TEMPLATE, &[None, Some(3)])?;
    let num_vertices = positions.len() / 3;
    add_shape(npz, &mut positions, betas)?;
    let faces = faces(&required(npz, "f", &[None, Some(3)])?);
    let faces = faces.map_err(|problem| npz.wrong("f", problem))?;
    let parents = parents(npz)?;
    let num_joints = parents.len();
    let places = joint_places(npz, &positions, num_joints, betas.is_empty())?;
    let weights = floats(npz, "weights", &[Some(num_vertices), Some(num_joints)])?;
    let weights: Vec<f32> = weights.into_iter().map(|weight| weight as f32).collect();
    let points = positions.chunks_exact(3).map(point).collect();
    let failed = |problem: FileProblem| npz.failed(problem);
    let joints = names(&parents).into_iter().zip(&parents).zip(places);
    let joints = joints.map(|((name, &parent), rest_position)| Joint {
        name,
        parent,
        rest_position,
    });
    Ok(Rig {
        rest: Some(TriMesh::new(points, faces).map_err(|error| failed(error.into()))?),
        skeleton: Skeleton::new(joints.collect()).map_err(|error| failed(error.into()))?,
        weights: SkinWeights::from_dense(num_joints, &weights)
            .map_err(|error| failed(error.into()))?,
        rest_pose: None,
    })
}

fn point(row: &[f64]) -> Point3 {
    Point3::new(row[0] as f32, row[1] as f32, row[2] as f32)
}

fn floats(npz: &mut NpzFile, key: &str, shape: &[Option<usize>]) -> Result<Vec<f64>, FileError> {
    let values = required(npz, key, shape)?.floats();
    values.map_err(|problem| npz.wrong(key, problem))
}

fn add_shape(npz: &mut NpzFile, positions: &mut [f64], betas: &[f64]) -> Result<(), FileError> {
    if betas.is_empty() {
        return Ok(());
    }
    let is_wrong = |beta: &f64| !(*beta as f32).is_finite();
    if let Some(number) = betas.iter().position(is_wrong) {
        return Err(npz.failed(FileProblem::Field {
            field: format!("betas[{number}]"),
            found: betas[number].to_string(),
            expected: "a finite number",
        }));
    }
    let array = npz.array("shapedirs")?;
    let found = match array.as_ref().map(|array| array.shape.as_slice()) {
        Some(&[vertices, 3, found]) if 3 * vertices == positions.len() => found,
        None => 0,
        Some(shape) => {
            let problem = ArrayProblem::Shape {
                found: shape.to_vec(),
                expected: format!("[{}, 3, _]", positions.len() / 3),
            };
            return Err(npz.wrong("shapedirs", problem));
        }
    };
    let asked = betas.len();
    let Some(array) = array.filter(|_| asked <= found) else {
        return Err(npz.failed(FileProblem::NoBetas { found, asked }));
    };
    let directions = array.floats();
    let directions = directions.map_err(|problem| npz.wrong("shapedirs", problem))?;
    for (value, row) in positions.iter_mut().zip(directions.chunks_exact(found)) {
        let offset: f64 = row.iter().zip(betas).map(|(row, beta)| row * beta).sum();
        *value += offset;
    }
    Ok(())
}

/// Parents out of `kintree_table` `[2, J]`: the parent of each joint, and its own number.
fn parents(npz: &mut NpzFile) -> Result<Vec<Option<usize>>, FileError> {
    let table = required(npz, "kintree_table", &[Some(2), None])?;
    let num_joints = table.shape[1];
    let values = table.integers();
    let values = values.map_err(|problem| npz.wrong("kintree_table", problem))?;
    let (parents, numbers) = values.split_at(num_joints);
    let place = |number: i64| numbers.iter().position(|&other| other == number);
    let parent = |(joint, &parent): (usize, &i64)| place(parent).filter(|&parent| parent != joint);
    Ok(parents.iter().enumerate().map(parent).collect())
}

/// Where joints stand: by the regressor, dense or sparse, or as `J` says for the mean shape.
fn joint_places(
    npz: &mut NpzFile,
    positions: &[f64],
    num_joints: usize,
    is_mean: bool,
) -> Result<Vec<Point3>, FileError> {
    let num_vertices = positions.len() / 3;
    let size = Size {
        joints: num_joints,
        vertices: num_vertices,
    };
    let regressor = match regressor(npz, size) {
        Ok(found) => found,
        // The joints of the mean shape stand beside a regressor that cannot be read.
        Err(_) if is_mean && npz.keys().iter().any(|key| key == "J") => None,
        Err(error) => return Err(error),
    };
    let Some(entries) = regressor else {
        if is_mean && npz.keys().iter().any(|key| key == "J") {
            let places = floats(npz, "J", &[Some(num_joints), Some(3)])?;
            return Ok(places.chunks_exact(3).map(point).collect());
        }
        npz.require(&["J_regressor"])?;
        return Err(npz.failed(FileProblem::UnknownFormat));
    };
    let mut places = vec![0.0; 3 * num_joints];
    for (joint, vertex, weight) in entries {
        for axis in 0..3 {
            places[3 * joint + axis] += weight * positions[3 * vertex + axis];
        }
    }
    Ok(places.chunks_exact(3).map(point).collect())
}

/// The names of the joints: those of the family for its tree, else numbers.
fn names(parents: &[Option<usize>]) -> Vec<String> {
    let is_family = parents.len() >= JOINT_PARENTS.len()
        && JOINT_PARENTS
            .iter()
            .zip(parents)
            .all(|((_, expected), found)| expected == found);
    let name = |joint: usize| match JOINT_PARENTS.get(joint).filter(|_| is_family) {
        Some((name, _)) => (*name).to_owned(),
        None => format!("joint_{joint}"),
    };
    (0..parents.len()).map(name).collect()
}
