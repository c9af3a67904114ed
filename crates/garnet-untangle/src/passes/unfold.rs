//! Smoothing cloth that runs through itself, where it has layers.
//!
//! Where limbs close, the warp folds cloth into itself, and a second layer runs through the first
//! one there. Garments of one layer are left as they are.

use garnet_knn::Surface;

use crate::UntangleError;
use crate::cloth::{Cloth, Refresh};
use crate::region::Region;

/// How often crossing cloth is looked for.
const ROUNDS: usize = 8;

/// Cloth this many edges from a crossing face is smoothed.
const RINGS: usize = 2;

/// Steps of smoothing a round.
const STEPS: usize = 10;

/// Smooths cloth of garments with layers where it crosses itself, and keeps it before the skin;
/// tells whether it did.
pub(crate) fn unfold(cloth: &mut Cloth<'_>) -> Result<bool, UntangleError> {
    let binding = cloth.scene.finder.binding;
    if binding.layers.is_single() {
        return Ok(false);
    }
    let garment = cloth.scene.garment;
    let mut surface = binding.surface.moved(cloth.positions.clone())?;
    let mut crossing = layered_pairs(cloth, &surface);
    let mut is_smoothed = false;
    for _ in 0..ROUNDS {
        if crossing.is_empty() {
            break;
        }
        let mut is_seed = vec![false; cloth.positions.len()];
        for node in crossing
            .iter()
            .flatten()
            .flat_map(|&face| garment.faces()[face as usize])
        {
            is_seed[node as usize] = true;
        }
        for (node, leads) in binding.layers.leads().rev() {
            if is_seed[node as usize] {
                for lead in leads {
                    is_seed[lead as usize] = true;
                }
            }
        }
        let seeds = (0..is_seed.len() as u32).filter(|&node| is_seed[node as usize]);
        let region = Region::around(garment.graph(), seeds, RINGS);
        let kept = (cloth.positions.clone(), cloth.contacts.clone());
        for _ in 0..STEPS {
            cloth.smooth(&region);
        }
        cloth.find_contacts(&region, Refresh::Moved);
        cloth.polish(&region);
        surface.refit(&cloth.positions)?;
        let left = layered_pairs(cloth, &surface);
        if left.len() >= crossing.len() {
            (cloth.positions, cloth.contacts) = kept;
            break;
        }
        crossing = left;
        is_smoothed = true;
    }
    Ok(is_smoothed)
}

/// Pairs of faces that cross each other, of which one at least has a layer over or under it.
fn layered_pairs(cloth: &Cloth<'_>, surface: &Surface) -> Vec<[u32; 2]> {
    let layers = &cloth.scene.finder.binding.layers;
    let faces = cloth.scene.garment.faces();
    let is_layered = |face: &u32| {
        let corners = faces[*face as usize].iter();
        corners
            .into_iter()
            .any(|&node| layers.is_layered(node as usize))
    };
    let mut pairs = surface.self_intersections();
    pairs.retain(|pair| pair.iter().any(is_layered));
    pairs
}
