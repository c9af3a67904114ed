//! The one mesh that all bodies share, and its stored form.
//!
//! Only the left half is stored; the right half is its mirror image. Little-endian:
//!
//! ```text
//! magic "GBT2"
//! u32 vertices, middle vertices, faces, coarse vertices, coarse faces     (of the half)
//! f32 position[vertex][3]           the middle vertices come first and have x = 0
//! u16 face[face][3]
//! u16 arm share[vertex] / 65535
//! u8 influences[vertex], then for each influence u8 joint, u16 weight / 65535
//! u16 coarse vertex[..]             numbers of vertices of the half, rising
//! u16 coarse face[..][3]            in numbers of coarse vertices
//! ```

use std::sync::OnceLock;

use super::skeleton::mirrored;

static STORED: &[u8] = include_bytes!("template.bin");

/// Joint and weight of each influence of a vertex.
pub(crate) type Influences = Vec<(usize, f32)>;

/// The mesh that all bodies share.
#[derive(Debug, Clone)]
pub(crate) struct Template {
    /// Positions of the left half; the first `num_middle` lie in the middle plane.
    pub(crate) half: Vec<[f64; 3]>,
    pub(crate) num_middle: usize,
    /// How much of a vertex is arm, 0 to 1, `[vertex of the half]`: where the tape ends.
    pub(crate) half_arm_share: Vec<f64>,
    /// Influences `[vertex of the half]`.
    pub(crate) half_influences: Vec<Influences>,
    /// Faces of the whole.
    pub(crate) faces: Vec<[u32; 3]>,
    /// Faces of the coarse level, in numbers of coarse vertices.
    pub(crate) coarse_faces: Vec<[u32; 3]>,
    /// The vertex that each coarse vertex is.
    pub(crate) coarse_vertices: Vec<u32>,
}

impl Template {
    /// The stored template, read once.
    pub(crate) fn stored() -> &'static Self {
        static TEMPLATE: OnceLock<Template> = OnceLock::new();
        TEMPLATE.get_or_init(|| Self::read(STORED))
    }

    fn read(bytes: &[u8]) -> Self {
        let mut reader = Reader { bytes };
        let magic: [u8; 4] = reader.array();
        assert_eq!(&magic, b"GBT2", "the stored template is one");
        let [vertices, num_middle, faces, coarse, coarse_faces] =
            std::array::from_fn(|_| u32::from_le_bytes(reader.array()) as usize);
        let half: Vec<[f64; 3]> = (0..vertices)
            .map(|_| std::array::from_fn(|_| f64::from(f32::from_le_bytes(reader.array()))))
            .collect();
        let half_faces = reader.faces(faces);
        let half_arm_share = (0..vertices)
            .map(|_| f64::from(reader.short()) / f64::from(u16::MAX))
            .collect();
        let counts: Vec<u8> = (0..vertices).map(|_| reader.array::<1>()[0]).collect();
        let half_influences = counts
            .iter()
            .map(|&count| reader.influences(count))
            .collect();
        let coarse_half: Vec<u32> = (0..coarse).map(|_| u32::from(reader.short())).collect();
        let coarse_half_faces = reader.faces(coarse_faces);

        let mirror = |vertex: u32| mirror_vertex(vertex, num_middle, vertices);
        let num_coarse_middle =
            coarse_half.partition_point(|&vertex| (vertex as usize) < num_middle);
        let mirror_coarse = |vertex: u32| mirror_vertex(vertex, num_coarse_middle, coarse);
        let others = coarse_half[num_coarse_middle..].iter();
        let coarse_vertices = coarse_half
            .iter()
            .copied()
            .chain(others.map(|&vertex| mirror(vertex)))
            .collect();
        Self {
            half,
            num_middle,
            half_arm_share,
            half_influences,
            faces: with_mirror_image(&half_faces, mirror),
            coarse_faces: with_mirror_image(&coarse_half_faces, mirror_coarse),
            coarse_vertices,
        }
    }

    /// The number of vertices of the whole.
    pub(crate) fn num_vertices(&self) -> usize {
        2 * self.half.len() - self.num_middle
    }

    /// Something of each vertex of the whole, from that of the left half and its mirror image.
    pub(crate) fn whole<T: Clone>(&self, half: &[T], mirror: impl Fn(&T) -> T) -> Vec<T> {
        let right = half[self.num_middle..].iter().map(mirror);
        half.iter().cloned().chain(right).collect()
    }

    /// How much of each vertex of the whole is arm.
    pub(crate) fn arm_share(&self) -> Vec<f64> {
        self.whole(&self.half_arm_share, |share| *share)
    }

    /// Influences of every vertex of the whole.
    pub(crate) fn influences(&self) -> Vec<Influences> {
        self.whole(&self.half_influences, |influences| {
            let other = |&(joint, weight): &(usize, f32)| (mirrored(joint), weight);
            influences.iter().map(other).collect()
        })
    }
}

fn mirror_vertex(vertex: u32, num_middle: usize, num_half: usize) -> u32 {
    if (vertex as usize) < num_middle {
        vertex
    } else {
        vertex + (num_half - num_middle) as u32
    }
}

fn with_mirror_image(half: &[[u32; 3]], mirror: impl Fn(u32) -> u32) -> Vec<[u32; 3]> {
    let right = half
        .iter()
        .map(|&[a, b, c]| [mirror(a), mirror(c), mirror(b)]);
    half.iter().copied().chain(right).collect()
}

/// Reads the stored template, whose length is known to fit.
struct Reader<'a> {
    bytes: &'a [u8],
}

impl Reader<'_> {
    fn array<const N: usize>(&mut self) -> [u8; N] {
        let (head, rest) = self
            .bytes
            .split_first_chunk()
            .expect("the stored template is whole");
        self.bytes = rest;
        *head
    }

    fn short(&mut self) -> u16 {
        u16::from_le_bytes(self.array())
    }

    fn faces(&mut self, count: usize) -> Vec<[u32; 3]> {
        (0..count)
            .map(|_| std::array::from_fn(|_| u32::from(self.short())))
            .collect()
    }

    fn influences(&mut self, count: u8) -> Influences {
        let influence = |_| {
            let joint = usize::from(self.array::<1>()[0]);
            (joint, f32::from(self.short()) / f32::from(u16::MAX))
        };
        (0..count).map(influence).collect()
    }
}
