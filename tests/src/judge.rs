//! What a drape must hold, measured apart from the code that made it.

use garnet::{Point3, TriMesh};
use garnet_knn::{Surface, VertexTree};
use garnet_mesh::{Topology, face_normals};

/// How far in front of a face the body is probed, in metres.
const PROBE: f32 = 5e-4;

/// Skin this near to embedded skin leaves no room, in metres.
const TRAP: f32 = 0.01;

/// Edges shorter than this at rest have no stretch, in metres.
const SHORTEST_EDGE: f32 = 1e-6;

/// Pieces nearer than this at rest belong together, in metres.
const PIECES_TOUCH: f32 = 0.015;

/// Measures drapes of one garment.
#[derive(Debug, Clone)]
pub struct Judge {
    rest: TriMesh,
    edges: Vec<[u32; 2]>,
    topology: Topology,
}

/// What was measured of one drape. Vertices that no face uses are left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// Vertices with room that are inside the body: winding number above 0.5.
    pub inside: usize,
    /// Vertices caught where the body runs through itself: their closest face, or a face whose
    /// center is within 10 mm of their closest point, lies inside another part of the body.
    pub trapped: usize,
    /// Smallest distance to the skin of vertices outside and not trapped, in metres.
    pub min_distance: f32,
    /// Distances to the skin of vertices outside and not trapped, sorted, in metres.
    pub distances: Vec<f32>,
    /// Share of the triangles that cross the skin and have no trapped vertex.
    pub crossing: f32,
    /// 99th percentile of edge length over rest length, without edges at trapped vertices.
    pub stretch_p99: f32,
    /// Largest edge length over rest length, without edges at trapped vertices.
    pub stretch_max: f32,
    /// How far a piece that touched others at rest moved away from them, in metres.
    pub piece_gap: f32,
}

impl Judgement {
    /// How many vertices outside and not trapped are nearer to the skin than a distance in metres.
    pub fn num_nearer(&self, distance: f32) -> usize {
        self.distances.partition_point(|&d| d < distance)
    }
}

impl Judge {
    /// A judge for a garment at rest; stretch is measured on the edges of its triangles.
    pub fn new(rest: &TriMesh) -> Self {
        let topology = Topology::new(rest.num_vertices(), rest.faces());
        Self {
            rest: rest.clone(),
            edges: topology.edges().to_vec(),
            topology,
        }
    }

    /// The same with stretch measured on other edges: those of polygons, without diagonals.
    #[must_use]
    pub fn with_edges(self, edges: Vec<[u32; 2]>) -> Self {
        Self { edges, ..self }
    }

    /// Measures the garment at `draped` `[vertex]` on a body.
    ///
    /// # Panics
    ///
    /// If `draped` has another number of positions than the garment or one that is not finite.
    pub fn judge(&self, draped: &[Point3], skin: &Surface) -> Judgement {
        let mesh = self.rest.with_positions(draped.to_vec());
        let mesh = mesh.expect("drapes are finite and have the vertices of the garment");
        let is_trapped = trapped(draped, skin);
        let is_inside = skin.contains_all(draped);
        let closest = skin.closest_all(draped);
        let mut is_used = vec![false; draped.len()];
        for &corner in mesh.faces().as_flattened() {
            is_used[corner as usize] = true;
        }
        let used: Vec<usize> = (0..draped.len())
            .filter(|&vertex| is_used[vertex])
            .collect();
        let free = || used.iter().copied().filter(|&vertex| !is_trapped[vertex]);
        let outside = free().filter(|&vertex| !is_inside[vertex]);
        let mut distances: Vec<f32> = outside
            .map(|vertex| closest[vertex].distance_squared.sqrt())
            .collect();
        distances.sort_by(f32::total_cmp);
        let stretches = self.stretches(draped, &is_trapped);
        let last = stretches.len().saturating_sub(1);
        let at = |share: f64| stretches.get((share * last as f64).round() as usize);
        Judgement {
            inside: free().filter(|&vertex| is_inside[vertex]).count(),
            trapped: used.iter().filter(|&&vertex| is_trapped[vertex]).count(),
            min_distance: distances.first().copied().unwrap_or(f32::INFINITY),
            distances,
            crossing: num_crossing(&mesh, skin, &is_trapped) as f32 / mesh.num_faces() as f32,
            stretch_p99: at(0.99).copied().unwrap_or(1.0),
            stretch_max: at(1.0).copied().unwrap_or(1.0),
            piece_gap: self.piece_gap(draped),
        }
    }

