//! How far a prediction is from the reference, and how far cloth is stretched.

use crate::normals::{area_vector, per_face};
use crate::{MeshError, Point3};

/// Edges shorter than this at rest, in metres, have no stretch.
const MIN_REST_LENGTH: f64 = 1e-6;

/// Mean and standard deviation of a measure over a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spread {
    /// The mean; 0 of nothing.
    pub mean: f64,
    /// The standard deviation (of the whole, not estimated from a sample).
    pub std: f64,
    /// Over how many values.
    pub count: usize,
}

impl Spread {
    /// The spread of values, summed in their order.
    pub fn of(values: &[f32]) -> Self {
        let count = values.len();
        let divisor = count.max(1) as f64;
        let mean = values.iter().map(|&value| f64::from(value)).sum::<f64>() / divisor;
        let squares = values
            .iter()
            .map(|&value| (f64::from(value) - mean).powi(2));
        Self {
            mean,
            std: (squares.sum::<f64>() / divisor).sqrt(),
            count,
        }
    }
}

/// Distances `[vertex]` between a reference and a prediction, in metres.
///
/// # Errors
///
/// [`MeshError::PositionCount`].
pub fn vertex_distances(reference: &[Point3], predicted: &[Point3]) -> Result<Vec<f32>, MeshError> {
    check_counts(reference, predicted)?;
    let pairs = reference.iter().zip(predicted);
    let distance = |(a, b): (&Point3, &Point3)| (a.cast::<f64>() - b.cast()).norm() as f32;
    Ok(pairs.map(distance).collect())
}

/// `E_dist`: mean and standard deviation of the vertex distances, in metres.
///
/// ```text
/// E_dist = 1/N Σ ‖G_i^G − G_i^P‖
/// ```
///
/// Source: *Gundogdu et al. 2020, Eq. 17* (printed there in centimetres).
///
/// # Errors
///
/// [`MeshError::PositionCount`].
pub fn distance_error(reference: &[Point3], predicted: &[Point3]) -> Result<Spread, MeshError> {
    Ok(Spread::of(&vertex_distances(reference, predicted)?))
}

/// Angles between the face normals of a reference and of a prediction, in radians.
///
/// Faces without area in the reference are left out. A face without area in the prediction alone
/// counts as π/2, the mean over all directions: collapsing faces is no way to a better score.
///
/// # Errors
///
/// [`MeshError::PositionCount`], or [`MeshError::FaceIndexOutOfRange`] if a face names a missing
/// position.
pub fn normal_angles(
    faces: &[[u32; 3]],
    reference: &[Point3],
    predicted: &[Point3],
) -> Result<Vec<f32>, MeshError> {
    check_counts(reference, predicted)?;
    for (face, corners) in faces.iter().enumerate() {
        check_indices(face, corners, reference.len())?;
    }
    let angles = per_face(faces, |corners| {
        let (expected, found) = (
            area_vector(reference, corners),
            area_vector(predicted, corners),
        );
        match (expected.norm() > 0.0, found.norm() > 0.0) {
            (false, _) => None,
            (true, false) => Some(std::f32::consts::FRAC_PI_2),
            (true, true) => {
                let (expected, found) = (expected.normalize(), found.normalize());
                // Exact for small angles, where the arc cosine loses half of the digits.
                Some(expected.cross(&found).norm().atan2(expected.dot(&found)) as f32)
            }
        }
    });
    Ok(angles.into_iter().flatten().collect())
}

/// `E_norm`: mean and standard deviation of the angles between face normals, in radians.
///
/// ```text
/// E_norm = 1/N_F Σ arccos(F_i^G · F_i^P / (‖F_i^G‖ ‖F_i^P‖))
/// ```
///
/// Faces without area: see [`normal_angles`].
///
/// Source: *Gundogdu et al. 2020, Eq. 18* (printed there in degrees).
///
/// # Errors
///
/// [`MeshError::PositionCount`] or [`MeshError::FaceIndexOutOfRange`].
pub fn normal_error(
    faces: &[[u32; 3]],
    reference: &[Point3],
    predicted: &[Point3],
) -> Result<Spread, MeshError> {
    Ok(Spread::of(&normal_angles(faces, reference, predicted)?))
}

