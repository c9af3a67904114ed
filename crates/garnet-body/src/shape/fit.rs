//! The body that measures as it shall: the corrections of a surface, by Broyden's method.

use garnet_knn::Surface;
use nalgebra::{SMatrix, SVector};

use super::anatomy::{Anatomy, Corrections};
use super::anthropometry::Dimension;
use super::body::{mesh, shared};
use super::carry::Carried;
use super::measure::Measures;
use super::primitives::Vec3;
use super::surface::BodySurface;
use super::tape::{self, BODY_DENSITY};
use super::template::Template;
use super::{BodyParameters, Measure, ShapeError};

/// Rounds before the mesh is evened out, at most, and how close the girths come in them.
const MAX_ROUGH_ROUNDS: usize = 8;
const ROUGH_TOLERANCE: f64 = 4e-3;

/// Rounds after that, and after each time that folded vertices are spread out, at most.
const MAX_ROUNDS: usize = 12;
const ROUNDS_AFTER_UNFOLDING: usize = 6;

/// Folded vertices are spread out at most so often, each time with one more ring around them.
const MAX_UNFOLDINGS: usize = 6;
const FIRST_RINGS: usize = 3;

/// The first times they stay on the surface.
const UNFOLDINGS_ON_SURFACE: usize = 2;

/// Fitting ends when every girth is this close, relative.
const GIRTH_TOLERANCE: f64 = 2e-3;

/// The inseam, in metres, and for how many rounds it is waited for: thighs that meet below the
/// crotch leave it no room.
const INSEAM_TOLERANCE: f64 = 2e-3;
const ROUNDS_FOR_INSEAM: usize = 6;

/// And, where no girth is given, the mass.
const MASS_TOLERANCE: f64 = 8e-3;

/// What is varied to meet the measures: the logarithms of the corrections of the girths and of the
/// body mass index that the girths are predicted from.
type Unknowns = SVector<f64, NUM_UNKNOWNS>;
const NUM_GIRTHS: usize = Measure::GIRTHS.len();
const BMI: usize = NUM_GIRTHS;
const NUM_UNKNOWNS: usize = NUM_GIRTHS + 1;

/// A girth changes by less than this in one round, as a logarithm.
const MAX_CHANGE: f64 = 0.15;

/// Corrections beyond this would not look like a body, as a logarithm.
const MAX_CORRECTION: f64 = 0.6;

/// The crotch moves by this share of its error in one round, and by no more than this in all, in
/// metres.
const CROTCH_GAIN: f64 = 0.7;
const MAX_CROTCH_CORRECTION: f64 = 0.03;

/// A candidate on the way to the right measures.
#[derive(Debug)]
pub(super) struct Trial {
    pub(super) surface: BodySurface,
    pub(super) positions: Vec<Vec3>,
    pub(super) measures: Measures,
    pub(super) volume: f64,
    carried: Carried,
}

impl Trial {
    fn new(surface: BodySurface, carried: Carried) -> Self {
        let template = Template::stored();
        let positions = template.whole(&carried.positions, |p| Vec3::new(-p.x, p.y, p.z));
        let joints: Vec<Vec3> = surface
            .joints()
            .iter()
            .map(|joint| joint.rest_position.coords.cast())
            .collect();
        Self {
            measures: tape::measured(
                &positions,
                &template.faces,
                &shared().arm_share,
                template.num_middle,
                &joints,
            ),
            volume: tape::volume(&positions, &template.faces),
            surface,
            positions,
            carried,
        }
    }

    /// Pairs of faces that intersect.
    fn intersections(&self) -> Vec<[u32; 2]> {
        Surface::new(&mesh(&self.positions)).self_intersections()
    }

    /// How far the crotch is too low, in metres.
    fn rise(&self) -> f64 {
        self.surface.anatomy.measures[Measure::Inseam] - self.measures[Measure::Inseam]
    }

    /// How far a girth is off, relative to what it shall be.
    pub(super) fn error(&self, measure: Measure) -> f64 {
        self.measures[measure] / self.surface.anatomy.measures[measure] - 1.0
    }
}

/// The body that measures what is asked for, as nearly as its parameters allow, and is free of
/// self-intersections.
///
/// The template is carried to the first surface and evened out once; from then on it follows the
/// small changes of the surface from round to round.
pub(super) fn fitted(parameters: &BodyParameters) -> Result<Trial, ShapeError> {
    let carrier = &shared().carrier;
    let mut fit = Fit::new(parameters);
    let surface = fit.surface();
    let carried = carrier.start(&surface);
    let near = fit.refined(
        Trial::new(surface, carried),
        &[],
        MAX_ROUGH_ROUNDS,
        [ROUGH_TOLERANCE, MASS_TOLERANCE],
    );
    let (surface, mut carried) = (near.surface, near.carried);
    carrier.even_out(&mut carried, &surface);
    let tolerances = [GIRTH_TOLERANCE, MASS_TOLERANCE];
    let mut trial = fit.refined(Trial::new(surface, carried), &[], MAX_ROUNDS, tolerances);
    let mut all_folded = Vec::new();
    for unfolding in 0..=MAX_UNFOLDINGS {
        let pairs = trial.intersections();
        if pairs.is_empty() {
            return Ok(trial);
        }
        if unfolding == MAX_UNFOLDINGS {
            return Err(ShapeError::SelfIntersecting { pairs: pairs.len() });
        }
        let faces = &Template::stored().faces;
        all_folded.extend(
            pairs
                .iter()
                .flatten()
                .flat_map(|&face| faces[face as usize]),
        );
        let spread = carrier.surroundings(&all_folded, FIRST_RINGS + unfolding);
        let is_lifted = unfolding >= UNFOLDINGS_ON_SURFACE;
        let (surface, mut carried) = (trial.surface, trial.carried);
        carrier.unfold(&mut carried, &surface, &spread, is_lifted);
        let lifted = if is_lifted { &spread[..] } else { &[] };
        trial = fit.refined(
            Trial::new(surface, carried),
            lifted,
            ROUNDS_AFTER_UNFOLDING,
            tolerances,
        );
    }
    unreachable!("the last round returns")
}

