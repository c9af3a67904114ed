//! Poses of a human body: a library in anatomical angles, a gait cycle, a sampler, self-contact.
//!
//! [`BodyAngles`] describe a pose as a physiotherapist does, in degrees of flexion, abduction and
//! rotation from upright standing with hanging arms. A [`Poser`] turns them into a
//! [`Pose`](garnet_skin::Pose) of any human skeleton, whatever its rest pose: arms at 0 degrees
//! hang on every body. [`SEQUENCES`] are chains of key poses; a [`PoseSampler`] draws poses along
//! them and along the gait cycle, with noise inside the ranges of motion. [`SelfContact`] measures
//! how deep the parts of a posed body run into each other and pushes them apart.
//!
//! ```no_run
//! use garnet_body::poses::{PoseSampler, Poser, SelfContact};
//!
//! # fn example(body: &garnet_skin::Body) -> Result<(), Box<dyn std::error::Error>> {
//! let sampler = PoseSampler::new(7);
//! let poser = Poser::new(body.skeleton())?;
//! let pose = poser.pose(&sampler.sample(12).angles);
//!
//! let contact = SelfContact::new(body)?;
//! let sound = sampler.sample_for(&poser, &contact, 12)?;
//! println!("{}: {:?}", sound.sequence, sound.outcome);
//! # Ok(())
//! # }
//! ```

mod angles;
mod contact;
mod eased;
mod folds;
mod gait;
mod key_pose;
mod library;
mod parts;
mod poser;
mod ranges;
mod sampler;
mod separate;
mod sequences;

pub use angles::{Arm, Bend, BodyAngles, Leg, NUM_ANGLES};
pub use contact::{Contact, ContactKind, ContactReport, SelfContact};
pub use eased::{Timing, Turns, turn};
pub use folds::{SkinFolds, skin_folds};
pub use gait::GaitCycle;
pub use key_pose::{KeyPose, key_pose, key_poses, key_poses_of};
pub use parts::{Part, parts_of_vertices};
pub use poser::Poser;
pub use ranges::{Range, ranges};
pub use sampler::{Outcome, PoseSampler, SampleError, SampledPose, SoundPose};
pub use separate::{Separated, SeparationOptions};
pub use sequences::{Group, SEQUENCES, Sequence, SequenceSet};
