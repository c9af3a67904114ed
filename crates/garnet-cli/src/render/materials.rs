//! Materials of OBJ files, as they are drawn.

use garnet::io::{ObjFile, ObjMaterials};
use garnet_view::{FaceMaterials, Material, Rgb, Texture};

/// How a mesh looks by the materials of its file.
#[derive(Debug, Default)]
pub(super) struct Look {
    /// Those of its faces; none if no material has a picture.
    pub(super) faces: Option<FaceMaterials>,
    /// What could not be read, for the user.
    pub(super) note: Option<String>,
}

/// Materials of a file whose faces have the color `plain` where they name none. Colors alone are
/// not shown: programs write the same grey for all.
pub(super) fn look_of(file: &ObjFile, plain: Rgb) -> Look {
    let look = file.look();
    if look.libraries.is_empty() {
        return Look::default();
    }
    let read = ObjMaterials::read(file, &look);
    let mut missing = read.missing;
    let textures: Vec<Option<Texture>> = (read.pictures.iter())
        .map(|picture| {
            let texture = Texture::decode(&picture.bytes).ok();
            if texture.is_none() {
                missing.push(picture.name.clone());
            }
            texture
        })
        .collect();
    let note = (!missing.is_empty()).then(|| {
        let names = missing.iter().map(|name| format!("`{name}`"));
        format!(
            "`{}` names {}, not to be read in its folder, and is drawn without",
            file.path().display(),
            names.collect::<Vec<_>>().join(", ")
        )
    });
    if textures.iter().all(Option::is_none) {
        return Look { faces: None, note };
    }
    let mut materials: Vec<Material> = (read.materials.iter())
        .map(|material| Material {
            color: shown(material.color),
            texture: material.picture.and_then(|place| textures[place].clone()),
        })
        .collect();
    let without = materials.len() as u32;
    materials.push(Material {
        color: plain,
        texture: None,
    });
    let corner = |corner: u32| look.corners[corner as usize].unwrap_or([0.0; 2]);
    let of_face = |polygon: u32| look.material_of[polygon as usize].unwrap_or(without);
    let faces = FaceMaterials {
        materials,
        of_face: file.triangle_polygon().into_iter().map(of_face).collect(),
        corners: (file.triangle_corners().iter())
            .map(|corners| corners.map(corner))
            .collect(),
    };
    Look {
        faces: Some(faces),
        note,
    }
}

#[expect(clippy::cast_sign_loss, reason = "colors are not negative")]
fn shown([red, green, blue, _]: [f32; 4]) -> Rgb {
    let [red, green, blue] = [red, green, blue].map(|value| (255.0 * value).round() as u8);
    Rgb::new(red, green, blue)
}
