//! What people are told about a drape.

use std::{collections::BTreeMap, path::Path};

use super::{
    fit,
    report::{CutReport, DrapeOutput, DrapeReport, RepeatedSeconds, WarningReport},
    timing::{Repeated, readable},
};
use crate::{console::Console, wearer_rig::TOLD};

/// Tells what was draped, what it is like, what may be wrong, and how long it took.
pub(crate) fn tell(report: &DrapeReport, folder: Option<&Path>, console: &Console) {
    console.summary(&headline(report, folder));
    for cut in &report.cuts {
        console.summary(&format_args!("  {}", cut_for(cut)));
    }
    console.summary(&format_args!("  {}", result(&report.drapes)));
    console.summary(&format_args!("  {}", stretch(&report.drapes)));
    if let Some(line) = fit_line(report) {
        console.summary(&format_args!("  {line}"));
    }
    if let Some(line) = cloth_crossings(report) {
        console.summary(&format_args!("  {line}"));
    }
    if let Some(line) = steps(&report.drapes) {
        console.summary(&format_args!("  {line}"));
    }
    if let Some(hidden) = report.hidden_faces {
        console.summary(&format_args!(
            "  {hidden} faces of the body are covered in all of it"
        ));
    }
    if is_converted(report) {
        console.summary(&format_args!("  {}", frames(report)));
    }
    for line in lines_of(&report.warnings) {
        console.warning(&line);
    }
    for drape in &report.drapes {
        if let Some(repeated) = &drape.repeated {
            console.summary(&times(drape, repeated, report));
        }
    }
    console.detail(&stages(report));
}

/// How and for whom the garment was cut.
fn cut_for(cut: &CutReport) -> String {
    let size = (cut.size.as_ref()).map_or_else(String::new, |size| format!(" in size {size}"));
    let changed = cut.parameters.iter();
    let changed: Vec<String> = changed
        .map(|(name, value)| format!("{name} {:.1}", 100.0 * value))
        .collect();
    let changed = if changed.is_empty() {
        String::new()
    } else {
        format!(" with {}", changed.join(", "))
    };
    let measures = cut.wearer.as_ref().map_or_else(String::new, |wearer| {
        let measures = [
            ("chest", wearer.chest),
            ("waist", wearer.waist),
            ("hip", wearer.hip),
            ("inseam", wearer.inseam),
        ];
        let measures = measures.map(|(name, metres)| format!("{name} {:.0}", 100.0 * metres));
        let told = if cut.is_told {
            format!(" {TOLD}")
        } else {
            String::new()
        };
        format!(": {} cm{told}", measures.join(", "))
    });
    let (target, time) = (&cut.target, readable(cut.seconds));
    let line = format!("cut{size}{changed} for `{target}`{measures}, in {time}");
    match &cut.choice {
        Some(choice) => format!("{line}; {choice}"),
        None => line,
    }
}

/// More warnings of a kind are told in one line.
const MOST_OF_A_KIND: usize = 5;

/// A line for each warning, or for all of a kind that there are many of.
fn lines_of(warnings: &[WarningReport]) -> Vec<String> {
    let mut kinds: BTreeMap<&str, Vec<&WarningReport>> = BTreeMap::new();
    for warning in warnings {
        kinds.entry(warning.kind).or_default().push(warning);
    }
    kinds.retain(|_, all| all.len() > MOST_OF_A_KIND);
    let mut lines = Vec::new();
    for warning in warnings {
        match kinds.get(warning.kind) {
            None => lines.push(warning.text.clone()),
            // In place of the first.
            Some(all)
                if all
                    .first()
                    .is_some_and(|first| std::ptr::eq(*first, warning)) =>
            {
                lines.push(of_many(all, warning));
            }
            Some(_) => {}
        }
    }
    lines
}

/// How many there are, where the first is, and the worst one.
fn of_many(all: &[&WarningReport], first: &WarningReport) -> String {
    let mut worst = first;
    for warning in all {
        if warning.severity > worst.severity {
            worst = warning;
        }
    }
    format!(
        "`{}` for {} outputs, the first `{}` (`--report FILE` lists all); the worst: {}",
        first.kind,
        all.len(),
        first.path,
        worst.text
    )
}

fn method(report: &DrapeReport) -> String {
    match &report.network {
        Some(network) => format!(" by `{}`", network.variant),
        None => String::new(),
    }
}

