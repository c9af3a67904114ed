//! tobj parses the geometry; the scan of the lines restores the file's numbering and checks it.

use std::{ops::Range, path::Path};

use super::error::{ObjLineProblem, ObjParseError};
use super::foreign::looks_like;
use super::scan::{Fault, ObjScan};
use super::words::{Words, line_number, text_of};
use garnet_mesh::{MAX_COORDINATE, Point3, stray_coordinate};

/// What an OBJ file holds, in the numbering of the file.
#[derive(Debug, Clone)]
pub(crate) struct Parsed {
    pub(crate) positions: Vec<Point3>,
    /// `[vertex]` byte where its coordinates start.
    pub(crate) vertex_starts: Vec<u32>,
    /// `[normal]` byte where its components start.
    pub(crate) normal_starts: Vec<u32>,
    /// `[polygon]` first corner; one more than there are polygons.
    pub(crate) polygon_starts: Vec<u32>,
    /// `[corner]` vertex.
    pub(crate) corner_vertices: Vec<u32>,
    /// `[corner]` normal or [`super::scan::NO_NORMAL`].
    pub(crate) corner_normals: Vec<u32>,
    pub(crate) num_texture_vertices: usize,
    pub(crate) num_groups: usize,
    pub(crate) num_small_faces: usize,
    pub(crate) has_colors: bool,
}

impl Parsed {
    /// The corners of a polygon.
    pub(crate) fn corners(&self, polygon: usize) -> Range<usize> {
        self.polygon_starts[polygon] as usize..self.polygon_starts[polygon + 1] as usize
    }
}

/// Parses the bytes of an OBJ file.
pub(crate) fn parse(bytes: &[u8]) -> Result<Parsed, ObjParseError> {
    if bytes.len() > u32::MAX as usize {
        return Err(ObjParseError::TooLarge {
            num_bytes: bytes.len() as u64,
            most: u64::from(u32::MAX),
        });
    }
    if bytes.is_empty() {
        return Err(ObjParseError::Empty);
    }
    if let Some(looks_like) = looks_like(bytes) {
        return Err(ObjParseError::NotObj { looks_like });
    }
    let mut scan = ObjScan::default();
    let scanned = scan.read(bytes);
    if let Err(fault) = scanned {
        // A coordinate that is no number may stand before what the scan noticed.
        check_numbers(bytes, &scan.vertex_starts)?;
        return Err(at_line(bytes, fault));
    }
    if scan.vertex_starts.is_empty() {
        return Err(ObjParseError::NoVertices);
    }
    if scan.corner_vertices.is_empty() {
        check_numbers(bytes, &scan.vertex_starts)?;
        return Err(ObjParseError::NoFaces);
    }
    let positions = match parse_positions(&mut scan) {
        Ok(positions) => positions,
        Err(error) => {
            check_numbers(bytes, &scan.vertex_starts)?;
            return Err(error);
        }
    };
    if stray_coordinate(&positions).is_some() {
        check_numbers(bytes, &scan.vertex_starts)?;
    }
    Ok(Parsed {
        positions,
        vertex_starts: scan.vertex_starts,
        normal_starts: scan.normal_starts,
        polygon_starts: scan.polygon_starts,
        corner_vertices: scan.corner_vertices,
        corner_normals: scan.corner_normals,
        num_texture_vertices: scan.num_texture_vertices,
        num_groups: scan.num_groups,
        num_small_faces: scan.num_small_faces,
        has_colors: scan.has_colors,
    })
}

