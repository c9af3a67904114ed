//! Which extensions a glTF file may need.

/// Extensions that are read, or that change neither meshes nor skins nor animations. A name that
/// ends on `*` stands for all that begin so.
const KNOWN: [&str; 11] = [
    // How surfaces look.
    "KHR_materials_*",
    "EXT_materials_*",
    "KHR_texture_*",
    "EXT_texture_*",
    "MSFT_texture_dds",
    // Lights, and words about the file.
    "KHR_lights_punctual",
    "EXT_lights_*",
    "KHR_xmp_json_ld",
    // Avatars, whose maps of joints are read.
    "VRM",
    "VRMC_*",
    // Numbers are read in all types that there are.
    "KHR_mesh_quantization",
];

/// Whether a file that needs the extension of this name can be read.
pub(super) fn is_known(name: &str) -> bool {
    KNOWN.iter().any(|known| match known.strip_suffix('*') {
        Some(start) => name.starts_with(start),
        None => name == *known,
    })
}

/// The known ones, as a text.
pub(super) fn listed() -> String {
    KNOWN.join(", ")
}
