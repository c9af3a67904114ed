//! Garments, and garments bound to a body: everything that is computed once.

use garnet_knn::{ClosestPoint, Surface};
use garnet_mesh::{Point3, Topology, TriMesh};

use crate::free_cloth::freedom;
use crate::holes::Holes;
use crate::pieces::Pieces;
use crate::scale::scale_on;
use crate::shape::offsets_at_skin;
use crate::transfer::{PIECE_LENGTH, transfer_screening, transferred_weights};
use crate::{
    Body, ClothGraph, PosedBody, ScreenedPoisson, SkinError, SkinWeights, TransferOptions, Vector3,
    Weld, skin_dual_quaternion, skin_linear,
};

/// Length over which the body's change of shape is smoothed on the cloth, in metres.
const SHAPE_LENGTH: f64 = 0.05;

/// How a garment is brought from rest to the target body before cloth is considered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Warp {
    /// Linear blend skinning.
    Linear,
    /// Dual-quaternion skinning: the paper's baseline, which knows the pose only.
    DualQuaternion,
    /// Dual-quaternion skinning after the garment was carried along with the body's shape.
    #[default]
    Shape,
}

/// A garment that lies on a body in its rest pose.
#[derive(Debug, Clone)]
pub struct Garment {
    mesh: TriMesh,
    /// Those of a person, at the garment's scale, if none.
    transfer: Option<TransferOptions>,
}

impl Garment {
    /// A garment as modelled on the rest body.
    pub fn new(mesh: TriMesh) -> Self {
        Self {
            mesh,
            transfer: None,
        }
    }

    /// The same with other lengths of weight smoothing.
    #[must_use]
    pub fn with_transfer(mut self, transfer: TransferOptions) -> Self {
        self.transfer = Some(transfer);
        self
    }

    /// The mesh at rest.
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// Binds the garment to the rest body that it lies on: finds the skin under each vertex and
    /// takes the weights from it.
    ///
    /// # Errors
    ///
    /// [`SkinError::Singular`] for a garment too degenerate to be smoothed.
    pub fn bind(self, body: &Body) -> Result<BoundGarment, SkinError> {
        let weld = Weld::sewn(&self.mesh);
        let rest = weld.gather(self.mesh.positions());
        let faces = weld.faces(&self.mesh);
        let topology = Topology::new(rest.len(), &faces);
        let plain = ClothGraph::new(&rest, &faces, &topology, &[]);
        let areas: Vec<f64> = plain.node_areas().iter().map(|&a| f64::from(a)).collect();
        let skin = body.skin().closest_all(&rest);
        let scale = scale_on(body, &skin);
        let pieces = Pieces::new(&rest, &topology, &areas, scale)?;
        let graph = if pieces.stitches.is_empty() {
            plain
        } else {
            ClothGraph::new(&rest, &faces, &topology, &pieces.stitches)
        };
        let surface = || {
            let mesh = TriMesh::new(rest.clone(), faces.clone()).ok()?;
            Some(Surface::new(&mesh))
        };
        let mut freedom = freedom(&rest, &topology, surface, &skin, &pieces.is_piece, scale);
        let holes = Holes::of(body, &rest, &skin);
        if let Some(holes) = &holes {
            // Cloth over missing skin is far from skin, and not free.
            for (freedom, share) in freedom.iter_mut().zip(&holes.share) {
                *freedom *= 1.0 - share;
            }
        }
        let options = (self.transfer).unwrap_or_else(|| TransferOptions::default().scaled(scale));
        let of_nodes = (pieces.is_piece.as_slice(), holes.as_ref());
        let screening = transfer_screening(&graph, &skin, of_nodes, &freedom, options);
        let transfer_system = ScreenedPoisson::new(&graph, screening)?;
        let body_faces = body.skin().faces();
        let shape_screening = (0..rest.len())
            .map(|node| {
                let length = if pieces.is_piece[node] {
                    PIECE_LENGTH
                } else {
                    f64::from(scale) * SHAPE_LENGTH
                };
                areas[node] / (length * length)
            })
            .collect();
        let (weights, shape_system) = rayon::join(
            || {
                let near = (skin.as_slice(), holes.as_ref());
                transferred_weights(body.weights(), body_faces, near, &transfer_system)
            },
            || transfer_system.rescreened(&graph, shape_screening),
        );
        Ok(BoundGarment {
            mesh: self.mesh,
            weld,
            rest,
            faces,
            topology,
            graph,
            is_piece: pieces.is_piece,
            is_over_hole: over_holes(body, &skin, holes.as_ref()),
            skin,
            scale,
            weights: weights?,
            shape_system: shape_system?,
            rest_skin: body.skin().clone(),
        })
    }
}

/// Whether each node lies over a hole of the body `[node]`; empty if there are no holes.
fn over_holes(body: &Body, skin: &[ClosestPoint], holes: Option<&Holes>) -> Vec<bool> {
    if body.num_rims() == 0 {
        return Vec::new();
    }
    let is_missing = |node: usize| holes.is_some_and(|holes| holes.share[node] > 0.5);
    let nodes = skin.iter().enumerate();
    nodes
        .map(|(node, skin)| body.is_cap(skin.face) || is_missing(node))
        .collect()
}

