//! How far from the teacher drapes are, scene by scene, and how far the poses are from others.

use garnet_drape::{BoundGarment, Expectation, Manifest, StoredPoses};
use garnet_skin::PosedBody;

/// Poses of scenes, and how far from the teacher their drapes are.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ScenesFound {
    /// As [`garnet_skin::Body::pose_and_shape`] tells them `[scene]`.
    poses: Vec<Vec<f32>>,
    /// Mean distance of the vertices `[scene]`, in metres.
    distances: Vec<f64>,
    /// Whether each joint moves the garment.
    moves: Vec<bool>,
}

impl ScenesFound {
    pub(crate) fn add(&mut self, garment: &BoundGarment, posed: &PosedBody, distances: &[f32]) {
        let sum: f64 = distances.iter().copied().map(f64::from).sum();
        self.poses.push(garment.body().pose_and_shape(posed));
        self.distances.push(sum / distances.len().max(1) as f64);
        if self.moves.is_empty() {
            self.moves = garment.moving_joints();
        }
    }

    /// The middle of their poses; none without scenes.
    pub fn middle(&self) -> Option<StoredPoses> {
        StoredPoses::of(self.poses.iter().map(Vec::as_slice))
    }

    /// How far each scene is from the middle of some poses, and its drape from the
    /// teacher's, in metres `[scene]`. Scenes of another skeleton are left out.
    pub fn pairs(&self, poses: &StoredPoses) -> Vec<(f64, f64)> {
        let scenes = self.poses.iter().zip(&self.distances);
        let pair = |(pose, &distance): (&Vec<f32>, _)| {
            Some((poses.distance(pose, &self.moves)?, distance))
        };
        scenes.filter_map(pair).collect()
    }

    /// Has a manifest expect of a variant what was found; nothing changes for too few scenes. The
    /// poses that it goes by are those of the first variant. Where they have no spread, they are
    /// found anew, and what was expected of other variants is forgotten.
    pub fn store(&self, manifest: &mut Manifest, variant: &str) {
        let known = manifest
            .poses
            .clone()
            .filter(|poses| !poses.spread.is_empty());
        let is_known = known.is_some();
        let Some(poses) = known.or_else(|| self.middle()) else {
            return;
        };
        let expected = Expectation::fit(&self.pairs(&poses));
        if expected.is_some() && !is_known {
            manifest
                .variants
                .iter_mut()
                .for_each(|other| other.expected = None);
        }
        let variants = manifest.variants.iter_mut();
        for found in variants.filter(|found| found.name == variant) {
            found.expected = expected;
        }
        if expected.is_some() {
            manifest.poses = Some(poses);
        }
    }
}
