//! Frees a garment of penetrations with a smooth displacement, verifies and reports.

mod binding;
mod cloth;
mod contact;
mod crossing;
mod directions;
mod embedded;
mod options;
mod region;
mod relax;
mod report;
mod rescue;
mod skin_normals;
mod sweep;
mod untangle;
mod verify;
mod way_out;

pub use binding::{Binding, UntangleError};
pub use options::UntangleOptions;
pub use report::UntangleReport;
pub use untangle::{Untangled, untangle};
