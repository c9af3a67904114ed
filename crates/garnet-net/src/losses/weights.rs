//! Which terms a training minimises, and how much each counts.

use serde::{Deserialize, Serialize};

use crate::NetError;

/// One term of the loss.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Term {
    /// Squared distance of vertices, Eq. 4.
    Vertex,
    /// Distance of vertices; not in the paper.
    Distance,
    /// Depth behind the nearest body points, Eq. 5.
    Penetration,
    /// Turn of faces, Eq. 6.
    Normal,
    /// Distances of two-ring pairs, Eq. 7.
    Bending,
    /// Mean-curvature normals, Eq. 14.
    MeanCurvature,
    /// Uniform curvature vectors, Eq. 19.
    UniformCurvature,
    /// Rayleigh quotients of 8 neighbors, Eq. 13.
    Rayleigh8,
    /// Rayleigh quotients of 16 neighbors, Eq. 13.
    Rayleigh16,
    /// Rayleigh quotients of 32 neighbors, Eq. 13.
    Rayleigh32,
    /// Edge lengths against the template's; needs no teacher.
    Strain,
    /// Height of the cloth; needs no teacher.
    Gravity,
    /// Cosines across edges; needs no teacher.
    Fold,
}

impl Term {
    /// All terms, in the order of reports.
    pub const ALL: [Self; 13] = [
        Self::Vertex,
        Self::Distance,
        Self::Penetration,
        Self::Normal,
        Self::Bending,
        Self::MeanCurvature,
        Self::UniformCurvature,
        Self::Rayleigh8,
        Self::Rayleigh16,
        Self::Rayleigh32,
        Self::Strain,
        Self::Gravity,
        Self::Fold,
    ];

    /// The name in reports and configurations.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Vertex => "vertex",
            Self::Distance => "distance",
            Self::Penetration => "penetration",
            Self::Normal => "normal",
            Self::Bending => "bending",
            Self::MeanCurvature => "mean-curvature",
            Self::UniformCurvature => "uniform-curvature",
            Self::Rayleigh8 => "rayleigh-8",
            Self::Rayleigh16 => "rayleigh-16",
            Self::Rayleigh32 => "rayleigh-32",
            Self::Strain => "strain",
            Self::Gravity => "gravity",
            Self::Fold => "fold",
        }
    }

    /// The field of [`LossConfig`] that has its weight.
    const fn field(self) -> &'static str {
        match self {
            Self::MeanCurvature => "mean_curvature",
            Self::UniformCurvature => "uniform_curvature",
            Self::Rayleigh8 | Self::Rayleigh16 | Self::Rayleigh32 => "rayleigh",
            _ => self.name(),
        }
    }
}

/// The weight of each term and the constants in them.
///
/// Lengths enter the terms in units of 0.1 m, for which the weights are meant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LossConfig {
    /// Of [`Term::Vertex`].
    pub vertex: f64,
    /// Of [`Term::Distance`].
    pub distance: f64,
    /// Of [`Term::Penetration`].
    pub penetration: f64,
    /// Of [`Term::Normal`].
    pub normal: f64,
    /// Of [`Term::Bending`].
    pub bending: f64,
    /// Of [`Term::MeanCurvature`].
    pub mean_curvature: f64,
    /// Of [`Term::UniformCurvature`].
    pub uniform_curvature: f64,
    /// Of the Rayleigh quotients of 8, 16 and 32 neighbors.
    pub rayleigh: [f64; 3],
    /// Of [`Term::Strain`].
    pub strain: f64,
    /// Of [`Term::Gravity`].
    pub gravity: f64,
    /// Of [`Term::Fold`].
    pub fold: f64,
    /// Vertices farther than this from their target do not count as penetrating, metres.
    pub penetration_tolerance: f32,
    /// Body points are moved out by this share of the body's mean edge length.
    pub penetration_offset: f32,
    /// Bound on cotangents of mean curvature: 20 is an angle of 3°. The paper has none.
    pub max_cotangent: f64,
}

impl Default for LossConfig {
    fn default() -> Self {
        Self::paper()
    }
}

