//! Whether a target is the rest body in another pose, by its edges and sides.

use std::{collections::HashSet, path::Path};

use garnet::{Point3, TriMesh, is_inside_out};

use super::rest_mesh::{other_topology, same_vertices};

/// At least this share of a target's edges are edges of the rest body; those that cut polygons into triangles may be others.
const MIN_SHARE: f64 = 0.5;

/// Edges of a target that are looked at.
const NUM_COMPARED: usize = 2000;

/// A rest body, and its edges.
pub(super) struct Known<'a> {
    rest: &'a TriMesh,
    edges: HashSet<[u32; 2]>,
}

impl<'a> Known<'a> {
    pub(super) fn of(rest: &'a TriMesh) -> Self {
        let faces = rest.faces().iter();
        let edges = faces.flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        Self {
            rest,
            edges: edges.map(sorted).collect(),
        }
    }

    /// Refuses a target that is not the rest body in another pose and shape, whose vertices are at `positions`, in metres,
    /// and whose polygons have `edges`.
    pub(super) fn check(
        &self,
        path: &Path,
        positions: &[Point3],
        edges: &[[u32; 2]],
    ) -> anyhow::Result<()> {
        same_vertices(path, positions, self.rest)?;
        self.check_edges(path, edges)?;
        not_mirrored(path, positions, self.rest)
    }

    /// Refuses a target whose edges are others: its vertices are in another order, though as many.
    fn check_edges(&self, path: &Path, edges: &[[u32; 2]]) -> anyhow::Result<()> {
        let step = edges.len().div_ceil(NUM_COMPARED).max(1);
        let compared = edges.iter().step_by(step);
        let num_compared = compared.len();
        let num_known = compared
            .filter(|&&edge| self.edges.contains(&sorted(edge)))
            .count();
        if num_known as f64 >= MIN_SHARE * num_compared as f64 {
            return Ok(());
        }
        Err(other_topology(
            path,
            format!("{num_known} of {num_compared} of its edges are edges of the rest body"),
        ))
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Refuses a target that is the mirror image of the rest body: its left is the right, and its skin inside out.
fn not_mirrored(path: &Path, positions: &[Point3], rest: &TriMesh) -> anyhow::Result<()> {
    if !is_inside_out(positions, rest.faces()) {
        return Ok(());
    }
    Err(other_topology(
        path,
        "it is the mirror image of the rest body".to_owned(),
    ))
}
