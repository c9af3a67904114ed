//! Cloth that lies on cloth which was moved on its own.

use crate::cloth::Cloth;
use crate::crossing::Crossing;
use crate::passes::verify::inside;

/// Shares of its distance from the cloth that it follows at which a node is tried.
const SHARES: [f32; 4] = [0.7, 0.4, 0.2, 0.05];

/// Puts followers of `moved` nodes where the cloth that they follow has them; returns those.
pub(crate) fn follow(cloth: &mut Cloth<'_>, moved: &[u32]) -> Vec<u32> {
    let layers = &cloth.scene.finder.binding.layers;
    if layers.is_single() {
        return Vec::new();
    }
    let mut is_moved = vec![false; cloth.positions.len()];
    for &node in moved {
        is_moved[node as usize] = true;
    }
    let mut followed = Vec::new();
    for (node, leads) in layers.leads() {
        if leads.iter().any(|&lead| is_moved[lead as usize]) {
            is_moved[node as usize] = true;
            followed.push(node);
        }
    }
    cloth.place_followers();
    followed
}

/// Brings followers that are inside the body nearer to the cloth that they follow, as far as it
/// takes; returns those that come free.
pub(crate) fn flatten(cloth: &mut Cloth<'_>, crossing: &Crossing) -> Vec<u32> {
    let finder = cloth.scene.finder;
    let garment = cloth.scene.garment;
    let is_inside = inside(garment, finder.skin, &cloth.positions, &crossing.faces);
    let mut flattened = Vec::new();
    let is_asked = |node: usize| is_inside[node];
    let layers = &finder.binding.layers;
    let places = layers.lowered(garment.faces(), &cloth.positions, is_asked, &SHARES);
    for (node, places) in places {
        if let Some(free) = places.into_iter().find(|&place| finder.winding(place) == 0) {
            cloth.positions[node as usize] = free;
            flattened.push(node);
        }
    }
    flattened
}
