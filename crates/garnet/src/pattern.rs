//! Sewing patterns, cut for a body.

pub use garnet_pattern::{
    Ease, Fit, GarmentKind, LEAST_ANGLE, Landmark, Landmarks, Line, Measures, Panel, Parameter,
    ParameterSpec, ParameterUnit, Parameters, PatternError, PatternLength, SewnGarment, Size,
    Template, VERTEX_RANGE, Wearer,
};
