//! Cloth that hangs free of the body: capes, tails of scarves, open coats.
//!
//! The skin nearest to it is that of the limb which happens to be there at rest, and tells nothing
//! of where the cloth goes. Such cloth takes its weights along the cloth, from where it is near the
//! skin. A skirt is far from the skin, too, but goes round the legs, which carry it along.

use garnet_knn::{ClosestPoint, Surface};
use garnet_mesh::{Point3, Topology};

/// Cloth nearer to the skin than this is not free, in metres: loose clothes are.
pub(crate) const FREE_DISTANCE: f32 = 0.04;

/// Cloth this far from the skin takes nothing from it, in metres.
const FREE_FAR: f32 = 0.06;

/// Free cloth smooths its weights over this length, in metres: longer than any garment.
const FREE_LENGTH: f32 = 10.0;

/// A patch of cloth goes round the body if more than this share of it finds cloth behind the body.
const ROUND_SHARE: f32 = 0.2;

/// Cloth behind the body is looked for no farther than this from cloth before it, in metres.
const ROUND_REACH: f32 = 1.0;

/// How free each node is `[node]`, from 0 to 1; nothing if none is. Of loose pieces none is.
///
/// `rest` and `faces` are the cloth's, `skin` is nearest to each node; lengths are `scale` times as
/// long as a person's.
pub(crate) fn freedom(
    rest: &[Point3],
    topology: &Topology,
    surface: impl FnOnce() -> Option<Surface>,
    skin: &[ClosestPoint],
    is_piece: &[bool],
    scale: f32,
) -> Vec<f32> {
    let near = scale * FREE_DISTANCE;
    let distance = |node: usize| skin[node].distance_squared.sqrt();
    let is_far: Vec<bool> = (0..rest.len())
        .map(|node| distance(node) > near && !is_piece[node])
        .collect();
    if !is_far.contains(&true) {
        return Vec::new();
    }
    let Some(surface) = surface() else {
        return Vec::new();
    };
    let is_round = |node: usize| {
        let way = skin[node].point - rest[node];
        let own = topology.vertex_faces(node);
        let reach = scale * ROUND_REACH / way.norm();
        let passages = surface.passages(rest[node], way, reach);
        // Past the skin, which is at length 1.
        passages
            .iter()
            .any(|passage| passage.length > 1.0 && !own.contains(&passage.face))
    };
    let mut freedom = vec![0.0; rest.len()];
    let mut is_seen = vec![false; rest.len()];
    let mut any = false;
    for start in 0..rest.len() {
        if !is_far[start] || is_seen[start] {
            continue;
        }
        is_seen[start] = true;
        let mut patch = vec![start];
        let mut is_attached = false;
        let mut next = 0;
        while let Some(&node) = patch.get(next) {
            next += 1;
            for &other in topology.neighbors(node) {
                let other = other as usize;
                is_attached |= !is_far[other];
                if is_far[other] && !is_seen[other] {
                    is_seen[other] = true;
                    patch.push(other);
                }
            }
        }
        let round = patch.iter().filter(|&&node| is_round(node)).count();
        if round as f32 > ROUND_SHARE * patch.len() as f32 {
            continue;
        }
        // Cloth that is near the skin nowhere hangs from where it is nearest.
        let near = if is_attached {
            near
        } else {
            let nearest = patch.iter().map(|&node| distance(node));
            nearest.fold(f32::INFINITY, f32::min)
        };
        for node in patch {
            let share = (distance(node) - near) / (scale * (FREE_FAR - FREE_DISTANCE));
            freedom[node] = share.clamp(0.0, 1.0);
            any = true;
        }
    }
    if any { freedom } else { Vec::new() }
}

/// The length over which weights are smoothed where cloth is free by `freedom`, if it is `length`
/// where it is not.
pub(crate) fn free_length(length: f64, freedom: f32) -> f64 {
    length * (f64::from(FREE_LENGTH) / length).powf(freedom.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use garnet_mesh::TriMesh;
    use garnet_mesh::primitives::{capsule, grid, tube};

    fn freedom_of(cloth: &TriMesh, skin: &Surface) -> Vec<f32> {
        let topology = Topology::new(cloth.num_vertices(), cloth.faces());
        let nearest = skin.closest_all(cloth.positions());
        let is_piece = vec![false; cloth.num_vertices()];
        let surface = || Some(Surface::new(cloth));
        freedom(
            cloth.positions(),
            &topology,
            surface,
            &nearest,
            &is_piece,
            1.0,
        )
    }

    #[test]
    fn a_sheet_that_hangs_behind_a_limb_is_free_where_it_is_far_from_it() {
        let limb = capsule(0.1, 0.8, 24, 24);
        let skin = Surface::new(&limb);
        let sheet = grid(30, 30, [0.8, 0.8]);
        let behind = |p: &Point3| Point3::new(p.x, p.z + p.y, -0.11 - 0.3 * p.x.abs());
        let cloth = sheet.positions().iter().map(behind).collect();
        let cloth = sheet.with_positions(cloth).unwrap();
        let freedom = freedom_of(&cloth, &skin);
        let nearest = skin.closest_all(cloth.positions());
        assert_eq!(freedom.len(), cloth.num_vertices());
        for (freedom, nearest) in freedom.iter().zip(&nearest) {
            let distance = nearest.distance_squared.sqrt();
            assert!(distance > FREE_DISTANCE || *freedom <= 0.0);
            assert!(distance < FREE_FAR + 1e-6 || *freedom >= 1.0);
        }
    }

    #[test]
    fn a_sheet_that_touches_nowhere_hangs_from_where_it_is_nearest() {
        let skin = Surface::new(&capsule(0.1, 0.8, 24, 24));
        let sheet = grid(30, 30, [0.8, 0.8]);
        let behind = |p: &Point3| Point3::new(p.x, p.z, -0.2 - 0.3 * (0.4 - p.z));
        let cloth = sheet.positions().iter().map(behind).collect();
        let cloth = sheet.with_positions(cloth).unwrap();
        let freedom = freedom_of(&cloth, &skin);
        let nearest = skin.closest_all(cloth.positions());
        let least = |all: &[ClosestPoint]| {
            let all = all.iter().map(|near| near.distance_squared.sqrt());
            all.fold(f32::INFINITY, f32::min)
        };
        let near = least(&nearest);
        assert!(near > FREE_FAR, "{near}");
        for (freedom, nearest) in freedom.iter().zip(&nearest) {
            let farther = nearest.distance_squared.sqrt() - near;
            let expected = (farther / (FREE_FAR - FREE_DISTANCE)).clamp(0.0, 1.0);
            assert!((freedom - expected).abs() < 1e-4);
        }
        assert!(freedom.contains(&0.0) && freedom.contains(&1.0));
    }

    #[test]
    fn a_wide_skirt_round_a_limb_is_not() {
        let skin = Surface::new(&capsule(0.1, 0.8, 24, 24));
        assert!(freedom_of(&tube(0.25, 0.5, 32, 24), &skin).is_empty());
        assert!(freedom_of(&tube(0.12, 0.5, 32, 24), &skin).is_empty());
    }

    #[test]
    fn lengths_grow_from_those_of_cloth_near_the_skin() {
        assert!((free_length(0.2, 0.0) - 0.2).abs() < 1e-12);
        assert!((free_length(0.2, 1.0) - f64::from(FREE_LENGTH)).abs() < 1e-6);
    }
}
