//! The production solver: XPBD in small steps on a moving skin.

use crate::contact::{Contacts, Interval, Skin};
use crate::layers::Layers;
use crate::xpbd::Projection;
use crate::xpbd::pairs::Pairs;
use crate::xpbd::particles::{Particles, Push};
use crate::xpbd::patch::Pace;
use crate::xpbd::patchwork::Patchwork;
use crate::xpbd::quad::Quad;
use crate::{Cloth, MovingCloth, Point3, Scene, Schedule, SelfContact, SimError, Stage, Vector3};

/// The state of one run.
#[derive(Debug)]
pub(crate) struct Solver<'a> {
    cloth: &'a Cloth,
    schedule: &'a Schedule,
    inverse_masses: Vec<f32>,
    particles: Particles,
    /// The same in patches, from a refresh to the next.
    patchwork: Patchwork,
    contacts: Contacts,
    pairs: Option<Pairs>,
    /// Lengths of the springs at the start, m; empty if they do not matter.
    start_lengths: Vec<f32>,
    center: Vector3,
    /// Length of a substep, in seconds, and how many there are from one refresh to the next.
    step: f32,
    num_substeps: u32,
    /// Displacement of the air next to each vertex a substep, m, and the share of its velocity
    /// against it that the vertex loses; empty if it stands still.
    wind: Vec<Quad>,
    /// Velocity lost to air that stands still, 1/s.
    drag: f32,
    /// Share of the friction against skin that acts.
    friction_share: f32,
    may_change: bool,
    /// Substeps since the stage began.
    substep: u32,
    /// Refreshes since the start.
    refresh: u32,
}

/// Garments this far from where they started are lost, in metres.
const LOST: f32 = 100.0;

impl Drop for Solver<'_> {
    fn drop(&mut self) {
        (self.cloth.spare()).leave(std::mem::take(&mut self.patchwork));
    }
}

impl<'a> Solver<'a> {
    pub(crate) fn new(scene: &Scene<'a>, schedule: &'a Schedule) -> Self {
        let cloth = scene.cloth;
        let start_lengths = if schedule.contraction_frames == 0 {
            Vec::new()
        } else {
            let length =
                |[a, b]: [u32; 2]| (scene.start[a as usize] - scene.start[b as usize]).norm();
            cloth
                .springs()
                .iter()
                .map(|spring| length(spring.vertices))
                .collect()
        };
        let particles = Particles::new(cloth, scene.start);
        let left = cloth.spare().take(schedule.patches);
        let mut patchwork =
            left.unwrap_or_else(|| Patchwork::new(cloth, &particles, schedule.patches));
        let share = schedule.length_share;
        patchwork.set_lengths(|spring| share * cloth.springs()[spring].rest_length);
        let sum: nalgebra::Vector3<f64> = scene.start.iter().map(|p| p.coords.cast::<f64>()).sum();
        Self {
            cloth,
            schedule,
            inverse_masses: cloth.inverse_masses(),
            particles,
            patchwork,
            contacts: Contacts::new(
                scene.masks(),
                cloth.grips(),
                cloth.fabric().thickness,
                scene.body.and_then(|body| body.likely_faces),
            ),
            pairs: match schedule.self_contact {
                SelfContact::Off => None,
                SelfContact::Repulsion { distance, least } => {
                    Some(Pairs::new(Layers::new(cloth, scene.start, distance, least)))
                }
            },
            start_lengths,
            center: (sum / scene.start.len().max(1) as f64).cast(),
            step: 0.0,
            num_substeps: 1,
            wind: Vec::new(),
            drag: schedule.drag,
            friction_share: 1.0,
            may_change: true,
            substep: 0,
            refresh: 0,
        }
    }

    pub(crate) fn positions(&self) -> Vec<Point3> {
        self.particles.positions()
    }

    /// What holds the cloth on the skin.
    pub(crate) fn contacts(&self) -> &Contacts {
        &self.contacts
    }

    /// From now on vertices near the skin stay on the skin that they are on.
    pub(crate) fn keep_contacts(&mut self) {
        self.may_change = false;
    }

    /// Begins a stage; its number of frames is the caller's.
    pub(crate) fn begin_stage(&mut self, stage: Stage) {
        let refreshes = self.schedule.refreshes_per_frame;
        self.num_substeps = self.schedule.substeps(stage.rate);
        let step = self.schedule.frame_seconds / (self.num_substeps * refreshes) as f32;
        if self.step > 0.0 {
            self.particles.rescale(step / self.step);
        }
        self.step = step;
        self.drag = self.schedule.drag + stage.extra_drag;
        self.friction_share = stage.friction;
        self.substep = 0;
        let projection = Projection {
            step,
            over_relaxation: self.schedule.over_relaxation,
            bending_interval: self.schedule.bending_interval,
        };
        self.patchwork
            .set_projection(self.cloth, &self.inverse_masses, projection);
    }