/// The share of values below a threshold, from 0 to 1: a point of an average precision curve.
///
/// 0 of nothing.
///
/// Source: *Gundogdu et al. 2020, Fig. 9*.
pub fn share_below(values: &[f32], threshold: f32) -> f64 {
    let num_below = values.iter().filter(|&&value| value < threshold).count();
    num_below as f64 / values.len().max(1) as f64
}

/// Length over rest length of the edges of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct StretchSummary {
    /// The smallest.
    pub min: f32,
    /// Half of the edges have less.
    pub p50: f32,
    /// 99 of 100 edges have less.
    pub p99: f32,
    /// The largest.
    pub max: f32,
    /// The mean.
    pub mean: f64,
    /// How many edges were measured.
    pub count: usize,
}

/// Length over rest length of each edge that is at least a micrometre long at rest.
///
/// # Errors
///
/// [`MeshError::PositionCount`], or [`MeshError::FaceIndexOutOfRange`] with the number of the edge
/// if one names a missing position.
pub fn edge_stretches(
    rest: &[Point3],
    posed: &[Point3],
    edges: &[[u32; 2]],
) -> Result<Vec<f32>, MeshError> {
    check_counts(rest, posed)?;
    stretches(posed, edges, |edge| length(rest, edges[edge]))
}

/// The ends of an edge and its rest length, in metres.
pub type RestEdge = ([u32; 2], f32);

/// The same of edges with rest lengths of their own: those of a sewing pattern, say.
///
/// # Errors
///
/// [`MeshError::FaceIndexOutOfRange`] with the number of the edge if one names a missing position.
pub fn pattern_stretches(posed: &[Point3], edges: &[RestEdge]) -> Result<Vec<f32>, MeshError> {
    let vertices: Vec<[u32; 2]> = edges.iter().map(|&(vertices, _)| vertices).collect();
    stretches(posed, &vertices, |edge| f64::from(edges[edge].1))
}

fn stretches(
    posed: &[Point3],
    edges: &[[u32; 2]],
    rest_length: impl Fn(usize) -> f64,
) -> Result<Vec<f32>, MeshError> {
    let mut stretches = Vec::with_capacity(edges.len());
    for (edge, &vertices) in edges.iter().enumerate() {
        check_indices(edge, &vertices, posed.len())?;
        let rest_length = rest_length(edge);
        if rest_length >= MIN_REST_LENGTH {
            stretches.push((length(posed, vertices) / rest_length) as f32);
        }
    }
    Ok(stretches)
}

fn length(positions: &[Point3], edge: [u32; 2]) -> f64 {
    let [a, b] = edge.map(|vertex| positions[vertex as usize].cast::<f64>());
    (b - a).norm()
}

/// Sums up [`edge_stretches`]; all zero if no edge could be measured.
///
/// # Errors
///
/// As [`edge_stretches`].
pub fn edge_stretch(
    rest: &[Point3],
    posed: &[Point3],
    edges: &[[u32; 2]],
) -> Result<StretchSummary, MeshError> {
    Ok(StretchSummary::of(edge_stretches(rest, posed, edges)?))
}

impl StretchSummary {
    /// The summary of some stretches; all zero if there are none.
    pub fn of(mut stretches: Vec<f32>) -> Self {
        stretches.sort_unstable_by(f32::total_cmp);
        let [min, .., max] = stretches[..] else {
            let only = stretches.first().copied().unwrap_or_default();
            return Self {
                min: only,
                p50: only,
                p99: only,
                max: only,
                mean: f64::from(only),
                count: stretches.len(),
            };
        };
        let last = stretches.len() - 1;
        let percentile = |percent: usize| stretches[(last * percent).div_ceil(100)];
        Self {
            min,
            p50: percentile(50),
            p99: percentile(99),
            max,
            mean: Spread::of(&stretches).mean,
            count: stretches.len(),
        }
    }
}

fn check_counts(reference: &[Point3], predicted: &[Point3]) -> Result<(), MeshError> {
    if reference.len() != predicted.len() {
        return Err(MeshError::PositionCount {
            found: predicted.len(),
            expected: reference.len(),
        });
    }
    Ok(())
}

