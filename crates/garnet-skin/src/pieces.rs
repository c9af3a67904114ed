//! Loose pieces: buttons and pockets that are not joined to the cloth they sit on.

use garnet_knn::{KnnError, VertexTree};
use garnet_mesh::{Point3, Topology};

/// A component with at least this share of the largest one's vertices' area is cloth of its own.
const MAIN_CLOTH_SHARE: f64 = 0.2;

/// A piece touches the cloth where it is no farther from it than this, in metres.
const TOUCH_DISTANCE: f32 = 0.015;

/// A piece sits on the cloth if more than this share of it touches.
const TOUCHING_SHARE: f64 = 0.5;

/// Which nodes belong to loose pieces, and the edges that tie these to the cloth.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pieces {
    /// Whether each node belongs to a piece `[node]`.
    pub(crate) is_piece: Vec<bool>,
    /// Edges from each touching node of a piece to the nearest node of the cloth.
    pub(crate) stitches: Vec<[u32; 2]>,
}

impl Pieces {
    /// Finds the components of the cloth that are small and lie on a larger one.
    pub(crate) fn new(
        positions: &[Point3],
        topology: &Topology,
        node_areas: &[f64],
        scale: f32,
    ) -> Result<Self, KnnError> {
        let components = topology.components();
        let mut areas = vec![0.0_f64; topology.num_components()];
        for (node, &area) in node_areas.iter().enumerate() {
            areas[components[node] as usize] += area;
        }
        let largest = areas.iter().copied().fold(0.0, f64::max);
        let is_main = |node: usize| {
            let area = areas[components[node] as usize];
            area > 0.0 && area >= MAIN_CLOTH_SHARE * largest
        };
        let (main, rest): (Vec<u32>, Vec<u32>) =
            (0..positions.len() as u32).partition(|&node| is_main(node as usize));
        let mut pieces = Self {
            is_piece: vec![false; positions.len()],
            stitches: Vec::new(),
        };
        if rest.is_empty() {
            return Ok(pieces);
        }
        let main_positions: Vec<Point3> = main.iter().map(|&n| positions[n as usize]).collect();
        let tree = VertexTree::new(&main_positions)?;
        let mut touching = vec![Vec::new(); areas.len()];
        let mut sizes = vec![0_usize; areas.len()];
        for &node in &rest {
            let component = components[node as usize] as usize;
            if areas[component] <= 0.0 {
                continue;
            }
            sizes[component] += 1;
            let nearest = tree.nearest(positions[node as usize]);
            if let Some(near) = nearest
                && near.distance_squared <= (scale * TOUCH_DISTANCE).powi(2)
            {
                touching[component].push([node, main[near.index as usize]]);
            }
        }
        for &node in &rest {
            let component = components[node as usize] as usize;
            let share = touching[component].len() as f64 / sizes[component].max(1) as f64;
            pieces.is_piece[node as usize] = share > TOUCHING_SHARE;
        }
        for stitches in touching {
            let sits = |[node, _]: &[u32; 2]| pieces.is_piece[*node as usize];
            if stitches.first().is_some_and(sits) {
                pieces.stitches.extend(stitches);
            }
        }
        pieces.stitches.sort_unstable();
        Ok(pieces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use garnet_mesh::primitives;

    #[test]
    fn a_button_is_tied_to_the_cloth_below_it() {
        let cloth = primitives::grid(20, 20, [0.4, 0.4]);
        let button = primitives::grid(2, 2, [0.01, 0.01]);
        let mut positions = cloth.positions().to_vec();
        let first = positions.len() as u32;
        let normal = (cloth.positions()[1] - cloth.positions()[0])
            .cross(&(cloth.positions()[25] - cloth.positions()[0]))
            .normalize();
        positions.extend(
            button
                .positions()
                .iter()
                .map(|point| point + 0.002 * normal),
        );
        let mut faces = cloth.faces().to_vec();
        faces.extend(button.faces().iter().map(|face| face.map(|v| v + first)));
        let topology = Topology::new(positions.len(), &faces);
        let areas = vec![1.0; positions.len()];
        let pieces = Pieces::new(&positions, &topology, &areas, 1.0).unwrap();
        assert!(pieces.is_piece[first as usize..].iter().all(|&piece| piece));
        assert!(!pieces.is_piece[..first as usize].iter().any(|&piece| piece));
        assert_eq!(pieces.stitches.len(), button.num_vertices());
    }
}
