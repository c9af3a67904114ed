//! What every drape is held to.

use garnet::{Body, Point3};
use garnet::{
    BoundGarment, Draper, Garment, Pose, PosedBody, TriMesh,
    untangle::{UntangleOptions, UntangleReport},
};
use garnet_tests::{Judge, Judgement};

/// Rounding of a distance in `f32`, in metres.
pub(crate) const ROUNDING: f32 = 1e-5;

/// The error that is allowed of a whole pipeline, in metres.
pub(crate) const GOLDEN: f32 = 1e-4;

/// Bounds that depend on the scene.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bars {
    pub(crate) stretch_p99: f32,
    pub(crate) stretch_max: f32,
    /// Share of faces that may cross the skin.
    pub(crate) crossing: f32,
}

impl Default for Bars {
    fn default() -> Self {
        Self {
            stretch_p99: 1.35,
            stretch_max: 3.0,
            crossing: 0.005,
        }
    }
}

/// A drape and what was measured of it.
pub(crate) struct Held {
    pub(crate) positions: Vec<Point3>,
    pub(crate) report: UntangleReport,
}

/// Binds, poses, drapes and holds.
pub(crate) fn draped(name: &str, garment: &TriMesh, body: &Body, pose: &Pose, bars: Bars) -> Held {
    let bound = Garment::new(garment.clone()).bind(body).unwrap();
    held(
        name,
        &Judge::new(garment),
        &bound,
        &body.posed(pose).unwrap(),
        bars,
    )
}

/// Drapes and demands: no free vertex inside the body, the clearance kept wherever there is room
/// for it, few faces across the skin, bounded stretch, pieces together; and a report that says so.
pub(crate) fn held(
    name: &str,
    judge: &Judge,
    garment: &BoundGarment,
    body: &PosedBody,
    bars: Bars,
) -> Held {
    let drape = Draper::new(garment.clone()).drape(body).unwrap();
    let report = drape.report.unwrap();
    let judgement = judge.judge(&drape.positions, body.skin());
    let clearance = UntangleOptions::default().clearance;
    let Judgement {
        inside,
        trapped,
        min_distance,
        crossing,
        stretch_p99,
        stretch_max,
        piece_gap,
        ..
    } = judgement;
    let nearer = judgement.num_nearer(clearance - ROUNDING);
    println!(
        "{name}: inside {inside}, trapped {trapped}, nearest {:.2} mm, {nearer} nearer than {:.0} \
         mm, crossing {:.2} %, stretch p99 {stretch_p99:.3} max {stretch_max:.2}, pieces apart \
         {:.1} mm",
        1e3 * min_distance,
        1e3 * clearance,
        1e2 * crossing,
        1e3 * piece_gap,
    );
    assert_eq!(report.inside, 0, "{name}: {report:?}");
    assert_eq!(inside, 0, "{name}: {report:?}");
    // Vertices at one place are one node of the report.
    let node_of_vertex = garment.cloth().weld().node_of_vertex().len();
    let per_node = node_of_vertex.div_ceil(garment.cloth().rest_nodes().len());
    assert!(
        nearer <= report.squeezed * per_node,
        "{name}: {nearer}, {report:?}"
    );
    assert!(crossing <= bars.crossing, "{name}: {crossing}, {report:?}");
    assert!(stretch_p99 <= bars.stretch_p99, "{name}: {stretch_p99}");
    assert!(stretch_max <= bars.stretch_max, "{name}: {stretch_max}");
    assert!(piece_gap <= PIECE_GAP, "{name}: {piece_gap}");
    Held {
        positions: drape.positions,
        report,
    }
}

/// Pieces that touch at rest come no farther apart than this, in metres.
const PIECE_GAP: f32 = 0.006;
