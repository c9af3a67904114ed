//! What a scene tells of its mirror image.

use garnet_data::Tailor;
use garnet_mesh::{Point3, TriMesh, Vector3};
use garnet_net::pose_space::{Exchange, Image, Mirror};
use garnet_skin::Symmetry;
use rayon::prelude::*;

use crate::Stage;

/// As many of the vertices as this, mirrored, must lie on the garment.
const SHARE_ON: f64 = 0.95;

/// No farther than this from it, in metres: folds that a garment has at rest are not the same on
/// both sides.
const ON: f32 = 0.01;

/// How the left of a garment lies on its right.
#[derive(Debug, Clone)]
pub(crate) struct GarmentMirror {
    /// For each vertex the triangle on which its mirror image lies, and the weights of its corners.
    images: Vec<Image>,
    /// From where each vertex is at rest to where the mirror image of the garment has it, in
    /// metres: folds at rest need not be alike on both sides.
    apart: Vec<Vector3>,
    numbers: Exchange,
}

/// For each vertex the triangle on which its mirror image lies, and the weights of its corners;
/// none of a mesh whose left and right differ.
pub(crate) fn images_on(mesh: &TriMesh, symmetry: &Symmetry) -> Option<Vec<Image>> {
    let surface = garnet_knn::Surface::new(mesh);
    let image = |place: &Point3| {
        let found = surface.closest(symmetry.point(place));
        let triangle = mesh.faces()[found.face as usize];
        (triangle, found.barycentric, found.distance_squared.sqrt())
    };
    let images: Vec<_> = mesh.positions().par_iter().map(image).collect();
    let on = images.iter().filter(|(_, _, distance)| *distance <= ON);
    if (on.count() as f64) < SHARE_ON * images.len() as f64 {
        return None;
    }
    let without_distance = |(triangle, weights, _)| (triangle, weights);
    Some(images.into_iter().map(without_distance).collect())
}

/// The mirror images of the vertices of a garment that was cut from a pattern, which are vertices,
/// however its folds lie at rest.
fn sewn_images(stage: &Stage, mesh: &TriMesh) -> Option<Vec<Image>> {
    let tailor = Tailor::of_package(&stage.package).ok()??;
    let template = tailor.template();
    if template.faces() != mesh.faces() || template.mirror().len() != mesh.num_vertices() {
        return None;
    }
    let images = template.mirror().iter();
    Some(
        images
            .map(|&vertex| ([vertex; 3], [1.0, 0.0, 0.0]))
            .collect(),
    )
}

/// From where each vertex is at rest to where the mirror image of the garment has it.
fn apart(mesh: &TriMesh, images: &[Image], symmetry: &Symmetry) -> Vec<Vector3> {
    let places = mesh.positions();
    let apart = |((triangle, weights), place): (&Image, &Point3)| {
        let corners = triangle.iter().zip(weights);
        let sum = corners.fold(Vector3::zeros(), |sum, (&corner, &weight)| {
            sum + places[corner as usize].coords * weight
        });
        symmetry.point(&Point3::from(sum)) - place
    };
    images.iter().zip(places).map(apart).collect()
}

impl GarmentMirror {
    /// Of the garment and the body of a package; none if left and right of them differ.
    pub(crate) fn of(stage: &Stage) -> Option<Self> {
        let template = stage.template();
        let symmetry = template.body.skeleton().symmetry()?;
        let mesh = template.garment.mesh();
        let images = match sewn_images(stage, mesh) {
            Some(images) => images,
            None => images_on(mesh, &symmetry)?,
        };
        Some(Self {
            apart: apart(mesh, &images, &symmetry),
            images,
            numbers: Exchange(template.body.mirrored_numbers(&symmetry)),
        })
    }

    /// The mirror image of offsets in the skinning frames `[vertex][3]`.
    pub(super) fn offsets(&self, offsets: &[f32]) -> Vec<f32> {
        let (vectors, _) = offsets.as_chunks::<3>();
        let image = |((triangle, weights), apart): (&Image, &Vector3)| {
            let corners = triangle.iter().zip(weights);
            let sum = corners.fold(Vector3::zeros(), |sum, (&corner, &weight)| {
                sum + Vector3::from(vectors[corner as usize]) * weight
            });
            let image = Symmetry::vector(sum) + apart;
            [image.x, image.y, image.z]
        };
        let images = self.images.iter().zip(&self.apart);
        images.flat_map(image).collect()
    }

    /// For each vertex the triangle on which its mirror image lies, and the weights of its corners.
    pub(crate) fn images(&self) -> &[Image] {
        &self.images
    }

    /// How numbers of pose and shape are exchanged.
    pub(crate) fn numbers(&self) -> &Exchange {
        &self.numbers
    }

    /// Gives left and right the same scales, the larger ones `[number]`.
    pub(super) fn even_out(&self, scales: &mut [f32]) {
        let own = scales.to_vec();
        for (scale, &(other, _)) in scales.iter_mut().zip(&self.numbers.0) {
            *scale = scale.max(own[other]);
        }
    }

    /// As a deformation keeps it, with the parity of its shapes.
    pub(super) fn with_parity(&self, parity: Vec<f32>) -> Mirror {
        Mirror {
            numbers: self.numbers.clone(),
            parity,
        }
    }
}
