//! A tunic: a front and a back panel, sewn at sides and sleeves, wrapped around the mannequin.

use std::fmt::Write;

use garnet::{Point3, TriMesh, Vector3};

use crate::bone::onto_level;
use crate::form::Form;

/// Distance of the cuffs from the shoulder, along the arm, in metres.
const CUFF: f32 = 0.23;

/// Distance from the form, in metres.
const GAP: f32 = 0.014;

/// Area of the panels, in m².
const CLOTH_AREA: f32 = 1.05;

/// Smoothing steps of the coarse panels, and after each refinement.
const STEPS: [usize; 2] = [120, 6];

/// A garment of quads with the texture coordinates of its sewing pattern.
#[derive(Debug, Clone)]
pub struct Tunic {
    /// The mesh at rest: two triangles a quad, in the order of [`Tunic::quads`].
    pub mesh: TriMesh,
    /// Vertex numbers of each quad, from 0.
    pub quads: Vec<[u32; 4]>,
    /// Pattern coordinates of each quad's corners.
    pub quad_uvs: Vec<[[f32; 2]; 4]>,
}

impl Tunic {
    /// The garment as the text of an OBJ file.
    ///
    /// # Panics
    ///
    /// Never: a string takes all text.
    pub fn to_obj(&self) -> String {
        let mut text = String::from("# a tunic of two panels, in metres\no tunic\n");
        for point in self.mesh.positions() {
            let line = writeln!(text, "v {:.5} {:.5} {:.5}", point.x, point.y, point.z);
            line.expect("a string takes all text");
        }
        let mut uvs: Vec<[u32; 2]> = Vec::new();
        let bits = |uv: &[f32; 2]| uv.map(f32::to_bits);
        uvs.extend(self.quad_uvs.as_flattened().iter().map(bits));
        uvs.sort_unstable();
        uvs.dedup();
        for uv in &uvs {
            let [u, v] = uv.map(f32::from_bits);
            writeln!(text, "vt {u:.4} {v:.4}").expect("a string takes all text");
        }
        for (quad, quad_uvs) in self.quads.iter().zip(&self.quad_uvs) {
            text.push('f');
            for (vertex, uv) in quad.iter().zip(quad_uvs) {
                let uv = uvs.binary_search(&bits(uv)).expect("all were collected");
                write!(text, " {}/{}", vertex + 1, uv + 1).expect("a string takes all text");
            }
            text.push('\n');
        }
        text
    }
}

/// A tunic with short sleeves for the [`mannequin`](crate::mannequin), of about `num_vertices`
/// vertices (1 000 and more), 14 mm before the skin and wider at the hem.
pub fn tunic(num_vertices: usize) -> Tunic {
    tunic_on(&Form::of_mannequin(), num_vertices)
}

/// The same tunic for another form.
pub fn tunic_on(form: &Form, num_vertices: usize) -> Tunic {
    let num_refinements = [3_000, 20_000]
        .iter()
        .filter(|&&n| num_vertices > n)
        .count();
    let coarse = num_vertices as f32 / (1 << (2 * num_refinements)) as f32;
    let mut panels = Panels::new((CLOTH_AREA / coarse).sqrt(), form);
    panels.wrap(form, STEPS[0]);
    for _ in 0..num_refinements {
        panels = panels.refined();
        panels.wrap(form, STEPS[1]);
    }
    panels.into_tunic()
}

/// Two panels on one lattice: columns from the right cuff to the left one, rows from hem to neck.
struct Panels {
    spacing: f32,
    /// Columns of half the trunk.
    trunk: i32,
    /// Columns of a sleeve.
    sleeve: i32,
    /// Rows of the trunk up to the shoulder.
    rows: i32,
    /// Rows of a sleeve.
    sleeve_rows: i32,
    /// Columns of half the neck.
    neck: i32,
    /// Vertex numbers `[side][row][column]`.
    vertices: Vec<u32>,
    positions: Vec<Point3>,
}

impl Panels {
    fn new(spacing: f32, form: &Form) -> Self {
        let cells = |length: f32| ((length / spacing) as i32).max(2);
        let mut panels = Self {
            spacing,
            trunk: cells(0.29),
            sleeve: cells(0.2),
            rows: cells(0.86),
            sleeve_rows: cells(0.24),
            neck: cells(0.115),
            vertices: Vec::new(),
            positions: Vec::new(),
        };
        panels.number_vertices();
        panels.positions = panels.start(form);
        panels
    }

