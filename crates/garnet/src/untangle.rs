//! Penetrations: what there are, and what removed them.

pub use garnet_drape::{Penetration, penetration};
pub use garnet_untangle::{UntangleOptions, UntangleReport, free_crossing_faces};
