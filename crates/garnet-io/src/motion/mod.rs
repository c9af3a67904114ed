//! Motion files: BVH, npz in the layout of AMASS and SMPL, pose JSON.

mod bvh;
mod bvh_text;
mod error;
mod smpl;
mod take;
mod turns;

pub use error::{MotionError, MotionProblem};
pub(crate) use smpl::JOINT_PARENTS;
#[cfg(test)]
pub(crate) use smpl::skeleton as smpl_skeleton;
pub use take::{Take, TakeError};
