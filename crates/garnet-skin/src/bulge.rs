//! How high missing skin stood over the flat faces that close its hole.
//!
//! Around a small hole the skin goes on as it looks at the rim: it lies below the tangent planes of
//! the rim. On a ball, the lowest of these is twice as high over the middle of the hole as the skin
//! was.

use std::collections::BTreeMap;

use garnet_knn::ClosestPoint;
use garnet_mesh::{Point3, Vector3, vertex_normals};

use crate::Body;

/// Missing skin stands so high over a cap, of the height of the lowest tangent plane of its rim. More
/// keeps cloth farther from holes, less lets it sink into them. That of a ball, in the middle.
const OF_TANGENTS: f32 = 0.5;

/// Rims whose skin looks along the cap are ends of limbs or necks, which do not go on as a bulge:
/// the least cosine between the skin's normals and that of the cap. Less takes steeper ones.
const LEAST_ALONG: f32 = 0.3;

/// This share of a rim, at least, has to look so. Less takes more holes.
const LEAST_SHARE: f32 = 0.8;

/// A vertex of a rim, and the normal of the skin there.
type Rim = Vec<(Point3, Vector3)>;

/// How high the missing skin was above the cap under each node, in metres `[node]`; 0 of nodes over
/// skin that is there, empty of bodies without holes. `skin` is the closest skin of each node.
pub(crate) fn bulges(body: &Body, skin: &[ClosestPoint]) -> Vec<f32> {
    let surface = body.skin();
    if !surface.has_caps() {
        return Vec::new();
    }
    let (positions, faces) = (surface.positions(), surface.faces());
    let first = faces.len()
        - (0_u32..faces.len() as u32)
            .filter(|&face| surface.is_cap(face))
            .count();
    let (real, caps) = faces.split_at(first);
    let hole_of = holes_of(positions.len(), caps);
    let normals = vertex_normals(positions, real);
    let mut holes: BTreeMap<u32, (Rim, Vector3)> = BTreeMap::new();
    for corners in caps {
        let [a, b, c] = corners.map(|corner| positions[corner as usize]);
        let (_, area) = holes.entry(hole_of[corners[0] as usize]).or_default();
        *area += (b - a).cross(&(c - a));
    }
    for (vertex, hole) in hole_of.iter().enumerate() {
        if let Some((rim, _)) = holes.get_mut(hole) {
            rim.push((positions[vertex], normals[vertex]));
        }
    }
    let bulge = |near: &ClosestPoint| {
        let face = near.face as usize;
        let corner = faces[face].first().filter(|_| face >= first)?;
        let (rim, area) = holes.get(&hole_of[*corner as usize])?;
        above(near.point, rim, area.try_normalize(f32::MIN_POSITIVE)?)
    };
    skin.iter().map(|near| bulge(near).unwrap_or(0.0)).collect()
}

/// The lowest vertex of the hole that each vertex is at the rim of `[vertex]`; itself, of others.
fn holes_of(num_vertices: usize, caps: &[[u32; 3]]) -> Vec<u32> {
    let mut lowest: Vec<u32> = (0..num_vertices as u32).collect();
    loop {
        let mut is_done = true;
        for corners in caps {
            let low = corners
                .map(|corner| lowest[corner as usize])
                .into_iter()
                .min();
            for corner in corners {
                let own = &mut lowest[*corner as usize];
                if let Some(low) = low.filter(|low| low < own) {
                    (*own, is_done) = (low, false);
                }
            }
        }
        if is_done {
            return lowest;
        }
    }
}

/// How high skin stood above a point of a cap that looks along `outward`; none if the skin at the rim
/// does not go on over the hole.
fn above(point: Point3, rim: &Rim, outward: Vector3) -> Option<f32> {
    let height = |(place, normal): &(Point3, Vector3)| {
        let along = normal.dot(&outward);
        (along > LEAST_ALONG).then(|| (place - point).dot(normal) / along)
    };
    let heights: Vec<f32> = rim.iter().filter_map(height).collect();
    let is_bulge = heights.len() as f32 >= LEAST_SHARE * rim.len() as f32;
    let lowest = heights
        .into_iter()
        .min_by(f32::total_cmp)
        .filter(|_| is_bulge)?;
    Some((OF_TANGENTS * lowest).max(0.0))
}

#[cfg(test)]
mod tests {
    use garnet_mesh::TriMesh;
    use garnet_mesh::primitives::{icosphere, tube};

    use super::*;
    use crate::{Joint, Skeleton, SkinWeights};

    const RADIUS: f32 = 0.3;

    fn body(mesh: TriMesh) -> Body {
        let joint = Joint {
            name: "root".to_owned(),
            parent: None,
            rest_position: Point3::origin(),
        };
        let rows = (0..mesh.num_vertices()).map(|_| [(0, 1.0)]);
        let weights = SkinWeights::from_influences(1, rows).unwrap();
        Body::new(mesh, Skeleton::new(vec![joint]).unwrap(), weights).unwrap()
    }

    #[test]
    fn skin_over_a_hole_in_a_ball_was_as_high_as_the_ball() {
        let ball = icosphere(4, RADIUS);
        let cut = 0.27;
        let is_left = |face: &&[u32; 3]| {
            let is_low = |corner: &u32| ball.positions()[*corner as usize].y < cut;
            face.iter().any(is_low)
        };
        let faces = ball.faces().iter().filter(is_left).copied().collect();
        let body = body(TriMesh::new(ball.positions().to_vec(), faces).unwrap());
        let top = Point3::new(0.0, RADIUS, 0.0);
        let side = Point3::new(RADIUS, 0.0, 0.0);
        let near = body.skin().closest_all(&[top, side]);
        let [over, beside] = bulges(&body, &near)[..] else {
            panic!("a bulge a node");
        };
        let missing = near[0].distance_squared.sqrt();
        assert!((0.02..0.04).contains(&missing), "{missing}");
        assert!(
            (0.8..1.1).contains(&(over / missing)),
            "{over} of {missing}"
        );
        assert!(beside.abs() < f32::EPSILON);
    }

    #[test]
    fn ends_of_a_tube_do_not_bulge() {
        let body = body(tube(0.05, 0.4, 16, 8));
        let near = body.skin().closest_all(&[Point3::new(0.0, 0.21, 0.0)]);
        assert!(body.skin().is_cap(near[0].face));
        assert!(bulges(&body, &near)[0].abs() < f32::EPSILON);
    }
}
