//! Bodies: the template on the surface of its measures, with a skeleton and weights.

use std::sync::OnceLock;

use garnet_mesh::{Point3, TriMesh};
use garnet_skin::{Body, SkinWeights};
use nalgebra::Isometry3;

use super::carry::Carrier;
use super::fit::fitted;
use super::measure::Measures;
use super::primitives::Vec3;
use super::surface::BodySurface;
use super::tape::{self, BODY_DENSITY};
use super::tape_on::own_frame;
use super::template::Template;
use super::{BodyParameters, NUM_JOINTS, ShapeError};

/// A given girth that is farther off than this cannot be had together with the others, relative.
const CONFLICT_TOLERANCE: f64 = 5e-3;

/// What does not depend on the body.
pub(super) struct Shared {
    pub(super) carrier: Carrier,
    /// How much of each vertex of the whole is arm.
    pub(super) arm_share: Vec<f64>,
    pub(super) weights: SkinWeights,
}

pub(super) fn shared() -> &'static Shared {
    static SHARED: OnceLock<Shared> = OnceLock::new();
    SHARED.get_or_init(|| {
        let template = Template::stored();
        Shared {
            carrier: Carrier::new(template, &BodySurface::template()),
            arm_share: template.arm_share(),
            weights: SkinWeights::from_influences(NUM_JOINTS, template.influences())
                .expect("the stored weights are weights"),
        }
    })
}

/// A body built from measures: mesh, skeleton and weights.
///
/// All bodies share one topology, in which vertices correspond. At rest the body stands on the
/// floor `y = 0` and looks to `+z`, arms 45° down and legs apart.
///
/// ```
/// use garnet_body::shape::{BodyParameters, Measure, ParametricBody};
///
/// let parameters = BodyParameters::new(1.0)
///     .with(Measure::Stature, 1.70)
///     .with(Measure::Waist, 0.78)
///     .with(Measure::Hip, 1.00);
/// let body = ParametricBody::build(&parameters)?;
/// assert!((body.measures()[Measure::Waist] - 0.78).abs() < 0.005 * 0.78);
/// # Ok::<(), garnet_body::shape::ShapeError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ParametricBody {
    body: Body,
    measures: Measures,
    volume: f64,
}

pub(super) fn mesh(positions: &[Vec3]) -> TriMesh {
    let single = positions.iter().map(|p| Point3::from(p.cast::<f32>()));
    TriMesh::new(single.collect(), Template::stored().faces.clone())
        .expect("the template is a mesh")
}

impl ParametricBody {
    /// Builds the body of these parameters; what they leave open is what is most likely.
    ///
    /// # Errors
    ///
    /// Those of [`BodyParameters::check`], [`ShapeError::MeasuresConflict`] and
    /// [`ShapeError::SelfIntersecting`].
    ///
    /// # Panics
    ///
    /// Never: the stored template is a mesh with a weight for every vertex.
    pub fn build(parameters: &BodyParameters) -> Result<Self, ShapeError> {
        parameters.check()?;
        let trial = fitted(parameters)?;
        for (measure, value) in parameters.given().filter(|(measure, _)| measure.is_girth()) {
            if trial.error(measure).abs() > CONFLICT_TOLERANCE {
                return Err(ShapeError::MeasuresConflict {
                    measure,
                    value_cm: 100.0 * value,
                    closest_cm: 100.0 * trial.measures[measure],
                });
            }
        }
        let body = Body::new(
            mesh(&trial.positions),
            trial.surface.skeleton(),
            shared().weights.clone(),
        )
        .expect("the template has a weight for every vertex");
        Ok(Self {
            body,
            measures: trial.measures,
            volume: trial.volume,
        })
    }

    /// Mesh, skeleton and weights.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// Mesh, skeleton and weights, without the rest.
    pub fn into_body(self) -> Body {
        self.body
    }

    /// What the tape measures on the mesh, in metres.
    pub fn measures(&self) -> &Measures {
        &self.measures
    }

    /// The volume, in m³.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// The mass at [`BODY_DENSITY`], in kg.
    pub fn mass(&self) -> f64 {
        BODY_DENSITY * self.volume
    }

