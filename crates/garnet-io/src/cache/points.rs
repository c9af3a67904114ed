//! Files that hold points alone: PC2, MDD, npz.

use std::{
    io::{self, Write},
    path::Path,
};

use garnet_mesh::{OpenFile, Point3, WriteError};
use zip::{CompressionMethod, DateTime, ZipWriter, write::SimpleFileOptions};

use super::{CacheKind, CachePart, push_floats};
use crate::{Frame, npy};

/// What a PC2 begins with.
const PC2_MAGIC: &[u8; 12] = b"POINTCACHE2\0";

/// Version of PC2.
const PC2_VERSION: i32 = 1;

/// Archives that may be larger than this need a longer form, in bytes.
const LARGE: u64 = 0xf000_0000;

/// A file of points that is being written.
#[derive(Debug)]
pub(super) struct PointsWriter {
    content: Content,
    frame: Frame,
    of: fn(f32) -> [u8; 4],
    bytes: Vec<u8>,
}

enum Content {
    Plain(OpenFile),
    Npz {
        archive: Box<ZipWriter<OpenFile>>,
        path: Box<Path>,
        faces: Vec<[u32; 3]>,
        fps: f64,
    },
}

impl std::fmt::Debug for Content {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Plain(file) => file.fmt(formatter),
            Self::Npz { path, .. } => path.fmt(formatter),
        }
    }
}

impl PointsWriter {
    pub(super) fn create(
        path: &Path,
        kind: CacheKind,
        part: CachePart,
        num_frames: usize,
        fps: f64,
    ) -> Result<Self, WriteError> {
        let mut file = OpenFile::create(path)?;
        let num_points = part.num_vertices;
        let header = match kind {
            CacheKind::Pc2 => pc2_header(num_points, num_frames),
            CacheKind::Mdd => mdd_header(num_points, num_frames, fps),
            CacheKind::Npz | CacheKind::Glb => {
                let bytes = 12 * num_points as u64 * num_frames as u64;
                let mut archive = ZipWriter::new(file);
                let header = npy::header("<f4", &[num_frames, num_points, 3]);
                let begun = archive
                    .start_file("vertices.npy", stored(bytes))
                    .map_err(io::Error::from)
                    .and_then(|()| archive.write_all(&header));
                begun.map_err(|source| failed(path, source))?;
                return Ok(Self {
                    content: Content::Npz {
                        archive: Box::new(archive),
                        path: path.into(),
                        faces: part.faces,
                        fps,
                    },
                    frame: part.frame,
                    of: f32::to_le_bytes,
                    bytes: Vec::new(),
                });
            }
        };
        file.write_all(&header)
            .map_err(|source| failed(path, source))?;
        Ok(Self {
            content: Content::Plain(file),
            frame: part.frame,
            of: match kind {
                CacheKind::Mdd => f32::to_be_bytes,
                _ => f32::to_le_bytes,
            },
            bytes: Vec::new(),
        })
    }

    pub(super) fn push(&mut self, positions: &[Point3]) -> Result<(), WriteError> {
        self.bytes.clear();
        let in_file = self.frame.to_file(positions.to_vec());
        push_floats(&mut self.bytes, &in_file, self.of);
        match &mut self.content {
            Content::Plain(file) => {
                let written = file.write_all(&self.bytes);
                written.map_err(|source| file.failed(source))
            }
            Content::Npz { archive, path, .. } => {
                let written = archive.write_all(&self.bytes);
                written.map_err(|source| failed(path, source))
            }
        }
    }

    pub(super) fn finish(self) -> Result<(), WriteError> {
        let file = match self.content {
            Content::Plain(file) => file,
            Content::Npz {
                archive,
                path,
                faces,
                fps,
            } => closed(*archive, &faces, fps).map_err(|source| failed(&path, source))?,
        };
        file.close()?.put()
    }
}

/// The rest of the arrays.
fn closed(mut archive: ZipWriter<OpenFile>, faces: &[[u32; 3]], fps: f64) -> io::Result<OpenFile> {
    let corners = faces.as_flattened().iter();
    let corners: Vec<u8> = corners.flat_map(|corner| corner.to_le_bytes()).collect();
    archive.start_file("faces.npy", stored(corners.len() as u64))?;
    archive.write_all(&npy::encode("<u4", &[faces.len(), 3], &corners))?;
    archive.start_file("fps.npy", stored(8))?;
    archive.write_all(&npy::encode("<f8", &[], &fps.to_le_bytes()))?;
    Ok(archive.finish()?)
}

fn stored(bytes: u64) -> SimpleFileOptions {
    SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default())
        .large_file(bytes > LARGE)
}

/// The first frame is 0, and there is a sample a frame.
fn pc2_header(num_points: usize, num_frames: usize) -> Vec<u8> {
    let mut header = PC2_MAGIC.to_vec();
    header.extend(PC2_VERSION.to_le_bytes());
    header.extend((num_points as u32).to_le_bytes());
    header.extend(0_f32.to_le_bytes());
    header.extend(1_f32.to_le_bytes());
    header.extend((num_frames as u32).to_le_bytes());
    header
}

/// The time of each frame, in seconds, stands before all points.
fn mdd_header(num_points: usize, num_frames: usize, fps: f64) -> Vec<u8> {
    let mut header = Vec::with_capacity(8 + 4 * num_frames);
    header.extend((num_frames as u32).to_be_bytes());
    header.extend((num_points as u32).to_be_bytes());
    for frame in 0..num_frames {
        header.extend(((frame as f64 / fps) as f32).to_be_bytes());
    }
    header
}

fn failed(path: &Path, source: io::Error) -> WriteError {
    WriteError::Io {
        path: path.to_path_buf(),
        source,
    }
}
