//! The simulation of the garments of scenes.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use garnet_data::{DataError, Tailor, wearer_of};
use garnet_drape::Simulator;

use crate::{Stage, StagedScene, TrainError, Worn};

/// Makes the simulators of scenes; that of the last garment is kept.
#[derive(Debug)]
pub(crate) struct Simulators<'a> {
    stage: &'a Stage,
    last: Option<(Arc<Worn>, Arc<Simulator>)>,
}

impl<'a> Simulators<'a> {
    pub(crate) fn new(stage: &'a Stage) -> Self {
        Self { stage, last: None }
    }

    /// That which made a scene.
    pub(crate) fn of(&mut self, staged: &StagedScene) -> Result<Arc<Simulator>, TrainError> {
        let last = self.last.take();
        let known = last.filter(|(worn, _)| Arc::ptr_eq(worn, &staged.worn));
        let known = match known {
            Some(known) => known,
            None => (
                Arc::clone(&staged.worn),
                Arc::new(simulator_of(self.stage, staged)?),
            ),
        };
        Ok(Arc::clone(&self.last.insert(known).1))
    }
}

fn simulator_of(stage: &Stage, staged: &StagedScene) -> Result<Simulator, TrainError> {
    let package = &stage.package;
    let tailor = match &staged.own {
        Some(_) if stage.is_made_to_measure() => Tailor::of_package(package)?,
        _ => None,
    };
    let body = &staged.worn.body;
    if let (Some(tailor), Some(wearer)) = (tailor, wearer_of(body)) {
        // Parameters may have been drawn for the body; they are in the order of their names.
        let mut parameters = tailor.parameters().clone();
        let names: BTreeSet<&str> = tailor
            .parameters()
            .iter()
            .map(|own| own.spec.name)
            .collect();
        for (name, &value) in names.into_iter().zip(staged.worn.graph.sewing_parameters()) {
            parameters
                .set(name, value.into())
                .map_err(DataError::from)?;
        }
        let tailor = tailor.with_size(None).with_parameters(parameters);
        let wearer = wearer.map_err(DataError::from)?;
        let worn = tailor.dress(body, &wearer, &AtomicBool::new(false))?;
        return Ok(tailor.simulator(&worn, body)?);
    }
    let cloth = Arc::clone(stage.template().ready()?.shared_cloth());
    let fabric = package.manifest.fabric.fabric();
    Ok(Simulator::of_garment(
        cloth,
        &package.body,
        &package.rest,
        &fabric,
    )?)
}
