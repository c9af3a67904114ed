//! Drapes side by side, to be looked at.

use garnet_data::Split;
use garnet_mesh::{Point3, TriMesh};
use garnet_untangle::UntangleOptions;

use crate::bound_candidate::BoundCandidate;
use crate::{Candidate, Finish, SceneName, Stage, StagedScene, TrainError};

/// A scene with all its drapes; places are in metres.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct DrapedScene {
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
pub fn drape_scenes(
    stage: &Stage,
    split: Split,
    candidates: &[Candidate],
    options: &UntangleOptions,
    keep: impl Fn(SceneName) -> bool + Sync,
    take: &mut dyn FnMut(DrapedScene),
) -> Result<(), TrainError> {
    let bound = candidates
        .iter()
        .map(|candidate| BoundCandidate::new(stage, candidate));
    let mut bound: Vec<BoundCandidate<'_>> = bound.collect::<Result<_, _>>()?;
    stage.for_each_of(split, keep, Ok, &mut |staged: StagedScene| {
        take(shown(&mut bound, options, &staged)?);
        Ok(())
    })
}

fn shown(
    bound: &mut [BoundCandidate<'_>],
    options: &UntangleOptions,
    staged: &StagedScene,
) -> Result<DrapedScene, TrainError> {
    let mut drapes = Vec::with_capacity(bound.len());
    for candidate in bound {
        let finish = Finish::Untangle(*options);
        let untangled = candidate.drape(staged, finish, |draper, placed, drape| {
            let before = || placed.positions(draper.garment());
            Ok(drape.map_or_else(before, |drape| drape.positions))
        })?;
        drapes.push(untangled);
    }
    let skin = staged.posed.skin().positions().to_vec();
    Ok(DrapedScene {
        scene: staged.name,
        body: staged.worn.body.rest().with_positions(skin)?,
        drapes,
        teacher: staged.draped.clone(),
    })
}
