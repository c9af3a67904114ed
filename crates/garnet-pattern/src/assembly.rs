//! The finished garment from its placed patches.

use crate::curve::Point2;
use crate::draft::{Draft, Layer};
use crate::sewn::{Panel, SewnGarment};
use crate::template::Template;
use crate::{Parameters, Point3};

/// Distance between panels of the flat pattern, in metres.
const PANEL_GAP: f64 = 0.05;

impl Template {
    /// Lays the panels apart and puts the vertices in their places.
    pub(crate) fn assembled(
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
                if is_turned(draft.patches[patch].layer, side) {
                    [-x, y]
                } else {
                    [x, y]
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
pub(crate) fn is_turned(layer: Layer, side: usize) -> bool {
    (layer == Layer::Back) != (side == 1)
}

pub(crate) fn turned([a, b, c]: [u32; 3], is_turned: bool) -> [u32; 3] {
    if is_turned { [a, c, b] } else { [a, b, c] }
}
