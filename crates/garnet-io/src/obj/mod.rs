//! OBJ: meshes in, and the same text with other positions out.

mod error;
mod file;
mod foreign;
mod look;
mod material;
mod normals;
mod output;
mod parse;
mod scan;
mod words;

pub use error::{ObjElement, ObjError, ObjLineProblem, ObjParseError};
pub use file::ObjFile;
pub use look::ObjLook;
pub use material::{ObjMaterial, ObjMaterials, ObjPicture};
pub use output::write_obj;