    fn half_width(&self) -> i32 {
        self.trunk + self.sleeve
    }

    fn has_node(&self, row: i32, column: i32) -> bool {
        let sleeve_from = self.rows - self.sleeve_rows;
        let is_trunk = column.abs() <= self.trunk;
        let is_sleeve = column.abs() <= self.half_width() && row >= sleeve_from;
        (0..=self.rows).contains(&row) && (is_trunk || is_sleeve)
    }

    /// Whether front and back are one at a node.
    fn is_sewn(&self, row: i32, column: i32) -> bool {
        let sleeve_from = self.rows - self.sleeve_rows;
        let is_shoulder = row == self.rows && column.abs() >= self.neck;
        let is_side = column.abs() == self.trunk && row <= sleeve_from;
        let is_underarm = column.abs() > self.trunk && row == sleeve_from;
        is_shoulder || is_side || is_underarm
    }

    fn slot(&self, side: i32, row: i32, column: i32) -> usize {
        let width = 2 * self.half_width() + 1;
        let column = column + self.half_width();
        usize::try_from((side * (self.rows + 1) + row) * width + column)
            .expect("nodes are inside the lattice")
    }

    /// The vertex of a node that there is; side 0 is the front.
    fn vertex(&self, side: i32, row: i32, column: i32) -> u32 {
        self.vertices[self.slot(side, row, column)]
    }

    /// Every node `[side, row, column]`, in order.
    fn nodes(&self) -> Vec<[i32; 3]> {
        let mut nodes = Vec::new();
        for side in 0..2 {
            for row in 0..=self.rows {
                for column in -self.half_width()..=self.half_width() {
                    if self.has_node(row, column) {
                        nodes.push([side, row, column]);
                    }
                }
            }
        }
        nodes
    }

    fn number_vertices(&mut self) {
        let size = 2 * (self.rows + 1) * (2 * self.half_width() + 1);
        self.vertices = vec![u32::MAX; usize::try_from(size).unwrap_or(0)];
        let mut count = 0;
        for [side, row, column] in self.nodes() {
            let slot = self.slot(side, row, column);
            self.vertices[slot] = if side == 1 && self.is_sewn(row, column) {
                self.vertex(0, row, column)
            } else {
                count += 1;
                count - 1
            };
        }
        self.positions = vec![Point3::origin(); count as usize];
    }

    /// Wide positions around the form, before the panels are wrapped.
    fn start(&self, form: &Form) -> Vec<Point3> {
        let mut positions = self.positions.clone();
        let arm = form.arm_direction;
        for [side, row, column] in self.nodes() {
            let outward = if side == 0 { 1.0 } else { -1.0 };
            let depth = if self.is_sewn(row, column) {
                0.0
            } else {
                outward
            };
            let mirror = if column < 0 { -1.0 } else { 1.0 };
            let beyond = (column.abs() - self.trunk).max(0);
            let point = if beyond == 0 {
                let share = row as f32 / self.rows as f32;
                let x = 0.24 * column as f32 / self.trunk as f32;
                Vector3::new(x, form.hem + share * (form.neck - form.hem), 0.25 * depth)
            } else {
                let across = Vector3::new(-arm.y, arm.x, 0.0);
                let middle = self.rows as f32 - 0.5 * self.sleeve_rows as f32;
                let height = 0.22 * (row as f32 - middle) / self.sleeve_rows as f32;
                let along = 0.06 + (CUFF - 0.06) * beyond as f32 / self.sleeve as f32;
                let left = form.shoulder + along * arm + height * across;
                Vector3::new(mirror * left.x, left.y, 0.15 * depth)
            };
            positions[self.vertex(side, row, column) as usize] = point.into();
        }
        positions
    }

