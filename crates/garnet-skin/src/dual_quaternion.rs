//! Dual quaternions: rigid transforms that can be blended.
//!
//! Kavan, Collins, Žára, O'Sullivan: *Skinning with Dual Quaternions*, I3D 2007, and *Geometric
//! Skinning with Approximate Dual Quaternion Blending*, ACM TOG 2008. A rigid transform with
//! rotation `q0` and translation `t` is `q0 + ε qe` with `qe = ½ t q0` (2008, section 3.3).

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

use crate::{Point3, Vector3};

/// A dual quaternion `real + ε dual`.
///
/// It is a rigid transform where its real part has norm 1; `q` and `-q` are the same transform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DualQuaternion {
    /// The rotation `q0`.
    pub real: Quaternion<f32>,
    /// `qe = ½ t q0`, in metres.
    pub dual: Quaternion<f32>,
}

/// Below this norm the real part of a blend is taken for zero.
///
/// With signs fixed against the heaviest part, the norm is at least that part's share, so only
/// parts that are no rotations at all come here.
const MIN_NORM: f32 = 1e-6;

impl DualQuaternion {
    /// The dual quaternion of a rigid transform.
    pub fn from_isometry(transform: &Isometry3<f32>) -> Self {
        let real = transform.rotation.cast::<f64>().into_inner();
        let translation = transform.translation.vector.cast::<f64>();
        let dual = Quaternion::from_imag(translation) * real * 0.5;
        Self {
            real: real.cast(),
            dual: dual.cast(),
        }
    }

    /// The rigid transform of a dual quaternion of norm 1.
    pub fn to_isometry(self) -> Isometry3<f32> {
        let translation = (self.dual * self.real.conjugate()).imag() * 2.0;
        let rotation = UnitQuaternion::new_unchecked(self.real);
        Isometry3::from_parts(Translation3::from(translation), rotation)
    }

    /// Divides both parts by the norm of the real part; none where that is near zero.
    pub fn normalized(self) -> Option<Self> {
        let norm = self.real.norm();
        (norm > MIN_NORM && norm.is_finite()).then(|| Self {
            real: self.real / norm,
            dual: self.dual / norm,
        })
    }

    /// Blends the transforms `parts` by weight (dual quaternion linear blending; Kavan et al. 2008,
    /// Eq. 4 and Algorithm 1).
    ///
    /// The pivot is the part of the largest weight, the first of equals: a part on its other
    /// hemisphere has its sign turned, so that rotations blend the short way. Where the sum
    /// vanishes, the blend is the pivot. No parts blend to the identity.
    pub fn blend(parts: impl Iterator<Item = (Self, f32)> + Clone) -> Self {
        let mut heaviest: Option<(Self, f32)> = None;
        for (part, weight) in parts.clone() {
            if heaviest.is_none_or(|(_, largest)| weight > largest) {
                heaviest = Some((part, weight));
            }
        }
        let Some((pivot, _)) = heaviest else {
            return Self::from_isometry(&Isometry3::identity());
        };
        Self::blend_about(pivot, parts)
    }

    /// [`Self::blend`] with a pivot that is known.
    pub(crate) fn blend_about(pivot: Self, parts: impl Iterator<Item = (Self, f32)>) -> Self {
        let signed = parts.map(|(part, weight)| {
            let is_opposite = pivot.real.dot(&part.real) < 0.0;
            (part, if is_opposite { -weight } else { weight })
        });
        Self::blend_signed(pivot, signed)
    }

    /// The blend of parts whose weights have the signs of the parts; the pivot where the sum
    /// vanishes.
    pub(crate) fn blend_signed(pivot: Self, parts: impl Iterator<Item = (Self, f32)>) -> Self {
        let mut real = Quaternion::from_vector(nalgebra::Vector4::zeros());
        let mut dual = real;
        for (part, weight) in parts {
            real += part.real * weight;
            dual += part.dual * weight;
        }
        Self { real, dual }.normalized().unwrap_or(pivot)
    }

