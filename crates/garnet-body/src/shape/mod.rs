//! The shape of a human body from tape measures.
//!
//! A few measures are enough: [`BodyParameters`] says what is known, the statistics of a population
//! complete the rest, and [`ParametricBody::build`] makes a mesh on which a tape measures what was
//! asked for. In between stands a smooth signed-distance function of lofted sections and blended
//! solids ([`BodySurface`]); one template mesh is carried onto its zero set, so that the vertices
//! of all bodies correspond. [`Population`] draws random bodies.
//!
//! ```
//! use garnet_body::shape::{BodyParameters, Measure, ParametricBody};
//!
//! let tall = ParametricBody::build(&BodyParameters::new(0.0).with(Measure::Stature, 1.90).with_bmi(23.0))?;
//! assert!((tall.measures()[Measure::Stature] - 1.90).abs() < 0.002);
//! assert!((tall.mass() / (23.0 * 1.90 * 1.90) - 1.0).abs() < 0.04);
//! # Ok::<(), garnet_body::shape::ShapeError>(())
//! ```

mod anatomy;
mod anthropometry;
mod arm;
mod body;
mod carry;
mod curve;
mod error;
mod field;
mod fit;
mod guide;
mod head;
mod leg;
mod measure;
mod parameters;
mod population;
mod population_model;
mod primitives;
mod recognize;
mod skeleton;
mod surface;
mod tape;
mod tape_on;
mod template;
mod torso;

pub use body::{ParametricBody, tape_measures};
pub use error::ShapeError;
pub use measure::{Measure, Measures};
pub use parameters::{BMI_RANGE, BodyParameters, STATURE_RANGE};
pub use population::{Population, SAMPLED_BMI, SAMPLED_STATURES};
pub use recognize::{Recognized, recognized, times_as_large, unposed};
pub use skeleton::{JOINT_NAMES, JOINT_PARENTS, NUM_JOINTS};
pub use surface::BodySurface;
pub use tape::{BODY_DENSITY, TapePlane};
pub use tape_on::{Tape, Tube, standing};
