//! The draft of each garment, and where it starts around its wearer.

use crate::curve::Point2;
use crate::draft::{Draft, Layer};
use crate::leg_start::LegStart;
use crate::top_start::TopStart;
use crate::wearer::{Landmark, Measures};
use crate::{GarmentKind, Parameters, PatternError, Wearer};

/// From the chart of a patch into space.
#[derive(Debug, Clone)]
pub(crate) enum StartShape {
    Top(TopStart),
    Legs(LegStart),
}

impl StartShape {
    /// Whether the chart has metres on both axes: else its outlines are convex and nothing folds.
    pub(crate) fn has_even_chart(&self) -> bool {
        matches!(self, Self::Top(_))
    }

    pub(crate) fn at(&self, layer: Layer, chart: Point2, closes: bool) -> Landmark {
        match self {
            Self::Top(top) => top.at(layer, chart, closes),
            Self::Legs(legs) => legs.at(layer, chart),
        }
    }
}

/// The pattern of a garment cut to measures, in the flat and around a wearer.
pub(crate) fn draft(
    parameters: &Parameters,
    cut: &Measures,
    wearer: &Wearer,
) -> Result<(Draft, StartShape), PatternError> {
    let top = |(draft, start)| (draft, StartShape::Top(start));
    match parameters.garment() {
        GarmentKind::Tshirt | GarmentKind::Sweater => {
            crate::shirt::shirt(parameters, cut, wearer).map(top)
        }
        GarmentKind::Dress => crate::dress::dress(parameters, cut, wearer).map(top),
        GarmentKind::Jeans => crate::jeans::jeans(parameters, cut, wearer)
            .map(|(draft, start)| (draft, StartShape::Legs(start))),
    }
}
