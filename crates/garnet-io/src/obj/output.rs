//! Writing an OBJ again: the same text with other positions.

use std::{
    io::{self, Write},
    path::Path,
};

use super::error::ObjError;
use super::file::ObjFile;
use super::normals::moved_normals;
use super::words::Words;
use garnet_mesh::{MeshError, Point3, TriMesh, Vector3, WriteError, write_atomically};

impl ObjFile {
    /// The file with its vertices at other positions `[vertex]`.
    ///
    /// Everything but `v` and `vn` lines stays byte for byte, and so do the `v` lines of vertices
    /// that keep their position: without a change the result is the source. A changed `v` line
    /// keeps its spaces, what follows the coordinates, and its line break. A `vn` line that
    /// moved faces name becomes the angle-weighted mean of their normals, on the same side of the
    /// faces as before; the other `vn` lines stay.
    ///
    /// Coordinates are plain decimals that read back as the same `f32`.
    ///
    /// # Errors
    ///
    /// [`ObjError::Positions`] if there are more or fewer positions than vertices, or one is not
    /// finite.
    pub fn bytes_with_positions(&self, positions: &[Point3]) -> Result<Vec<u8>, ObjError> {
        self.check_positions(positions)
            .map_err(|source| ObjError::Positions {
                path: self.path().to_path_buf(),
                source,
            })?;
        let parsed = self.parsed();
        let is_moved = |vertex: usize| bits(positions[vertex]) != bits(parsed.positions[vertex]);
        let moved: Vec<usize> = (0..positions.len()).filter(|&v| is_moved(v)).collect();
        let normals = moved_normals(self, positions);

        let mut output = Output::new(self.source(), 32 * (moved.len() + normals.len()));
        let mut normals = normals.into_iter().peekable();
        for vertex in moved {
            let start = parsed.vertex_starts[vertex];
            while let Some((normal, direction)) =
                normals.next_if(|&(normal, _)| parsed.normal_starts[normal as usize] < start)
            {
                output.put_normal(parsed.normal_starts[normal as usize], direction);
            }
            output.put_position(start, positions[vertex]);
        }
        for (normal, direction) in normals {
            output.put_normal(parsed.normal_starts[normal as usize], direction);
        }
        Ok(output.finish())
    }

    /// Writes [`ObjFile::bytes_with_positions`] to a file, whole or not at all.
    ///
    /// The output may be the file that was read.
    ///
    /// # Errors
    ///
    /// [`ObjError::Positions`] or [`ObjError::Write`].
    pub fn write_with_positions(
        &self,
        path: impl AsRef<Path>,
        positions: &[Point3],
    ) -> Result<(), ObjError> {
        let bytes = self.bytes_with_positions(positions)?;
        write_atomically(path, |writer| writer.write_all(&bytes))?;
        Ok(())
    }

    fn check_positions(&self, positions: &[Point3]) -> Result<(), MeshError> {
        if positions.len() != self.num_vertices() {
            return Err(MeshError::PositionCount {
                found: positions.len(),
                expected: self.num_vertices(),
            });
        }
        garnet_mesh::check_range(positions)
    }
}

/// Writes a mesh as a plain OBJ of `v` and `f` lines, whole or not at all.
///
/// # Errors
///
/// [`WriteError`].
pub fn write_obj(path: impl AsRef<Path>, mesh: &TriMesh) -> Result<(), WriteError> {
    write_atomically(path, |writer| write_plain(writer, mesh))
}

/// Writes the `v` and `f` lines of a mesh.
pub(super) fn write_plain(writer: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    for position in mesh.positions() {
        writeln!(writer, "v {} {} {}", position.x, position.y, position.z)?;
    }
    for corners in mesh.faces() {
        let [a, b, c] = corners.map(|vertex| u64::from(vertex) + 1);
        writeln!(writer, "f {a} {b} {c}")?;
    }
    Ok(())
}

fn bits(position: Point3) -> [u32; 3] {
    [position.x, position.y, position.z].map(f32::to_bits)
}

