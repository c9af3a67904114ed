//! The topology of a garment, and the garments of that topology.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::curve::{Point2, distance, length, resampled};
use crate::draft::{Arc, Draft, Layer, Meets, Patch};
use crate::harmonic::HarmonicMap;
use crate::reference::REFERENCE;
use crate::sewn::{Line, Panel, SewnGarment};
use crate::start::{StartShape, draft};
use crate::triangulate::{doubled_area, triangulated};
use crate::union::Union;
use crate::wearer::Measures;
use crate::{GarmentKind, Parameters, PatternError, Point3, Wearer};

/// Smallest and largest number of vertices of a garment.
pub const VERTEX_RANGE: [usize; 2] = [500, 40_000];

/// Triangles of a pattern have no smaller angle, in degrees.
pub const LEAST_ANGLE: f64 = 8.0;

/// Distance between panels of the flat pattern, in metres.
const PANEL_GAP: f64 = 0.05;

/// The mean pattern of a garment, triangulated: one topology for all parameters and wearers.
///
/// ```
/// use garnet_pattern::{GarmentKind, Template, Wearer};
///
/// let template = Template::new(GarmentKind::Tshirt, 2000)?;
/// let mut parameters = GarmentKind::Tshirt.parameters();
/// let short = template.made_to_measure(&parameters, &Wearer::reference())?;
/// parameters.set("sleeve", 0.32)?;
/// let long = template.made_to_measure(&parameters, &Wearer::reference())?;
/// assert_eq!(short.faces, long.faces);
/// # Ok::<(), garnet_pattern::PatternError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Template {
    garment: GarmentKind,
    /// How many pieces an arc is cut into, by its name.
    pieces: BTreeMap<&'static str, usize>,
    patches: Vec<PatchMesh>,
    faces: Vec<[u32; 3]>,
    panels: Vec<PanelPart>,
    num_vertices: usize,
    mirror: Vec<u32>,
    seams: Vec<Line>,
    rims: Vec<Line>,
}

/// One patch of the left half, meshed.
#[derive(Debug, Clone)]
struct PatchMesh {
    map: HarmonicMap,
    mean: Vec<Point2>,
    faces: Vec<[u32; 3]>,
    /// The vertex of the garment that each point is, left and right.
    vertices: [Vec<u32>; 2],
}

/// One panel and the patches `(patch, side)` that make it.
#[derive(Debug, Clone)]
struct PanelPart {
    name: String,
    faces: Range<usize>,
    parts: Vec<(usize, usize)>,
}

impl Template {
    /// Triangulates the mean pattern with about `num_vertices` vertices, within 2 %.
    ///
    /// # Errors
    ///
    /// [`PatternError::VertexCount`].
    pub fn new(garment: GarmentKind, num_vertices: usize) -> Result<Self, PatternError> {
        let [least, most] = VERTEX_RANGE;
        if !(least..=most).contains(&num_vertices) {
            return Err(PatternError::VertexCount {
                asked: num_vertices,
            });
        }
        let (draft, _) = draft(&garment.parameters(), &REFERENCE.measures, &REFERENCE)?;
        let edge = edge_for(&draft, num_vertices)?;
        Self::meshed(garment, &draft, edge)
    }

    /// The garment.
    pub fn garment(&self) -> GarmentKind {
        self.garment
    }

    /// How many vertices all garments of this template have.
    pub fn num_vertices(&self) -> usize {
        self.num_vertices
    }

    /// Vertex numbers `[face][corner]` of all garments of this template.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Cuts and sews a garment to the measures of the person who wears it.
    ///
    /// # Errors
    ///
    /// As [`Template::sewn`].
    pub fn made_to_measure(
        &self,
        parameters: &Parameters,
        wearer: &Wearer,
    ) -> Result<SewnGarment, PatternError> {
        self.sewn(parameters, &wearer.measures, wearer)
    }

