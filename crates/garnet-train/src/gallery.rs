//! Drapes side by side, to be looked at.

use garnet_data::Split;
use garnet_mesh::{Point3, TriMesh};
use garnet_untangle::UntangleOptions;

use crate::contender::Contender;
use crate::{Candidate, Finish, SceneName, Stage, StagedScene, TrainError};

/// A scene with all its drapes; places are in metres.
#[derive(Debug, Clone)]
pub struct Exhibit {
    /// Which it is.
    pub scene: SceneName,
    /// The posed body.
    pub body: TriMesh,
    /// Of each candidate `[vertex]`, untangled.
    pub drapes: Vec<Vec<Point3>>,
    /// What the teacher made of it `[vertex]`.
    pub teacher: Vec<Point3>,
}

/// Drapes the scenes of a split that
/// `keep` lets through by all candidates, untangles, and gives each scene to `take`.
///
/// # Errors
///
/// As [`crate::evaluate`].
pub fn exhibit(
    stage: &Stage,
    split: Split,
    candidates: &[Candidate],
    options: &UntangleOptions,
    keep: impl Fn(SceneName) -> bool + Sync,
    take: &mut dyn FnMut(Exhibit),
) -> Result<(), TrainError> {
    let contenders = candidates
        .iter()
        .map(|candidate| Contender::new(stage, candidate));
    let mut contenders: Vec<Contender<'_>> = contenders.collect::<Result<_, _>>()?;
    stage.for_each_of(split, keep, Ok, &mut |staged: StagedScene| {
        take(shown(&mut contenders, options, &staged)?);
        Ok(())
    })
}

fn shown(
    contenders: &mut [Contender<'_>],
    options: &UntangleOptions,
    staged: &StagedScene,
) -> Result<Exhibit, TrainError> {
    let mut drapes = Vec::with_capacity(contenders.len());
    for contender in contenders {
        let finish = Finish::Untangle(*options);
        let untangled = contender.drape(staged, finish, |draper, placed, drape| {
            let before = || placed.positions(draper.garment());
            Ok(drape.map_or_else(before, |drape| drape.positions))
        })?;
        drapes.push(untangled);
    }
    let skin = staged.posed.skin().positions().to_vec();
    Ok(Exhibit {
        scene: staged.name,
        body: staged.worn.body.rest().with_positions(skin)?,
        drapes,
        teacher: staged.draped.clone(),
    })
}
