//! Whole trainings on small invented data sets.

#![allow(clippy::unwrap_used, reason = "tests")]

mod bad_input;
mod evaluation;
mod invented;
mod numbers;
mod pose_space;
mod states;
mod training;