fn check_indices(face: usize, vertices: &[u32], num_vertices: usize) -> Result<(), MeshError> {
    match vertices
        .iter()
        .find(|&&index| index as usize >= num_vertices)
    {
        Some(&index) => Err(MeshError::FaceIndexOutOfRange {
            face,
            index,
            num_vertices,
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::primitives::icosphere;
    use crate::{Topology, Vector3};

    /// Bound on closed forms in `f32`.
    const ROUNDING: f64 = 1e-5;

    #[test]
    fn a_shift_is_its_length_and_turns_nothing() {
        let mesh = icosphere(1, 1.0);
        let shift = Vector3::new(0.03, 0.0, 0.04);
        let moved: Vec<Point3> = mesh.positions().iter().map(|p| p + shift).collect();
        let distance = distance_error(mesh.positions(), &moved).unwrap();
        approx::assert_relative_eq!(distance.mean, 0.05, max_relative = ROUNDING);
        approx::assert_abs_diff_eq!(distance.std, 0.0, epsilon = 1e-6);
        let normal = normal_error(mesh.faces(), mesh.positions(), &moved).unwrap();
        approx::assert_abs_diff_eq!(normal.mean, 0.0, epsilon = 1e-5);
        assert_eq!(normal.count, mesh.num_faces());
    }

    #[test]
    fn the_spread_of_two_values_is_half_their_difference() {
        let spread = Spread::of(&[1.0, 3.0]);
        let expected = Spread {
            mean: 2.0,
            std: 1.0,
            count: 2,
        };
        assert_eq!(spread, expected);
    }

    #[test]
    fn faces_without_area_count_only_against_the_prediction() {
        let whole = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
        let collapsed = [Point3::origin(); 3];
        let faces = [[0, 1, 2]];
        let angles = normal_angles(&faces, &whole, &collapsed).unwrap();
        assert_eq!(angles, [std::f32::consts::FRAC_PI_2]);
        assert!(
            normal_angles(&faces, &collapsed, &whole)
                .unwrap()
                .is_empty()
        );
    }

    #[test]
    fn meshes_that_do_not_fit_are_refused() {
        let (two, three) = ([Point3::origin(); 2], [Point3::origin(); 3]);
        assert!(distance_error(&two, &three).is_err());
        assert!(normal_error(&[[0, 1, 2]], &two, &two).is_err());
        assert!(edge_stretch(&two, &two, &[[0, 2]]).is_err());
    }

    #[test]
    fn the_share_below_is_strict() {
        assert_eq!(
            share_below(&[1.0, 2.0, 3.0, 4.0], 3.0).to_bits(),
            0.5_f64.to_bits()
        );
    }

    #[test]
    fn edges_without_length_are_left_out() {
        let rest = [0.0, 0.0, 1.0].map(|x| Point3::new(x, 0.0, 0.0));
        let posed = [0.0, 1.0, 3.0].map(|x| Point3::new(x, 0.0, 0.0));
        let stretch = edge_stretch(&rest, &posed, &[[0, 1], [1, 2]]).unwrap();
        assert_eq!((stretch.count, stretch.max.to_bits()), (1, 2_f32.to_bits()));
        assert_eq!(
            edge_stretch(&rest, &posed, &[]).unwrap(),
            StretchSummary::default()
        );
    }

    proptest! {
        #[test]
        fn a_turn_is_its_angle_on_normals_across_the_axis(angle in 0.0_f32..3.1) {
            let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), angle);
            let reference = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
            let turned = reference.map(|p| turn * p);
            let error = normal_error(&[[0, 1, 2]], &reference, &turned).unwrap();
            approx::assert_abs_diff_eq!(error.mean, f64::from(angle), epsilon = 1e-5);
        }

        #[test]
        fn scaling_stretches_every_edge_alike(scale in 0.01_f32..100.0) {
            let mesh = icosphere(1, 1.0);
            let topology = Topology::new(mesh.num_vertices(), mesh.faces());
            let scaled: Vec<Point3> = mesh.positions().iter().map(|p| p * scale).collect();
            let stretch = edge_stretch(mesh.positions(), &scaled, topology.edges()).unwrap();
            for value in [stretch.min, stretch.p50, stretch.p99, stretch.max] {
                approx::assert_relative_eq!(value, scale, max_relative = ROUNDING as f32);
            }
        }
    }
}
