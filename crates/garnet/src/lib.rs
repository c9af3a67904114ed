//! Drapes a garment mesh on a body mesh: bind once, drape many.
//!
//! A garment lies on a body in its rest pose. [`Garment::bind`] computes once what does not depend
//! on the pose; [`Draper::drape`] then takes milliseconds for each pose: it warps the garment by
//! dual-quaternion skinning and frees it of every penetration.
//!
//! The root has the 26 names that a drape needs, with the default features; all others are in the
//! modules, one for each crate of the workspace.
//!
//! ```
//! use garnet::{Body, Draper, Garment, Joint, Point3, Pose, Skeleton, SkinWeights, UnitQuaternion, Vector3, mesh::primitives};
//!
//! // An arm of two bones along y, bent at the elbow, in a sleeve.
//! let arm = primitives::capsule(0.05, 0.6, 24, 24);
//! let joint = |name: &str, parent, y| Joint {
//!     name: name.to_owned(),
//!     parent,
//!     rest_position: Point3::new(0.0, y, 0.0),
//! };
//! let skeleton = Skeleton::new(vec![joint("shoulder", None, -0.3), joint("elbow", Some(0), 0.0)])?;
//! let forearm = |p: &Point3| (0.5 + p.y / 0.1).clamp(0.0, 1.0);
//! let rows = arm.positions().iter().map(|p| [(0, 1.0 - forearm(p)), (1, forearm(p))]);
//! let weights = SkinWeights::from_influences(2, rows)?;
//! let body = Body::new(arm, skeleton, weights)?;
//! let sleeve = primitives::tube(0.06, 0.4, 32, 30);
//!
//! let garment = Garment::new(sleeve).bind(&body)?;
//! let mut pose = Pose::rest(2);
//! pose.rotations[1] = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 1.2);
//! let draper = Draper::new(garment);
//! let drape = draper.drape(&body.posed(&pose)?)?;
//!
//! assert_eq!(drape.positions.len(), draper.garment().mesh().num_vertices());
//! assert_eq!(drape.report.map(|report| report.inside), Some(0));
//! # Ok::<(), garnet::Error>(())
//! ```

pub mod body;
#[cfg(feature = "train")]
pub mod data;
pub mod drape;
pub mod io;
pub mod knn;
pub mod mesh;
#[cfg(feature = "package")]
pub mod net;
#[cfg(feature = "package")]
pub mod package;
#[cfg(feature = "train")]
pub mod pattern;
#[cfg(feature = "package")]
pub mod sim;
pub mod skin;
#[cfg(feature = "train")]
pub mod stress;
#[cfg(feature = "train")]
pub mod train;
pub mod untangle;

pub use garnet_drape::{
    BoundGarment, Drape, DrapeOptions, DrapeSeconds, Draper, Error, Fallback, Garment, Provenance,
};
#[cfg(feature = "package")]
pub use garnet_drape::{Choice, Limit, Package};
pub use garnet_mesh::{Point3, TriMesh, Vector3};
pub use garnet_skin::{Body, Joint, Pose, PosedBody, Rig, Skeleton, SkinWeights, Warp};
pub use nalgebra::{Isometry3, Quaternion, UnitQuaternion};

/// Compiles the program of the README.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
