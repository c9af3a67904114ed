//! The point of one triangle nearest to a point, and a bound on the distance for four at once.
//!
//! Ericson 2005, "Real-time collision detection", section 5.1.5: the sign of a few dot products
//! tells over which corner, edge or side the point lies.

use crate::lanes::{Lanes, Lanes3, cross3, dot3, sub3};
use nalgebra::Vector3;

/// Below this square of height over length a triangle is treated as its three edges.
const NEEDLE_SQUARED: f64 = 1e-12;

/// The part of a triangle on which a closest point lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Feature {
    /// The inside of the triangle.
    Face,
    /// The inside of the edge from this corner (0, 1 or 2) to the next.
    Edge(u8),
    /// This corner (0, 1 or 2).
    Vertex(u8),
}

/// A point projected onto a triangle, in double precision.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Projection {
    pub(crate) barycentric: [f64; 3],
    /// From the closest point to the query.
    pub(crate) offset: Vector3<f64>,
    pub(crate) distance_squared: f64,
    pub(crate) feature: Feature,
}

/// Projects `p` onto a triangle, which may have no area.
#[inline]
pub(crate) fn project(p: Vector3<f64>, corners: &[Vector3<f64>; 3]) -> Projection {
    let [a, b, c] = *corners;
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (ab_ab, ac_ac, ab_ac) = (ab.dot(&ab), ac.dot(&ac), ab.dot(&ac));
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    let longest = ab_ab.max(ac_ac);
    let area_squared = ab_ab * ac_ac - ab_ac * ab_ac;
    if area_squared.is_nan() || area_squared <= NEEDLE_SQUARED * longest * longest {
        return project_on_edges(p, corners);
    }
    let (d3, d4) = (d1 - ab_ab, d2 - ab_ac);
    let (d5, d6) = (d1 - ab_ac, d2 - ac_ac);
    let at_vertex = |corner: u8| {
        let mut barycentric = [0.0; 3];
        barycentric[usize::from(corner)] = 1.0;
        (barycentric, Feature::Vertex(corner))
    };
    let vc = d1 * d4 - d3 * d2;
    let vb = d5 * d2 - d1 * d6;
    let va = d3 * d6 - d5 * d4;
    let (barycentric, feature) = if d1 <= 0.0 && d2 <= 0.0 {
        at_vertex(0)
    } else if d3 >= 0.0 && d4 <= d3 {
        at_vertex(1)
    } else if d6 >= 0.0 && d5 <= d6 {
        at_vertex(2)
    } else if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        ([1.0 - t, t, 0.0], Feature::Edge(0))
    } else if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        ([1.0 - t, 0.0, t], Feature::Edge(2))
    } else if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        ([0.0, 1.0 - t, t], Feature::Edge(1))
    } else {
        let (v, w) = (vb / (va + vb + vc), vc / (va + vb + vc));
        ([1.0 - v - w, v, w], Feature::Face)
    };
    let offset = ap - barycentric[1] * ab - barycentric[2] * ac;
    Projection {
        barycentric,
        offset,
        distance_squared: offset.norm_squared(),
        feature,
    }
}

/// Projects onto the nearest of the three edges, the first of them at equal distance.
fn project_on_edges(p: Vector3<f64>, corners: &[Vector3<f64>; 3]) -> Projection {
    let mut best = project_on_edge(p, corners, 0);
    for edge in 1..3 {
        let other = project_on_edge(p, corners, edge);
        if other.distance_squared < best.distance_squared {
            best = other;
        }
    }
    best
}

