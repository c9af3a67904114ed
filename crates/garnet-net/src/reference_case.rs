//! Inputs and output of a model in one file, for other implementations.

use std::collections::HashMap;
use std::path::Path;

use garnet_mesh::{Point3, write_atomically};
use safetensors::Dtype;
use safetensors::tensor::TensorView;

use crate::{CheckpointError, SceneInput};

/// A named array.
#[derive(Debug, Clone, PartialEq)]
struct Array {
    name: &'static str,
    dtype: Dtype,
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

/// What a model is told of a scene, and what it says: named arrays, as
/// `docs/reference/formats.md` has them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReferenceCase {
    arrays: Vec<Array>,
}

impl ReferenceCase {
    /// What a scene brings, whatever the model asks for.
    pub(crate) fn of_input(input: &SceneInput<'_>) -> Self {
        let mut case = Self::default();
        case.points("input.warped", input.warped);
        let turns = input
            .rotations
            .iter()
            .flat_map(|turn| turn.coords.data.0[0]);
        case.numbers("input.rotations", &turns.collect::<Vec<f32>>(), 4);
        case.row("input.parameters", input.parameters);
        case.points("input.body", input.body);
        let normals = input.body_normals.iter().flat_map(|n| [n.x, n.y, n.z]);
        case.numbers("input.body_normals", &normals.collect::<Vec<f32>>(), 3);
        let matrix = input.world_from_root.to_homogeneous().transpose();
        case.numbers("input.world_from_root", matrix.as_slice(), 4);
        case
    }

    /// Numbers in rows of so many; none are left out.
    pub(crate) fn numbers(&mut self, name: &'static str, values: &[f32], columns: usize) {
        let bytes = values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        let shape = vec![values.len() / columns.max(1), columns];
        self.push(name, Dtype::F32, shape, bytes);
    }

    /// Numbers in one row; none are left out.
    pub(crate) fn row(&mut self, name: &'static str, values: &[f32]) {
        self.numbers(name, values, values.len());
    }

    pub(crate) fn points(&mut self, name: &'static str, points: &[Point3]) {
        let values = points.iter().flat_map(|p| [p.x, p.y, p.z]);
        self.numbers(name, &values.collect::<Vec<f32>>(), 3);
    }

    /// Vertex numbers in rows of so many; none are left out.
    #[cfg(feature = "burn")]
    pub(crate) fn indices(&mut self, name: &'static str, values: &[u32], columns: usize) {
        let wide = values.iter().map(|&value| i64::from(value).to_le_bytes());
        let shape = vec![values.len() / columns.max(1), columns];
        self.push(name, Dtype::I64, shape, wide.flatten().collect());
    }

    fn push(&mut self, name: &'static str, dtype: Dtype, shape: Vec<usize>, bytes: Vec<u8>) {
        if !bytes.is_empty() {
            self.arrays.push(Array {
                name,
                dtype,
                shape,
                bytes,
            });
        }
    }

    /// Writes the arrays as safetensors, whole or not at all, with a text under the key `garnet`.
    ///
    /// # Errors
    ///
    /// [`CheckpointError::Write`] with what the system says.
    pub fn write(&self, path: impl AsRef<Path>, text: &str) -> Result<(), CheckpointError> {
        let path = path.as_ref();
        let failed = |source| CheckpointError::NotSafetensors {
            path: path.to_path_buf(),
            source,
        };
        let mut views = Vec::new();
        for array in &self.arrays {
            let view = TensorView::new(array.dtype, array.shape.clone(), &array.bytes);
            views.push((array.name, view.map_err(failed)?));
        }
        let text = HashMap::from([("garnet".to_owned(), text.to_owned())]);
        let bytes = safetensors::serialize(views, Some(text)).map_err(failed)?;
        Ok(write_atomically(path, |writer| writer.write_all(&bytes))?)
    }
}

#[cfg(test)]
mod tests {
    use garnet_mesh::Vector3;
    use nalgebra::{Isometry3, UnitQuaternion};
    use safetensors::SafeTensors;

    use super::*;

    #[test]
    fn arrays_come_back_with_their_shapes() {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.3);
        let input = SceneInput {
            warped: &[Point3::new(1.0, 2.0, 3.0), Point3::origin()],
            body: &[Point3::origin()],
            body_normals: &[],
            world_from_root: Isometry3::translation(4.0, 5.0, 6.0),
            rotations: &[turn, turn],
            parameters: &[0.5, 0.25],
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("case.safetensors");
        ReferenceCase::of_input(&input).write(&path, "{}").unwrap();
        let bytes = std::fs::read(path).unwrap();
        let tensors = SafeTensors::deserialize(&bytes).unwrap();
        let read = |name: &str| {
            let view = tensors.tensor(name).unwrap();
            let numbers = view.data().as_chunks().0.iter();
            let numbers: Vec<f32> = numbers.map(|&bytes| f32::from_le_bytes(bytes)).collect();
            (view.shape().to_vec(), numbers)
        };
        assert_eq!(read("input.warped").0, [2, 3]);
        let (shape, turns) = read("input.rotations");
        assert_eq!((shape, turns[2]), (vec![2, 4], turn.k));
        assert_eq!(read("input.parameters"), (vec![1, 2], vec![0.5, 0.25]));
        // Row after row: the place is the last column.
        assert_eq!(read("input.world_from_root").1[..4], [1.0, 0.0, 0.0, 4.0]);
        assert!(tensors.tensor("input.body_normals").is_err());
    }
}
