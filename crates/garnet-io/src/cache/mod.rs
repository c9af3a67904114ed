//! Meshes that move, in files that programs play: PC2, MDD, npz and GLB.
//!
//! Frames are written as they come; what is kept of each is a few numbers. A file appears when it
//! is whole.

mod glb;
mod glb_json;
mod glb_parts;
mod points;

use std::path::{Path, PathBuf};

use garnet_mesh::{Point3, TriMesh, WriteError};

use crate::{Frame, ObjFile, ObjLook};
use glb::GlbWriter;
use points::PointsWriter;

/// A format of moving meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum CacheKind {
    /// The point cache that Blender's Mesh Cache and 3ds Max play.
    Pc2,
    /// The motion of `LightWave`, which Blender and Maya play.
    Mdd,
    /// Arrays for `NumPy`: `vertices [frames, n, 3]`, `faces [m, 3]`, `fps`.
    Npz,
    /// glTF 2.0 with a morph target for each frame.
    Glb,
}

impl CacheKind {
    /// The kind that the extension of a name stands for, if it does.
    ///
    /// ```
    /// use garnet_io::CacheKind;
    ///
    /// assert_eq!(CacheKind::of("walk.PC2"), Some(CacheKind::Pc2));
    /// assert_eq!(CacheKind::of("walk.obj"), None);
    /// ```
    pub fn of(path: impl AsRef<Path>) -> Option<Self> {
        let extension = path.as_ref().extension()?.to_str()?;
        match extension.to_ascii_lowercase().as_str() {
            "pc2" => Some(Self::Pc2),
            "mdd" => Some(Self::Mdd),
            "npz" => Some(Self::Npz),
            "glb" => Some(Self::Glb),
            _ => None,
        }
    }

    /// Whether a file holds several meshes, the body with the garment, say.
    pub const fn holds_parts(self) -> bool {
        matches!(self, Self::Glb)
    }
}

/// A mesh of a file: what does not move.
#[derive(Debug, Clone)]
pub struct CachePart {
    pub(super) name: String,
    /// Unit and up axis of its file, which all formats but glTF keep.
    pub(super) frame: Frame,
    pub(super) num_vertices: usize,
    /// Triangles, in the order of [`ObjFile::triangles`].
    pub(super) faces: Vec<[u32; 3]>,
    /// The polygon of each triangle, and the number of its corners in the look `[triangle]`.
    pub(super) corners: Vec<(u32, [u32; 3])>,
    pub(super) look: ObjLook,
    /// The folder of the file, where materials are looked for.
    pub(super) folder: PathBuf,
}

impl CachePart {
    /// The mesh of an OBJ, with texture coordinates and materials.
    pub fn of_obj(file: &ObjFile, frame: Frame) -> Self {
        let look = file.look();
        let stem = file.path().file_stem().unwrap_or_default();
        let name = look.object.clone();
        let corners = file.triangle_polygon().into_iter();
        let corners = corners.zip(file.triangle_corners()).collect();
        Self {
            name: name.unwrap_or_else(|| stem.to_string_lossy().into_owned()),
            frame,
            num_vertices: file.num_vertices(),
            faces: file.triangles(),
            corners,
            look,
            folder: file.path().parent().unwrap_or(Path::new("")).to_path_buf(),
        }
    }

    /// A part of a mesh without materials or texture coordinates.
    pub fn of_mesh(name: &str, mesh: &TriMesh, frame: Frame) -> Self {
        let faces = mesh.faces().to_vec();
        let corners = (0..faces.len() as u32).map(|face| (face, [0, 1, 2].map(|k| 3 * face + k)));
        Self {
            name: name.to_owned(),
            frame,
            num_vertices: mesh.num_vertices(),
            corners: corners.collect(),
            look: ObjLook {
                corners: vec![None; 3 * faces.len()],
                material_of: vec![None; faces.len()],
                ..ObjLook::default()
            },
            faces,
            folder: PathBuf::new(),
        }
    }
}

/// Why a file of moving meshes cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CacheError {
    /// The system refuses.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The format has no room for so much.
    #[error("cannot write `{}`", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// How much it would be.
        #[source]
        problem: TooLarge,
    },
}