    /// Moves a point by a dual quaternion of norm 1 (Kavan et al. 2008, Algorithm 1).
    pub fn transform_point(self, point: &Point3) -> Point3 {
        let (w0, d0) = (self.real.scalar(), self.real.imag());
        let (we, de) = (self.dual.scalar(), self.dual.imag());
        let translation = (de * w0 - d0 * we + d0.cross(&de)) * 2.0;
        Point3::from(self.transform_vector(&point.coords) + translation)
    }

    /// Turns a direction by a dual quaternion of norm 1.
    pub fn transform_vector(self, vector: &Vector3) -> Vector3 {
        let (w0, d0) = (self.real.scalar(), self.real.imag());
        vector + d0.cross(&(d0.cross(vector) + vector * w0)) * 2.0
    }
}

impl std::ops::Neg for DualQuaternion {
    type Output = Self;

    /// The same transform with the other sign.
    fn neg(self) -> Self {
        Self {
            real: -self.real,
            dual: -self.dual,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn transform(angle: [f32; 3], shift: [f32; 3]) -> Isometry3<f32> {
        Isometry3::new(Vector3::from(shift), Vector3::from(angle))
    }

    fn twist(degrees: f32) -> DualQuaternion {
        DualQuaternion::from_isometry(&transform([0.0, degrees.to_radians(), 0.0], [0.0; 3]))
    }

    proptest! {
        #[test]
        fn a_rigid_transform_moves_points_as_its_dual_quaternion(
            angle in prop::array::uniform3(-3.0_f32..3.0),
            shift in prop::array::uniform3(-5.0_f32..5.0),
            point in prop::array::uniform3(-2.0_f32..2.0),
        ) {
            let transform = transform(angle, shift);
            let point = Point3::from(point);
            let dual = DualQuaternion::from_isometry(&transform);
            prop_assert!((dual.transform_point(&point) - transform * point).norm() < 1e-5);
            prop_assert!((dual.to_isometry() * point - transform * point).norm() < 1e-5);
        }

        #[test]
        fn the_sign_of_a_part_does_not_matter(
            angles in prop::array::uniform2(prop::array::uniform3(-1.5_f32..1.5)),
            share in 0.01_f32..0.99,
        ) {
            let [a, b] = angles.map(|angle| DualQuaternion::from_isometry(&transform(angle, [0.3, -0.2, 0.9])));
            let point = Point3::new(0.4, 1.2, -0.3);
            let blend = |a, b| DualQuaternion::blend([(a, share), (b, 1.0 - share)].into_iter()).transform_point(&point);
            let expected = blend(a, b);
            for moved in [blend(-a, b), blend(a, -b), blend(-a, -b)] {
                prop_assert!((moved - expected).norm() < 1e-6);
            }
        }
    }

    #[test]
    fn two_opposite_parts_blend_to_a_unit_transform() {
        // 180 degrees apart: the quaternions are orthogonal and the signs undecided.
        for degrees in [179.999, 180.0, 180.001] {
            let blend =
                DualQuaternion::blend([(twist(0.0), 0.5), (twist(degrees), 0.5)].into_iter());
            approx::assert_relative_eq!(blend.real.norm(), 1.0, epsilon = 1e-6);
        }
        let same = DualQuaternion::blend([(twist(30.0), 0.5), (-twist(30.0), 0.5)].into_iter());
        approx::assert_relative_eq!(same.real, twist(30.0).real, epsilon = 1e-6);
    }

    #[test]
    fn a_vanishing_blend_falls_back_to_the_heaviest_part() {
        let zero = DualQuaternion {
            real: Quaternion::from_imag(Vector3::zeros()),
            dual: Quaternion::from_imag(Vector3::zeros()),
        };
        let blend = DualQuaternion::blend([(twist(40.0), 0.0), (zero, 0.0)].into_iter());
        assert_eq!(blend, twist(40.0));
        let nothing = DualQuaternion::blend(std::iter::empty());
        assert_eq!(nothing.to_isometry(), Isometry3::identity());
    }
}