/// The source, copied with some words replaced.
struct Output<'a> {
    source: &'a [u8],
    /// Up to where the source is copied.
    copied: usize,
    bytes: Vec<u8>,
}

impl<'a> Output<'a> {
    fn new(source: &'a [u8], num_extra: usize) -> Self {
        Self {
            source,
            copied: 0,
            bytes: Vec::with_capacity(source.len() + num_extra),
        }
    }

    fn put_position(&mut self, start: u32, position: Point3) {
        match self.weight(start as usize) {
            Some(weight) => {
                let values = position.coords.map(|value| weighted(value, weight));
                self.put_words(start, |bytes, axis| push_decimal(bytes, values[axis]));
            }
            None => self.put_words(start, |bytes, axis| push_decimal(bytes, position[axis])),
        }
    }

    fn put_normal(&mut self, start: u32, direction: Vector3) {
        self.put_words(start, |bytes, axis| push_component(bytes, direction[axis]));
    }

    /// Replaces three words, the first of which starts at `start`.
    fn put_words(&mut self, start: u32, put: impl Fn(&mut Vec<u8>, usize)) {
        let mut words = Words::new(self.source, start as usize);
        for axis in 0..3 {
            let Some(span) = words.next_span() else {
                return;
            };
            self.bytes
                .extend_from_slice(&self.source[self.copied..span.start]);
            put(&mut self.bytes, axis);
            self.copied = span.end;
        }
    }

    /// The number after three coordinates if it is the last of its line.
    fn weight(&self, start: usize) -> Option<f32> {
        let mut words = Words::new(self.source, start);
        let word = (0..4).map(|_| words.next_word()).last().flatten()?;
        match words.next_word() {
            Some(_) => None,
            None => std::str::from_utf8(word).ok()?.parse().ok(),
        }
    }

    fn finish(mut self) -> Vec<u8> {
        self.bytes.extend_from_slice(&self.source[self.copied..]);
        self.bytes
    }
}

/// The finite number that divided by `weight` comes closest to `value`.
fn weighted(value: f32, weight: f32) -> f32 {
    let product = (value * weight).clamp(f32::MIN, f32::MAX);
    let error = |candidate: f32| (candidate / weight - value).abs();
    let candidates = [product, product.next_up(), product.next_down()];
    candidates
        .into_iter()
        .filter(|candidate| candidate.is_finite())
        .min_by(|&a, &b| error(a).total_cmp(&error(b)))
        .unwrap_or(product)
}

/// The fewest digits that read back as the same number.
fn push_decimal(bytes: &mut Vec<u8>, value: f32) {
    write!(bytes, "{value}").expect("a vector takes every byte");
}

