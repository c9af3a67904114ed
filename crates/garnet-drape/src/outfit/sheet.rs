//! A worn garment as a surface with an outside.

use garnet_knn::{ClosestPoint, Feature, Surface};
use garnet_mesh::{Point3, TriMesh, Vector3};

use super::WornGarment;
use crate::{BoundGarment, Error};

/// A worn garment as a surface between nodes.
#[derive(Debug, Clone)]
pub(super) struct Sheet<'a> {
    pub(super) garment: &'a BoundGarment,
    /// Where its nodes are.
    pub(super) surface: Surface,
    /// 1 if the normals of most faces lead away from the skin, else -1.
    pub(super) sign: f32,
}

impl<'a> Sheet<'a> {
    pub(super) fn new(worn: &WornGarment<'a>) -> Result<Self, Error> {
        let cloth = worn.garment.cloth();
        let nodes = cloth.weld().gather(&worn.positions);
        let mesh = TriMesh::new(nodes, cloth.faces().to_vec())?;
        Ok(Self {
            garment: worn.garment,
            surface: Surface::new(&mesh),
            sign: outward_sign(worn.garment),
        })
    }

    /// The unit normal that leads away from the skin at a point of the surface.
    pub(super) fn outward(&self, at: &ClosestPoint) -> Vector3 {
        self.sign * self.surface.smooth_normal(at)
    }

    /// The unit normal at a node that leads away from the skin.
    pub(super) fn outward_at(&self, node: usize) -> Vector3 {
        self.sign * self.surface.vertex_normal(node as u32)
    }

    /// Whether a closest point lies on the edge of the garment, beyond which there is none.
    pub(super) fn is_rim(&self, at: &ClosestPoint) -> bool {
        let topology = self.garment.cloth().topology();
        let corners = self.surface.faces()[at.face as usize];
        let is_boundary = |corner: u8| topology.is_boundary(corners[usize::from(corner)] as usize);
        match at.feature {
            Feature::Face => false,
            Feature::Edge(corner) => is_boundary(corner) && is_boundary((corner + 1) % 3),
            Feature::Vertex(corner) => is_boundary(corner),
        }
    }
}

/// On which side of a garment the skin is not, at rest.
fn outward_sign(garment: &BoundGarment) -> f32 {
    let cloth = garment.cloth();
    let (nodes, skin) = (cloth.rest_nodes(), cloth.skin());
    let of_face = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|node| nodes[node as usize]);
        let away: Vector3 = face
            .map(|node| nodes[node as usize] - skin[node as usize].point)
            .iter()
            .sum();
        f64::from((b - a).cross(&(c - a)).dot(&away))
    };
    let sum: f64 = cloth.faces().iter().map(of_face).sum();
    if sum < 0.0 { -1.0 } else { 1.0 }
}

/// Where the skin is that each node lies on at rest `[node]`, on the rest body of `garment`; `on`
/// is a garment whose body has perhaps another shape, of the same faces, on whose body it is told.
pub(super) fn anchors(garment: &BoundGarment, on: &BoundGarment) -> Vec<Point3> {
    let (own, other) = (garment.body().skin(), on.body().skin());
    let is_same = own.faces() == other.faces();
    let place = |skin: &ClosestPoint| {
        if !is_same {
            return skin.point;
        }
        let corners = other.faces()[skin.face as usize].map(|vertex| vertex as usize);
        let shares = corners.into_iter().zip(skin.barycentric);
        let sum: Vector3 = shares
            .map(|(vertex, share)| share * other.positions()[vertex].coords)
            .sum();
        Point3::from(sum)
    };
    garment.cloth().skin().iter().map(place).collect()
}
