//! A garment on a body, brought into balance.

use std::ops::ControlFlow;
use std::sync::{Mutex, MutexGuard, PoisonError};

use nalgebra::Vector3;

use super::obstacle::{Nearest, Nothing, Obstacle, exactly};
use super::options::ReferenceOptions;
use super::settle::Settled;
use super::solver::Reference;
use crate::contact::{Contacts, Grounds, Skin};
use crate::layers::Layers;
use crate::{Point3, Scene, Schedule, SelfContact, SimError};

/// Largest force left over on a vertex, over the mean weight of a vertex.
const TOLERANCE: f64 = 0.01;

/// Newton iterations of a step.
const MAX_ITERATIONS: usize = 20;

/// Stiffness of contact, N/m a vertex: cloth that is pulled tight over a shoulder sinks by a tenth
/// of a millimetre.
const CONTACT_STIFFNESS: f64 = 5000.0;

/// One of so many vertices may be held in creases of the skin.
const VERTICES_A_CREASE: usize = 100;

/// How a drape was brought into balance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    /// How it ended.
    pub settled: Settled,
    /// Vertices that were held where they lay: caught between two parts of the body, or in a
    /// crease.
    pub held: usize,
    /// How far the vertices moved in the mean, in metres.
    pub moved: f64,
}

/// The skin under a garment: of all of it each vertex sees that alone on which the production
/// solver holds it, and what is around.
struct Under<'a>(Mutex<Grounds<'a>>);

impl<'a> Under<'a> {
    fn grounds(&self) -> MutexGuard<'_, Grounds<'a>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Obstacle for Under<'_> {
    fn follow(&self, places: &[Vector3<f64>]) {
        self.grounds().follow(&rounded(places));
    }

    fn nearest(&self, vertex: usize, place: &Vector3<f64>, reach: f64) -> Option<Nearest> {
        let grounds = self.grounds();
        let surface = grounds.skin().surface();
        let point = Point3::from(place.cast::<f32>());
        let is_under = |face: u32| grounds.is_under(vertex, face);
        let closest = surface.closest_where(point, reach as f32, is_under)?;
        exactly(surface, &closest, place, reach)
    }
}

fn rounded(places: &[Vector3<f64>]) -> Vec<Point3> {
    let places = places.iter();
    places
        .map(|place| Point3::from(place.cast::<f32>()))
        .collect()
}

/// Brings a garment into balance from where the production solver has left it, on skin that stands
/// still.
///
/// Vertices that are caught between two parts of the body stay where they are: what holds them
/// there is no force. `observer` is told the steps that are done and the residual, and may break
/// off.
pub(crate) fn balance(
    scene: &Scene<'_>,
    schedule: &Schedule,
    ground: Option<(&Skin, Contacts)>,
    positions: &[Point3],
    observer: &mut dyn FnMut(usize, f64) -> ControlFlow<()>,
) -> Result<(Vec<Point3>, Balance), SimError> {
    let cloth = scene.cloth;
    let options = ReferenceOptions {
        gravity: Vector3::new(0.0, -f64::from(schedule.gravity), 0.0),
        tolerance: TOLERANCE,
        max_iterations: MAX_ITERATIONS,
        contact_stiffness: CONTACT_STIFFNESS,
        max_creased: cloth.num_vertices() / VERTICES_A_CREASE,
        max_steps: schedule.balance_steps as usize,
        ..ReferenceOptions::default()
    };
    let grounds = ground.map(|(skin, contacts)| Grounds::new(cloth, skin, contacts));
    let under = grounds.map(|grounds| Under(Mutex::new(grounds)));
    let obstacle = under
        .as_ref()
        .map_or(&Nothing as &dyn Obstacle, |under| under);
    let mut reference = Reference::new(cloth, positions, obstacle, options)?;
    let num_pinned = reference.num_held();
    if let SelfContact::Repulsion { distance, least } = schedule.self_contact {
        reference.keep_layers(Layers::new(cloth, scene.start, distance, least));
    }
    if let Some(under) = &under {
        let grounds = under.grounds();
        reference.hold(|vertex| grounds.is_caught(vertex));
        reference.scale_friction(|vertex| grounds.grip(vertex).into());
    }
    let settled = reference.settle_watched(observer)?;
    let balanced = rounded(reference.positions());
    let moves = positions.iter().zip(&balanced);
    let moved: f64 = moves.map(|(from, to)| f64::from((to - from).norm())).sum();
    let balance = Balance {
        settled,
        held: reference.num_held() - num_pinned,
        moved: moved / positions.len().max(1) as f64,
    };
    Ok((balanced, balance))
}
