//! Derivatives by the weights of a network: their length, and whether they are numbers at all.

use burn::module::{Module, ModuleVisitor, Param};
use burn::optim::GradientsParams;
use burn::tensor::Tensor;
use garnet_net::GarNet;

/// Adam keeps squares of derivatives in single precision: larger ones overflow and stop a weight
/// for good.
const MAX_DERIVATIVE: f32 = 1e18;

/// The norm of the derivatives by all weights.
///
/// # Errors
///
/// The name of the first tensor with a derivative that is not finite, or whose square is not.
pub(crate) fn norm(model: &GarNet, gradients: &GradientsParams) -> Result<f64, String> {
    let mut visitor = Norm {
        gradients,
        path: Vec::new(),
        squared: 0.0,
        not_finite: None,
    };
    model.visit(&mut visitor);
    match visitor.not_finite {
        None => Ok(visitor.squared.sqrt()),
        Some(name) => Err(name),
    }
}

/// The derivatives times a factor.
pub(crate) fn scaled(
    model: &GarNet,
    mut gradients: GradientsParams,
    factor: f64,
) -> GradientsParams {
    let mut visitor = Scaled {
        gradients: &mut gradients,
        factor,
    };
    model.visit(&mut visitor);
    gradients
}

struct Norm<'a> {
    gradients: &'a GradientsParams,
    path: Vec<String>,
    squared: f64,
    not_finite: Option<String>,
}

impl ModuleVisitor for Norm<'_> {
    fn enter_module(&mut self, name: &str, _: &str) {
        self.path.push(name.to_owned());
    }

    fn exit_module(&mut self, _: &str, _: &str) {
        self.path.pop();
    }

    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        let Some(gradient) = self.gradients.get::<D>(param.id) else {
            return;
        };
        let numbers: Vec<f32> =
            (gradient.into_data().try_into_vec()).expect("weights are of single precision");
        let squared: f64 = numbers
            .iter()
            .map(|&number| f64::from(number).powi(2))
            .sum();
        let is_usable = numbers.iter().all(|number| number.abs() < MAX_DERIVATIVE);
        if !is_usable && self.not_finite.is_none() {
            self.not_finite = Some(self.path.join("."));
        }
        self.squared += squared;
    }
}

struct Scaled<'a> {
    gradients: &'a mut GradientsParams,
    factor: f64,
}

impl ModuleVisitor for Scaled<'_> {
    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        if let Some(gradient) = self.gradients.remove::<D>(param.id) {
            self.gradients
                .register::<D>(param.id, gradient * self.factor);
        }
    }
}
