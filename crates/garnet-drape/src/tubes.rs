//! Limbs that come out of the cloth which is round them: a finger out of its glove, an arm out of
//! its sleeve. No vertex is inside the body then, and yet the garment is not worn.

use garnet_knn::Surface;
use garnet_mesh::{Point3, TriMesh};
use garnet_skin::PosedBody;
use rayon::prelude::*;

use crate::{BoundGarment, Error};

/// Places on the skin of a joint that are looked at.
const SAMPLES: usize = 24;

/// Skin is in the cloth at rest if the cloth goes round it so often: less counts skin near
/// openings, which slides out of them.
const IN_WINDING: f32 = 0.8;

/// It is out of the cloth if that goes round it less often than this; more takes the skin at the
/// opening of a sleeve for bare, on arms that are raised.
const OUT_WINDING: f32 = 0.25;

/// A joint is in the cloth at rest if at least this share of its places is, and as many.
const IN_SHARE: f32 = 0.5;
const MIN_IN: usize = 6;

/// A limb has come out of the cloth if more than this share of what was in it is not. Hems that
/// slide bare less.
const OUT_SHARE: f32 = 0.4;

/// Skin beyond the rim of the cloth, as of a forearm whose sleeve rides up, does not count, unless
/// more than this share of the limb is there: then all of it has left the sleeve.
const ALL_OUT: f32 = 0.9;

/// Weights of corners below this are rounding.
const ON_CORNER: f32 = 1e-5;

/// A limb that is out of the cloth which was round it at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LimbOutside {
    /// The joint that its skin follows most.
    pub joint: usize,
    /// What share of its skin that was in the cloth is not, from 0 to 1.
    pub share: f32,
}

/// The skin that lies in the cloth of a garment at rest.
#[derive(Debug, Clone)]
pub struct Tubes {
    /// The cloth at rest with all faces turned outwards, if some look to another side than most:
    /// a lining, whose turns about a limb would cancel those of its shell.
    turned: Option<Surface>,
    /// Joints, and vertices of the body whose skin follows them most.
    joints: Vec<(usize, Vec<u32>)>,
}

impl Tubes {
    /// Finds the limbs that are in the cloth of a garment at rest.
    ///
    /// # Errors
    ///
    /// [`Error::Untangle`] for a garment out of any range.
    pub fn new(garment: &BoundGarment) -> Result<Self, Error> {
        let body = garment.body();
        let weights = body.weights();
        let mut of_joints = vec![Vec::new(); weights.num_joints()];
        let mut is_named = vec![false; weights.num_vertices()];
        for &vertex in body.skin().faces().iter().flatten() {
            if let Some(is_named) = is_named.get_mut(vertex as usize) {
                *is_named = true;
            }
        }
        for vertex in (0..is_named.len()).filter(|&vertex| is_named[vertex]) {
            of_joints[weights.heaviest(vertex)].push(vertex as u32);
        }
        for vertices in &mut of_joints {
            let step = vertices.len().div_ceil(SAMPLES).max(1);
            *vertices = vertices.iter().copied().step_by(step).collect();
        }
        let asked: Vec<(usize, Vec<u32>)> = of_joints.into_iter().enumerate().collect();
        let rest = garment.mesh().positions();
        let turned = turned_outwards(garment);
        let cloth = Cloth::at(garment, turned.as_ref(), rest)?;
        let skin = body.skin().positions();
        let joints = asked.into_par_iter().filter_map(|(joint, mut vertices)| {
            let count = vertices.len();
            vertices.retain(|&vertex| {
                let place = skin.get(vertex as usize);
                place.is_some_and(|place| cloth.goes_round(place, IN_WINDING))
            });
            let is_worn =
                vertices.len() >= MIN_IN && vertices.len() as f32 >= IN_SHARE * count as f32;
            is_worn.then_some((joint, vertices))
        });
        let joints = joints.collect();
        Ok(Self { turned, joints })
    }

    /// The limbs that are out of the cloth where the garment's vertices are at `positions`
    /// `[vertex]` on `body`, in metres.
    ///
    /// # Errors
    ///
    /// [`Error::Untangle`] for positions out of any range.
    pub fn limbs_outside(
        &self,
        garment: &BoundGarment,
        positions: &[Point3],
        body: &PosedBody,
    ) -> Result<Vec<LimbOutside>, Error> {
        if self.joints.is_empty() {
            return Ok(Vec::new());
        }
        let cloth = Cloth::at(garment, self.turned.as_ref(), positions)?;
        let skin = body.skin().positions();
        let outside = self.joints.par_iter().map(|(joint, vertices)| {
            let places = vertices.iter();
            let places = places.filter_map(|&vertex| skin.get(vertex as usize).copied());
            let out: Vec<Point3> = places
                .filter(|place| !cloth.goes_round(place, OUT_WINDING))
                .collect();
            let count = vertices.len().max(1) as f32;
            let all = out.len() as f32 / count;
            let beside = out.iter().filter(|place| !cloth.ends_before(place));
            let share = if all > ALL_OUT {
                all
            } else {
                beside.count() as f32 / count
            };
            LimbOutside {
                joint: *joint,
                share,
            }
        });
        let outside: Vec<LimbOutside> = outside.collect();
        let is_out = |limb: &LimbOutside| limb.share > OUT_SHARE;
        Ok(outside.into_iter().filter(is_out).collect())
    }
}

/// Of faces that look inwards, a smaller share is turned by folds, and a larger one is a garment
/// inside out.
const MIXED: std::ops::Range<f32> = 0.15..0.85;

