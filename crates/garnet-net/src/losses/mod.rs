//! The losses of the paper and terms of physics, with their derivatives.
//!
//! All terms are functions of predicted places alone, so each computes its derivative by them by
//! hand, in double precision, on plain slices: no tensor is made, and finite differences can check
//! every term exactly. [`LossReport::gradient`] then enters the network by
//! [`surrogate`](crate::surrogate). Lengths count in units of 0.1 m.

mod bending;
mod gradient;
mod mean_curvature;
mod normal;
mod penetration;
mod physics;
mod rayleigh;
mod report;
mod target;
#[cfg(test)]
mod tests;
mod uniform_curvature;
mod vertex;
mod weights;

pub use report::{LossReport, LossValue};
pub use target::{LossBody, LossTarget};
pub use weights::{LossConfig, Term};

use garnet_knn::VertexTree;
use garnet_mesh::{Hinge, Point3, Topology, TriMesh, Vector3, face_areas};

use crate::{NetError, UNIT};
use bending::{bending_loss, pair_lengths};
use gradient::{Gradient, Place};
use mean_curvature::mean_curvature_loss;
use normal::normal_loss;
use penetration::{Front, penetration_loss};
use physics::{fold_loss, gravity_loss, strain_loss};
use rayleigh::{Neighborhoods, rayleigh_loss};
use uniform_curvature::uniform_curvature_loss;
use vertex::{distance_loss, vertex_loss};

/// Neighborhood sizes of the Rayleigh quotients.
const RAYLEIGH_SIZES: [usize; 3] = [8, 16, 32];

/// The terms for one garment: all that depends on the template alone.
#[derive(Debug, Clone)]
pub struct Losses {
    config: LossConfig,
    topology: Topology,
    pairs: Vec<[u32; 2]>,
    hinges: Vec<Hinge>,
    rest_lengths: Vec<f64>,
    cloth_shares: Vec<f64>,
    neighborhoods: [Neighborhoods; 3],
}

impl Losses {
    /// Prepares the terms for a template.
    ///
    /// # Errors
    ///
    /// [`NetError::Loss`] for a weight that is negative or no number, [`NetError::Knn`] for a
    /// template of more vertices than can be numbered.
    pub fn new(template: &TriMesh, config: &LossConfig) -> Result<Self, NetError> {
        config.check()?;
        let topology = Topology::new(template.num_vertices(), template.faces());
        let places = in_units(template.positions());
        let tree = VertexTree::new(template.positions())?;
        let neighborhoods = RAYLEIGH_SIZES.map(|size| {
            let table = tree.k_nearest_all(template.positions(), size);
            Neighborhoods {
                size: table.num_neighbors(),
                indices: table.into_indices(),
            }
        });
        let areas = face_areas(template.positions(), template.faces());
        Ok(Self {
            config: config.clone(),
            pairs: topology.two_ring_pairs(),
            hinges: topology.hinges(),
            rest_lengths: pair_lengths(&places, topology.edges()),
            cloth_shares: cloth_shares(template, &areas),
            neighborhoods,
            topology,
        })
    }

    /// The weights and constants.
    pub fn config(&self) -> &LossConfig {
        &self.config
    }

    /// Prepares what the teacher's drape of a scene contributes, `[vertex]` in metres.
    ///
    /// # Errors
    ///
    /// [`NetError::Count`] for another number of vertices, [`NetError::NotFinite`].
    pub fn target(&self, draped: &[Point3]) -> Result<LossTarget, NetError> {
        self.check_places("target vertex", draped)?;
        Ok(LossTarget::new(draped))
    }

    /// The terms that have a weight, and the derivative of their weighted sum.
    ///
    /// # Errors
    ///
    /// [`NetError::Count`] for another number of vertices, [`NetError::NotFinite`].
    pub fn evaluate(
        &self,
        predicted: &[Point3],
        target: &LossTarget,
        body: &LossBody,
    ) -> Result<LossReport, NetError> {
        let terms = Term::ALL.into_iter();
        let terms = terms.filter(|&term| self.config.weight(term) > 0.0);
        self.report(predicted, target, body, terms)
    }

