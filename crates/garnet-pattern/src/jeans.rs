//! Jeans: fronts, backs and a waistband.

use crate::bodice::at_least;
use crate::curve::{Point2, Polyline, bezier, distance, length, line, reversed, spline};
use crate::draft::{Arc, Draft, Layer, Meets, Patch};
use crate::leg_start::{LegSizes, LegStart};
use crate::reference::REFERENCE;
use crate::wearer::Measures;
use crate::{Parameters, PatternError, PatternLength, Wearer};

/// Rest lengths of the waistband over those of its pattern.
const WAISTBAND_SHRINK: f32 = 0.93;
/// The back panel is wider than the front panel by this, in metres.
const BACK_WIDER: f64 = 0.02;
/// Share of the crotch's fork that the front takes.
const FRONT_FORK: f64 = 0.30;
/// The forks together are at least this share of the hip.
pub(crate) const LEAST_FORK: f64 = 0.09;
/// How far the middle of the back rises above the waist line and leans in, in metres.
const BACK_RISE: [f64; 2] = [0.022, 0.028];

/// One leg panel; heights count from the crotch line.
struct Leg {
    hem: [Point2; 2],
    outseam: Polyline,
    waist: [Point2; 2],
    middle: Polyline,
    inseam: Polyline,
}

struct Levels {
    hem: f64,
    knee: f64,
    hip: f64,
    waist: f64,
}

/// Widths of one panel and where its corners lie.
struct Widths {
    fork: f64,
    hip: f64,
    waist: f64,
    knee: f64,
    hem: f64,
    /// Where the middle meets the waist line: right of the middle at the hip, and above.
    lean: [f64; 2],
}

fn leg(levels: &Levels, widths: &Widths, crotch_drop: f64, side_rise: f64) -> Leg {
    let axis = 0.5 * (widths.hip - widths.fork);
    let [lean, rise] = widths.lean;
    let middle_top = [lean, levels.waist + rise];
    let side_top = [lean + widths.waist, levels.waist + side_rise];
    let crotch = [-widths.fork, -crotch_drop];
    let hem = [
        [axis - 0.5 * widths.hem, levels.hem],
        [axis + 0.5 * widths.hem, levels.hem],
    ];
    let outseam = spline(&[
        hem[1],
        [axis + 0.5 * widths.knee, levels.knee],
        [widths.hip, levels.hip],
        side_top,
    ]);
    let inner_thigh = [
        axis - 0.5 * widths.knee - 0.30 * (axis - 0.5 * widths.knee - crotch[0]).max(0.0),
        0.45 * levels.knee,
    ];
    let inseam = spline(&[
        crotch,
        inner_thigh,
        [axis - 0.5 * widths.knee, levels.knee],
        hem[0],
    ]);
    // Straight down to the hip, then round to the tip of the fork.
    let turn = [0.0, levels.hip];
    let mut middle = line(middle_top, turn);
    // The curve leaves the straight part in its direction.
    let straight = distance(middle_top, turn);
    let reach = 0.6 * levels.hip / straight;
    let round = bezier(
        turn,
        [
            turn[0] + reach * (turn[0] - middle_top[0]),
            turn[1] + reach * (turn[1] - middle_top[1]),
        ],
        [-0.45 * widths.fork, -crotch_drop + 0.004],
        crotch,
    );
    middle.extend_from_slice(&round[1..]);
    Leg {
        hem,
        outseam,
        waist: [side_top, middle_top],
        middle,
        inseam,
    }
}

