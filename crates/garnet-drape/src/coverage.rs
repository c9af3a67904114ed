//! Which faces of a body a garment covers, so that programs need not draw them.
//!
//! A face may be hidden if it is never seen: where the garment was made, and in each drape, all of
//! it lies close under cloth, and far from the openings of the garment for how loose the cloth is
//! there. In doubt it is not hidden.

use garnet_knn::{ClosestPoint, Surface};
use garnet_mesh::{Point3, TriMesh, Vector3};
use garnet_skin::PosedBody;
use rayon::prelude::*;

use crate::BoundGarment;

/// What counts as covered. Lengths are metres.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CoverageOptions {
    /// Cloth that is farther from the skin does not cover it.
    pub reach: f32,
    /// Cloth nearer than this to an opening does not cover, and ...
    pub margin: f32,
    /// ... nor does cloth nearer to one than so many times its distance from the skin: under loose
    /// cloth one sees farther in.
    pub slope: f32,
    /// Cloth covers skin that looks at it within this angle, in radians.
    pub angle: f32,
}

impl Default for CoverageOptions {
    fn default() -> Self {
        Self {
            reach: 0.05,
            margin: 0.02,
            slope: 3.0,
            angle: 1.0,
        }
    }
}

/// The faces of a body that a garment covers in all that was seen of it.
///
/// # Examples
///
/// ```no_run
/// use garnet_drape::{Coverage, CoverageOptions, Draper};
/// use garnet_skin::PosedBody;
///
/// fn hidden(draper: &Draper, frames: &[PosedBody]) -> Result<Vec<bool>, garnet_drape::Error> {
///     let mut coverage = Coverage::at_rest(draper.garment(), CoverageOptions::default());
///     for body in frames {
///         let drape = draper.drape(body)?;
///         coverage.see(draper.garment(), body, &drape.positions);
///     }
///     Ok(coverage.into_hidden())
/// }
/// ```
#[derive(Debug, Clone)]
pub struct Coverage {
    options: CoverageOptions,
    /// Whether each face of the body's mesh is covered `[face]`.
    is_hidden: Vec<bool>,
    /// Vertices of the cloth at an opening `[node]`.
    at_opening: Vec<u32>,
}

impl Coverage {
    /// What the garment covers of the body that it was bound to, at rest.
    pub fn at_rest(garment: &BoundGarment, options: CoverageOptions) -> Self {
        let cloth = garment.cloth();
        let topology = cloth.topology();
        let num_nodes = cloth.rest_nodes().len() as u32;
        let mut coverage = Self {
            options,
            is_hidden: vec![true; garment.body().rest().num_faces()],
            at_opening: (0..num_nodes)
                .filter(|&node| topology.is_boundary(node as usize))
                .collect(),
        };
        let body = garment.body();
        let nodes = cloth.rest_nodes().to_vec();
        coverage.leave_covered(body.skin(), nodes, topology.faces());
        coverage
    }

    /// The same, after a drape, too: positions `[vertex]` of the garment's mesh on a body.
    ///
    /// # Panics
    ///
    /// If there are fewer positions than vertices, or `body` is not of the body that the garment
    /// was bound to.
    pub fn see(&mut self, garment: &BoundGarment, body: &PosedBody, positions: &[Point3]) {
        // What closes holes of the skin follows the faces of the mesh.
        assert!(
            body.skin().faces().len() >= self.is_hidden.len(),
            "the body that is worn on"
        );
        let cloth = garment.cloth();
        let nodes = cloth.weld().gather(positions);
        self.leave_covered(body.skin(), nodes, cloth.topology().faces());
    }

    /// Whether each face of the body's mesh is covered in all that was seen `[face]`.
    pub fn into_hidden(self) -> Vec<bool> {
        self.is_hidden
    }

    /// Leaves those faces that are covered by cloth at `nodes`, too.
    fn leave_covered(&mut self, skin: &Surface, nodes: Vec<Point3>, cloth_faces: &[[u32; 3]]) {
        let openings: Vec<Point3> = self
            .at_opening
            .iter()
            .map(|&node| nodes[node as usize])
            .collect();
        let Ok(mesh) = TriMesh::new(nodes, cloth_faces.to_vec()) else {
            self.is_hidden.fill(false);
            return;
        };
        let over = Over {
            cloth: Surface::new(&mesh),
            openings: garnet_knn::VertexTree::new(&openings).ok(),
            options: self.options,
        };
        let (places, body_faces) = (skin.positions(), skin.faces());
        let normals = garnet_mesh::vertex_normals(places, body_faces);
        let mut is_needed = vec![false; places.len()];
        for (face, _) in body_faces
            .iter()
            .zip(&self.is_hidden)
            .filter(|(_, hidden)| **hidden)
        {
            for &vertex in face {
                is_needed[vertex as usize] = true;
            }
        }
        let is_covered: Vec<bool> = (0..places.len())
            .into_par_iter()
            .map(|vertex| is_needed[vertex] && over.covers(places[vertex], normals[vertex]))
            .collect();
        let is_whole = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|vertex| places[vertex as usize]);
            let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
            face.iter().all(|&vertex| is_covered[vertex as usize])
                && over.covers(middle, (b - a).cross(&(c - a)))
        };
        self.is_hidden
            .par_iter_mut()
            .zip(body_faces)
            .filter(|(is_hidden, _)| **is_hidden)
            .for_each(|(is_hidden, face)| *is_hidden = is_whole(face));
    }
}