    /// Cuts a garment to the measures `cut` (of a size, say), sews it and hangs it around `wearer`.
    ///
    /// # Errors
    ///
    /// [`PatternError::WrongGarment`], [`PatternError::BadWearer`], [`PatternError::Impossible`] or
    /// [`PatternError::Folded`].
    pub fn sewn(
        &self,
        parameters: &Parameters,
        cut: &Measures,
        wearer: &Wearer,
    ) -> Result<SewnGarment, PatternError> {
        if parameters.garment() != self.garment {
            return Err(PatternError::WrongGarment {
                given: parameters.garment(),
                expected: self.garment,
            });
        }
        cut.check()?;
        wearer.check()?;
        let (draft, shape) = draft(parameters, cut, wearer)?;
        let mut flats = Vec::new();
        let mut starts = Vec::new();
        for (patch, mesh) in draft.patches.iter().zip(&self.patches) {
            let outline = self.outline(patch, |arc| &arc.flat);
            flats.push(mesh.map.placed(&outline, &mesh.mean));
            starts.push(self.start(patch, mesh, &shape));
        }
        self.check_angles(&flats, parameters)?;
        Ok(self.assembled(parameters, &draft, &flats, &starts))
    }

    fn meshed(garment: GarmentKind, draft: &Draft, edge: f64) -> Result<Self, PatternError> {
        let pieces = pieces(draft, edge);
        let mut template = Self {
            garment,
            pieces,
            patches: Vec::new(),
            faces: Vec::new(),
            panels: Vec::new(),
            num_vertices: 0,
            mirror: Vec::new(),
            seams: Vec::new(),
            rims: Vec::new(),
        };
        for patch in &draft.patches {
            let outline = template.outline(patch, |arc| &arc.flat);
            let mesh = triangulated(&outline, edge, true).map_err(|reason| {
                PatternError::Triangulation {
                    panel: patch.panel,
                    reason,
                }
            })?;
            template.patches.push(PatchMesh {
                map: HarmonicMap::new(&mesh.points, outline.len(), &mesh.faces),
                mean: mesh.points,
                faces: mesh.faces,
                vertices: [Vec::new(), Vec::new()],
            });
        }
        template.number(draft);
        Ok(template)
    }

    /// The outline of a patch, sampled: every arc without its last point.
    fn outline<'a>(&self, patch: &'a Patch, curve: impl Fn(&'a Arc) -> &'a [Point2]) -> Vec<Point2> {
        let mut outline = Vec::new();
        for arc in &patch.arcs {
            let pieces = self.pieces[arc.name];
            outline.extend_from_slice(&resampled(curve(arc), pieces)[..pieces]);
        }
        outline
    }

    /// The points of an outline on each arc, ends included, in the direction of the arc's name.
    fn arc_points(&self, patch: &Patch) -> Vec<Vec<usize>> {
        let counts: Vec<usize> = patch.arcs.iter().map(|arc| self.pieces[arc.name]).collect();
        let total: usize = counts.iter().sum();
        let mut first = 0;
        let mut arcs = Vec::new();
        for (arc, count) in patch.arcs.iter().zip(counts) {
            let mut points: Vec<usize> = (first..=first + count).map(|i| i % total).collect();
            if arc.is_reversed {
                points.reverse();
            }
            arcs.push(points);
            first += count;
        }
        arcs
    }

