//! Skinning weights: which joints a vertex follows, and how much.

use std::sync::Arc;

use crate::{Skeleton, SkinError};

/// The largest number of joints that one vertex follows.
pub const MAX_INFLUENCES: usize = 8;

/// Weights below zero by no more than this are rounding and count as zero.
const NEGATIVE_ROUNDING: f32 = -1e-4;

/// Up to [`MAX_INFLUENCES`] joints and weights a vertex.
///
/// Weights of a vertex are positive, fall from one to the next, and sum to 1; equal weights are in
/// the order of the joint numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct SkinWeights {
    num_joints: usize,
    starts: Vec<usize>,
    joints: Vec<u16>,
    weights: Vec<f32>,
    /// Pairs of a joint and what it hangs on, parents before their children; roots after the first
    /// hang on that. Empty before a skeleton was told.
    bones: Arc<[[u16; 2]]>,
}

impl SkinWeights {
    /// Reads weights `[vertex][joint]`, stored row by row, `num_joints` a row.
    ///
    /// # Errors
    ///
    /// [`SkinError::WeightCount`] and those of [`SkinWeights::from_influences`].
    pub fn from_dense(num_joints: usize, weights: &[f32]) -> Result<Self, SkinError> {
        if num_joints == 0 {
            return Err(SkinError::NoJoints);
        }
        if !weights.len().is_multiple_of(num_joints) {
            return Err(SkinError::WeightCount {
                found: weights.len(),
                num_joints,
            });
        }
        let rows = weights.chunks_exact(num_joints);
        Self::from_influences(num_joints, rows.map(|row| row.iter().copied().enumerate()))
    }

    /// Reads the pairs joint number and weight of each vertex.
    ///
    /// Pairs may be in any order, zero weights may name any joint, and the weights of a joint named
    /// twice are added. If more than [`MAX_INFLUENCES`] remain, the largest are kept. The rest is
    /// scaled to sum 1.
    ///
    /// # Errors
    ///
    /// [`SkinError::NoJoints`], [`SkinError::TooManyJoints`], or for a vertex
    /// [`SkinError::NonFiniteWeight`], [`SkinError::NegativeWeight`] (below -1e-4),
    /// [`SkinError::UnknownJoint`] or [`SkinError::NoWeight`].
    pub fn from_influences<V>(
        num_joints: usize,
        vertices: impl IntoIterator<Item = V>,
    ) -> Result<Self, SkinError>
    where
        V: IntoIterator<Item = (usize, f32)>,
    {
        if num_joints == 0 {
            return Err(SkinError::NoJoints);
        }
        if num_joints > Skeleton::MAX_JOINTS {
            return Err(SkinError::TooManyJoints {
                found: num_joints,
                limit: Skeleton::MAX_JOINTS,
            });
        }
        let mut result = Self {
            num_joints,
            starts: vec![0],
            joints: Vec::new(),
            weights: Vec::new(),
            bones: Arc::default(),
        };
        let mut row = Vec::new();
        for (vertex, influences) in vertices.into_iter().enumerate() {
            row.clear();
            for (joint, weight) in influences {
                if is_used(vertex, joint, weight, num_joints)? {
                    row.push((joint, f64::from(weight)));
                }
            }
            result.push(vertex, &mut row)?;
        }
        Ok(result)
    }

    /// Appends a vertex with the positive weights `row`.
    fn push(&mut self, vertex: usize, row: &mut Vec<(usize, f64)>) -> Result<(), SkinError> {
        row.sort_by_key(|&(joint, _)| joint);
        row.dedup_by(|next, kept| {
            let is_same = next.0 == kept.0;
            kept.1 += if is_same { next.1 } else { 0.0 };
            is_same
        });
        row.sort_by(|a, b| b.1.total_cmp(&a.1));
        row.truncate(MAX_INFLUENCES);
        let sum: f64 = row.iter().map(|&(_, weight)| weight).sum();
        if sum <= 0.0 {
            return Err(SkinError::NoWeight {
                vertex,
                // The sum of nothing is -0.
                sum: sum as f32 + 0.0,
            });
        }
        for &(joint, weight) in &*row {
            self.joints.push(joint as u16);
            self.weights.push((weight / sum) as f32);
        }
        self.starts.push(self.joints.len());
        Ok(())
    }

    /// How many vertices there are.
    pub fn num_vertices(&self) -> usize {
        self.starts.len() - 1
    }

    /// How many joints the skeleton has that these weights are for.
    pub fn num_joints(&self) -> usize {
        self.num_joints
    }