pub(crate) fn jeans(
    parameters: &Parameters,
    cut: &Measures,
    wearer: &Wearer,
) -> Result<(Draft, LegStart), PatternError> {
    let inseam_scale = cut.inseam / REFERENCE.measures.inseam;
    let scale = cut.stature / REFERENCE.measures.stature;
    let band = parameters.at("waistband");
    let rise = parameters.at("rise") * scale;
    let inseam = parameters.at("inseam") * inseam_scale;
    let levels = Levels {
        hem: -inseam,
        // Shorts end above the knee.
        knee: (cut.knee_height - cut.inseam).max(-0.62 * inseam),
        hip: (cut.hip_height - cut.inseam).clamp(0.045, 0.5 * rise),
        waist: rise - band,
    };
    at_least(PatternLength::Rise, levels.waist - levels.hip, 0.02)?;
    let girth = |above_crotch: f64| {
        cut.band_girth(cut.inseam + above_crotch) * (1.0 + parameters.at("waist-ease"))
    };
    let hip = 0.25 * cut.hip * (1.0 + parameters.at("hip-ease"));
    let thigh = cut.thigh * (1.0 + parameters.at("thigh-ease"));
    let forks = (thigh - 2.0 * hip).max(LEAST_FORK * cut.hip);
    let knee = cut.knee * (1.0 + parameters.at("knee-ease"));
    let hem = parameters.at("leg-opening") * (cut.calf / REFERENCE.measures.calf);
    let waist = 0.25 * girth(levels.waist);
    let widths = |sign: f64, fork: f64, lean: [f64; 2]| Widths {
        fork,
        hip: hip + sign * 0.5 * BACK_WIDER,
        waist: waist + sign * 0.25 * BACK_WIDER,
        knee: 0.5 * (knee + sign * BACK_WIDER),
        hem: 0.5 * (hem + sign * BACK_WIDER),
        lean,
    };
    let front = leg(
        &levels,
        &widths(-1.0, FRONT_FORK * forks, [0.008, 0.0]),
        0.0,
        0.0,
    );
    // The seams of the back are as long as those of the front.
    let back_widths = widths(
        1.0,
        (1.0 - FRONT_FORK) * forks,
        BACK_RISE.map(|x| x * scale),
    );
    let (mut drop, mut side) = (0.0, 0.0);
    let mut back = leg(&levels, &back_widths, drop, side);
    for _ in 0..8 {
        drop += length(&back.inseam) - length(&front.inseam);
        side += length(&front.outseam) - length(&back.outseam);
        back = leg(&levels, &back_widths, drop, side);
    }
    let start = LegStart::new(
        wearer,
        &LegSizes {
            inseam: length(&front.inseam),
            rise,
            band,
        },
    );
    let top = 0.25 * girth(rise);
    let patches = [(Layer::Front, &front), (Layer::Back, &back)];
    let mut all: Vec<Patch> = patches
        .map(|(layer, leg)| leg_patch(leg, layer, &start))
        .into();
    all.extend(patches.map(|(layer, leg)| {
        let bottom = distance(leg.waist[0], leg.waist[1]);
        band_patch(layer, [bottom, top + bottom - waist], band, &start)
    }));
    Ok((Draft { patches: all }, start))
}

const fn waist_name(layer: Layer) -> &'static str {
    match layer {
        Layer::Front => "front waist",
        Layer::Back => "back waist",
    }
}

fn leg_patch(leg: &Leg, layer: Layer, start: &LegStart) -> Patch {
    let (panel, hem, middle) = match layer {
        Layer::Front => ("front", "front hem", "front crotch"),
        Layer::Back => ("back", "back hem", "back crotch"),
    };
    let [low, crotch, waist] = start.heights();
    let arcs = vec![
        Arc::new(
            hem,
            Meets::Rim,
            false,
            line(leg.hem[0], leg.hem[1]),
            line([0.0, low], [1.0, low]),
        ),
        Arc::new(
            "outseam",
            Meets::Seam,
            false,
            leg.outseam.clone(),
            line([1.0, low], [1.0, waist]),
        ),
        Arc::new(
            waist_name(layer),
            Meets::Seam,
            false,
            line(leg.waist[0], leg.waist[1]),
            line([1.0, waist], [0.0, waist]),
        ),
        Arc::new(
            middle,
            Meets::MiddleSeam,
            false,
            leg.middle.clone(),
            start.crotch_seam(),
        )
        .guiding(),
        Arc::new(
            "inseam",
            Meets::Seam,
            false,
            leg.inseam.clone(),
            line([0.0, crotch], [0.0, low]),
        ),
    ];
    Patch {
        panel,
        is_cut_twice: true,
        layer,
        shrink: 1.0,
        arcs,
    }
}

fn band_patch(layer: Layer, [bottom, top]: [f64; 2], height: f64, start: &LegStart) -> Patch {
    let (panel, rim, middle) = match layer {
        Layer::Front => ("front waistband", "front waistband", "front band middle"),
        Layer::Back => ("back waistband", "back waistband", "back band middle"),
    };
    let [_, _, low] = start.heights();
    let high = start.top();
    let seam = [[0.0, 0.0], [bottom, 0.0]];
    let edge = [[top, height], [0.0, height]];
    let arcs = vec![
        Arc::new(
            waist_name(layer),
            Meets::Seam,
            true,
            reversed(&[seam[1], seam[0]]),
            line([0.0, low], [1.0, low]),
        ),
        Arc::new(
            "band side",
            Meets::Seam,
            false,
            line(seam[1], edge[0]),
            line([1.0, low], [1.0, high]),
        ),
        Arc::new(
            rim,
            Meets::Rim,
            false,
            line(edge[0], edge[1]),
            line([1.0, high], [0.0, high]),
        ),
        Arc::new(
            middle,
            Meets::MiddleFold,
            false,
            line(edge[1], seam[0]),
            line([0.0, high], [0.0, low]),
        ),
    ];
    Patch {
        panel,
        is_cut_twice: false,
        layer,
        shrink: WAISTBAND_SHRINK,
        arcs,
    }
}
