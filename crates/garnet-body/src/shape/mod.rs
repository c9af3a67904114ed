//! The shape of a human body from tape measures.
