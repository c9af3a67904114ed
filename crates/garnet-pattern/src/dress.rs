//! A sleeveless dress: a bodice to the waist and a flared skirt.

use crate::bodice::{Edge, at_least, bodice, bodice_patch, width_rows};
use crate::curve::{Point2, Polyline, length, line, reversed};
use crate::draft::{Arc, Draft, Layer, Meets, Patch};
use crate::reference::REFERENCE;
use crate::top_start::{Sizes, TopStart};
use crate::wearer::Measures;
use crate::{Parameters, PatternError, PatternLength, Wearer};

/// The least opening of half a skirt panel, in radians: a straight skirt is a very long cone.
const LEAST_OPENING: f64 = 0.02;

/// Half a skirt panel: a sector of a cone, with the hips added at the side.
struct Skirt {
    /// Distance of the waist from the apex, and the opening, in radians.
    apex: f64,
    waist: f64,
    opening: f64,
    /// What the hips need beyond the cone, and how far below the waist they are.
    hips: f64,
    drop: f64,
    length: f64,
}

impl Skirt {
    /// The width of half a panel at a distance below the waist.
    fn width(&self, below: f64) -> f64 {
        let share = crate::curve::smoothstep(0.0, 1.0, (below / self.drop).min(1.0));
        self.waist + self.opening * below + share * self.hips
    }

    /// The point at a distance below the waist, at a share of the width from the middle.
    fn at(&self, below: f64, share: f64) -> Point2 {
        let radius = self.apex + below;
        let angle = share * self.width(below) / radius;
        [radius * angle.sin(), self.apex - radius * angle.cos()]
    }

    fn level(&self, below: f64) -> Polyline {
        (0..=48)
            .map(|i| self.at(below, f64::from(i) / 48.0))
            .collect()
    }

    /// From the hem to the waist.
    fn side(&self) -> Polyline {
        let at = |i: i32| self.at(self.length * (1.0 - f64::from(i) / 64.0), 1.0);
        (0..=64).map(at).collect()
    }
}

pub(crate) fn dress(
    parameters: &Parameters,
    cut: &Measures,
    wearer: &Wearer,
) -> Result<(Draft, TopStart), PatternError> {
    let scale = cut.stature / REFERENCE.measures.stature;
    let waist = 0.25 * cut.waist * (1.0 + parameters.at("waist-ease"));
    let side = |underarm: Point2| line(underarm, [waist, cut.waist_height]);
    let bodice = bodice(parameters, cut, None, &side)?;
    let below = cut.waist_height - (cut.neck_height - parameters.at("length") * scale);
    at_least(PatternLength::Skirt, below, 0.25)?;
    let drop = (cut.waist_height - cut.hip_height).max(0.08);
    let opening = (0.25 * parameters.at("hem-flare") / below).max(LEAST_OPENING);
    let hip = 0.25 * cut.hip * (1.0 + parameters.at("hip-ease"));
    let skirt = Skirt {
        apex: waist / opening,
        waist,
        opening,
        hips: (hip - waist - opening * drop).max(0.0),
        drop,
        length: below,
    };
    let mut rows = width_rows(&bodice.side, bodice.underarm[1]);
    let bodice_side = bodice.underarm[1] - cut.waist_height;
    rows.extend((1..=24).map(|i| {
        let below = below * f64::from(i) / 24.0;
        (bodice_side + below, skirt.width(below))
    }));
    let start = TopStart::new(
        wearer,
        &Sizes {
            neck: bodice.neck[0],
            neck_depth: [
                bodice.neck[1] - bodice.neck_front,
                bodice.neck[1] - bodice.neck_back,
            ],
            side: length(&bodice.side),
            rows,
            sleeve: None,
            below,
            cuff_rib: 0.0,
            neck_rib: 0.0,
        },
    );
    let edge = Edge {
        bottom: ["front waist", "back waist"],
        bottom_meets: Meets::Seam,
        armhole_meets: Meets::Rim,
        neck_meets: Meets::Rim,
    };
    let layers = [Layer::Front, Layer::Back];
    let mut patches: Vec<Patch> = layers
        .map(|layer| bodice_patch(&bodice, layer, &start, &edge))
        .into();
    patches.extend(layers.map(|layer| skirt_patch(&skirt, layer, &start)));
    Ok((Draft { patches }, start))
}

fn skirt_patch(skirt: &Skirt, layer: Layer, start: &TopStart) -> Patch {
    let (panel, waist, hem, middle) = match layer {
        Layer::Front => (
            "front skirt",
            "front waist",
            "front hem",
            "front skirt middle",
        ),
        Layer::Back => ("back skirt", "back waist", "back hem", "back skirt middle"),
    };
    let (upper, lower) = (start.bottom(), start.lowest());
    let arcs = vec![
        Arc::new(
            hem,
            Meets::Rim,
            false,
            skirt.level(skirt.length),
            line([0.0, lower[1]], lower),
        ),
        Arc::new(
            "skirt side",
            Meets::Seam,
            false,
            skirt.side(),
            start.side_below(),
        )
        .closing(),
        Arc::new(
            waist,
            Meets::Seam,
            true,
            reversed(&skirt.level(0.0)),
            line(upper, [0.0, upper[1]]),
        ),
        Arc::new(
            middle,
            Meets::MiddleFold,
            false,
            line(skirt.at(0.0, 0.0), skirt.at(skirt.length, 0.0)),
            line([0.0, upper[1]], [0.0, lower[1]]),
        ),
    ];
    Patch {
        panel,
        is_cut_twice: false,
        layer,
        shrink: 1.0,
        arcs,
    }
}
