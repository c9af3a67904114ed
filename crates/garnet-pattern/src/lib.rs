//! Sewing patterns to sewn garment meshes that are not yet worn: T-shirt, sweater, dress and jeans.
//!
//! Parameters and the measures of a body give the outlines of panels. The mean pattern of a
//! garment is triangulated once ([`Template`]); for all other parameters and bodies the outlines
//! move and the inside follows harmonically, so that all garments of a template have the same
//! faces. Points of a seam are one vertex. The result ([`SewnGarment`]) knows the flat pattern,
//! from which rest lengths follow, and a start shape around the wearer's rest body that touches
//! neither the body nor itself: a simulation contracts it.
//!
//! ```
//! use garnet_pattern::{GarmentKind, Template, Wearer};
//!
//! let template = Template::new(GarmentKind::Tshirt, 1500)?;
//! let mut parameters = GarmentKind::Tshirt.parameters();
//! parameters.set("sleeve", 0.30)?;
//! let shirt = template.made_to_measure(&parameters, &Wearer::reference())?;
//! assert_eq!(shirt.panels[0].name, "front");
//! assert_eq!(shirt.start_mesh().num_faces(), shirt.faces.len());
//! # Ok::<(), garnet_pattern::PatternError>(())
//! ```

mod assembly;
mod bodice;
mod curve;
mod draft;
mod dress;
mod edge_length;
mod error;
mod fit;
mod garments;
mod harmonic;
mod jeans;
mod leg_start;
mod mend;
mod numbering;
mod parameters;
mod reference;
mod sewn;
mod shirt;
mod size;
mod sleeve;
mod start;
mod template;
mod top_start;
mod triangulate;
mod union;
mod wearer;

pub use error::{PatternError, PatternLength};
pub use fit::{Band, Ease, Finished, Fit};
pub use garments::GarmentKind;
pub use garnet_mesh::Point3;
pub use parameters::{Parameter, ParameterSpec, ParameterUnit, Parameters};
pub use sewn::{Line, Panel, SewnGarment};
pub use size::Size;
pub use template::{LEAST_ANGLE, Template, VERTEX_RANGE};
pub use wearer::{Landmark, Landmarks, Measures, Wearer};