/// Cloth, and where it ends.
struct Over {
    cloth: Surface,
    openings: Option<garnet_knn::VertexTree>,
    options: CoverageOptions,
}

impl Over {
    /// Whether cloth covers a place of the skin with this normal, of any length.
    fn covers(&self, place: Point3, normal: Vector3) -> bool {
        let options = &self.options;
        let Some(ClosestPoint { point, .. }) = self.cloth.closest_within(place, options.reach)
        else {
            return false;
        };
        let way = point - place;
        let gap = way.norm();
        let is_before = way.dot(&normal) >= options.angle.cos() * gap * normal.norm();
        let clear = options.margin.max(options.slope * gap);
        let opening = self.openings.as_ref().and_then(|tree| tree.nearest(point));
        is_before && opening.is_none_or(|near| near.distance_squared.sqrt() >= clear)
    }
}

#[cfg(test)]
mod tests {
    use garnet_mesh::primitives::{capsule, tube};
    use garnet_skin::{Body, Joint, Pose, Skeleton, SkinWeights};

    use super::*;
    use crate::{Draper, Garment};

    /// A trunk from -0.7 to 0.7 with a joint, and a tube over it from -0.4 to 0.4.
    fn dressed(radius: f32) -> (Body, BoundGarment) {
        let mesh = capsule(0.1, 1.4, 24, 40);
        let joint = Joint {
            name: "root".to_owned(),
            parent: None,
            rest_position: Point3::origin(),
        };
        let weights = SkinWeights::from_influences(1, vec![[(0, 1.0)]; mesh.num_vertices()]);
        let skeleton = Skeleton::new(vec![joint]).unwrap();
        let body = Body::new(mesh, skeleton, weights.unwrap()).unwrap();
        let garment = Garment::new(tube(radius, 0.8, 48, 40)).bind(&body).unwrap();
        (body, garment)
    }

    /// The farthest of the hidden faces from the middle, and how many there are.
    fn hidden(body: &Body, is_hidden: &[bool]) -> (f32, usize) {
        let mesh = body.rest();
        let faces = mesh
            .faces()
            .iter()
            .zip(is_hidden)
            .filter(|(_, hidden)| **hidden);
        let ends = faces
            .clone()
            .flat_map(|(face, _)| face.map(|v| mesh.positions()[v as usize].y.abs()));
        (ends.fold(0.0, f32::max), faces.count())
    }

    #[test]
    fn what_lies_close_under_cloth_and_far_from_its_ends_is_hidden() {
        let options = CoverageOptions::default();
        let mut before = usize::MAX;
        for radius in [0.105, 0.12, 0.14] {
            let (body, garment) = dressed(radius);
            let is_hidden = Coverage::at_rest(&garment, options).into_hidden();
            let (end, count) = hidden(&body, &is_hidden);
            let clear = options.margin.max(options.slope * (radius - 0.1));
            // Between sides of the tube the cloth is a little nearer.
            assert!(end < 0.4 - clear + 0.01, "{end} of {radius}");
            assert!(count > 100 && count <= before, "{count} of {radius}");
            before = count;
        }
        let (body, loose) = dressed(0.2);
        let is_hidden = Coverage::at_rest(&loose, options).into_hidden();
        assert_eq!(hidden(&body, &is_hidden).1, 0);
    }

    #[test]
    fn what_a_drape_uncovers_is_not_hidden() {
        let (body, garment) = dressed(0.105);
        let options = CoverageOptions::default();
        let at_rest = Coverage::at_rest(&garment, options);
        let posed = body.posed(&Pose::rest(1)).unwrap();
        let drape = Draper::new(garment.clone()).drape(&posed).unwrap();
        let mut same = at_rest.clone();
        same.see(&garment, &posed, &drape.positions);
        let (_, count) = hidden(&body, &at_rest.clone().into_hidden());
        assert_eq!(hidden(&body, &same.into_hidden()).1, count);
        // Pushed up by 0.2.
        let mut pushed = at_rest;
        let up: Vec<Point3> = drape
            .positions
            .iter()
            .map(|p| p + Vector3::y() * 0.2)
            .collect();
        pushed.see(&garment, &posed, &up);
        let is_hidden = pushed.into_hidden();
        let faces = body
            .rest()
            .faces()
            .iter()
            .zip(&is_hidden)
            .filter(|(_, hidden)| **hidden);
        let lowest =
            faces.flat_map(|(face, _)| face.map(|v| body.rest().positions()[v as usize].y));
        let lowest = lowest.fold(f32::INFINITY, f32::min);
        assert!(lowest > -0.2 && lowest < 0.0, "{lowest}");
    }
}
