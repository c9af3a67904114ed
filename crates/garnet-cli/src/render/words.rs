//! The words of the arguments of `render`.

use clap::ValueEnum;
use garnet::mesh::UpAxis;
use garnet_view::Camera;

/// A side to look from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ViewName {
    /// From the front.
    Front,
    /// From the back.
    Back,
    /// From the body's left.
    #[value(alias = "side")]
    Left,
    /// From the body's right.
    Right,
    /// From above.
    Top,
    /// From the front, half to the body's left and a little above.
    ThreeQuarter,
}

/// The axis that points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum UpName {
    /// As in most programs.
    Y,
    /// As in Blender and 3ds Max.
    Z,
}

impl ViewName {
    pub(crate) fn camera(self) -> Camera {
        match self {
            Self::Front => Camera::front(),
            Self::Back => Camera::back(),
            Self::Left => Camera::left(),
            Self::Right => Camera::right(),
            Self::Top => Camera::top(),
            Self::ThreeQuarter => Camera::three_quarter(),
        }
    }

    pub(crate) fn caption(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::Back => "back",
            Self::Left => "left",
            Self::Right => "right",
            Self::Top => "top",
            Self::ThreeQuarter => "three-quarter",
        }
    }
}

impl UpName {
    pub(crate) fn axis(self) -> UpAxis {
        match self {
            Self::Y => UpAxis::Y,
            Self::Z => UpAxis::Z,
        }
    }
}

/// `WxH` in pixels.
pub(crate) fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X']);
    let pixels = |side: &str| {
        let pixels = side.parse().ok()?;
        (1..=garnet_view::MAX_SIZE)
            .contains(&pixels)
            .then_some(pixels)
    };
    sides
        .and_then(|(width, height)| Some([pixels(width)?, pixels(height)?]))
        .ok_or_else(|| {
            let largest = garnet_view::MAX_SIZE;
            format!("expected pixels as `1200x800`, up to {largest} each way")
        })
}

/// `LO:HI`, rising.
pub(crate) fn range(text: &str) -> Result<[f32; 2], String> {
    let number = |text: &str| text.parse().ok().filter(|number: &f32| number.is_finite());
    let ends = text.split_once(':');
    let ends = ends.and_then(|(low, high)| Some([number(low)?, number(high)?]));
    ends.filter(|[low, high]| low < high)
        .ok_or_else(|| "expected two numbers that rise, as `-20:20`".to_owned())
}

/// A factor.
pub(crate) fn zoom(text: &str) -> Result<f32, String> {
    let factor = text.parse().ok();
    factor
        .filter(|factor| (1e-3..=1e3).contains(factor))
        .ok_or_else(|| "expected a factor from 0.001 to 1000".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_ranges_are_checked() {
        assert_eq!(size("1200x800"), Ok([1200, 800]));
        for text in ["", "0x5", "12", "1x99999", "ax2", "-1x2"] {
            assert!(size(text).is_err(), "{text}");
        }
        assert_eq!(range("-20:20"), Ok([-20.0, 20.0]));
        for text in ["", "1:1", "2:1", "nan:1", "1"] {
            assert!(range(text).is_err(), "{text}");
        }
    }
}
