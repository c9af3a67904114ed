//! GLB: a morph target for each frame after the first, and an animation that goes from one to the
//! next.
//!
//! Room for the JSON is left at the beginning of the file, since the bounds of what comes are known
//! at the end only; what is not needed of it stays blank.

use std::{
    io::{self, Seek, SeekFrom, Write},
    path::Path,
};

use garnet_mesh::{OpenFile, Point3, Vector3, WriteError};

use super::{
    CacheError, CachePart, TooLarge,
    glb_json::{Bounds, document},
    glb_parts::GlbPart,
    push_floats,
};
use crate::obj::{ObjMaterial, ObjMaterials, ObjPicture};

const MAGIC: &[u8; 4] = b"glTF";
const VERSION: u32 = 2;
const JSON: &[u8; 4] = b"JSON";
const BIN: &[u8; 4] = b"BIN\0";

/// The header of the file, and those of its two chunks, in bytes.
const HEADERS: u64 = 12 + 8 + 8;

/// What the parts of a GLB are, and where in its binary chunk.
#[derive(Debug)]
pub(super) struct Layout {
    pub(super) parts: Vec<GlbPart>,
    /// Of each part.
    pub(super) materials: Vec<Vec<ObjMaterial>>,
    pub(super) pictures: Vec<ObjPicture>,
    pub(super) num_frames: usize,
    pub(super) fps: f64,
    /// Bytes where texture coordinates, pictures, times, weights, the first frame and the others
    /// begin, and where all ends.
    pub(super) starts: Starts,
}

/// Where things begin in the binary chunk, in bytes. It begins with the triangles.
#[derive(Debug, Default)]
pub(super) struct Starts {
    pub(super) textures: u64,
    pub(super) pictures: Vec<u64>,
    pub(super) times: u64,
    pub(super) weights: u64,
    pub(super) first: u64,
    pub(super) others: u64,
    pub(super) end: u64,
}

impl Layout {
    fn new(parts: &[CachePart], num_frames: usize, fps: f64) -> Self {
        let mut read = ObjMaterials::default();
        let materials = parts
            .iter()
            .map(|part| read.read_more(&part.look, &part.folder))
            .collect();
        let parts: Vec<GlbPart> = parts.iter().map(GlbPart::new).collect();
        let sum = |of: fn(&GlbPart) -> usize| parts.iter().map(of).sum::<usize>() as u64;
        let mut starts = Starts {
            textures: 12 * sum(GlbPart::num_faces),
            ..Starts::default()
        };
        let mut at = starts.textures + 8 * sum(|part| part.texture.len());
        for picture in &read.pictures {
            starts.pictures.push(at);
            at += padded(picture.bytes.len());
        }
        let (frames, others) = (num_frames as u64, num_frames as u64 - 1);
        starts.times = at;
        starts.weights = at + if others > 0 { 4 * frames } else { 0 };
        starts.first = starts.weights + 4 * frames * others;
        let of_frame = 24 * sum(GlbPart::num_vertices);
        starts.others = starts.first + of_frame;
        starts.end = starts.others + of_frame * others;
        Self {
            parts,
            materials,
            pictures: read.pictures,
            num_frames,
            fps,
            starts,
        }
    }
}

/// The length of something that ends at a multiple of four bytes.
fn padded(length: usize) -> u64 {
    length.next_multiple_of(4) as u64
}

/// A GLB that is being written.
#[derive(Debug)]
pub(super) struct GlbWriter {
    file: OpenFile,
    layout: Layout,
    /// Room for the JSON, in bytes.
    room: u64,
    /// Of the positions of each frame and part.
    bounds: Vec<Bounds>,
    /// The first frame `[part]`.
    first: Vec<(Vec<Point3>, Vec<Vector3>)>,
    bytes: Vec<u8>,
}