    /// Sews: numbers the vertices so that points of a seam are one vertex.
    fn number(&mut self, draft: &Draft) {
        let sizes: Vec<usize> = self.patches.iter().map(|patch| patch.mean.len()).collect();
        let half: usize = sizes.iter().sum();
        let first: Vec<usize> = sizes
            .iter()
            .scan(0, |sum, size| Some(std::mem::replace(sum, *sum + size)))
            .collect();
        let mut union = Union::new(2 * half);
        let mut met: BTreeMap<&'static str, Vec<usize>> = BTreeMap::new();
        for (number, patch) in draft.patches.iter().enumerate() {
            for (arc, points) in patch.arcs.iter().zip(self.arc_points(patch)) {
                let points: Vec<usize> = points.iter().map(|i| first[number] + i).collect();
                match arc.meets {
                    Meets::MiddleSeam | Meets::MiddleFold => {
                        points.iter().for_each(|&i| union.join(i, half + i));
                    }
                    Meets::Seam | Meets::Fold => match met.get(arc.name) {
                        Some(others) => {
                            for (&i, &j) in points.iter().zip(others) {
                                union.join(i, j);
                                union.join(half + i, half + j);
                            }
                        }
                        None => {
                            met.insert(arc.name, points);
                        }
                    },
                    Meets::Rim => {}
                }
            }
        }
        self.order_panels(draft);
        let mut numbers = vec![u32::MAX; 2 * half];
        let mut count = 0;
        for panel in &self.panels {
            for &(patch, side) in &panel.parts {
                let base = side * half + first[patch];
                for point in 0..sizes[patch] {
                    let slot = &mut numbers[union.root(base + point)];
                    if *slot == u32::MAX {
                        *slot = count;
                        count += 1;
                    }
                }
            }
        }
        self.num_vertices = count as usize;
        self.mirror = vec![0; count as usize];
        for patch in 0..sizes.len() {
            for side in 0..2 {
                let base = side * half + first[patch];
                let of = |point: usize, union: &mut Union| numbers[union.root(point)];
                self.patches[patch].vertices[side] = (0..sizes[patch])
                    .map(|point| of(base + point, &mut union))
                    .collect();
            }
            let [left, right] = &self.patches[patch].vertices;
            for (&l, &r) in left.iter().zip(right) {
                self.mirror[l as usize] = r;
                self.mirror[r as usize] = l;
            }
        }
        self.number_faces(draft);
        self.number_lines(draft);
    }

