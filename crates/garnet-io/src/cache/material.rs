//! Materials of an OBJ, as far as glTF needs them: color, opacity, and the picture of the color.

use std::path::{Path, PathBuf};

use garnet_mesh::{read_bounded, stays_inside};

use super::CachePart;

/// Files of materials that are larger are left out, in bytes.
const MAX_LIBRARY: u64 = 16 << 20;

/// Pictures that are larger are left out, in bytes.
const MAX_PICTURE: u64 = 64 << 20;

/// A material.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Material {
    pub(super) name: String,
    /// Red, green, blue and opacity, from 0 to 1.
    pub(super) color: [f32; 4],
    /// The picture of its color, of those of the file.
    pub(super) picture: Option<usize>,
}

/// A PNG or JPEG.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Picture {
    pub(super) name: String,
    pub(super) kind: &'static str,
    pub(super) bytes: Vec<u8>,
}

/// The materials of a mesh, in its order. Files that are not there or not readable leave materials
/// white: the mesh is what matters.
pub(super) fn materials(part: &CachePart, pictures: &mut Vec<Picture>) -> Vec<Material> {
    let mut known = Vec::new();
    for library in &part.look.libraries {
        let bytes =
            beside(&part.folder, library).and_then(|path| read_bounded(&path, MAX_LIBRARY).ok());
        let read = bytes.and_then(|bytes| tobj::load_mtl_buf(&mut bytes.as_slice()).ok());
        known.extend(read.map_or(Vec::new(), |(materials, _)| materials));
    }
    let of_name = |name: &String| {
        let found = known.iter().find(|material| material.name == *name);
        let [r, g, b] = found
            .and_then(|material| material.diffuse)
            .unwrap_or([1.0; 3]);
        let opacity = found.and_then(|material| material.dissolve).unwrap_or(1.0);
        let named = found.and_then(|material| material.diffuse_texture.as_deref());
        Material {
            name: name.clone(),
            color: [r, g, b, opacity].map(|value| value.clamp(0.0, 1.0)),
            picture: named.and_then(|named| picture(&part.folder, named, pictures)),
        }
    };
    part.look.materials.iter().map(of_name).collect()
}

/// The number of a picture, which is read if it is new.
fn picture(folder: &Path, named: &str, pictures: &mut Vec<Picture>) -> Option<usize> {
    if let Some(place) = pictures.iter().position(|picture| picture.name == named) {
        return Some(place);
    }
    let bytes = read_bounded(&beside(folder, named)?, MAX_PICTURE).ok()?;
    let kind = match bytes.as_slice() {
        [0x89, b'P', b'N', b'G', ..] => "image/png",
        [0xff, 0xd8, 0xff, ..] => "image/jpeg",
        _ => return None,
    };
    pictures.push(Picture {
        name: named.to_owned(),
        kind,
        bytes,
    });
    Some(pictures.len() - 1)
}

/// A file that another one names, if it is in the folder of that or below.
fn beside(folder: &Path, named: &str) -> Option<PathBuf> {
    let named = named.replace('\\', "/");
    stays_inside(&named).then(|| folder.join(named))
}