/// The cloth at rest with all faces looking away from the skin, if they do not look to one side.
fn turned_outwards(garment: &BoundGarment) -> Option<Surface> {
    let cloth = garment.cloth();
    if !MIXED.contains(&cloth.inward_share()) {
        return None;
    }
    let (nodes, skin) = (cloth.rest_nodes(), garment.body().skin());
    let normal = |[a, b, c]: [Point3; 3]| (b - a).cross(&(c - a));
    let mut faces = cloth.faces().to_vec();
    for face in &mut faces {
        let [first, ..] = *face;
        let under = skin.faces()[cloth.skin()[first as usize].face as usize];
        let under = normal(under.map(|vertex| skin.positions()[vertex as usize]));
        if normal(face.map(|node| nodes[node as usize])).dot(&under) < 0.0 {
            face.swap(1, 2);
        }
    }
    let mesh = TriMesh::new(nodes.to_vec(), faces).ok()?;
    Some(Surface::new(&mesh))
}

/// The cloth of a garment in some place.
struct Cloth<'a> {
    garment: &'a BoundGarment,
    surface: Surface,
}

impl<'a> Cloth<'a> {
    fn at(
        garment: &'a BoundGarment,
        turned: Option<&Surface>,
        positions: &[Point3],
    ) -> Result<Self, Error> {
        let nodes = garment.cloth().weld().gather(positions);
        let surface = match turned {
            Some(turned) => turned.moved(nodes)?,
            None => garment.binding().surface_at(nodes)?,
        };
        Ok(Self { garment, surface })
    }

    /// Whether it goes round a place more often than `least`.
    fn goes_round(&self, place: &Point3, least: f32) -> bool {
        self.surface.generalized_winding_number(*place).abs() > least
    }

    /// Whether a place lies beyond its rim, and not beside it.
    fn ends_before(&self, place: &Point3) -> bool {
        let topology = self.garment.cloth().topology();
        let nearest = self.surface.closest(*place);
        let corners = topology.faces()[nearest.face as usize];
        let mut corners = corners.into_iter().zip(nearest.barycentric);
        corners.all(|(node, weight)| weight < ON_CORNER || topology.is_boundary(node as usize))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Garment;
    use garnet_mesh::primitives::{capsule, tube};
    use garnet_skin::{Body, Joint, Pose, Skeleton, SkinWeights};

    #[test]
    fn a_limb_beside_its_sleeve_is_out_of_it() {
        let limb = capsule(0.05, 0.6, 24, 24);
        let joint = Joint {
            name: "limb".to_owned(),
            parent: None,
            rest_position: Point3::origin(),
        };
        let weights = SkinWeights::from_dense(1, &vec![1.0; limb.num_vertices()]).unwrap();
        let body = Body::new(limb, Skeleton::new(vec![joint]).unwrap(), weights).unwrap();
        let sleeve = Garment::new(tube(0.06, 0.9, 32, 24)).bind(&body).unwrap();
        let tubes = Tubes::new(&sleeve).unwrap();
        let posed = body.posed(&Pose::rest(1)).unwrap();
        let moved = |by: f32| -> Vec<Point3> {
            let rest = sleeve.mesh().positions().iter();
            rest.map(|p| Point3::new(p.x + by, p.y, p.z)).collect()
        };
        let outside = |by| tubes.limbs_outside(&sleeve, &moved(by), &posed).unwrap();
        assert_eq!(outside(0.0), []);
        assert_eq!(outside(0.005), []);
        let found = outside(0.2);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].joint, 0);
        assert!(found[0].share > 0.99);
        // It rides up, by a half of the limb and more, and off it.
        let slid = |by: f32| -> Vec<Point3> {
            let rest = sleeve.mesh().positions().iter();
            rest.map(|p| Point3::new(p.x, p.y + by, p.z)).collect()
        };
        let outside = |by| tubes.limbs_outside(&sleeve, &slid(by), &posed).unwrap();
        assert_eq!(outside(0.6), []);
        assert_eq!(outside(1.5).len(), 1);
    }

    #[test]
    fn a_lining_that_looks_inwards_hides_nothing() {
        let limb = capsule(0.05, 0.6, 24, 24);
        let joint = Joint {
            name: "limb".to_owned(),
            parent: None,
            rest_position: Point3::origin(),
        };
        let weights = SkinWeights::from_dense(1, &vec![1.0; limb.num_vertices()]).unwrap();
        let body = Body::new(limb, Skeleton::new(vec![joint]).unwrap(), weights).unwrap();
        let [shell, lining] = [0.064, 0.06].map(|radius| tube(radius, 0.9, 32, 24));
        let count = shell.num_vertices() as u32;
        let places = [shell.positions(), lining.positions()].concat();
        let turned = lining.faces().iter();
        let turned = turned.map(|&[a, b, c]| [a + count, c + count, b + count]);
        let faces = shell.faces().iter().copied().chain(turned);
        let lined = TriMesh::new(places, faces.collect()).unwrap();
        let sleeve = Garment::new(lined).bind(&body).unwrap();
        let tubes = Tubes::new(&sleeve).unwrap();
        let posed = body.posed(&Pose::rest(1)).unwrap();
        for (by, expected) in [(0.0, 0), (0.2, 1)] {
            let rest = sleeve.mesh().positions().iter();
            let moved: Vec<Point3> = rest.map(|p| Point3::new(p.x + by, p.y, p.z)).collect();
            let outside = tubes.limbs_outside(&sleeve, &moved, &posed).unwrap();
            assert_eq!(outside.len(), expected);
        }
    }
}
