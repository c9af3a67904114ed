//! The edges of faces, and what they connect.

use crate::lists::Lists;

/// The sides of a face, in their direction.
pub(crate) fn sides(&[a, b, c]: &[u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Sorted unique edges and the faces of each.
///
/// Sides are first put into one bucket for each smaller vertex; sorting the small buckets is much
/// faster than sorting all sides.
pub(crate) fn edges_of(num_vertices: usize, faces: &[[u32; 3]]) -> (Vec<[u32; 2]>, Lists) {
    let mut starts = vec![0_u32; num_vertices + 1];
    let all_sides = || {
        let numbered = faces.iter().enumerate();
        numbered
            .flat_map(|(face, corners)| sides(corners).map(|side| (side, face as u32)))
            .filter(|([from, to], _)| from != to)
    };
    for corners in faces {
        for &corner in corners {
            assert!(
                (corner as usize) < num_vertices,
                "face names vertex {corner}, but there are {num_vertices}"
            );
        }
    }
    for ([from, to], _) in all_sides() {
        starts[from.min(to) as usize + 1] += 1;
    }
    for vertex in 0..num_vertices {
        starts[vertex + 1] += starts[vertex];
    }
    let mut buckets = vec![(0, 0); starts[num_vertices] as usize];
    let mut ends = starts.clone();
    for ([from, to], face) in all_sides() {
        let end = &mut ends[from.min(to) as usize];
        buckets[*end as usize] = (from.max(to), face);
        *end += 1;
    }

    let mut edges: Vec<[u32; 2]> = Vec::with_capacity(buckets.len() / 2 + 1);
    let mut face_starts = Vec::with_capacity(buckets.len() / 2 + 2);
    let mut edge_faces = Vec::with_capacity(buckets.len());
    for vertex in 0..num_vertices {
        let bucket = &mut buckets[starts[vertex] as usize..starts[vertex + 1] as usize];
        bucket.sort_unstable();
        let mut last = None;
        for &mut (other, face) in bucket {
            match last {
                // Both sides of a collapsed face are one.
                Some((edge, last_face)) if edge == other && last_face == face => continue,
                Some((edge, _)) if edge == other => {}
                _ => {
                    edges.push([vertex as u32, other]);
                    face_starts.push(edge_faces.len() as u32);
                }
            }
            edge_faces.push(face);
            last = Some((other, face));
        }
    }
    face_starts.push(edge_faces.len() as u32);
    (edges, Lists::from_parts(face_starts, edge_faces))
}

/// Numbers connected components in the order of their first vertex.
pub(crate) fn components(num_vertices: usize, edges: &[[u32; 2]]) -> (Vec<u32>, usize) {
    let mut parent: Vec<u32> = (0..num_vertices as u32).collect();
    for &[a, b] in edges {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        parent[a.max(b) as usize] = a.min(b);
    }
    let mut number = vec![u32::MAX; num_vertices];
    let mut count = 0;
    for vertex in 0..num_vertices as u32 {
        let root = root(&mut parent, vertex) as usize;
        if number[root] == u32::MAX {
            number[root] = count;
            count += 1;
        }
        number[vertex as usize] = number[root];
    }
    (number, count as usize)
}

fn root(parent: &mut [u32], mut vertex: u32) -> u32 {
    while parent[vertex as usize] != vertex {
        parent[vertex as usize] = parent[parent[vertex as usize] as usize];
        vertex = parent[vertex as usize];
    }
    vertex
}
