//! Gauss-Newton on the rigid transforms of all joints.

use nalgebra::{
    Isometry3, Matrix3, Matrix3x6, Matrix6, Point3, Quaternion, Translation3, UnitQuaternion,
    Vector3, Vector6,
};
use rayon::prelude::*;

use super::equations::{Equations, Pattern};
use crate::{Body, Joint, Method};

/// Vertices of one task; sums are taken in the order of the tasks.
const CHUNK: usize = 1024;

const MAX_STEPS: usize = 20;

/// Largest move of any joint, in radians or metres, at which the search stops.
const STILL: f64 = 1e-7;

/// Relative fall of the squared residual below which the search stops.
const NO_PROGRESS: f64 = 1e-4;

/// Residual of the linear equations, relative to their right side.
const SOLVER_TOLERANCE: f64 = 1e-6;

/// Damping of each block, relative to its mean diagonal: enough to keep what no vertex sees.
const DAMPING: f64 = 1e-6;

/// Strength of the tie of a joint to its parent, relative to the weights of its vertices.
const TIE: f64 = 1.0;

/// A rest body, a target, and the pattern of the equations between them.
#[derive(Debug)]
pub(super) struct Problem<'a> {
    body: &'a Body,
    rest: &'a [Point3<f64>],
    target: &'a [Point3<f64>],
    pattern: Pattern,
    /// `Σ w²` over the vertices of each joint.
    weight_squared: Vec<f64>,
}

/// Where a search ended.
#[derive(Debug)]
pub(super) struct Solution {
    pub transforms: Vec<Isometry3<f64>>,
    pub method: Method,
    pub max_residual: f64,
    pub rms_residual: f64,
    pub iterations: usize,
}

/// A joint as the kernels want it.
#[derive(Debug, Clone, Copy)]
struct Posed {
    rotation: Matrix3<f64>,
    translation: Vector3<f64>,
    /// Where the joint's turns are centred: its own position.
    center: Vector3<f64>,
    /// On the side of that of the parent.
    real: Quaternion<f64>,
    dual: Quaternion<f64>,
}

impl<'a> Problem<'a> {
    pub(super) fn new(body: &'a Body, rest: &'a [Point3<f64>], target: &'a [Point3<f64>]) -> Self {
        let mut weight_squared = vec![0.0; body.skeleton().num_joints()];
        for vertex in 0..body.weights().num_vertices() {
            for (joint, weight) in body.weights().vertex(vertex) {
                weight_squared[joint] += f64::from(weight * weight);
            }
        }
        Self {
            body,
            rest,
            target,
            pattern: Pattern::new(body.weights(), body.skeleton()),
            weight_squared,
        }
    }

    /// Takes steps from `start` until nothing moves or improves.
    pub(super) fn solve(&self, method: Method, start: &[Isometry3<f64>]) -> Solution {
        let mut transforms = start.to_vec();
        let mut joints = self.posed(&transforms);
        let mut residuals = self.residuals(method, &joints);
        let mut loss = sum_of_squares(&residuals);
        let mut iterations = 0;
        while iterations < MAX_STEPS {
            let mut equations = self.equations(method, &joints, &residuals);
            self.tie(&joints, &mut equations);
            damp(&mut equations);
            let Some(step) = self.pattern.solve(&equations, SOLVER_TOLERANCE) else {
                break;
            };
            let moved: Vec<Isometry3<f64>> = transforms
                .iter()
                .zip(&joints)
                .zip(&step)
                .map(|((transform, joint), step)| apply(transform, joint, step))
                .collect();
            let next_joints = self.posed(&moved);
            let next_residuals = self.residuals(method, &next_joints);
            let next_loss = sum_of_squares(&next_residuals) + self.gaps(&next_joints);
            let this_loss = loss + self.gaps(&joints);
            iterations += 1;
            if !next_loss.is_finite() || next_loss > this_loss {
                break;
            }
            transforms = moved;
            joints = next_joints;
            residuals = next_residuals;
            loss = sum_of_squares(&residuals);
            let largest = step.iter().map(Vector6::amax).fold(0.0, f64::max);
            if largest < STILL || this_loss - next_loss < NO_PROGRESS * this_loss {
                break;
            }
        }
        let squared = residuals.iter().map(Vector3::norm_squared);
        Solution {
            transforms,
            method,
            max_residual: squared.fold(0.0, f64::max).sqrt(),
            rms_residual: (loss / residuals.len().max(1) as f64).sqrt(),
            iterations,
        }
    }

