//! From files to values in metres: the garment, the rest body, and the targets.

use std::{path::Path, sync::Arc};

use anyhow::Context;
use garnet::{
    Body, Garment, TriMesh,
    body::shape::tape_measures,
    drape::Refit,
    io::{Frame, MotionOptions, ObjFile, PoseSource, RestSource, Scene, Target},
    package::GarmentPackage,
};

use crate::input;

use super::{
    args::{Source, SourceFiles},
    tailored::{Cut, Tailoring, stand_in_at_rest},
    warning::Warning,
};

/// All that a drape starts from, in metres with y up.
#[derive(Debug)]
pub(crate) struct Prepared {
    pub(crate) garment_file: ObjFile,
    pub(crate) garment_frame: Frame,
    pub(crate) garment: TriMesh,
    /// How the garment came to the body, if it was made for another one.
    pub(crate) refit: Option<Refit>,
    pub(crate) rest: RestSource,
    pub(crate) body: Body,
    pub(crate) targets: Vec<Target>,
    pub(crate) pose: Option<PoseSource>,
    /// Where its motion goes.
    pub(crate) motion: MotionOptions,
    /// Seconds from each target to the next, if they are frames of a motion that says.
    pub(crate) frame_time: Option<f64>,
    /// What was taken for granted while poses were read.
    pub(crate) notes: Vec<String>,
    /// How the garment is to be cut for each wearer.
    pub(super) tailoring: Option<Tailoring>,
    /// Whether `body` is another one than that of the package, on which the garment does not lie.
    pub(super) is_on_other: bool,
    /// Whether the unit of the body was named, and not detected.
    pub(super) is_unit_named: bool,
    /// The garment as it was cut for its wearer.
    pub(super) cut: Option<Arc<Cut>>,
    /// Whether it is cut to the measures of its wearer, and no otherwise.
    pub(super) is_made_for_wearer: bool,
    /// What is wrong already.
    pub(super) warnings: Vec<Warning>,
}

impl Prepared {
    /// Reads the files and brings them together.
    pub(crate) fn read(source: &Source) -> anyhow::Result<Self> {
        let mut tailoring = Tailoring::of(source)?;
        match source {
            Source::Scene(path) => Ok(Self::of(
                Scene::read(path)?,
                None,
                None,
                MotionOptions::default(),
            )),
            Source::Files(source) => {
                if source.package.is_some() {
                    input::check_regular(&source.scene.garment)?;
                }
                let mut scene = Scene::load(&source.scene)?;
                if let Some(folder) = &source.package {
                    check_template(folder, &scene)?;
                }
                let own = scene.own.take();
                let is_measured = own.is_none() || tape_measures(&scene.body).is_some();
                let is_to_measure = tailoring.as_ref().is_some_and(Tailoring::is_to_measure);
                let is_on_other = own.is_some() && is_measured && is_to_measure;
                let own = own.filter(|_| !is_on_other);
                let mut refit = None;
                let mut cut = None;
                if let Some(mut own) = own {
                    let asked = tailoring
                        .take_if(|tailoring| tailoring.is_asked_for() || tailoring.is_to_measure());
                    if let Some(mut asked) = asked {
                        let wearer = if tape_measures(&scene.body).is_some() {
                            Some(scene.body.clone())
                        } else if asked.is_chosen() || asked.is_to_measure() {
                            let fitted = refitted(source, &scene, &own)?;
                            Some(stand_in_at_rest(&fitted, &scene.body)?)
                        } else {
                            None
                        };
                        let made = asked.cut_for(wearer.as_ref(), &scene.rest.path)?;
                        scene.garment.mesh = made.package.mesh.clone();
                        own = made.package.body.clone();
                        cut = Some(Arc::new(made));
                    }
                    let fitted = refitted(source, &scene, &own)?;
                    scene.garment.mesh = dressed(source, &fitted, &scene.body)?;
                    refit = Some(fitted);
                }
                let files = &source.scene;
                let path = scene.rest.path.clone();
                let mut prepared = Self::of(scene, refit, files.pose.clone(), files.motion);
                if let Some(cut) = &cut {
                    prepared.warn_of_misfit(cut.misfit.clone(), &path);
                }
                Ok(Self {
                    tailoring,
                    is_on_other,
                    is_unit_named: files.units.body.is_some(),
                    cut,
                    ..prepared
                })
            }
        }
    }

    fn of(
        scene: Scene,
        refit: Option<Refit>,
        pose: Option<PoseSource>,
        motion: MotionOptions,
    ) -> Self {
        Self {
            garment_file: scene.garment.file,
            garment_frame: scene.garment.frame,
            garment: scene.garment.mesh,
            refit,
            rest: scene.rest,
            body: scene.body,
            targets: scene.targets,
            pose,
            motion,
            frame_time: scene.frame_time,
            notes: scene.notes.iter().map(ToString::to_string).collect(),
            tailoring: None,
            is_on_other: false,
            is_unit_named: false,
            cut: None,
            is_made_for_wearer: false,
            warnings: Vec::new(),
        }
    }

    /// Keeps the first targets, and gives the same with the others.
    pub(super) fn split_off(&mut self, count: usize) -> Self {
        Self {
            garment_file: self.garment_file.clone(),
            garment_frame: self.garment_frame,
            garment: self.garment.clone(),
            refit: None,
            rest: self.rest.clone(),
            body: self.body.clone(),
            targets: self.targets.split_off(count.min(self.targets.len())),
            pose: self.pose.clone(),
            motion: self.motion,
            frame_time: self.frame_time,
            notes: Vec::new(),
            tailoring: None,
            is_on_other: self.is_on_other,
            is_unit_named: self.is_unit_named,
            cut: None,
            is_made_for_wearer: false,
            warnings: Vec::new(),
        }
    }
}

/// Refuses a template that was changed: networks have learned another one, and the pattern is of
/// another one.
fn check_template(folder: &Path, scene: &Scene) -> anyhow::Result<()> {
    let manifest = GarmentPackage::read_manifest(folder)?;
    Ok(manifest.check_template(scene.garment.file.path(), &scene.garment.mesh)?)
}

/// Brings the garment of a package from its own body to the other one at rest.
fn refitted(source: &SourceFiles, scene: &Scene, own: &Body) -> anyhow::Result<Refit> {
    let garment = Garment::new(scene.garment.mesh.clone());
    Refit::new(garment, own, &scene.body).with_context(|| cannot_bring(source))
}

/// The garment of a package on the other body at rest.
fn dressed(source: &SourceFiles, refit: &Refit, other: &Body) -> anyhow::Result<TriMesh> {
    refit.dressed(other).with_context(|| cannot_bring(source))
}

fn cannot_bring(source: &SourceFiles) -> String {
    let garment = source.scene.garment.display();
    format!("cannot bring `{garment}` from the body of its package to the other one")
}
