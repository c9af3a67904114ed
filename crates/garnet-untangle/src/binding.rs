//! What untangling needs of a bound garment and computes once.

use garnet_knn::{ClosestPoint, KnnError, Surface, VertexTree};
use garnet_mesh::{Bounds, MeshError, Point3, TriMesh, Vector3, face_normals, vertex_normals};
use garnet_skin::{BoundGarment, ScreenedPoisson, SkinError};
use rayon::prelude::*;

use crate::layers::{Layers, Sheets, orientation_by_sheet};

/// Skin this near to the skin that a node lies on, at rest, is its own even for tight cloth, in
/// metres: the reach of cloth that slides along a limb. With a larger one, skin beyond an armpit or
/// the crotch becomes own; with a smaller one, cloth that slides comes upon skin that it takes for
/// foreign.
const OWN_RADIUS: f32 = 0.08;

/// The own skin of loose cloth reaches farther by this much of its distance from the skin, which is
/// how far it may swing. Larger takes skirts for the skin of both legs, smaller for that of one.
const OWN_RADIUS_PER_DISTANCE: f32 = 2.0;

/// Cloth nearer to the skin at rest than this is not loose in that sense, in metres.
const LOOSE_DISTANCE: f32 = 0.015;

/// Skin that is turned from the skin that a node lies on, at rest, by an angle with a lower cosine
/// is the far side of the limb. Lower ones let own skin reach farther around it.
const FAR_SIDE_COSINE: f32 = -0.2;

/// Skin counts as covered if it is this near to the skin under some node, at rest, in metres: more
/// than half an edge of the coarsest garment, less than the width of a wrist.
const COVER_DISTANCE: f32 = 0.03;

/// Length over which the warp holds its place while its strain is relaxed, in metres. With a longer
/// one strain spreads farther and cloth leaves its place more.
const RELAX_LENGTH: f64 = 0.2;