    fn order_panels(&mut self, draft: &Draft) {
        let mut names: Vec<(&'static str, bool)> = Vec::new();
        for patch in &draft.patches {
            if !names.contains(&(patch.panel, patch.is_cut_twice)) {
                names.push((patch.panel, patch.is_cut_twice));
            }
        }
        let parts = |panel: &str, side: usize| -> Vec<(usize, usize)> {
            let patches = draft.patches.iter().enumerate();
            let own = patches.filter(|(_, patch)| patch.panel == panel);
            own.map(|(number, _)| (number, side)).collect()
        };
        for (panel, is_cut_twice) in names {
            let mut push = |name: String, parts: Vec<(usize, usize)>| {
                self.panels.push(PanelPart {
                    name,
                    faces: 0..0,
                    parts,
                });
            };
            if is_cut_twice {
                push(format!("left {panel}"), parts(panel, 0));
                push(format!("right {panel}"), parts(panel, 1));
            } else {
                push(panel.to_owned(), [parts(panel, 0), parts(panel, 1)].concat());
            }
        }
    }

    fn number_faces(&mut self, draft: &Draft) {
        for panel in &mut self.panels {
            let first = self.faces.len();
            for &(patch, side) in &panel.parts {
                let mesh = &self.patches[patch];
                let vertices = &mesh.vertices[side];
                let is_turned = is_turned(draft.patches[patch].layer, side);
                self.faces.extend(mesh.faces.iter().map(|&face| {
                    turned(face, is_turned).map(|point| vertices[point as usize])
                }));
            }
            panel.faces = first..self.faces.len();
        }
    }

    fn number_lines(&mut self, draft: &Draft) {
        let mut done: Vec<&'static str> = Vec::new();
        for (number, patch) in draft.patches.iter().enumerate() {
            for (arc, points) in patch.arcs.iter().zip(self.arc_points(patch)) {
                if done.contains(&arc.name) {
                    continue;
                }
                done.push(arc.name);
                let sides: &[(usize, &str)] = match arc.meets {
                    Meets::Fold | Meets::MiddleFold => continue,
                    Meets::MiddleSeam => &[(0, "")],
                    Meets::Seam | Meets::Rim => &[(0, "left "), (1, "right ")],
                };
                for &(side, prefix) in sides {
                    let vertices = &self.patches[number].vertices[side];
                    let line = Line {
                        name: format!("{prefix}{}", arc.name),
                        vertices: points.iter().map(|&point| vertices[point]).collect(),
                    };
                    if arc.meets == Meets::Rim {
                        self.rims.push(line);
                    } else {
                        self.seams.push(line);
                    }
                }
            }
        }
    }

    /// Where the points of a patch of the left half start, in space.
    fn start(&self, patch: &Patch, mesh: &PatchMesh, shape: &StartShape) -> Vec<[f64; 3]> {
        let outline = self.outline(patch, |arc| &arc.chart);
        let chart = mesh.map.placed(&outline, &guess(&mesh.mean, &outline));
        let mut closes = vec![false; chart.len()];
        let mut is_middle = vec![false; chart.len()];
        for (arc, points) in patch.arcs.iter().zip(self.arc_points(patch)) {
            for point in points {
                closes[point] |= arc.closes;
                is_middle[point] |= matches!(arc.meets, Meets::MiddleFold | Meets::MiddleSeam);
            }
        }
        let points = chart.iter().zip(closes).zip(is_middle);
        points
            .map(|((&at, closes), is_middle)| {
                let [x, y, z] = shape.at(patch.layer, at, closes);
                [if is_middle { 0.0 } else { x }, y, z]
            })
            .collect()
    }

    fn check_angles(&self, flats: &[Vec<Point2>], parameters: &Parameters) -> Result<(), PatternError> {
        let least = LEAST_ANGLE.to_radians().sin();
        let mut folded = 0;
        for (mesh, points) in self.patches.iter().zip(flats) {
            for face in &mesh.faces {
                let corners = face.map(|point| points[point as usize]);
                folded += usize::from(least_sine(corners) < least);
            }
        }
        if folded == 0 {
            return Ok(());
        }
        Err(PatternError::Folded {
            folded: 2 * folded,
            faces: self.faces.len(),
            least_degrees: LEAST_ANGLE,
            hint: parameters.farthest(),
        })
    }

    fn assembled(
        &self,
        parameters: &Parameters,
        draft: &Draft,
        flats: &[Vec<Point2>],
        starts: &[Vec<[f64; 3]>],
    ) -> SewnGarment {
        let mut flat = vec![[[0.0_f32; 2]; 3]; self.faces.len()];
        let mut shrink = vec![1.0; self.faces.len()];
        let mut panels = Vec::new();
        let mut edge = 0.0;
        for panel in &self.panels {
            let seen = |patch: usize, side: usize, point: usize| -> Point2 {
                let [x, y] = flats[patch][point];
                match is_turned(draft.patches[patch].layer, side) {
                    true => [-x, y],
                    false => [x, y],
                }
            };
            let all = panel.parts.iter().flat_map(|&(patch, side)| {
                (0..flats[patch].len()).map(move |point| seen(patch, side, point))
            });
            let (mut low, mut high, mut bottom) = (f64::MAX, f64::MIN, f64::MAX);
            for [x, y] in all {
                low = low.min(x);
                high = high.max(x);
                bottom = bottom.min(y);
            }
            let shift = [edge - low, -bottom];
            edge += high - low + PANEL_GAP;
            let mut number = panel.faces.start;
            for &(patch, side) in &panel.parts {
                let is_turned = is_turned(draft.patches[patch].layer, side);
                for &face in &self.patches[patch].faces {
                    flat[number] = turned(face, is_turned).map(|point| {
                        let [x, y] = seen(patch, side, point as usize);
                        [(x + shift[0]) as f32, (y + shift[1]) as f32]
                    });
                    shrink[number] = draft.patches[patch].shrink;
                    number += 1;
                }
            }
            panels.push(Panel {
                name: panel.name.clone(),
                faces: panel.faces.clone(),
            });
        }
        let mut start = vec![Point3::origin(); self.num_vertices];
        for (mesh, points) in self.patches.iter().zip(starts) {
            for (side, sign) in [(0, 1.0), (1, -1.0)] {
                for (&vertex, &[x, y, z]) in mesh.vertices[side].iter().zip(points) {
                    start[vertex as usize] = Point3::new((sign * x) as f32, y as f32, z as f32);
                }
            }
        }
        SewnGarment {
            parameters: parameters.clone(),
            faces: self.faces.clone(),
            flat,
            shrink,
            panels,
            seams: self.seams.clone(),
            rims: self.rims.clone(),
            mirror: self.mirror.clone(),
            start,
        }
    }
}

/// Whether a patch is seen from its other side: its triangles run backwards.
fn is_turned(layer: Layer, side: usize) -> bool {
    (layer == Layer::Back) != (side == 1)
}

fn turned([a, b, c]: [u32; 3], is_turned: bool) -> [u32; 3] {
    if is_turned { [a, c, b] } else { [a, b, c] }
}

/// The sine of the smallest angle of a triangle, negative if it is folded over.
fn least_sine([a, b, c]: [Point2; 3]) -> f64 {
    let mut sides = [distance(a, b), distance(b, c), distance(c, a)];
    sides.sort_by(f64::total_cmp);
    doubled_area(a, b, c) / (sides[1] * sides[2]).max(1e-18)
}

/// A first guess of a chart: the mean panel stretched over the new outline's box.
fn guess(mean: &[Point2], outline: &[Point2]) -> Vec<Point2> {
    let bounds = |points: &[Point2], axis: usize| {
        let low = points.iter().map(|p| p[axis]).fold(f64::MAX, f64::min);
        let high = points.iter().map(|p| p[axis]).fold(f64::MIN, f64::max);
        [low, high]
    };
    let mut points = mean.to_vec();
    for axis in 0..2 {
        let [from, to] = [bounds(mean, axis), bounds(outline, axis)];
        let scale = (to[1] - to[0]) / (from[1] - from[0]).max(1e-9);
        for point in &mut points {
            point[axis] = to[0] + scale * (point[axis] - from[0]);
        }
    }
    points
}

/// How many pieces each arc has with edges of a length: arcs of one name alike.
fn pieces(draft: &Draft, edge: f64) -> BTreeMap<&'static str, usize> {
    let mut lengths: BTreeMap<&'static str, (f64, f64)> = BTreeMap::new();
    for arc in draft.patches.iter().flat_map(|patch| &patch.arcs) {
        let (sum, count) = lengths.entry(arc.name).or_default();
        *sum += length(&arc.flat);
        *count += 1.0;
    }
    let count = |(sum, count): (f64, f64)| (sum / count / edge).round().max(1.0) as usize;
    lengths
        .into_iter()
        .map(|(name, lengths)| (name, count(lengths)))
        .collect()
}