/// A garment with everything that does not depend on the target body.
///
/// Vertices at one place are one *node* inside; see [`Weld`]. Positions `[node]` are in what ends
/// on `_nodes`; [`Weld::scatter`] takes them to positions `[vertex]`.
#[derive(Debug, Clone)]
pub struct BoundGarment {
    mesh: TriMesh,
    weld: Weld,
    rest: Vec<Point3>,
    faces: Vec<[u32; 3]>,
    topology: Topology,
    graph: ClothGraph,
    is_piece: Vec<bool>,
    is_over_hole: Vec<bool>,
    skin: Vec<ClosestPoint>,
    scale: f32,
    weights: SkinWeights,
    shape_system: ScreenedPoisson,
    rest_skin: Surface,
}

impl BoundGarment {
    /// The mesh at rest.
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// Which vertices are one node.
    pub fn weld(&self) -> &Weld {
        &self.weld
    }

    /// Positions at rest `[node]`, in metres.
    pub fn rest_nodes(&self) -> &[Point3] {
        &self.rest
    }

    /// Faces of the garment `[face][corner]`, as numbers of nodes.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Topology of the faces between nodes.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// The cloth as a graph between nodes.
    pub fn graph(&self) -> &ClothGraph {
        &self.graph
    }

    /// Whether each node belongs to a loose piece that sits on other cloth `[node]`.
    pub fn is_piece(&self) -> &[bool] {
        &self.is_piece
    }

    /// Whether a node is cloth: whether a face names it.
    pub fn is_cloth(&self, node: usize) -> bool {
        !self.topology.vertex_faces(node).is_empty()
    }

    /// Whether a node lies over a hole of the body, an open neck or skin that was deleted under the
    /// garment, and not over skin.
    pub fn is_over_hole(&self, node: usize) -> bool {
        self.is_over_hole.get(node).is_some_and(|&is_over| is_over)
    }

    /// The closest point of the rest skin `[node]`.
    pub fn skin(&self) -> &[ClosestPoint] {
        &self.skin
    }

    /// What share of the cloth looks towards the skin that it lies on, by area, from 0 to 1: little
    /// of a garment as people make them, and nearly all of one that is inside out.
    pub fn inward_share(&self) -> f32 {
        let (nodes, body) = (&self.rest, &self.rest_skin);
        let away = |node: u32| {
            let near = &self.skin[node as usize];
            let corners = body.faces()[near.face as usize];
            let [a, b, c] = corners.map(|corner| body.positions()[corner as usize]);
            let outward = (b - a).cross(&(c - a));
            let offset = nodes[node as usize] - near.point;
            // What is in the skin lies on it, too.
            let way = if offset.dot(&outward) > 0.0 {
                offset
            } else {
                outward
            };
            way.try_normalize(f32::MIN_POSITIVE).unwrap_or_default()
        };
        let (mut inward, mut all) = (0.0_f64, 0.0_f64);
        for face in &self.faces {
            let [a, b, c] = face.map(|node| nodes[node as usize]);
            let normal = (b - a).cross(&(c - a));
            let way: Vector3 = face.iter().map(|&node| away(node)).sum();
            let area = f64::from(normal.norm());
            all += area;
            if normal.dot(&way) < 0.0 {
                inward += area;
            }
        }
        if all > 0.0 {
            (inward / all) as f32
        } else {
            0.0
        }
    }

    /// What the lengths of draping, which are a person's, are to be multiplied by: 1 for cloth on
    /// limbs as thick as a person's, less on fingers and dolls, more on giants.
    pub fn scale(&self) -> f32 {
        self.scale
    }

    /// Skinning weights of the nodes, `[node]`.
    pub fn weights(&self) -> &SkinWeights {
        &self.weights
    }

    /// The skin of the rest body.
    pub fn rest_skin(&self) -> &Surface {
        &self.rest_skin
    }

    /// A factored smoothing system of the garment's graph, to be used with other screenings.
    pub fn system(&self) -> &ScreenedPoisson {
        &self.shape_system
    }

    /// How a change of the body's shape moves the garment at rest `[node]`, in metres: that of the
    /// nearest skin, smoothed. `of_body` is the change of each vertex of the body.
    pub fn shape_offsets_nodes(&self, of_body: &[Vector3]) -> Vec<Vector3> {
        let at_skin = offsets_at_skin(of_body, self.rest_skin.faces(), &self.skin);
        self.shape_system.smoothed_vectors(&at_skin)
    }

    /// Positions `[node]` of the garment warped to a posed body, in metres.
    ///
    /// # Errors
    ///
    /// [`SkinError::TransformCount`] or [`SkinError::TargetCount`] if `body` is not of the body
    /// that the garment was bound to.
    pub fn warped_nodes(&self, body: &PosedBody, warp: Warp) -> Result<Vec<Point3>, SkinError> {
        let found = body.posed_from_rest().len();
        let expected = self.weights.num_joints();
        if found != expected {
            return Err(SkinError::TransformCount { found, expected });
        }
        let found = body.skin().positions().len();
        let expected = self.rest_skin.positions().len();
        if found != expected {
            return Err(SkinError::TargetCount { found, expected });
        }
        let transforms = body.posed_from_rest();
        Ok(match (warp, body.shape_offsets()) {
            (Warp::Linear, _) => skin_linear(&self.rest, &self.weights, transforms),
            (Warp::Shape, Some(offsets)) => {
                let offsets = self.shape_offsets_nodes(offsets);
                let shaped: Vec<Point3> =
                    self.rest.iter().zip(&offsets).map(|(x, d)| x + d).collect();
                skin_dual_quaternion(&shaped, &self.weights, transforms)
            }
            (Warp::DualQuaternion | Warp::Shape, _) => {
                skin_dual_quaternion(&self.rest, &self.weights, transforms)
            }
        })
    }
}
