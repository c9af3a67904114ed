//! Drawing back cloth that goes round a part of the body.
//!
//! Where a limb folds onto another one, or a thigh rises into a hem, projection can send the cloth
//! before it to both sides of the limb, and a loop of it goes round. What is pulled tighter there
//! only lies tighter on the limb. Cloth has room on the side that it comes from: it bunches. So the
//! loop comes together without regard to lengths and skin, held by the cloth around it alone, and
//! leaves the skin from there.

use garnet_knn::TORN_STRETCH;

use crate::UntangleError;
use crate::cloth::{Cloth, Refresh};
use crate::crossing::Crossing;
use crate::passes::{lift, rescue};
use crate::region::{Region, rings_of};

/// Edges stretched more than this go round a part of the body: easing leaves less of one that is
/// tight alone.
const LOOP_STRETCH: f32 = 1.25 * TORN_STRETCH;

/// Cloth this far from such an edge is drawn back, in metres; the wider ones if a loop is left. The
/// first is half of the way round a wrist, the last that round a thigh with the hem below it.
/// Tried: without the last, a hem stays round a thigh (docs/experiments/068).
const RADII: [f32; 6] = [0.04, 0.06, 0.09, 0.13, 0.18, 0.25];

/// Steps that bring the cloth together, for each edge across it.
const STEPS_PER_RING: usize = 12;

/// As if there were no more edges across it than this: on bodies far larger than their garment
/// there are more than can be waited for.
const MOST_RINGS: usize = 64;

/// Searches for contacts after that, ...
const SEARCHES: usize = 6;

/// ... each with so many steps.
const STEPS: usize = 8;

/// Draws cloth back that goes round a part of the body, and lifts it where it crosses the skin;
/// keeps what lessens such edges, tears no others and lets no more faces cross the skin.
pub(crate) fn retreat(
    cloth: &mut Cloth<'_>,
    mut crossing: Crossing,
) -> Result<Crossing, UntangleError> {
    let mut loops = Loops::of(cloth);
    let mut stuck = free_faces(cloth, &crossing);
    for radius in RADII {
        if loops.nodes.is_empty() {
            break;
        }
        let kept = (
            cloth.positions.clone(),
            cloth.contacts.clone(),
            cloth.clearances.clone(),
        );
        draw_back(cloth, &loops.nodes, radius);
        let layers = &cloth.scene.finder.binding.layers;
        let mut drawn = lift(cloth)?;
        let moved = rescue(cloth, &drawn, |node| !layers.is_follower(node));
        drawn.refresh(cloth, &moved)?;
        let left = Loops::of(cloth);
        let crossing_left = free_faces(cloth, &drawn);
        // Shorter loops are not to strain the cloth around them.
        let is_better = left.excess < loops.excess && left.torn <= loops.torn;
        if is_better && crossing_left <= stuck {
            (loops, stuck, crossing) = (left, crossing_left, drawn);
        } else {
            (cloth.positions, cloth.contacts, cloth.clearances) = kept;
        }
    }
    Ok(crossing)
}

/// Edges that go round a part of the body.
struct Loops {
    /// Their ends.
    nodes: Vec<u32>,
    /// The sum of their stretch beyond the limit.
    excess: f32,
    /// The sum of the stretch of all torn edges beyond what counts as torn, trapped ones, too.
    torn: f32,
}

impl Loops {
    fn of(cloth: &Cloth<'_>) -> Self {
        let edges = cloth.edges_beyond(LOOP_STRETCH);
        let beyond = |edge| cloth.stretch(edge) - LOOP_STRETCH;
        Self {
            excess: edges.iter().map(beyond).sum(),
            torn: cloth.torn_anywhere(),
            nodes: edges.iter().flat_map(|edge| edge.ends).collect(),
        }
    }
}

/// How many faces cross the skin away from trapped nodes.
fn free_faces(cloth: &Cloth<'_>, crossing: &Crossing) -> usize {
    let faces = cloth.scene.garment.faces();
    let is_free = |&&face: &&u32| {
        let corners = faces[face as usize];
        !corners.iter().any(|&node| cloth.is_trapped(node as usize))
    };
    crossing.faces.iter().filter(is_free).count()
}

/// Brings the cloth around `nodes` together, then in front of the skin.
fn draw_back(cloth: &mut Cloth<'_>, nodes: &[u32], radius: f32) {
    let graph = cloth.scene.garment.graph();
    let rings = rings_of(graph, cloth.scale() * radius).max(2);
    let region = Region::around(graph, nodes.iter().copied(), rings);
    cloth.forget_contacts(&region);
    for &node in region.nodes() {
        cloth.clearances[node as usize] = cloth.goal(node as usize);
    }
    for _ in 0..STEPS_PER_RING * rings.min(MOST_RINGS) {
        cloth.smooth(&region);
    }
    for _ in 0..SEARCHES {
        cloth.find_contacts(&region, Refresh::All);
        for _ in 0..STEPS {
            cloth.smooth(&region);
        }
    }
    cloth.polish(&region);
}
