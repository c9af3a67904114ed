//! The library of key poses.
//!
//! Angles in degrees, as in [`BodyAngles`](super::BodyAngles): `pelvis`, `spine` and `neck` take
//! flexion, side bend to the left and turn to the left; `leg` and `arm` flexion, abduction and
//! outward rotation. Poses to one side are written for the left; sequences mirror them.

mod dance;
mod everyday;
mod reach;
mod yoga;

pub(super) use dance::DANCE;
pub(super) use everyday::EVERYDAY;
pub(super) use reach::REACH;
pub(super) use yoga::YOGA;
