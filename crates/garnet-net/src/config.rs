//! What a network is made of: every width, head, block and neighbor count.
//!
//! The paper publishes few of these numbers, so all of them are
//! values of a configuration, which weight files carry. [`GarNetConfig::preset`] names usable sets.

use garnet_sim::Moment;
use garnet_skin::Warp;
use serde::{Deserialize, Serialize};

use crate::NetError;

/// The length unit of the network and its losses, in metres.
///
/// With it the paper's loss weights keep their sense: in metres a squared vertex distance would be
/// 1e-5 beside edge lengths of 1e-2.
pub const UNIT: f32 = 0.1;

/// Which parts of the paper's figure 2 a network has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Variant {
    /// Point-wise and max-pooled features only: no mesh convolutions, no local pooling.
    Naive,
    /// Mesh convolutions; the body is seen through its global features alone.
    Global,
    /// As [`Variant::Global`], and each vertex pools the features of its nearest body points.
    Local,
    /// As [`Variant::Global`], with parameters of shape and pose in place of the body stream.
    GlobalParams,
    /// As [`Variant::Local`], with parameters of shape and pose beside the body stream; not in the
    /// paper.
    LocalParams,
}

/// The frame in which translations are predicted and offsets are fed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Frame {
    /// That of the root joint (the pelvis), as in the paper.
    Root,
    /// That of each vertex: its blended skinning rotation.
    Skin,
}

/// How the garment M was brought to the target body before the network sees it.
///
/// The network does not do it; whoever uses a model has to do it in the same way as in training.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// Dual-quaternion skinning, as in the paper: pose only.
    DualQuaternion,
    /// Dual-quaternion skinning and the change of the body's shape.
    Shape,
    /// As [`Start::Shape`], moved by the pose-space deformation that predicts where the garment
    /// rests; not in the paper.
    PoseSpace,
}

impl Start {
    /// The warp of the garment.
    pub const fn warp(self) -> Warp {
        match self {
            Self::DualQuaternion => Warp::DualQuaternion,
            Self::Shape | Self::PoseSpace => Warp::Shape,
        }
    }

    /// The moment that a pose-space deformation predicts which moves the warped garment, if one
    /// does.
    pub const fn deformation(self) -> Option<Moment> {
        match self {
            Self::DualQuaternion | Self::Shape => None,
            Self::PoseSpace => Some(Moment::Rest),
        }
    }
}

/// What a garment vertex brings along, besides its place, into the first layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VertexInput {
    /// Its place on the template, 3 numbers in units.
    Template,
    /// From the nearest body point to the vertex, in the frame of prediction; 3 numbers in units.
    BodyOffset,
    /// The normal of the nearest body point, in the frame of prediction; 3 numbers.
    BodyNormal,
    /// The first two columns of its skinning rotation, seen from the root; 6 numbers.
    Rotation,
    /// Where down is, in the frame of prediction; 3 numbers. The root frame turns with the pelvis,
    /// and cloth hangs down however the wearer leans.
    Down,
}

impl VertexInput {
    /// How many numbers it is.
    pub const fn width(self) -> usize {
        match self {
            Self::Template | Self::BodyOffset | Self::BodyNormal | Self::Down => 3,
            Self::Rotation => 6,
        }
    }
}

/// Widths of a spatial transformer: a point-wise part, max-pooling, and a head.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StnConfig {
    /// Of the layers before pooling.
    pub points: Vec<usize>,
    /// Of the layers after pooling; the 9 numbers of the matrix follow.
    pub head: Vec<usize>,
}

/// Widths of the body stream.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyStreamConfig {
    /// The transformer of the points.
    pub stn: StnConfig,
    /// The first MLP block.
    pub first: Vec<usize>,
    /// The second MLP block, fed with the first one and the transformer's output; it ends in the
    /// point-wise features.
    pub second: Vec<usize>,
    /// Global features, max-pooled over the points.
    pub global: usize,
    /// Whether points bring their normals along.
    pub normals: bool,
    /// Body points that are looked at, spread evenly; 0 for all.
    pub points: usize,
    /// Body points farther from the template than this at rest are left out, in metres; 0 keeps
    /// all.
    pub reach: f32,
    /// Layers from parameters to global features, of the variants that have them.
    pub parameters: Vec<usize>,
}

