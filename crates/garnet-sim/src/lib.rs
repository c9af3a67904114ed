//! Physics-based simulation of cloth on a moving body.
//!
//! A [`Cloth`] is made once of a garment mesh, its [`RestShape`] and a [`Fabric`]. [`drape`] takes
//! it from where it lies on a body at rest to the body's last place, along a [`Schedule`] of fixed
//! steps, and reports how it lies there.

mod along;
mod body_on_way;
mod cloth;
mod collider;
mod contact;
mod drape;
mod error;
mod fabric;
mod layers;
mod moment;
pub mod reference;
mod report;
mod rest_shape;
mod scene;
mod schedule;
mod solver;
mod xpbd;

pub use along::{MovingCloth, go_along};
pub use cloth::{BENDING_FACTOR, BendingHinge, Cloth, Spring};
pub use collider::{Collider, MAX_PARTS, Motion};
pub use drape::{Drape, Event, drape, settle};
pub use error::SimError;
pub use fabric::{DEFAULT_THICKNESS, FABRIC_NAMES, Fabric, USUAL_COMPRESSION};
pub use garnet_mesh::{Point3, Vector3};
pub use moment::{FALLEN, Moment};
pub use report::{
    DrapeReport, Energy, Lost, Penetration, STILL_SPEED, SelfIntersections, Speeds, Strain,
};
pub use rest_shape::{GRIP, RestShape};
pub use scene::{MovingBody, Scene, Wind};
pub use schedule::{
    MAX_SUBSTEPS, Quality, STANDARD_GRAVITY, Schedule, SelfContact, SettleFrames, Stage,
};
