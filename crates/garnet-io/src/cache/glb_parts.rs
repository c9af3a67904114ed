//! The vertices of a mesh as glTF has them: one texture coordinate each, one material a list of
//! triangles.

use std::collections::BTreeMap;

use garnet_mesh::{Point3, Vector3, vertex_normals};

use super::CachePart;

/// A mesh of a GLB.
#[derive(Debug)]
pub(super) struct GlbPart {
    pub(super) name: String,
    /// Vertices of the mesh as read.
    faces: Vec<[u32; 3]>,
    /// The vertex of the mesh `[vertex]`, ascending: a vertex at a seam of the texture is there
    /// once for each side.
    source: Vec<u32>,
    /// Texture coordinates, with v from above `[vertex]`; empty if there are none.
    pub(super) texture: Vec<[f32; 2]>,
    /// Triangles of each material.
    pub(super) primitives: Vec<Primitive>,
}

/// The triangles of a material.
#[derive(Debug, PartialEq)]
pub(super) struct Primitive {
    /// The material, of those of the mesh.
    pub(super) material: Option<u32>,
    pub(super) faces: Vec<[u32; 3]>,
}

impl GlbPart {
    pub(super) fn new(part: &CachePart) -> Self {
        let look = &part.look;
        let has_texture = look.corners.iter().any(Option::is_some);
        // In the order of vertices, and of the bits of their coordinates.
        let key = |vertex: u32, corner: u32| {
            let texture = look.corners.get(corner as usize).copied().flatten();
            (vertex, texture.map(|uv| uv.map(f32::to_bits)))
        };
        let mut numbers = BTreeMap::new();
        let mut is_used = vec![false; part.num_vertices];
        for (face, (_, corners)) in part.faces.iter().zip(&part.corners) {
            for (&vertex, &corner) in face.iter().zip(corners) {
                numbers.insert(key(vertex, corner), 0_u32);
                is_used[vertex as usize] = true;
            }
        }
        let unused = (0..part.num_vertices as u32).filter(|&vertex| !is_used[vertex as usize]);
        numbers.extend(unused.map(|vertex| ((vertex, None), 0)));
        for (number, place) in (0..).zip(numbers.values_mut()) {
            *place = number;
        }
        let mut of_material: BTreeMap<Option<u32>, Vec<[u32; 3]>> = BTreeMap::new();
        for (face, (polygon, corners)) in part.faces.iter().zip(&part.corners) {
            let material = look.material_of.get(*polygon as usize).copied().flatten();
            let numbered = std::array::from_fn(|k| numbers[&key(face[k], corners[k])]);
            of_material.entry(material).or_default().push(numbered);
        }
        let from_above = |bits: Option<[u32; 2]>| match bits.map(|bits| bits.map(f32::from_bits)) {
            Some([u, v]) => [u, 1.0 - v],
            None => [0.0, 0.0],
        };
        let texture = numbers.keys().map(|(_, bits)| from_above(*bits));
        Self {
            name: part.name.clone(),
            faces: part.faces.clone(),
            source: numbers.keys().map(|(vertex, _)| *vertex).collect(),
            texture: if has_texture {
                texture.collect()
            } else {
                Vec::new()
            },
            primitives: of_material
                .into_iter()
                .map(|(material, faces)| Primitive { material, faces })
                .collect(),
        }
    }

    /// How many vertices there are, those of seams by their sides.
    pub(super) fn num_vertices(&self) -> usize {
        self.source.len()
    }

    pub(super) fn num_faces(&self) -> usize {
        self.faces.len()
    }

    /// Positions and unit normals `[vertex]` of positions of the mesh as read.
    pub(super) fn frame(&self, positions: &[Point3]) -> (Vec<Point3>, Vec<Vector3>) {
        let normals = vertex_normals(positions, &self.faces);
        let unit = |normal: &Vector3| {
            // Vertices of no face have none: any will do.
            normal
                .try_normalize(f32::MIN_POSITIVE)
                .unwrap_or(Vector3::y())
        };
        let places = self.source.iter().map(|&vertex| vertex as usize);
        (
            places.clone().map(|vertex| positions[vertex]).collect(),
            places.map(|vertex| unit(&normals[vertex])).collect(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Frame, ObjFile};

    fn part(text: &str) -> GlbPart {
        let file = ObjFile::parse(text.into(), "test.obj").unwrap();
        GlbPart::new(&CachePart::of_obj(&file, Frame::OURS))
    }

    const SQUARE: &str =
        "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

    #[test]
    fn vertices_at_seams_are_there_for_each_side_and_others_keep_their_order() {
        let split = part(&format!("{SQUARE}f 2/1 3/2 4/3\nf 2/1 4/1 5/4\n"));
        // Vertex 3 has the coordinates 1 1 and 0 0.
        assert_eq!(split.source, [0, 1, 2, 3, 3, 4]);
        assert_eq!(split.texture[3..5], [[0.0, 1.0], [1.0, 0.0]]);
        assert_eq!(split.primitives[0].faces, [[1, 2, 4], [1, 3, 5]]);
        let whole = part(&format!("{SQUARE}f 2 3 4 5\n"));
        assert_eq!(whole.source, [0, 1, 2, 3, 4]);
        assert!(whole.texture.is_empty());
        assert_eq!(whole.primitives[0].faces, [[1, 2, 3], [1, 3, 4]]);
    }

    #[test]
    fn each_material_has_its_triangles() {
        let both = part(&format!(
            "{SQUARE}f 2 3 4\nusemtl b\nf 2 4 5\nusemtl a\nf 3 4 5\n"
        ));
        let found: Vec<_> = both
            .primitives
            .iter()
            .map(|one| (one.material, one.faces.len()))
            .collect();
        assert_eq!(found, [(None, 1), (Some(0), 1), (Some(1), 1)]);
    }

    #[test]
    fn normals_are_of_length_one() {
        let square = part(&format!("{SQUARE}f 2 3 4 5\n"));
        let positions = [
            [9.0; 3],
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        let (places, normals) = square.frame(&positions.map(Point3::from));
        assert_eq!(places[0], Point3::new(9.0, 9.0, 9.0));
        assert_eq!(normals[0], Vector3::y());
        assert!(normals[1..].iter().all(|normal| *normal == Vector3::z()));
    }
}
