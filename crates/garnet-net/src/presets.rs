//! Named configurations, from the paper's size down.

use crate::{
    BodyStreamConfig, Frame, GarNetConfig, GarmentStreamConfig, NetError, PoolingConfig, Start,
    StnConfig, Variant, VertexInput,
};

/// Names of the presets, largest first.
pub const PRESET_NAMES: [&str; 5] = ["paper", "medium", "small", "light", "tiny"];

/// The widths that differ from preset to preset.
struct Widths {
    stn: &'static [usize],
    stn_head: &'static [usize],
    body_first: &'static [usize],
    body_second: &'static [usize],
    body_global: usize,
    points: &'static [usize],
    input: usize,
    blocks: &'static [usize],
    convolutions: usize,
    heads: usize,
    global: usize,
    fusion: &'static [usize],
    neighbors: usize,
    body_points: usize,
    reach: f32,
}

const PAPER: Widths = Widths {
    stn: &[64, 128, 512],
    stn_head: &[256],
    body_first: &[64, 64],
    body_second: &[64, 128],
    body_global: 512,
    points: &[64, 64],
    input: 64,
    blocks: &[64, 64, 64, 128, 128, 128],
    convolutions: 2,
    heads: 8,
    global: 512,
    fusion: &[512, 256, 128],
    neighbors: 15,
    body_points: 0,
    reach: 0.0,
};

/// As `small`, with wider layers.
const MEDIUM: Widths = Widths {
    stn: &[64, 96],
    stn_head: &[48],
    body_first: &[64],
    body_second: &[64, 96],
    body_global: 256,
    points: &[48, 88],
    input: 88,
    blocks: &[88, 88, 88, 88, 88, 88],
    convolutions: 1,
    heads: 8,
    global: 256,
    fusion: &[192, 128, 64],
    neighbors: 8,
    body_points: 1700,
    reach: 0.4,
};

const SMALL: Widths = Widths {
    stn: &[32, 64],
    stn_head: &[32],
    body_first: &[32],
    body_second: &[32, 64],
    body_global: 128,
    points: &[32, 48],
    input: 48,
    blocks: &[48, 48, 48, 48, 48, 48],
    convolutions: 1,
    heads: 8,
    global: 128,
    fusion: &[128, 64, 32],
    neighbors: 8,
    body_points: 1700,
    reach: 0.4,
};

const LIGHT: Widths = Widths {
    stn: &[16, 32],
    stn_head: &[32],
    body_first: &[32],
    body_second: &[32, 32],
    body_global: 128,
    points: &[32],
    input: 32,
    blocks: &[32, 32, 32, 32, 32, 32],
    convolutions: 1,
    heads: 8,
    global: 128,
    fusion: &[96, 64, 32],
    neighbors: 8,
    body_points: 1000,
    reach: 0.4,
};

const TINY: Widths = Widths {
    stn: &[8],
    stn_head: &[],
    body_first: &[16],
    body_second: &[16],
    body_global: 16,
    points: &[16],
    input: 16,
    blocks: &[16, 24],
    convolutions: 2,
    heads: 4,
    global: 16,
    fusion: &[32, 16],
    neighbors: 4,
    body_points: 500,
    reach: 0.4,
};

impl GarNetConfig {
    /// A named configuration of [`PRESET_NAMES`]; all are [`Variant::Local`].
    ///
    /// `paper` is the reconstruction of the lost widths: it starts from dual-quaternion skinning,
    /// and places in the root frame are all that a vertex brings along. The others start from the
    /// shape-aware warp, predict in each vertex's skinning frame and feed it what is
    /// known of its surroundings at no cost: the offset to the nearest body point, its normal, the
    /// rotation, the place on the template, where down is.
    ///
    /// # Errors
    ///
    /// [`NetError::UnknownPreset`].
    pub fn preset(name: &str) -> Result<Self, NetError> {
        match name {
            "paper" => Ok(Self::of_widths(&PAPER)),
            "medium" => Ok(Self::of_widths(&MEDIUM).with_surroundings()),
            "small" => Ok(Self::of_widths(&SMALL).with_surroundings()),
            "light" => Ok(Self::of_widths(&LIGHT).with_surroundings()),
            "tiny" => Ok(Self::of_widths(&TINY).with_surroundings()),
            _ => Err(NetError::UnknownPreset {
                name: name.to_owned(),
                known: PRESET_NAMES.map(|name| format!("`{name}`")).join(", "),
            }),
        }
    }

    /// The same widths as another variant.
    #[must_use]
    pub fn with_variant(mut self, variant: Variant, num_body_parameters: usize) -> Self {
        self.variant = variant;
        self.num_body_parameters = num_body_parameters;
        if variant == Variant::GlobalParams {
            // Without body points in the network, nothing of them may come in by the vertices.
            let of_body = [VertexInput::BodyOffset, VertexInput::BodyNormal];
            (self.garment.inputs).retain(|input| !of_body.contains(input));
        }
        self
    }

    /// Predicts in skinning frames and feeds what is known of each vertex's surroundings.
    fn with_surroundings(mut self) -> Self {
        self.start = Start::Shape;
        self.frame = Frame::Skin;
        self.body.normals = true;
        self.body.parameters = vec![self.body.global; 2];
        self.garment.inputs = vec![
            VertexInput::Template,
            VertexInput::BodyOffset,
            VertexInput::BodyNormal,
            VertexInput::Rotation,
            VertexInput::Down,
        ];
        self
    }

    fn of_widths(widths: &Widths) -> Self {
        let stn = StnConfig {
            points: widths.stn.to_vec(),
            head: widths.stn_head.to_vec(),
        };
        Self {
            variant: Variant::Local,
            start: Start::DualQuaternion,
            frame: Frame::Root,
            body: BodyStreamConfig {
                stn: stn.clone(),
                first: widths.body_first.to_vec(),
                second: widths.body_second.to_vec(),
                global: widths.body_global,
                normals: false,
                points: widths.body_points,
                reach: widths.reach,
                parameters: vec![widths.body_global],
            },
            garment: GarmentStreamConfig {
                stn,
                points: widths.points.to_vec(),
                input: widths.input,
                blocks: widths.blocks.to_vec(),
                convolutions: widths.convolutions,
                heads: widths.heads,
                global: widths.global,
                inputs: Vec::new(),
            },
            pooling: PoolingConfig {
                neighbors: widths.neighbors,
                averaged: 16,
                downscale: 10,
            },
            fusion: widths.fusion.to_vec(),
            num_sewing_parameters: 0,
            num_body_parameters: 0,
            mean_edge_length: 0.01,
            scaling: None,
        }
    }
}
