//! Units and axes of files, and the way from them to metres with y up and back.

use garnet_body::shape::times_as_large;
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
    if let Some(unit) = times_as_large(mesh).and_then(|times| unit_of(Unit::Metre, times)) {
        return unit;
    }
    let extent = extent(mesh);
    guess_body_unit(extent.y.max(extent.z)).unwrap_or(Unit::Metre)
}

fn extent(mesh: &TriMesh) -> Vector3 {
    let bounds = Bounds::of_faces(mesh.positions(), mesh.faces());
    bounds.unwrap_or_default().extent()
}

/// People of one topology are larger by no more than this: children and giants.
const OTHER_SHAPE: f32 = 2.0;

/// The same, where the only unit that fits is an imperial one. Higher ones take a child in
/// centimetres for a grown-up in inches.
const ALIKE: f32 = 4.0 / 3.0;

/// Larger factors are those of no unit.
const NO_UNIT: f32 = 3.2;

/// The unit of a body whose edges are `ratio` times as long as in `unit`, if there is one: the same
/// times a power of ten, or an imperial one where that alone gives a body of like size.
pub(super) fn unit_of(unit: Unit, ratio: f32) -> Option<Unit> {
    let factor = |other: &Unit| {
        let size = ratio * other.in_metres() / unit.in_metres();
        size.max(1.0 / size)
    };
    let nearest = |units: &[Unit], most: f32| {
        let of_units = units.iter().copied();
        let fitting = of_units.filter(|other| factor(other) <= most);
        fitting.min_by(|a, b| factor(a).total_cmp(&factor(b)))
    };
    let same = [unit];
    let like: &[Unit] = if Unit::METRIC.contains(&unit) {
        &Unit::METRIC
    } else {
        &same
    };
    nearest(like, OTHER_SHAPE)
        .or_else(|| nearest(&Unit::ALL, ALIKE))
        .or_else(|| nearest(like, NO_UNIT))
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
    fn a_unit_is_known_by_the_size_of_the_body() {
        let cases = [
            (Unit::Metre, 100.0, Some(Unit::Centimetre)),
            (Unit::Metre, 61.0, Some(Unit::Centimetre)),
            (Unit::Centimetre, 0.012, Some(Unit::Metre)),
            (Unit::Metre, 1.0 / 0.0254, Some(Unit::Inch)),
            (Unit::Centimetre, 0.9 / 2.54, Some(Unit::Inch)),
            (Unit::Metre, 3.3, Some(Unit::Foot)),
            (Unit::Inch, 1.2, Some(Unit::Inch)),
            (Unit::Inch, 2.54, Some(Unit::Centimetre)),
            // A doll of the same topology.
            (Unit::Metre, 0.45, Some(Unit::Metre)),
            (Unit::Metre, 0.1, None),
            (Unit::Millimetre, 1e9, None),
            (Unit::Metre, f32::NAN, None),
        ];
        for (unit, ratio, expected) in cases {
            assert_eq!(unit_of(unit, ratio), expected, "{unit} times {ratio}");
        }
    }
}
