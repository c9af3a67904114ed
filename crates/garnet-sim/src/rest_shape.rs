//! The shape in which cloth is free of force.

use crate::{Point3, SimError};
use garnet_mesh::Topology;
use nalgebra::Vector2;

/// The shape that a garment was cut or knitted in.
///
/// It gives lengths and areas alone. All cloth is flat at rest: bending resists any fold, whichever
/// way the garment lay when it was measured.
#[derive(Debug, Clone, PartialEq)]
pub enum RestShape {
    /// The lengths that the garment has at these positions `[vertex]`, in metres.
    Worn(Vec<Point3>),
    /// A sewing pattern.
    Flat {
        /// Place of each corner in the plane `[face][corner]`, in metres. An edge that the faces
        /// give two lengths (a seam) takes their mean.
        corners: Vec<[[f32; 2]; 3]>,
        /// Length that is aimed at over flat length `[face]`: ribs 0.9, waistbands 0.93, all
        /// else 1. Empty means 1 everywhere.
        shrink: Vec<f32>,
        /// What the fabric's friction on skin is multiplied by at shrunk faces, which keep all of
        /// it while the body moves: [`GRIP`] where elastic, buttons or a belt hold them. 0: they
        /// hold as other cloth does.
        grip: f32,
    },
}

/// The grip of waistbands and of ribs around the neck.
pub const GRIP: f32 = 3.0;

/// Smallest and largest grip.
const GRIP_RANGE: std::ops::RangeInclusive<f32> = 0.0..=20.0;

/// Smallest and largest factor of a shrunk face.
const SHRINK_RANGE: std::ops::RangeInclusive<f32> = 0.2..=2.0;

/// Below this area over the square of the longest side a face counts as a line.
const MIN_FLATNESS: f32 = 1e-5;

/// No side of a face may be shorter than this, in metres.
const MIN_SIDE: f32 = 1e-5;

/// How often the longer side of a seam may be as long as the shorter one.
const MAX_SEAM_RATIO: f32 = 2.0;

/// One triangle at rest: side lengths and area, enough to rebuild it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RestFace {
    /// Length of the side from each corner to the next, shrinking included, in metres.
    pub(crate) sides: [f32; 3],
    /// Area, shrinking included, m².
    pub(crate) area: f32,
    /// Area before shrinking, m²: what the mass comes from.
    pub(crate) cut_area: f32,
    pub(crate) is_shrunk: bool,
}

impl RestFace {
    /// Cotangents of the angles at the three corners.
    pub(crate) fn cotangents(&self) -> [f32; 3] {
        let [ab, bc, ca] = self.sides.map(|side| side * side);
        let scale = 1.0 / (4.0 * self.area);
        [
            (ab + ca - bc) * scale,
            (ab + bc - ca) * scale,
            (bc + ca - ab) * scale,
        ]
    }
}

impl RestShape {
    /// The grip of shrunk faces; 0 without a pattern.
    pub(crate) fn grip(&self) -> Result<f32, SimError> {
        let grip = match self {
            Self::Worn(_) => 0.0,
            Self::Flat { grip, .. } => *grip,
        };
        if GRIP_RANGE.contains(&grip) {
            return Ok(grip);
        }
        Err(SimError::Fabric {
            quantity: "grip of ribs",
            value: grip,
            min: *GRIP_RANGE.start(),
            max: *GRIP_RANGE.end(),
            unit: "times the friction",
        })
    }

    /// Whether a triangle as worn has the extent that a face of cloth needs.
    pub fn has_area(corners: [Point3; 3]) -> bool {
        let (sides, area) = worn_face(corners);
        is_sound(&sides, area)
    }

