//! How far vertices of a garment keep from each other.

use crate::{Cloth, Point3};

/// The distances that vertices keep: what production and reference solver push apart alike.
///
/// The ends of an edge do not repel: the spring holds them apart. A pair that was nearer at the start
/// than its reach keeps the distance of the start, so that pockets and collars are not blown up.
#[derive(Debug, Clone)]
pub(crate) struct Layers {
    /// Vertices within two edges of each and with a larger number, and how many edges away:
    /// `[ring_starts[v]..]`.
    rings: Vec<(u32, u8)>,
    ring_starts: Vec<u32>,
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
        let topology = cloth.topology();
        let num_vertices = cloth.num_vertices();
        let one_edge = topology.edges().iter().map(|&pair| (pair, 1));
        let two_edges = topology.two_ring_pairs().into_iter().map(|pair| (pair, 2));
        let mut rings: Vec<([u32; 2], u8)> = one_edge.chain(two_edges).collect();
        rings.sort_unstable();
        let mut ring_starts = vec![0; num_vertices + 1];
        for &([vertex, _], _) in &rings {
            ring_starts[vertex as usize + 1] += 1;
        }
        for vertex in 0..num_vertices {
            ring_starts[vertex + 1] += ring_starts[vertex];
        }
        let mut sums = vec![(0.0_f32, 0.0_f32); num_vertices];
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
            rings: rings
                .into_iter()
                .map(|([_, other], edges)| (other, edges))
                .collect(),
            ring_starts,
            radii: sums.iter().map(radius).collect(),
            start: start.to_vec(),
            least,
        }
    }

    /// The largest distance that two vertices keep, m.
    pub(crate) fn widest(&self) -> f32 {
        2.0 * self.radii.iter().copied().fold(0.0, f32::max)
    }

    /// The distance that two vertices keep, but for where they started, m.
    #[inline]
    pub(crate) fn reach(&self, a: usize, b: usize) -> f32 {
        self.radii[a] + self.radii[b]
    }

    /// The distance that vertices `a` < `b` keep, m; none for the ends of an edge.
    #[inline]
    pub(crate) fn distance(&self, a: usize, b: usize) -> Option<f32> {
        let reach = self.reach(a, b);
        let ring = &self.rings[self.ring_starts[a] as usize..self.ring_starts[a + 1] as usize];
        let edges = ring.iter().find(|&&(other, _)| other == b as u32);
        let least = match edges {
            Some((_, 1)) => return None,
            Some(_) => 0.0,
            None => self.least * reach,
        };
        let at_start = (self.start[a] - self.start[b]).norm();
        Some(reach.min(at_start.max(least)))
    }
}
