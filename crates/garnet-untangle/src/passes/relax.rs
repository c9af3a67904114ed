//! Relaxing the strain of the warp.
//!
//! Skinning stretches cloth where limbs spread. The relaxed cloth has the edges of the warp, those
//! that are too long or too short brought to the limit, as nearly as one set of positions can have
//! them: a screened Poisson equation, solved a few times with the edges clamped anew.

use garnet_mesh::{Point3, Vector3};
use garnet_skin::{BoundGarment, ClothGraph, ScreenedPoisson};
use rayon::prelude::*;

use crate::{Binding, UntangleOptions};

/// Edges that one task handles. Results do not depend on it, nor on the number of threads.
const CHUNK: usize = 4096;

/// Lengths below this have no direction, in metres.
const MIN_LENGTH: f32 = 1e-9;

/// Relaxation ends when no larger share of the edges is stretched beyond the limit.
const STRETCHED_SHARE: f32 = 0.005;

/// Steps of relaxation, at most.
const RELAX_STEPS: usize = 6;

/// The range of edge lengths over rest lengths that cloth is relaxed to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StretchRange {
    pub(crate) min: f32,
    pub(crate) max: f32,
}

impl StretchRange {
    /// The range that the options ask for.
    pub(crate) fn of(options: &UntangleOptions) -> Self {
        Self {
            min: options.min_stretch,
            max: options.max_stretch,
        }
    }
}

/// The warp, with its strain relaxed if it has too much: where the cloth is drawn to from then on.
pub(crate) fn relax(
    garment: &BoundGarment,
    binding: &Binding,
    warped: &[Point3],
    options: &UntangleOptions,
) -> Vec<Point3> {
    let mut positions = warped.to_vec();
    let range = StretchRange::of(options);
    let graph = garment.graph();
    for _ in 0..RELAX_STEPS {
        if stretched_share(graph, &positions, options.relax_beyond) <= STRETCHED_SHARE {
            break;
        }
        positions = relaxed(graph, &binding.relax_system, warped, &positions, range);
    }
    positions
}

/// The edges `[edge]` at `positions`, with lengths brought into the range.
pub(crate) fn clamped_edges(
    graph: &ClothGraph,
    positions: &[Point3],
    range: StretchRange,
) -> Vec<Vector3> {
    let clamped = |(&[a, b], &rest_length): (&[u32; 2], &f32)| {
        let edge = positions[b as usize] - positions[a as usize];
        let length = edge.norm().max(MIN_LENGTH);
        let (low, high) = (range.min * rest_length, range.max * rest_length);
        edge * (length.clamp(low, high.max(low)) / length)
    };
    let rest_lengths = graph.rest_lengths().par_iter();
    let edges = graph.edges().par_iter().zip(rest_lengths);
    edges.with_min_len(CHUNK).map(clamped).collect()
}

/// The share of the cloth's own edges that are longer than `limit` times their rest length.
fn stretched_share(graph: &ClothGraph, positions: &[Point3], limit: f32) -> f32 {
    let edges = &graph.edges()[..graph.num_cloth_edges()];
    let is_stretched = |&(&[a, b], rest_length): &(&[u32; 2], &f32)| {
        let edge = positions[b as usize] - positions[a as usize];
        edge.norm_squared() > (limit * rest_length).powi(2)
    };
    let count = edges
        .iter()
        .zip(graph.rest_lengths())
        .filter(is_stretched)
        .count();
    count as f32 / edges.len().max(1) as f32
}

/// One step of relaxation: the positions nearest to having the clamped edges of `positions`, held
/// in place by `warped`.
fn relaxed(
    graph: &ClothGraph,
    system: &ScreenedPoisson,
    warped: &[Point3],
    positions: &[Point3],
    range: StretchRange,
) -> Vec<Point3> {
    let edges = clamped_edges(graph, positions, range);
    let right_side = |node: usize| {
        let mut sum = warped[node].coords * system.screening()[node] as f32;
        for half in graph.half_edges(node) {
            sum -= half.weight * half.sign * edges[half.edge as usize];
        }
        sum
    };
    let right_side: Vec<Vector3> = (0..graph.num_nodes())
        .into_par_iter()
        .with_min_len(CHUNK)
        .map(right_side)
        .collect();
    system
        .solve(&right_side)
        .into_iter()
        .map(Point3::from)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use garnet_mesh::{Topology, primitives};

    const RANGE: StretchRange = StretchRange { min: 0.6, max: 1.1 };

    fn grid_graph() -> (Vec<Point3>, ClothGraph) {
        let grid = primitives::grid(20, 20, [0.5, 0.5]);
        let topology = Topology::new(grid.num_vertices(), grid.faces());
        let graph = ClothGraph::new(grid.positions(), grid.faces(), &topology, &[]);
        (grid.positions().to_vec(), graph)
    }

    fn system(graph: &ClothGraph) -> ScreenedPoisson {
        let screening = graph
            .node_areas()
            .iter()
            .map(|&area| f64::from(area) / 0.04);
        ScreenedPoisson::new(graph, screening.collect()).unwrap()
    }

    #[test]
    fn cloth_at_rest_stays_at_rest() {
        let (rest, graph) = grid_graph();
        let relaxed = relaxed(&graph, &system(&graph), &rest, &rest, RANGE);
        for (before, after) in rest.iter().zip(&relaxed) {
            assert!((after - before).norm() < 1e-6);
        }
    }

    #[test]
    fn a_node_that_is_in_no_face_stays_where_the_warp_has_it() {
        let grid = primitives::grid(20, 20, [0.5, 0.5]);
        let mut places = grid.positions().to_vec();
        places.push(Point3::new(0.1, 1.2, 0.3));
        let topology = Topology::new(places.len(), grid.faces());
        let graph = ClothGraph::new(&places, grid.faces(), &topology, &[]);
        let relaxed = relaxed(&graph, &system(&graph), &places, &places, RANGE);
        let (last, before) = (relaxed.last().unwrap(), places.last().unwrap());
        assert!((last - before).norm() < 1e-5, "{last}");
    }

    #[test]
    fn stretched_cloth_gives_way() {
        let (rest, graph) = grid_graph();
        let torn = |p: &Point3| Point3::new(if p.x > 0.0 { p.x + 0.05 } else { p.x }, p.y, p.z);
        let warped: Vec<Point3> = rest.iter().map(torn).collect();
        let before = stretched_share(&graph, &warped, 1.5);
        let once = relaxed(&graph, &system(&graph), &warped, &warped, RANGE);
        let twice = relaxed(&graph, &system(&graph), &warped, &once, RANGE);
        assert!(before > 0.0);
        assert!(stretched_share(&graph, &twice, 1.5) <= 0.0);
    }
}
