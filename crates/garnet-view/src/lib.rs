//! Pictures: shaded PNG of meshes.
