//! Worn templates, garment packages, scenes and data sets.
