//! Lifting cloth whose triangles cross the skin though their corners are outside.

use crate::UntangleError;
use crate::cloth::{Cloth, Refresh, SWEEPS};
use crate::crossing::{Crossing, raise_clearances};
use crate::region::{Region, rings_of};

/// Searches for contacts while crossing faces are lifted once, each with its sweeps.
const LIFT_SEARCHES: usize = 2;

/// Cloth this far from a crossing face may move while the face is lifted, in metres. Less makes
/// steeper bumps, more moves cloth that lay well.
const LIFT_RADIUS: f32 = 0.03;

/// Lifting must not add more than this to the stretch of torn edges beyond what counts as torn,
/// summed over them, and [so much more for each face](crate::UntangleOptions::lift_excess). Higher
/// trades torn cloth for fewer crossings.
const MAX_ADDED_EXCESS: f32 = 0.5;

/// Corners of triangles that cross the skin keep at most this more than the clearance, in metres: a
/// triangle that needs more is larger than the limb that it crosses.
const MAX_LIFT: f32 = 0.015;

/// Lifts cloth whose triangles cross the skin; returns the faces that still do.
pub(crate) fn lift(cloth: &mut Cloth<'_>) -> Result<Crossing, UntangleError> {
    let mut crossing = Crossing::of(cloth)?;
    let mut fewest = usize::MAX;
    for _ in 0..cloth.scene.options.crossing_rounds {
        let free = free_faces(cloth, &crossing.faces);
        // None are left, or the last round did not lessen them.
        if free.is_empty() || free.len() >= fewest {
            break;
        }
        fewest = free.len();
        if let Some(region) = lift_or_leave(cloth, &free) {
            crossing.refresh(cloth, region.nodes())?;
        }
    }
    Ok(crossing)
}

/// The corners of those faces that have no corner that is trapped or left as it is.
fn free_faces(cloth: &Cloth<'_>, crossing: &[u32]) -> Vec<[u32; 3]> {
    let faces = cloth.scene.garment.faces();
    let is_stuck = |&node: &u32| cloth.is_trapped(node as usize) || cloth.is_left[node as usize];
    let corners = crossing.iter().map(|&face| faces[face as usize]);
    corners
        .filter(|corners| !corners.iter().any(is_stuck))
        .collect()
}

/// Lifts the corners of crossing faces, unless that tears the cloth: then it stays as it was, and
/// is not lifted there again.
fn lift_or_leave(cloth: &mut Cloth<'_>, free: &[[u32; 3]]) -> Option<Region> {
    let before = cloth.tears();
    let kept = (
        cloth.positions.clone(),
        cloth.contacts.clone(),
        cloth.clearances.clone(),
    );
    let region = lift_corners(cloth, free);
    let after = cloth.tears();
    let most = MAX_ADDED_EXCESS + cloth.scene.options.lift_excess * free.len() as f32;
    if after.excess <= before.excess + most {
        return Some(region);
    }
    (cloth.positions, cloth.contacts, cloth.clearances) = kept;
    let graph = cloth.scene.garment.graph();
    let rings = rings_of(graph, cloth.scale() * LIFT_RADIUS).max(2);
    for &node in Region::around(graph, after.nodes, rings).nodes() {
        cloth.is_left[node as usize] = true;
    }
    None
}

/// Lifts the corners of crossing faces; returns the part of the cloth that may have moved.
fn lift_corners(cloth: &mut Cloth<'_>, free: &[[u32; 3]]) -> Region {
    cloth.report.crossing_rounds += 1;
    let graph = cloth.scene.garment.graph();
    let rings = rings_of(graph, cloth.scale() * LIFT_RADIUS).max(2);
    let layers = &cloth.scene.finder.binding.layers;
    let mut seeds: Vec<u32> = free.iter().flatten().copied().collect();
    if !layers.is_single() {
        let mut is_seed = vec![false; cloth.positions.len()];
        for &seed in &seeds {
            is_seed[seed as usize] = true;
        }
        for (node, leads) in layers.leads().rev() {
            if is_seed[node as usize] {
                for lead in leads {
                    is_seed[lead as usize] = true;
                }
                seeds.extend(leads);
            }
        }
    }
    let region = Region::around(graph, seeds, rings);
    let normals = cloth.normals(&region);
    let limit = cloth.scene.options.clearance + cloth.scale() * MAX_LIFT;
    raise_clearances(
        cloth.scene.finder,
        free,
        &cloth.positions,
        |node| normals[region.index_of(node)],
        &cloth.contacts,
        &mut cloth.clearances,
        limit,
    );
    // What lies on other cloth is lifted with it.
    for (node, leads) in layers.leads().rev() {
        let lift = cloth.clearances[node as usize] - cloth.goal(node as usize);
        for lead in leads.map(|lead| lead as usize) {
            cloth.clearances[lead] = cloth.clearances[lead].max(cloth.goal(lead) + lift);
        }
    }
    for _ in 0..LIFT_SEARCHES {
        cloth.find_contacts(&region, Refresh::Moved);
        cloth.sweep(SWEEPS / 2, &region);
    }
    cloth.polish(&region);
    region
}
