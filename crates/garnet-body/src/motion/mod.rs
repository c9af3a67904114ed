//! Motions, and carrying them over to other skeletons.
//!
//! A [`Motion`] is a skeleton at rest and one [`Pose`](garnet_skin::Pose) of it a frame, in metres
//! and Y up, whatever file it came from. A [`Retarget`] carries it over to another skeleton by the
//! meaning of the joints and the directions of the bones in the world: two skeletons whose rest
//! poses differ (a T-pose and arms half down, legs together and legs spread) still show the same
//! motion.

mod clip;
mod error;
mod figure;
mod flips;
mod frames;
mod ground;
mod hinges;
mod joint_names;
mod joint_search;
mod joint_tree;
mod retarget;
mod rotation;
mod upward;

pub use clip::{Motion, ReadOptions};
pub use error::{FrameRangeError, RetargetError};
pub use figure::{Figure, joint_named};
pub use frames::FrameRange;
pub use ground::{Ground, lowest_points, put_on_ground};
pub use joint_names::{Role, Side, role_names};
pub use retarget::{Retarget, RetargetOptions, StartAt};
pub(crate) use rotation::Direction;
pub use rotation::{pose_between, smallest_rotation, world_rotations};
pub use upward::Upward;