/// More than a format can hold.
#[derive(Debug, thiserror::Error)]
#[error("{num_frames} frames take {bytes} bytes, more than the {limit} that the format can hold")]
pub struct TooLarge {
    /// Frames of the motion.
    pub num_frames: usize,
    /// What they would take.
    pub bytes: u64,
    /// What there is room for.
    pub limit: u64,
}

/// A file of moving meshes that is being written, frame by frame.
///
/// # Examples
///
/// ```
/// use garnet_io::{CacheKind, CachePart, CacheWriter, Frame};
/// use garnet_mesh::primitives::icosphere;
///
/// let folder = tempfile::tempdir()?;
/// let (path, ball) = (folder.path().join("ball.pc2"), icosphere(0, 1.0));
/// let part = CachePart::of_mesh("ball", &ball, Frame::OURS);
/// let mut cache = CacheWriter::create(&path, CacheKind::Pc2, vec![part], 2, 30.0)?;
/// for _ in 0..2 {
///     cache.push(&[ball.positions()])?;
/// }
/// cache.finish()?;
/// assert_eq!(std::fs::metadata(&path)?.len(), 32 + 2 * 12 * 12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct CacheWriter {
    content: Content,
    num_vertices: Vec<usize>,
    num_frames: usize,
    num_done: usize,
}

#[derive(Debug)]
enum Content {
    Points(Box<PointsWriter>),
    Glb(Box<GlbWriter>),
}

impl CacheWriter {
    /// Begins a file of `num_frames` frames at `fps` frames a second. Formats that
    /// [hold one mesh](CacheKind::holds_parts) take the first part alone.
    ///
    /// # Errors
    ///
    /// [`CacheError`] if the system refuses, or the format has no room for so many frames.
    ///
    /// # Panics
    ///
    /// If there is no part, or no frame.
    pub fn create(
        path: impl AsRef<Path>,
        kind: CacheKind,
        mut parts: Vec<CachePart>,
        num_frames: usize,
        fps: f64,
    ) -> Result<Self, CacheError> {
        assert!(
            !parts.is_empty() && num_frames > 0,
            "a file of no mesh or no frame"
        );
        if !kind.holds_parts() {
            parts.truncate(1);
        }
        let num_vertices = parts.iter().map(|part| part.num_vertices).collect();
        let path = path.as_ref();
        let content = if kind == CacheKind::Glb {
            Content::Glb(Box::new(GlbWriter::create(path, &parts, num_frames, fps)?))
        } else {
            let part = parts.remove(0);
            Content::Points(Box::new(PointsWriter::create(
                path, kind, part, num_frames, fps,
            )?))
        };
        Ok(Self {
            content,
            num_vertices,
            num_frames,
            num_done: 0,
        })
    }

    /// Writes a frame: positions `[vertex]` of each part, in metres with y up. Those of parts that
    /// the format leaves out are left out.
    ///
    /// # Errors
    ///
    /// [`CacheError::Write`] if the system refuses.
    ///
    /// # Panics
    ///
    /// If there are too many frames, or more or fewer positions than vertices.
    pub fn push(&mut self, positions: &[&[Point3]]) -> Result<(), CacheError> {
        assert!(
            self.num_done < self.num_frames,
            "more frames than were told"
        );
        let found = positions.iter().map(|part| part.len());
        let fits = found
            .take(self.num_vertices.len())
            .eq(self.num_vertices.iter().copied());
        assert!(fits, "a position for each vertex");
        self.num_done += 1;
        match &mut self.content {
            Content::Points(points) => Ok(points.push(positions[0])?),
            Content::Glb(glb) => Ok(glb.push(positions)?),
        }
    }

    /// Puts the file into its place.
    ///
    /// # Errors
    ///
    /// [`CacheError::Write`] if the system refuses.
    ///
    /// # Panics
    ///
    /// If frames are missing.
    pub fn finish(self) -> Result<(), CacheError> {
        assert!(
            self.num_done == self.num_frames,
            "fewer frames than were told"
        );
        match self.content {
            Content::Points(points) => Ok(points.finish()?),
            Content::Glb(glb) => Ok(glb.finish()?),
        }
    }
}

/// The bytes of points, in an order of bytes.
fn push_floats(bytes: &mut Vec<u8>, points: &[Point3], of: fn(f32) -> [u8; 4]) {
    bytes.reserve(12 * points.len());
    for point in points {
        for axis in 0..3 {
            bytes.extend(of(point[axis]));
        }
    }
}
