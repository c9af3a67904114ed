//! Bodies with the proportions of children, and what they wear.

use garnet_body::motion::{Figure, Role, Side};
use garnet_drape::BoundGarment;
use garnet_mesh::{Point3, TriMesh};
use garnet_skin::{Body, Skeleton, SkinWeights};

use crate::StressError;

/// How much smaller a child of four is than an adult, as shares: a head that is nearly grown, short
/// legs.
const HEAD: f32 = 0.1;
const TRUNK: f32 = 0.38;
const ARMS: f32 = 0.42;
const LEGS: f32 = 0.5;

/// Joints moved, and what hangs on them smaller, so that an adult becomes a child.
struct Growth {
    adult: Vec<Point3>,
    child: Vec<Point3>,
    /// Size of what follows each joint, of the adult's.
    size: Vec<f32>,
}

impl Growth {
    /// Of a figure; 0 leaves an adult, 1 is a child of four. None of what is no human figure.
    fn new(skeleton: &Skeleton, level: f32) -> Option<Self> {
        let figure = Figure::new(skeleton, "the body").ok()?;
        let mut smaller_by = vec![None; skeleton.num_joints()];
        let mut set = |role, share| {
            if let Some(joint) = figure.joint(role) {
                smaller_by[joint] = Some(share);
            }
        };
        set(Role::Head, HEAD);
        for side in Side::BOTH {
            set(Role::Shoulder(side), ARMS);
            set(Role::Hip(side), LEGS);
        }
        let adult: Vec<Point3> = (skeleton.joints().iter())
            .map(|joint| joint.rest_position)
            .collect();
        let (mut child, mut size) = (adult.clone(), vec![1.0; adult.len()]);
        for &joint in skeleton.parents_first() {
            let parent = skeleton.joints()[joint].parent;
            let inherited = parent
                .and_then(|parent| smaller_by[parent])
                .unwrap_or(TRUNK);
            let share = *smaller_by[joint].get_or_insert(inherited);
            size[joint] = 1.0 - level * share;
            child[joint] = match parent {
                Some(parent) => child[parent] + size[parent] * (adult[joint] - adult[parent]),
                None => Point3::origin() + size[joint] * adult[joint].coords,
            };
        }
        Some(Self { adult, child, size })
    }

    /// Where points go that follow the joints by `weights`.
    fn moved(&self, points: &[Point3], weights: &SkinWeights) -> Vec<Point3> {
        let points = points.iter().enumerate();
        let moved = points.map(|(vertex, point)| {
            let parts = weights.vertex(vertex).map(|(joint, weight)| {
                let place = self.child[joint] + self.size[joint] * (point - self.adult[joint]);
                weight * place.coords
            });
            Point3::from(parts.sum::<garnet_mesh::Vector3>())
        });
        moved.collect()
    }
}

/// The body of a garment with the proportions of a child, and the garment made smaller with it;
/// none of a body that is no human figure. 0 leaves them, 1 is a child of four.
pub(crate) fn child(
    garment: &BoundGarment,
    level: f64,
) -> Result<Option<(Body, TriMesh)>, StressError> {
    let adult = garment.body();
    let Some(growth) = Growth::new(adult.skeleton(), level as f32) else {
        return Ok(None);
    };
    let skin = growth.moved(adult.rest().positions(), adult.weights());
    let rest = TriMesh::new(skin, adult.rest().faces().to_vec())?;
    let skeleton = (adult.skeleton()).placed(|joint, _| growth.child[joint])?;
    let body = Body::new(rest, skeleton, adult.weights().clone())?;
    let (mesh, cloth) = (garment.mesh(), garment.cloth());
    let nodes = cloth.weld().gather(mesh.positions());
    let worn = cloth.weld().scatter(&growth.moved(&nodes, cloth.weights()));
    Ok(Some((body, TriMesh::new(worn, mesh.faces().to_vec())?)))
}

#[cfg(test)]
mod tests {
    use garnet_body::shape::{BodyParameters, ParametricBody};
    use garnet_mesh::Bounds;

    use super::*;

    #[test]
    fn children_are_small_and_have_large_heads() {
        let adult = ParametricBody::build(&BodyParameters::new(0.5))
            .unwrap()
            .body()
            .clone();
        let growth = Growth::new(adult.skeleton(), 1.0).unwrap();
        let moved = growth.moved(adult.rest().positions(), adult.weights());
        let height = |points: &[Point3]| Bounds::of(points).unwrap().extent().y;
        let [old, new] = [height(adult.rest().positions()), height(&moved)];
        // A child of four is a metre high, and its head a fifth of that.
        assert!((0.5..0.65).contains(&(new / old)), "{old} m, {new} m");
        let none = Growth::new(adult.skeleton(), 0.0).unwrap();
        let same = none.moved(adult.rest().positions(), adult.weights());
        let pairs = same.iter().zip(adult.rest().positions());
        let farthest = pairs.map(|(a, b)| (a - b).norm()).max_by(f32::total_cmp);
        assert!(farthest.unwrap() < 1e-5);
    }
}
