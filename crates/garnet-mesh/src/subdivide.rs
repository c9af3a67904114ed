//! Finer meshes of the same shape.

use crate::{MeshError, Point3, Topology, TriMesh};

/// The mesh with each triangle split into four at the middles of its sides; its vertices come
/// first, then one for each edge.
///
/// # Errors
///
/// [`MeshError`], which a sound mesh does not give.
///
/// # Panics
///
/// Never: every side is an edge.
///
/// # Examples
///
/// ```
/// use garnet_mesh::{primitives::grid, subdivided};
///
/// let square = grid(1, 1, [1.0, 1.0]);
/// let finer = subdivided(&square)?;
/// assert_eq!((finer.num_vertices(), finer.num_faces()), (9, 8));
/// # Ok::<(), garnet_mesh::MeshError>(())
/// ```
pub fn subdivided(mesh: &TriMesh) -> Result<TriMesh, MeshError> {
    let topology = Topology::new(mesh.num_vertices(), mesh.faces());
    let mut positions = mesh.positions().to_vec();
    for &[a, b] in topology.edges() {
        let [a, b] = [a, b].map(|vertex| mesh.positions()[vertex as usize]);
        positions.push(Point3::from(0.5 * (a.coords + b.coords)));
    }
    let middle = |a: u32, b: u32| {
        let edge = topology.edges().binary_search(&[a.min(b), a.max(b)]);
        mesh.num_vertices() as u32 + edge.expect("every side is an edge") as u32
    };
    let split = |&[a, b, c]: &[u32; 3]| {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    let faces = mesh.faces().iter().flat_map(split).collect();
    TriMesh::new(positions, faces)
}
