//! How far vertices of a garment keep from each other.

use std::sync::Arc;

use garnet_mesh::Topology;

use crate::{Cloth, Point3};

/// The distances that vertices keep: what production and reference solver push apart alike.
///
/// The ends of an edge do not repel: the spring holds them apart. A pair that was nearer at the
/// start than its reach keeps the distance of the start, so that pockets and collars are not blown
/// up.
#[derive(Debug, Clone)]
pub(crate) struct Layers {
    topology: Arc<Topology>,
    /// Half the distance that each vertex keeps from another like it, m.
    radii: Vec<f32>,
    start: Vec<Point3>,
    least: f32,
}

/// Radii are cut at this many times the mean, so that one long edge does not widen searches.
const MAX_RADIUS: f32 = 2.0;

impl Layers {
    /// `factor` times the mean rest length of the edges around is what vertices keep from another,
    /// `least` the share of it that pairs keep that were nearer at `start` `[vertex]`.
    pub(crate) fn new(cloth: &Cloth, start: &[Point3], factor: f32, least: f32) -> Self {
        let mut sums = vec![(0.0_f32, 0.0_f32); cloth.num_vertices()];
        for spring in cloth.springs() {
            for vertex in spring.vertices {
                let (length, count) = &mut sums[vertex as usize];
                *length += spring.rest_length;
                *count += 1.0;
            }
        }
        let largest = MAX_RADIUS * 0.5 * factor * cloth.mean_edge_length();
        let radius =
            |(length, count): &(f32, f32)| (0.5 * factor * length / count.max(1.0)).min(largest);
        Self {
            topology: cloth.shared_topology(),
            radii: sums.iter().map(radius).collect(),
            start: start.to_vec(),
            least,
        }
    }

    /// The largest distance that two vertices keep, m.
    pub(crate) fn widest(&self) -> f32 {
        2.0 * self.radii.iter().copied().fold(0.0, f32::max)
    }

    /// Half the distance that each vertex keeps from another like it `[vertex]`, m.
    pub(crate) fn radii(&self) -> &[f32] {
        &self.radii
    }

    /// The distance that two vertices keep, but for where they started, m.
    #[inline]
    pub(crate) fn reach(&self, a: usize, b: usize) -> f32 {
        self.radii[a] + self.radii[b]
    }

    /// The distance that two vertices keep, m; none for the ends of an edge.
    #[inline]
    pub(crate) fn distance(&self, a: usize, b: usize) -> Option<f32> {
        let reach = self.reach(a, b);
        let [around_a, around_b] = [a, b].map(|vertex| self.topology.neighbors(vertex));
        let is_edge = around_a.contains(&(b as u32));
        if is_edge {
            return None;
        }
        let is_two_edges_away = around_a.iter().any(|other| around_b.contains(other));
        let least = if is_two_edges_away {
            0.0
        } else {
            self.least * reach
        };
        let at_start = (self.start[a] - self.start[b]).norm();
        Some(reach.min(at_start.max(least)))
    }
}
