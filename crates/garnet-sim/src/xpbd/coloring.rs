//! Groups of constraints that share no vertex.

/// How many colors a mask tells apart.
const MASK_BITS: usize = u128::BITS as usize;

/// The order in which constraints are solved: by color, and by number within a color.
///
/// Greedy: each constraint takes the first color that none of its vertices has. Returns the
/// constraints of each color.
pub(crate) fn colors<const N: usize>(
    num_vertices: usize,
    constraints: impl Iterator<Item = [u32; N]>,
) -> Vec<Vec<u32>> {
    let mut used: Vec<u128> = vec![0; num_vertices];
    let mut colors: Vec<Vec<u32>> = Vec::new();
    for (constraint, vertices) in constraints.enumerate() {
        let taken = vertices
            .iter()
            .fold(0_u128, |taken, &vertex| taken | used[vertex as usize]);
        let color = (!taken).trailing_zeros() as usize;
        // Past the last color of the mask each constraint gets a color of its own.
        let is_past = color >= MASK_BITS;
        if is_past || color >= colors.len() {
            colors.push(Vec::new());
        }
        let color = if is_past { colors.len() - 1 } else { color };
        colors[color].push(constraint as u32);
        if !is_past {
            for vertex in vertices {
                used[vertex as usize] |= 1 << color;
            }
        }
    }
    colors
}

#[cfg(test)]
mod tests {
    use super::*;
    use garnet_mesh::Topology;
    use garnet_mesh::primitives::icosphere;

    #[test]
    fn constraints_of_a_color_share_no_vertex_and_none_is_lost() {
        let mesh = icosphere(3, 1.0);
        let topology = Topology::new(mesh.num_vertices(), mesh.faces());
        let edges = topology.edges();
        let colors = colors(mesh.num_vertices(), edges.iter().copied());
        let mut seen = vec![false; edges.len()];
        for color in &colors {
            let mut is_taken = vec![false; mesh.num_vertices()];
            for &edge in color {
                seen[edge as usize] = true;
                for vertex in edges[edge as usize] {
                    assert!(!std::mem::replace(&mut is_taken[vertex as usize], true));
                }
            }
        }
        assert!(seen.iter().all(|&is_seen| is_seen));
        assert!(colors.len() < 16, "{}", colors.len());
    }

    #[test]
    fn a_star_of_many_edges_takes_a_color_each() {
        let star = (1..200).map(|tip| [0, tip]);
        let colors = colors(200, star);
        assert!(colors.iter().all(|color| color.len() == 1));
        assert_eq!(colors.len(), 199);
    }
}
