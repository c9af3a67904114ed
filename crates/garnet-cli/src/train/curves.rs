//! The loss curves as a picture.

use std::path::Path;

use garnet::train::EpochRecord;
use garnet_view::{Axis, Chart, Series};

use crate::output;

/// Draws training and validation loss over the epochs.
pub(super) fn draw(path: &Path, name: &str, epochs: &[EpochRecord]) -> anyhow::Result<()> {
    let series = |name: &str, value: fn(&EpochRecord) -> Option<f64>| Series {
        name: name.to_owned(),
        points: (epochs.iter())
            .filter_map(|record| Some([f64::from(record.epoch), value(record)?]))
            .collect(),
    };
    let chart = Chart::of_series(
        &format!("training of `{name}`"),
        [
            Axis::linear("epoch"),
            Axis::logarithmic("loss; distance in 0.1 m"),
        ],
        &[
            series("training", |record| record.loss),
            series("validation", |record| Some(record.valid_loss)),
            series("distance, validation", |record| {
                Some(10.0 * record.valid.distance)
            }),
        ],
    );
    output::write(path, chart.to_svg()?.as_bytes())
}