    fn posed(&self, transforms: &[Isometry3<f64>]) -> Vec<Posed> {
        let joints = transforms.iter().zip(self.body.skeleton().joints());
        let posed = joints.map(|(transform, joint)| {
            let real = transform.rotation.into_inner();
            let translation = transform.translation.vector;
            Posed {
                rotation: transform.rotation.to_rotation_matrix().into_inner(),
                translation,
                center: (transform * joint.rest_position.cast::<f64>()).coords,
                real,
                dual: Quaternion::from_imag(translation) * real * 0.5,
            }
        });
        let mut posed: Vec<Posed> = posed.collect();
        for pair in self.body.weights().bones() {
            let [joint, parent] = pair.map(usize::from);
            if posed[parent].real.dot(&posed[joint].real) < 0.0 {
                posed[joint].real = -posed[joint].real;
                posed[joint].dual = -posed[joint].dual;
            }
        }
        posed
    }

    /// Skinned less target, `[vertex]`.
    fn residuals(&self, method: Method, joints: &[Posed]) -> Vec<Vector3<f64>> {
        let mut residuals = vec![Vector3::zeros(); self.rest.len()];
        let chunks = residuals.par_chunks_mut(CHUNK).enumerate();
        chunks.for_each(|(chunk, residuals)| {
            for (offset, residual) in residuals.iter_mut().enumerate() {
                let vertex = chunk * CHUNK + offset;
                let (numbers, weights) = self.body.weights().row(vertex);
                let rest = &self.rest[vertex].coords;
                let skinned = match method {
                    Method::Linear => linear(joints, numbers, weights, rest),
                    Method::DualQuaternion => dual_quaternion(joints, numbers, weights, rest),
                };
                *residual = skinned - self.target[vertex].coords;
            }
        });
        residuals
    }

    /// The normal equations of all vertices.
    fn equations(&self, method: Method, joints: &[Posed], residuals: &[Vector3<f64>]) -> Equations {
        let chunks = residuals.par_chunks(CHUNK).enumerate();
        let parts: Vec<Equations> = chunks
            .map(|(chunk, residuals)| {
                let mut part = self.pattern.zeros();
                for (offset, residual) in residuals.iter().enumerate() {
                    let vertex = chunk * CHUNK + offset;
                    self.add_vertex(method, joints, vertex, residual, &mut part);
                }
                part
            })
            .collect();
        let mut sum = self.pattern.zeros();
        for part in &parts {
            sum.add(part);
        }
        sum
    }

    fn add_vertex(
        &self,
        method: Method,
        joints: &[Posed],
        vertex: usize,
        residual: &Vector3<f64>,
        part: &mut Equations,
    ) {
        let (numbers, weights) = self.body.weights().row(vertex);
        let rest = &self.rest[vertex].coords;
        let skinned = self.target[vertex].coords + residual;
        let lever = |joint: &Posed| match method {
            // w_j T_j x moves with joint j alone.
            Method::Linear => joint.rotation * rest + joint.translation - joint.center,
            // The blend turns about the joint by the share w_j, to first order of the angle between
            // joints: exact where the residual is zero is all that the search needs.
            Method::DualQuaternion => skinned - joint.center,
        };
        let mut jacobians = [Matrix3x6::zeros(); crate::MAX_INFLUENCES];
        for ((jacobian, &number), &weight) in jacobians.iter_mut().zip(numbers).zip(weights) {
            *jacobian = motion(&lever(&joints[usize::from(number)])) * f64::from(weight);
        }
        for (i, &a) in numbers.iter().enumerate() {
            let a = usize::from(a);
            part.right[a] -= jacobians[i].tr_mul(residual);
            for (j, &b) in numbers.iter().enumerate().skip(i) {
                let (pair, is_swapped) = self.pattern.pair(a, usize::from(b));
                let (first, second) = if is_swapped { (j, i) } else { (i, j) };
                part.blocks[pair] += jacobians[first].tr_mul(&jacobians[second]);
            }
        }
    }

    /// Ties every joint to its parent: both should place the joint's rest position at one point.
    fn tie(&self, joints: &[Posed], equations: &mut Equations) {
        for (child, joint) in self.body.skeleton().joints().iter().enumerate() {
            let Some(parent) = joint.parent else {
                continue;
            };
            let (by_parent, gap) = gap(&joints[child], &joints[parent], joint);
            let strength = self.tie_strength(child, parent);
            let of_child = motion(&Vector3::zeros());
            let of_parent = -motion(&(by_parent - joints[parent].center));
            equations.right[child] -= of_child.tr_mul(&gap) * strength;
            equations.right[parent] -= of_parent.tr_mul(&gap) * strength;
            equations.blocks[child] += of_child.tr_mul(&of_child) * strength;
            equations.blocks[parent] += of_parent.tr_mul(&of_parent) * strength;
            let (pair, is_swapped) = self.pattern.pair(child, parent);
            let mixed = of_child.tr_mul(&of_parent) * strength;
            equations.blocks[pair] += if is_swapped { mixed.transpose() } else { mixed };
        }
    }

