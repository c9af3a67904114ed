//! Triangles as they lie on the picture.

use nalgebra::Vector3;

use crate::lens::Lens;

/// A triangle on the picture: a triangle of a mesh, or what is left of it before the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Piece {
    /// Column, row and nearness of the three corners.
    pub(crate) corners: [[f64; 3]; 3],
    /// The number of the triangle of which this is a piece.
    pub(crate) triangle: u32,
}

/// Projects a triangle and hands on the one or two pieces that lie behind the near plane.
pub(crate) fn project(
    lens: &Lens,
    corners: &[Vector3<f64>; 3],
    triangle: u32,
    mut push: impl FnMut(Piece),
) {
    let mut whole = |corners: [Vector3<f64>; 3]| {
        push(Piece {
            corners: corners.map(|corner| lens.screen(&corner)),
            triangle,
        });
    };
    let near = match lens.near() {
        Some(near) if corners.iter().any(|corner| corner.z > near) => near,
        _ => return whole(*corners),
    };
    let mut left = [Vector3::zeros(); 4];
    let mut num_left = 0;
    for corner in 0..3 {
        let (from, to) = (corners[corner], corners[(corner + 1) % 3]);
        if from.z <= near {
            left[num_left] = from;
            num_left += 1;
        }
        if (from.z <= near) != (to.z <= near) {
            left[num_left] = from + (to - from) * ((near - from.z) / (to.z - from.z));
            num_left += 1;
        }
    }
    for second in 1..num_left.max(1) - 1 {
        whole([left[0], left[second], left[second + 1]]);
    }
}

impl Piece {
    /// Whether the corners run clockwise on the picture, as those of a back side do.
    pub(crate) fn is_clockwise(&self) -> bool {
        let [[ax, ay, _], [bx, by, _], [cx, cy, _]] = self.corners;
        (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 0.0
    }
}