    /// All terms, those without weight too, for tables.
    ///
    /// # Errors
    ///
    /// As [`Losses::evaluate`].
    pub fn measure(
        &self,
        predicted: &[Point3],
        target: &LossTarget,
        body: &LossBody,
    ) -> Result<LossReport, NetError> {
        self.report(predicted, target, body, Term::ALL.into_iter())
    }

    fn report(
        &self,
        predicted: &[Point3],
        target: &LossTarget,
        body: &LossBody,
        terms: impl Iterator<Item = Term>,
    ) -> Result<LossReport, NetError> {
        self.check_places("predicted vertex", predicted)?;
        let fronts = body.fronts(predicted, self.config.penetration_offset);
        let places = in_units(predicted);
        let mut sums = vec![Place::zeros(); places.len()];
        let mut values = Vec::new();
        for term in terms {
            let weight = self.config.weight(term);
            let sums = &mut sums;
            let mut gradient = Gradient { sums, weight };
            let value = self.value(term, &places, target, &fronts, &mut gradient);
            values.push(LossValue {
                term,
                value,
                weight,
            });
        }
        let gradient = sums
            .iter()
            .map(|sum| Vector3::new(sum.x as f32, sum.y as f32, sum.z as f32));
        Ok(LossReport {
            values,
            gradient: gradient.collect(),
        })
    }

    fn value(
        &self,
        term: Term,
        places: &[Place],
        target: &LossTarget,
        fronts: &[Front],
        gradient: &mut Gradient<'_>,
    ) -> f64 {
        let topology = &self.topology;
        let faces = topology.faces();
        let max_cotangent = self.config.max_cotangent;
        let rayleigh = |size: usize, gradient: &mut Gradient<'_>| {
            let quotients = target.quotients(self, size);
            rayleigh_loss(places, &self.neighborhoods[size], quotients, gradient)
        };
        match term {
            Term::Vertex => vertex_loss(places, &target.places, gradient),
            Term::Distance => distance_loss(places, &target.places, gradient),
            Term::Penetration => {
                let tolerance = f64::from(self.config.penetration_tolerance / UNIT);
                penetration_loss(places, &target.places, fronts, tolerance, gradient)
            }
            Term::Normal => normal_loss(places, faces, target.normals(self), gradient),
            Term::Bending => bending_loss(places, &self.pairs, target.lengths(self), gradient),
            Term::MeanCurvature => {
                let curvature = target.mean_curvature(self);
                mean_curvature_loss(places, faces, curvature, max_cotangent, gradient)
            }
            Term::UniformCurvature => {
                uniform_curvature_loss(places, topology, target.uniform_curvature(self), gradient)
            }
            Term::Rayleigh8 => rayleigh(0, gradient),
            Term::Rayleigh16 => rayleigh(1, gradient),
            Term::Rayleigh32 => rayleigh(2, gradient),
            Term::Strain => strain_loss(places, topology.edges(), &self.rest_lengths, gradient),
            Term::Gravity => gravity_loss(places, &self.cloth_shares, gradient),
            Term::Fold => fold_loss(places, &self.hinges, gradient),
        }
    }

    fn check_places(&self, what: &'static str, places: &[Point3]) -> Result<(), NetError> {
        NetError::check_count(what, places.len(), self.topology.num_vertices())?;
        let is_stray = |place: &Point3| !place.iter().all(|value| value.is_finite());
        match places.iter().position(is_stray) {
            Some(index) => Err(NetError::NotFinite { what, index }),
            None => Ok(()),
        }
    }
}

/// Places in units, in double precision.
fn in_units(points: &[Point3]) -> Vec<Place> {
    let in_unit = |point: &Point3| point.coords.cast::<f64>() / f64::from(UNIT);
    points.iter().map(in_unit).collect()
}

/// The share of all cloth that each vertex carries: a third of the faces at it.
fn cloth_shares(template: &TriMesh, areas: &[f32]) -> Vec<f64> {
    let total: f64 = areas.iter().map(|&area| f64::from(area)).sum();
    let mut shares = vec![0.0; template.num_vertices()];
    for (face, &area) in template.faces().iter().zip(areas) {
        for &vertex in face {
            shares[vertex as usize] += f64::from(area) / (3.0 * total.max(f64::MIN_POSITIVE));
        }
    }
    shares
}
