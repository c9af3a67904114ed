//! OBJ files, read so that they can be written again without loss.

use std::{
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

use super::error::{ObjError, ObjParseError};
use super::output::write_plain;
use super::parse::{Parsed, parse};
use garnet_mesh::{MeshError, Point3, TriMesh, check_regular};

/// An OBJ file: its vertices and polygons in the numbering of the file, and all of its text.
///
/// All groups and objects of the file are one mesh with shared vertices. Seams of the texture do
/// not split vertices; unused and duplicate vertices stay. The fourth number of a `v` line, if it
/// is the last, divides the coordinates.
///
/// # Examples
///
/// ```
/// use garnet_io::ObjFile;
///
/// let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
/// let file = ObjFile::parse(text.into(), "square.obj")?;
/// assert_eq!(file.mesh()?.num_faces(), 2);
///
/// let mut positions = file.positions().to_vec();
/// positions[3].z = 0.25;
/// let moved = file.bytes_with_positions(&positions)?;
/// assert_eq!(moved, text.replace("v 0 1 0", "v 0 1 0.25").as_bytes());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ObjFile {
    path: PathBuf,
    source: Vec<u8>,
    parsed: Parsed,
}

impl ObjFile {
    /// Reads and parses an OBJ file.
    ///
    /// # Errors
    ///
    /// [`ObjError::Read`] or [`ObjError::Parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ObjError> {
        let path = path.as_ref();
        let source = read_limited(path)?;
        Self::parse(source, path)
    }

    /// Reads a file that another one names, or that stands in a folder of a known form: pipes and
    /// devices, which may never end, are refused.
    ///
    /// # Errors
    ///
    /// Those of [`ObjFile::read`].
    pub fn read_regular(path: impl AsRef<Path>) -> Result<Self, ObjError> {
        let path = path.as_ref();
        check_regular(path).map_err(|source| ObjError::Read {
            path: path.to_path_buf(),
            source,
        })?;
        Self::read(path)
    }

    /// The file that [`write_obj`](crate::write_obj) would write for a mesh, under the name `path`.
    ///
    /// # Errors
    ///
    /// [`ObjError::Parse`] for a mesh without vertices or faces.
    pub fn of_mesh(mesh: &TriMesh, path: impl AsRef<Path>) -> Result<Self, ObjError> {
        let mut bytes = Vec::new();
        let written = write_plain(&mut bytes, mesh);
        debug_assert!(written.is_ok(), "a vector takes every byte");
        Self::parse(bytes, path.as_ref())
    }

    /// Parses the bytes of a file; `name` stands for the path.
    ///
    /// # Errors
    ///
    /// [`ObjError::Parse`].
    pub fn parse(bytes: Vec<u8>, name: impl Into<PathBuf>) -> Result<Self, ObjError> {
        let path = name.into();
        match parse(&bytes) {
            Ok(parsed) => Ok(Self {
                path,
                source: bytes,
                parsed,
            }),
            Err(source) => Err(ObjError::Parse { path, source }),
        }
    }

    /// The path that was read, or the name given with the bytes.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The bytes of the file as read.
    pub fn source(&self) -> &[u8] {
        &self.source
    }

    /// Positions `[vertex]` in the order of the file, unused vertices included.
    pub fn positions(&self) -> &[Point3] {
        &self.parsed.positions
    }

    /// How many vertices there are, unused ones included.
    pub fn num_vertices(&self) -> usize {
        self.parsed.positions.len()
    }

    /// How many polygons there are.
    pub fn num_polygons(&self) -> usize {
        self.parsed.polygon_starts.len() - 1
    }

    /// The vertices of a polygon, from 0, in the order of its corners.
    ///
    /// # Panics
    ///
    /// If there is no such polygon.
    pub fn polygon(&self, polygon: usize) -> &[u32] {
        &self.parsed.corner_vertices[self.parsed.corners(polygon)]
    }

    /// The vertices of each polygon in turn, from 0: three or more, in the order of the corners.
    pub fn polygons(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        (0..self.num_polygons()).map(|polygon| self.polygon(polygon))
    }

    /// The triangles of all polygons, in their order.
    ///
    /// A polygon with the corners `p` becomes the fan `[p[0], p[k], p[k + 1]]`.
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(self.num_triangles());
        for corners in self.polygons() {
            for side in corners[1..].windows(2) {
                triangles.push([corners[0], side[0], side[1]]);
            }
        }
        triangles
    }

    /// The polygon of each triangle of [`ObjFile::triangles`].
    pub fn triangle_polygon(&self) -> Vec<u32> {
        let mut owners = Vec::with_capacity(self.num_triangles());
        for (polygon, corners) in self.polygons().enumerate() {
            owners.resize(owners.len() + corners.len() - 2, polygon as u32);
        }
        owners
    }

    /// The corners of each triangle of [`ObjFile::triangles`], numbered as in
    /// [`ObjLook::corners`](super::ObjLook::corners).
    pub fn triangle_corners(&self) -> Vec<[u32; 3]> {
        let mut corners = Vec::with_capacity(self.num_triangles());
        let mut first = 0;
        for polygon in self.polygons() {
            let count = polygon.len() as u32;
            corners.extend((1..count - 1).map(|side| [first, first + side, first + side + 1]));
            first += count;
        }
        corners
    }

    /// The triangle mesh: [`ObjFile::positions`] and [`ObjFile::triangles`].
    ///
    /// # Errors
    ///
    /// [`MeshError::TooLarge`].
    pub fn mesh(&self) -> Result<TriMesh, MeshError> {
        TriMesh::new(self.parsed.positions.clone(), self.triangles())
    }

    /// The edges of the polygons, without the diagonals of their triangles.
    ///
    /// Each has the smaller vertex first; they are sorted and unique.
    pub fn polygon_edges(&self) -> Vec<[u32; 2]> {
        let mut edges = Vec::with_capacity(self.parsed.corner_vertices.len());
        for corners in self.polygons() {
            let mut from = corners[corners.len() - 1];
            for &to in corners {
                if from != to {
                    edges.push([from.min(to), from.max(to)]);
                }
                from = to;
            }
        }
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// How many `vt` lines there are.
    pub fn num_texture_vertices(&self) -> usize {
        self.parsed.num_texture_vertices
    }

    /// How many `vn` lines there are.
    pub fn num_normals(&self) -> usize {
        self.parsed.normal_starts.len()
    }

    /// How many `o` and `g` lines there are.
    pub fn num_groups(&self) -> usize {
        self.parsed.num_groups
    }

    /// How many faces have 1 or 2 corners: they stay in the text, and are not among the polygons.
    pub fn num_small_faces(&self) -> usize {
        self.parsed.num_small_faces
    }

    /// Whether a vertex has a color after its coordinates.
    pub fn has_colors(&self) -> bool {
        self.parsed.has_colors
    }

    /// Whether every polygon is a triangle.
    pub fn is_triangulated(&self) -> bool {
        self.num_triangles() == self.num_polygons()
    }

    fn num_triangles(&self) -> usize {
        self.parsed.corner_vertices.len() - 2 * self.num_polygons()
    }

    pub(crate) fn parsed(&self) -> &Parsed {
        &self.parsed
    }
}