    /// Lets the air move by so much in the next frame around cloth so loose `[vertex]`, in metres;
    /// not at all if empty.
    pub(crate) fn set_wind(&mut self, of_frame: &[(Vector3, f32)]) {
        let per_frame = self.num_substeps * self.schedule.refreshes_per_frame;
        let rate = self.schedule.carry * self.step;
        self.wind.clear();
        self.wind.extend(of_frame.iter().map(|(wind, looseness)| {
            Quad::new(wind / per_frame as f32, 1.0 - (-looseness * rate).exp())
        }));
    }

    /// Gives the cloth the velocity of the air that goes along with the body, where that is known.
    pub(crate) fn set_off(&mut self) {
        self.particles.set_off(&self.wind);
    }

    /// Goes on from cloth as it was left, or from rest with the velocity of the air.
    pub(crate) fn take_up(&mut self, from: &MovingCloth) {
        self.particles.put(&from.positions);
        let sum: nalgebra::Vector3<f64> = (from.positions.iter())
            .map(|p| p.coords.cast::<f64>())
            .sum();
        self.center = (sum / from.positions.len().max(1) as f64).cast();
        if from.velocities.is_empty() {
            self.particles.set_off(&self.wind);
        } else {
            self.particles.set_velocities(&from.velocities, self.step);
        }
        if !from.faces.is_empty() {
            self.contacts.take_up(&from.faces);
        }
    }

    /// The cloth as it is left for the next stretch.
    pub(crate) fn left(&self) -> MovingCloth {
        MovingCloth {
            positions: self.particles.positions(),
            velocities: self.particles.velocities(self.step),
            faces: self.contacts.own_faces(),
        }
    }

    /// Looks for contacts anew. `frame` counts from the start of the run.
    pub(crate) fn refresh(&mut self, skin: Option<&Skin>, frame: u64) {
        self.particles.rebase();
        self.contract(frame);
        let interval = Interval {
            step: self.step,
            max_push_speed: self.schedule.max_push_speed,
            num_substeps: self.num_substeps,
            friction: self.cloth.fabric().friction,
            friction_share: self.friction_share,
            may_change: self.may_change,
        };
        let (faces, particles) = (self.cloth.faces(), &self.particles);
        let (contacts, pairs) = (&mut self.contacts, &mut self.pairs);
        let looks_for_pairs = self.refresh.is_multiple_of(self.schedule.pair_interval);
        self.refresh += 1;
        let mut pairs = pairs.as_mut().filter(|_| looks_for_pairs);
        rayon::join(
            || skin.map(|skin| contacts.refresh(skin, faces, particles, interval)),
            || pairs.as_mut().map(|pairs| pairs.sort(particles)),
        );
        if let Some(pairs) = pairs {
            let max_rise = self.schedule.max_push_speed * self.step;
            let is_out = &self.contacts.is_squeezed;
            pairs.refresh(is_out, max_rise, self.num_substeps);
        }
        let pairs = self.pairs.as_ref().map_or(&[][..], Pairs::near);
        let planes = &self.contacts.planes;
        (self.patchwork).load(&self.particles, &self.wind, pairs, planes);
    }

    /// Sets rest lengths on their way from the start to those of the cloth.
    fn contract(&mut self, frame: u64) {
        let num_frames = u64::from(self.schedule.contraction_frames);
        if frame <= num_frames && !self.start_lengths.is_empty() {
            let share = frame as f32 / num_frames as f32;
            let (start, springs) = (&self.start_lengths, self.cloth.springs());
            let length_share = self.schedule.length_share;
            self.patchwork.set_lengths(|spring| {
                let end = length_share * springs[spring].rest_length;
                start[spring] + (end - start[spring]) * share
            });
        }
    }

    /// Whether each vertex lay where the body has no room for it when the contacts were refreshed
    /// last `[vertex]`.
    pub(crate) fn is_squeezed(&self) -> &[bool] {
        &self.contacts.is_squeezed
    }

    /// Takes the substeps from a refresh to the next; another thread, if there is one, does
    /// something else meanwhile.
    pub(crate) fn step(&mut self, meanwhile: impl FnOnce() + Send) {
        let (schedule, step) = (self.schedule, self.step);
        let pace = Pace {
            push: Push {
                gravity: schedule.gravity * step * step,
                keep: (-self.drag * step).exp(),
                max_travel: schedule.max_speed * step,
            },
            friction: self.cloth.fabric().friction,
            bending_interval: schedule.bending_interval,
        };
        (self.patchwork).step(self.num_substeps, self.substep, &pace, meanwhile);
        self.substep += self.num_substeps;
        self.patchwork.store(&mut self.particles);
    }

    /// Refuses to go on with a garment that is nowhere.
    pub(crate) fn check(&self, seconds: f32) -> Result<(), SimError> {
        match self.particles.first_lost(self.center, LOST) {
            None => Ok(()),
            Some(vertex) => Err(SimError::Exploded {
                vertex,
                at: self.particles.position(vertex),
                seconds,
            }),
        }
    }
}
