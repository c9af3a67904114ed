//! The lamps: as for clay in a studio, fixed to the camera, under a sky.

use nalgebra::Vector3;

use crate::{lens::Lens, rgb::Light, scene::Surface};

/// Lamps and sky in the coordinates of a view.
#[derive(Debug)]
pub(crate) struct Studio {
    /// Where the sky is.
    up: Vector3<f32>,
    key: Vector3<f32>,
    fill: Vector3<f32>,
    rim: Vector3<f32>,
}

const SKY: Light = Light::new(0.30, 0.32, 0.36);
const GROUND: Light = Light::new(0.12, 0.11, 0.10);
const KEY: Light = Light::new(0.98, 0.95, 0.90);
const FILL: Light = Light::new(0.12, 0.13, 0.15);
const RIM: Light = Light::new(0.34, 0.35, 0.38);

/// The dull shine of the key light, which draws folds in dark or strongly colored cloth.
const SHEEN: f32 = 0.085;

/// How far the key light reaches around edges.
const WRAP: f32 = 0.05;

/// How much of the lamps, other than of the sky, a closed crease still gets.
const CREASE_SHARE: f32 = 0.45;

/// How much of the shading a heat map takes on, so that its colors stay those of the bar.
const HEAT_RELIEF: f32 = 0.55;

impl Studio {
    pub(crate) fn new(lens: &Lens) -> Self {
        Self {
            up: lens.direction(&Vector3::y()),
            key: Vector3::new(-0.66, 0.60, 0.45).normalize(),
            fill: Vector3::new(0.80, 0.05, 0.60).normalize(),
            rim: Vector3::new(0.35, 0.55, -0.76).normalize(),
        }
    }

    /// The light that goes from a surface to the viewer, where `openness` of its sky is free.
    pub(crate) fn lit(&self, surface: &Surface, openness: f32) -> Light {
        let normal = surface.normal;
        let sky = GROUND.lerp(&SKY, 0.5 + 0.5 * normal.dot(&self.up));
        let key = ((normal.dot(&self.key) + WRAP) / (1.0 + WRAP)).max(0.0);
        let fill = normal.dot(&self.fill).max(0.0);
        let grazing = 1.0 - normal.dot(&surface.to_viewer).clamp(0.0, 1.0);
        let rim = grazing * grazing * grazing * (normal.dot(&self.rim) + 0.4).clamp(0.0, 1.0);
        let lamps = KEY * key + FILL * fill + RIM * rim;
        let crease = CREASE_SHARE + (1.0 - CREASE_SHARE) * openness;
        let light = sky * openness + lamps * crease;
        if surface.is_heat {
            let light = light.map(|light| 1.0 + HEAT_RELIEF * (light - 1.0));
            return surface.color.component_mul(&light);
        }
        let halfway = (self.key + surface.to_viewer).normalize();
        let sheen = SHEEN * normal.dot(&halfway).max(0.0).powi(14) * crease;
        surface.color.component_mul(&light) + KEY * sheen
    }
}