fn project_on_edge(p: Vector3<f64>, corners: &[Vector3<f64>; 3], edge: u8) -> Projection {
    let (start, end) = (usize::from(edge), usize::from((edge + 1) % 3));
    let direction = corners[end] - corners[start];
    let from_start = p - corners[start];
    let length_squared = direction.norm_squared();
    let t = if length_squared > 0.0 {
        (from_start.dot(&direction) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let feature = if t <= 0.0 {
        Feature::Vertex(edge)
    } else if t >= 1.0 {
        Feature::Vertex((edge + 1) % 3)
    } else {
        Feature::Edge(edge)
    };
    let mut barycentric = [0.0; 3];
    barycentric[start] = 1.0 - t;
    barycentric[end] += t;
    let offset = from_start - t * direction;
    Projection {
        barycentric,
        offset,
        distance_squared: offset.norm_squared(),
        feature,
    }
}

/// Square of height over length under which single precision says nothing about a triangle.
const VAGUE_NEEDLE_SQUARED: f32 = 1e-5;
/// Rounding of the squared distances below, relative to the squared lengths that enter them.
const ROUNDING: f32 = 4e-6;

/// Four squared distances, none above that of [`project`].
#[inline]
pub(crate) fn distance_squared_bound(p: Lanes3, corners: &[Lanes3; 3]) -> Lanes {
    let zero = Lanes::splat(0.0);
    let one = Lanes::splat(1.0);
    let two = Lanes::splat(2.0);
    let [a, b, c] = *corners;
    let (ab, ac, ap) = (sub3(b, a), sub3(c, a), sub3(p, a));
    let (ab_ab, ac_ac, ab_ac) = (dot3(ab, ab), dot3(ac, ac), dot3(ab, ac));
    let (d1, d2, ap_ap) = (dot3(ab, ap), dot3(ac, ap), dot3(ap, ap));
    let (d3, d4) = (d1 - ab_ab, d2 - ab_ac);
    let (d5, d6) = (d1 - ab_ac, d2 - ac_ac);
    let vc = d1 * d4 - d3 * d2;
    let vb = d5 * d2 - d1 * d6;
    let va = d3 * d6 - d5 * d4;

    // The nearest point of each edge; `max` turns the 0/0 of an edge without length into 0.
    let t = (d1 / ab_ab).max(zero).min(one);
    let to_ab = ap_ap - t * (two * d1 - t * ab_ab);
    let t = (d2 / ac_ac).max(zero).min(one);
    let to_ac = ap_ap - t * (two * d2 - t * ac_ac);
    let along = d4 - d3;
    let bc_bc = along + (d5 - d6);
    let t = (along / bc_bc).max(zero).min(one);
    let to_bc = (ap_ap - d1 - d3) - t * (two * along - t * bc_bc);
    let to_edges = to_ab.min(to_ac).min(to_bc);

    let normal = cross3(ab, ac);
    let normal_normal = dot3(normal, normal);
    let height = dot3(normal, ap);
    let to_plane = height * height / normal_normal;
    let least_weight = va.min(vb).min(vc);
    let distance = least_weight.select_greater(zero, to_plane, to_edges);

    let longest = ab_ab.max(ac_ac);
    let bound = distance - Lanes::splat(ROUNDING) * (ap_ap + longest);
    let vague = Lanes::splat(VAGUE_NEEDLE_SQUARED) * longest * longest;
    normal_normal.select_greater(vague, bound, zero)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::splat3;
    use proptest::prelude::*;

    fn corner() -> impl Strategy<Value = [f32; 3]> {
        let coarse = (-3_i8..4).prop_map(f32::from);
        prop::array::uniform3(prop_oneof![coarse, -3.0_f32..3.0, -1e-3_f32..1e-3])
    }

    proptest! {
        #[test]
        fn no_sampled_point_is_nearer_and_the_bound_holds(
            corners in prop::array::uniform3(corner()),
            point in corner(),
        ) {
            let [a, b, c] = corners.map(|corner| Vector3::from(corner.map(f64::from)));
            let p = Vector3::from(point.map(f64::from));
            let projection = project(p, &[a, b, c]);
            let [u, v, w] = projection.barycentric;
            prop_assert!(u >= -1e-12 && v >= 0.0 && w >= 0.0 && (u + v + w - 1.0).abs() < 1e-12);
            prop_assert!((p - projection.offset - (u * a + v * b + w * c)).norm() < 1e-12);
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let (s, t) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                    let sample = (1.0 - s - t) * a + s * b + t * c;
                    // A needle's inside may be nearer than its edges by 1e-6 of its length.
                    let distance = (p - sample).norm() + 1e-5;
                    prop_assert!(projection.distance_squared.sqrt() <= distance);
                }
            }
            let bound = distance_squared_bound(splat3(point), &corners.map(splat3)).0[0];
            prop_assert!(f64::from(bound) <= projection.distance_squared);
        }
    }

    #[test]
    fn each_region_names_its_feature() {
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let corners = corners.map(Vector3::from);
        let feature = |x: f64, y: f64| project(Vector3::new(x, y, 1.0), &corners).feature;
        assert_eq!(feature(0.5, 0.5), Feature::Face);
        assert_eq!(feature(1.0, -1.0), Feature::Edge(0));
        assert_eq!(feature(2.0, 2.0), Feature::Edge(1));
        assert_eq!(feature(-1.0, 1.0), Feature::Edge(2));
        assert_eq!(feature(-1.0, -1.0), Feature::Vertex(0));
        assert_eq!(feature(3.0, 0.0), Feature::Vertex(1));
        assert_eq!(feature(0.0, 3.0), Feature::Vertex(2));
    }
}
