//! Arguments that contradict each other, or that what is trained cannot follow.

use garnet::{
    package::GarmentPackage,
    train::{Recipe, TrainConfig, kind_name, kind_names},
};

use super::TrainArgs;
use crate::{
    failure::refused,
    hints::{advised, did_you_mean_or},
};

/// Refuses what would be left out of account. A variant that the package has is trained anew as
/// what it is.
pub(super) fn check(args: &TrainArgs, recipe: &mut Recipe) -> anyhow::Result<()> {
    if args.resume {
        // What was begun goes on as it was.
        return Ok(());
    }
    if !recipe.says_what() && args.from.is_none() {
        let manifest = GarmentPackage::read_manifest(&args.package)?;
        if let Some(variant) = manifest.variant(&recipe.name) {
            let weights = args.package.join(&variant.weights);
            *recipe = Recipe::of_weights(&recipe.name, &weights).map_err(advised)?;
        }
    }
    if recipe.pose_space().is_some() {
        return check_fit(args, recipe);
    }
    check_size(args, recipe)?;
    let Some(path) = &args.config else {
        return check_name(args, recipe);
    };
    match TrainConfig::kind_in(path).map_err(advised)? {
        None => check_name(args, recipe),
        Some(asked) if recipe.kind.is_some_and(|kind| kind != asked) => Err(refused(
            format!(
                "`{}` asks for `kind = \"{}\"`",
                path.display(),
                kind_name(asked)
            ),
            match &args.kind {
                Some(kind) => format!("`--kind {kind}` is another kind of network"),
                None => format!("`--variant {}` is another kind of network", recipe.name),
            },
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

/// Refuses a name that says nothing where nothing else says what is to be trained: it may be a
/// mistyped one, and a training takes hours.
fn check_name(args: &TrainArgs, recipe: &Recipe) -> anyhow::Result<()> {
    if recipe.says_what() || args.from.is_some() {
        return Ok(());
    }
    let manifest = GarmentPackage::read_manifest(&args.package)?;
    let name = &recipe.name;
    let variants: Vec<&str> = (manifest.variants.iter())
        .map(|variant| variant.name.as_str())
        .collect();
    let says_kind = format!(
        "`--kind KIND` says what a variant of your own is, as in `--kind local --variant {name}`"
    );
    let known = |stem: &str| kind_names().any(|kind| kind == stem) || variants.contains(&stem);
    if let Some((stem, ending)) = name.rsplit_once('-').filter(|(stem, _)| known(stem)) {
        return Err(refused(
            format!("nothing says what `{name}` is"),
            format!("fine-tunings of `{stem}` end in -rq, -mc, -mcrq and -umc, not in -{ending}"),
            says_kind,
        ));
    }
    let kinds: Vec<&str> = kind_names().collect();
    let all = kinds.iter().chain(&variants).copied();
    let hint = did_you_mean_or(name, all, &says_kind);
    Err(refused(
        format!("nothing says what `{name}` is"),
        format!("it is no kind: those are {}", kinds.join(", ")),
        hint,
    ))
}
