//! The set-in sleeve and its cuff.

use crate::bodice::{armhole_name, at_least};
use crate::curve::{Polyline, bezier, length, lerp, line, reversed};
use crate::draft::{Arc, Layer, Meets, Patch};
use crate::reference::REFERENCE;
use crate::top_start::TopStart;
use crate::wearer::Measures;
use crate::{Parameters, PatternError, PatternLength};

/// Rest lengths of the ribs at cuffs and hem over those of their pattern.
pub(crate) const RIB_SHRINK: f32 = 0.9;
/// The inner leg of a sleeve is at least so long, in metres.
const LEAST_UNDERARM: f64 = 0.015;

/// The cap of half a sleeve from the shoulder's tip at the origin to the underarm, as long as the
/// armhole; its height follows.
fn sleeve_cap(half: f64, armhole: f64) -> Polyline {
    let curve = |height: f64| {
        bezier(
            [0.0, 0.0],
            [-0.42 * half, 0.0],
            [-0.52 * half, -height],
            [-half, -height],
        )
    };
    let (mut low, mut high) = (0.0, armhole);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if length(&curve(middle)) < armhole {
            low = middle;
        } else {
            high = middle;
        }
    }
    curve(0.5 * (low + high))
}

/// Half a sleeve, seen with its top at x = 0 and the front at negative x.
pub(crate) struct Sleeve {
    cap: Polyline,
    /// From the underarm to the corner of the cuff, above its rib.
    pub(crate) under: Polyline,
    cuff: f64,
    /// The length of the top, with the rib.
    pub(crate) top: f64,
    rib: f64,
}

pub(crate) fn sleeve(
    parameters: &Parameters,
    cut: &Measures,
    half: f64,
    armhole: f64,
    rib: f64,
) -> Result<Sleeve, PatternError> {
    let arm_scale = cut.arm_length / REFERENCE.measures.arm_length;
    let top = parameters.at("sleeve") * arm_scale;
    let cap = sleeve_cap(half, armhole);
    let height = -cap[cap.len() - 1][1];
    at_least(PatternLength::Underarm, top - height - rib, LEAST_UNDERARM)?;
    let girth = if rib > 0.0 { cut.wrist } else { cut.upper_arm };
    let cuff = (0.5 * girth * (1.0 + parameters.at("cuff-ease"))).min(half);
    // Above a rib the sleeve is a little fuller than the rib.
    let corner = [-cuff, rib - top];
    let underarm = [-half, -height];
    let bend = 0.35 * (underarm[1] - corner[1]);
    let under = bezier(
        underarm,
        [lerp(underarm, corner, 0.4)[0], underarm[1] - bend],
        [lerp(underarm, corner, 0.85)[0], corner[1] + bend],
        corner,
    );
    Ok(Sleeve {
        cap,
        under,
        cuff,
        top,
        rib,
    })
}

pub(crate) fn sleeve_patch(sleeve: &Sleeve, layer: Layer, start: &TopStart) -> Patch {
    let corner = [-sleeve.cuff, sleeve.rib - sleeve.top];
    let cuff = [0.0, corner[1]];
    let (cuff_name, meets) = match (sleeve.rib > 0.0, layer) {
        (false, Layer::Front) => ("front cuff", Meets::Rim),
        (false, Layer::Back) => ("back cuff", Meets::Rim),
        (true, Layer::Front) => ("front cuff rib", Meets::Seam),
        (true, Layer::Back) => ("back cuff rib", Meets::Seam),
    };
    let arcs = vec![
        Arc::new(
            "underarm",
            Meets::Seam,
            false,
            sleeve.under.clone(),
            start.under_sleeve(),
        )
        .closing(),
        Arc::new(cuff_name, meets, false, line(corner, cuff), start.cuff(0.0)),
        Arc::new(
            "sleeve top",
            Meets::Fold,
            false,
            line(cuff, [0.0, 0.0]),
            start.sleeve_top(),
        )
        .closing(),
        Arc::new(
            armhole_name(layer),
            Meets::Seam,
            true,
            sleeve.cap.clone(),
            reversed(&start.armhole()),
        ),
    ];
    Patch {
        panel: "sleeve",
        is_cut_twice: true,
        layer,
        shrink: 1.0,
        arcs,
    }
}

pub(crate) fn cuff_rib(sleeve: &Sleeve, layer: Layer, start: &TopStart) -> Patch {
    let top = sleeve.rib - sleeve.top;
    let [a, b] = [[-sleeve.cuff, top], [0.0, top]];
    let [c, d] = [[0.0, -sleeve.top], [-sleeve.cuff, -sleeve.top]];
    let (seam, free) = match layer {
        Layer::Front => ("front cuff rib", "front cuff"),
        Layer::Back => ("back cuff rib", "back cuff"),
    };
    let (upper, lower) = (start.cuff(0.0), start.cuff(1.0));
    let arcs = vec![
        Arc::new(seam, Meets::Seam, true, line(b, a), reversed(&upper)),
        Arc::new(
            "cuff rib under",
            Meets::Seam,
            false,
            line(a, d),
            line(upper[0], lower[0]),
        )
        .closing(),
        Arc::new(free, Meets::Rim, false, line(d, c), lower.clone()),
        Arc::new(
            "cuff rib top",
            Meets::Fold,
            false,
            line(c, b),
            line(lower[1], upper[1]),
        )
        .closing(),
    ];
    Patch {
        panel: "cuff",
        is_cut_twice: true,
        layer,
        shrink: RIB_SHRINK,
        arcs,
    }
}
