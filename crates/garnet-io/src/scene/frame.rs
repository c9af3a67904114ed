//! Units and axes of files, and the way from them to metres with y up and back.

use garnet_mesh::{Bounds, Point3, TriMesh, Unit, UpAxis, Vector3};

use crate::{guess_body_unit, guess_up_axis};

/// Unit of length and up axis of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame {
    /// The unit.
    pub unit: Unit,
    /// The axis that points up.
    pub up: UpAxis,
}

impl Frame {
    /// The frame in which everything is computed.
    pub const OURS: Self = Self {
        unit: Unit::Metre,
        up: UpAxis::Y,
    };

    /// The frame of a body, by its height.
    pub fn detected(mesh: &TriMesh) -> Self {
        Self {
            unit: detected_unit(mesh),
            up: detected_up(mesh),
        }
    }

    /// Positions of the file, in metres with y up.
    pub fn to_metres(self, positions: Vec<Point3>) -> Vec<Point3> {
        if self == Self::OURS {
            return positions;
        }
        let point = |point: &Point3| self.point_to_metres(point);
        positions.iter().map(point).collect()
    }

    /// A position of the file, in metres with y up.
    pub fn point_to_metres(self, point: &Point3) -> Point3 {
        let metres = self.unit.in_metres();
        match self.up {
            UpAxis::Y => point * metres,
            UpAxis::Z => Point3::new(point.x, point.z, -point.y) * metres,
        }
    }

    /// Positions in metres with y up, as the file has them.
    pub fn to_file(self, positions: Vec<Point3>) -> Vec<Point3> {
        if self == Self::OURS {
            return positions;
        }
        let metres = self.unit.in_metres();
        let point = |point: &Point3| match self.up {
            UpAxis::Y => point / metres,
            UpAxis::Z => Point3::new(point.x, -point.z, point.y) / metres,
        };
        positions.iter().map(point).collect()
    }
}

/// The up axis of a rest body: the longer of y and z, and y in doubt.
pub(super) fn detected_up(mesh: &TriMesh) -> UpAxis {
    guess_up_axis(extent(mesh)).unwrap_or(UpAxis::Y)
}

/// The unit in which a rest body has the height of a body; metres in doubt.
pub(super) fn detected_unit(mesh: &TriMesh) -> Unit {
    let extent = extent(mesh);
    guess_body_unit(extent.y.max(extent.z)).unwrap_or(Unit::Metre)
}

fn extent(mesh: &TriMesh) -> Vector3 {
    let bounds = Bounds::of_faces(mesh.positions(), mesh.faces());
    bounds.unwrap_or_default().extent()
}

/// The unit `decades` powers of ten shorter, if there is one.
pub(super) fn shorter(unit: Unit, decades: i32) -> Option<Unit> {
    let place = Unit::METRIC.iter().position(|&other| other == unit)?;
    let place = i32::try_from(place).ok()?.checked_add(decades)?;
    Unit::METRIC.get(usize::try_from(place).ok()?).copied()
}

#[cfg(test)]
mod tests {
    use garnet_mesh::primitives::icosphere;

    use super::*;

    const ROUNDING: f32 = 1e-6;

    #[test]
    fn the_way_back_is_the_way_there_reversed() {
        let positions = icosphere(1, 0.7).into_parts().0;
        for unit in Unit::METRIC {
            for up in [UpAxis::Y, UpAxis::Z] {
                let frame = Frame { unit, up };
                let back = frame.to_metres(frame.to_file(positions.clone()));
                let pairs = positions.iter().zip(&back);
                assert!(pairs.into_iter().all(|(a, b)| (a - b).norm() < ROUNDING));
            }
        }
    }

    #[test]
    fn a_front_stays_a_front() {
        let blender = Frame {
            unit: Unit::Metre,
            up: UpAxis::Z,
        };
        let nose = blender.point_to_metres(&Point3::new(0.0, -0.1, 1.6));
        assert_eq!(nose, Point3::new(0.0, 1.6, 0.1));
    }

    #[test]
    fn units_are_counted_in_powers_of_ten() {
        assert_eq!(shorter(Unit::Metre, 2), Some(Unit::Centimetre));
        assert_eq!(shorter(Unit::Centimetre, -2), Some(Unit::Metre));
        assert_eq!(shorter(Unit::Metre, -1), None);
        assert_eq!(shorter(Unit::Millimetre, i32::MAX), None);
    }
}
