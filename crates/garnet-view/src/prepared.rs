//! Layers with everything that is the same in all views.

use garnet_mesh::Vector3;
use rayon::prelude::*;

use crate::{
    ColorMap, FaceMaterials, Heat, Layer, Paint, Picture, ViewError, normals, palette, rgb::Light,
};

/// Steps of a color table: finer than 8 bits a channel can tell.
const TABLE_STEPS: usize = 1024;

/// A layer that has been checked.
#[derive(Debug)]
pub(crate) struct Prepared<'a> {
    pub(crate) layer: &'a Layer<'a>,
    /// Unit normals `[vertex]`.
    pub(crate) normals: Vec<Vector3>,
    pub(crate) coat: Coat<'a>,
    /// From 0 to 1.
    pub(crate) opacity: f32,
}

/// The paint of a layer, ready to be looked up.
#[derive(Debug)]
pub(crate) enum Coat<'a> {
    Plain(Light),
    Heat(Scale<'a>),
    Materials(&'a FaceMaterials),
}

/// Values and the colors that stand for them.
#[derive(Debug)]
pub(crate) struct Scale<'a> {
    pub(crate) values: &'a [f32],
    pub(crate) legend: Legend<'a>,
    table: Vec<Light>,
}

/// What a color bar tells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Legend<'a> {
    pub(crate) map: ColorMap,
    pub(crate) low: f32,
    pub(crate) high: f32,
    pub(crate) label: &'a str,
}

impl Scale<'_> {
    /// Whether values stand for kinds, which do not blend into each other.
    pub(crate) fn has_kinds(&self) -> bool {
        self.legend.map == ColorMap::Problems
    }

    /// The color of a value.
    pub(crate) fn light(&self, value: f64) -> Light {
        let (low, high) = (f64::from(self.legend.low), f64::from(self.legend.high));
        let position = ((value - low) / (high - low)).clamp(0.0, 1.0);
        if !value.is_finite() || position.is_nan() {
            return palette::NON_FINITE.to_light();
        }
        let last = self.table.len() - 1;
        self.table[nearest_index(position * last as f64).min(last)]
    }
}

#[expect(clippy::cast_sign_loss, reason = "a float cast saturates at zero")]
fn nearest_index(value: f64) -> usize {
    (value + 0.5) as usize
}

/// Checks and prepares all layers of a picture.
pub(crate) fn prepared<'a>(picture: &'a Picture<'a>) -> Result<Vec<Prepared<'a>>, ViewError> {
    picture
        .layers
        .par_iter()
        .enumerate()
        .map(|(index, layer)| {
            let coat = match &layer.paint {
                Paint::Plain(color) => Coat::Plain(color.to_light()),
                Paint::Heat(heat) => Coat::Heat(scale(heat, index, layer.mesh.num_vertices())?),
                Paint::Materials(materials) => {
                    Coat::Materials(fitting(materials, index, layer.mesh.num_faces())?)
                }
            };
            Ok(Prepared {
                layer,
                normals: normals::vertex_normals(layer.mesh),
                coat,
                opacity: if layer.opacity.is_nan() {
                    1.0
                } else {
                    layer.opacity.clamp(0.0, 1.0)
                },
            })
        })
        .collect::<Vec<_>>()
        .into_iter()
        .collect()
}

fn scale<'a>(heat: &'a Heat<'a>, layer: usize, expected: usize) -> Result<Scale<'a>, ViewError> {
    let found = heat.values.len();
    if found != expected {
        return Err(ViewError::ValueCount {
            layer,
            found,
            expected,
        });
    }
    let [low, high] = match heat.range {
        Some([low, high]) if low.is_finite() && high.is_finite() && low < high => [low, high],
        Some([low, high]) => return Err(ViewError::ValueRange { layer, low, high }),
        None => range_of(heat.values, heat.map),
    };
    Ok(Scale {
        values: heat.values,
        legend: Legend {
            map: heat.map,
            low,
            high,
            label: &heat.label,
        },
        table: heat.map.table(TABLE_STEPS),
    })
}

fn fitting(
    materials: &FaceMaterials,
    layer: usize,
    expected: usize,
) -> Result<&FaceMaterials, ViewError> {
    let count = materials.materials.len();
    let found = [materials.of_face.len(), materials.corners.len()];
    let is_known = materials
        .of_face
        .iter()
        .all(|&material| (material as usize) < count);
    if found == [expected; 2] && is_known {
        return Ok(materials);
    }
    let found = found.into_iter().find(|&found| found != expected);
    Err(ViewError::FaceMaterials {
        layer,
        found: found.unwrap_or(expected),
        expected,
    })
}

/// The range that shows all finite values; one without width is widened.
pub(crate) fn range_of(values: &[f32], map: ColorMap) -> [f32; 2] {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let [low, high] = match map {
        ColorMap::Viridis => [
            finite().reduce(f32::min).unwrap_or(0.0),
            finite().reduce(f32::max).unwrap_or(0.0),
        ],
        ColorMap::CoolWarm => {
            let most = finite().map(f32::abs).reduce(f32::max).unwrap_or(0.0);
            [-most, most]
        }
        ColorMap::Fit => [0.0, map.kinds().len() as f32],
        ColorMap::Problems => [0.0, (map.points().len() - 1) as f32],
    };
    if low < high {
        return [low, high];
    }
    match map {
        ColorMap::Viridis => [low, (low + low.abs().max(1.0)).min(f32::MAX)],
        ColorMap::CoolWarm | ColorMap::Fit | ColorMap::Problems => [-1.0, 1.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_automatic_range_covers_the_finite_values() {
        let values = [0.5, f32::NAN, -2.0, f32::INFINITY, 1.0];
        let is_exactly = |range: [f32; 2], expected: [f32; 2]| {
            assert_eq!(range.map(f32::to_bits), expected.map(f32::to_bits));
        };
        is_exactly(range_of(&values, ColorMap::Viridis), [-2.0, 1.0]);
        is_exactly(range_of(&values, ColorMap::CoolWarm), [-2.0, 2.0]);
        is_exactly(range_of(&[f32::NAN], ColorMap::Viridis), [0.0, 1.0]);
    }
}
