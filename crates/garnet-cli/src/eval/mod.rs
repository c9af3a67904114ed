//! `garnet eval`: networks beside the warp, on a data set.

mod args;
mod curves;
mod report;

use std::time::Instant;

use garnet::train::{EvalEvent, Stage, evaluate};

pub(crate) use args::{EvalArgs, candidates, check_apart};
use report::EvalReport;

use crate::{
    console::{Console, print_data, print_document},
    dataset::read_package,
    failure::ExitStatus,
    hints::{advised, advised_on},
    output,
};

/// Measures, prints the table, and writes report and curves.
pub(crate) fn run(args: &EvalArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    let start = Instant::now();
    args.check()?;
    let package = read_package(&args.package)?;
    args.check_apart(&package.manifest)?;
    // What is misspelt is told before the data set is read.
    args.candidates(&package, false)?;
    let stage = Stage::open(&args.package, &args.dataset).map_err(advised)?;
    let is_size = stage.package.manifest.positions != package.manifest.positions;
    let candidates = args.candidates(&package, is_size)?;
    let mut bar = None;
    let mut observer = |event| {
        if let EvalEvent::Scene { done, total } = event {
            let bar = bar.get_or_insert_with(|| console.progress(total));
            bar.set_position(done as u64);
        }
    };
    let found = evaluate(
        &stage,
        args.split(),
        &candidates,
        args.finish(),
        &mut observer,
    );
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    let found = found.map_err(|error| advised_on(error, &args.dataset))?;
    let report = EvalReport::new(&found, args, &stage, start.elapsed());
    if let Some(folder) = &args.curves {
        output::open_folder(folder)?;
        curves::write(folder, &found)?;
    }
    if let Some(path) = &args.report {
        let mut text = serde_json::to_string_pretty(&report)?;
        text.push('\n');
        output::write(path, text.as_bytes())?;
    }
    if console.is_json() {
        print_document(&report)?;
    } else {
        print_data(&report.to_string())?;
    }
    Ok(judge(&report, args, console))
}

/// Whether all networks are within the limit that the user set.
fn judge(report: &EvalReport, args: &EvalArgs, console: &Console) -> ExitStatus {
    let Some(limit) = args.max_error else {
        return ExitStatus::Done;
    };
    let networks = report
        .methods
        .iter()
        .filter(|method| method.weights.is_some())
        .filter(|method| method.settle_frames == 0 || method.has_to_settle);
    let beyond = networks.filter(|method| method.scores.distance > f64::from(limit));
    let Some(worst) = beyond.max_by(|a, b| a.scores.distance.total_cmp(&b.scores.distance)) else {
        return ExitStatus::Done;
    };
    console.exceeded(&[format!(
        "`{}` is {:.2} mm from the simulation in the mean, more than {} mm",
        worst.name,
        1e3 * worst.scores.distance,
        1e3 * limit
    )]);
    ExitStatus::LimitExceeded
}
