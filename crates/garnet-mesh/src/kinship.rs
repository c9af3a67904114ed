//! Whether a mesh is another one in another pose and shape: by the lengths of its edges, its edges,
//! and its sides.

use std::collections::HashSet;

use crate::edges::sides;
use crate::{Point3, TriMesh, edge_stretches, is_inside_out};

/// How two sets of positions of one mesh are related.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kinship {
    /// Edges are `ratio` times as long, but for pose and shape.
    Scaled {
        /// The median of the ratios.
        ratio: f32,
    },
    /// Edges have nothing to do with each other.
    Stranger,
}

/// Faces whose edges are compared in length.
const NUM_FACES: usize = 4000;

/// How much more the longest edges of one mesh may be stretched than the median ones.
const MAX_SPREAD: f32 = 8.0;

/// The stretch that one edge in ten exceeds may be so many times the one that nine in ten exceed:
/// far more than between bodies of one topology, and less than between a body and itself with its
/// vertices in another order, since places of one body, anyhow mixed, have no long tail.
const MAX_RANGE: f32 = 4.0;

/// Compares edge lengths, which a pose hardly changes.
///
/// ```
/// use garnet_mesh::{Kinship, Point3, kinship, primitives::capsule};
///
/// let body = capsule(0.2, 1.4, 16, 12);
/// let in_mm: Vec<Point3> = body.positions().iter().map(|place| place * 1e3).collect();
/// let Kinship::Scaled { ratio } = kinship(body.positions(), &in_mm, body.faces()) else {
///     panic!("a mesh is of its own kin");
/// };
/// assert!((ratio - 1e3).abs() < 1.0);
/// ```
pub fn kinship(rest: &[Point3], other: &[Point3], faces: &[[u32; 3]]) -> Kinship {
    let step = faces.len().div_ceil(NUM_FACES).max(1);
    let edges: Vec<[u32; 2]> = faces.iter().step_by(step).flat_map(sides).collect();
    let Ok(mut stretches) = edge_stretches(rest, other, &edges) else {
        return Kinship::Stranger;
    };
    if stretches.is_empty() {
        return Kinship::Stranger;
    }
    stretches.sort_unstable_by(f32::total_cmp);
    let last = stretches.len() - 1;
    let at = |percent: usize| stretches[(last * percent).div_ceil(100)];
    let median = at(50);
    if median <= 0.0 || at(99) > MAX_SPREAD * median || at(90) > MAX_RANGE * at(10) {
        return Kinship::Stranger;
    }
    Kinship::Scaled { ratio: median }
}

/// At least this share of a mesh's edges are edges of the known one; those that cut polygons into
/// triangles may be others.
const MIN_SHARE: f64 = 0.5;

/// Edges of a mesh that are looked for in the known one.
const NUM_EDGES: usize = 2000;

/// A mesh that others are compared with, and its edges.
#[derive(Debug, Clone)]
pub struct KnownMesh<'a> {
    mesh: &'a TriMesh,
    edges: HashSet<[u32; 2]>,
}

/// What tells that a mesh is not a known one in another pose and shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshDifference {
    /// It has more or fewer vertices.
    VertexCount {
        /// Its vertices.
        found: usize,
        /// Those of the known mesh.
        expected: usize,
    },
    /// Vertices that are neighbours in the known mesh are far from each other.
    Order,
    /// Most of its edges are none of the known mesh.
    Edges {
        /// Edges that the known mesh has, too.
        known: usize,
        /// Edges that were looked at.
        compared: usize,
    },
    /// Its left is the right, and its outside the inside.
    Mirrored,
}

impl MeshDifference {
    /// The difference in words; `known` stands for the known mesh: "the rest body", say.
    pub fn described(self, known: &str) -> String {
        match self {
            Self::VertexCount { found, expected } => {
                format!("it has {found} vertices, {known} has {expected}")
            }
            Self::Order => {
                format!("its vertices are in another order than those of {known}")
            }
            Self::Edges {
                known: num_known,
                compared,
            } => format!("{num_known} of {compared} of its edges are edges of {known}"),
            Self::Mirrored => {
                format!("it is the mirror image of {known}, or its vertices are in another order")
            }
        }
    }
}

impl<'a> KnownMesh<'a> {
    /// A mesh to compare others with.
    pub fn of(mesh: &'a TriMesh) -> Self {
        let edges = mesh.faces().iter().flat_map(sides);
        Self {
            mesh,
            edges: edges.map(sorted).collect(),
        }
    }

