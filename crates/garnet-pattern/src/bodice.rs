//! The bodice of shirts and dresses.

use crate::curve::{Point2, Polyline, bezier, length, line, resampled, reversed};
use crate::draft::{Arc, Layer, Meets, Patch};
use crate::reference::REFERENCE;
use crate::top_start::TopStart;
use crate::wearer::Measures;
use crate::{Parameters, PatternError, PatternLength};

/// How far the back of the neckline lies below the neck's side, in metres.
const BACK_NECK: f64 = 0.025;
/// The armhole is longer than half the sleeve is wide by these factors, so that the sleeve has a
/// cap, and not too high a one.
const CAP: [f64; 2] = [1.06, 1.22];

/// The lengths of a bodice, in metres, on the body that it is cut for.
pub(crate) struct Bodice {
    /// The neck's side, the tip of the shoulder and the bottom of the armhole.
    pub(crate) neck: Point2,
    pub(crate) tip: Point2,
    pub(crate) underarm: Point2,
    /// From the underarm to the bottom corner.
    pub(crate) side: Polyline,
    pub(crate) armhole: Polyline,
    /// Center of the neckline, front and back.
    pub(crate) neck_front: f64,
    pub(crate) neck_back: f64,
}

impl Bodice {
    /// Half the width of a sleeve that wants to be `half` wide: more where the armhole is long.
    pub(crate) fn sleeve_half(&self, half: f64) -> f64 {
        half.max(length(&self.armhole) / CAP[1])
    }

    pub(crate) fn bottom(&self) -> Point2 {
        self.side[self.side.len() - 1]
    }

    pub(crate) fn neckline(&self, layer: Layer) -> Polyline {
        let low = match layer {
            Layer::Front => self.neck_front,
            Layer::Back => self.neck_back,
        };
        neckline(self.neck, low)
    }
}

/// From the neck's side to the middle: round at the corner, level in the middle.
fn neckline(side: Point2, low: f64) -> Polyline {
    let drop = side[1] - low;
    // A shallow neckline leaves the shoulder flatter: its corner stays round.
    let shallow = (1.0 - drop / side[0]).max(0.0);
    bezier(
        side,
        [
            side[0] * (0.98 - 0.22 * shallow),
            side[1] - (0.62 + 0.22 * shallow) * drop,
        ],
        [side[0] * 0.58, low],
        [0.0, low],
    )
}

/// The bottom corner of the bodice and how it gets there from the underarm.
pub(crate) type Side<'a> = dyn Fn(Point2) -> Polyline + 'a;

pub(crate) fn bodice(
    parameters: &Parameters,
    cut: &Measures,
    sleeve_half: Option<f64>,
    side: &Side<'_>,
) -> Result<Bodice, PatternError> {
    let neck_scale = cut.neck / REFERENCE.measures.neck;
    let scale = cut.stature / REFERENCE.measures.stature;
    let neck = [
        0.5 * parameters.at("neck-width") * neck_scale,
        cut.neck_height,
    ];
    let tip = [
        0.5 * cut.shoulder_breadth + parameters.at("shoulder"),
        cut.shoulder_height + 0.010 * scale,
    ];
    at_least(PatternLength::Shoulder, tip[0] - neck[0], 0.03)?;
    let half_width = 0.25 * cut.chest * (1.0 + parameters.at("chest-ease"));
    let mut depth = cut.armpit_height() - parameters.at("armhole") * scale;
    let mut armhole = armhole_curve([half_width, depth], tip);
    if let Some(sleeve_half) = sleeve_half {
        // A thick arm needs a deeper armhole.
        for _ in 0..20 {
            let missing = CAP[0] * sleeve_half - length(&armhole);
            if missing < 1e-4 {
                break;
            }
            depth -= missing;
            armhole = armhole_curve([half_width, depth], tip);
        }
    }
    let underarm = [half_width, depth];
    let neck_front = neck[1] - parameters.at("neck-depth") * neck_scale;
    Ok(Bodice {
        neck,
        tip,
        underarm,
        side: side(underarm),
        armhole,
        neck_front,
        neck_back: neck[1] - BACK_NECK * neck_scale,
    })
}

/// From the underarm to the tip of the shoulder, hollowed towards the body.
fn armhole_curve(underarm: Point2, tip: Point2) -> Polyline {
    let inner = underarm[0].min(tip[0]) - 0.022;
    let rise = tip[1] - underarm[1];
    bezier(
        underarm,
        [
            inner + 0.25 * (underarm[0] - inner),
            underarm[1] + 0.02 * rise,
        ],
        [inner, underarm[1] + 0.30 * rise],
        tip,
    )
}

pub(crate) fn at_least(what: PatternLength, found: f64, least: f64) -> Result<(), PatternError> {
    if found >= least {
        return Ok(());
    }
    Err(PatternError::Impossible {
        what,
        found_cm: 100.0 * found,
        least_cm: 100.0 * least,
    })
}

/// Half widths by distance below the underarm, top to bottom.
pub(crate) fn width_rows(side: &[Point2], top: f64) -> Vec<(f64, f64)> {
    let rows = resampled(side, 24);
    rows.iter().map(|&[x, y]| (top - y, x)).collect()
}

pub(crate) const fn neck_name(layer: Layer) -> &'static str {
    match layer {
        Layer::Front => "front neck",
        Layer::Back => "back neck",
    }
}

pub(crate) const fn armhole_name(layer: Layer) -> &'static str {
    match layer {
        Layer::Front => "front armhole",
        Layer::Back => "back armhole",
    }
}

/// What the bodice is sewn to.
pub(crate) struct Edge {
    /// The names of its bottom, front and back.
    pub(crate) bottom: [&'static str; 2],
    pub(crate) bottom_meets: Meets,
    pub(crate) armhole_meets: Meets,
    pub(crate) neck_meets: Meets,
}

pub(crate) fn bodice_patch(bodice: &Bodice, layer: Layer, start: &TopStart, edge: &Edge) -> Patch {
    let (is_front, panel) = match layer {
        Layer::Front => (true, "front"),
        Layer::Back => (false, "back"),
    };
    let bottom = bodice.bottom();
    let neckline = bodice.neckline(layer);
    let low = neckline[neckline.len() - 1];
    let middle = if is_front {
        "front middle"
    } else {
        "back middle"
    };
    let arcs = vec![
        Arc::new(
            edge.bottom[layer as usize],
            edge.bottom_meets,
            false,
            line([0.0, bottom[1]], bottom),
            line([0.0, start.hem()], start.bottom()),
        ),
        Arc::new(
            "side",
            Meets::Seam,
            false,
            reversed(&bodice.side),
            start.side(),
        )
        .closing(),
        Arc::new(
            armhole_name(layer),
            edge.armhole_meets,
            false,
            bodice.armhole.clone(),
            start.armhole(),
        )
        .guiding(),
        Arc::new(
            "shoulder",
            Meets::Seam,
            false,
            line(bodice.tip, bodice.neck),
            line(start.tip(), start.neck()),
        )
        .closing(),
        Arc::new(
            neck_name(layer),
            edge.neck_meets,
            false,
            neckline,
            start.neckline(layer),
        )
        .guiding(),
        Arc::new(
            middle,
            Meets::MiddleFold,
            false,
            line(low, [0.0, bottom[1]]),
            line([0.0, start.neck_low(layer)], [0.0, start.hem()]),
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
