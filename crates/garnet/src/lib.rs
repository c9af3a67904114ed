//! Drapes a garment mesh on a body mesh: bind once, drape many.
