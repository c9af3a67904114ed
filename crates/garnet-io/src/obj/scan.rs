//! One pass over the lines of an OBJ file: where each vertex stands, and what each face names.
//!
//! tobj renumbers vertices, leaves out unused ones and names no line in its errors. The scan keeps
//! what is needed to undo that, and copies the geometry into a plain text for tobj: no comments,
//! names, colors or continued lines, which tobj misreads, but the numbers as they are written.

use std::ops::Range;

use super::error::{ObjElement, ObjLineProblem};
use super::words::{Words, parse_index, text_of};

/// No normal is named by a face corner.
pub(crate) const NO_NORMAL: u32 = u32::MAX;

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// What the scan finds.
#[derive(Debug, Default)]
pub(crate) struct ObjScan {
    /// `[vertex]` byte where the first coordinate of its `v` line starts.
    pub(crate) vertex_starts: Vec<u32>,
    /// `[normal]` byte where the first component of its `vn` line starts.
    pub(crate) normal_starts: Vec<u32>,
    /// `[polygon]` first corner; one more than there are polygons.
    pub(crate) polygon_starts: Vec<u32>,
    /// `[corner]` vertex, from 0.
    pub(crate) corner_vertices: Vec<u32>,
    /// `[corner]` normal, from 0, or [`NO_NORMAL`].
    pub(crate) corner_normals: Vec<u32>,
    /// How many `vt` lines there are.
    pub(crate) num_texture_vertices: usize,
    /// How many `o` and `g` lines there are.
    pub(crate) num_groups: usize,
    /// How many faces have 1 or 2 corners: they are not among the polygons.
    pub(crate) num_small_faces: usize,
    /// Whether a `v` line has more than four numbers.
    pub(crate) has_colors: bool,
    /// The geometry alone, for tobj.
    pub(crate) geometry: Vec<u8>,
    /// The largest numbers that faces name, from 1, and where: vertex, texture vertex, normal.
    largest: [(i64, usize); 3],
}

/// Something wrong at a byte of the file.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) at: usize,
    pub(crate) problem: ObjLineProblem,
}

const ELEMENTS: [ObjElement; 3] = [
    ObjElement::Vertex,
    ObjElement::TextureVertex,
    ObjElement::Normal,
];

impl ObjScan {
    /// Scans a whole file of less than 4 GiB.
    ///
    /// Fills `self` up to the first fault. Numbers are not read here: that is tobj's work.
    pub(crate) fn read(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        self.polygon_starts.push(0);
        self.geometry.reserve(bytes.len());
        let mut at = match bytes.strip_prefix(BYTE_ORDER_MARK) {
            Some(text) => bytes.len() - text.len(),
            None => 0,
        };
        while at < bytes.len() {
            let mut words = Words::new(bytes, at);
            at = match words.next_word() {
                Some(b"v") => self.read_vertex(bytes, at, words)?,
                Some(b"vn") => {
                    self.normal_starts.push(first_start(&words));
                    words.next_line()
                }
                Some(b"vt") => {
                    self.num_texture_vertices += 1;
                    words.next_line()
                }
                Some(b"f") => self.read_face(bytes, at, words)?,
                Some(b"l" | b"p") => words.next_line(),
                Some(b"o" | b"g") => {
                    self.num_groups += 1;
                    words.next_raw_line()
                }
                // Names may end with a backslash (a folder of Windows) without going on.
                _ => words.next_raw_line(),
            };
        }
        self.check_ranges(bytes)
    }

    fn read_vertex(
        &mut self,
        bytes: &[u8],
        at: usize,
        mut words: Words<'_>,
    ) -> Result<usize, Fault> {
        self.geometry.push(b'v');
        let mut fourth = 0..0;
        let mut num_words = 0;
        while let Some(span) = words.next_span() {
            match num_words {
                0 => self.vertex_starts.push(span.start as u32),
                3 => fourth = span.clone(),
                _ => {}
            }
            if num_words < 3 {
                let word = &bytes[span.clone()];
                if !word.is_ascii() {
                    let text = text_of(word);
                    let problem = ObjLineProblem::CoordinateNotANumber { text };
                    let at = span.start;
                    return Err(Fault { at, problem });
                }
                self.push_word(word);
            }
            num_words += 1;
        }
        match num_words {
            0..3 => {
                let found = num_words;
                let problem = ObjLineProblem::TooFewCoordinates { found };
                return Err(Fault { at, problem });
            }
            3 => {}
            4 => self.push_weight(bytes, fourth)?,
            _ => self.has_colors = true,
        }
        self.geometry.push(b'\n');
        Ok(words.next_raw_line())
    }

