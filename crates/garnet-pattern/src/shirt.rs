//! T-shirt and sweater.

use crate::bodice::{Bodice, Edge, at_least, bodice, bodice_patch, neck_name, width_rows};
use crate::curve::{Point2, Polyline, inside_of, length, line, reversed, spline};
use crate::draft::{Arc, Draft, Layer, Meets, Patch};
use crate::reference::REFERENCE;
use crate::sleeve::{RIB_SHRINK, cuff_rib, sleeve, sleeve_patch};
use crate::top_start::{Sizes, TopStart};
use crate::wearer::Measures;
use crate::{GarmentKind, Parameters, PatternError, PatternLength, Wearer};

/// Height of the rib around the neck, in metres.
const NECK_RIB: f64 = 0.018;
/// Height of the ribs at cuffs and hem, in metres.
const RIB: f64 = 0.05;
/// Rest lengths of the neck's rib over those of its pattern.
const NECK_SHRINK: f32 = 0.97;

/// The patterns of T-shirt and sweater.
pub(crate) fn shirt(
    parameters: &Parameters,
    cut: &Measures,
    wearer: &Wearer,
) -> Result<(Draft, TopStart), PatternError> {
    let is_sweater = parameters.garment() == GarmentKind::Sweater;
    let rib = if is_sweater { RIB } else { 0.0 };
    let scale = cut.stature / REFERENCE.measures.stature;
    let half = 0.5 * cut.upper_arm * (1.0 + parameters.at("sleeve-ease"));
    let hem = cut.neck_height - parameters.at("length") * scale + rib;
    let waist = cut.waist_height;
    let chest_half = 0.25 * cut.chest * (1.0 + parameters.at("chest-ease"));
    let waist_half = chest_half * (1.0 + parameters.at("waist-shape"));
    let hem_half = chest_half * (1.0 + parameters.at("hem-flare"));
    let side = |underarm: Point2| side_line(underarm, [waist_half, waist], [hem_half, hem]);
    let bodice = bodice(parameters, cut, Some(half), &side)?;
    at_least(PatternLength::SideSeam, bodice.underarm[1] - hem, 0.08)?;
    let half = bodice.sleeve_half(half);
    let sleeve = sleeve(parameters, cut, half, length(&bodice.armhole), rib)?;
    let start = TopStart::new(
        wearer,
        &Sizes {
            neck: bodice.neck[0],
            neck_depth: [
                bodice.neck[1] - bodice.neck_front,
                bodice.neck[1] - bodice.neck_back,
            ],
            side: length(&bodice.side),
            rows: width_rows(&bodice.side, bodice.underarm[1]),
            sleeve: Some((sleeve.top, length(&sleeve.under) + rib)),
            below: rib,
            cuff_rib: rib,
            neck_rib: NECK_RIB,
        },
    );
    let edge = Edge {
        bottom: if is_sweater {
            ["front rib", "back rib"]
        } else {
            ["front hem", "back hem"]
        },
        bottom_meets: if is_sweater { Meets::Seam } else { Meets::Rim },
        armhole_meets: Meets::Seam,
        neck_meets: Meets::Seam,
    };
    let mut patches = Vec::new();
    for layer in [Layer::Front, Layer::Back] {
        patches.push(bodice_patch(&bodice, layer, &start, &edge));
    }
    for layer in [Layer::Front, Layer::Back] {
        patches.push(sleeve_patch(&sleeve, layer, &start));
    }
    for layer in [Layer::Front, Layer::Back] {
        patches.push(neck_rib(&bodice, layer, &start));
    }
    if is_sweater {
        for layer in [Layer::Front, Layer::Back] {
            patches.push(cuff_rib(&sleeve, layer, &start));
        }
        for layer in [Layer::Front, Layer::Back] {
            patches.push(hem_rib(&bodice, layer, &start));
        }
    }
    Ok((Draft { patches }, start))
}

/// From the underarm over the waist to the hem, without the waist where the shirt is too short.
fn side_line(underarm: Point2, waist: Point2, hem: Point2) -> Polyline {
    if waist[1] > hem[1] + 0.06 && waist[1] < underarm[1] - 0.06 {
        spline(&[underarm, waist, hem])
    } else {
        line(underarm, hem)
    }
}

/// The rib lies in the plane of the neckline, inside of it.
fn neck_rib(bodice: &Bodice, layer: Layer, start: &TopStart) -> Patch {
    let outer = bodice.neckline(layer);
    let low = outer[outer.len() - 1];
    let inner = inside_of(&outer, bodice.tip, NECK_RIB);
    let along = inner[0];
    let (panel, free, middle) = match layer {
        Layer::Front => ("front neck rib", "front collar", "front rib middle"),
        Layer::Back => ("back neck rib", "back collar", "back rib middle"),
    };
    let arcs = vec![
        Arc::new(
            neck_name(layer),
            Meets::Seam,
            true,
            reversed(&outer),
            reversed(&start.neckline(layer)),
        ),
        Arc::new(
            "rib shoulder",
            Meets::Seam,
            false,
            line(bodice.neck, along),
            line(start.neck(), start.collar()),
        )
        .closing(),
        Arc::new(
            free,
            Meets::Rim,
            false,
            inner.clone(),
            start.collar_line(layer),
        ),
        Arc::new(
            middle,
            Meets::MiddleFold,
            false,
            line(inner[inner.len() - 1], low),
            line([0.0, start.collar_low(layer)], [0.0, start.neck_low(layer)]),
        ),
    ];
    Patch {
        panel,
        is_cut_twice: false,
        layer,
        shrink: NECK_SHRINK,
        arcs,
    }
}

fn hem_rib(bodice: &Bodice, layer: Layer, start: &TopStart) -> Patch {
    let corner = bodice.bottom();
    let low = corner[1] - RIB;
    let (panel, seam, free, middle) = match layer {
        Layer::Front => (
            "front hem rib",
            "front rib",
            "front hem",
            "front hem middle",
        ),
        Layer::Back => ("back hem rib", "back rib", "back hem", "back hem middle"),
    };
    let (upper, lower) = (start.bottom(), start.lowest());
    let arcs = vec![
        Arc::new(
            free,
            Meets::Rim,
            false,
            line([0.0, low], [corner[0], low]),
            line([0.0, lower[1]], lower),
        ),
        Arc::new(
            "hem rib side",
            Meets::Seam,
            false,
            line([corner[0], low], corner),
            line(lower, upper),
        )
        .closing(),
        Arc::new(
            seam,
            Meets::Seam,
            true,
            line(corner, [0.0, corner[1]]),
            line(upper, [0.0, upper[1]]),
        ),
        Arc::new(
            middle,
            Meets::MiddleFold,
            false,
            line([0.0, corner[1]], [0.0, low]),
            line([0.0, upper[1]], [0.0, lower[1]]),
        ),
    ];
    Patch {
        panel,
        is_cut_twice: false,
        layer,
        shrink: RIB_SHRINK,
        arcs,
    }
}
