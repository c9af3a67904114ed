//! Colors as they are written down and as light adds up.

/// A color as it is stored in a PNG: sRGB, 8 bits a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Rgb {
    /// The red channel.
    pub red: u8,
    /// The green channel.
    pub green: u8,
    /// The blue channel.
    pub blue: u8,
}

/// An amount of red, green and blue light; 1 is the brightest that a picture shows.
pub(crate) type Light = nalgebra::Vector3<f32>;

impl Rgb {
    /// A color of three channels.
    pub const fn new(red: u8, green: u8, blue: u8) -> Self {
        Self { red, green, blue }
    }

    /// The channels in the order in which they are stored.
    pub(crate) const fn channels(self) -> [u8; 3] {
        [self.red, self.green, self.blue]
    }

    /// The light that this color stands for.
    pub(crate) fn to_light(self) -> Light {
        Light::from(self.channels().map(decoded))
    }

    /// The color nearest to an amount of light; too bright is white, not a number is black.
    pub(crate) fn from_light(light: Light) -> Self {
        let [red, green, blue] = [light.x, light.y, light.z].map(encoded);
        Self { red, green, blue }
    }
}

/// The transfer function of sRGB (IEC 61966-2-1).
fn decoded(code: u8) -> f32 {
    let value = f32::from(code) / 255.0;
    if value <= 0.040_45 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}

#[expect(
    clippy::cast_sign_loss,
    reason = "clamped before; not a number becomes zero"
)]
fn encoded(light: f32) -> u8 {
    let light = light.clamp(0.0, 1.0);
    let value = if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * light.powf(1.0 / 2.4) - 0.055
    };
    (255.0 * value + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_survives_the_way_through_light() {
        for code in 0..=255 {
            let color = Rgb::new(code, 255 - code, code / 2);
            assert_eq!(Rgb::from_light(color.to_light()), color);
        }
    }
}
