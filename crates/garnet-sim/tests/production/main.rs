//! The production solver on small scenes with known answers.

mod bad_input;
mod balance;
mod body;
mod free;
mod stage;
