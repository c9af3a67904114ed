//! How primitives join their corners: lists, strips and fans of triangles.

use gltf::json::{
    Root,
    accessor::ComponentType,
    mesh::{Mode, Primitive, Semantic},
    validation::Checked,
};

/// Whether a primitive has no faces: it is made of points or lines.
pub(super) fn is_faceless(primitive: &Primitive) -> bool {
    let faceless = [Mode::Points, Mode::Lines, Mode::LineLoop, Mode::LineStrip];
    matches!(primitive.mode, Checked::Valid(mode) if faceless.contains(&mode))
}

/// How many triangles a primitive has at most, as its accessors say.
pub(super) fn most_faces(root: &Root, primitive: &Primitive) -> usize {
    let positions = primitive
        .attributes
        .get(&Checked::Valid(Semantic::Positions));
    let corners = primitive.indices.as_ref().or(positions);
    let accessor = corners.and_then(|accessor| root.accessors.get(accessor.value()));
    let count = accessor.map_or(0, |accessor| accessor.count.0 as usize);
    match primitive.mode {
        Checked::Valid(Mode::Triangles) => count / 3,
        Checked::Valid(Mode::TriangleStrip | Mode::TriangleFan) => count.saturating_sub(2),
        _ => 0,
    }
}

/// The number that starts a strip anew: the largest of the type of the indices. The format forbids
/// it, and exporters write it.
pub(super) fn restart(root: &Root, primitive: &Primitive) -> Option<usize> {
    let accessor = root.accessors.get(primitive.indices.as_ref()?.value())?;
    let Checked::Valid(kind) = accessor.component_type else {
        return None;
    };
    match kind.0 {
        ComponentType::U8 => Some(usize::from(u8::MAX)),
        ComponentType::U16 => Some(usize::from(u16::MAX)),
        ComponentType::U32 => Some(u32::MAX as usize),
        _ => None,
    }
}

/// The triangles that corners are joined to, counter-clockwise; none of a mode that has no
/// triangles, or if a list of triangles ends within one.
///
/// Strips and fans (glTF 2.0, section 3.7.2.1) start anew at `restart`. Of them, triangles that
/// name a vertex twice are left out: they only lead from one part of a strip to the next.
pub(super) fn triangles(
    mode: Mode,
    corners: &[usize],
    restart: Option<usize>,
) -> Option<Vec<[usize; 3]>> {
    if mode == Mode::Triangles {
        let (faces, rest) = corners.as_chunks::<3>();
        return rest.is_empty().then(|| faces.to_vec());
    }
    let mut faces = Vec::with_capacity(corners.len());
    for run in corners.split(|&corner| Some(corner) == restart) {
        let windows = run.windows(3).enumerate();
        match mode {
            Mode::TriangleStrip => faces.extend(windows.map(|(place, row)| {
                let odd = place % 2;
                [row[0], row[1 + odd], row[2 - odd]]
            })),
            Mode::TriangleFan => {
                let sides = run.get(1..).unwrap_or_default().windows(2);
                faces.extend(sides.map(|side| [side[0], side[1], run[0]]));
            }
            _ => return None,
        }
    }
    faces.retain(|&[a, b, c]| a != b && b != c && c != a);
    Some(faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_winding_of_strips_alternates_and_fans_keep_theirs() {
        let strip = triangles(Mode::TriangleStrip, &[0, 1, 2, 3, 4], None).unwrap();
        assert_eq!(strip, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        let fan = triangles(Mode::TriangleFan, &[7, 1, 2, 3], None).unwrap();
        assert_eq!(fan, [[1, 2, 7], [2, 3, 7]]);
        for mode in [Mode::TriangleStrip, Mode::TriangleFan] {
            for length in 0..3 {
                assert!(
                    triangles(mode, &[0, 1][..length.min(2)], None)
                        .unwrap()
                        .is_empty()
                );
            }
        }
        assert_eq!(triangles(Mode::Triangles, &[0, 1, 2, 3], None), None);
        assert_eq!(triangles(Mode::LineLoop, &[0, 1, 2], None), None);
    }

    #[test]
    fn triangles_between_the_parts_of_a_strip_are_left_out() {
        // Two corners twice lead from the first part to the second: the winding goes on.
        let joined = [0, 1, 2, 3, 3, 4, 4, 5, 6, 7];
        let expected = [[0, 1, 2], [1, 3, 2], [4, 5, 6], [5, 7, 6]];
        let found = triangles(Mode::TriangleStrip, &joined, None).unwrap();
        assert_eq!(found, expected);
        let restarted = [0, 1, 2, 3, 255, 4, 5, 6, 7];
        let found = triangles(Mode::TriangleStrip, &restarted, Some(255)).unwrap();
        assert_eq!(found, expected);
    }
}