    /// What the ties cost.
    fn gaps(&self, joints: &[Posed]) -> f64 {
        let mut sum = 0.0;
        for (child, joint) in self.body.skeleton().joints().iter().enumerate() {
            if let Some(parent) = joint.parent {
                let (_, gap) = gap(&joints[child], &joints[parent], joint);
                sum += gap.norm_squared() * self.tie_strength(child, parent);
            }
        }
        sum
    }

    fn tie_strength(&self, child: usize, parent: usize) -> f64 {
        TIE * 0.5 * (self.weight_squared[child] + self.weight_squared[parent])
    }
}

/// Where the parent places a joint's rest position, and how far from there the joint does.
fn gap(child: &Posed, parent: &Posed, joint: &Joint) -> (Vector3<f64>, Vector3<f64>) {
    let rest = joint.rest_position.coords.cast::<f64>();
    let by_parent = parent.rotation * rest + parent.translation;
    (by_parent, child.center - by_parent)
}

fn sum_of_squares(residuals: &[Vector3<f64>]) -> f64 {
    residuals.iter().map(Vector3::norm_squared).sum()
}

/// How a point at `lever` from a centre moves with a turn `ω` about it and a shift `v`:
/// `ω × lever + v`, as a matrix of `(ω, v)`.
fn motion(lever: &Vector3<f64>) -> Matrix3x6<f64> {
    let mut matrix = Matrix3x6::zeros();
    matrix
        .fixed_view_mut::<3, 3>(0, 0)
        .copy_from(&-lever.cross_matrix());
    matrix
        .fixed_view_mut::<3, 3>(0, 3)
        .copy_from(&Matrix3::identity());
    matrix
}

fn apply(transform: &Isometry3<f64>, joint: &Posed, step: &Vector6<f64>) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(step.fixed_rows::<3>(0).into_owned());
    let shift = step.fixed_rows::<3>(3);
    let from_center = transform.translation.vector - joint.center;
    let translation = turn * from_center + joint.center + shift;
    let rotation = UnitQuaternion::new_normalize((turn * transform.rotation).into_inner());
    Isometry3::from_parts(Translation3::from(translation), rotation)
}

/// Adds to the diagonals so that directions that no vertex sees stay where they are.
fn damp(equations: &mut Equations) {
    let num_joints = equations.right.len();
    let diagonal = &mut equations.blocks[..num_joints];
    let trace: f64 = diagonal.iter().map(Matrix6::trace).sum();
    let floor = DAMPING * trace / (6 * num_joints) as f64 + f64::MIN_POSITIVE.sqrt();
    for block in diagonal {
        *block += Matrix6::identity() * floor;
    }
}

fn linear(joints: &[Posed], numbers: &[u16], weights: &[f32], rest: &Vector3<f64>) -> Vector3<f64> {
    let mut skinned = Vector3::zeros();
    for (&number, &weight) in numbers.iter().zip(weights) {
        let joint = &joints[usize::from(number)];
        skinned += (joint.rotation * rest + joint.translation) * f64::from(weight);
    }
    skinned
}

/// Dual-quaternion skinning in `f64`; see [`crate::DualQuaternion`].
fn dual_quaternion(
    joints: &[Posed],
    numbers: &[u16],
    weights: &[f32],
    rest: &Vector3<f64>,
) -> Vector3<f64> {
    let pivot = &joints[usize::from(numbers[0])];
    if numbers.len() == 1 {
        return pivot.rotation * rest + pivot.translation;
    }
    let mut real = Quaternion::from_imag(Vector3::zeros());
    let mut dual = real;
    for (&number, &weight) in numbers.iter().zip(weights) {
        let joint = &joints[usize::from(number)];
        real += joint.real * f64::from(weight);
        dual += joint.dual * f64::from(weight);
    }
    let norm = real.norm();
    let (real, dual) = (real / norm, dual / norm);
    let (w0, d0, we, de) = (real.scalar(), real.imag(), dual.scalar(), dual.imag());
    let turned = rest + d0.cross(&(d0.cross(rest) + rest * w0)) * 2.0;
    turned + (de * w0 - d0 * we + d0.cross(&de)) * 2.0
}
