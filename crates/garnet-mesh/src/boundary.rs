//! Joins the sides of a boundary into loops.

use std::collections::BTreeMap;

/// Joins directed sides into simple loops, each given once around, starting at its first vertex.
///
/// A walk goes on along a side that leaves the vertex it has reached, or against one that arrives
/// there, and cuts off a loop whenever it meets itself. A walk that cannot go on is given open.
pub(crate) fn boundary_loops(sides: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut at_vertex: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    // Taken from the back: first the sides that leave, in their order.
    for end in [1, 0] {
        for (side, vertices) in sides.iter().enumerate().rev() {
            at_vertex.entry(vertices[end]).or_default().push(side);
        }
    }
    let mut is_used = vec![false; sides.len()];
    let mut loops = Vec::new();
    for first in 0..sides.len() {
        if is_used[first] {
            continue;
        }
        let mut path = vec![sides[first][0]];
        // Where a vertex stands in the path.
        let mut place = BTreeMap::from([(sides[first][0], 0)]);
        let mut next_side = Some(first);
        while let Some(side) = next_side {
            is_used[side] = true;
            let [from, to] = sides[side];
            let reached = if path.last() == Some(&from) { to } else { from };
            if let Some(&start) = place.get(&reached) {
                let cut: Vec<u32> = path.drain(start + 1..).collect();
                for vertex in &cut {
                    place.remove(vertex);
                }
                let whole: Vec<u32> = std::iter::once(reached).chain(cut).collect();
                loops.push(from_smallest(whole));
            } else {
                place.insert(reached, path.len());
                path.push(reached);
            }
            next_side = at_vertex.get_mut(&reached).and_then(|sides| {
                while sides.pop_if(|side| is_used[*side]).is_some() {}
                sides.pop()
            });
        }
        if path.len() > 1 {
            loops.push(path);
        }
    }
    loops.sort_unstable();
    loops
}

fn from_smallest(mut boundary: Vec<u32>) -> Vec<u32> {
    let smallest = (0..boundary.len()).min_by_key(|&index| boundary[index]);
    boundary.rotate_left(smallest.unwrap_or(0));
    boundary
}
