//! Mending cloth that was torn apart.
//!
//! Pushed out node by node, cloth can end up on both sides of an arm that reaches through it. Such
//! cloth starts again: it comes together without regard to the skin and leaves it on one side.

use crate::cloth::{Cloth, HOME_PREFERENCES, Refresh, SWEEPS};
use crate::region::{Region, rings_of};

/// Cloth this far from a torn edge is mended, in metres: the thickness of an arm, which the cloth
/// has gone round on both sides.
const MEND_RADIUS: f32 = 0.04;

/// Sweeps that bring torn cloth together. Too few leave it on both sides of the arm.
const MEND_SWEEPS: usize = 24;

/// Searches for contacts after that, each with its sweeps.
const MEND_SEARCHES: usize = 4;

/// Starts again where the cloth was torn apart: nodes that went round a part of the body on
/// different sides come together without regard to the skin, and leave it on one side. Returns the
/// stretch beyond what counts as torn that is left, summed over torn edges.
pub(crate) fn mend(cloth: &mut Cloth<'_>) -> f32 {
    let mut tears = cloth.tears();
    for preference in HOME_PREFERENCES {
        if tears.nodes.is_empty() {
            break;
        }
        let kept = (cloth.positions.clone(), cloth.contacts.clone());
        cloth.home_preference = preference;
        close_tears(cloth, &tears.nodes);
        let left = cloth.tears();
        if left.excess < tears.excess {
            tears = left;
        } else {
            (cloth.positions, cloth.contacts) = kept;
        }
    }
    cloth.home_preference = HOME_PREFERENCES[0];
    tears.excess
}

fn close_tears(cloth: &mut Cloth<'_>, nodes: &[u32]) {
    let graph = cloth.scene.garment.graph();
    let rings = rings_of(graph, cloth.scale() * MEND_RADIUS).max(2);
    let region = Region::around(graph, nodes.iter().copied(), rings);
    cloth.forget_contacts(&region);
    cloth.sweep(MEND_SWEEPS, &region);
    for _ in 0..MEND_SEARCHES {
        cloth.find_contacts(&region, Refresh::All);
        cloth.sweep(SWEEPS, &region);
    }
    cloth.polish(&region);
}