/// Six decimals, as modeling programs write normals.
fn push_component(bytes: &mut Vec<u8>, value: f32) {
    write!(bytes, "{value:.6}").expect("a vector takes every byte");
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Bound on the components of unit normals that are written with six decimals.
    const SIX_DECIMALS: f32 = 1e-6;

    fn parsed(text: &str) -> ObjFile {
        ObjFile::parse(text.into(), "test.obj").unwrap()
    }

    fn with_positions(file: &ObjFile, positions: &[Point3]) -> String {
        String::from_utf8(file.bytes_with_positions(positions).unwrap()).unwrap()
    }

    #[test]
    fn a_changed_vertex_keeps_everything_around_its_coordinates() {
        let file = parsed("v  1 2\t3 0.5 0.6 0.7 # first\r\n v 4 5 6 2\nv 7 \\\n 8 9 1\nf 1 2 3");
        let mut positions = file.positions().to_vec();
        positions[0] = Point3::new(0.1, -20.0, 1e-9);
        positions[2].y = 8.5;
        assert_eq!(
            with_positions(&file, &positions),
            "v  0.1 -20\t0.000000001 0.5 0.6 0.7 # first\r\n v 4 5 6 2\nv 7 \\\n 8.5 9 1\nf 1 2 3"
        );
    }

    #[test]
    fn a_weight_still_divides_the_new_coordinates() {
        let file = parsed("v 4 5 6 2\nv 0 0 0\nv 1 0 0\nf 1 2 3\n");
        let mut positions = file.positions().to_vec();
        positions[0] = Point3::new(0.3, 0.7, -11.1);
        let again = parsed(&with_positions(&file, &positions));
        assert_eq!(again.positions(), positions);
    }

    #[test]
    fn normals_turn_with_their_faces_and_others_stay() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\n\
                    vn 0 0 1\nvn 0.00 0 -1\nvn 0 0 1.0\nvn 0.000 1 0\n\
                    f 1//1 2//2 3//1\nf 4//3 5//3 6//3\n";
        let file = parsed(text);
        let mut positions = file.positions().to_vec();
        for position in &mut positions[..3] {
            // A quarter turn around x takes +z to -y.
            *position = Point3::new(position.x, -position.z, position.y);
        }
        let expected = text
            .replace("v 0 1 0\n", "v -0 0 1\n")
            .replace("vn 0 0 1\n", "vn 0.000000 -1.000000 0.000000\n")
            .replace("vn 0.00 0 -1\n", "vn -0.000000 1.000000 -0.000000\n");
        let written = with_positions(&file, &positions);
        for (expected, found) in expected.lines().zip(written.lines()) {
            let numbers = |line: &str| -> Vec<f32> {
                let words = line.split(' ').skip(1);
                words.map(|word| word.parse().unwrap_or(0.0)).collect()
            };
            approx::assert_abs_diff_eq!(
                numbers(expected).as_slice(),
                numbers(found).as_slice(),
                epsilon = SIX_DECIMALS
            );
            assert_eq!(expected.split(' ').next(), found.split(' ').next());
        }
        for kept in ["vn 0 0 1.0\n", "vn 0.000 1 0\n"] {
            assert!(written.contains(kept), "{kept} in {written}");
        }
    }

    #[test]
    fn positions_that_do_not_fit_are_refused() {
        let file = parsed("v 0 0 0\nf 1 1 1\n");
        assert!(file.bytes_with_positions(&[]).is_err());
        let infinite = Point3::new(f32::INFINITY, 0.0, 0.0);
        assert!(file.bytes_with_positions(&[infinite]).is_err());
    }

    #[test]
    fn the_file_itself_can_be_the_output() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("triangle.obj");
        std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3").unwrap();
        let file = ObjFile::read(&path).unwrap();
        let positions: Vec<Point3> = file.positions().iter().map(|p| p * 2.0).collect();
        file.write_with_positions(&path, &positions).unwrap();
        assert_eq!(ObjFile::read(&path).unwrap().positions(), positions);
    }

    #[test]
    fn a_written_mesh_reads_back_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("triangle.obj");
        let positions = [[0.1, 0.2, 0.3], [1e-20, 3e5, -7.0], [1.0, 2.0, 3.0]];
        let mesh = TriMesh::new(positions.map(Point3::from).to_vec(), vec![[2, 0, 1]]).unwrap();
        write_obj(&path, &mesh).unwrap();
        assert_eq!(ObjFile::read(&path).unwrap().mesh().unwrap(), mesh);
    }

    fn coordinate() -> impl Strategy<Value = String> {
        "[-+]?([0-9]{1,3}(\\.[0-9]{0,7})?|\\.[0-9]{1,4})(e-[0-9]|e[0-2])?"
    }

    fn vertex_line() -> impl Strategy<Value = String> {
        let tail = prop_oneof![
            6 => Just(String::new()),
            1 => Just(" 1.0".to_owned()),
            1 => Just(" 0.5".to_owned()),
            1 => Just("  0.25 .5 1".to_owned()),
            1 => Just("\t# note".to_owned()),
        ];
        let blank =
            prop_oneof![4 => Just(" "), 1 => Just("  "), 1 => Just("\t"), 1 => Just(" \\\n ")];
        let three = (coordinate(), coordinate(), coordinate());
        (three, blank, tail)
            .prop_map(|((x, y, z), blank, tail)| format!("v{blank}{x}{blank}{y} {z}{tail}"))
    }

    fn face_line() -> impl Strategy<Value = String> {
        let corner = prop_oneof![
            "[1-9]",
            "-[1-9]",
            "[1-9]/[1-3]",
            "[1-9]//[1-3]",
            "-[1-9]/-[1-3]/-[1-3]",
        ];
        proptest::collection::vec(corner, 3..6)
            .prop_map(|corners| format!("f {}", corners.join(" ")))
    }

    /// Right OBJ texts with groups, all line ends, relative numbers, colors and unused vertices.
    fn obj_text() -> impl Strategy<Value = String> {
        let other = prop_oneof![
            Just("g sleeve left".to_owned()),
            Just("o shirt".to_owned()),
            Just("usemtl cotton".to_owned()),
            Just("vn 0 0 1".to_owned()),
            Just("vt 0.5 0.5".to_owned()),
            Just("  # v 1 2".to_owned()),
            Just(String::new()),
            Just("s 1".to_owned()),
            Just("l 1 2".to_owned()),
        ];
        let line = prop_oneof![2 => vertex_line(), 2 => face_line(), 1 => other];
        let parts = (
            proptest::collection::vec(vertex_line(), 9..12),
            proptest::collection::vec(line, 1..30),
            face_line(),
            prop_oneof![Just("\n"), Just("\r\n"), Just("\r"), Just(" \n")],
            any::<bool>(),
        );
        parts.prop_map(|(vertices, lines, face, end, has_last_end)| {
            let mut all = vertices;
            all.extend(["vt 0 0", "vt 1 0", "vt 1 1"].map(str::to_owned));
            all.extend(["vn 0 0 1", "vn 0 1 0.0", "vn  1 0 0"].map(str::to_owned));
            all.extend(lines);
            all.push(face);
            all.join(end) + if has_last_end { end } else { "" }
        })
    }

    proptest! {
        #[test]
        fn a_round_trip_without_a_change_gives_the_same_bytes(text in obj_text()) {
            let file = parsed(&text);
            prop_assert_eq!(with_positions(&file, file.positions()), text);
        }

        #[test]
        fn a_damaged_text_is_refused_or_still_gives_the_same_bytes(
            text in obj_text(),
            damage in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        ) {
            let mut bytes = text.into_bytes();
            for (place, byte) in damage {
                *place.get_mut(&mut bytes) = byte;
            }
            if let Ok(file) = ObjFile::parse(bytes.clone(), "test.obj") {
                prop_assert_eq!(file.bytes_with_positions(file.positions()).unwrap(), bytes);
                let moved = vec![Point3::new(0.5, -1.0, 2.0); file.num_vertices()];
                let written = file.bytes_with_positions(&moved).unwrap();
                let again = ObjFile::parse(written, "test.obj").unwrap();
                for position in again.positions() {
                    approx::assert_relative_eq!(*position, moved[0], max_relative = 1e-6);
                }
            }
        }

        #[test]
        fn moved_positions_read_back_and_nothing_else_changes(
            text in obj_text(),
            seed in any::<u64>(),
        ) {
            let file = parsed(&text);
            let shift = (seed % 1000) as f32 * 1e-3;
            let moved = |(vertex, position): (usize, &Point3)| match (seed >> (vertex % 60)) & 1 {
                0 => *position,
                _ => Point3::new(position.x * 1.1 + shift, position.y - shift, position.z * 0.7),
            };
            let positions: Vec<Point3> = file.positions().iter().enumerate().map(moved).collect();
            let written = with_positions(&file, &positions);
            let again = parsed(&written);
            for (expected, found) in positions.iter().zip(again.positions()) {
                approx::assert_relative_eq!(*expected, *found, max_relative = 1e-7);
            }
            prop_assert!(file.polygons().eq(again.polygons()));
            let others = |text: &str| -> Vec<String> {
                let lines = text.split(['\n', '\r']);
                let is_other = |line: &&str| !line.starts_with('v') && !line.starts_with(' ');
                lines.filter(is_other).map(str::to_owned).collect()
            };
            prop_assert_eq!(others(&text), others(&written));
        }
    }
}