    /// Joint numbers and weights of a vertex, the heaviest first.
    ///
    /// # Panics
    ///
    /// If there is no such vertex.
    pub fn vertex(&self, vertex: usize) -> impl ExactSizeIterator<Item = (usize, f32)> + '_ {
        let (joints, weights) = self.row(vertex);
        let pairs = joints.iter().zip(weights);
        pairs.map(|(&joint, &weight)| (usize::from(joint), weight))
    }

    /// The joint of the largest weight of a vertex.
    ///
    /// # Panics
    ///
    /// If there is no such vertex.
    pub fn heaviest(&self, vertex: usize) -> usize {
        usize::from(self.row(vertex).0[0])
    }

    /// Weights `[vertex][joint]`, row by row, one for every joint.
    pub fn to_dense(&self) -> Vec<f32> {
        let mut dense = vec![0.0; self.num_vertices() * self.num_joints];
        for (vertex, row) in dense.chunks_exact_mut(self.num_joints).enumerate() {
            for (joint, weight) in self.vertex(vertex) {
                row[joint] = weight;
            }
        }
        dense
    }

    /// Refuses a skeleton with another number of joints than the weights are for.
    ///
    /// # Errors
    ///
    /// [`SkinError::JointCount`].
    pub fn check_joints(&self, skeleton: &Skeleton) -> Result<(), SkinError> {
        if self.num_joints() == skeleton.num_joints() {
            return Ok(());
        }
        Err(SkinError::JointCount {
            weights: self.num_joints(),
            skeleton: skeleton.num_joints(),
        })
    }

    /// The same weights, which know how the joints hang together.
    pub(crate) fn on(mut self, skeleton: &Skeleton) -> Self {
        let order = skeleton.parents_first();
        let hung = order.iter().skip(1).map(|&joint| {
            let parent = skeleton.joints()[joint].parent.unwrap_or(order[0]);
            [joint, parent].map(|joint| joint as u16)
        });
        self.bones = hung.collect();
        self
    }

    /// The same weights on the skeleton that `other` is on.
    pub(crate) fn on_that_of(mut self, other: &Self) -> Self {
        self.bones = Arc::clone(&other.bones);
        self
    }

    /// Pairs of a joint and what it hangs on, parents before their children.
    pub(crate) fn bones(&self) -> &[[u16; 2]] {
        &self.bones
    }

    pub(crate) fn row(&self, vertex: usize) -> (&[u16], &[f32]) {
        let range = self.starts[vertex]..self.starts[vertex + 1];
        (&self.joints[range.clone()], &self.weights[range])
    }
}

/// Whether a weight counts; errors name what makes it impossible.
fn is_used(vertex: usize, joint: usize, value: f32, num_joints: usize) -> Result<bool, SkinError> {
    if !value.is_finite() {
        return Err(SkinError::NonFiniteWeight {
            vertex,
            joint,
            value,
        });
    }
    if value < NEGATIVE_ROUNDING {
        return Err(SkinError::NegativeWeight {
            vertex,
            joint,
            value,
        });
    }
    if value <= 0.0 {
        return Ok(false);
    }
    if joint >= num_joints {
        return Err(SkinError::UnknownJoint {
            vertex,
            joint,
            num_joints,
        });
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn weights_are_sorted_and_sum_to_one() {
        let weights =
            SkinWeights::from_dense(4, &[0.0, 1.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.5]).unwrap();
        assert_eq!(
            weights.vertex(0).collect::<Vec<_>>(),
            [(2, 0.75), (1, 0.25)]
        );
        assert_eq!(weights.vertex(1).collect::<Vec<_>>(), [(3, 1.0)]);
        assert_eq!(weights.heaviest(0), 2);
        assert_eq!(weights.num_vertices(), 2);
    }

    #[test]
    fn the_eight_largest_weights_are_kept() {
        let dense: Vec<f32> = (1..=10_u8).map(f32::from).collect();
        let weights = SkinWeights::from_dense(10, &dense).unwrap();
        let kept: Vec<(usize, f32)> = weights.vertex(0).collect();
        assert_eq!(kept.len(), MAX_INFLUENCES);
        assert_eq!(kept[0], (9, 10.0 / 52.0));
        assert_eq!(kept[7], (2, 3.0 / 52.0));
    }

    #[test]
    fn a_joint_named_twice_counts_once() {
        let weights =
            SkinWeights::from_influences(2, [vec![(0, 0.25), (1, 0.5), (0, 0.25)]]).unwrap();
        assert_eq!(weights.vertex(0).collect::<Vec<_>>(), [(0, 0.5), (1, 0.5)]);
    }

    #[test]
    fn impossible_weights_are_refused_with_vertex_and_value() {
        let one = |joint, weight| {
            SkinWeights::from_influences(2, [vec![(0, 1.0)], vec![(joint, weight)]]).unwrap_err()
        };
        assert_eq!(
            one(0, 0.0),
            SkinError::NoWeight {
                vertex: 1,
                sum: 0.0
            }
        );
        assert!(matches!(
            one(1, f32::NAN),
            SkinError::NonFiniteWeight {
                vertex: 1,
                joint: 1,
                ..
            }
        ));
        assert!(matches!(
            one(1, f32::INFINITY),
            SkinError::NonFiniteWeight { .. }
        ));
        assert_eq!(
            one(1, -0.1),
            SkinError::NegativeWeight {
                vertex: 1,
                joint: 1,
                value: -0.1
            }
        );
        assert_eq!(
            one(5, 0.5),
            SkinError::UnknownJoint {
                vertex: 1,
                joint: 5,
                num_joints: 2
            }
        );
        assert_eq!(
            SkinWeights::from_dense(2, &[1.0]).unwrap_err(),
            SkinError::WeightCount {
                found: 1,
                num_joints: 2
            }
        );
        assert_eq!(
            SkinWeights::from_dense(0, &[]).unwrap_err(),
            SkinError::NoJoints
        );
    }

    #[test]
    fn padding_with_zero_weight_and_negative_rounding_are_ignored() {
        let weights =
            SkinWeights::from_influences(1, [vec![(0, 1.0), (255, 0.0), (3, -1e-5)]]).unwrap();
        assert_eq!(weights.vertex(0).collect::<Vec<_>>(), [(0, 1.0)]);
    }

    proptest! {
        #[test]
        fn any_positive_weights_are_normalised_and_fall(row in prop::collection::vec(1e-3_f32..1e3, 1..20)) {
            let weights = SkinWeights::from_dense(row.len(), &row).unwrap();
            let kept: Vec<f32> = weights.vertex(0).map(|(_, weight)| weight).collect();
            let sum: f64 = kept.iter().map(|&weight| f64::from(weight)).sum();
            prop_assert!((sum - 1.0).abs() < 1e-6);
            prop_assert!(kept.is_sorted_by(|a, b| a >= b));
            prop_assert!(kept.len() <= MAX_INFLUENCES);
        }
    }
}
