//! From the warp to cloth that lies outside the skin.

use garnet_mesh::Point3;
use garnet_skin::{BoundGarment, PosedBody};

use crate::cloth::Cloth;
use crate::contact::ContactFinder;
use crate::embedded::EmbeddedSkin;
use crate::relax::{StretchRange, clamped_edges, relaxed, stretched_share};
use crate::skin_normals::SkinNormals;
use crate::sweep::Sweeper;
use crate::verify::verified;
use crate::{Binding, UntangleError, UntangleOptions, UntangleReport};

/// The warp is relaxed while edges are stretched by more than this beyond the largest stretch.
const RELAX_BEYOND: f32 = 1.1;

/// Relaxation ends when no larger share of the edges is stretched that much.
const STRETCHED_SHARE: f32 = 0.005;

/// Steps of relaxation, at most.
const RELAX_STEPS: usize = 10;

/// What untangling gives.
#[derive(Debug, Clone)]
pub struct Untangled {
    /// Positions `[node]`, in metres.
    pub positions: Vec<Point3>,
    /// What was found and what is left.
    pub report: UntangleReport,
}

/// Frees a warped garment of penetrations.
///
/// The strain of the warp is relaxed; then nodes are pushed in front of the skin and their
/// neighbours drawn along, so that the displacement is smooth; triangles that still cross the skin
/// are lifted. The result is verified by exact tests.
///
/// # Errors
///
/// [`UntangleError::BodyFaces`] or [`UntangleError::PositionCount`] if the parts do not belong
/// together.
pub fn untangle(
    garment: &BoundGarment,
    binding: &Binding,
    body: &PosedBody,
    warped: &[Point3],
    options: &UntangleOptions,
) -> Result<Untangled, UntangleError> {
    let (found, expected) = (body.skin().faces().len(), garment.rest_skin().faces().len());
    if found != expected {
        return Err(UntangleError::BodyFaces { found, expected });
    }
    let (found, expected) = (warped.len(), garment.rest().len());
    if found != expected {
        return Err(UntangleError::PositionCount { found, expected });
    }
    let embedded = EmbeddedSkin::new(body.skin(), warped)?;
    let skin_normals = SkinNormals::new(body.skin());
    let finder = ContactFinder {
        binding,
        skin: body.skin(),
        embedded: &embedded,
        normals: &skin_normals,
    };
    let anchors = relaxed_warp(garment, binding, warped, options);
    let graph = garment.graph();
    let range = StretchRange {
        min: options.min_stretch,
        max: options.max_stretch,
    };
    let edges = clamped_edges(graph, &anchors, range);
    let strength = 1.0 / (options.push_length * options.push_length);
    let screening: Vec<f32> = graph.node_areas().iter().map(|a| a * strength).collect();
    let sweeper = Sweeper {
        graph,
        anchors: &anchors,
        screening: &screening,
        edges: &edges,
        max_stretch: options.max_stretch,
    };
    let mut cloth = Cloth::new(garment, &finder, &sweeper, options);
    cloth.push_out();
    cloth.mend();
    let mut crossing = cloth.lift_crossing_faces()?;
    if cloth.mend() {
        crossing = cloth.lift_crossing_faces()?;
    }
    let report = verified(garment, &finder, warped, &cloth, &crossing);
    Ok(Untangled {
        positions: cloth.positions,
        report,
    })
}

/// The warp, with its strain relaxed if it has too much.
fn relaxed_warp(
    garment: &BoundGarment,
    binding: &Binding,
    warped: &[Point3],
    options: &UntangleOptions,
) -> Vec<Point3> {
    let mut positions = warped.to_vec();
    let range = StretchRange {
        min: options.min_stretch,
        max: options.max_stretch,
    };
    let graph = garment.graph();
    let limit = RELAX_BEYOND * options.max_stretch;
    for _ in 0..RELAX_STEPS {
        if stretched_share(graph, &positions, limit) <= STRETCHED_SHARE {
            break;
        }
        positions = relaxed(graph, &binding.relax_system, warped, &positions, range);
    }
    positions
}
