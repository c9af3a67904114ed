//! T-shirt, sweater and dress: the bodice, its sleeves, ribs and skirt.

use crate::curve::{Point2, Polyline, bezier, distance, length, lerp, line, reversed, resampled, spline};
use crate::draft::{Arc, Draft, Layer, Meets, Patch};
use crate::reference::REFERENCE;
use crate::top_start::TopStart;
use crate::wearer::Measures;
use crate::{GarmentKind, Parameters, PatternError, Wearer};

/// Height of the rib around the neck, in metres.
const NECK_RIB: f64 = 0.018;
/// Height of the ribs at cuffs and hem, in metres.
const RIB: f64 = 0.05;
/// Rest lengths of the neck's rib over those of its pattern.
const NECK_SHRINK: f32 = 0.97;
/// Rest lengths of the ribs at cuffs and hem over those of their pattern.
const RIB_SHRINK: f32 = 0.9;
/// How far the back of the neckline lies below the neck's side, in metres.
const BACK_NECK: f64 = 0.025;
/// The armhole is longer than half the sleeve is wide by this factor, so that the sleeve has a cap.
const CAP: f64 = 1.10;
/// The inner leg of a sleeve is at least so long, in metres.
const LEAST_UNDERARM: f64 = 0.03;

/// The lengths of a bodice, in metres, on the body that it is cut for.
struct Bodice {
    /// The neck's side, the tip of the shoulder and the bottom of the armhole.
    neck: Point2,
    tip: Point2,
    underarm: Point2,
    /// From the underarm to the bottom corner.
    side: Polyline,
    armhole: Polyline,
    /// Center of the neckline, front and back.
    neck_front: f64,
    neck_back: f64,
}

impl Bodice {
    fn bottom(&self) -> Point2 {
        self.side[self.side.len() - 1]
    }

