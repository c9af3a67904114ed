//! Physics-based simulation of cloth on a moving body.
