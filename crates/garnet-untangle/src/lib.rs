//! Frees a garment of penetrations with a smooth displacement, verifies and reports.
//!
//! ```
//! use garnet_mesh::primitives::{capsule, tube};
//! use garnet_skin::{Body, Garment, Joint, Point3, Pose, Skeleton, SkinWeights, Warp};
//! use garnet_untangle::{Binding, UntangleOptions, untangle};
//!
//! let limb = capsule(0.05, 0.4, 24, 24);
//! let joint = Joint {
//!     name: "limb".to_owned(),
//!     parent: None,
//!     rest_position: Point3::origin(),
//! };
//! let weights = SkinWeights::from_dense(1, &vec![1.0; limb.num_vertices()])?;
//! let body = Body::new(limb, Skeleton::new(vec![joint])?, weights)?;
//!
//! // A sleeve that is a little too tight.
//! let garment = Garment::new(tube(0.0495, 0.3, 32, 24)).bind(&body)?;
//! let binding = Binding::new(&garment)?;
//! let posed = body.posed(&Pose::rest(1))?;
//! let warped_nodes = garment.warped_nodes(&posed, Warp::Shape)?;
//!
//! let options = UntangleOptions::default();
//! let untangled = untangle(&garment, &binding, &posed, &warped_nodes, &options)?;
//! assert!(untangled.report.inside_before > 0);
//! assert_eq!(untangled.report.inside, 0);
//! assert!(untangled.report.min_distance >= options.clearance);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod binding;
mod cloth;
mod contact;
mod crossing;
mod directions;
mod layers;
mod lengths;
mod options;
mod passes;
mod region;
mod report;
mod skin_normals;
mod sweep;
mod tears;
mod untangle;
mod way_out;

pub use binding::{Binding, UntangleError};
pub use crossing::free_crossing_faces;
pub use options::UntangleOptions;
pub use report::UntangleReport;
pub use untangle::{Untangled, counted_again, untangle};
