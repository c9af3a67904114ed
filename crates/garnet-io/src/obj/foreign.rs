//! Tells other kinds of files from OBJ by their first bytes.

const SIGNATURES: [(&[u8], &str); 25] = [
    (b"glTF", "a GLB model"),
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"PK\x03\x04", "a ZIP or NPZ archive"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"\x28\xb5\x2f\xfd", "a Zstandard archive"),
    (b"\x93NUMPY", "a NumPy array"),
    (b"\x89HDF", "an HDF5 file"),
    (b"\x80\x02", "a pickle of Python"),
    (b"\x80\x03", "a pickle of Python"),
    (b"\x80\x04", "a pickle of Python"),
    (b"\x80\x05", "a pickle of Python"),
    (b"Kaydara FBX", "an FBX model"),
    (b"; FBX", "an FBX model"),
    (b"BLENDER", "a Blender file"),
    (b"ply\n", "a PLY mesh"),
    (b"ply\r", "a PLY mesh"),
    (b"solid ", "an STL mesh"),
    (b"OFF\n", "an OFF mesh"),
    (b"#usda", "a USD scene"),
    (b"PXR-USDC", "a USD scene"),
    (b"HIERARCHY", "a BVH motion"),
    (b"newmtl ", "an MTL material library"),
    (b"<", "an XML or HTML text"),
    (b"{", "a JSON text"),
];

/// What the file looks like if it is clearly no OBJ, with its article.
pub(crate) fn looks_like(bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Some("a text in UTF-16; save it as UTF-8");
    }
    let known = SIGNATURES
        .iter()
        .find(|(signature, _)| bytes.starts_with(signature));
    match known {
        Some(&(_, name)) => Some(name),
        None if bytes.contains(&0) => Some("a binary file"),
        None => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn binary_files_are_named() {
        assert_eq!(looks_like(b"glTF\x02\0\0\0"), Some("a GLB model"));
        assert_eq!(looks_like(b"v 0 0 0\n\0"), Some("a binary file"));
    }

    #[test]
    fn an_obj_is_not_foreign() {
        assert_eq!(looks_like(b"# made by hand\nv 0 0 0\n"), None);
        assert_eq!(looks_like(b"\xef\xbb\xbfo shirt\n"), None);
    }
}
