//! Meshes that the benches share.
