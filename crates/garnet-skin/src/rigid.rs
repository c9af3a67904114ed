//! Rigid transforms out of matrices.

use nalgebra::{Isometry3, Matrix3, Matrix4, Quaternion, Translation3, UnitQuaternion};

use crate::SkinError;

/// Rounds of the symmetric eigenvalue iteration; a 4 × 4 matrix needs a handful.
const MAX_EIGEN_ROUNDS: usize = 200;

/// The rigid transform of a matrix (column vectors, translation in the last column).
///
/// Rounding within `tolerance` is removed; scale, shear and mirrors beyond it are refused, because
/// dual quaternions cannot carry them. `joint` names the joint in the error.
///
/// # Errors
///
/// [`SkinError::NotRigid`], also for entries that are not finite.
pub fn rigid_from_matrix(
    joint: &str,
    matrix: &Matrix4<f64>,
    tolerance: f64,
) -> Result<Isometry3<f32>, SkinError> {
    let linear: Matrix3<f64> = matrix.fixed_view::<3, 3>(0, 0).into_owned();
    let translation = matrix.fixed_view::<3, 1>(0, 3).into_owned();
    let gram = linear.transpose() * linear - Matrix3::identity();
    let last_row = matrix.row(3) - Matrix4::<f64>::identity().row(3);
    let mut deviation = gram.abs().max().max(last_row.abs().max());
    if linear.determinant() <= 0.0 {
        deviation = deviation.max(2.0);
    }
    let is_finite = matrix.iter().all(|&value| (value as f32).is_finite());
    if !is_finite || deviation > tolerance {
        return Err(SkinError::NotRigid {
            joint: joint.to_owned(),
            deviation: if is_finite { deviation } else { f64::NAN },
            tolerance,
        });
    }
    let rotation = nearest_rotation(&linear).unwrap_or_else(UnitQuaternion::identity);
    Ok(Isometry3::from_parts(Translation3::from(translation), rotation).cast())
}

/// The rotation `R` of largest `tr(Rᵀ M)`: for a covariance `M = Σ w y xᵀ` the rotation of the best
/// rigid fit of `x` to `y`, for any other matrix the rotation nearest to it.
///
/// Horn 1987, *Closed-form solution of absolute orientation using unit quaternions*, section 4: the
/// eigenvector of the largest eigenvalue of a symmetric 4 × 4 matrix. It is never a mirror, and a
/// matrix of deficient rank gives one of its best rotations. None if `M` is not finite.
pub fn nearest_rotation(matrix: &Matrix3<f64>) -> Option<UnitQuaternion<f64>> {
    let scale = matrix.abs().max();
    if !scale.is_finite() {
        return None;
    }
    if scale <= f64::MIN_POSITIVE {
        return Some(UnitQuaternion::identity());
    }
    let m = matrix / scale;
    let (x, y, z) = (
        m[(2, 1)] - m[(1, 2)],
        m[(0, 2)] - m[(2, 0)],
        m[(1, 0)] - m[(0, 1)],
    );
    let (xy, xz, yz) = (
        m[(0, 1)] + m[(1, 0)],
        m[(0, 2)] + m[(2, 0)],
        m[(1, 2)] + m[(2, 1)],
    );
    let [xx, yy, zz] = [m[(0, 0)], m[(1, 1)], m[(2, 2)]];
    #[rustfmt::skip]
    let horn = Matrix4::new(
        xx + yy + zz, x,            y,            z,
        x,            xx - yy - zz, xy,           xz,
        y,            xy,           yy - xx - zz, yz,
        z,            xz,           yz,           zz - xx - yy,
    );
    let eigen = horn.try_symmetric_eigen(f64::EPSILON, MAX_EIGEN_ROUNDS)?;
    let largest = eigen.eigenvalues.imax();
    let q = eigen.eigenvectors.column(largest);
    Some(UnitQuaternion::new_normalize(Quaternion::new(
        q[0], q[1], q[2], q[3],
    )))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use proptest::prelude::*;

    use super::*;

    const TOLERANCE: f64 = 1e-3;

    proptest! {
        #[test]
        fn a_rigid_matrix_gives_its_transform_back(angle in prop::array::uniform3(-3.0_f64..3.0), noise in prop::collection::vec(-5e-5_f64..5e-5, 9)) {
            let transform = Isometry3::new(Vector3::new(1.0, -2.0, 0.5), Vector3::from(angle));
            let mut matrix = transform.to_homogeneous();
            for (entry, noise) in noise.iter().enumerate() {
                matrix[(entry / 3, entry % 3)] += noise;
            }
            let found = rigid_from_matrix("j", &matrix, TOLERANCE).unwrap();
            prop_assert!(found.rotation.cast::<f64>().angle_to(&transform.rotation) < 5e-4);
            prop_assert!((found.translation.vector.cast::<f64>() - transform.translation.vector).norm() < 1e-6);
        }

        #[test]
        fn any_matrix_has_a_nearest_rotation(entries in prop::collection::vec(-1e3_f64..1e3, 9)) {
            let rotation = nearest_rotation(&Matrix3::from_row_slice(&entries)).unwrap();
            prop_assert!((rotation.coords.norm() - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn scale_shear_mirrors_and_nan_are_refused_by_name() {
        let scale = Matrix4::new_scaling(1.01);
        let mut shear = Matrix4::identity();
        shear[(0, 1)] = 0.1;
        let mirror = Matrix4::from_diagonal(&nalgebra::Vector4::new(-1.0, 1.0, 1.0, 1.0));
        let mut projective = Matrix4::identity();
        projective[(3, 0)] = 0.5;
        for matrix in [
            scale,
            shear,
            mirror,
            projective,
            Matrix4::from_element(f64::NAN),
            Matrix4::zeros(),
        ] {
            let error = rigid_from_matrix("left_knee", &matrix, TOLERANCE).unwrap_err();
            assert!(
                matches!(&error, SkinError::NotRigid { joint, .. } if joint == "left_knee"),
                "{error}"
            );
        }
    }

    #[test]
    fn a_flat_covariance_gives_a_rotation_that_fits() {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.7);
        let covariance = (turn * Vector3::x()) * Vector3::x().transpose();
        let found = nearest_rotation(&covariance).unwrap();
        approx::assert_relative_eq!(found * Vector3::x(), turn * Vector3::x(), epsilon = 1e-9);
        assert!(nearest_rotation(&Matrix3::zeros()).is_some());
    }
}