fn headline(report: &DrapeReport, folder: Option<&Path>) -> String {
    let garment = &report.garment.path;
    let seconds = readable(report.seconds.total);
    match (folder, report.drapes.as_slice()) {
        (_, [drape]) => {
            let target = match &report.pose {
                Some(pose) => format!("`{}` posed by `{}`", report.rest_body.path, pose.path),
                None => format!("`{}`", drape.target),
            };
            let output = &drape.output;
            let method = method(report);
            format!("draped `{garment}` on {target}{method} into `{output}` in {seconds}")
        }
        (folder, drapes) => {
            let folder = folder.unwrap_or(Path::new("")).display();
            let count = drapes.len();
            let method = method(report);
            let rate = rate(report.drapes_per_second);
            format!(
                "draped `{garment}` on {count} bodies{method} into `{folder}` in {seconds}, {rate} a \
                 second"
            )
        }
    }
}

/// Drapes a second as people read them.
fn rate(rate: f64) -> String {
    if rate < 10.0 {
        format!("{rate:.2}")
    } else {
        format!("{rate:.0}")
    }
}

/// The largest step of the cloth from one frame of a motion to the next.
fn steps(drapes: &[DrapeOutput]) -> Option<String> {
    let largest = (drapes.iter())
        .filter_map(|drape| Some((drape, drape.steps?)))
        .max_by(|(_, a), (_, b)| a.cloth_m.total_cmp(&b.cloth_m));
    let (drape, steps) = largest?;
    let is_between = |drape: &&DrapeOutput| drape.steps.is_some_and(|steps| steps.is_between);
    let between = match drapes.iter().filter(is_between).count() {
        0 => String::new(),
        between => format!(
            "; {} frames draped by themselves, {between} between them",
            drapes.len() - between
        ),
    };
    Some(format!(
        "largest step of the cloth {:.1} mm, into `{}`, where the body steps {:.1} mm{between}",
        1e3 * steps.cloth_m,
        drape.output,
        1e3 * steps.body_m
    ))
}

fn result(drapes: &[DrapeOutput]) -> String {
    let untangled: Vec<_> = drapes
        .iter()
        .filter_map(|drape| drape.untangle.as_ref())
        .collect();
    if untangled.is_empty() {
        let found: Vec<_> = drapes
            .iter()
            .filter_map(|drape| drape.penetration.as_ref())
            .collect();
        let inside: usize = found.iter().map(|found| found.inside).sum();
        let deepest = found
            .iter()
            .map(|found| found.deepest_m)
            .fold(0.0, f32::max);
        let vertices = if inside == 1 { "vertex" } else { "vertices" };
        return format!(
            "not untangled: {inside} {vertices} inside the body, the deepest {:.1} mm",
            1e3 * deepest
        );
    }
    let before: usize = untangled
        .iter()
        .map(|untangle| untangle.inside_before)
        .sum();
    let inside: usize = untangled.iter().map(|untangle| untangle.inside).sum();
    let deepest = untangled
        .iter()
        .map(|untangle| untangle.deepest_before_m)
        .fold(0.0, f32::max);
    let least = untangled
        .iter()
        .filter_map(|untangle| untangle.min_distance_m);
    let nearest = match least.reduce(f32::min) {
        Some(least) => format!("; nearest to the skin {:.1} mm", 1e3 * least),
        None => String::new(),
    };
    format!(
        "freed {before} vertices from the body, the deepest {:.1} mm; {inside} left inside{nearest}",
        1e3 * deepest
    )
}

fn stretch(drapes: &[DrapeOutput]) -> String {
    let worst = |value: fn(&DrapeOutput) -> f32| drapes.iter().map(value).fold(0.0, f32::max);
    let max = worst(|drape| drape.stretch.max);
    let caught = worst(|drape| drape.stretch.max_at_trapped.unwrap_or(0.0));
    let caught = if caught > max {
        format!("; {caught:.2} where it is caught")
    } else {
        String::new()
    };
    format!(
        "edges over rest length: median {:.2}, p99 {:.2}, largest {max:.2}{caught}",
        worst(|drape| drape.stretch.p50),
        worst(|drape| drape.stretch.p99),
    )
}

/// How the garment fits, if there is one wearer.
fn fit_line(report: &DrapeReport) -> Option<String> {
    let is_one = report.drapes.len() == 1 || report.pose.is_some();
    let first = report.drapes.first().filter(|_| is_one)?;
    Some(fit::line(first.fit.as_ref()?, first.is_fit_told))
}

