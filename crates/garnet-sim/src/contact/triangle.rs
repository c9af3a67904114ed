//! The point of a triangle nearest to a point.

use crate::Vector3;
use garnet_knn::Feature;

/// A point projected onto a triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Projection {
    pub(crate) barycentric: [f32; 3],
    pub(crate) feature: Feature,
}

/// Projects the origin onto the triangle with the corners `a`, `b` and `c`.
///
/// Ericson 2005, "Real-time collision detection", section 5.1.5. A triangle without area gives one
/// of its corners or edges.
#[inline]
pub(crate) fn project_origin([a, b, c]: [Vector3; 3]) -> Projection {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (-ab.dot(&a), -ac.dot(&a));
    let (d3, d4) = (-ab.dot(&b), -ac.dot(&b));
    let (d5, d6) = (-ab.dot(&c), -ac.dot(&c));
    let at = |barycentric: [f32; 3], feature: Feature| Projection {
        barycentric,
        feature,
    };
    if d1 <= 0.0 && d2 <= 0.0 {
        return at([1.0, 0.0, 0.0], Feature::Vertex(0));
    }
    if d3 >= 0.0 && d4 <= d3 {
        return at([0.0, 1.0, 0.0], Feature::Vertex(1));
    }
    if d6 >= 0.0 && d5 <= d6 {
        return at([0.0, 0.0, 1.0], Feature::Vertex(2));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        return at([1.0 - t, t, 0.0], Feature::Edge(0));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        return at([1.0 - t, 0.0, t], Feature::Edge(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return at([0.0, 1.0 - t, t], Feature::Edge(1));
    }
    let (v, w) = (vb / (va + vb + vc), vc / (va + vb + vc));
    at([1.0 - v - w, v, w], Feature::Face)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_point_of_the_triangle_is_nearer(
            corners in prop::array::uniform3(prop::array::uniform3(-1.0_f32..1.0)),
            weights in prop::array::uniform3(0.0_f32..1.0),
        ) {
            let corners = corners.map(Vector3::from);
            let total: f32 = weights.iter().sum();
            prop_assume!(total > 0.01);
            let place = |weights: [f32; 3]| -> Vector3 {
                corners.iter().zip(weights).map(|(corner, weight)| corner * weight).sum()
            };
            let projection = project_origin(corners);
            let nearest = place(projection.barycentric).norm();
            let other = place(weights.map(|weight| weight / total)).norm();
            prop_assert!(nearest <= other + 1e-3, "{} {}", nearest, other);
        }
    }
}