    /// The mesh that others are compared with.
    pub const fn mesh(&self) -> &'a TriMesh {
        self.mesh
    }

    /// Refuses a mesh of another number of vertices.
    ///
    /// # Errors
    ///
    /// [`MeshDifference::VertexCount`].
    pub fn check_count(&self, found: usize) -> Result<(), MeshDifference> {
        let expected = self.mesh.num_vertices();
        if found == expected {
            return Ok(());
        }
        Err(MeshDifference::VertexCount { found, expected })
    }

    /// Refuses a mesh whose vertices are others, or in another order. Its vertices are at
    /// `positions` `[vertex]`, in any unit, and its polygons have `edges`; none if it has no
    /// polygons. Returns how many times as long its edges are, as a power of ten: between strangers
    /// they may all be longer.
    ///
    /// ```
    /// use garnet_mesh::{KnownMesh, primitives::icosphere};
    ///
    /// let ball = icosphere(1, 1.0);
    /// let known = KnownMesh::of(&ball);
    /// assert_eq!(known.check_order(ball.positions(), &[]), Ok(0));
    /// let difference = known.check_order(ball.positions(), &[[0, 3], [0, 6], [1, 2]]).unwrap_err();
    /// assert_eq!(difference.described("the ball"), "0 of 3 of its edges are edges of the ball");
    /// ```
    ///
    /// # Errors
    ///
    /// [`MeshDifference`], all but [`MeshDifference::Mirrored`].
    pub fn check_order(
        &self,
        positions: &[Point3],
        edges: &[[u32; 2]],
    ) -> Result<i32, MeshDifference> {
        self.check_count(positions.len())?;
        let kin = kinship(self.mesh.positions(), positions, self.mesh.faces());
        let Kinship::Scaled { ratio } = kin else {
            return Err(MeshDifference::Order);
        };
        self.check_edges(edges)?;
        Ok(ratio.log10().round() as i32)
    }

    /// The same, and refuses a mesh that is the mirror image of the known one, which is to enclose
    /// a volume. Its positions are in the unit of the known mesh.
    ///
    /// # Errors
    ///
    /// [`MeshDifference`].
    pub fn check(&self, positions: &[Point3], edges: &[[u32; 2]]) -> Result<i32, MeshDifference> {
        let decades = self.check_order(positions, edges)?;
        match (is_inside_out(positions, self.mesh.faces()), decades) {
            (false, _) => Ok(decades),
            (true, 0) => Err(MeshDifference::Mirrored),
            // Edges between vertices that lie anywhere are longer, and their faces look anywhere.
            (true, _) => Err(MeshDifference::Order),
        }
    }

    /// Refuses edges that are others: vertices are in another order, though as many.
    fn check_edges(&self, edges: &[[u32; 2]]) -> Result<(), MeshDifference> {
        let step = edges.len().div_ceil(NUM_EDGES).max(1);
        let looked_at = edges.iter().step_by(step);
        let compared = looked_at.len();
        let known = looked_at
            .filter(|&&edge| self.edges.contains(&sorted(edge)))
            .count();
        if known as f64 >= MIN_SHARE * compared as f64 {
            return Ok(());
        }
        Err(MeshDifference::Edges { known, compared })
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Topology;
    use crate::primitives::capsule;

    fn body() -> TriMesh {
        capsule(0.2, 1.4, 16, 12)
    }

    #[test]
    fn a_mesh_is_known_at_another_scale_and_strangers_are_told_apart() {
        let body = body();
        let rest = body.positions();
        let scaled: Vec<Point3> = rest.iter().map(|point| point * 110.0).collect();
        let found = kinship(rest, &scaled, body.faces());
        assert!(
            matches!(found, Kinship::Scaled { ratio } if (ratio - 110.0).abs() < 0.1),
            "{found:?}"
        );
        let shuffled: Vec<Point3> = (0..rest.len()).map(|i| rest[i * 7 % rest.len()]).collect();
        assert_eq!(kinship(rest, &shuffled, body.faces()), Kinship::Stranger);
        let flat = vec![Point3::origin(); rest.len()];
        assert_eq!(kinship(rest, &flat, body.faces()), Kinship::Stranger);
    }

    #[test]
    fn what_differs_from_a_known_mesh_is_told() {
        let body = body();
        let (known, rest) = (KnownMesh::of(&body), body.positions());
        let topology = Topology::new(body.num_vertices(), body.faces());
        let edges = topology.edges();
        assert_eq!(known.check(rest, edges), Ok(0));

        let expected = rest.len();
        let found = expected - 1;
        assert_eq!(
            known.check(&rest[1..], edges),
            Err(MeshDifference::VertexCount { found, expected })
        );
        let renumbered = |vertex: u32| vertex * 7 % expected as u32;
        let others: Vec<[u32; 2]> = edges.iter().map(|edge| edge.map(renumbered)).collect();
        assert!(matches!(
            known.check(rest, &others),
            Err(MeshDifference::Edges { .. })
        ));
        let shuffled: Vec<Point3> = (0..expected).map(|i| rest[i * 7 % expected]).collect();
        assert_eq!(known.check(&shuffled, &[]), Err(MeshDifference::Order));
        let mirrored: Vec<Point3> = rest.iter().map(|p| Point3::new(-p.x, p.y, p.z)).collect();
        assert_eq!(known.check(&mirrored, edges), Err(MeshDifference::Mirrored));
        let longer: Vec<Point3> = mirrored.iter().map(|p| p * 30.0).collect();
        assert_eq!(known.check(&longer, edges), Err(MeshDifference::Order));
        assert_eq!(known.check_order(&mirrored, edges), Ok(0));
    }
}
