//! Pushing the cloth in front of the skin.

use crate::cloth::{Cloth, Refresh, SWEEPS};
use crate::region::{Region, rings_of};

/// Pushes all nodes in front of the skin, drawing the cloth around them along.
pub(crate) fn push(cloth: &mut Cloth<'_>) {
    let options = cloth.scene.options;
    let lacks = |node: &u32| {
        let contact = &cloth.contacts[*node as usize];
        let is_near = contact.distance < cloth.clearances[*node as usize];
        !contact.is_held && (contact.foreign_parts > 0 || is_near)
    };
    let lacking = (0..cloth.positions.len() as u32).filter(lacks);
    let graph = cloth.scene.garment.graph();
    let region = Region::around(graph, lacking, rings_of(graph, options.push_length));
    for round in 0..options.contact_rounds {
        if round > 0 && !cloth.find_contacts(&region, Refresh::Moved) {
            break;
        }
        cloth.sweep(SWEEPS, &region);
    }
    cloth.polish(&region);
}
