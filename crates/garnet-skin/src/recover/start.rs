//! The start of a recovery: a weighted rigid fit for each joint.

use nalgebra::{Isometry3, Matrix3, Point3, Translation3, Vector3};

use crate::{Body, rigid::nearest_rotation};

/// Power of the weights in the fit: vertices that a joint shares with others say little about it.
const WEIGHT_POWER: i32 = 4;

/// Share of a joint's own scatter that its parent's rotation gets as a prior. It decides only what
/// the vertices leave open, such as the turn of a joint whose vertices lie on a line.
const PARENT_PRIOR: f64 = 1e-3;

/// Sums over the vertices of one joint (Umeyama 1991, Eq. 34 to 38).
#[derive(Debug, Clone, Default)]
struct Moments {
    weight: f64,
    rest: Vector3<f64>,
    target: Vector3<f64>,
    rest_squared: f64,
    /// `Σ w y xᵀ`.
    product: Matrix3<f64>,
}

/// The rigid transform that carries the vertices of each joint to the target best, `[joint]`.
///
/// A joint of no vertices gets its parent's transform.
pub(super) fn rigid_fits(
    body: &Body,
    rest: &[Point3<f64>],
    target: &[Point3<f64>],
) -> Vec<Isometry3<f64>> {
    let skeleton = body.skeleton();
    let mut moments = vec![Moments::default(); skeleton.num_joints()];
    let mut whole = Moments::default();
    for (vertex, (x, y)) in rest.iter().zip(target).enumerate() {
        for (joint, weight) in body.weights().vertex(vertex) {
            moments[joint].add(f64::from(weight).powi(WEIGHT_POWER), &x.coords, &y.coords);
        }
        whole.add(1.0, &x.coords, &y.coords);
    }
    // Roots lean on the fit of all vertices, as far as they leave anything open.
    let whole = whole.fit(&Isometry3::identity(), whole.mean_scatter());
    let mut fits = vec![whole; skeleton.num_joints()];
    for &joint in skeleton.parents_first() {
        let parent = skeleton.joints()[joint].parent;
        let prior = parent.map_or(whole, |parent| fits[parent]);
        let scatter = moments[joint].mean_scatter();
        fits[joint] = moments[joint].fit(&prior, scatter);
    }
    fits
}

impl Moments {
    fn add(&mut self, weight: f64, x: &Vector3<f64>, y: &Vector3<f64>) {
        self.weight += weight;
        self.rest += x * weight;
        self.target += y * weight;
        self.rest_squared += weight * x.norm_squared();
        self.product += y * x.transpose() * weight;
    }

    /// `Σ w |x - x̄|²`.
    fn mean_scatter(&self) -> f64 {
        if self.weight <= 0.0 {
            return 0.0;
        }
        (self.rest_squared - self.rest.norm_squared() / self.weight).max(0.0)
    }

    fn fit(&self, prior: &Isometry3<f64>, scatter: f64) -> Isometry3<f64> {
        if self.weight <= f64::MIN_POSITIVE {
            return *prior;
        }
        let rest_mean = self.rest / self.weight;
        let target_mean = self.target / self.weight;
        let covariance = self.product - self.target * rest_mean.transpose();
        let prior_rotation = prior.rotation.to_rotation_matrix().into_inner();
        // One vertex has no scatter: the tiny constant makes its rotation the prior's.
        let strength = PARENT_PRIOR * scatter + f64::MIN_POSITIVE.sqrt();
        let rotation = nearest_rotation(&(covariance + prior_rotation * strength));
        let rotation = rotation.unwrap_or(prior.rotation);
        let translation = target_mean - rotation * rest_mean;
        Isometry3::from_parts(Translation3::from(translation), rotation)
    }
}