/// Of garments of one layer more pairs than this for each of their faces are told: a few are in
/// every fold.
const TOLD_CROSSINGS: f64 = 0.01;

/// Cloth that runs through cloth, where more of it does than at rest.
fn cloth_crossings(report: &DrapeReport) -> Option<String> {
    let garment = &report.garment;
    let is_told = |drape: &&DrapeOutput| {
        let grown = drape
            .cloth_crossings
            .saturating_sub(drape.cloth_crossings_at_rest);
        let many = TOLD_CROSSINGS * garment.triangles as f64;
        grown > 0 && (garment.layered > 0 || grown as f64 > many)
    };
    let told = report.drapes.iter().filter(is_told);
    let worst = told.max_by_key(|drape| drape.cloth_crossings)?;
    let pairs = match worst.cloth_crossings {
        1 => "1 pair".to_owned(),
        count => format!("{count} pairs"),
    };
    let where_to = match report.drapes.len() {
        1 => String::new(),
        _ => format!(", most of them in `{}`", worst.output),
    };
    let at_rest = worst.cloth_crossings_at_rest;
    Some(format!(
        "cloth through cloth: {pairs} of faces, {at_rest} at rest{where_to}"
    ))
}

fn is_converted(report: &DrapeReport) -> bool {
    let garment = (report.garment.units.as_str(), report.garment.up.as_str());
    let body = (
        report.rest_body.units.as_str(),
        report.rest_body.up.as_str(),
    );
    garment != ("m", "y") || body != ("m", "y")
}

fn frames(report: &DrapeReport) -> String {
    let (garment, body) = (&report.garment, &report.rest_body);
    format!(
        "taken: garment in {}, {} up; rest body in {}, {} up",
        garment.units, garment.up, body.units, body.up
    )
}

fn times(drape: &DrapeOutput, repeated: &RepeatedSeconds, report: &DrapeReport) -> String {
    let of = |repeated: &Repeated| {
        format!(
            "{} (p95 {})",
            readable(repeated.median),
            readable(repeated.p95)
        )
    };
    format!(
        "`{}`: {} drapes on {} threads, median: fit {}, warp {}, {}{}untangle {}, all but the fit {}",
        drape.target,
        report.repeat,
        report.threads,
        of(&repeated.fit),
        of(&repeated.warp),
        match &report.network {
            Some(_) => format!("network {}, ", of(&repeated.network)),
            None => String::new(),
        },
        match report.settle_frames {
            0 => String::new(),
            _ => format!("settle {}, ", of(&repeated.settle)),
        },
        of(&repeated.untangle),
        of(&repeated.drape)
    )
}

fn stages(report: &DrapeReport) -> String {
    let sum = |stage: fn(&DrapeOutput) -> f64| readable(report.drapes.iter().map(stage).sum());
    format!(
        "stages on {} threads: read {}, bind {}, fit {}, warp {}, {}{}untangle {}, write {}",
        report.threads,
        readable(report.seconds.read),
        readable(report.seconds.bind),
        sum(|drape| drape.seconds.fit),
        sum(|drape| drape.seconds.warp),
        match &report.network {
            Some(_) => format!("network {}, ", sum(|drape| drape.seconds.network)),
            None => String::new(),
        },
        match report.settle_frames {
            0 => String::new(),
            _ => format!("settle {}, ", sum(|drape| drape.seconds.settle)),
        },
        sum(|drape| drape.seconds.untangle),
        sum(|drape| drape.seconds.write)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn warning(kind: &'static str, number: usize, severity: f64) -> WarningReport {
        WarningReport {
            kind,
            path: format!("{number}.obj"),
            count: None,
            text: format!("{kind} {number}"),
            severity,
        }
    }

    #[test]
    fn many_warnings_of_a_kind_are_one_line_with_the_worst() {
        let torn = (0..6).map(|number| warning("torn", number, [2.1, 2.2, 4.0][number % 3]));
        let mut all: Vec<WarningReport> = torn.collect();
        all.insert(1, warning("components", 9, 2.0));
        let lines = lines_of(&all);
        assert_eq!(lines.len(), 2, "{lines:?}");
        assert!(
            lines[0].starts_with("`torn` for 6 outputs, the first `0.obj`"),
            "{lines:?}"
        );
        assert!(lines[0].ends_with("the worst: torn 2"), "{lines:?}");
        assert_eq!(lines[1], "components 9");
        all.pop();
        assert_eq!(lines_of(&all).len(), all.len());
    }
}
