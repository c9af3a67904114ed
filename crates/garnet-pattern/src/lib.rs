//! Sewing patterns to sewn garment meshes.
