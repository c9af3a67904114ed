//! What a drape must hold, measured apart from the code that made it.

use garnet::{Point3, TriMesh};
use garnet_knn::{Surface, VertexTree};
use garnet_mesh::{Topology, face_normals};

/// How far in front of a face the body is probed, in metres.
const PROBE: f32 = 5e-4;

/// Skin this near to embedded skin leaves no room, in metres.
const TRAP: f32 = 0.01;

/// Slits and creases of one part leave cloth no room that is no deeper than this, in metres.
const SLIT: f32 = 0.005;

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
    /// center is within 10 mm of their closest point, lies inside another part of the body,
    /// probed 0.5 mm before it; in a slit or crease of one part only if they are no farther
    /// from the skin than 5 mm. The definition is that of [`garnet_knn::Traps`], written down
    /// once more.
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
    let probed = |side: f32| {
        let places = centers.iter().zip(&normals);
        places.map(move |(center, normal)| center + side * PROBE * normal)
    };
    let is_covered = skin.contains_all(&probed(1.0).collect::<Vec<_>>());
    let parts_behind = probed(-1.0).map(|place| skin.parts_around(place));
    let has_room = is_covered.iter().map(|is_covered| !is_covered);
    // How far from each face cloth is caught, at most.
    let depth = |(has_room, parts): (bool, i32)| match (has_room, parts) {
        (true, _) => 0.0,
        (false, ..=1) => SLIT,
        (false, _) => f32::INFINITY,
    };
    let depths: Vec<f32> = has_room.zip(parts_behind).map(depth).collect();
    let tree_of = |least: f32| {
        let faces = centers.iter().zip(&depths);
        let faces = faces.filter(|(_, depth)| **depth >= least);
        let middles: Vec<Point3> = faces.map(|(center, _)| *center).collect();
        VertexTree::new(&middles).expect("centers of faces are finite")
    };
    let (slits, embedded) = (tree_of(SLIT), tree_of(f32::INFINITY));
    let closest = skin.closest_all(positions);
    let is_trap = closest.iter().map(|closest| {
        let distance = closest.distance_squared.sqrt();
        let is_near = |tree: &VertexTree| {
            let near = tree.nearest(closest.point);
            near.is_some_and(|near| near.distance_squared < TRAP * TRAP)
        };
        distance < depths[closest.face as usize]
            || is_near(&embedded)
            || (distance < SLIT && is_near(&slits))
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
