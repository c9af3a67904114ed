//! Skinning: moving vertices with the joints that they follow.

use nalgebra::{Isometry3, Matrix3, Vector3 as NaVector3};
use rayon::prelude::*;

use crate::{DualQuaternion, Point3, SkinWeights};

/// How the transforms of several joints are blended at a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// Dual-quaternion skinning (Kavan et al. 2007): every vertex moves rigidly, so limbs keep
    /// their volume where they twist.
    #[default]
    DualQuaternion,
    /// Linear blend skinning: the weighted mean of where the joints would put the vertex.
    Linear,
}

/// Vertices that one task moves. Results do not depend on it, nor on the number of threads.
const CHUNK: usize = 1024;

/// Moves `positions` `[vertex]` by the blended rigid transforms of their joints (Kavan et al. 2008,
/// Algorithm 1).
///
/// `posed_from_rest` has one rigid transform a joint. Weights of a [`Body`](crate::Body), and of
/// what is bound to one, blend each joint the short way from its parent: two thighs may be turned
/// by more than 180 degrees against each other, as long as neither is against the pelvis. Of other
/// weights the sign of every quaternion is fixed against the heaviest joint of the vertex; see
/// [`DualQuaternion::blend`]. Where the short way changes sides, the vertex does, too.
///
/// # Panics
///
/// If there is another number of positions than vertices in `weights`, or another number of
/// transforms than joints.
pub fn skin_dual_quaternion(
    positions: &[Point3],
    weights: &SkinWeights,
    posed_from_rest: &[Isometry3<f32>],
) -> Vec<Point3> {
    check_counts(positions.len(), weights, posed_from_rest);
    let joints = Joints::new(weights, posed_from_rest);
    map_vertices(positions.len(), Point3::origin(), |vertex| {
        joints
            .blended(weights, vertex)
            .transform_point(&positions[vertex])
    })
}

/// Moves `positions` `[vertex]` to `Σ_j w_j T_j x` (linear blend skinning).
///
/// `posed_from_rest` has one rigid transform a joint.
///
/// # Panics
///
/// If there is another number of positions than vertices in `weights`, or another number of
/// transforms than joints.
pub fn skin_linear(
    positions: &[Point3],
    weights: &SkinWeights,
    posed_from_rest: &[Isometry3<f32>],
) -> Vec<Point3> {
    check_counts(positions.len(), weights, posed_from_rest);
    let joints: Vec<(Matrix3<f32>, NaVector3<f32>)> = posed_from_rest
        .iter()
        .map(|transform| {
            let rotation = transform.rotation.cast::<f64>().to_rotation_matrix();
            (rotation.into_inner().cast(), transform.translation.vector)
        })
        .collect();
    map_vertices(positions.len(), Point3::origin(), |vertex| {
        let mut moved = NaVector3::zeros();
        for (joint, weight) in weights.vertex(vertex) {
            let (rotation, translation) = &joints[joint];
            moved += (rotation * positions[vertex].coords + translation) * weight;
        }
        Point3::from(moved)
    })
}

/// The rigid transform by which dual-quaternion skinning moves each vertex, `[vertex]`.
///
/// Its inverse un-poses the vertex; its rotation carries directions.
///
/// # Panics
///
/// If there is another number of transforms than joints in `weights`.
pub fn blended_transforms(
    weights: &SkinWeights,
    posed_from_rest: &[Isometry3<f32>],
) -> Vec<Isometry3<f32>> {
    check_counts(weights.num_vertices(), weights, posed_from_rest);
    let joints = Joints::new(weights, posed_from_rest);
    map_vertices(weights.num_vertices(), Isometry3::identity(), |vertex| {
        joints.blended(weights, vertex).to_isometry()
    })
}

/// The transforms of the joints.
struct Joints {
    duals: Vec<DualQuaternion>,
    /// 1, or -1 where the quaternion of a joint is on the other side of that of its parent; empty
    /// if it is not known how joints hang together.
    signs: Vec<f32>,
}

impl Joints {
    fn new(weights: &SkinWeights, transforms: &[Isometry3<f32>]) -> Self {
        let duals = transforms.iter().map(DualQuaternion::from_isometry);
        let duals: Vec<DualQuaternion> = duals.collect();
        let bones = weights.bones();
        let mut signs = Vec::new();
        if !bones.is_empty() {
            signs.resize(duals.len(), 1.0);
        }
        for pair in bones {
            let [joint, parent] = pair.map(usize::from);
            let is_opposite = duals[parent].real.dot(&duals[joint].real) < 0.0;
            signs[joint] = if is_opposite {
                -signs[parent]
            } else {
                signs[parent]
            };
        }
        Self { duals, signs }
    }