    fn neckline(&self, layer: Layer) -> Polyline {
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
    bezier(
        side,
        [side[0] * 0.98, side[1] - 0.62 * drop],
        [side[0] * 0.58, low],
        [0.0, low],
    )
}

/// The bottom corner of the bodice and how it gets there from the underarm.
type Side<'a> = dyn Fn(Point2) -> Polyline + 'a;

fn bodice(
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
    at_least(
        "shoulder seam",
        tip[0] - neck[0],
        0.03,
        "make `neck-width` smaller or `shoulder` larger",
    )?;
    let half_width = 0.25 * cut.chest * (1.0 + parameters.at("chest-ease"));
    let mut depth = cut.armpit_height() - parameters.at("armhole") * scale;
    let mut armhole = armhole_curve([half_width, depth], tip);
    if let Some(sleeve_half) = sleeve_half {
        // A thick arm needs a deeper armhole.
        for _ in 0..20 {
            let missing = CAP * sleeve_half - length(&armhole);
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
        [inner + 0.25 * (underarm[0] - inner), underarm[1] + 0.02 * rise],
        [inner, underarm[1] + 0.30 * rise],
        tip,
    )
}

fn at_least(
    what: &'static str,
    found: f64,
    least: f64,
    hint: &'static str,
) -> Result<(), PatternError> {
    if found >= least {
        return Ok(());
    }
    Err(PatternError::Impossible {
        what,
        found_cm: 100.0 * found,
        least_cm: 100.0 * least,
        hint,
    })
}

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
struct Sleeve {
    cap: Polyline,
    /// From the underarm to the corner of the cuff, above its rib.
    under: Polyline,
    cuff: f64,
    /// The length of the top, with the rib.
    top: f64,
    rib: f64,
}

fn sleeve(
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
    at_least(
        "underarm seam of the sleeve",
        top - height - rib,
        LEAST_UNDERARM,
        "make `sleeve` longer, `sleeve-ease` larger or `armhole` smaller",
    )?;
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
    at_least(
        "side seam",
        bodice.underarm[1] - hem,
        0.08,
        "make `length` longer, or `armhole` or `sleeve-ease` smaller",
    )?;
    let sleeve = sleeve(parameters, cut, half, length(&bodice.armhole), rib)?;
    let start = TopStart::new(
        wearer,
        &crate::top_start::Sizes {
            neck: bodice.neck[0],
            neck_depth: [bodice.neck[1] - bodice.neck_front, bodice.neck[1] - bodice.neck_back],
            side: length(&bodice.side),
            rows: width_rows(&bodice.side, bodice.underarm[1]),
            sleeve: Some((sleeve.top, length(&sleeve.under) + rib)),
            rib,
            neck_rib: NECK_RIB,
        },
    );
    let mut patches = Vec::new();
    for layer in [Layer::Front, Layer::Back] {
        patches.push(bodice_patch(&bodice, layer, &start, is_sweater));
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

/// Half widths by distance below the underarm, top to bottom.
fn width_rows(side: &[Point2], top: f64) -> Vec<(f64, f64)> {
    let rows = resampled(side, 24);
    rows.iter().map(|&[x, y]| (top - y, x)).collect()
}

const fn neck_name(layer: Layer) -> &'static str {
    match layer {
        Layer::Front => "front neck",
        Layer::Back => "back neck",
    }
}

const fn armhole_name(layer: Layer) -> &'static str {
    match layer {
        Layer::Front => "front armhole",
        Layer::Back => "back armhole",
    }
}

fn bodice_patch(bodice: &Bodice, layer: Layer, start: &TopStart, has_rib: bool) -> Patch {
    let (is_front, panel) = match layer {
        Layer::Front => (true, "front"),
        Layer::Back => (false, "back"),
    };
    let bottom = bodice.bottom();
    let neckline = bodice.neckline(layer);
    let low = neckline[neckline.len() - 1];
    let (hem_name, hem_meets) = match (has_rib, is_front) {
        (false, true) => ("front hem", Meets::Rim),
        (false, false) => ("back hem", Meets::Rim),
        (true, true) => ("front rib", Meets::Seam),
        (true, false) => ("back rib", Meets::Seam),
    };
    let middle = if is_front { "front middle" } else { "back middle" };
    let arcs = vec![
        Arc::new(
            hem_name,
            hem_meets,
            false,
            line([0.0, bottom[1]], bottom),
            line([0.0, start.hem()], start.bottom()),
        ),
        Arc::new("side", Meets::Seam, false, reversed(&bodice.side), start.side()).closing(),
        Arc::new(armhole_name(layer), Meets::Seam, false, bodice.armhole.clone(), start.armhole()),
        Arc::new(
            "shoulder",
            Meets::Seam,
            false,
            line(bodice.tip, bodice.neck),
            line(start.tip(), start.neck()),
        )
        .closing(),
        Arc::new(neck_name(layer), Meets::Seam, false, neckline, start.neckline(layer)),
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

fn sleeve_patch(sleeve: &Sleeve, layer: Layer, start: &TopStart) -> Patch {
    let corner = [-sleeve.cuff, sleeve.rib - sleeve.top];
    let cuff = [0.0, corner[1]];
    let (cuff_name, meets) = match (sleeve.rib > 0.0, layer) {
        (false, Layer::Front) => ("front cuff", Meets::Rim),
        (false, Layer::Back) => ("back cuff", Meets::Rim),
        (true, Layer::Front) => ("front cuff rib", Meets::Seam),
        (true, Layer::Back) => ("back cuff rib", Meets::Seam),
    };
    let arcs = vec![
        Arc::new("underarm", Meets::Seam, false, sleeve.under.clone(), start.under_sleeve()).closing(),
        Arc::new(cuff_name, meets, false, line(corner, cuff), start.cuff(0.0)),
        Arc::new("sleeve top", Meets::Fold, false, line(cuff, [0.0, 0.0]), start.sleeve_top()).closing(),
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

/// The rib lies in the plane of the neckline, inside of it.
fn neck_rib(bodice: &Bodice, layer: Layer, start: &TopStart) -> Patch {
    let outer = bodice.neckline(layer);
    let low = outer[outer.len() - 1];
    let along = lerp(bodice.neck, bodice.tip, -NECK_RIB / distance(bodice.neck, bodice.tip));
    let inner = neckline(along, low[1] + NECK_RIB);
    let (panel, free, middle) = match layer {
        Layer::Front => ("front neck rib", "front collar", "front rib middle"),
        Layer::Back => ("back neck rib", "back collar", "back rib middle"),
    };
    let arcs = vec![
        Arc::new(neck_name(layer), Meets::Seam, true, reversed(&outer), reversed(&start.neckline(layer))),
        Arc::new("rib shoulder", Meets::Seam, false, line(bodice.neck, along), line(start.neck(), start.collar())).closing(),
        Arc::new(free, Meets::Rim, false, inner.clone(), start.collar_line(layer)),
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

fn cuff_rib(sleeve: &Sleeve, layer: Layer, start: &TopStart) -> Patch {
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
        Arc::new("cuff rib under", Meets::Seam, false, line(a, d), line(upper[0], lower[0])).closing(),
        Arc::new(free, Meets::Rim, false, line(d, c), lower.clone()),
        Arc::new("cuff rib top", Meets::Fold, false, line(c, b), line(lower[1], upper[1])).closing(),
    ];
    Patch {
        panel: "cuff",
        is_cut_twice: true,
        layer,
        shrink: RIB_SHRINK,
        arcs,
    }
}

fn hem_rib(bodice: &Bodice, layer: Layer, start: &TopStart) -> Patch {
    let corner = bodice.bottom();
    let low = corner[1] - RIB;
    let (panel, seam, free, middle) = match layer {
        Layer::Front => ("front hem rib", "front rib", "front hem", "front hem middle"),
        Layer::Back => ("back hem rib", "back rib", "back hem", "back hem middle"),
    };
    let (upper, lower) = (start.bottom(), start.rib_bottom());
    let arcs = vec![
        Arc::new(free, Meets::Rim, false, line([0.0, low], [corner[0], low]), line([0.0, lower[1]], lower)),
        Arc::new("hem rib side", Meets::Seam, false, line([corner[0], low], corner), line(lower, upper)).closing(),
        Arc::new(seam, Meets::Seam, true, line(corner, [0.0, corner[1]]), line(upper, [0.0, upper[1]])),
        Arc::new(middle, Meets::MiddleFold, false, line([0.0, corner[1]], [0.0, low]), line([0.0, upper[1]], [0.0, lower[1]])),
    ];
    Patch {
        panel,
        is_cut_twice: false,
        layer,
        shrink: RIB_SHRINK,
        arcs,
    }
}