/// Widths of the garment stream.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GarmentStreamConfig {
    /// The transformer of the vertices.
    pub stn: StnConfig,
    /// The point-wise MLP.
    pub points: Vec<usize>,
    /// The layer that takes point-wise features and global body features.
    pub input: usize,
    /// Output width of each residual block of mesh convolutions.
    pub blocks: Vec<usize>,
    /// Convolutions in a block.
    pub convolutions: usize,
    /// Weight matrices of a convolution (M in FeaStNet).
    pub heads: usize,
    /// Global features, max-pooled over the vertices.
    pub global: usize,
    /// What vertices bring along besides their place.
    pub inputs: Vec<VertexInput>,
}

/// Counts of the local body pooling.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoolingConfig {
    /// Body points that each vertex max-pools.
    pub neighbors: usize,
    /// Body points whose features are averaged into a kept one.
    pub averaged: usize,
    /// One body point of so many is kept.
    pub downscale: usize,
}

/// Mean and spread of each number that a network is told, over the scenes of its training: it is
/// told how many spreads a number is from the mean. A spread of zero leaves the number out.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InputScaling {
    /// Of the parameters of shape and pose `[number][2]`.
    pub parameters: Vec<[f32; 2]>,
    /// Of what vertices bring along `[feature][2]`.
    pub vertices: Vec<[f32; 2]>,
}

/// All that determines the shape of a `GarNet`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GarNetConfig {
    /// Which parts there are.
    pub variant: Variant,
    /// How M comes about.
    pub start: Start,
    /// The frame of prediction.
    pub frame: Frame,
    /// The body stream.
    pub body: BodyStreamConfig,
    /// The garment stream.
    pub garment: GarmentStreamConfig,
    /// Local pooling.
    pub pooling: PoolingConfig,
    /// Hidden widths of the fusion, one at least; a layer of 3 without activation follows.
    pub fusion: Vec<usize>,
    /// Sewing parameters, fed to each vertex.
    pub num_sewing_parameters: usize,
    /// Parameters of shape and pose, of the variants that have them.
    pub num_body_parameters: usize,
    /// Mean edge length of the template, in metres: differences of coordinates are divided by it
    /// where mesh convolutions weigh neighbors.
    pub mean_edge_length: f32,
    /// By which inputs are put on a like scale; none takes them as they are, as the paper does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scaling: Option<InputScaling>,
}

#[cfg(feature = "burn")]
impl InputScaling {
    /// Puts numbers on a like scale, row by row of as many as there are scales.
    pub(crate) fn apply(scales: &[[f32; 2]], numbers: &mut [f32]) {
        for row in numbers.chunks_exact_mut(scales.len().max(1)) {
            for (number, &[mean, spread]) in row.iter_mut().zip(scales) {
                *number = if spread > 0.0 {
                    (*number - mean) / spread
                } else {
                    0.0
                };
            }
        }
    }
}

