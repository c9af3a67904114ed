//! Materials of an OBJ: color, opacity, and the picture of the color.

use std::path::{Path, PathBuf};

use garnet_mesh::{read_bounded, stays_inside};

use super::{file::ObjFile, look::ObjLook};

/// Files of materials that are larger are left out, in bytes.
const MAX_LIBRARY: u64 = 16 << 20;

/// Pictures that are larger are left out, in bytes.
const MAX_PICTURE: u64 = 64 << 20;

/// A material of an OBJ.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ObjMaterial {
    /// Its name.
    pub name: String,
    /// Red, green, blue and opacity, from 0 to 1.
    pub color: [f32; 4],
    /// The picture of its color, of those of the file.
    pub picture: Option<usize>,
}

/// The picture of a material, as the file has it: PNG or JPEG.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ObjPicture {
    /// The path that the material names.
    pub name: String,
    /// The kind: `image/png` or `image/jpeg`.
    pub kind: &'static str,
    /// The bytes of the file.
    pub bytes: Vec<u8>,
}

/// Materials that an OBJ names, and their pictures.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ObjMaterials {
    /// In the order of [`ObjLook::materials`].
    pub materials: Vec<ObjMaterial>,
    /// Pictures that they name.
    pub pictures: Vec<ObjPicture>,
    /// Files that are named, and not there, not readable, or not in the folder of the OBJ.
    pub missing: Vec<String>,
}

impl ObjMaterials {
    /// Reads the materials of a file. What cannot be read leaves them white: the mesh is what
    /// matters.
    pub fn read(file: &ObjFile, look: &ObjLook) -> Self {
        let folder = file.path().parent().unwrap_or(Path::new(""));
        let mut found = Self::default();
        found.materials = found.read_more(look, folder);
        found
    }

    /// The materials of a mesh, in its order, with their files in a folder.
    pub(crate) fn read_more(&mut self, look: &ObjLook, folder: &Path) -> Vec<ObjMaterial> {
        let mut known = Vec::new();
        for library in &look.libraries {
            let path = beside(folder, library);
            let bytes = path.and_then(|path| read_bounded(&path, MAX_LIBRARY).ok());
            let read = bytes.and_then(|bytes| tobj::load_mtl_buf(&mut bytes.as_slice()).ok());
            match read {
                Some((materials, _)) => known.extend(materials),
                None => self.missing.push(library.clone()),
            }
        }
        let names = look.materials.iter();
        names
            .map(|name| self.material(name, &known, folder))
            .collect()
    }

    fn material(&mut self, name: &str, known: &[tobj::Material], folder: &Path) -> ObjMaterial {
        let found = known.iter().find(|material| material.name == *name);
        let diffuse = found.and_then(|material| material.diffuse);
        let opacity = found.and_then(|material| material.dissolve).unwrap_or(1.0);
        let named = found.and_then(|material| material.diffuse_texture.as_deref());
        let picture = named.and_then(|named| {
            let place = picture(folder, named, &mut self.pictures);
            if place.is_none() {
                self.missing.push(named.to_owned());
            }
            place
        });
        // Some programs write black beside a picture that is meant as it is.
        let is_black = diffuse.is_none_or(|color| color.iter().all(|&value| value <= 0.0));
        let [r, g, b] = match diffuse {
            Some(color) if !(is_black && picture.is_some()) => color,
            _ => [1.0; 3],
        };
        ObjMaterial {
            name: name.to_owned(),
            color: [r, g, b, opacity].map(|value| value.clamp(0.0, 1.0)),
            picture,
        }
    }
}

/// The number of a picture, which is read if it is new.
fn picture(folder: &Path, named: &str, pictures: &mut Vec<ObjPicture>) -> Option<usize> {
    if let Some(place) = pictures.iter().position(|picture| picture.name == named) {
        return Some(place);
    }
    let bytes = read_bounded(&beside(folder, named)?, MAX_PICTURE).ok()?;
    let kind = match bytes.as_slice() {
        [0x89, b'P', b'N', b'G', ..] => "image/png",
        [0xff, 0xd8, 0xff, ..] => "image/jpeg",
        _ => return None,
    };
    pictures.push(ObjPicture {
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
