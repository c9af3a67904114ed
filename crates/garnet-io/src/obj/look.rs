//! What the polygons of an OBJ look like: texture coordinates, materials, the name of the object.

use super::file::ObjFile;
use super::words::{Words, parse_index};

/// The texture of an OBJ file, in the order of its polygons and their corners.
///
/// # Examples
///
/// ```
/// use garnet_io::ObjFile;
///
/// let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 1\nusemtl silk\nf 1/1 2 3\n";
/// let look = ObjFile::parse(text.into(), "a.obj")?.look();
/// assert_eq!(look.corners[0], Some([0.5, 1.0]));
/// assert_eq!(look.materials, ["silk"]);
/// assert_eq!(look.material_of, [Some(0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ObjLook {
    /// Texture coordinates `[corner]`, of all polygons in turn, with v from below; none where a
    /// corner names none.
    pub corners: Vec<Option<[f32; 2]>>,
    /// Names of materials, in the order in which polygons come to them.
    pub materials: Vec<String>,
    /// The material of each polygon `[polygon]`, of those.
    pub material_of: Vec<Option<u32>>,
    /// The files of materials that are named, as they are written.
    pub libraries: Vec<String>,
    /// The name of the object, if there is one alone.
    pub object: Option<String>,
}

impl ObjFile {
    /// Texture coordinates and materials of the polygons: read from the text each time, since only
    /// other formats than OBJ need them.
    pub fn look(&self) -> ObjLook {
        let bytes = self.source();
        let mut look = ObjLook::default();
        let mut coordinates: Vec<[f32; 2]> = Vec::with_capacity(self.num_texture_vertices());
        // Corners may name what comes later in the file.
        let mut named: Vec<Option<i64>> = Vec::with_capacity(self.parsed().corner_vertices.len());
        let mut material = None;
        let mut objects = Vec::new();
        let mut at = bytes
            .strip_prefix(b"\xef\xbb\xbf")
            .map_or(0, |text| bytes.len() - text.len());
        while at < bytes.len() {
            let mut words = Words::new(bytes, at);
            at = match words.next_word() {
                Some(b"vt") => {
                    coordinates.push(std::array::from_fn(|_| number(&mut words)));
                    words.next_line()
                }
                Some(b"f") => {
                    let first = named.len();
                    while let Some(word) = words.next_word() {
                        named.push(texture_of(word, coordinates.len()));
                    }
                    if named.len() - first < 3 {
                        named.truncate(first);
                    } else {
                        look.material_of.push(material);
                    }
                    words.next_raw_line()
                }
                Some(b"v" | b"l" | b"p" | b"vn") => words.next_line(),
                Some(b"usemtl") => {
                    let name = rest_of_line(bytes, &words);
                    material = (!name.is_empty()).then(|| number_of(&mut look.materials, name));
                    words.next_raw_line()
                }
                Some(b"mtllib") => {
                    look.libraries.push(rest_of_line(bytes, &words));
                    words.next_raw_line()
                }
                Some(b"o") => {
                    objects.push(rest_of_line(bytes, &words));
                    words.next_raw_line()
                }
                _ => words.next_raw_line(),
            };
        }
        let place = |index: i64| coordinates.get(usize::try_from(index).ok()?).copied();
        look.corners = named.into_iter().map(|index| place(index?)).collect();
        if let [name] = objects.as_mut_slice() {
            look.object = Some(std::mem::take(name)).filter(|name| !name.is_empty());
        }
        look
    }
}

/// The next number of a line; 0 where there is none.
fn number(words: &mut Words<'_>) -> f32 {
    let word = words
        .next_word()
        .and_then(|word| std::str::from_utf8(word).ok());
    let value = word.and_then(|word| word.parse().ok()).unwrap_or(0.0);
    if f32::is_finite(value) { value } else { 0.0 }
}

/// The texture vertex that a corner names, from 0.
fn texture_of(corner: &[u8], num_before: usize) -> Option<i64> {
    let part = corner.split(|&byte| byte == b'/').nth(1)?;
    match parse_index(part)? {
        index @ 1.. => Some(index - 1),
        index => Some(i64::try_from(num_before).ok()? + index),
    }
}

fn rest_of_line(bytes: &[u8], words: &Words<'_>) -> String {
    let rest = &bytes[words.position()..];
    let end = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
    let line = &rest[..end.unwrap_or(rest.len())];
    String::from_utf8_lossy(line).trim().to_owned()
}

/// The number of a name in a list, to which it is added if it is new.
fn number_of(names: &mut Vec<String>, name: String) -> u32 {
    let place = names.iter().position(|other| *other == name);
    let place = place.unwrap_or_else(|| {
        names.push(name);
        names.len() - 1
    });
    place as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(text: &str) -> ObjLook {
        ObjFile::parse(text.into(), "test.obj").unwrap().look()
    }

    #[test]
    fn corners_keep_their_texture_and_polygons_their_material() {
        let look = look(
            "mtllib a b.mtl\no shirt\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0.25\nvt 1 nan\n\
             f 1/1 2/-1 3\nusemtl red silk\nf 1 2\nf 1/2/ 3/3 4\nusemtl\nf 2 3 4\nvt 0.5 0.5 0\n\
             usemtl blue\nf 1 2 3\nusemtl red silk\nf 1 2 3 4\n",
        );
        let [low, right, late] = [[0.0, 0.25], [1.0, 0.0], [0.5, 0.5]];
        assert_eq!(
            look.corners[..6],
            [Some(low), Some(right), None, Some(right), Some(late), None]
        );
        assert_eq!(look.corners.len(), 3 + 3 + 3 + 3 + 4);
        assert_eq!(look.materials, ["red silk", "blue"]);
        assert_eq!(look.material_of, [None, Some(0), None, Some(1), Some(0)]);
        assert_eq!(look.libraries, ["a b.mtl"]);
        assert_eq!(look.object.as_deref(), Some("shirt"));
    }

    #[test]
    fn of_several_objects_none_names_the_mesh() {
        let text = "o a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\no b\nf 3 2 1\n";
        assert_eq!(look(text).object, None);
    }
}