/// The unknowns and what was learned of them.
///
/// Where no girth is given, the mass matters more than the likely girths: then the body mass index
/// that the girths are predicted from is varied until the mesh has the mass.
struct Fit {
    parameters: BodyParameters,
    /// The body mass index that the girths are predicted from.
    bmi: Option<f64>,
    /// What the body shall weigh, if no girth says so.
    mass: Option<f64>,
    unknowns: Unknowns,
    /// What is added to the height of the crotch, in metres. The mesh may have no room for it
    /// between the thighs, so that it is no unknown that others could lean on.
    crotch: f64,
    /// Errors over unknowns.
    slopes: SMatrix<f64, NUM_UNKNOWNS, NUM_UNKNOWNS>,
}

impl Fit {
    fn new(parameters: &BodyParameters) -> Self {
        let likely = parameters.completed(parameters.bmi());
        let mass = likely.expected(Dimension::Mass);
        let stature = likely.expected(Dimension::Stature);
        let meets_mass = !parameters.has_girth();
        Self {
            bmi: if meets_mass {
                Some(mass / stature.powi(2))
            } else {
                parameters.bmi()
            },
            mass: meets_mass.then_some(mass),
            parameters: parameters.clone().with(Measure::Stature, stature),
            unknowns: Unknowns::zeros(),
            crotch: 0.0,
            slopes: SMatrix::identity(),
        }
    }

    /// The surface of the unknowns.
    fn surface(&self) -> BodySurface {
        let mut corrections = Corrections::default();
        for (measure, value) in Measure::GIRTHS.into_iter().zip(self.unknowns.iter()) {
            corrections[measure] = value.exp();
        }
        corrections.crotch = self.crotch;
        let shift = self.unknowns[BMI].exp();
        let body = self.parameters.completed(self.bmi.map(|bmi| bmi * shift));
        BodySurface::of(Anatomy::new(self.parameters.sex(), &body, corrections))
    }

    /// Logarithms of what is measured over what shall be.
    fn errors(&self, trial: &Trial) -> Unknowns {
        let mut errors = Unknowns::zeros();
        for (place, measure) in Measure::GIRTHS.into_iter().enumerate() {
            errors[place] = (1.0 + trial.error(measure)).max(0.1).ln();
        }
        if let Some(mass) = self.mass {
            errors[BMI] = (trial.volume * BODY_DENSITY / mass).ln();
        }
        errors
    }

    /// The best of some rounds from `trial` on; `lifted` are vertices of the half that need not lie
    /// on the surface.
    fn refined(
        &mut self,
        trial: Trial,
        lifted: &[usize],
        rounds: usize,
        [girth_tolerance, mass_tolerance]: [f64; 2],
    ) -> Trial {
        let carrier = &shared().carrier;
        let mut errors = self.errors(&trial);
        let badness = |errors: &Unknowns, rise: f64| {
            errors.rows(0, NUM_GIRTHS).amax() + 0.2 * errors[BMI].abs() + 0.02 * rise.abs()
        };
        let is_met = |errors: &Unknowns, rise: f64, round: usize| {
            errors.rows(0, NUM_GIRTHS).amax() < girth_tolerance
                && errors[BMI].abs() < mass_tolerance
                && (rise.abs() < INSEAM_TOLERANCE || round >= ROUNDS_FOR_INSEAM)
        };
        let mut rise = trial.rise();
        let mut best = (badness(&errors, rise), self.unknowns, self.crotch);
        let mut best_trial = trial;
        let mut carried = best_trial.carried.clone();
        for round in 0..rounds {
            if is_met(&errors, rise, round) {
                break;
            }
            let before = self.unknowns;
            self.advance(&errors);
            if round < ROUNDS_FOR_INSEAM {
                self.crotch = (self.crotch + CROTCH_GAIN * rise)
                    .clamp(-MAX_CROTCH_CORRECTION, MAX_CROTCH_CORRECTION);
            }
            let surface = self.surface();
            carrier.follow(&mut carried, &surface);
            if !lifted.is_empty() {
                carrier.lift_off(&mut carried, lifted);
            }
            let trial = Trial::new(surface, carried.clone());
            let new_errors = self.errors(&trial);
            self.learn(&(self.unknowns - before), &(new_errors - errors));
            errors = new_errors;
            rise = trial.rise();
            if badness(&errors, rise) < best.0 {
                best = (badness(&errors, rise), self.unknowns, self.crotch);
                best_trial = trial;
            }
        }
        (_, self.unknowns, self.crotch) = best;
        best_trial
    }

    /// Takes a step towards no errors.
    fn advance(&mut self, errors: &Unknowns) {
        let step = self.slopes.lu().solve(errors).unwrap_or(*errors);
        self.unknowns = (self.unknowns - step.map(|value| value.clamp(-MAX_CHANGE, MAX_CHANGE)))
            .map(|value| value.clamp(-MAX_CORRECTION, MAX_CORRECTION));
    }

    /// Learns from what a step has changed: Broyden 1965.
    fn learn(&mut self, step: &Unknowns, change: &Unknowns) {
        let surprise = change - self.slopes * step;
        let updated = self.slopes + surprise * step.transpose() / step.norm_squared().max(1e-12);
        // A girth that grows when it is corrected downwards is an accident of the others.
        if updated.diagonal().min() > 0.3 {
            self.slopes = updated;
        }
    }
}