impl LossConfig {
    /// L_p: the weights of Eq. 3.
    pub const fn paper() -> Self {
        Self {
            vertex: 1.0,
            distance: 0.0,
            penetration: 1.0,
            normal: 0.3,
            bending: 0.5,
            mean_curvature: 0.0,
            uniform_curvature: 0.0,
            rayleigh: [0.0; 3],
            strain: 0.0,
            gravity: 0.0,
            fold: 0.0,
            penetration_tolerance: 0.05,
            penetration_offset: 0.2,
            max_cotangent: 20.0,
        }
    }

    /// As [`LossConfig::paper`], with distances in place of their squares: what networks are told
    /// by is the mean distance. The weight gives both terms the same slope at 12 mm.
    pub const fn nearer() -> Self {
        Self {
            vertex: 0.0,
            distance: 0.25,
            ..Self::paper()
        }
    }

    /// Fine-tuning with mean curvature, Eq. 15 (Local-MC).
    ///
    /// The paper's weight of 10 belongs to a unit of length that it does not tell. In 0.1 m it
    /// would leave nothing of the other terms; with this one the term starts at the size of that of
    /// the vertices, as the paper wants it. More gives flatter cloth farther off. Tried: 5e-5 and
    /// 1e-3 (docs/experiments/006-learning-rates.md).
    pub const fn fine_tune_mc() -> Self {
        Self {
            mean_curvature: 5e-5,
            ..Self::paper_tenth()
        }
    }

    /// Fine-tuning with uniform curvature vectors (Local-UMC).
    pub const fn fine_tune_umc() -> Self {
        Self {
            uniform_curvature: 10.0,
            ..Self::paper_tenth()
        }
    }

    /// Fine-tuning with Rayleigh quotients, Eq. 16 (Local-RQ).
    pub const fn fine_tune_rq() -> Self {
        Self {
            rayleigh: [500.0, 50.0, 10.0],
            ..Self::paper_tenth()
        }
    }

    /// Fine-tuning with both (Local-MCRQ).
    pub const fn fine_tune_mcrq() -> Self {
        Self {
            rayleigh: [500.0, 50.0, 10.0],
            ..Self::fine_tune_mc()
        }
    }

    /// λ_p L_p with λ_p = 0.1.
    const fn paper_tenth() -> Self {
        Self {
            vertex: 0.1,
            penetration: 0.1,
            normal: 0.03,
            bending: 0.05,
            ..Self::paper()
        }
    }

    /// The weight of a term.
    pub const fn weight(&self, term: Term) -> f64 {
        match term {
            Term::Vertex => self.vertex,
            Term::Distance => self.distance,
            Term::Penetration => self.penetration,
            Term::Normal => self.normal,
            Term::Bending => self.bending,
            Term::MeanCurvature => self.mean_curvature,
            Term::UniformCurvature => self.uniform_curvature,
            Term::Rayleigh8 => self.rayleigh[0],
            Term::Rayleigh16 => self.rayleigh[1],
            Term::Rayleigh32 => self.rayleigh[2],
            Term::Strain => self.strain,
            Term::Gravity => self.gravity,
            Term::Fold => self.fold,
        }
    }

    /// Whether no term has a weight: there is nothing to minimise.
    pub fn is_nothing(&self) -> bool {
        Term::ALL.into_iter().all(|term| self.weight(term) <= 0.0)
    }

    /// Checks weights and constants.
    ///
    /// # Errors
    ///
    /// [`NetError::Loss`] with the first that is negative, no number or otherwise out of range.
    pub fn check(&self) -> Result<(), NetError> {
        let weights = Term::ALL.map(|term| (term.field(), self.weight(term), 0.0, 1e9));
        let constants = [
            (
                "penetration_tolerance",
                f64::from(self.penetration_tolerance),
                0.0,
                1e9,
            ),
            (
                "penetration_offset",
                f64::from(self.penetration_offset),
                0.0,
                1e3,
            ),
            ("max_cotangent", self.max_cotangent, 1.0, 1e12),
        ];
        for (field, value, min, max) in weights.into_iter().chain(constants) {
            if !(min..=max).contains(&value) {
                return Err(NetError::Loss {
                    field,
                    value,
                    min,
                    max,
                });
            }
        }
        Ok(())
    }
}
