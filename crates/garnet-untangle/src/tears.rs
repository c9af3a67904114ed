//! Edges of the cloth that are longer than cloth can be.

use garnet_knn::TORN_STRETCH;

use crate::cloth::Cloth;

/// Edges that are torn apart.
#[derive(Debug, Default)]
pub(crate) struct Tears {
    /// Their ends.
    pub(crate) nodes: Vec<u32>,
    /// The sum of their stretch beyond what counts as torn.
    pub(crate) excess: f32,
}

/// An edge of the cloth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ClothEdge {
    pub(crate) ends: [u32; 2],
    /// In metres.
    pub(crate) rest_length: f32,
}

impl Cloth<'_> {
    /// The edges that are torn apart where the body leaves room.
    pub(crate) fn tears(&self) -> Tears {
        let mut tears = Tears::default();
        for edge in self.edges_beyond(TORN_STRETCH) {
            tears.excess += self.stretch(&edge) - TORN_STRETCH;
            tears.nodes.extend(edge.ends);
        }
        tears.nodes.sort_unstable();
        tears.nodes.dedup();
        tears
    }

    /// The edges that are stretched beyond `limit` where the body leaves room.
    pub(crate) fn edges_beyond(&self, limit: f32) -> Vec<ClothEdge> {
        let is_free = |edge: &ClothEdge| !edge.ends.iter().any(|&n| self.is_trapped(n as usize));
        self.edges()
            .filter(|edge| self.stretch(edge) > limit && is_free(edge))
            .collect()
    }

    /// The stretch of all torn edges beyond what counts as torn, also of trapped ones.
    pub(crate) fn torn_anywhere(&self) -> f32 {
        let excess = self.edges().map(|edge| self.stretch(&edge) - TORN_STRETCH);
        excess.filter(|excess| *excess > 0.0).sum()
    }

    fn edges(&self) -> impl Iterator<Item = ClothEdge> {
        let graph = self.scene.garment.graph();
        let edges = graph.edges()[..graph.num_cloth_edges()].iter();
        let all = edges.zip(graph.rest_lengths());
        all.map(|(&ends, &rest_length)| ClothEdge { ends, rest_length })
    }

    /// Length over rest length of an edge.
    pub(crate) fn stretch(&self, edge: &ClothEdge) -> f32 {
        let [a, b] = edge.ends.map(|node| self.positions[node as usize]);
        (b - a).norm() / edge.rest_length.max(f32::MIN_POSITIVE)
    }
}