/// What can go wrong before untangling starts.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UntangleError {
    /// The smoothing system of the garment cannot be factored.
    #[error(transparent)]
    Skin(#[from] SkinError),
    /// The garment or the body cannot be searched.
    #[error(transparent)]
    Knn(#[from] KnnError),
    /// The garment has no face of non-zero extent.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The posed body is not of the body that the garment was bound to.
    #[error("the body has {found} faces, the garment was bound to a body of {expected}")]
    BodyFaces {
        /// Faces of the posed body.
        found: usize,
        /// Faces of the rest body.
        expected: usize,
    },
    /// Another number of warped positions than the garment has nodes.
    #[error("there are {found} warped positions for {expected} nodes")]
    PositionCount {
        /// Positions given.
        found: usize,
        /// Nodes of the garment.
        expected: usize,
    },
}

/// A garment made ready for untangling: which skin belongs to which cloth.
///
/// In armpits, at the crotch and where an arm rests on the torso, the nearest skin may belong to
/// the wrong limb. The rest pose tells: skin near the skin that a node lay on at rest is the node's
/// *own*, all other is *foreign*. Cloth stays outside its own skin, facing it with its inner side.
/// Foreign skin is either *under* the cloth (the other thigh under a skirt) or *over* it (an arm on
/// a torso): under, if the garment covers it at rest and it lies behind the cloth there.
#[derive(Debug, Clone)]
pub struct Binding {
    pub(crate) surface: Surface,
    pub(crate) relax_system: ScreenedPoisson,
    /// 1 or -1 `[node]`: turns the normals of the faces to the outside of the garment.
    pub(crate) orientation: Vec<f32>,
    /// As of [`BoundGarment::scale`].
    pub(crate) scale: f32,
    /// Cloth that lies on cloth.
    pub(crate) layers: Layers,
    /// The skin that each node lies on at rest `[node]`.
    pub(crate) skin: Vec<ClosestPoint>,
    rest: Vec<Point3>,
    rest_normals: Vec<Vector3>,
    own_radius: Vec<f32>,
    skin_normals: Vec<Vector3>,
    face_centers: Vec<Point3>,
    face_normals: Vec<Vector3>,
    is_covered: Vec<bool>,
}

impl Binding {
    /// Classifies the skin of the rest body for every node of the garment.
    ///
    /// # Errors
    ///
    /// [`UntangleError::Skin`] or [`UntangleError::Mesh`] for a garment too degenerate to be
    /// smoothed or searched.
    pub fn new(garment: &BoundGarment) -> Result<Self, UntangleError> {
        let scale = garment.scale();
        let rest = garment.rest_nodes().to_vec();
        let mesh = TriMesh::new(rest.clone(), garment.faces().to_vec())?;
        let body = garment.rest_skin();
        let body_normals = face_normals(body.positions(), body.faces());
        let mut rest_normals = vertex_normals(&rest, garment.faces());
        let surface = Surface::new(&mesh);
        let sheets = Sheets::new(garment, &body_normals);
        let layers = Layers::new(garment, &surface, &sheets);
        let mut orientation = orientation(garment, &rest_normals, &body_normals);
        if !layers.is_single() {
            orientation = orientation_by_sheet(&sheets, garment.topology(), &orientation, &layers);
        }
        for (normal, sign) in rest_normals.iter_mut().zip(&orientation) {
            *normal *= *sign;
        }
        let skin_points: Vec<Point3> = garment.skin().iter().map(|skin| skin.point).collect();
        let skin_normals = garment
            .skin()
            .iter()
            .map(|skin| body_normals[skin.face as usize])
            .collect();
        let own_radius = garment.skin().iter().enumerate().map(|(node, skin)| {
            // Over a hole no skin is the cloth's own.
            if garment.is_over_hole(node) {
                return 0.0;
            }
            let loose = (skin.distance_squared.sqrt() - scale * LOOSE_DISTANCE).max(0.0);
            scale * OWN_RADIUS + OWN_RADIUS_PER_DISTANCE * loose
        });
        let own_radius = own_radius.collect();
        let center = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|vertex| body.positions()[vertex as usize].coords);
            Point3::from((a + b + c) / 3.0)
        };
        let face_centers: Vec<Point3> = body.faces().iter().map(center).collect();
        let is_covered = || {
            let tree = VertexTree::new(&skin_points)?;
            let cover = scale * COVER_DISTANCE;
            // To ask for the nearest point is dear from far away.
            let bounds = Bounds::of(&skin_points);
            let covered = face_centers.par_iter().map(|&center| {
                let is_near = bounds.is_some_and(|bounds| bounds.distance(center) < cover);
                let nearest = is_near.then(|| tree.nearest(center)).flatten();
                nearest.is_some_and(|n| n.distance_squared < cover * cover)
            });
            Ok::<Vec<bool>, KnnError>(covered.collect())
        };
        let relax_system = || {
            let areas = garment.graph().node_areas().iter();
            let length = f64::from(scale) * RELAX_LENGTH;
            let screening = areas.map(|&area| f64::from(area) / (length * length));
            (garment.system()).rescreened(garment.graph(), screening.collect())
        };
        let (is_covered, relax_system) = rayon::join(is_covered, relax_system);
        Ok(Self {
            surface,
            relax_system: relax_system?,
            orientation,
            scale,
            layers,
            rest,
            rest_normals,
            skin: garment.skin().to_vec(),
            own_radius,
            skin_normals,
            face_centers,
            face_normals: body_normals,
            is_covered: is_covered?,
        })
    }

    /// How many pairs of faces of the garment run through each other where its nodes are at
    /// `positions_nodes`, in metres. Faces that share a corner count where they meet beyond it.
    ///
    /// # Errors
    ///
    /// [`UntangleError::Knn`] for another number of positions than nodes, or positions out of any
    /// range.
    pub fn cloth_crossings(&self, positions_nodes: Vec<Point3>) -> Result<usize, UntangleError> {
        Ok(self.surface_at(positions_nodes)?.self_intersections().len())
    }

    /// The garment as a surface where its nodes are at `positions_nodes`, in metres.
    ///
    /// # Errors
    ///
    /// As [`Binding::cloth_crossings`].
    pub fn surface_at(&self, positions_nodes: Vec<Point3>) -> Result<Surface, UntangleError> {
        Ok(self.surface.moved(positions_nodes)?)
    }

    /// How many nodes lie on other cloth of the garment and follow it.
    pub fn num_layered(&self) -> usize {
        self.layers.num_followers()
    }

    /// Whether a face of the skin was near the skin that a node lay on at rest, and not on the far
    /// side of the limb.
    pub(crate) fn is_own(&self, node: usize, face: u32) -> bool {
        let face = face as usize;
        let offset = self.face_centers[face] - self.skin[node].point;
        offset.norm_squared() < self.own_radius[node] * self.own_radius[node]
            && self.face_normals[face].dot(&self.skin_normals[node]) > FAR_SIDE_COSINE
    }

    /// Whether foreign skin belongs under the cloth at a node.
    pub(crate) fn is_under(&self, node: usize, face: u32) -> bool {
        let offset = self.face_centers[face as usize] - self.rest[node];
        self.is_covered[face as usize] && offset.dot(&self.rest_normals[node]) < 0.0
    }
}

/// For each node 1, or -1 if most of its component's faces turn their normals to the skin.
fn orientation(garment: &BoundGarment, normals: &[Vector3], body_normals: &[Vector3]) -> Vec<f32> {
    let components = garment.topology().components();
    let mut votes = vec![0.0_f64; garment.topology().num_components()];
    for (node, skin) in garment.skin().iter().enumerate() {
        let agreement = normals[node].dot(&body_normals[skin.face as usize]);
        let area = garment.graph().node_areas()[node];
        votes[components[node] as usize] += f64::from(agreement * area);
    }
    let sign = |&component: &u32| {
        if votes[component as usize] < 0.0 {
            -1.0
        } else {
            1.0
        }
    };
    components.iter().map(sign).collect()
}
