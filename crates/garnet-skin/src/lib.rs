//! Skeletons, poses, weights, dual-quaternion skinning, weight transfer to garments, pose recovery.
//!
//! ```
//! use garnet_mesh::TriMesh;
//! use garnet_skin::{
//!     Body, Joint, Method, Point3, Pose, SkinWeights, Skeleton, Vector3, recover_pose,
//! };
//!
//! let corners = [[0.0, 0.0], [0.1, 0.0], [0.0, 0.4], [0.1, 0.8]];
//! let positions = corners.map(|[x, y]| Point3::new(x, y, 0.0));
//! let mesh = TriMesh::new(positions.to_vec(), vec![[0, 1, 2], [1, 3, 2]])?;
//! let joint = |name: &str, parent, y| Joint {
//!     name: name.to_owned(),
//!     parent,
//!     rest_position: Point3::new(0.0, y, 0.0),
//! };
//! let skeleton = Skeleton::new(vec![joint("hip", None, 0.0), joint("knee", Some(0), 0.4)])?;
//! let weights = SkinWeights::from_dense(2, &[1.0, 0.0, 1.0, 0.0, 0.5, 0.5, 0.0, 1.0])?;
//! let body = Body::new(mesh, skeleton, weights)?;
//!
//! let mut pose = Pose::rest(2);
//! pose.root_translation = Vector3::new(0.0, 1.0, 0.0);
//! let posed = body.posed_positions(&pose, Method::DualQuaternion)?;
//! assert!((posed[3].y - 1.8).abs() < 1e-5);
//!
//! let recovered = recover_pose(&body, &posed)?;
//! assert!(recovered.max_residual_m < 1e-5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod at_home;
mod body;
mod caps;
mod cloth_graph;
mod dual_quaternion;
mod error;
mod free_cloth;
mod garment;
mod holes;
mod pieces;
mod pose;
mod posed_body;
mod recover;
mod rigid;
mod scale;
mod screened_poisson;
mod shape;
mod symmetry;
mod transfer;
mod warped;
mod weld;

mod skeleton;
mod skinning;
mod weights;

pub use at_home::BodyAtHome;
pub use body::{Body, Rig};
pub use cloth_graph::{ClothGraph, HalfEdge};
pub use dual_quaternion::DualQuaternion;
pub use error::SkinError;
pub use garment::{BoundGarment, Garment, Warp};
pub use garnet_mesh::{Point3, Vector3};
pub use pose::{Pose, PoseFit};
pub use posed_body::PosedBody;
pub use recover::{RecoveredPose, recover_pose};
pub use rigid::{nearest_rotation, rigid_from_matrix};
pub use scale::scale_of;
pub use screened_poisson::ScreenedPoisson;
pub use skeleton::{Joint, Skeleton};
pub use skinning::{Method, blended_transforms, skin_dual_quaternion, skin_linear};
pub use symmetry::Symmetry;
pub use transfer::TransferOptions;
pub use warped::WarpedGarment;
pub use weights::{MAX_INFLUENCES, SkinWeights};
pub use weld::Weld;
