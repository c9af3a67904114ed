//! The topology of a garment, and the garments of that topology.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::curve::{Point2, Polyline, at_shares, places, resampled, shares_at, stepped};
use crate::draft::{Arc, Draft, Meets, Patch};
use crate::edge_length::{edge_for, pieces};
use crate::harmonic::HarmonicMap;
use crate::mend::{least_sine, mend};
use crate::reference::REFERENCE;
use crate::sewn::{Line, SewnGarment};
use crate::start::{StartShape, draft};
use crate::triangulate::{settle, triangulated};
use crate::wearer::Measures;
use crate::{GarmentKind, Parameters, PatternError, Wearer};

/// Smallest and largest number of vertices of a garment.
pub const VERTEX_RANGE: [usize; 2] = [500, 40_000];

/// Triangles of a pattern have no smaller angle, in degrees.
pub const LEAST_ANGLE: f64 = 8.0;

/// Points at triangles of the flat pattern with a smaller angle are moved, in degrees.
const SQUEEZED: f64 = 22.0;

/// And at those of the chart of the start shape.
const SQUEEZED_CHART: f64 = 4.0;

/// Rounds in which triangles that the harmonic map squeezed get room again.
const SETTLING: usize = 6;

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
    pub(crate) pieces: BTreeMap<&'static str, usize>,
    /// Where the points of guiding arcs lie, by their name.
    places: BTreeMap<&'static str, Vec<f64>>,
    pub(crate) patches: Vec<PatchMesh>,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) panels: Vec<PanelPart>,
    pub(crate) num_vertices: usize,
    pub(crate) mirror: Vec<u32>,
    pub(crate) seams: Vec<Line>,
    pub(crate) rims: Vec<Line>,
}

/// Shares of the length of an arc at its points, by its name.
pub(crate) type Shares = BTreeMap<&'static str, Vec<f64>>;

/// One patch of the left half, meshed.
#[derive(Debug, Clone)]
pub(crate) struct PatchMesh {
    pub(crate) map: HarmonicMap,
    pub(crate) mean: Vec<Point2>,
    pub(crate) faces: Vec<[u32; 3]>,
    /// The vertex of the garment that each point is, left and right.
    pub(crate) vertices: [Vec<u32>; 2],
}

/// One panel and the patches `(patch, side)` that make it.
#[derive(Debug, Clone)]
pub(crate) struct PanelPart {
    pub(crate) name: String,
    pub(crate) faces: Range<usize>,
    pub(crate) parts: Vec<(usize, usize)>,
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
        let edge = edge_for(&draft, num_vertices);
        Self::meshed(garment, &draft, edge)
    }

    /// The garment that was sewn.
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

    /// The vertex that is each vertex's mirror image at x = 0, its own in the middle, of all
    /// garments of this template `[vertex]`.
    pub fn mirror(&self) -> &[u32] {
        &self.mirror
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
        let shares = self.shares(&draft);
        let mut flats = Vec::new();
        let mut starts = Vec::new();
        for (patch, mesh) in draft.patches.iter().zip(&self.patches) {
            let outline = self.flat_outline(patch, &shares);
            let mut flat = mesh.map.placed(&outline, &mesh.mean);
            for _ in 0..SETTLING {
                settle(&mut flat, outline.len(), &mesh.faces);
            }
            mend(&mut flat, outline.len(), &mesh.faces, SQUEEZED);
            flats.push(flat);
            starts.push(self.start(patch, mesh, &shape));
        }
        self.check_angles(&flats, parameters)?;
        Ok(self.assembled(parameters, &draft, &flats, &starts))
    }

    /// A template without patches.
    pub(crate) fn empty(garment: GarmentKind, pieces: BTreeMap<&'static str, usize>) -> Self {
        Self {
            garment,
            pieces,
            places: BTreeMap::new(),
            patches: Vec::new(),
            faces: Vec::new(),
            panels: Vec::new(),
            num_vertices: 0,
            mirror: Vec::new(),
            seams: Vec::new(),
            rims: Vec::new(),
        }
    }

    fn meshed(garment: GarmentKind, draft: &Draft, edge: f64) -> Result<Self, PatternError> {
        let mut template = Self::empty(garment, pieces(draft, edge));
        for patch in &draft.patches {
            let outline = template.flat_outline(patch, &Shares::new());
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
        template.keep_places(draft);
        template.number(draft);
        Ok(template)
    }

    /// The outline of a patch, sampled: every arc without its last point.
    fn outline(&self, patch: &Patch, sample: impl Fn(&Arc, usize) -> Polyline) -> Vec<Point2> {
        let mut outline = Vec::new();
        for arc in &patch.arcs {
            let pieces = self.pieces[arc.name];
            outline.extend_from_slice(&sample(arc, pieces)[..pieces]);
        }
        outline
    }

    /// The outline in the flat pattern; `shares` of the lengths of arcs are from
    /// [`Template::shares`].
    pub(crate) fn flat_outline(&self, patch: &Patch, shares: &Shares) -> Vec<Point2> {
        self.outline(patch, |arc, pieces| match shares.get(arc.name) {
            None => resampled(&arc.flat, pieces),
            Some(shares) if arc.is_reversed => {
                let turned: Vec<f64> = shares.iter().rev().map(|share| 1.0 - share).collect();
                at_shares(&arc.flat, &turned)
            }
            Some(shares) => at_shares(&arc.flat, shares),
        })
    }

    /// Where on their lengths the points of guiding arcs lie, and so those of their followers.
    fn shares(&self, draft: &Draft) -> Shares {
        let arcs = draft.patches.iter().flat_map(|patch| &patch.arcs);
        let guides = arcs.filter(|arc| arc.guides);
        guides
            .filter_map(|arc| {
                let places = self.places.get(arc.name)?;
                Some((arc.name, shares_at(&arc.flat, places)))
            })
            .collect()
    }

    /// Keeps the points of guiding arcs where equal pieces of the mean pattern have them.
    fn keep_places(&mut self, draft: &Draft) {
        let arcs = draft.patches.iter().flat_map(|patch| &patch.arcs);
        for arc in arcs.filter(|arc| arc.guides) {
            let pieces = self.pieces[arc.name];
            let even: Vec<f64> = (0..=pieces).map(|i| i as f64 / pieces as f64).collect();
            self.places.insert(arc.name, places(&arc.flat, &even));
        }
    }

    /// The points of an outline on each arc, ends included, in the direction of the arc's name.
    pub(crate) fn arc_points(&self, patch: &Patch) -> Vec<Vec<usize>> {
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

    /// Where the points of a patch of the left half start, in space.
    fn start(&self, patch: &Patch, mesh: &PatchMesh, shape: &StartShape) -> Vec<[f64; 3]> {
        let outline = self.outline(patch, |arc, pieces| stepped(&arc.chart, pieces));
        let mut chart = mesh.map.placed(&outline, &guess(&mesh.mean, &outline));
        if shape.has_even_chart() {
            mend(&mut chart, outline.len(), &mesh.faces, SQUEEZED_CHART);
        }
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

    fn check_angles(
        &self,
        flats: &[Vec<Point2>],
        parameters: &Parameters,
    ) -> Result<(), PatternError> {
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
            far: parameters.far(),
        })
    }
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
