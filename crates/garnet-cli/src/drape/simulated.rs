//! The simulation as a way to drape.

use std::{path::PathBuf, sync::atomic::AtomicBool};

use anyhow::Context;
use garnet::{
    PosedBody, Warped,
    data::{BodyPath, GarmentPackage, Quality, SceneReport, StoredFabric, Teacher, quality_name},
    sim::{Event, Fabric, RestShape},
};

use super::{
    Bound,
    args::{Simulation, Source},
    report::SimulationReport,
};
use crate::{console::Console, output};

/// A garment that is simulated.
pub(super) struct Teaching {
    teacher: Teacher,
    quality: Quality,
    fabric: StoredFabric,
    frames: Option<PathBuf>,
}

/// The simulation of a garment: of a fabric, or of that of its package, or of cotton.
pub(super) fn teacher_of(
    bound: &Bound,
    fabric: Option<&StoredFabric>,
    source: &Source,
) -> anyhow::Result<(Teacher, StoredFabric)> {
    let package = match source {
        Source::Files(files) => files.package.as_deref(),
        Source::Scene(_) => None,
    };
    let mesh = bound.garment.mesh();
    let (own, rest) = if let Some(package) = package {
        GarmentPackage::read_cloth(package, mesh)?
    } else {
        let worn = mesh.positions().to_vec();
        let cotton = StoredFabric::new("cotton", &Fabric::cotton());
        (cotton, RestShape::Worn(worn))
    };
    let fabric = fabric.cloned().unwrap_or(own);
    let cloth = bound.garment.cloth().clone();
    let teacher = Teacher::of_garment(cloth, &bound.body, &rest, &fabric.fabric());
    let teacher = teacher
        .with_context(|| format!("cannot simulate `{}`", bound.garment_file.path().display()))?;
    Ok((teacher, fabric))
}

impl Teaching {
    pub(super) fn new(
        bound: &Bound,
        simulation: &Simulation,
        source: &Source,
    ) -> anyhow::Result<Self> {
        let (teacher, fabric) = teacher_of(bound, simulation.fabric.as_ref(), source)?;
        if let Some(folder) = &simulation.frames {
            output::make_folder(folder)?;
        }
        Ok(Self {
            teacher,
            quality: simulation.quality,
            fabric,
            frames: simulation.frames.clone(),
        })
    }

    pub(super) fn report(&self) -> SimulationReport {
        SimulationReport {
            quality: quality_name(self.quality),
            fabric: self.fabric.clone(),
            vertices: self.teacher.num_simulated(),
        }
    }

    /// Moves the body from rest to its target, with the garment on it.
    pub(super) fn drape(
        &self,
        bound: &Bound,
        posed: &PosedBody,
        console: &Console,
    ) -> anyhow::Result<(Warped, Option<SceneReport>)> {
        let path = BodyPath::to_posed(&bound.body, posed);
        let stop = AtomicBool::new(false);
        let mut written: anyhow::Result<()> = Ok(());
        let bar = console.progress(1000);
        let mut watch = |event: Event<'_>| match event {
            Event::Frame {
                num_done,
                progress,
                positions,
                ..
            } => {
                bar.set_position((1000.0 * progress) as u64);
                if let Some(folder) = self.frames.as_ref().filter(|_| written.is_ok()) {
                    let name = folder.join(format!("frame_{num_done:04}.obj"));
                    let vertices = bound
                        .garment_frame
                        .to_file(self.teacher.vertices(positions));
                    let frame = bound.garment_file.write_with_positions(&name, &vertices);
                    written = frame.map_err(anyhow::Error::from);
                }
            }
            Event::Balance {
                num_done,
                max_steps,
                residual,
            } => {
                let message =
                    format!("balance: step {num_done} of at most {max_steps}, {residual:.2}");
                bar.set_message(message);
            }
            _ => {}
        };
        let drape = self.teacher.drape(&path, self.quality, &stop, &mut watch);
        bar.finish_and_clear();
        written?;
        let drape = drape?;
        let report = SceneReport::from(&drape.report);
        Ok((
            Warped::simulated(&bound.garment, &drape.positions),
            Some(report),
        ))
    }
}
