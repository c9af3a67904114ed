//! What is in a motion file.

use std::path::Path;

use garnet::{body::motion::ReadOptions, io::Take};
use serde::Serialize;

use super::table::Table;
use crate::failure::refused;

/// What is in a motion file.
#[derive(Debug, Serialize)]
pub(crate) struct MotionInfo {
    frames: usize,
    seconds_per_frame: Option<f64>,
    joints: Vec<String>,
    /// What was taken for granted.
    notes: Vec<String>,
}

impl MotionInfo {
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let take = Take::read(path, &ReadOptions::default())?;
        let motion = take.motion().ok_or_else(|| {
            refused(
                format!("`{}` is no motion", path.display()),
                "it holds poses without a skeleton",
                "name it `.json`",
            )
        })?;
        let joints = motion.skeleton.joints().iter();
        Ok(Self {
            frames: take.num_frames(),
            seconds_per_frame: take.frame_time(),
            joints: joints.map(|joint| joint.name.clone()).collect(),
            notes: motion.notes.clone(),
        })
    }

    pub(crate) fn fill(&self, table: &mut Table) {
        table.row("kind", "motion");
        table.row("frames", self.frames);
        match self.seconds_per_frame {
            Some(seconds) => table.row("frame time", format_args!("{:.2} ms", 1e3 * seconds)),
            None => table.row("frame time", "not told"),
        }
        table.row("joints", self.joints.join(", "));
        for note in &self.notes {
            table.row("note", note);
        }
    }
}
