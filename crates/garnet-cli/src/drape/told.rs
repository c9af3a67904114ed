//! What `--verbose` tells of a drape while it is made.

use garnet::package::GarmentPackage;
use tracing::info;

use super::{
    args::{Job, NetworkChoice, Source},
    choice::ChoiceReport,
    prepared::Prepared,
    ready::{Ready, package_of},
};

/// The files that were read: which ones, how large, in which unit and axes.
pub(super) fn read(prepared: &Prepared, seconds: f64) {
    let (garment, frame) = (&prepared.garment_file, prepared.garment_frame);
    info!(
        path = %garment.path().display(),
        vertices = garment.num_vertices(),
        faces = garment.num_polygons(),
        unit = %frame.unit,
        up = %frame.up,
        is_refitted = prepared.refit.is_some(),
        "the garment"
    );
    let (rest, body) = (&prepared.rest, &prepared.body);
    info!(
        path = %rest.path.display(),
        rig = %rest.rig_path.display(),
        vertices = body.rest().num_vertices(),
        faces = body.rest().num_faces(),
        joints = body.skeleton().num_joints(),
        unit = %rest.frame.unit,
        up = %rest.frame.up,
        "the rest body"
    );
    let targets = prepared.targets.len();
    match (&prepared.pose, prepared.targets.first()) {
        (Some(pose), _) => info!(pose = %pose.path.display(), targets, "the posed body"),
        (None, Some(first)) => info!(path = %first.path.display(), targets, "the posed body"),
        (None, None) => info!(targets, "no body"),
    }
    info!(seconds, "read");
}

/// What drapes, and why that.
pub(super) fn method(ready: &Ready, job: &Job) {
    let network = ready.network_report();
    let weights = network.map(|network| network.weights);
    info!(
        method = ready.method_name(),
        weights,
        relax_frames = ready.relax_frames(),
        simulator = ready.draper.simulator().is_some(),
        untangles = ready.draper.options().untangle.is_some(),
        why = why(ready.choice.as_ref(), job),
        "the method"
    );
}

/// Why a garment is draped in the way that it is.
fn why(choice: Option<&ChoiceReport>, job: &Job) -> String {
    if let Some(choice) = choice {
        return choice.text.clone();
    }
    if job.simulation.is_some() {
        return "simulation was asked for".to_owned();
    }
    let why = match (&job.network, package_of(&job.source)) {
        (NetworkChoice::Named(name), _) => return format!("`--method {name}` names it"),
        (NetworkChoice::None, _) => "a method without a network was asked for",
        (NetworkChoice::Default, None) => match &job.source {
            Source::Scene(_) => "a scene has no variants",
            Source::Files(_) => "the garment is no package, and has no variants",
        },
        (NetworkChoice::Default, Some(folder)) => {
            let manifest = GarmentPackage::read_manifest(folder);
            let has_default = manifest.is_ok_and(|manifest| manifest.default_variant().is_some());
            if has_default {
                "it is the default of the package"
            } else {
                "the package has no variants"
            }
        }
    };
    why.to_owned()
}
