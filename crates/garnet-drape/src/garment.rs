//! Garments: bound once, draped many times.

use std::sync::Arc;

use garnet_io::{Frame, check_offsets, check_sizes};
use garnet_knn::ClosestPoint;
use garnet_mesh::{Bounds, MeshError, Point3, TriMesh};
use garnet_skin::{Body, PosedBody, TransferOptions, Warp};
use garnet_untangle::{
    Binding, UntangleError, UntangleOptions, Untangled, counted_again, untangle,
};

use crate::Error;
use crate::stiff::StiffPieces;

/// A garment that lies on a body in its rest pose.
#[derive(Debug, Clone)]
pub struct Garment {
    cloth: garnet_skin::Garment,
}

impl Garment {
    /// A garment as modelled on the rest body, in metres.
    pub fn new(mesh: TriMesh) -> Self {
        Self {
            cloth: garnet_skin::Garment::new(mesh),
        }
    }

    /// The same with other lengths of weight smoothing.
    #[must_use]
    pub fn with_transfer(self, transfer: TransferOptions) -> Self {
        Self {
            cloth: self.cloth.with_transfer(transfer),
        }
    }

    /// The mesh at rest.
    pub fn mesh(&self) -> &TriMesh {
        self.cloth.mesh()
    }

    /// Computes all that does not depend on the target body: weights taken from the rest body, and
    /// which skin belongs to which cloth.
    ///
    /// # Errors
    ///
    /// [`Error::Misplaced`] if the garment does not lie on the body;
    /// [`Error::Skin`] or [`Error::Untangle`] for a garment too degenerate to be smoothed.
    pub fn bind(self, body: &Body) -> Result<BoundGarment, Error> {
        let bounds = |mesh: &TriMesh| Bounds::of_faces(mesh.positions(), mesh.faces());
        let garment_bounds = bounds(self.mesh()).ok_or(MeshError::NoFaces)?;
        let body_bounds = bounds(body.rest()).ok_or(MeshError::NoFaces)?;
        check_sizes(&garment_bounds, &body_bounds, Frame::OURS)?;
        let cloth = self.cloth.bind(body)?;
        let pairs = cloth.rest_nodes().iter().zip(cloth.skin()).enumerate();
        // Over a hole there is nothing that tells where cloth belongs.
        let pairs = pairs.filter(|&(node, _)| cloth.is_cloth(node) && !cloth.is_over_hole(node));
        let pairs = pairs.map(|(_, pair)| pair);
        let (nodes, pairs): (Vec<Point3>, Vec<_>) = pairs.map(|(n, near)| (*n, (n, near))).unzip();
        let skin = body.skin();
        let has_rims = body.num_rims() > 0;
        let offset = |(node, near): (&Point3, &ClosestPoint)| {
            let offset = node - near.point;
            if has_rims {
                // At the rim of a hole the face does not tell what is inside.
                let side = if skin.contains(*node) { -1.0 } else { 1.0 };
                return (offset, side * offset);
            }
            (offset, skin.pseudonormal(near))
        };
        let (offsets, normals): (Vec<_>, Vec<_>) = pairs.into_iter().map(offset).unzip();
        check_offsets(&nodes, &offsets, &normals, &body_bounds)?;
        BoundGarment::of_cloth(cloth, Arc::new(body.clone()))
    }
}

/// A garment bound to a body: everything that is computed once.
#[derive(Debug, Clone)]
pub struct BoundGarment {
    cloth: Arc<garnet_skin::BoundGarment>,
    binding: Binding,
    pieces: StiffPieces,
    body: Arc<Body>,
}

impl BoundGarment {
    /// The mesh at rest.
    pub fn mesh(&self) -> &TriMesh {
        self.cloth.mesh()
    }

    /// Cloth that was bound to `body`, made ready to be untangled. Whether it lies on the body is
    /// not looked at.
    ///
    /// # Errors
    ///
    /// [`Error::Untangle`] for a garment too degenerate to be smoothed.
    pub fn of_cloth(
        cloth: impl Into<Arc<garnet_skin::BoundGarment>>,
        body: Arc<Body>,
    ) -> Result<Self, Error> {
        let cloth = cloth.into();
        let binding = Binding::new(&cloth)?;
        Ok(Self {
            pieces: StiffPieces::of(&cloth),
            cloth,
            binding,
            body,
        })
    }

    /// The cloth inside: nodes, weights and the skin below them.
    pub fn cloth(&self) -> &garnet_skin::BoundGarment {
        &self.cloth
    }

    /// The same, to be kept.
    pub fn shared_cloth(&self) -> &Arc<garnet_skin::BoundGarment> {
        &self.cloth
    }

    /// The body that the garment lies on at rest.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// The same, to be kept.
    pub fn shared_body(&self) -> &Arc<Body> {
        &self.body
    }

    pub(crate) fn binding(&self) -> &Binding {
        &self.binding
    }

    /// Cloth with its nodes at `nodes` `[node]` freed of penetrations. Small loose pieces keep
    /// their shape where there is room.
    pub(crate) fn freed(
        &self,
        body: &PosedBody,
        nodes: &[Point3],
        options: &UntangleOptions,
    ) -> Result<Untangled, UntangleError> {
        let (cloth, binding) = (&*self.cloth, &self.binding);
        if self.pieces.is_empty() {
            return untangle(cloth, binding, body, nodes, options);
        }
        let mut stiff = nodes.to_vec();
        self.pieces.stiffen(cloth, &mut stiff);
        let mut untangled = untangle(cloth, binding, body, &stiff, options)?;
        let room = (body.skin(), options.clearance);
        let pieces = &self.pieces;
        if !pieces.stiffen_outside(cloth, &mut untangled.positions_nodes, room) {
            return Ok(untangled);
        }
        let moved = (&stiff[..], untangled.positions_nodes);
        counted_again(cloth, binding, body, moved, (&untangled.report, options))
    }

    /// How many nodes lie on other cloth of the garment and follow it.
    pub fn num_layered(&self) -> usize {
        self.binding.num_layered()
    }

    /// How many pairs of faces of the garment run through each other where its vertices are at
    /// `positions` `[vertex]`, in metres. See [`Binding::cloth_crossings`].
    ///
    /// # Errors
    ///
    /// [`Error::Untangle`] for positions out of any range.
    ///
    /// # Panics
    ///
    /// If there are fewer positions than vertices.
    pub fn cloth_crossings(&self, positions: &[Point3]) -> Result<usize, Error> {
        let nodes = self.cloth.weld().gather(positions);
        Ok(self.binding.cloth_crossings(nodes)?)
    }

    /// Positions `[vertex]` of the garment warped to a posed body, in metres.
    ///
    /// # Errors
    ///
    /// [`Error::Skin`] if `body` is not of the body that the garment was bound to.
    pub fn warped(&self, body: &PosedBody, warp: Warp) -> Result<Vec<Point3>, Error> {
        let nodes = self.cloth.warped_nodes(body, warp)?;
        Ok(self.cloth.weld().scatter(&nodes))
    }
}
