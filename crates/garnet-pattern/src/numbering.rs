//! Sewing: which points of the patches are one vertex, and the faces and lines of the whole.

use std::collections::BTreeMap;

use crate::assembly::{is_turned, turned};
use crate::draft::{Draft, Meets};
use crate::sewn::Line;
use crate::template::{PanelPart, Template};
use crate::union::Union;

impl Template {
    /// Sews: numbers the vertices so that points of a seam are one vertex.
    pub(crate) fn number(&mut self, draft: &Draft) {
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
                        for &i in &points {
                            union.join(i, half + i);
                        }
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
                push(
                    panel.to_owned(),
                    [parts(panel, 0), parts(panel, 1)].concat(),
                );
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
                self.faces.extend(
                    mesh.faces
                        .iter()
                        .map(|&face| turned(face, is_turned).map(|point| vertices[point as usize])),
                );
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
}
