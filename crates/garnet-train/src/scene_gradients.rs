//! One scene of training: forward, loss, backward.

use burn::optim::GradientsParams;
use burn::tensor::Device;
use garnet_net::losses::LossReport;
use garnet_net::{GarNet, NetError, surrogate};

use crate::context::{Example, TrainingContext};
use crate::gradients;
use crate::{TrainError, Trouble, TroubleKind};

/// The loss of a scene and its derivatives.
#[derive(Debug)]
pub(crate) struct SceneGradients {
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
pub(crate) fn scene_gradients(
    context: &TrainingContext,
    example: &Example,
    model: &GarNet,
    device: &Device,
    share: f32,
) -> Result<Result<SceneGradients, Trouble>, TrainError> {
    // Inside the pool, parallel loops need no hand-over of their own.
    rayon::scope(|_| derived(context, example, model, device, share))
}

/// The work of [`scene_gradients`].
fn derived(
    context: &TrainingContext,
    example: &Example,
    model: &GarNet,
    device: &Device,
    share: f32,
) -> Result<Result<SceneGradients, Trouble>, TrainError> {
    let prepared = context.prepared(example)?;
    let trouble = |kind| {
        Ok(Err(Trouble {
            scene: example.scene,
            kind,
        }))
    };
    let output = model.forward(&example.graph, &context.sampling, &prepared.scene, device);
    let translations: Vec<f32> =
        (output.to_data().try_into_vec()).expect("networks compute in single precision");
    let predicted = match prepared.scene.moved(&translations) {
        Err(NetError::Diverged { vertex }) => return trouble(TroubleKind::Place { vertex }),
        moved => moved?,
    };
    let report = context
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
    Ok(Ok(SceneGradients { report, gradients }))
}
