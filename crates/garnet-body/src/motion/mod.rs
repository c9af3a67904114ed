//! Motion files and retargeting.
//!
//! A [`Motion`] is a skeleton at rest and one [`Pose`](garnet_skin::Pose) of it a frame, in metres
//! and Y up, whatever file it came from. A [`Retarget`] carries it over to another skeleton by the
//! names of the joints and the directions of the bones in the world: two skeletons whose rest poses
//! differ (a T-pose and arms half down, legs together and legs spread) still show the same motion.
//!
//! ```no_run
//! use garnet_body::motion::{Ground, ReadOptions, RetargetOptions, Take, put_on_ground};
//!
//! # fn example(body: &garnet_skin::Body) -> Result<(), Box<dyn std::error::Error>> {
//! let take = Take::read("walk.bvh", &ReadOptions::default())?;
//! let mut poses = take.poses(body.skeleton(), "0:120:4".parse()?, &RetargetOptions::default())?;
//! put_on_ground(body, &mut poses, Ground::Clip)?;
//! # Ok(())
//! # }
//! ```

mod bvh;
mod bvh_text;
mod clip;
mod error;
mod figure;
mod frames;
mod ground;
mod joint_names;
mod retarget;
mod rotation;
mod smpl;
mod take;

pub use clip::{Motion, ReadOptions};
pub use error::{FrameRangeError, MotionError, MotionProblem, RetargetError};
pub use figure::Figure;
pub use frames::FrameRange;
pub use ground::{Ground, lowest_points, put_on_ground};
pub use joint_names::{Role, Side, role_names};
pub use retarget::{Retarget, RetargetOptions, StartAt};
pub(crate) use rotation::Direction;
pub use rotation::{smallest_rotation, world_rotations};
pub use take::{Take, TakeError};
