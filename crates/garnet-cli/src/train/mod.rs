//! `garnet train`: a network for a garment.

mod args;
mod curves;
mod followed;
mod progress;
mod report;

use std::{
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
    time::Instant,
};

use garnet::{
    io::remove_stale_temporaries,
    package::GarmentPackage,
    train::{TrainJob, train, training_folder},
};

pub(crate) use args::TrainArgs;
use progress::Progress;
use report::TrainReport;

use crate::{
    console::{Console, print_document},
    dataset::read_package,
    failure::{ExitStatus, Hint},
    hints::{advised, advised_on},
    interrupt::tell_on_interrupt,
    output,
};

/// Trains, or goes on with a training, and adds the network to the package.
pub(crate) fn run(args: &TrainArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    let start = Instant::now();
    if !GarmentPackage::is_at(&args.package) {
        read_package(&args.package)?;
    }
    let job = args.job()?;
    check_apart(&job, args)?;
    let folder = training_folder(&job.package, &job.recipe.name);
    for folder in [&job.package, &folder] {
        remove_stale_temporaries(folder);
    }
    let told = format!(
        "`{}` keeps the last state that was written: `--resume` goes on from it",
        folder.display()
    );
    tell_on_interrupt(told, vec![folder.clone()], console)?;
    let mut progress = Progress::new(console, &job, &folder);
    let trained = train(
        &job,
        &mut |event| progress.tell(event),
        &AtomicBool::new(false),
    );
    progress.finish();
    let trained = trained.map_err(|error| match job.more[..] {
        [] => advised_on(error, &job.dataset),
        _ => advised(error),
    })?;
    let report = TrainReport::new(&trained, &folder, progress.start(), start.elapsed());
    if console.is_json() {
        print_document(&report)?;
    }
    console.summary(&report);
    Ok(ExitStatus::Done)
}

/// Refuses weights that would take the place of those that they start from, or of the
/// configuration or data that they learn from.
fn check_apart(job: &TrainJob, args: &TrainArgs) -> anyhow::Result<()> {
    let weights = job.weights();
    let datasets = std::iter::once(&job.dataset).chain(&job.more);
    let datasets = datasets.flat_map(|folder| output::files_of_dataset(folder));
    let read: Vec<PathBuf> = job.base.iter().chain(&args.config).cloned().collect();
    let read: Vec<PathBuf> = read.into_iter().chain(datasets).collect();
    let read: Vec<&Path> = read.iter().map(PathBuf::as_path).collect();
    output::check_apart(&[&weights], &read)
        .hint(|| "give the variant another name with `--variant`".to_owned())
}