/// The edge length that gives a garment of so many vertices.
fn edge_for(draft: &Draft, num_vertices: usize) -> Result<f64, PatternError> {
    let mut edge = 0.014 * (5000.0 / num_vertices as f64).sqrt();
    let mut best = (usize::MAX, edge);
    for _ in 0..24 {
        let found = count(draft, edge)?;
        let miss = found.abs_diff(num_vertices);
        if miss < best.0 {
            best = (miss, edge);
        }
        if miss * 200 <= num_vertices {
            break;
        }
        // Rounding of the arcs makes the count jump: a step that is not quite right gets over it.
        edge *= (found as f64 / num_vertices as f64).powf(0.45);
    }
    Ok(best.1)
}

/// How many vertices the garment has with edges of a length.
fn count(draft: &Draft, edge: f64) -> Result<usize, PatternError> {
    let mut template = Template {
        garment: GarmentKind::Tshirt,
        pieces: pieces(draft, edge),
        patches: Vec::new(),
        faces: Vec::new(),
        panels: Vec::new(),
        num_vertices: 0,
        mirror: Vec::new(),
        seams: Vec::new(),
        rims: Vec::new(),
    };
    for patch in &draft.patches {
        let outline = template.outline(patch, |arc| &arc.flat);
        let mut points = outline.clone();
        points.extend(crate::triangulate::lattice(&outline, edge));
        template.patches.push(PatchMesh {
            map: HarmonicMap::new(&points, points.len(), &[]),
            mean: points,
            faces: Vec::new(),
            vertices: [Vec::new(), Vec::new()],
        });
    }
    template.number(draft);
    Ok(template.num_vertices)
}
