//! Models of the SMPL family as rigs: the layout that their npz files share.
//!
//! The shape is `v_template + shapedirs · betas`, and joints stand where `J_regressor` puts them in
//! that shape. Offsets that depend on the pose (`posedirs`) are left out.

use garnet_mesh::TriMesh;
use garnet_skin::{Joint, Point3, Rig, Skeleton, SkinWeights};

use super::{
    ArrayProblem, FileError, FileProblem,
    motion::JOINT_PARENTS,
    npy::NpyArray,
    npz::NpzFile,
    rig_npz::{faces, required},
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
    let array = unpickled(npz, key)?;
    if array.is_none() {
        npz.require(&[key])?;
    }
    let values = required(npz, key, shape)?.floats();
    values.map_err(|problem| npz.wrong(key, problem))
}

/// The array of a key; one that is an object of Python is told so.
fn unpickled(npz: &mut NpzFile, key: &str) -> Result<Option<NpyArray>, FileError> {
    npz.array(key).map_err(|error| match error.problem {
        FileProblem::Array {
            key,
            problem: ArrayProblem::ElementType { descr },
        } if descr.contains('O') => npz.failed(FileProblem::Pickled { key }),
        problem => npz.failed(problem),
    })
}

fn add_shape(npz: &mut NpzFile, positions: &mut [f64], betas: &[f64]) -> Result<(), FileError> {
    if betas.is_empty() {
        return Ok(());
    }
    let array = unpickled(npz, "shapedirs")?;
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
    let regressor = match regressor(npz, num_joints, num_vertices) {
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

/// Joint, vertex and weight.
type Entry = (usize, usize, f64);

/// The entries of the regressor: a dense array, rows of joint, vertex and weight, or the parts of a
/// sparse matrix beside each other (`J_regressor_data` and so on, as rows or in `scipy`'s CSR).
fn regressor(
    npz: &mut NpzFile,
    num_joints: usize,
    num_vertices: usize,
) -> Result<Option<Vec<Entry>>, FileError> {
    if let Some(array) = unpickled(npz, "J_regressor")? {
        let values = array.floats();
        let values = values.map_err(|problem| npz.wrong("J_regressor", problem))?;
        return match *array.shape.as_slice() {
            [rows, columns] if rows == num_joints && columns == num_vertices => {
                let entries = values.into_iter().enumerate();
                let entries = entries.filter(|&(_, weight)| weight != 0.0);
                let place = |index: usize| (index / num_vertices, index % num_vertices);
                Ok(Some(
                    entries
                        .map(|(index, weight)| (place(index).0, place(index).1, weight))
                        .collect(),
                ))
            }
            [_, 3] => {
                let rows = values.chunks_exact(3);
                let entries = rows.map(|row| (row[0], row[1], row[2]));
                checked(npz, entries.collect(), num_joints, num_vertices).map(Some)
            }
            _ => Err(npz.wrong(
                "J_regressor",
                ArrayProblem::Shape {
                    found: array.shape.clone(),
                    expected: format!("[{num_joints}, {num_vertices}]"),
                },
            )),
        };
    }
    let mut part = |name: &str| -> Result<Option<Vec<f64>>, FileError> {
        for separator in ["_", "."] {
            let key = format!("J_regressor{separator}{name}");
            if let Some(array) = npz.array(&key)? {
                let values = array.floats();
                return values.map(Some).map_err(|problem| npz.wrong(&key, problem));
            }
        }
        Ok(None)
    };
    let Some(weights) = part("data")? else {
        return Ok(None);
    };
    let (rows, columns) = (part("row")?, part("col")?);
    let (starts, indices) = (part("indptr")?, part("indices")?);
    let entries: Vec<(f64, f64, f64)> = match (rows, columns, starts, indices) {
        (Some(rows), Some(columns), _, _) => {
            let places = rows.into_iter().zip(columns).zip(weights);
            places
                .map(|((row, column), weight)| (row, column, weight))
                .collect()
        }
        (_, _, Some(starts), Some(indices)) => {
            let entries = indices.into_iter().zip(weights).enumerate();
            let row = |entry: usize| {
                let before = starts
                    .iter()
                    .filter(|&&start| start <= entry as f64)
                    .count();
                before as f64 - 1.0
            };
            entries
                .map(|(entry, (column, weight))| (row(entry), column, weight))
                .collect()
        }
        _ => return Ok(None),
    };
    checked(npz, entries, num_joints, num_vertices).map(Some)
}

fn checked(
    npz: &NpzFile,
    entries: Vec<(f64, f64, f64)>,
    num_joints: usize,
    num_vertices: usize,
) -> Result<Vec<Entry>, FileError> {
    let mut checked = Vec::with_capacity(entries.len());
    for (index, (row, column, weight)) in entries.into_iter().enumerate() {
        for (value, count) in [(row, num_joints), (column, num_vertices)] {
            if !(value >= 0.0 && value < count as f64) {
                let expected = "the number of a joint or a vertex";
                let problem = ArrayProblem::Value {
                    index,
                    value,
                    expected,
                };
                return Err(npz.wrong("J_regressor", problem));
            }
        }
        checked.push((whole(row), whole(column), weight));
    }
    Ok(checked)
}

#[expect(clippy::cast_sign_loss, reason = "the range is checked")]
fn whole(value: f64) -> usize {
    value as usize
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
