//! Poses of the built-in body: a library and a sampler.
