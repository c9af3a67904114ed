//! Networks that start from a pose-space deformation.

use std::path::Path;

use faer::Mat;
use garnet_data::Split;
use garnet_net::{GarNetConfig, POSE_SPACE, PoseSpace, Start};

use super::offsets::{bodies, offset_of};
use super::regression::Regression;
use crate::subject::Example;
use crate::{Stage, TrainError};

/// The deformation of a package that a network starts from, if it starts from one.
///
/// # Errors
///
/// [`TrainError::NoStart`] if the package has none, [`TrainError::Checkpoint`] if it cannot be read.
pub(crate) fn start_of(
    package: &Path,
    stage: &Stage,
    network: &GarNetConfig,
) -> Result<Option<PoseSpace>, TrainError> {
    if network.start != Start::PoseSpace {
        return Ok(None);
    }
    let path = package.join(format!("{POSE_SPACE}.safetensors"));
    if !path.is_file() {
        return Err(TrainError::NoStart { path });
    }
    let space = PoseSpace::load(&path)?;
    let (expected, found) = (space.garment, stage.template().graph.fingerprint());
    if expected != found {
        return Err(garnet_net::NetError::OtherGarment { expected, found }.into());
    }
    Ok(Some(space))
}

/// Moves the warps of examples to where a network will find them.
///
/// The deformation knows the drapes that it was fitted to: a network that started from them would learn
/// to mend the errors of a fit, which are half of those that it meets later. Each body of the training is
/// therefore moved as a deformation of all others would move it.
pub(crate) fn start(
    space: &PoseSpace,
    split: Split,
    examples: &mut [Example],
) -> Result<(), TrainError> {
    let left_out = match split {
        Split::Train => Some(left_out(space, examples)?),
        Split::Valid | Split::Test => None,
    };
    for (row, example) in examples.iter_mut().enumerate() {
        let mut shares = space.coefficients(&example.parameters)?;
        if let Some(left_out) = &left_out {
            for (shape, share) in shares.iter_mut().enumerate() {
                *share = left_out[(row, shape)] as f32;
            }
        }
        let warped = &mut example.warped;
        warped.positions = space.moved(&warped.positions, &warped.rotations, &shares)?;
    }
    Ok(())
}

/// The shares `[scene, shape]` that bodies would have if they had been left out of the fit.
fn left_out(space: &PoseSpace, examples: &[Example]) -> Result<Mat<f64>, TrainError> {
    let scaled: Vec<Vec<f32>> = (examples.iter())
        .map(|example| space.scaled(&example.parameters))
        .collect::<Result<_, _>>()?;
    let numbers = scaled.first().map_or(0, Vec::len);
    let places = Mat::from_fn(examples.len(), numbers, |row, column| {
        f64::from(scaled[row][column])
    });
    let parts = space.parts();
    let mut shares = Mat::<f64>::zeros(examples.len(), space.num_shapes());
    for (row, example) in examples.iter().enumerate() {
        let offsets = offset_of(example).zip(&parts.mean);
        let offsets: Vec<f32> = offsets.map(|(offset, mean)| offset - mean).collect();
        let shapes = parts.shapes.chunks_exact(offsets.len().max(1));
        for (column, shape) in shapes.enumerate() {
            let product: f32 = shape.iter().zip(&offsets).map(|(a, b)| a * b).sum();
            shares[(row, column)] = f64::from(product);
        }
    }
    let all: Vec<&Example> = examples.iter().collect();
    let (regression, _) = Regression::surely(&places, &shares, space.ridge);
    Ok(shares - regression.left_out(&bodies(&all)))
}