    /// The faces of the coarse level, of about 1,700 vertices, in numbers of its vertices.
    pub fn coarse_faces() -> &'static [[u32; 3]] {
        &Template::stored().coarse_faces
    }

    /// The vertex of the body that each vertex of the coarse level is.
    pub fn coarse_vertices() -> &'static [u32] {
        &Template::stored().coarse_vertices
    }

    /// The coarse level of a body whose vertices are at `positions`, in rest or in a pose.
    ///
    /// # Panics
    ///
    /// If `positions` are not those of a built-in body.
    pub fn coarse(positions: &[Point3]) -> TriMesh {
        let vertices = Self::coarse_vertices().iter();
        let kept = vertices.map(|&vertex| positions[vertex as usize]).collect();
        TriMesh::new(kept, Self::coarse_faces().to_vec()).expect("the coarse level is a mesh")
    }
}

/// What the tape measures on a body at rest, wherever it stands and faces, if it has the built-in
/// topology and joints.
pub fn tape_measures(body: &Body) -> Option<Measures> {
    let template = Template::stored();
    if body.rest().faces() != template.faces || body.skeleton().num_joints() != NUM_JOINTS {
        return None;
    }
    let joints = body.skeleton().joints().iter();
    let mut joints: Vec<Vec3> = joints
        .map(|joint| joint.rest_position.coords.cast())
        .collect();
    let mut positions = tape::doubled(body.rest().positions());
    let own = own_frame(&positions, &joints);
    if own != Isometry3::identity() {
        for place in positions.iter_mut().chain(&mut joints) {
            *place = (own * nalgebra::Point3::from(*place)).coords;
        }
    }
    Some(tape::measured(
        &positions,
        &template.faces,
        &shared().arm_share,
        template.num_middle,
        &joints,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Measure, Population};

    /// Bars of the built-in body: girths relative, stature and gap in metres, mass relative.
    const MAX_GIRTH_ERROR: f64 = 0.005;
    const MAX_STATURE_ERROR: f64 = 0.002;
    const MAX_MASS_ERROR: f64 = 0.04;
    const MIN_THIGH_GAP: f64 = 0.010;

    fn corners_of_the_range() -> Vec<BodyParameters> {
        let mut bodies = Vec::new();
        for sex in [0.0, 0.5, 1.0] {
            for (stature, bmi) in [(1.52, 19.0), (1.65, 32.0), (1.75, 24.0), (1.92, 21.0)] {
                bodies.push(
                    BodyParameters::new(sex)
                        .with(Measure::Stature, stature)
                        .with_bmi(bmi),
                );
            }
        }
        bodies
    }

    #[test]
    fn bodies_are_closed_well_shaped_and_free_of_self_intersections() {
        for parameters in corners_of_the_range() {
            let built = ParametricBody::build(&parameters).unwrap();
            let body = built.body();
            assert!(
                garnet_mesh::diagnose(body.rest()).is_clean(),
                "{parameters:?}"
            );
            assert!(body.skin().is_closed(), "{parameters:?}");
            assert_eq!(
                body.skin().self_intersections(),
                Vec::<[u32; 2]>::new(),
                "{parameters:?}"
            );
            for joint in body.skeleton().joints() {
                assert!(
                    body.skin().contains(joint.rest_position),
                    "{} of {parameters:?}",
                    joint.name
                );
            }
        }
    }

    #[test]
    fn without_girths_a_body_has_its_stature_its_mass_and_room_between_the_thighs() {
        for parameters in corners_of_the_range() {
            let built = ParametricBody::build(&parameters).unwrap();
            let stature = parameters.measure(Measure::Stature).unwrap();
            let mass = parameters.bmi().unwrap() * stature.powi(2);
            assert!((built.measures()[Measure::Stature] - stature).abs() < MAX_STATURE_ERROR);
            assert!(
                (built.mass() / mass - 1.0).abs() < MAX_MASS_ERROR,
                "{parameters:?}"
            );
            let below = built.measures()[Measure::Inseam] - 0.03;
            let positions = built.body().rest().positions().iter();
            let legs = positions.filter(|point| f64::from(point.y) < below);
            let gap = legs
                .map(|point| 2.0 * f64::from(point.x).abs())
                .fold(f64::MAX, f64::min);
            assert!(gap > MIN_THIGH_GAP, "{gap} of {parameters:?}");
        }
    }

    #[test]
    fn given_girths_are_measured_on_the_mesh() {
        let population = Population::new(5);
        for index in 0..6 {
            let parameters = population.sample(index);
            let built = ParametricBody::build(&parameters).unwrap();
            for (measure, value) in parameters.given().filter(|(measure, _)| measure.is_girth()) {
                let error = (built.measures()[measure] / value - 1.0).abs();
                assert!(error < MAX_GIRTH_ERROR, "{measure} of {index}: {error}");
            }
            let again = tape_measures(built.body()).unwrap();
            for (measure, value) in built.measures().iter() {
                approx::assert_relative_eq!(again[measure], value, max_relative = 1e-4);
            }
        }
    }

    #[test]
    fn a_body_whose_skin_stays_folded_is_refused() {
        // A huge belly over legs that are far too long for the trunk.
        let parameters = BodyParameters::new(0.0)
            .with(Measure::Stature, 1.65)
            .with(Measure::Inseam, 0.877)
            .with(Measure::UnderBust, 1.406)
            .with(Measure::Waist, 1.478);
        let error = ParametricBody::build(&parameters).err().unwrap();
        assert!(
            matches!(error, ShapeError::SelfIntersecting { pairs } if pairs > 0),
            "{error}"
        );
        assert!(error.to_string().contains("pairs of faces"));
    }

    #[test]
    fn an_upper_arm_stays_round_where_the_armpit_reaches_its_tape() {
        let heavy = BodyParameters::new(0.0)
            .with(Measure::Stature, 1.80)
            .with_bmi(36.0);
        let body = ParametricBody::build(&heavy).unwrap().into_body();
        let at = |name: &str| {
            let joint = body.skeleton().find(name).unwrap();
            body.skeleton().joints()[joint].rest_position
        };
        let [shoulder, elbow] = ["left_shoulder", "left_elbow"].map(at);
        let bone = elbow - shoulder;
        // The least distance of the skin from the bone, between armpit and elbow.
        let radius = |share: f32| {
            let center = shoulder + share * bone;
            let skin = body.skin().closest(center);
            skin.distance_squared.sqrt()
        };
        let [middle, below] = [0.55, 0.75].map(radius);
        assert!(middle > 0.95 * below, "{middle} {below}");
    }

    #[test]
    fn changing_one_girth_leaves_the_others() {
        const STEP: f64 = 1.02;
        const MAX_MOVEMENT: f64 = 0.01;
        let all_of = |built: &ParametricBody| {
            let measures = built.measures().iter();
            measures.fold(BodyParameters::new(1.0), |known, (measure, value)| {
                known.with(measure, value)
            })
        };
        let parameters = Population::new(3).sample(1);
        let base = all_of(&ParametricBody::build(&parameters).unwrap());
        let before = ParametricBody::build(&base).unwrap();
        for girth in Measure::GIRTHS {
            let value = STEP * base.measure(girth).unwrap();
            let after = ParametricBody::build(&base.clone().with(girth, value)).unwrap();
            for (other, old) in before.measures().iter() {
                let change = (after.measures()[other] / old - 1.0).abs();
                let is_kept = change < MAX_MOVEMENT || other == girth;
                assert!(is_kept, "{other} moves by {change} with {girth}");
            }
        }
    }

    #[test]
    fn the_same_parameters_give_the_same_bytes() {
        let parameters = BodyParameters::new(0.3).with_bmi(27.0);
        let [first, second] = [0; 2].map(|_| ParametricBody::build(&parameters).unwrap());
        assert_eq!(
            first.body().rest().positions(),
            second.body().rest().positions()
        );
    }

    #[test]
    fn the_coarse_level_is_a_closed_mesh_of_some_of_the_vertices() {
        let built = ParametricBody::build(&BodyParameters::new(1.0)).unwrap();
        let coarse = ParametricBody::coarse(built.body().rest().positions());
        assert!((1500..1900).contains(&coarse.num_vertices()));
        assert!(garnet_mesh::diagnose(&coarse).is_clean());
    }

    #[test]
    fn a_body_is_the_mirror_image_of_itself() {
        let built = ParametricBody::build(&BodyParameters::new(0.0)).unwrap();
        let template = Template::stored();
        let positions = built.body().rest().positions();
        for (left, right) in (template.num_middle..template.half.len()).zip(template.half.len()..) {
            let (left, right) = (positions[left], positions[right]);
            assert_eq!(Point3::new(-left.x, left.y, left.z), right);
        }
    }
}