impl GarNetConfig {
    /// Checks that a network can be made of the numbers.
    ///
    /// # Errors
    ///
    /// [`NetError::Config`] with the first number that is out of range.
    #[expect(clippy::too_many_lines, reason = "a line a number")]
    pub fn validate(&self) -> Result<(), NetError> {
        let count = |field, value: usize, min: usize, max: usize| {
            if (min..=max).contains(&value) {
                return Ok(());
            }
            Err(NetError::Config {
                field,
                value: value as f64,
                min: min as f64,
                max: max as f64,
            })
        };
        let length = |field, value: f32, min: f64| {
            let value = f64::from(value);
            if (min..=10.0).contains(&value) {
                return Ok(());
            }
            Err(NetError::Config {
                field,
                value,
                min,
                max: 10.0,
            })
        };
        let widths = |field, widths: &[usize], min_layers: usize| {
            count(field, widths.len(), min_layers, 8)?;
            widths
                .iter()
                .try_for_each(|&width| count(field, width, 1, 4096))
        };
        widths("body.stn.points", &self.body.stn.points, 1)?;
        widths("body.stn.head", &self.body.stn.head, 0)?;
        widths("body.first", &self.body.first, 1)?;
        widths("body.second", &self.body.second, 1)?;
        count("body.global", self.body.global, 1, 4096)?;
        widths("body.parameters", &self.body.parameters, 0)?;
        widths("garment.stn.points", &self.garment.stn.points, 1)?;
        widths("garment.stn.head", &self.garment.stn.head, 0)?;
        widths("garment.points", &self.garment.points, 1)?;
        count("garment.input", self.garment.input, 1, 4096)?;
        let min_blocks = usize::from(self.has_mesh_convolutions());
        widths("garment.blocks", &self.garment.blocks, min_blocks)?;
        count("garment.convolutions", self.garment.convolutions, 1, 8)?;
        count("garment.heads", self.garment.heads, 1, 32)?;
        count("garment.global", self.garment.global, 1, 4096)?;
        count("pooling.neighbors", self.pooling.neighbors, 1, 256)?;
        count("pooling.averaged", self.pooling.averaged, 1, 256)?;
        count("pooling.downscale", self.pooling.downscale, 1, 1000)?;
        widths("fusion", &self.fusion, 1)?;
        count("num_sewing_parameters", self.num_sewing_parameters, 0, 1024)?;
        let least = usize::from(self.has_body_parameters());
        count("num_body_parameters", self.num_body_parameters, least, 4096)?;
        count("body.points", self.body.points, 0, 1 << 20)?;
        length("body.reach", self.body.reach, 0.0)?;
        length("mean_edge_length", self.mean_edge_length, 1e-6)?;
        let Some(scaling) = &self.scaling else {
            return Ok(());
        };
        let expected = if self.has_body_parameters() {
            self.num_body_parameters
        } else {
            0
        };
        let found = scaling.parameters.len();
        count("scaling.parameters", found, expected, expected)?;
        let (found, expected) = (scaling.vertices.len(), self.num_vertex_features());
        count("scaling.vertices", found, expected, expected)?;
        let scales = scaling.parameters.iter().chain(&scaling.vertices);
        for &[mean, spread] in scales {
            for (field, value, min) in [
                ("scaling mean", f64::from(mean), -1e6),
                ("scaling spread", f64::from(spread), 0.0),
            ] {
                if !(min..=1e6).contains(&value) {
                    return Err(NetError::Config {
                        field,
                        value,
                        min,
                        max: 1e6,
                    });
                }
            }
        }
        Ok(())
    }

    /// Whether the garment stream has mesh convolutions.
    pub fn has_mesh_convolutions(&self) -> bool {
        self.variant != Variant::Naive
    }

    /// Whether vertices pool features of near body points.
    pub fn has_local_pooling(&self) -> bool {
        matches!(self.variant, Variant::Local | Variant::LocalParams)
    }

    /// Whether the network is told parameters of shape and pose.
    pub fn has_body_parameters(&self) -> bool {
        matches!(self.variant, Variant::GlobalParams | Variant::LocalParams)
    }

    /// Whether there is a body stream.
    pub fn has_body_stream(&self) -> bool {
        self.variant != Variant::GlobalParams
    }

    /// Whether a vertex needs the nearest body point.
    pub fn needs_nearest(&self) -> bool {
        let nearest = [VertexInput::BodyOffset, VertexInput::BodyNormal];
        (self.garment.inputs.iter()).any(|input| nearest.contains(input))
    }

    /// Whether it asks for [`SceneInput::body_normals`](crate::SceneInput::body_normals).
    pub fn needs_body_normals(&self) -> bool {
        self.body.normals && self.has_body_stream()
            || self.garment.inputs.contains(&VertexInput::BodyNormal)
    }

    /// Whether scenes have to bring skinning rotations.
    pub fn needs_rotations(&self) -> bool {
        self.frame == Frame::Skin || self.garment.inputs.contains(&VertexInput::Rotation)
    }

    /// Numbers that a vertex brings along besides its place.
    pub fn num_vertex_features(&self) -> usize {
        let inputs: usize = (self.garment.inputs.iter())
            .map(|input| input.width())
            .sum();
        inputs + self.num_sewing_parameters
    }

    /// Numbers of a body point: 3, or 6 with its normal.
    pub fn num_body_features(&self) -> usize {
        if self.body.normals { 6 } else { 3 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn networks_start_as_files_say() {
        for (start, name) in [
            (Start::DualQuaternion, "\"dual-quaternion\""),
            (Start::Shape, "\"shape\""),
            (Start::PoseSpace, "\"pose-space\""),
        ] {
            assert_eq!(serde_json::to_string(&start).unwrap(), name);
            assert_eq!(serde_json::from_str::<Start>(name).unwrap(), start);
        }
        let error = serde_json::from_str::<Start>("\"arrival\"").unwrap_err();
        assert!(error.to_string().contains("`pose-space`"), "{error}");
        assert_eq!(Start::PoseSpace.deformation(), Some(Moment::Rest));
    }
}
