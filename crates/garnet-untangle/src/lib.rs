//! Frees a garment of penetrations with a smooth displacement, verifies and reports.
