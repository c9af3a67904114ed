//! One scene of training: forward, loss, backward.

use burn::optim::GradientsParams;
use burn::tensor::Device;
use garnet_net::losses::LossReport;
use garnet_net::{GarNet, NetError, surrogate};

use crate::gradients;
use crate::subject::{Example, Subject};
use crate::{TrainError, Trouble, TroubleKind};

/// What a scene teaches.
#[derive(Debug)]
pub(crate) struct Lesson {
    /// The terms of the loss.
    pub(crate) report: LossReport,
    /// Derivatives of the loss by the weights, times the share.
    pub(crate) gradients: GradientsParams,
}

/// Runs the network on a scene and derives the loss by its weights; `share` is what the scene
/// counts in the step.
///
/// # Errors
///
/// The inner one is what was not finite, the outer one is for scenes that cannot be used at all.
pub(crate) fn lesson(
    subject: &Subject,
    example: &Example,
    model: &GarNet,
    device: &Device,
    share: f32,
) -> Result<Result<Lesson, Trouble>, TrainError> {
    // Inside the pool, parallel loops need no hand-over of their own.
    rayon::scope(|_| taught(subject, example, model, device, share))
}

/// The work of [`lesson`].
fn taught(
    subject: &Subject,
    example: &Example,
    model: &GarNet,
    device: &Device,
    share: f32,
) -> Result<Result<Lesson, Trouble>, TrainError> {
    let prepared = subject.prepared(example)?;
    let trouble = |kind| {
        Ok(Err(Trouble {
            scene: example.scene,
            kind,
        }))
    };
    let output = model.forward(&example.graph, &subject.sampling, &prepared.scene, device);
    let translations: Vec<f32> =
        (output.to_data().try_into_vec()).expect("networks compute in single precision");
    let predicted = match prepared.scene.moved(&translations) {
        Err(NetError::Diverged { vertex }) => return trouble(TroubleKind::Place { vertex }),
        moved => moved?,
    };
    let report = subject
        .losses
        .evaluate(&predicted, &prepared.target, &prepared.body)?;
    let vertex = report.non_finite_vertex();
    if let Some(term) = report.non_finite_term() {
        return trouble(TroubleKind::Loss { term, vertex });
    }
    if let Some(vertex) = vertex {
        return trouble(TroubleKind::Derivative { vertex });
    }
    let mut gradient = prepared.scene.pulled_back(&report.gradient);
    for value in &mut gradient {
        *value *= share;
    }
    let gradients = GradientsParams::from_grads(surrogate(output, gradient).backward(), model);
    if let Err(name) = gradients::norm(model, &gradients) {
        return trouble(TroubleKind::Weight { name });
    }
    Ok(Ok(Lesson { report, gradients }))
}