/// Positions `[vertex]` in the order of the file, as tobj reads them.
///
/// tobj numbers vertices in the order in which faces name them and drops the others. One more
/// polygon that names every vertex in turn therefore tells which is which. tobj keeps the corners
/// in the order of the file, so the corners before it must name the vertices that the scan read.
fn parse_positions(scan: &mut ObjScan) -> Result<Vec<Point3>, ObjParseError> {
    let num_vertices = scan.vertex_starts.len();
    let expected = scan.corner_vertices.len();
    push_polygon_of_all(&mut scan.geometry, num_vertices);

    let options = tobj::LoadOptions::default();
    let no_materials = |_: &Path| Ok(<(Vec<_>, _)>::default());
    let loaded = tobj::load_obj_buf(&mut scan.geometry.as_slice(), &options, no_materials);
    scan.geometry = Vec::new();
    let (models, _) = loaded.map_err(|source| ObjParseError::Refused { source })?;
    let differ = |found| ObjParseError::CornersDiffer { found, expected };
    let [model] = models.as_slice() else {
        return Err(differ(0));
    };
    let mesh = &model.mesh;
    if mesh.indices.len() != expected + num_vertices {
        return Err(differ(mesh.indices.len().saturating_sub(num_vertices)));
    }
    let (corners, parsed_from_file) = mesh.indices.split_at(expected);
    let agrees = |&(&parsed, &vertex): &(&u32, &u32)| parsed_from_file[vertex as usize] == parsed;
    let pairs = || corners.iter().zip(&scan.corner_vertices);
    if !pairs().all(|pair| agrees(&pair)) {
        return Err(differ(pairs().filter(agrees).count()));
    }
    let (points, _) = mesh.positions.as_chunks::<3>();
    let positions = parsed_from_file
        .iter()
        .map(|&vertex| points.get(vertex as usize).map(|&point| point.into()));
    positions.collect::<Option<_>>().ok_or(differ(0))
}

fn push_polygon_of_all(geometry: &mut Vec<u8>, num_vertices: usize) {
    geometry.push(b'f');
    for number in 1..=num_vertices {
        geometry.push(b' ');
        push_number(geometry, number);
    }
    geometry.push(b'\n');
}

fn push_number(text: &mut Vec<u8>, mut number: usize) {
    let start = text.len();
    while number > 0 {
        text.push(b'0' + (number % 10) as u8);
        number /= 10;
    }
    text[start..].reverse();
}

/// Looks for the first coordinate that is no number in range.
fn check_numbers(bytes: &[u8], vertex_starts: &[u32]) -> Result<(), ObjParseError> {
    for &start in vertex_starts {
        let mut words = Words::new(bytes, start as usize);
        let coordinates = [words.next_span(), words.next_span(), words.next_span()];
        let fourth = words.next_span();
        let weight = match (fourth, words.next_span()) {
            (Some(span), None) => number(&bytes[span]).filter(|&weight| weight != 0.0),
            _ => None,
        };
        for span in coordinates.into_iter().flatten() {
            let text = text_of(&bytes[span.clone()]);
            let problem = match number(&bytes[span.clone()]) {
                None => ObjLineProblem::CoordinateNotANumber { text },
                Some(value) if (value / weight.unwrap_or(1.0)).abs() <= MAX_COORDINATE => continue,
                Some(_) => ObjLineProblem::CoordinateOutOfRange { text },
            };
            let at = span.start;
            return Err(at_line(bytes, Fault { at, problem }));
        }
    }
    Ok(())
}

fn number(word: &[u8]) -> Option<f32> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

