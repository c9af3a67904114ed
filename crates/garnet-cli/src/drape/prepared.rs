//! From files to values in metres: the garment, the rest body, and the targets.

use std::path::Path;

use anyhow::Context;
use garnet::{
    Body, Garment, TriMesh,
    drape::Refit,
    io::{Frame, MotionOptions, ObjFile, PoseSource, RestSource, Scene, Target},
    package::GarmentPackage,
};

use super::args::{Source, SourceFiles};

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
}

impl Prepared {
    /// Reads the files and brings them together.
    pub(crate) fn read(source: &Source) -> anyhow::Result<Self> {
        match source {
            Source::Scene(path) => Ok(Self::of(
                Scene::read(path)?,
                None,
                None,
                MotionOptions::default(),
            )),
            Source::Files(source) => {
                let mut scene = Scene::load(&source.scene)?;
                if let Some(folder) = &source.package {
                    check_template(folder, &scene)?;
                }
                let refit = match scene.own.take() {
                    Some(own) => Some(refitted(source, &mut scene, &own)?),
                    None => None,
                };
                let files = &source.scene;
                Ok(Self::of(scene, refit, files.pose.clone(), files.motion))
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
fn refitted(source: &SourceFiles, scene: &mut Scene, own: &Body) -> anyhow::Result<Refit> {
    let cannot = || {
        let garment = source.scene.garment.display();
        format!("cannot bring `{garment}` from the body of its package to the other one")
    };
    let garment = Garment::new(scene.garment.mesh.clone());
    let refit = Refit::new(garment, own, &scene.body).with_context(cannot)?;
    scene.garment.mesh = refit.dressed(&scene.body).with_context(cannot)?;
    Ok(refit)
}