    /// The triangles at rest `[face]`.
    pub(crate) fn faces(&self, topology: &Topology) -> Result<Vec<RestFace>, SimError> {
        let faces = topology.faces();
        match self {
            Self::Worn(positions) => {
                check_count("rest positions", positions.len(), topology.num_vertices())?;
                let corner = |vertex: u32| positions[vertex as usize];
                let triangles = faces.iter().map(|face| face.map(corner));
                collect(
                    faces,
                    triangles.map(|[a, b, c]| (worn_face([a, b, c]), 1.0)),
                )
            }
            Self::Flat {
                corners, shrink, ..
            } => {
                check_count("faces of the pattern", corners.len(), faces.len())?;
                if !shrink.is_empty() {
                    check_count("factors of shrinking", shrink.len(), faces.len())?;
                }
                check_folds(topology, corners)?;
                let factor = |face: usize| shrink.get(face).copied().unwrap_or(1.0);
                let triangles = corners.iter().enumerate();
                collect(
                    faces,
                    triangles.map(|(face, corners)| (flat_face(*corners), factor(face))),
                )
            }
        }
    }
}

/// Sides and area of each face; refuses those without area.
fn collect(
    faces: &[[u32; 3]],
    triangles: impl Iterator<Item = (([f32; 3], f32), f32)>,
) -> Result<Vec<RestFace>, SimError> {
    let mut rest = Vec::with_capacity(faces.len());
    for (face, ((sides, area), factor)) in triangles.enumerate() {
        if !SHRINK_RANGE.contains(&factor) {
            return Err(SimError::Fabric {
                quantity: "shrinking",
                value: factor,
                min: *SHRINK_RANGE.start(),
                max: *SHRINK_RANGE.end(),
                unit: "times the flat length",
            });
        }
        if !is_sound(&sides, area) {
            return Err(SimError::NoArea {
                face,
                corners: faces[face],
            });
        }
        rest.push(RestFace {
            sides: sides.map(|side| factor * side),
            area: factor * factor * area,
            cut_area: area,
            is_shrunk: (factor - 1.0).abs() > f32::EPSILON,
        });
    }
    Ok(rest)
}

/// Whether a triangle has an extent.
fn is_sound(sides: &[f32; 3], area: f32) -> bool {
    let longest = sides.iter().copied().fold(0.0, f32::max);
    let shortest = sides.iter().copied().fold(f32::INFINITY, f32::min);
    shortest >= MIN_SIDE && area > MIN_FLATNESS * longest * longest && longest.is_finite()
}

fn worn_face([a, b, c]: [Point3; 3]) -> ([f32; 3], f32) {
    let sides = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
    (sides, 0.5 * (b - a).cross(&(c - a)).norm())
}

fn flat_face(corners: [[f32; 2]; 3]) -> ([f32; 3], f32) {
    let [a, b, c] = corners.map(Vector2::from);
    let sides = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
    (sides, signed_area(corners).abs())
}

fn signed_area(corners: [[f32; 2]; 3]) -> f32 {
    let [a, b, c] = corners.map(Vector2::from);
    0.5 * (b - a).perp(&(c - a))
}

/// Refuses neighbors of one panel that lie on top of each other, and seams whose sides differ.
fn check_folds(topology: &Topology, corners: &[[[f32; 2]; 3]]) -> Result<(), SimError> {
    for (edge, &vertices) in topology.edges().iter().enumerate() {
        let &[first, second] = topology.edge_faces(edge) else {
            continue;
        };
        let ends = [first, second].map(|face| {
            let place = |vertex: u32| {
                let corners_of_face = topology.faces()[face as usize].iter();
                let slot = corners_of_face.zip(corners[face as usize]);
                slot.filter(|&(&corner, _)| corner == vertex)
                    .map(|(_, place)| place)
                    .next()
            };
            vertices.map(|vertex| place(vertex).unwrap_or_default())
        });
        let areas = [first, second].map(|face| signed_area(corners[face as usize]));
        if ends[0] == ends[1] && areas[0] * areas[1] < 0.0 {
            return Err(SimError::FoldedPattern {
                faces: [first, second],
            });
        }
        let lengths = ends.map(|[a, b]| (Vector2::from(b) - Vector2::from(a)).norm());
        let [short, long] = [lengths[0].min(lengths[1]), lengths[0].max(lengths[1])];
        if long > MAX_SEAM_RATIO * short {
            return Err(SimError::SeamMismatch { vertices, lengths });
        }
    }
    Ok(())
}

pub(crate) fn check_count(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), SimError> {
    if found == expected {
        return Ok(());
    }
    Err(SimError::Count {
        what,
        found,
        expected,
    })
}