/// The most that is read of a pipe or a device, in bytes: some may go on for ever.
const LONGEST_STREAM: u64 = 1 << 29;

fn read_limited(path: &Path) -> Result<Vec<u8>, ObjError> {
    let failed = |source| ObjError::Read {
        path: path.to_path_buf(),
        source,
    };
    let file = File::open(path).map_err(failed)?;
    let data = file.metadata().map_err(failed)?;
    let num_bytes = data.len();
    let limit = if data.is_file() {
        u64::from(u32::MAX)
    } else {
        LONGEST_STREAM
    };
    let mut source = Vec::new();
    if num_bytes <= limit {
        source.reserve(num_bytes as usize + 1);
        // One byte more than the limit shows that a stream without a known size is too long.
        let mut limited = file.take(limit + 1);
        limited.read_to_end(&mut source).map_err(failed)?;
    }
    let num_bytes = num_bytes.max(source.len() as u64);
    if num_bytes > limit {
        return Err(ObjError::Parse {
            path: path.to_path_buf(),
            source: ObjParseError::TooLarge {
                num_bytes,
                most: limit,
            },
        });
    }
    Ok(source)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> ObjFile {
        ObjFile::parse(text.into(), "test.obj").unwrap()
    }

    const TWO_GROUPS: &str = "\
        o front\nv 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\n\
        f 2/1 3/2 4/2 5/1\n\
        o back\nv 0 0 0\nv 2 0 0\nv 2 1 0\nusemtl cotton\n\
        f 3/2 -2/1 -1/2 4/1\nf -3 -2 -1\n";

    #[test]
    fn groups_are_one_mesh_in_the_numbering_of_the_file() {
        let file = parsed(TWO_GROUPS);
        let polygons: Vec<&[u32]> = file.polygons().collect();
        assert_eq!(
            polygons,
            [&[1, 2, 3, 4][..], &[2, 6, 7, 3][..], &[5, 6, 7][..]]
        );
        assert_eq!(file.positions()[0], Point3::new(9.0, 9.0, 9.0));
        assert_eq!(file.positions()[7], Point3::new(2.0, 1.0, 0.0));
        assert_eq!(file.num_vertices(), 8);
        assert_eq!(file.num_groups(), 2);
        assert_eq!(file.num_texture_vertices(), 2);
        assert!(!file.is_triangulated());
    }

    #[test]
    fn a_polygon_becomes_a_fan_and_its_diagonal_is_no_edge() {
        let file = parsed(TWO_GROUPS);
        let triangles = [[1, 2, 3], [1, 3, 4], [2, 6, 7], [2, 7, 3], [5, 6, 7]];
        assert_eq!(file.triangles(), triangles);
        assert_eq!(file.triangle_polygon(), [0, 0, 1, 1, 2]);
        assert_eq!(file.mesh().unwrap().faces(), triangles);
        let edges = file.polygon_edges();
        assert!(!edges.contains(&[1, 3]));
        assert_eq!(edges.len(), 9);
        assert!(edges.is_sorted());
    }

    #[test]
    fn a_file_of_one_vertex_keeps_its_number() {
        let file = parsed("v 1 2 3\nf 1 1 1\n");
        assert_eq!(file.polygon(0), [0, 0, 0]);
        assert!(file.polygon_edges().is_empty());
    }

    #[test]
    fn unusual_spellings_mean_what_they_say() {
        let file = parsed(
            "\u{feff}v\t+.5 -0 1e-3 # comment\r\n  v 1. \\\r\n 2 3\r\nv 4 5 6 2\rV 1\n\
             v 0 0 1 0.1 0.2 0.3\nmtllib missing.mtl\nusemtl\nvt 0.5\ns off\nl 1 2\np 1\n\
             g C:\\cloth\\\nf 4// 3//1 2/1 1/1/\n#v nonsense\ncurv 0 1 2",
        );
        assert_eq!(file.positions()[0], Point3::new(0.5, 0.0, 0.001));
        assert_eq!(file.positions()[1], Point3::new(1.0, 2.0, 3.0));
        assert_eq!(file.positions()[2], Point3::new(2.0, 2.5, 3.0));
        assert_eq!(file.polygon(0), [3, 2, 1, 0]);
        assert!(file.has_colors());
    }

    #[test]
    fn a_face_may_name_a_vertex_that_comes_later() {
        let file = parsed("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
        assert_eq!(file.polygon(0), [0, 1, 2]);
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = ObjFile::read("missing.obj").unwrap_err();
        assert_eq!(error.to_string(), "cannot read `missing.obj`");
    }
}
