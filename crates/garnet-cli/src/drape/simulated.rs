//! The simulation as a way to drape.

use std::{
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
    sync::{Arc, atomic::AtomicBool},
};

use anyhow::Context;
use garnet::{
    Draper, PosedBody,
    data::SceneReport,
    drape::Placed,
    io::{Target, remove_stale_temporaries},
    package::{GarmentPackage, Progress, Quality, Simulator, StoredFabric, quality_name},
    sim::{Event, Fabric, RestShape},
};

use indicatif::ProgressBar;

use super::{
    Bound,
    args::{Simulation, Source},
    ready::package_of,
    report::SimulationReport,
};
use crate::{console::Console, output};

/// How a garment is simulated.
pub(super) struct Simulated {
    quality: Quality,
    fabric: StoredFabric,
    /// Vertices that are simulated.
    vertices: usize,
    frames: Option<PathBuf>,
}

/// The simulation of a garment: of a fabric, or of that of its package, or of cotton.
pub(super) fn simulator_of(
    bound: &Bound,
    fabric: Option<&StoredFabric>,
    source: &Source,
    settles: bool,
) -> anyhow::Result<(Arc<Simulator>, StoredFabric)> {
    let mesh = bound.garment.mesh();
    let (own, rest) = if let Some(cut) = &bound.cut {
        let package = &cut.package;
        (package.manifest.fabric.clone(), package.rest.clone())
    } else if let Some(package) = package_of(source) {
        GarmentPackage::read_cloth(package, mesh)?
    } else {
        let worn = mesh.positions().to_vec();
        let cotton = StoredFabric::new("cotton", &Fabric::cotton());
        (cotton, RestShape::Worn(worn))
    };
    let fabric = fabric.cloned().unwrap_or(own);
    let cloth = Arc::clone(bound.garment.shared_cloth());
    let (body, fabric_of) = (bound.garment.body(), fabric.fabric());
    let any = || Simulator::of_any_garment(cloth.clone(), body, &rest, &fabric_of);
    let has_pieces = cloth.is_piece().contains(&true);
    let simulator = if settles || has_pieces {
        any()
    } else {
        // Of a mesh that is cloth as it is, edge by edge, nothing is left out or turned.
        Simulator::of_garment(cloth.clone(), body, &rest, &fabric_of).or_else(|_| any())
    };
    let simulator = simulator
        .with_context(|| format!("cannot simulate `{}`", bound.garment_file.path().display()))?;
    Ok((Arc::new(simulator), fabric))
}

impl Simulated {
    pub(super) fn new(
        bound: &Bound,
        simulation: &Simulation,
        source: &Source,
    ) -> anyhow::Result<(Arc<Simulator>, Self)> {
        let (simulator, fabric) = simulator_of(bound, simulation.fabric.as_ref(), source, false)?;
        let simulated = Self {
            quality: simulation.quality,
            fabric,
            vertices: simulator.num_simulated(),
            frames: simulation.frames.clone(),
        };
        Ok((simulator, simulated))
    }

    /// How fine the steps are.
    pub(super) fn quality(&self) -> Quality {
        self.quality
    }

    pub(super) fn report(&self) -> SimulationReport {
        SimulationReport {
            quality: quality_name(self.quality),
            fabric: self.fabric.clone(),
            vertices: self.vertices,
        }
    }

    /// Where the frames of a target go, if they are written: in a folder of its own if there are
    /// several.
    fn frames_of(&self, bound: &Bound, target: &Target) -> Option<PathBuf> {
        let folder = self.frames.as_ref()?;
        if bound.targets.len() < 2 {
            return Some(folder.clone());
        }
        let stem = target.stem.as_ref().map(OsStr::new);
        Some(folder.join(stem.or(target.path.file_stem()).unwrap_or_default()))
    }

    /// Makes the folder of the frames of a target, and that of all frames around it.
    fn make_folders(&self, of_target: &Path) -> anyhow::Result<()> {
        self.frames.as_deref().map_or(Ok(()), output::make_folder)?;
        output::make_folder(of_target)
    }

    /// Moves the body from rest to its target, with the garment on it. Frames are where the target
    /// is.
    pub(super) fn drape<'a>(
        &self,
        (bound, draper): (&Bound, &Draper),
        target: &Target,
        body: &'a PosedBody,
        (console, stop): (Option<&Console>, &AtomicBool),
    ) -> anyhow::Result<(Placed<'a>, SceneReport)> {
        let frames = self.frames_of(bound, target);
        let mut num_written = 0;
        let mut written: anyhow::Result<()> = Ok(());
        let bar = console.map_or_else(ProgressBar::hidden, |console| console.progress(1000));
        let mut watch = |progress: Progress<'_>| match progress.event {
            &Event::Frame {
                num_done,
                progress: share,
                ..
            } => {
                bar.set_position((1000.0 * share) as u64);
                let folder = frames.as_ref().filter(|_| written.is_ok());
                if let Some((folder, vertices)) = folder.zip(progress.frame()) {
                    let name = folder.join(frame_name(num_done));
                    num_written = num_written.max(num_done);
                    let vertices = bound.garment_frame.to_file(vertices);
                    let write = || bound.garment_file.write_with_positions(&name, &vertices);
                    // No frame, no folder.
                    written = self
                        .make_folders(folder)
                        .and_then(|()| write().map_err(anyhow::Error::from));
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
        let simulated = draper.simulate(body, self.quality, stop, &mut watch);
        bar.finish_and_clear();
        written?;
        let (placed, report) = simulated?;
        if let Some(folder) = &frames {
            remove_after(folder, num_written)?;
        }
        Ok((placed, SceneReport::from(&report)))
    }
}

/// The file of a frame.
fn frame_name(number: u64) -> String {
    format!("frame_{number:04}.obj")
}

/// Removes the frames that a longer simulation has left in a folder, and the temporary files of a
/// killed one.
fn remove_after(folder: &Path, last: u64) -> anyhow::Result<()> {
    remove_stale_temporaries(folder);
    let cannot = || format!("cannot remove older frames in `{}`", folder.display());
    for entry in fs::read_dir(folder).with_context(cannot)? {
        let path = entry.with_context(cannot)?.path();
        let name = path.file_name().and_then(OsStr::to_str).unwrap_or_default();
        let number = name
            .strip_prefix("frame_")
            .and_then(|name| name.strip_suffix(".obj"));
        let number = number.and_then(|number| number.parse().ok());
        if number.is_some_and(|number: u64| number > last && name == frame_name(number)) {
            fs::remove_file(&path).with_context(cannot)?;
        }
    }
    Ok(())
}