impl GlbWriter {
    pub(super) fn create(
        path: &Path,
        parts: &[CachePart],
        num_frames: usize,
        fps: f64,
    ) -> Result<Self, CacheError> {
        let layout = Layout::new(parts, num_frames, fps);
        let num_bounds = layout.parts.len() * num_frames;
        let longest = document(&layout, &vec![Bounds::LONGEST; num_bounds]);
        let room = padded(longest.len());
        let bytes = HEADERS + room + layout.starts.end;
        let limit = u64::from(u32::MAX);
        if bytes > limit {
            return Err(CacheError::TooLarge {
                path: path.to_path_buf(),
                problem: TooLarge {
                    num_frames,
                    bytes,
                    limit,
                },
            });
        }
        let file = OpenFile::create(path)?;
        let mut writer = Self {
            file,
            layout,
            room,
            bounds: Vec::with_capacity(num_bounds),
            first: Vec::new(),
            bytes: Vec::new(),
        };
        let begun = writer.begin();
        begun.map_err(|source| writer.file.failed(source))?;
        Ok(writer)
    }

    /// Writes what does not move.
    fn begin(&mut self) -> io::Result<()> {
        let (file, layout) = (&mut self.file, &self.layout);
        file.seek(SeekFrom::Start(HEADERS + self.room))?;
        for primitive in layout.parts.iter().flat_map(|part| &part.primitives) {
            for corner in primitive.faces.as_flattened() {
                file.write_all(&corner.to_le_bytes())?;
            }
        }
        for value in layout
            .parts
            .iter()
            .flat_map(|part| part.texture.as_flattened())
        {
            file.write_all(&value.to_le_bytes())?;
        }
        for picture in &layout.pictures {
            file.write_all(&picture.bytes)?;
            let length = picture.bytes.len();
            file.write_all(&[0; 3][..padded(length) as usize - length])?;
        }
        let num_frames = layout.num_frames;
        if num_frames == 1 {
            return Ok(());
        }
        for frame in 0..num_frames {
            file.write_all(&((frame as f64 / layout.fps) as f32).to_le_bytes())?;
        }
        for frame in 0..num_frames {
            for target in 1..num_frames {
                let weight = f32::from(u8::from(target == frame));
                file.write_all(&weight.to_le_bytes())?;
            }
        }
        Ok(())
    }

    pub(super) fn push(&mut self, positions: &[&[Point3]]) -> Result<(), WriteError> {
        let is_first = self.first.is_empty();
        self.bytes.clear();
        for (number, part) in self.layout.parts.iter().enumerate() {
            let (mut places, mut normals) = part.frame(positions[number]);
            if is_first {
                self.first.push((places.clone(), normals.clone()));
            } else {
                let (first, first_normals) = &self.first[number];
                for (place, first) in places.iter_mut().zip(first) {
                    *place = Point3::from(*place - first);
                }
                for (normal, first) in normals.iter_mut().zip(first_normals) {
                    *normal -= first;
                }
            }
            self.bounds.push(Bounds::of(&places));
            push_floats(&mut self.bytes, &places, f32::to_le_bytes);
            let normals: Vec<Point3> = normals.into_iter().map(Point3::from).collect();
            push_floats(&mut self.bytes, &normals, f32::to_le_bytes);
        }
        let written = self.file.write_all(&self.bytes);
        written.map_err(|source| self.file.failed(source))
    }

    pub(super) fn finish(mut self) -> Result<(), WriteError> {
        let json = document(&self.layout, &self.bounds);
        let headed = self.head(json);
        headed.map_err(|source| self.file.failed(source))?;
        self.file.close()?.put()
    }

    fn head(&mut self, mut json: String) -> io::Result<()> {
        let room = self.room as usize;
        debug_assert!(json.len() <= room, "the longest numbers fit");
        json.extend(std::iter::repeat_n(' ', room - json.len()));
        let end = self.layout.starts.end;
        let file = &mut self.file;
        file.seek(SeekFrom::Start(0))?;
        file.write_all(MAGIC)?;
        file.write_all(&VERSION.to_le_bytes())?;
        file.write_all(&((HEADERS + self.room + end) as u32).to_le_bytes())?;
        file.write_all(&(self.room as u32).to_le_bytes())?;
        file.write_all(JSON)?;
        file.write_all(json.as_bytes())?;
        file.write_all(&(end as u32).to_le_bytes())?;
        file.write_all(BIN)?;
        file.flush()
    }
}