fn at_line(bytes: &[u8], fault: Fault) -> ObjParseError {
    ObjParseError::Line {
        line: line_number(bytes, fault.at),
        problem: fault.problem,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn message(text: &str) -> String {
        parse(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn a_wrong_line_is_told_with_its_number() {
        let cases = [
            (
                "v 0 0 0.1l3\n",
                "line 4: vertex coordinate `0.1l3` is not a number",
            ),
            (
                "v 0 0,5 1\n",
                "line 4: vertex coordinate `0,5` is not a number",
            ),
            (
                "v 0 nan 1\n",
                "line 4: vertex coordinate `nan` is not finite or beyond 1000000",
            ),
            (
                "v 0 1e999 1\n",
                "line 4: vertex coordinate `1e999` is not finite or beyond 1000000",
            ),
            (
                "v 0 1\u{a0}2 3 4\n",
                "line 4: vertex coordinate `1\u{a0}2` is not a number",
            ),
            (
                "v 1e38 0 1 0.01\n",
                "line 4: vertex coordinate `1e38` is not finite or beyond 1000000",
            ),
            (
                "v 0 0 1 0\n",
                "line 4: vertex weight `0` is not a number other than zero",
            ),
            (
                "v 0 0 1 inf\n",
                "line 4: vertex weight `inf` is not a number other than zero",
            ),
            ("v 1 2\n", "line 4: a vertex needs 3 coordinates, found 2"),
            ("f\n", "line 4: a face needs at least 3 corners, found 0"),
            (
                "f 1 2 x\n",
                "line 4: face corner `x` is not `v`, `v/vt`, `v//vn` or `v/vt/vn`",
            ),
            (
                "f 1 2 3/1/1/1\n",
                "line 4: face corner `3/1/1/1` is not `v`, `v/vt`, `v//vn` or `v/vt/vn`",
            ),
            (
                "f 1 2 0\n",
                "line 4: face corner `0` names vertex 0, but they are numbered from 1",
            ),
            (
                "f 1 2 4/1\nf 1 2 3\n",
                "line 4: face corner `4/1` names vertex 4, but there are 3",
            ),
            (
                "f 1 2 -4\n",
                "line 4: face corner `-4` names vertex -4, but there are 3",
            ),
            (
                "vn 0 0 1\nf 1//1 2//2 3//1\n",
                "line 5: face corner `2//2` names normal 2, but there are 1",
            ),
            (
                "f 1 2 99999999999\n",
                "line 4: face corner `99999999999` names vertex 99999999999, but there are 3",
            ),
        ];
        for (line, expected) in cases {
            let text = format!("v 0 0 0\r\nv 1 0 0\nv 0 1 0\n{line}f 1 2 3\n");
            assert_eq!(message(&text), expected, "for {line:?}");
        }
    }

    #[test]
    fn the_first_wrong_line_is_told() {
        let text = "v 0 0 zero\nv 1 0 0\nv 0 1 0\nf 1 2\n";
        assert_eq!(
            message(text),
            "line 1: vertex coordinate `zero` is not a number"
        );
    }

    #[test]
    fn a_file_without_a_mesh_is_refused() {
        assert_eq!(message(""), "the file is empty");
        assert!(message("# nothing\n").contains("no vertices"));
        assert!(message("v 0 0 0\n").contains("no faces"));
        assert!(message("glTF\u{2}").contains("looks like a GLB model"));
    }

    /// Lines of OBJ files, right and wrong.
    fn line() -> impl Strategy<Value = String> {
        prop_oneof![
            3 => "v( {1,2}-?[0-9]{1,2}(\\.[0-9]{0,3})?){2,7}",
            3 => "f( [1-6](/[1-3]?(/[1-3]?)?)?){2,5}",
            1 => "f( -?[0-9]{1,2}(/-?[0-9]?){0,3}){0,5}",
            1 => "v[nt]?( (nan|inf|1e9{1,3}|[-+.e0-9]{1,5}|\\\\|#)){0,5}",
            1 => "(vn|vt|l|p|g|o|usemtl|mtllib|s)( [a-z0-9./\\\\#]{0,4}){0,4}",
            1 => "[ -~\\t]{0,20}",
        ]
    }

    fn text() -> impl Strategy<Value = String> {
        let ending = prop_oneof![
            Just("\n"),
            Just("\r\n"),
            Just("\r"),
            Just(" \\\n"),
            Just("")
        ];
        proptest::collection::vec((line(), ending), 0..30).prop_map(|lines| {
            let body: String = lines.into_iter().map(|(line, end)| line + end).collect();
            format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n{body}")
        })
    }

    fn holds(parsed: &Parsed, bytes: &[u8]) -> bool {
        let num_vertices = parsed.positions.len();
        parsed.vertex_starts.len() == num_vertices
            && parsed
                .corner_vertices
                .iter()
                .all(|&vertex| (vertex as usize) < num_vertices)
            && parsed
                .positions
                .iter()
                .all(|position| position.iter().all(|value| value.is_finite()))
            && parsed
                .vertex_starts
                .iter()
                .all(|&start| (start as usize) < bytes.len())
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            if let Ok(parsed) = parse(&bytes) {
                prop_assert!(holds(&parsed, &bytes));
            }
        }

        #[test]
        fn any_lines_are_read_or_refused_by_line(text in text()) {
            match parse(text.as_bytes()) {
                Ok(parsed) => prop_assert!(holds(&parsed, text.as_bytes())),
                Err(error) => {
                    let is_line = matches!(error, ObjParseError::Line { .. });
                    prop_assert!(is_line, "{error}");
                }
            }
        }
    }
}
