//! Which faces of a garment are simulated: those of which cloth can be made.
//!
//! Garments as people have them have faces without area, faces that are there twice (both sides of
//! a sheet), and faces that look to different sides.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use garnet_mesh::Topology;
use garnet_sim::RestShape;
use garnet_skin::BoundGarment;

/// Faces between nodes, without those of loose pieces, without area, or that are there twice; faces
/// that share an edge look to one side where they can.
pub(crate) fn simulated_faces(garment: &BoundGarment) -> Vec<[u32; 3]> {
    let is_piece = garment.is_piece();
    let place = |node: u32| garment.rest_nodes()[node as usize];
    let mut seen = BTreeSet::new();
    let is_cloth = |face: &&[u32; 3]| {
        let mut sorted = **face;
        sorted.sort_unstable();
        !face.iter().any(|&node| is_piece[node as usize])
            && RestShape::has_area(face.map(place))
            && seen.insert(sorted)
    };
    let faces: Vec<[u32; 3]> = garment.faces().iter().filter(is_cloth).copied().collect();
    let topology = Topology::new(garment.rest_nodes().len(), &faces);
    if topology.inconsistent_edges().is_empty() {
        return faces;
    }
    turned(&topology)
}

/// The faces with as few as possible turned so that neighbours look to one side, patch by patch.
fn turned(topology: &Topology) -> Vec<[u32; 3]> {
    let mut faces = topology.faces().to_vec();
    let mut across: BTreeMap<u32, Vec<(u32, bool)>> = BTreeMap::new();
    for (edge, &[low, high]) in topology.edges().iter().enumerate() {
        let &[first, second] = topology.edge_faces(edge) else {
            continue;
        };
        let runs_along = |face: u32| {
            let [a, b, c] = faces[face as usize];
            [(a, b), (b, c), (c, a)].contains(&(low, high))
        };
        let differs = runs_along(first) == runs_along(second);
        across.entry(first).or_default().push((second, differs));
        across.entry(second).or_default().push((first, differs));
    }
    let mut is_turned: Vec<Option<bool>> = vec![None; faces.len()];
    for start in 0..faces.len() as u32 {
        if is_turned[start as usize].is_some() {
            continue;
        }
        is_turned[start as usize] = Some(false);
        let (mut patch, mut queue) = (vec![start], VecDeque::from([start]));
        while let Some(face) = queue.pop_front() {
            let own = is_turned[face as usize] == Some(true);
            for &(other, differs) in across.get(&face).into_iter().flatten() {
                if is_turned[other as usize].is_none() {
                    is_turned[other as usize] = Some(own != differs);
                    patch.push(other);
                    queue.push_back(other);
                }
            }
        }
        let count = patch
            .iter()
            .filter(|&&face| is_turned[face as usize] == Some(true));
        let most_are = 2 * count.count() > patch.len();
        for face in patch {
            if (is_turned[face as usize] == Some(true)) != most_are {
                faces[face as usize].swap(1, 2);
            }
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;
    use garnet_mesh::primitives::tube;

    #[test]
    fn faces_that_look_to_the_other_side_are_turned() {
        let tube = tube(0.2, 0.6, 16, 4);
        let mut faces = tube.faces().to_vec();
        for face in [3, 4, 17, 40] {
            faces[face].swap(1, 2);
        }
        let count = tube.num_vertices();
        assert_eq!(turned(&Topology::new(count, &faces)), tube.faces());
        // The many decide.
        let all: Vec<[u32; 3]> = tube.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
        let mut most = all.clone();
        most[7].swap(1, 2);
        assert_eq!(turned(&Topology::new(count, &most)), all);
    }
}