    /// Smooths the cloth at a distance from the form, with hem, neckline and cuffs in planes.
    fn wrap(&mut self, form: &Form, steps: usize) {
        let field = |point| (form.distance)(point);
        let quads = self.quads();
        let rims = self.rims(form);
        for _ in 0..steps {
            let mut sums = vec![(Vector3::zeros(), 0.0_f32); self.positions.len()];
            for [_, quad] in &quads {
                for corner in 0..4 {
                    let [a, b] = [quad[corner], quad[(corner + 1) % 4]].map(|v| v as usize);
                    for (from, to) in [(a, b), (b, a)] {
                        sums[to].0 += self.positions[from].coords;
                        sums[to].1 += 1.0;
                    }
                }
            }
            for (position, (sum, count)) in self.positions.iter_mut().zip(sums) {
                let middle = Point3::from(sum / count);
                *position = onto_level(field, GAP, *position + 0.7 * (middle - *position));
            }
            for &(vertex, normal, offset) in &rims {
                for _ in 0..4 {
                    let position = &mut self.positions[vertex];
                    *position -= (position.coords.dot(&normal) - offset) * normal;
                    *position = onto_level(field, GAP, *position);
                }
                let position = &mut self.positions[vertex];
                *position -= (position.coords.dot(&normal) - offset) * normal;
            }
        }
    }

    /// The vertices of hem, neckline and cuffs, each with the plane that it stays in.
    fn rims(&self, form: &Form) -> Vec<(usize, Vector3, f32)> {
        let mut rims = Vec::new();
        for [side, row, column] in self.nodes() {
            let vertex = self.vertex(side, row, column) as usize;
            if row == 0 {
                rims.push((vertex, Vector3::y(), form.hem));
            } else if row == self.rows && column.abs() <= self.neck {
                rims.push((vertex, Vector3::y(), form.neck));
            } else if column.abs() == self.half_width() {
                let mut normal = form.arm_direction;
                let offset = normal.dot(&form.shoulder) + CUFF;
                normal.x *= if column < 0 { -1.0 } else { 1.0 };
                rims.push((vertex, normal, offset));
            }
        }
        rims
    }

    /// Places on the lattice and vertices of each quad, counter-clockwise from outside.
    fn quads(&self) -> Vec<[[u32; 4]; 2]> {
        let mut quads = Vec::new();
        for [side, row, column] in self.nodes() {
            let mut corners = [[0, 0], [0, 1], [1, 1], [1, 0]];
            if side == 1 {
                corners.reverse();
            }
            let corners = corners.map(|[up, along]| [row + up, column + along]);
            if corners
                .iter()
                .all(|&[row, column]| self.has_node(row, column))
            {
                let slots = corners.map(|[row, column]| self.slot(side, row, column) as u32);
                quads.push([slots, corners.map(|[r, c]| self.vertex(side, r, c))]);
            }
        }
        quads
    }

    /// The same panels with cells of half the size.
    fn refined(&self) -> Self {
        let mut fine = Self {
            spacing: 0.5 * self.spacing,
            trunk: 2 * self.trunk,
            sleeve: 2 * self.sleeve,
            rows: 2 * self.rows,
            sleeve_rows: 2 * self.sleeve_rows,
            neck: 2 * self.neck,
            vertices: Vec::new(),
            positions: Vec::new(),
        };
        fine.number_vertices();
        for [side, row, column] in fine.nodes() {
            let ends = |n: i32| [n.div_euclid(2), (n + 1).div_euclid(2)];
            let mut sum = Vector3::zeros();
            let mut count = 0.0;
            for coarse_row in ends(row) {
                for coarse_column in ends(column) {
                    if self.has_node(coarse_row, coarse_column) {
                        let vertex = self.vertex(side, coarse_row, coarse_column);
                        sum += self.positions[vertex as usize].coords;
                        count += 1.0;
                    }
                }
            }
            let vertex = fine.vertex(side, row, column);
            fine.positions[vertex as usize] = Point3::from(sum / count);
        }
        fine
    }

    fn into_tunic(self) -> Tunic {
        let width = 2 * self.half_width() + 1;
        let uv = |slot: u32| {
            let slot = i32::try_from(slot).unwrap_or(0);
            let (line, column) = (slot / width, slot % width);
            let (side, row) = (line / (self.rows + 1), line % (self.rows + 1));
            // One unit of the texture holds both panels side by side.
            let column = column + side * (width + 1);
            [column, row].map(|n| 0.4 * self.spacing * n as f32)
        };
        let pairs = self.quads();
        let quads: Vec<[u32; 4]> = pairs.iter().map(|pair| pair[1]).collect();
        let quad_uvs = pairs.iter().map(|pair| pair[0].map(uv)).collect();
        let faces = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let faces = faces.collect();
        let mesh = TriMesh::new(self.positions, faces).expect("quads name vertices of the panels");
        Tunic {
            mesh,
            quads,
            quad_uvs,
        }
    }
}