    /// The transform of a vertex, with the sign of its heaviest joint.
    fn blended(&self, weights: &SkinWeights, vertex: usize) -> DualQuaternion {
        let (numbers, shares) = weights.row(vertex);
        let heaviest = usize::from(numbers[0]);
        let pivot = self.duals[heaviest];
        if numbers.len() == 1 {
            return pivot;
        }
        let parts = numbers.iter().zip(shares);
        let parts = parts.map(|(&joint, &share)| (usize::from(joint), share));
        if self.signs.is_empty() {
            let parts = parts.map(|(joint, share)| (self.duals[joint], share));
            return DualQuaternion::blend_about(pivot, parts);
        }
        let side = self.signs[heaviest];
        let signed =
            parts.map(|(joint, share)| (self.duals[joint], side * self.signs[joint] * share));
        DualQuaternion::blend_signed(pivot, signed)
    }
}

/// Evaluates a function of the vertex number for all vertices.
fn map_vertices<T: Send + Copy>(
    num_vertices: usize,
    blank: T,
    of_vertex: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let mut values = vec![blank; num_vertices];
    let chunks = values.par_chunks_mut(CHUNK).enumerate();
    chunks.for_each(|(chunk, values)| {
        for (offset, value) in values.iter_mut().enumerate() {
            *value = of_vertex(chunk * CHUNK + offset);
        }
    });
    values
}

