//! Inputs and output of a network in one file, for comparison with other implementations.

use std::path::Path;

use garnet_kernel::NeighborTable;
use garnet_mesh::write_atomically;
use safetensors::Dtype;
use safetensors::tensor::TensorView;

use crate::{BodySampling, CheckpointError, GarmentGraph, Scene};

/// A named array on its way into the file.
type Array<'a> = (&'a str, Dtype, Vec<usize>, Vec<u8>);

/// Writes the arrays of a scene and the translations of a network as safetensors.
///
/// `benches/python/garnet_torch.py` reads them. Rings are given as `ring_offsets` and
/// `ring_vertices`, tables as `[row][column]`; arrays that the network does not take are left out.
///
/// # Errors
///
/// [`CheckpointError::Write`] with what the system says.
pub fn write_reference_case(
    path: impl AsRef<Path>,
    garment: &GarmentGraph,
    sampling: &BodySampling,
    scene: &Scene,
    translations: &[f32],
) -> Result<(), CheckpointError> {
    let path = path.as_ref();
    let num_vertices = scene.num_vertices();
    let (mut offsets, mut vertices) = (vec![0_u32], Vec::new());
    for vertex in 0..num_vertices {
        vertices.extend_from_slice(garment.rings().neighbors(vertex));
        offsets.push(vertices.len() as u32);
    }
    let mut arrays = vec![
        numbers("vertices", &scene.vertices, num_vertices),
        numbers("features", &scene.features, num_vertices),
        numbers("body_points", &scene.body_points, sampling.used().len()),
        numbers("body_normals", &scene.body_normals, sampling.used().len()),
        numbers("parameters", &scene.parameters, 1),
        numbers("translations", translations, num_vertices),
        indices("ring_offsets", &offsets, 1),
        indices("ring_vertices", &vertices, 1),
        table("averaged", sampling.averaged()),
    ];
    if let Some(nearest) = &scene.nearest {
        arrays.push(table("nearest", nearest));
    }
    arrays.retain(|(_, _, _, bytes)| !bytes.is_empty());
    let failed = |source| CheckpointError::NotSafetensors {
        path: path.to_path_buf(),
        source,
    };
    let mut views = Vec::new();
    for (name, dtype, shape, bytes) in &arrays {
        let view = TensorView::new(*dtype, shape.clone(), bytes).map_err(failed)?;
        views.push((*name, view));
    }
    let bytes = safetensors::serialize(views, None).map_err(failed)?;
    Ok(write_atomically(path, |writer| writer.write_all(&bytes))?)
}

fn numbers<'a>(name: &'a str, values: &[f32], rows: usize) -> Array<'a> {
    let shape = vec![rows, values.len() / rows.max(1)];
    let bytes = values.iter().flat_map(|value| value.to_le_bytes());
    (name, Dtype::F32, shape, bytes.collect())
}

fn indices<'a>(name: &'a str, values: &[u32], rows: usize) -> Array<'a> {
    let shape = vec![rows, values.len() / rows.max(1)];
    let values = values
        .iter()
        .flat_map(|&value| i64::from(value).to_le_bytes());
    (name, Dtype::I64, shape, values.collect())
}

fn table<'a>(name: &'a str, table: &NeighborTable) -> Array<'a> {
    let rows = (0..table.num_rows()).flat_map(|row| table.neighbors(row).to_vec());
    indices(name, &rows.collect::<Vec<u32>>(), table.num_rows())
}
