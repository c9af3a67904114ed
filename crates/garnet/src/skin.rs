//! Skinning: methods, weight transfer, bodies at home.

pub use garnet_skin::{BodyAtHome, Method, SkinError, TransferOptions, WarpedGarment, scale_of};
