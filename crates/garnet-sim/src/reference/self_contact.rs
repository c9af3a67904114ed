//! Cloth on cloth: vertices that are not neighbors keep a distance.

use garnet_knn::VertexTree;
use nalgebra::{Matrix3, Vector3};

use super::blocks::{Blocks, Curvature};
use crate::layers::Layers;
use crate::{Cloth, Point3};

/// Pairs are looked for within this many radii, so that they need not be looked for in every step.
const SEARCH_RADII: f64 = 3.0;

/// Vertices nearer than this many radii along the cloth are neighbors.
const NEIGHBOR_RADII: f64 = 2.0;

/// Repulsion of vertices: energy ½ k (r − d)² of each pair that is nearer than r and not near along
/// the cloth.
#[derive(Debug, Clone)]
pub(super) struct SelfContact {
    radius: f64,
    stiffness: f64,
    keeping: Keeping,
    /// Candidates, sorted.
    pairs: Vec<[u32; 2]>,
    /// Where the candidates were looked for.
    places: Vec<Vector3<f64>>,
}

/// Who keeps from whom.
#[derive(Debug, Clone)]
enum Keeping {
    /// All from all but their neighbors `[vertex]` along the cloth, sorted.
    Distance { neighbors: Vec<Vec<u32>> },
    /// As the layers say.
    Layers(Layers),
}

impl Keeping {
    fn is_neighbor(&self, vertex: usize, other: u32) -> bool {
        match self {
            Self::Distance { neighbors } => neighbors[vertex].binary_search(&other).is_ok(),
            Self::Layers(_) => false,
        }
    }
}

impl SelfContact {
    /// All vertices keep `radius` metres, but from those that are near along the cloth.
    pub(super) fn new(cloth: &Cloth, radius: f64, stiffness: f64) -> Self {
        let neighbors = neighbors_along(cloth, NEIGHBOR_RADII * radius);
        Self::kept_by(Keeping::Distance { neighbors }, radius, stiffness)
    }

    /// What the production solver keeps apart: all vertices but the ends of edges, so that folds do
    /// not close.
    pub(super) fn of_layers(layers: Layers, stiffness: f64) -> Self {
        let radius = layers.widest().into();
        Self::kept_by(Keeping::Layers(layers), radius, stiffness)
    }

    fn kept_by(keeping: Keeping, radius: f64, stiffness: f64) -> Self {
        Self {
            radius,
            stiffness,
            keeping,
            pairs: Vec::new(),
            places: Vec::new(),
        }
    }

    /// The distance that two vertices keep.
    fn reach(&self, [a, b]: [u32; 2]) -> f64 {
        match &self.keeping {
            Keeping::Distance { .. } => self.radius,
            Keeping::Layers(layers) => {
                (layers.distance(a as usize, b as usize)).map_or(0.0, f64::from)
            }
        }
    }

    /// The longest way that a vertex may go before the next [`SelfContact::look`], in metres.
    ///
    /// With as much again since the candidates were looked for, none can be missed.
    pub(super) fn max_move(&self) -> f64 {
        0.25 * (SEARCH_RADII - 1.0) * self.radius
    }

    /// Looks for pairs anew where vertices have moved.
    pub(super) fn look(&mut self, x: &[Vector3<f64>]) {
        let margin = self.max_move().powi(2);
        let is_known = self.places.len() == x.len()
            && x.iter()
                .zip(&self.places)
                .all(|(x, place)| (x - place).norm_squared() < margin);
        if is_known {
            return;
        }
        self.places = x.to_vec();
        let points: Vec<Point3> = x.iter().map(|x| Point3::from(x.cast::<f32>())).collect();
        let tree = VertexTree::new(&points).expect("the solver checks that positions are finite");
        self.pairs.clear();
        for (vertex, &point) in points.iter().enumerate() {
            let first = self.pairs.len();
            for neighbor in tree.within(point, (SEARCH_RADII * self.radius) as f32) {
                let (a, b) = (vertex as u32, neighbor.index);
                if b > a && !self.keeping.is_neighbor(vertex, b) {
                    self.pairs.push([a, b]);
                }
            }
            self.pairs[first..].sort_unstable();
        }
    }

