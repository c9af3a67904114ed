//! What the file tests have in common.

use std::error::Error;

use garnet_mesh::TriMesh;
use garnet_skin::{Joint, Point3, Rig, Skeleton, SkinWeights};

/// A strip of eight vertices on two joints.
pub(crate) fn strip() -> Rig {
    let positions = (0..8).map(|i| Point3::new((i % 2) as f32 * 0.1, (i / 2) as f32 * 0.25, 0.0));
    let faces = (0..3).flat_map(|i| {
        [
            [2 * i, 2 * i + 1, 2 * i + 2],
            [2 * i + 1, 2 * i + 3, 2 * i + 2],
        ]
    });
    let joint = |name: &str, parent, y| Joint {
        name: name.to_owned(),
        parent,
        rest_position: Point3::new(0.05, y, 0.0),
    };
    let shares = [0.0_f32, 0.0, 0.25, 0.25, 0.75, 0.75, 1.0, 1.0];
    Rig {
        rest: Some(TriMesh::new(positions.collect(), faces.collect()).unwrap()),
        skeleton: Skeleton::new(vec![joint("hip", None, 0.0), joint("knee", Some(0), 0.4)])
            .unwrap(),
        weights: SkinWeights::from_influences(
            2,
            shares.map(|share| [(0, 1.0 - share), (1, share)]),
        )
        .unwrap(),
        rest_pose: None,
    }
}

/// An error and its causes in one line.
pub(crate) fn chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(next) = cause {
        text = format!("{text}: {next}");
        cause = next.source();
    }
    text
}
