//! Cloth on a moving body.

pub use garnet_sim::{
    BENDING_FACTOR, BendingHinge, Cloth, Collider, DEFAULT_THICKNESS, Drape, DrapeReport, Energy,
    Event, FABRIC_NAMES, FALLEN, Fabric, GRIP, Lost, MAX_PARTS, MAX_SUBSTEPS, Motion, MovingBody,
    Penetration, Quality, RestShape, STANDARD_GRAVITY, STILL_SPEED, Scene, Schedule, SelfContact,
    SelfIntersections, SettleFrames, SimError, Speeds, Spring, Stage, Strain, USUAL_COMPRESSION,
    Wind, drape, reference, settle,
};
