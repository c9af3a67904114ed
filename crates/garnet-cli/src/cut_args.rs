//! In which size and with which parameters a garment is cut.

use std::{path::Path, sync::atomic::AtomicBool};

use anyhow::Context;
use clap::Args;
use garnet::{
    Body,
    body::shape::ParametricBody,
    data::{CutOptions, body_of_size, recut},
    package::GarmentPackage,
    pattern::{Ease, GarmentKind, Measures, Parameters, PatternError, Size},
};

use crate::hints::for_pattern;

/// The size that a garment is cut in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SizeChoice {
    /// This one.
    Named(Size),
    /// The one that fits the body best.
    Auto,
}

/// How the garment of a package is cut anew before it is draped.
#[derive(Debug, Clone, Copy, Default, PartialEq, Args)]
pub(crate) struct CutArgs {
    /// Size of the garment of a package: XS to 3XL or, of jeans, waist and inner leg in inches
    /// (32x34); auto is the one that fits the body best [default: the cut of the package].
    #[arg(long, value_name = "SIZE", value_parser = size)]
    pub(crate) size: Option<SizeChoice>,
    /// Length of its sleeves, in centimetres.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    sleeve: Option<f64>,
    /// Its length, from the neck to the hem, or of jeans of the inner leg, in centimetres.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    length: Option<f64>,
    /// How much wider it is than the chest, or of jeans than the hip, of the body that it is cut
    /// for (that of its size or its package), in per cent.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "PERCENT",
        allow_negative_numbers = true
    )]
    ease: Option<f64>,
}

impl CutArgs {
    /// The option that was given, if one was.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let options = [
            (self.size.is_some(), "--size"),
            (self.sleeve.is_some(), "--sleeve"),
            (self.length.is_some(), "--length"),
            (self.ease.is_some(), "--ease"),
        ];
        let mut given = options.into_iter().filter(|(is_given, _)| *is_given);
        given.next().map(|(_, name)| name)
    }

    /// Sets what was given, and checks the size.
    ///
    /// # Errors
    ///
    /// What the pattern does not have, or not so long or wide.
    pub(crate) fn set_in(&self, parameters: &mut Parameters) -> Result<(), PatternError> {
        let [length, ease] = match parameters.garment() {
            GarmentKind::Jeans => ["inseam", "hip-ease"],
            _ => ["length", "chest-ease"],
        };
        let named = [
            ("sleeve", self.sleeve),
            (length, self.length),
            (ease, self.ease),
        ];
        for (name, shown) in named {
            if let Some(shown) = shown {
                parameters.set(name, shown / 100.0)?;
            }
        }
        if let Some(SizeChoice::Named(size)) = self.size {
            check_size(size, parameters.garment())?;
        }
        Ok(())
    }
}

/// Refuses sizes of trousers for what is none.
pub(crate) fn check_size(size: Size, garment: GarmentKind) -> Result<(), PatternError> {
    match (size, garment) {
        (Size::Trousers { .. }, GarmentKind::Jeans) => Ok(()),
        (Size::Trousers { .. }, _) => Err(PatternError::NoTrousers {
            garment,
            size: size.to_string(),
        }),
        _ => Ok(()),
    }
}

/// Reads a size, or `auto`.
pub(crate) fn size(text: &str) -> Result<SizeChoice, String> {
    if text.eq_ignore_ascii_case("auto") {
        return Ok(SizeChoice::Auto);
    }
    let named = text.parse().map(SizeChoice::Named);
    named.map_err(|error: PatternError| told(&error))
}

/// An error of a pattern in the line that a wrong argument gets, with what to do about it.
pub(crate) fn told(error: &PatternError) -> String {
    match for_pattern(error) {
        Some(hint) => format!("{error}; {hint}"),
        None => error.to_string(),
    }
}

/// The size that fits best, the one that comes next, and what is told of them.
pub(crate) fn chosen_size(
    parameters: &Parameters,
    wearer: &Measures,
) -> Option<([Size; 2], String)> {
    let sizes = parameters.by_fit(&parameters.sizes(), wearer);
    let [first, second, ..] = sizes[..] else {
        return None;
    };
    let is_fitting = |size: Size| parameters.fit(&size.measures(), wearer).fits();
    let nearest = "its ease is nearest to that of the pattern";
    let text = match (is_fitting(first), is_fitting(second)) {
        (true, true) => format!("size {first} is taken: {nearest}; {second} fits, too"),
        (true, false) => {
            format!("size {first} is taken, the only one that fits; {second} comes next")
        }
        (false, _) => format!("no size fits: {first} is taken, {nearest}; {second} comes next"),
    };
    Some(([first, second], text))
}

/// Where a garment, cut in a size or else to the measures `cut_to`, is too tight or too wide for
/// its wearer.
pub(crate) fn misfit(
    parameters: &Parameters,
    (size, cut_to): (Option<Size>, &Measures),
    wearer: &Measures,
) -> Option<String> {
    let fit = parameters.fit(&size.map_or(*cut_to, Size::measures), wearer);
    let bad = fit.eases.iter().filter(|ease| !ease.is_allowed());
    let bad: Vec<String> = bad.map(shown).collect();
    if bad.is_empty() {
        return None;
    }
    let bad = bad.join(", ");
    let Some(size) = size else {
        return Some(format!(
            "with these parameters the garment does not fit: {bad}"
        ));
    };
    let advice = match parameters.best_size(wearer) {
        Some(best) => format!("size {best} fits best"),
        None => "no size fits; without `--size` it is cut to measure".to_owned(),
    };
    Some(format!(
        "size {size} does not fit this body: {bad}; {advice}"
    ))
}

fn shown(ease: &Ease) -> String {
    let [low, high] = ease.allowed.map(|share| 100.0 * share);
    let wanted = if high.is_finite() {
        format!("{low:.0} to {high:.0} %")
    } else {
        format!("{low:.0} % and more")
    };
    let share = 100.0 * ease.share;
    // What misses by less than half a per cent is not to look as if it fitted.
    let digits = usize::from((low..=high).contains(&share.round()));
    format!(
        "its {} has an ease of {share:.digits$} % ({wanted} fits)",
        ease.place
    )
}

/// The garment of a package on the body that a size is for: as it is stored there, or cut.
pub(crate) fn in_size(
    package: &GarmentPackage,
    folder: &Path,
    size: Size,
) -> anyhow::Result<GarmentPackage> {
    if let Some(stored) = package.in_size(folder, &size.to_string())? {
        return Ok(stored);
    }
    let options = CutOptions {
        size: Some(size),
        parameters: None,
    };
    cut_on(package, wearer_of_size(package, size), &options)
}

/// The garment of a package, cut anew and put on a body.
pub(crate) fn cut_on(
    package: &GarmentPackage,
    body: Body,
    options: &CutOptions,
) -> anyhow::Result<GarmentPackage> {
    let cut = recut(package, body, options, &AtomicBool::new(false))?;
    cut.context("the measures of the body are not known")
}

/// The body that a size is for; that of the package, if there is none like it.
pub(crate) fn wearer_of_size(package: &GarmentPackage, size: Size) -> Body {
    let built = ParametricBody::build(&body_of_size(package, size));
    built.map_or_else(|_| package.body.clone(), ParametricBody::into_body)
}
