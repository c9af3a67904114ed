//! Scenes as a mirror shows them: as many again to learn from.

use std::sync::{Arc, OnceLock};

use garnet_mesh::{Point3, Vector3};
use garnet_net::pose_space::{Exchange, Image};
use garnet_skin::{Symmetry, WarpedGarment};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

use crate::Stage;
use crate::context::Example;
use crate::pose_space::{GarmentMirror, images_on};

/// How left and right of garment and body are exchanged.
#[derive(Debug)]
pub(crate) struct SceneMirror {
    garment: Vec<Image>,
    body: Vec<Image>,
    numbers: Exchange,
}

impl SceneMirror {
    /// Of a package; none if left and right of its garment or body differ.
    pub(crate) fn of(stage: &Stage) -> Option<Self> {
        let garment = GarmentMirror::of(stage)?;
        let body = &stage.template().body;
        Some(Self {
            garment: garment.images().to_vec(),
            body: images_on(body.rest(), &body.skeleton().symmetry()?)?,
            numbers: garment.numbers().clone(),
        })
    }

    /// The mirror image of a scene, in the plane x = 0 of the world.
    ///
    /// Places, and the frames that they are seen in, are mirrored alike.
    pub(crate) fn mirrored(&self, example: &Example) -> Example {
        let Example { warped, .. } = example;
        let turns: Vec<Quaternion<f32>> = warped
            .rotations
            .iter()
            .map(|turn| *turn.quaternion())
            .collect();
        let turn = |image: &Image| {
            let (corners, weights) = image;
            let first = turns[corners[0] as usize];
            let sum = corners.iter().zip(weights).fold(
                Quaternion::from_parts(0.0, Vector3::zeros()),
                |sum, (&corner, &weight)| {
                    let turn = turns[corner as usize];
                    // Of the two that are the same turn, that near to the first.
                    let sign = if turn.dot(&first) < 0.0 { -1.0 } else { 1.0 };
                    sum + turn * (sign * weight)
                },
            );
            mirrored_turn(&UnitQuaternion::from_quaternion(sum))
        };
        let Isometry3 {
            rotation,
            translation,
        } = &warped.world_from_root;
        let neighbors = OnceLock::new();
        if let Some(known) = example.mirrored_neighbors.get() {
            neighbors.get_or_init(|| known.clone());
        }
        let normals = &example.body_normals;
        let normal = |image: &Image| {
            let (corners, weights) = image;
            let corners = corners.iter().zip(weights);
            let sum = corners.fold(Vector3::zeros(), |sum, (&corner, &weight)| {
                sum + normals[corner as usize] * weight
            });
            Symmetry::vector(sum).normalize()
        };
        Example {
            scene: example.scene,
            sequence: example.sequence.clone(),
            rest: Arc::clone(&example.rest),
            graph: example.graph.clone(),
            warped: WarpedGarment {
                positions: places(&self.garment, &warped.positions),
                rotations: self.garment.iter().map(turn).collect(),
                world_from_root: Isometry3::from_parts(
                    Translation3::from(Symmetry::vector(translation.vector)),
                    mirrored_turn(rotation),
                ),
            },
            body: places(&self.body, &example.body),
            body_normals: if normals.is_empty() {
                Vec::new()
            } else {
                self.body.iter().map(normal).collect()
            },
            parameters: self.numbers.of(&example.parameters),
            draped: places(&self.garment, &example.draped),
            neighbors,
            mirrored_neighbors: OnceLock::new(),
        }
    }
}

/// Where a mirror shows the images of vertices.
fn places(images: &[Image], points: &[Point3]) -> Vec<Point3> {
    let place = |(corners, weights): &Image| {
        let corners = corners.iter().zip(weights);
        let sum = corners.fold(Vector3::zeros(), |sum, (&corner, &weight)| {
            sum + points[corner as usize].coords * weight
        });
        Point3::from(Symmetry::vector(sum))
    };
    images.iter().map(place).collect()
}

/// M R M, with M = diag(−1, 1, 1).
fn mirrored_turn(turn: &UnitQuaternion<f32>) -> UnitQuaternion<f32> {
    let Quaternion { coords } = turn.quaternion();
    UnitQuaternion::new_unchecked(Quaternion::new(coords.w, coords.x, -coords.y, -coords.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_mirrored_as_vectors_are() {
        let turn = UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1);
        let vector = Vector3::new(0.2, -0.5, 0.9);
        let expected = Symmetry::vector(turn * Symmetry::vector(vector));
        assert!((mirrored_turn(&turn) * vector - expected).norm() < 1e-6);
    }

    #[test]
    fn a_place_between_corners_is_mirrored_between_them() {
        let points = [[1.0, 0.0, 0.0], [3.0, 2.0, 0.0], [0.0, 0.0, 4.0]].map(Point3::from);
        let found = places(&[([0, 1, 2], [0.5, 0.25, 0.25])], &points);
        assert!((found[0] - Point3::new(-1.25, 0.5, 1.0)).norm() < 1e-6);
    }
}