    /// The fourth number is a weight only if it is the last.
    fn push_weight(&mut self, bytes: &[u8], span: Range<usize>) -> Result<(), Fault> {
        let word = &bytes[span.clone()];
        let weight = std::str::from_utf8(word).ok().map(str::parse::<f32>);
        match weight {
            Some(Ok(weight)) if weight.is_finite() && weight != 0.0 => {
                self.push_word(word);
                Ok(())
            }
            _ => Err(Fault {
                at: span.start,
                problem: ObjLineProblem::BadWeight {
                    text: text_of(word),
                },
            }),
        }
    }

    fn read_face(&mut self, bytes: &[u8], at: usize, mut words: Words<'_>) -> Result<usize, Fault> {
        let first = self.corner_vertices.len();
        let before = self.geometry.len();
        self.geometry.push(b'f');
        while let Some(span) = words.next_span() {
            self.read_corner(bytes, span)?;
        }
        let found = self.corner_vertices.len() - first;
        if found == 0 {
            let problem = ObjLineProblem::TooFewCorners { found };
            return Err(Fault { at, problem });
        }
        if found < 3 {
            // Points and edges stay in the text, and are no part of the surface.
            self.corner_vertices.truncate(first);
            self.corner_normals.truncate(first);
            self.geometry.truncate(before);
            self.num_small_faces += 1;
            return Ok(words.next_raw_line());
        }
        self.geometry.push(b'\n');
        self.polygon_starts.push(self.corner_vertices.len() as u32);
        Ok(words.next_raw_line())
    }

    fn read_corner(&mut self, bytes: &[u8], span: Range<usize>) -> Result<(), Fault> {
        let word = &bytes[span.clone()];
        let fault = |problem| Fault {
            at: span.start,
            problem,
        };
        let counts = self.counts();
        let mut named = [None; 3];
        for (slot, part) in word.split(|&byte| byte == b'/').enumerate() {
            let index = match (slot, part) {
                (1.., b"") => continue,
                (0..3, part) => parse_index(part),
                _ => None,
            };
            let text = || text_of(word);
            let Some(index) = index else {
                return Err(fault(ObjLineProblem::BadCorner { text: text() }));
            };
            let (element, available) = (ELEMENTS[slot], counts[slot]);
            let number = match index {
                0 => {
                    let text = text();
                    return Err(fault(ObjLineProblem::IndexZero { text, element }));
                }
                1.. => index - 1,
                // A relative number counts back from the lines so far.
                _ if i64::from(available) + index >= 0 => i64::from(available) + index,
                _ => {
                    return Err(fault(ObjLineProblem::IndexOutOfRange {
                        text: text(),
                        element,
                        index,
                        available: available as usize,
                    }));
                }
            };
            if number >= self.largest[slot].0 {
                self.largest[slot] = (number + 1, span.start);
            }
            // A number that does not fit is out of range, which `largest` shows at the end.
            named[slot] = Some(u32::try_from(number).unwrap_or(NO_NORMAL));
            if slot == 0 {
                self.push_word(part);
            }
        }
        let Some(vertex) = named[0] else {
            let text = text_of(word);
            return Err(fault(ObjLineProblem::BadCorner { text }));
        };
        self.corner_vertices.push(vertex);
        self.corner_normals.push(named[2].unwrap_or(NO_NORMAL));
        Ok(())
    }

    fn push_word(&mut self, word: &[u8]) {
        self.geometry.push(b' ');
        self.geometry.extend_from_slice(word);
    }

    /// Faces may name what comes later in the file, so the upper bound is known at the end.
    ///
    /// Texture vertices and normals that the file leaves out altogether may be named.
    fn check_ranges(&self, bytes: &[u8]) -> Result<(), Fault> {
        let counts = self.counts();
        for slot in 0..3 {
            let (index, at) = self.largest[slot];
            let available = counts[slot];
            if index > i64::from(available) && (slot == 0 || available > 0) {
                let word = Words::new(bytes, at).next_word().unwrap_or_default();
                let problem = ObjLineProblem::IndexOutOfRange {
                    text: text_of(word),
                    element: ELEMENTS[slot],
                    index,
                    available: available as usize,
                };
                return Err(Fault { at, problem });
            }
        }
        Ok(())
    }

    /// How many vertices, texture vertices and normals there are so far.
    fn counts(&self) -> [u32; 3] {
        [
            self.vertex_starts.len() as u32,
            self.num_texture_vertices as u32,
            self.normal_starts.len() as u32,
        ]
    }
}

/// Where the next word starts, or the end of the line.
fn first_start(words: &Words<'_>) -> u32 {
    let mut words = words.clone();
    match words.next_span() {
        Some(span) => span.start as u32,
        None => words.position() as u32,
    }
}
