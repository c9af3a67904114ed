//! The weights of a network, one by one, on their way into a file and out of it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use burn::module::{ModuleMapper, ModuleVisitor, Param};
use burn::tensor::{DType, Device, Tensor, TensorData, f16};
use safetensors::Dtype;
use safetensors::tensor::TensorView;

use super::Precision;
use crate::CheckpointError;

/// A tensor on its way into a file.
pub(super) struct Stored {
    pub(super) dtype: Dtype,
    pub(super) shape: Vec<usize>,
    pub(super) bytes: Vec<u8>,
    pub(super) is_finite: bool,
}

/// Collects the weights of a network by name.
pub(super) struct Tensors {
    pub(super) precision: Precision,
    pub(super) path: Vec<String>,
    pub(super) found: BTreeMap<String, Stored>,
}

impl ModuleVisitor for Tensors {
    fn enter_module(&mut self, name: &str, _: &str) {
        self.path.push(name.to_owned());
    }

    fn exit_module(&mut self, _: &str, _: &str) {
        self.path.pop();
    }

    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        let tensor = param.val();
        let shape = tensor.dims().to_vec();
        let data = tensor.into_data().convert_dtype(DType::F32);
        let numbers: Vec<f32> = data.try_into_vec().expect("the data was converted to f32");
        let (dtype, bytes, is_finite) = match self.precision {
            Precision::F32 => (
                Dtype::F32,
                numbers
                    .iter()
                    .flat_map(|value| value.to_le_bytes())
                    .collect(),
                numbers.iter().all(|value| value.is_finite()),
            ),
            Precision::F16 => {
                let halves: Vec<f16> = numbers.into_iter().map(f16::from_f32).collect();
                (
                    Dtype::F16,
                    halves
                        .iter()
                        .flat_map(|value| value.to_le_bytes())
                        .collect(),
                    halves.iter().all(|value| value.is_finite()),
                )
            }
        };
        let stored = Stored {
            dtype,
            shape,
            bytes,
            is_finite,
        };
        self.found.insert(self.path.join("."), stored);
    }
}

/// Puts weights from a file into a network.
pub(super) struct Filler<'a> {
    pub(super) file: &'a Path,
    pub(super) device: &'a Device,
    pub(super) numbers: BTreeMap<&'a str, TensorView<'a>>,
    pub(super) path: Vec<String>,
    pub(super) problem: Option<CheckpointError>,
}

impl ModuleMapper for Filler<'_> {
    fn enter_module(&mut self, name: &str, _: &str) {
        self.path.push(name.to_owned());
    }

    fn exit_module(&mut self, _: &str, _: &str) {
        self.path.pop();
    }

    fn map_float<const D: usize>(&mut self, param: Param<Tensor<D>>) -> Param<Tensor<D>> {
        let name = self.path.join(".");
        let shape = param.dims().to_vec();
        let Some(view) = self.numbers.remove(name.as_str()) else {
            return self.refuse(param, name, "missing".to_owned(), format!("{shape:?}"));
        };
        if view.shape() != shape {
            let found = format!("{:?}", view.shape());
            return self.refuse(param, name, found, format!("{shape:?}"));
        }
        let numbers: Vec<f32> = match view.dtype() {
            Dtype::F32 => (view.data().as_chunks::<4>().0.iter())
                .map(|&bytes| f32::from_le_bytes(bytes))
                .collect(),
            Dtype::F16 => (view.data().as_chunks::<2>().0.iter())
                .map(|&bytes| f16::from_le_bytes(bytes).to_f32())
                .collect(),
            other => {
                let found = format!("of type {other:?}");
                return self.refuse(param, name, found, "F32 or F16".to_owned());
            }
        };
        if !numbers.iter().all(|value| value.is_finite()) {
            (self.problem).get_or_insert(CheckpointError::NotFinite { name });
            return param;
        }
        let tensor = Tensor::from_data(TensorData::new(numbers, shape), self.device);
        // A plain device records no derivatives; the parameter remembers that training wants them.
        param.map(|_| tensor.set_require_grad(self.device.is_autodiff()))
    }
}

impl Filler<'_> {
    /// Keeps the first problem.
    fn refuse<P>(&mut self, param: P, name: String, found: String, expected: String) -> P {
        let path: PathBuf = self.file.to_path_buf();
        (self.problem).get_or_insert(CheckpointError::Tensor {
            path,
            name,
            found,
            expected,
        });
        param
    }
}
