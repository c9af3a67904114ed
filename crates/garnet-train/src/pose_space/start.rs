//! Networks that start from a pose-space deformation.

use std::path::Path;

use faer::Mat;
use garnet_data::Split;
use garnet_net::pose_space::deformation_name;
use garnet_net::{GarNetConfig, Moment, PoseSpace};
use rayon::prelude::*;

use super::mirror::GarmentMirror;
use super::offsets::halves;
use super::regression::{Places, Regression};
use super::scenes::left_out_with;
use super::starts::Starts;
use crate::context::Example;
use crate::{Stage, TrainError, training_folder};

/// A deformation that networks start from.
pub(crate) struct Beginning {
    pub(crate) space: PoseSpace,
    /// What it would have told scenes of the training that it had not seen; none if it has not been
    /// found out.
    starts: Option<Starts>,
}

impl Beginning {
    /// Of a deformation that is to tell no scenes of the training.
    pub(super) const fn of(space: PoseSpace) -> Self {
        let starts = None;
        Self { space, starts }
    }
}

/// The deformation of a package that a network starts from, if it starts from one.
///
/// # Errors
///
/// [`TrainError::NoStart`] if the package has none, [`TrainError::Checkpoint`] if it cannot be
/// read, [`TrainError::Starts`] if what is beside it is damaged.
pub(crate) fn start_of(
    package: &Path,
    stage: &Stage,
    network: &GarNetConfig,
) -> Result<Option<Beginning>, TrainError> {
    stage.check_moment(Moment::Rest)?;
    let Some(moment) = network.start.deformation() else {
        return Ok(None);
    };
    let name = deformation_name(moment);
    let path = package.join(format!("{name}.safetensors"));
    if !path.is_file() {
        return Err(TrainError::NoStart { path, name });
    }
    let space = PoseSpace::load(&path)?;
    let (expected, found) = (space.garment, stage.template().graph.fingerprint());
    if expected != found {
        return Err(garnet_net::NetError::OtherGarment { expected, found }.into());
    }
    let starts = Starts::load(&training_folder(package, name), &space)?;
    Ok(Some(Beginning { space, starts }))
}

/// Moves the warps of examples to where a network will find them.
///
/// The deformation knows the drapes that it was fitted to: a network that started from them would
/// learn to mend the errors of a fit, which are half of those that it meets later. Each scene of
/// the training is therefore moved as a deformation would move it that knows neither its body nor
/// its sequence of poses.
pub(crate) fn start(
    beginning: &Beginning,
    stage: &Stage,
    split: Split,
    examples: &mut [Example],
) -> Result<(), TrainError> {
    let Beginning { space, starts } = beginning;
    let all = match (split, space.regions(), starts) {
        (Split::Valid | Split::Test, ..) => {
            let shares = (examples.iter())
                .map(|example| space.coefficients(&example.parameters, example.graph.cut()));
            shares.collect::<Result<_, _>>()?
        }
        (Split::Train, None, _) => left_out(space, stage, examples)?,
        (Split::Train, Some(_), Some(starts)) => known(space, stage, starts, examples)?,
        (Split::Train, Some(_), None) => return Err(cannot_leave_out(space)),
    };
    for (example, shares) in examples.iter_mut().zip(all) {
        let warped = &mut example.warped;
        warped.positions = space.moved(&warped.positions, &warped.rotations, &shares)?;
    }
    Ok(())
}

fn cannot_leave_out(space: &PoseSpace) -> TrainError {
    let name = space.record["variant"].as_str().unwrap_or_default();
    TrainError::CannotLeaveOut {
        name: name.to_owned(),
    }
}

/// The shares `[scene][shape]` that were found out when the deformation was fitted.
fn known(
    space: &PoseSpace,
    stage: &Stage,
    starts: &Starts,
    examples: &[Example],
) -> Result<Vec<Vec<f32>>, TrainError> {
    // Scenes of another data set may have the same numbers.
    let dataset = stage.dataset.manifest.fingerprint().to_string();
    if space.record["dataset"].as_str() != Some(&dataset) {
        return Err(cannot_leave_out(space));
    }
    let of_scene = |example: &Example| starts.of_scene(example.scene).map(<[f32]>::to_vec);
    let all: Option<Vec<Vec<f32>>> = examples.iter().map(of_scene).collect();
    all.ok_or_else(|| cannot_leave_out(space))
}

/// The shares `[scene][shape]` that scenes would have if their bodies and sequences had been left
/// out of the fit.
fn left_out(
    space: &PoseSpace,
    stage: &Stage,
    examples: &[Example],
) -> Result<Vec<Vec<f32>>, TrainError> {
    let parts = space.parts().ok_or_else(|| cannot_leave_out(space))?;
    let places = |numbers: &dyn Fn(&Example) -> Vec<f32>| -> Result<Mat<f64>, TrainError> {
        let scaled: Vec<Vec<f32>> = (examples.iter())
            .map(|example| parts.scaled(&numbers(example)))
            .collect::<Result<_, _>>()?;
        let numbers = scaled.first().map_or(0, Vec::len);
        Ok(Mat::from_fn(examples.len(), numbers, |row, column| {
            f64::from(scaled[row][column])
        }))
    };
    let places = Places {
        own: places(&|example| example.parameters.clone())?,
        mirrored: match &parts.mirror {
            Some(mirror) => Some(places(&|example| mirror.numbers.of(&example.parameters))?),
            None => None,
        },
    };
    let mirror = parts.mirror.as_ref().and_then(|_| GarmentMirror::of(stage));
    let parity = match &parts.mirror {
        Some(mirror) => mirror.parity.clone(),
        None => vec![1.0; space.num_shapes()],
    };
    let shares_of = |example: &Example| -> Vec<f64> {
        let (mut even, odd) = halves(example, mirror.as_ref());
        for (offset, mean) in even.iter_mut().zip(&parts.mean) {
            *offset -= mean;
        }
        let shapes = parts.shapes.chunks_exact(parts.mean.len().max(1));
        let share = |(shape, &parity): (&[f32], &f32)| {
            let half = if parity < 0.0 { &odd } else { &even };
            let product: f32 = shape.iter().zip(half).map(|(a, b)| a * b).sum();
            f64::from(product)
        };
        shapes.zip(&parity).map(share).collect()
    };
    let rows: Vec<Vec<f64>> = examples.par_iter().map(shares_of).collect();
    let shares = Mat::from_fn(rows.len(), space.num_shapes(), |row, shape| {
        rows[row][shape]
    });
    let all: Vec<&Example> = examples.iter().collect();
    let (regression, _) = Regression::surely(&places, &shares, &parity, space.ridge);
    let told = shares - regression.left_out(&left_out_with(&all));
    let row = |row: usize| (0..told.ncols()).map(move |shape| (row, shape));
    let rows = (0..told.nrows()).map(|number| row(number).map(|at| told[at] as f32).collect());
    Ok(rows.collect())
}