    /// Length over rest length of the edges without a trapped end, sorted.
    fn stretches(&self, draped: &[Point3], is_trapped: &[bool]) -> Vec<f32> {
        let rest = self.rest.positions();
        let mut stretches = Vec::new();
        for [a, b] in self.edges.iter().map(|edge| edge.map(|v| v as usize)) {
            let length = (rest[a] - rest[b]).norm();
            if length > SHORTEST_EDGE && !is_trapped[a] && !is_trapped[b] {
                stretches.push((draped[a] - draped[b]).norm() / length);
            }
        }
        stretches.sort_by(f32::total_cmp);
        stretches
    }

    /// By how much the gap between touching pieces grew at most.
    fn piece_gap(&self, draped: &[Point3]) -> f32 {
        let rest = self.rest.positions();
        let components = self.topology.components();
        let mut worst = 0.0_f32;
        let count = self.topology.num_components() as u32;
        for piece in 0..count {
            let of = |positions: &[Point3], is_piece: bool| {
                let chosen = positions.iter().zip(components);
                let chosen = chosen.filter(|(_, c)| (**c == piece) == is_piece);
                chosen.map(|(p, _)| *p).collect::<Vec<Point3>>()
            };
            let gap = |positions: &[Point3]| {
                let others = VertexTree::new(&of(positions, false)).expect("positions are finite");
                let nearest = of(positions, true)
                    .into_iter()
                    .filter_map(|p| others.nearest(p));
                nearest
                    .map(|n| n.distance_squared.sqrt())
                    .fold(f32::INFINITY, f32::min)
            };
            let at_rest = gap(rest);
            if at_rest < PIECES_TOUCH {
                worst = worst.max(gap(draped) - at_rest);
            }
        }
        worst
    }
}

/// Whether each position is caught where the body runs through itself, as [`Judgement::trapped`]
/// counts.
///
/// # Panics
///
/// Never: a skin is finite.
pub fn trapped(positions: &[Point3], skin: &Surface) -> Vec<bool> {
    let normals = face_normals(skin.positions(), skin.faces());
    let center = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|vertex| skin.positions()[vertex as usize].coords);
        Point3::from((a + b + c) / 3.0)
    };
    let centers: Vec<Point3> = skin.faces().iter().map(center).collect();
    let probes = centers
        .iter()
        .zip(&normals)
        .map(|(center, normal)| center + PROBE * normal);
    let is_embedded = skin.contains_all(&probes.collect::<Vec<_>>());
    let embedded = centers
        .iter()
        .zip(&is_embedded)
        .filter(|(_, is_embedded)| **is_embedded);
    let embedded: Vec<Point3> = embedded.map(|(center, _)| *center).collect();
    let tree = VertexTree::new(&embedded).expect("centers of faces are finite");
    let closest = skin.closest_all(positions);
    let is_trap = closest.iter().map(|closest| {
        let near = tree.nearest(closest.point);
        is_embedded[closest.face as usize]
            || near.is_some_and(|near| near.distance_squared < TRAP * TRAP)
    });
    is_trap.collect()
}

/// How many faces without a trapped vertex cross the skin.
fn num_crossing(mesh: &TriMesh, skin: &Surface, is_trapped: &[bool]) -> usize {
    let mut crossing: Vec<u32> = Surface::new(mesh)
        .intersections(skin)
        .iter()
        .map(|pair| pair[0])
        .collect();
    crossing.dedup();
    let is_free = |face: &&u32| {
        let corners = mesh.faces()[**face as usize];
        !corners.iter().any(|&vertex| is_trapped[vertex as usize])
    };
    crossing.iter().filter(is_free).count()
}
