//! Where a motion goes, and how fast: arguments of `drape`, `simulate` and `body`.

use clap::Args;
use garnet::io::{MotionOptions, PoseSource};

use crate::failure::refused;

/// Under what arguments about poses stand in the help.
pub(crate) const POSES: &str = "Poses and motions";

/// Arguments about motions.
#[derive(Debug, Clone, Copy, Default, Args)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a flag of the command line"
)]
pub(crate) struct MotionArgs {
    /// Stand a motion on the floor (y = 0): a single frame, or the lowest of all frames; without
    /// it, heights are those of the recording.
    #[arg(long, help_heading = POSES)]
    pub(crate) ground: bool,
    /// Keep a motion above the origin; without it, it goes where the recording goes, scaled by the
    /// length of the legs.
    #[arg(long, help_heading = POSES)]
    pub(crate) in_place: bool,
    /// Play a motion anew with so many frames a second.
    #[arg(long, help_heading = POSES, value_name = "N", value_parser = fps, allow_negative_numbers = true)]
    pub(crate) fps: Option<f64>,
    /// Leave joints that a recording turns over from one frame to the next as they are, instead of
    /// turning them within a fifth of a second.
    #[arg(long, help_heading = POSES, hide_short_help = true)]
    pub(crate) keep_flips: bool,
    /// Leave arms where a recording has them, instead of keeping them out of a trunk that is
    /// broader than the recorded one.
    #[arg(long, help_heading = POSES, hide_short_help = true)]
    pub(crate) keep_arms: bool,
}

impl MotionArgs {
    /// Refuses options of motions where there is no pose; `--pose-up` is one, too.
    pub(crate) fn check(self, pose: Option<&PoseSource>, has_pose_up: bool) -> anyhow::Result<()> {
        let options = [
            (self.ground, "--ground"),
            (self.in_place, "--in-place"),
            (self.fps.is_some(), "--fps"),
            (self.keep_flips, "--keep-flips"),
            (self.keep_arms, "--keep-arms"),
            (has_pose_up, "--pose-up"),
        ];
        match options.into_iter().find(|(is_given, _)| *is_given) {
            Some((_, option)) if pose.is_none() => Err(refused(
                format!("`{option}` is given without a pose"),
                "it is for the poses and motions of `--pose`",
                format!("add `--pose`, or leave out `{option}`"),
            )),
            _ => Ok(()),
        }
    }

    pub(crate) fn options(self) -> MotionOptions {
        MotionOptions {
            on_ground: self.ground,
            in_place: self.in_place,
            fps: self.fps,
            keep_flips: self.keep_flips,
            keep_arms: self.keep_arms,
        }
    }
}

fn fps(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(fps) if (0.001..=10_000.0).contains(&fps) => Ok(fps),
        _ => Err("expected frames a second, from 0.001 to 10000".to_owned()),
    }
}
