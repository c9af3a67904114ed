//! Limbs that come out of the cloth which is round them: a finger out of its glove, an arm out of
//! its sleeve. No vertex is inside the body then, and yet the garment is not worn.

use garnet_mesh::Point3;
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
        let is_in = contained(garment, &asked, (rest, body.skin().positions()), IN_WINDING)?;
        let joints = asked.into_iter().zip(is_in);
        let joints = joints.filter_map(|((joint, vertices), is_in)| {
            let count = vertices.len();
            let pairs = vertices.into_iter().zip(is_in);
            let inside: Vec<u32> = pairs.filter(|(_, is_in)| *is_in).map(|(v, _)| v).collect();
            let is_worn = inside.len() >= MIN_IN && inside.len() as f32 >= IN_SHARE * count as f32;
            is_worn.then_some((joint, inside))
        });
        Ok(Self {
            joints: joints.collect(),
        })
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
        let skin = body.skin().positions();
        let is_in = contained(garment, &self.joints, (positions, skin), OUT_WINDING)?;
        let shares = self.joints.iter().zip(is_in).map(|((joint, _), is_in)| {
            let out = is_in.iter().filter(|is_in| !**is_in).count();
            LimbOutside {
                joint: *joint,
                share: out as f32 / is_in.len().max(1) as f32,
            }
        });
        Ok(shares.filter(|limb| limb.share > OUT_SHARE).collect())
    }
}

/// Which vertices of a body the cloth goes round more often than `least`.
fn contained(
    garment: &BoundGarment,
    joints: &[(usize, Vec<u32>)],
    (positions, skin): (&[Point3], &[Point3]),
    least: f32,
) -> Result<Vec<Vec<bool>>, Error> {
    if joints.is_empty() {
        return Ok(Vec::new());
    }
    let nodes = garment.cloth().weld().gather(positions);
    let cloth = garment.binding().surface_at(nodes)?;
    let is_in = |vertex: &u32| {
        let place = skin.get(*vertex as usize);
        place.is_some_and(|place| cloth.generalized_winding_number(*place).abs() > least)
    };
    let joints = joints.par_iter();
    Ok(joints
        .map(|(_, vertices)| vertices.iter().map(is_in).collect())
        .collect())
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
    }
}
