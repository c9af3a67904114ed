//! A smaller network inside a larger one.
//!
//! Channels that the larger one has beyond those of the smaller come last and start at random, but
//! nothing that was there before listens to them yet: weights from new channels to old ones are zero.
//! So the larger network tells what the smaller told, and its new channels learn from there
//! (after *Chen et al. 2016, Net2Net*, where new channels are copies of old ones: such pairs stay
//! alike under Adam unless noise tells them apart).

use burn::module::Param;
use burn::tensor::{Device, Tensor, TensorData};

use super::GarNet;
use crate::{GarNetConfig, NetError};

/// Channels that enter a layer from one place: how many there were, and how many there are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Widened {
    pub(super) from: usize,
    pub(super) to: usize,
}

impl Widened {
    /// Channels that are as they were.
    pub(super) const fn kept(count: usize) -> Self {
        Self {
            from: count,
            to: count,
        }
    }
}

/// Puts a smaller matrix into a larger one, part by part of the rows; new rows give nothing to old columns.
///
/// # Shapes
///
/// - `larger`: `[sum of parts' to, out]`; `smaller`: `[sum of parts' from, at most out]`
pub(super) fn matrix(larger: &mut Param<Tensor<2>>, smaller: &Param<Tensor<2>>, parts: &[Widened]) {
    let ([rows, columns], [old_rows, old_columns]) = (larger.dims(), smaller.dims());
    debug_assert_eq!(rows, parts.iter().map(|part| part.to).sum::<usize>());
    debug_assert_eq!(old_rows, parts.iter().map(|part| part.from).sum::<usize>());
    let (mut values, old) = (numbers(larger.val()), numbers(smaller.val()));
    let mut new_rows = values.chunks_exact_mut(columns.max(1));
    let mut old_rows = old.chunks_exact(old_columns.max(1));
    for part in parts {
        for (number, row) in new_rows.by_ref().take(part.to).enumerate() {
            let heard = &mut row[..old_columns];
            let old = if number < part.from {
                old_rows.next()
            } else {
                None
            };
            match old {
                Some(old) => heard.copy_from_slice(old),
                None => heard.fill(0.0),
            }
        }
    }
    replace(larger, values);
}

/// Puts a shorter row of numbers at the beginning of a longer one.
pub(super) fn vector(longer: &mut Param<Tensor<1>>, shorter: &Param<Tensor<1>>) {
    let (mut values, old) = (numbers(longer.val()), numbers(shorter.val()));
    values[..old.len()].copy_from_slice(&old);
    replace(longer, values);
}

fn numbers<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    let data = tensor.into_data().convert::<f32>();
    data.try_into_vec::<f32>().expect("weights are numbers")
}

/// Other values under the same number, by which an optimizer knows them.
fn replace<const D: usize>(param: &mut Param<Tensor<D>>, values: Vec<f32>) {
    let made = |old: Tensor<D>| {
        let data = TensorData::new(values, old.shape());
        Tensor::from_data(data, &old.device()).set_require_grad(old.is_require_grad())
    };
    *param = param.clone().map(made);
}

impl GarNet {
    /// A larger network that tells what this one tells, with new channels, drawn from a seed, that learn from there.
    ///
    /// The other configuration is of the same garment, and its layers may be wider. It may look at other body points,
    /// too, and pool others; then both tell alike only as far as those do.
    ///
    /// # Errors
    ///
    /// [`NetError::CannotGrow`] with the field that is in the way, or [`NetError::Config`].
    pub fn grown(
        &self,
        config: &GarNetConfig,
        seed: u64,
        device: &Device,
    ) -> Result<Self, NetError> {
        self.config.check_growth(config)?;
        let mut larger = config.init(seed, device)?;
        larger.take_in(self);
        Ok(larger)
    }
}

impl GarNetConfig {
    /// Whether a network of this configuration can become one of another.
    fn check_growth(&self, larger: &Self) -> Result<(), NetError> {
        let alike = [
            ("variant", self.variant == larger.variant),
            ("start", self.start == larger.start),
            ("frame", self.frame == larger.frame),
            ("body.normals", self.body.normals == larger.body.normals),
            (
                "garment.inputs",
                self.garment.inputs == larger.garment.inputs,
            ),
            ("garment.heads", self.garment.heads == larger.garment.heads),
            (
                "garment.convolutions",
                self.garment.convolutions == larger.garment.convolutions,
            ),
            (
                "num_sewing_parameters",
                self.num_sewing_parameters == larger.num_sewing_parameters,
            ),
            (
                "num_body_parameters",
                self.num_body_parameters == larger.num_body_parameters,
            ),
        ];
        if let Some((field, _)) = alike.into_iter().find(|(_, is_alike)| !is_alike) {
            return Err(NetError::CannotGrow {
                field,
                reason: "differs".to_owned(),
            });
        }
        for ((field, from), (_, to)) in self.widths().into_iter().zip(larger.widths()) {
            let pairs = from.iter().zip(&to);
            if from.len() != to.len() || pairs.into_iter().any(|(from, to)| from > to) {
                return Err(NetError::CannotGrow {
                    field,
                    reason: format!("has widths {from:?}, which do not go into {to:?}"),
                });
            }
        }
        if self.shortcuts() != larger.shortcuts() {
            return Err(NetError::CannotGrow {
                field: "garment.blocks",
                reason: "changes its width at other blocks".to_owned(),
            });
        }
        Ok(())
    }

    /// Every width, by field.
    fn widths(&self) -> [(&'static str, Vec<usize>); 13] {
        let (body, garment) = (&self.body, &self.garment);
        [
            ("body.stn.points", body.stn.points.clone()),
            ("body.stn.head", body.stn.head.clone()),
            ("body.first", body.first.clone()),
            ("body.second", body.second.clone()),
            ("body.global", vec![body.global]),
            ("body.parameters", body.parameters.clone()),
            ("garment.stn.points", garment.stn.points.clone()),
            ("garment.stn.head", garment.stn.head.clone()),
            ("garment.points", garment.points.clone()),
            ("garment.input", vec![garment.input]),
            ("garment.blocks", garment.blocks.clone()),
            ("garment.global", vec![garment.global]),
            ("fusion", self.fusion.clone()),
        ]
    }

    /// Which blocks of mesh convolutions change the width.
    fn shortcuts(&self) -> Vec<bool> {
        let blocks = &self.garment.blocks;
        let before = std::iter::once(&self.garment.input).chain(blocks);
        before.zip(blocks).map(|(from, to)| from != to).collect()
    }
}
