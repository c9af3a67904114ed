//! Arguments that contradict each other, or that what is trained cannot follow.

use std::path::Path;

use garnet::{
    package::GarmentPackage,
    train::{Recipe, TrainConfig, kind_name},
};

use super::TrainArgs;
use crate::{failure::refused, hints::advised};

/// Refuses what would be left out of account.
pub(super) fn check(args: &TrainArgs, recipe: &Recipe) -> anyhow::Result<()> {
    if args.resume {
        // What was begun goes on as it was.
        return Ok(());
    }
    if recipe.pose_space().is_some() {
        return check_fit(args, recipe);
    }
    check_size(args, recipe)?;
    let Some(path) = &args.config else {
        return check_ending(args, recipe);
    };
    match TrainConfig::kind_in(path).map_err(advised)? {
        None => check_ending(args, recipe),
        Some(asked) if recipe.kind.is_some_and(|kind| kind != asked) => Err(refused(
            format!(
                "`{}` asks for `kind = \"{}\"`",
                path.display(),
                kind_name(asked)
            ),
            format!("`--variant {}` is another kind of network", recipe.name),
            "leave `kind` out, or give the variant a name of its own",
        )),
        Some(_) => Ok(()),
    }
}

/// Deformations are fitted in one go, from nothing.
fn check_fit(args: &TrainArgs, recipe: &Recipe) -> anyhow::Result<()> {
    let options = [
        ("--preset", args.preset.is_some()),
        ("--epochs", args.epochs.is_some()),
        ("--from", args.from.is_some()),
    ];
    let Some((option, _)) = options.into_iter().find(|(_, is_given)| *is_given) else {
        return Ok(());
    };
    Err(refused(
        format!("`{option}` is for networks"),
        format!("`{}` is a pose-space deformation", recipe.name),
        "leave it out: `[pose_space]` of a configuration says how one is fitted",
    ))
}

/// What is fine-tuned keeps its size.
fn check_size(args: &TrainArgs, recipe: &Recipe) -> anyhow::Result<()> {
    let Some((base, _)) = (recipe.fine_tuned.as_ref()).filter(|_| args.from.is_none()) else {
        return Ok(());
    };
    if args.preset.is_none() {
        return Ok(());
    }
    Err(refused(
        "`--preset` is the size of a new network",
        format!("`{}` starts from `{base}` and has its size", recipe.name),
        "leave it out, or train a network of that size first",
    ))
}

/// Refuses what looks like a mistyped fine-tuning, where nothing else says what is to be trained.
fn check_ending(args: &TrainArgs, recipe: &Recipe) -> anyhow::Result<()> {
    let name = &recipe.name;
    let is_clear = recipe.kind.is_some() || recipe.fine_tuned.is_some() || args.from.is_some();
    let Some((stem, ending)) = name.rsplit_once('-').filter(|_| !is_clear) else {
        return Ok(());
    };
    if !is_known(&args.package, stem)? {
        return Ok(());
    }
    Err(refused(
        format!("nothing says what `{name}` is"),
        format!("fine-tunings of `{stem}` end in -rq, -mc, -mcrq and -umc, not in -{ending}"),
        "a new network of such a name asks for `kind`, as in `kind = \"local\"`, in a configuration (`--config`)",
    ))
}

/// Whether a name is that of a kind, of a deformation, or of a variant of the package.
fn is_known(package: &Path, name: &str) -> anyhow::Result<bool> {
    let means_something = |recipe: Recipe| {
        recipe.kind.is_some() || recipe.fine_tuned.is_some() || recipe.pose_space().is_some()
    };
    if Recipe::of_name(name).is_ok_and(means_something) {
        return Ok(true);
    }
    let manifest = GarmentPackage::read_manifest(package)?;
    Ok(manifest.variant(name).is_some())
}