    /// Pairs that repel each other, or are about to.
    pub(super) fn near_pairs(
        &self,
        x: &[Vector3<f64>],
        radii: f64,
    ) -> impl Iterator<Item = [u32; 2]> {
        let bound = (radii * self.radius).powi(2);
        self.pairs
            .iter()
            .copied()
            .filter(move |&[a, b]| (x[b as usize] - x[a as usize]).norm_squared() < bound)
    }

    fn depth(&self, x: &[Vector3<f64>], [a, b]: [u32; 2]) -> (f64, Vector3<f64>, f64) {
        let along = x[b as usize] - x[a as usize];
        let length = along.norm().max(1e-9);
        let depth = self.reach([a, b]) - length;
        (depth.max(0.0), along / length, length)
    }

    /// Energy, J.
    pub(super) fn energy(&self, x: &[Vector3<f64>]) -> f64 {
        let energy = |pair| 0.5 * self.stiffness * self.depth(x, pair).0.powi(2);
        self.near_pairs(x, 1.0).map(energy).sum()
    }

    /// Adds the gradient of the energy, N.
    pub(super) fn add_gradient(&self, x: &[Vector3<f64>], gradient: &mut [Vector3<f64>]) {
        for [a, b] in self.near_pairs(x, 1.0) {
            let (depth, direction, _) = self.depth(x, [a, b]);
            let push = direction * (self.stiffness * depth);
            gradient[a as usize] += push;
            gradient[b as usize] -= push;
        }
    }

    /// Adds the second derivatives.
    pub(super) fn add_hessian(
        &self,
        x: &[Vector3<f64>],
        curvature: Curvature,
        blocks: &mut Blocks,
    ) {
        for [a, b] in self.near_pairs(x, 1.0) {
            let (depth, direction, length) = self.depth(x, [a, b]);
            if depth == 0.0 {
                continue;
            }
            let across = curvature.of(-self.stiffness * depth / length);
            let axial = direction * direction.transpose();
            let block = axial * (self.stiffness - across) + Matrix3::identity() * across;
            blocks.add(a, a, &block);
            blocks.add(b, b, &block);
            blocks.add(a, b, &-block);
        }
    }
}

/// The vertices within `reach` along the edges and within two edges of each vertex, sorted.
fn neighbors_along(cloth: &Cloth, reach: f64) -> Vec<Vec<u32>> {
    let topology = cloth.topology();
    let mut edges: Vec<Vec<(u32, f64)>> = vec![Vec::new(); cloth.num_vertices()];
    for spring in cloth.springs() {
        let [a, b] = spring.vertices;
        edges[a as usize].push((b, f64::from(spring.rest_length)));
        edges[b as usize].push((a, f64::from(spring.rest_length)));
    }
    let around = |vertex: usize| {
        // Paths of few edges: a list is searched faster than a heap is kept.
        let mut near: Vec<(u32, f64)> = vec![(vertex as u32, 0.0)];
        let mut next = 0;
        while next < near.len() {
            let (from, distance) = near[next];
            next += 1;
            for &(to, length) in &edges[from as usize] {
                let distance = distance + length;
                match near.iter().position(|&(known, _)| known == to) {
                    Some(place) if distance < near[place].1 => near[place].1 = distance,
                    None if distance < reach => near.push((to, distance)),
                    _ => {}
                }
            }
        }
        let mut list: Vec<u32> = near.into_iter().map(|(near, _)| near).collect();
        for &neighbor in topology.neighbors(vertex) {
            list.push(neighbor);
            list.extend(topology.neighbors(neighbor as usize));
        }
        list.sort_unstable();
        list.dedup();
        list
    };
    (0..cloth.num_vertices()).map(around).collect()
}
