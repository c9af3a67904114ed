//! Tiles of vertices, and where each tile adds up what it sends to other vertices.
//!
//! A *slot* is a place of a tile for one vertex that the tile sees. In a mesh whose numbering
//! follows its surface a tile sees little more than itself, so the slots of all tiles are not many
//! more than the vertices; in the worst case they are as many as the edges.

use std::ops::Range;

/// Vertices a tile. The aggregate of a tile (128 x 8 heads x 128 channels x 4 B = 0.5 MB) stays in
/// L2.
pub(crate) const TILE_ROWS: usize = 128;

/// The tiles of a graph.
#[derive(Debug, Clone)]
pub(crate) struct Tiles {
    num_rows: usize,
    slot_of_edge: Vec<u32>,
    slot_offsets: Vec<usize>,
    vertex_of_slot: Vec<u32>,
}

/// The slots of each vertex, ascending.
#[derive(Debug, Clone)]
pub(crate) struct SlotsOfVertices {
    offsets: Vec<u32>,
    slots: Vec<u32>,
}

impl Tiles {
    /// Gives each tile a slot for every vertex that it sees, in the order in which it sees them.
    pub(crate) fn new(offsets: &[u32], neighbors: &[u32]) -> Self {
        let num_rows = offsets.len() - 1;
        let mut tile_and_slot = vec![(u32::MAX, 0); num_rows];
        let mut slot_of_edge = Vec::with_capacity(neighbors.len());
        let mut slot_offsets = vec![0];
        let mut vertex_of_slot = Vec::new();
        for tile in 0..num_rows.div_ceil(TILE_ROWS) {
            let first = vertex_of_slot.len();
            let rows = tile * TILE_ROWS..((tile + 1) * TILE_ROWS).min(num_rows);
            for &neighbor in &neighbors[offsets[rows.start] as usize..offsets[rows.end] as usize] {
                let (last_tile, slot) = &mut tile_and_slot[neighbor as usize];
                if *last_tile != tile as u32 {
                    (*last_tile, *slot) = (tile as u32, (vertex_of_slot.len() - first) as u32);
                    vertex_of_slot.push(neighbor);
                }
                slot_of_edge.push(*slot);
            }
            slot_offsets.push(vertex_of_slot.len());
        }
        Self {
            num_rows,
            slot_of_edge,
            slot_offsets,
            vertex_of_slot,
        }
    }

    /// Number of tiles.
    pub(crate) fn len(&self) -> usize {
        self.slot_offsets.len() - 1
    }

    /// The vertices of a tile.
    pub(crate) fn rows(&self, tile: usize) -> Range<usize> {
        tile * TILE_ROWS..((tile + 1) * TILE_ROWS).min(self.num_rows)
    }

    /// Number of slots of all tiles.
    pub(crate) fn num_slots(&self) -> usize {
        self.vertex_of_slot.len()
    }

    /// Number of slots of some tiles.
    pub(crate) fn num_slots_of(&self, tiles: Range<usize>) -> usize {
        self.slot_offsets[tiles.end] - self.slot_offsets[tiles.start]
    }

    /// The slot of each edge, counted from the first of its tile.
    #[inline(always)]
    pub(crate) fn slots_of_edges(&self, edges: Range<usize>) -> &[u32] {
        &self.slot_of_edge[edges]
    }
}

impl SlotsOfVertices {
    pub(crate) fn new(num_vertices: usize, tiles: &Tiles) -> Self {
        let mut offsets = vec![0_u32; num_vertices + 1];
        for &vertex in &tiles.vertex_of_slot {
            offsets[vertex as usize + 1] += 1;
        }
        for vertex in 0..num_vertices {
            offsets[vertex + 1] += offsets[vertex];
        }
        let mut next = offsets.clone();
        let mut slots = vec![0; tiles.num_slots()];
        for (slot, &vertex) in tiles.vertex_of_slot.iter().enumerate() {
            slots[next[vertex as usize] as usize] = slot as u32;
            next[vertex as usize] += 1;
        }
        Self { offsets, slots }
    }

    /// The slots of a vertex, counted over all tiles.
    #[inline(always)]
    pub(crate) fn of(&self, vertex: usize) -> &[u32] {
        &self.slots[self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_edge_finds_its_target_by_its_slot() {
        let num_rows = 3 * TILE_ROWS + 5;
        let lists: Vec<[u32; 3]> = (0..num_rows as u32)
            .map(|i| [i, (i * 7 + 3) % num_rows as u32, (i + 1) % num_rows as u32])
            .collect();
        let offsets: Vec<u32> = (0..=num_rows as u32).map(|i| 3 * i).collect();
        let neighbors = lists.concat();
        let tiles = Tiles::new(&offsets, &neighbors);
        let slots = SlotsOfVertices::new(num_rows, &tiles);

        assert_eq!(tiles.len(), 4);
        for (edge, &neighbor) in neighbors.iter().enumerate() {
            let tile = edge / 3 / TILE_ROWS;
            let slot = tiles.slot_offsets[tile] + tiles.slots_of_edges(edge..edge + 1)[0] as usize;
            assert_eq!(tiles.vertex_of_slot[slot], neighbor);
            assert!(slots.of(neighbor as usize).contains(&(slot as u32)));
        }
        let num_collected: usize = (0..num_rows).map(|vertex| slots.of(vertex).len()).sum();
        assert_eq!(num_collected, tiles.num_slots());
    }
}
