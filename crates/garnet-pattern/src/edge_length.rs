//! How finely a pattern is meshed.

use std::collections::BTreeMap;

use crate::GarmentKind;
use crate::curve::length;
use crate::draft::Draft;
use crate::harmonic::HarmonicMap;
use crate::template::{PatchMesh, Shares, Template};
use crate::triangulate::lattice;

/// How many pieces each arc has with edges of a length: arcs of one name alike.
pub(crate) fn pieces(draft: &Draft, edge: f64) -> BTreeMap<&'static str, usize> {
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
pub(crate) fn edge_for(draft: &Draft, num_vertices: usize) -> f64 {
    let mut edge = 0.014 * (5000.0 / num_vertices as f64).sqrt();
    let mut best = (usize::MAX, edge);
    for _ in 0..24 {
        let found = count(draft, edge);
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
    best.1
}

/// How many vertices the garment has with edges of a length.
fn count(draft: &Draft, edge: f64) -> usize {
    let mut template = Template::empty(GarmentKind::Tshirt, pieces(draft, edge));
    for patch in &draft.patches {
        let outline = template.flat_outline(patch, &Shares::new());
        let mut points = outline.clone();
        points.extend(lattice(&outline, edge));
        template.patches.push(PatchMesh {
            map: HarmonicMap::new(&points, points.len(), &[]),
            mean: points,
            faces: Vec::new(),
            vertices: [Vec::new(), Vec::new()],
        });
    }
    template.number(draft);
    template.num_vertices
}