fn check_counts(num_positions: usize, weights: &SkinWeights, transforms: &[Isometry3<f32>]) {
    assert_eq!(
        num_positions,
        weights.num_vertices(),
        "one weight row a vertex"
    );
    assert_eq!(
        transforms.len(),
        weights.num_joints(),
        "one transform a joint"
    );
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::Vector3;

    const ROUNDING: f32 = 1e-5;

    fn transform(shift: [f32; 3], angle: [f32; 3]) -> Isometry3<f32> {
        Isometry3::new(Vector3::from(shift), Vector3::from(angle))
    }

    fn twisted(share: f32, degrees: f32) -> [Point3; 2] {
        let weights =
            SkinWeights::from_influences(2, [vec![(0, 1.0 - share), (1, share)]]).unwrap();
        let joints = [
            Isometry3::identity(),
            transform([0.0; 3], [0.0, degrees.to_radians(), 0.0]),
        ];
        let point = [Point3::new(0.1, 0.0, 0.0)];
        [
            skin_dual_quaternion(&point, &weights, &joints)[0],
            skin_linear(&point, &weights, &joints)[0],
        ]
    }

    fn any_transform() -> impl Strategy<Value = Isometry3<f32>> {
        let three = |limit: f32| prop::array::uniform3(-limit..limit);
        (three(2.0), three(1.4)).prop_map(|(shift, angle)| transform(shift, angle))
    }

    fn any_weights(num_joints: usize) -> impl Strategy<Value = SkinWeights> {
        let row = prop::collection::vec(1e-2_f32..1.0, num_joints);
        prop::collection::vec(row, 3)
            .prop_map(move |rows| SkinWeights::from_dense(num_joints, &rows.concat()).unwrap())
    }

    fn points() -> [Point3; 3] {
        [
            Point3::new(0.3, 1.0, -0.2),
            Point3::new(-0.5, 0.1, 0.4),
            Point3::new(0.0, 1.7, 0.0),
        ]
    }

    proptest! {
        #[test]
        fn one_joint_moves_its_vertices_rigidly(joint in any_transform()) {
            let weights = SkinWeights::from_dense(1, &[1.0; 3]).unwrap();
            for method in [skin_dual_quaternion, skin_linear] {
                for (moved, point) in method(&points(), &weights, &[joint]).iter().zip(points()) {
                    prop_assert!((moved - joint * point).norm() < ROUNDING);
                }
            }
        }

        #[test]
        fn joints_with_the_same_transform_move_rigidly(joint in any_transform(), weights in any_weights(4)) {
            for (moved, point) in skin_dual_quaternion(&points(), &weights, &[joint; 4]).iter().zip(points()) {
                prop_assert!((moved - joint * point).norm() < ROUNDING);
            }
        }

        #[test]
        fn pure_translations_equal_linear_skinning(shifts in prop::collection::vec(prop::array::uniform3(-3.0_f32..3.0), 5), weights in any_weights(5)) {
            let joints: Vec<_> = shifts.into_iter().map(|shift| transform(shift, [0.0; 3])).collect();
            let dual = skin_dual_quaternion(&points(), &weights, &joints);
            for (a, b) in dual.iter().zip(skin_linear(&points(), &weights, &joints)) {
                prop_assert!((a - b).norm() < ROUNDING);
            }
        }

        #[test]
        fn a_global_rigid_motion_commutes(global in any_transform(), joints in prop::collection::vec(any_transform(), 3), weights in any_weights(3)) {
            let moved_joints: Vec<_> = joints.iter().map(|joint| global * joint).collect();
            let first = skin_dual_quaternion(&points(), &weights, &joints);
            let then = skin_dual_quaternion(&points(), &weights, &moved_joints);
            // Near 180 degrees between two joints the short way may change with rounding.
            let is_clear = |a: &Isometry3<f32>, b: &Isometry3<f32>| a.rotation.coords.dot(&b.rotation.coords).abs() > 1e-3;
            prop_assume!(joints.iter().all(|a| joints.iter().all(|b| is_clear(a, b))));
            for (a, b) in first.iter().zip(&then) {
                prop_assert!((global * a - b).norm() < 1e-4);
            }
        }

        #[test]
        fn blended_transforms_move_the_vertices_as_skinning_does(joints in prop::collection::vec(any_transform(), 3), weights in any_weights(3)) {
            let transforms = blended_transforms(&weights, &joints);
            for ((moved, transform), point) in skin_dual_quaternion(&points(), &weights, &joints).iter().zip(transforms).zip(points()) {
                prop_assert!((moved - transform * point).norm() < ROUNDING);
                prop_assert!((transform.inverse() * moved - point).norm() < ROUNDING);
            }
        }
    }

    #[test]
    fn a_half_twist_keeps_the_radius_where_linear_skinning_collapses() {
        let [dual, linear] = twisted(0.5, 180.0);
        approx::assert_relative_eq!(dual.coords.norm(), 0.1, epsilon = 1e-6);
        assert!(linear.coords.norm() < 1e-6);
    }

    #[test]
    fn a_twist_through_180_degrees_jumps_once_and_stays_on_the_radius() {
        for share in [0.3, 0.5, 0.7] {
            let mut jumps = 0;
            let mut previous = twisted(share, 170.0)[0];
            for step in 1..=200 {
                let next = twisted(share, 170.0 + 0.1 * step as f32)[0];
                approx::assert_relative_eq!(next.coords.norm(), 0.1, epsilon = 1e-6);
                // A tenth of a degree turns no vertex by more than half a degree off the side
                // change.
                if (next - previous).norm() > 0.1 * 0.5_f32.to_radians() {
                    jumps += 1;
                }
                previous = next;
            }
            assert!(jumps <= 1, "{jumps} jumps at share {share}");
        }
    }

    /// A pelvis, and thighs turned by an angle, in radians, to one side and to the other.
    fn straddle(angle: f32) -> [Isometry3<f32>; 3] {
        [0.0, angle, -angle].map(|turn| transform([0.0; 3], [turn, 0.0, 0.0]))
    }

    fn on_straddle(weights: SkinWeights) -> SkinWeights {
        let joint = |parent| crate::Joint {
            name: format!("on {parent:?}"),
            parent,
            rest_position: Point3::origin(),
        };
        let joints = [None, Some(0), Some(0)].map(joint);
        weights.on(&crate::Skeleton::new(joints.to_vec()).unwrap())
    }

    #[test]
    fn limbs_that_turn_by_more_than_180_degrees_against_each_other_go_through_their_parent() {
        let rows = [
            vec![(1, 0.36), (2, 0.35), (0, 0.29)],
            vec![(1, 0.5), (2, 0.5)],
            vec![(0, 0.4), (2, 0.6)],
        ];
        let weights = on_straddle(SkinWeights::from_influences(3, rows).unwrap());
        let mut last = skin_dual_quaternion(&points(), &weights, &straddle(1.0));
        for step in 1..=600 {
            // Each thigh to 126 degrees, which is 252 between them.
            let angle = 1.0 + 0.002 * step as f32;
            let next = skin_dual_quaternion(&points(), &weights, &straddle(angle));
            for ((before, after), place) in last.iter().zip(&next).zip(points()) {
                let most = 0.01 * place.coords.norm();
                assert!((after - before).norm() < most, "{angle}: {before} {after}");
            }
            last = next;
        }
    }

    proptest! {
        #[test]
        fn the_skeleton_does_not_matter_where_all_joints_are_near_each_other(
            angles in prop::array::uniform3(prop::array::uniform3(-0.8_f32..0.8)),
            signs in prop::array::uniform3(prop::bool::ANY),
            weights in any_weights(3),
        ) {
            let mut joints = angles.map(|angle| transform([0.3, -0.2, 0.9], angle));
            for (joint, is_turned) in joints.iter_mut().zip(signs) {
                if is_turned {
                    *joint.rotation.as_mut_unchecked() = -joint.rotation.into_inner();
                }
            }
            let on = on_straddle(weights.clone());
            prop_assert_eq!(
                skin_dual_quaternion(&points(), &on, &joints),
                skin_dual_quaternion(&points(), &weights, &joints)
            );
            prop_assert_eq!(blended_transforms(&on, &joints), blended_transforms(&weights, &joints));
        }
    }

    #[test]
    fn results_are_the_same_with_any_number_of_threads() {
        let positions: Vec<Point3> = (0..5000)
            .map(|i| Point3::new(i as f32 * 1e-3, (i % 7) as f32, 0.5))
            .collect();
        let weights =
            SkinWeights::from_influences(2, (0..5000).map(|i| [(0, 1.0 + i as f32), (1, 2500.0)]))
                .unwrap();
        let joints = [
            transform([0.1, 0.0, 0.0], [0.5, 0.0, 1.0]),
            transform([0.0; 3], [0.0, 1.0, 0.0]),
        ];
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| skin_dual_quaternion(&positions, &weights, &joints))
        };
        assert_eq!(on(1), on(3));
    }
}
