//! The rest shape of a sewn garment as a file.

use std::path::Path;

use garnet_mesh::{MOST_BYTES, StagedFile, read_bounded};
use garnet_sim::{GRIP, RestShape};

use super::PackageError;
use crate::tensors::{Array, Contents, to_bytes};

const SCHEMA: &str = "garnet.rest/1";

/// Writes tensors `corners` `[face, 3, 2]`, metres, `shrink` `[face]` and, if it is not that of
/// waistbands, `grip` `[1]`, beside their place; the text is the schema and the checksum. A garment
/// without pattern needs no file: none.
pub(crate) fn stage(path: &Path, rest: &RestShape) -> Result<Option<StagedFile>, PackageError> {
    let RestShape::Flat {
        corners,
        shrink,
        grip,
    } = rest
    else {
        return Ok(None);
    };
    let corners = Array {
        shape: vec![corners.len(), 3, 2],
        values: corners.as_flattened().as_flattened().to_vec(),
    };
    let shrink = Array {
        shape: vec![shrink.len()],
        values: shrink.clone(),
    };
    let grip = Array {
        shape: vec![1],
        values: vec![*grip],
    };
    let mut arrays = vec![("corners", &corners), ("shrink", &shrink)];
    if grip.values != [GRIP] {
        arrays.push(("grip", &grip));
    }
    let bytes = to_bytes(&arrays, SCHEMA, |checksum| format!("{SCHEMA} {checksum}"));
    let bytes = bytes.map_err(|source| PackageError::tensors(path, source))?;
    Ok(Some(StagedFile::new(path, |writer| {
        writer.write_all(&bytes)
    })?))
}

/// Reads the file of a garment of so many faces.
pub(crate) fn read(path: &Path, num_faces: usize) -> Result<RestShape, PackageError> {
    let bytes =
        read_bounded(path, MOST_BYTES).map_err(|source| PackageError::read(path, source))?;
    let contents = Contents::of(&bytes).map_err(|source| PackageError::tensors(path, source))?;
    let foreign = |what: String| PackageError::foreign(path, what);
    let no_rest = || foreign(format!("it is no `{SCHEMA}`"));
    let contents = contents.ok_or_else(no_rest)?;
    match contents.text.split_once(' ') {
        Some((SCHEMA, expected)) => {
            PackageError::check(path, contents.checksum(SCHEMA), expected)?;
        }
        // Of an earlier version.
        None if contents.text == SCHEMA => {}
        _ => return Err(no_rest()),
    }
    if let Some(name) = contents.foreign(&["corners", "shrink", "grip"]) {
        return Err(foreign(format!(
            "its tensor `{name}` is none of a rest shape"
        )));
    }
    let array = |name: &str, shape: &[usize]| {
        let array = contents.array(name).filter(|array| array.shape == shape);
        let what = format!("it has no tensor `{name}` of shape {shape:?}");
        array.ok_or_else(|| foreign(what))
    };
    let corners = array("corners", &[num_faces, 3, 2])?.values;
    let corners: Vec<[[f32; 2]; 3]> = corners.as_chunks::<2>().0.as_chunks::<3>().0.to_vec();
    let shrink = array("shrink", &[num_faces])?.values;
    let grip = match contents.array("grip") {
        Some(_) => array("grip", &[1])?.values[0],
        None => GRIP,
    };
    Ok(RestShape::Flat {
        corners,
        shrink,
        grip,
    })
}
