//! Isotropic remeshing of a half body with a border in the middle plane, after Botsch and Kobbelt
//! 2004: split, collapse, flip, smooth along the surface, project.

use garnet_body::shape::BodySurface;

use super::Vec3;

/// A mesh of the left half, with unused vertices and in no order.
#[derive(Debug, Default, Clone)]
pub(crate) struct Half {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) is_middle: Vec<bool>,
    pub(crate) faces: Vec<[u32; 3]>,
}

/// A coarser mesh on a subset of the vertices.
#[derive(Debug)]
pub(crate) struct Coarse {
    pub(crate) vertices: Vec<u32>,
    pub(crate) faces: Vec<[u32; 3]>,
}

/// A mesh that is changed edge by edge. Dead faces have equal corners.
#[derive(Debug, Clone)]
pub(crate) struct Mesh {
    pub(crate) positions: Vec<Vec3>,
    is_middle: Vec<bool>,
    pub(crate) faces: Vec<[u32; 3]>,
    vertex_faces: Vec<Vec<u32>>,
}

const DEAD: [u32; 3] = [u32::MAX; 3];

impl Mesh {
    pub(crate) fn new(half: Half) -> Self {
        let mut vertex_faces = vec![Vec::new(); half.positions.len()];
        for (face, corners) in half.faces.iter().enumerate() {
            for &corner in corners {
                vertex_faces[corner as usize].push(face as u32);
            }
        }
        Self {
            positions: half.positions,
            is_middle: half.is_middle,
            faces: half.faces,
            vertex_faces,
        }
    }

    /// Whether the faces around every vertex form one fan, open in the middle plane alone.
    pub(crate) fn is_manifold(&self) -> bool {
        (0..self.positions.len() as u32).all(|vertex| {
            let faces = &self.vertex_faces[vertex as usize];
            if faces.is_empty() {
                return true;
            }
            let neighbors = self.neighbors(vertex);
            let open = neighbors
                .iter()
                .filter(|&&other| self.edge_faces(vertex, other).len() == 1)
                .count();
            let regular = neighbors
                .iter()
                .all(|&other| matches!(self.edge_faces(vertex, other).len(), 1 | 2));
            let is_middle = self.is_middle[vertex as usize];
            let expected_open = if is_middle { 2 } else { 0 };
            // One fan reaches every neighbor from any of them.
            let mut reached = vec![neighbors[0]];
            let mut next = 0;
            while let Some(&other) = reached.get(next) {
                for face in self.edge_faces(vertex, other) {
                    let across = self.opposite(face, vertex, other);
                    if !reached.contains(&across) {
                        reached.push(across);
                    }
                }
                next += 1;
            }
            regular && open == expected_open && reached.len() == neighbors.len()
        })
    }

    pub(crate) fn num_middle(&self) -> usize {
        self.is_middle
            .iter()
            .filter(|&&is_middle| is_middle)
            .count()
    }

    pub(crate) fn remesh(
        &mut self,
        surface: &BodySurface,
        length: impl Fn(&Vec3) -> f64,
        rounds: usize,
    ) {
        for _ in 0..6 {
            self.project(surface);
            self.smooth();
        }
        for _ in 0..rounds {
            self.split_long(&length);
            self.collapse_short(&length, 0.8, false);
            self.flip_to_valence();
            for _ in 0..3 {
                self.smooth();
                self.project(surface);
            }
        }
        for _ in 0..8 {
            self.flip_to_valence();
            self.smooth();
            self.project(surface);
        }
    }

    fn at(&self, vertex: u32) -> Vec3 {
        self.positions[vertex as usize]
    }

    fn edges(&self) -> Vec<[u32; 2]> {
        let mut edges: Vec<[u32; 2]> = self
            .faces
            .iter()
            .filter(|&&face| face != DEAD)
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    fn edge_faces(&self, a: u32, b: u32) -> Vec<u32> {
        let faces = self.vertex_faces[a as usize].iter().copied();
        faces
            .filter(|&face| self.faces[face as usize].contains(&b))
            .collect()
    }

    fn opposite(&self, face: u32, a: u32, b: u32) -> u32 {
        let corners = self.faces[face as usize];
        *corners
            .iter()
            .find(|&&corner| corner != a && corner != b)
            .expect("a face has three corners")
    }

    fn neighbors(&self, vertex: u32) -> Vec<u32> {
        let faces = self.vertex_faces[vertex as usize].iter();
        let mut neighbors: Vec<u32> = faces
            .flat_map(|&face| self.faces[face as usize])
            .filter(|&corner| corner != vertex)
            .collect();
        neighbors.sort_unstable();
        neighbors.dedup();
        neighbors
    }

    fn set_face(&mut self, face: u32, corners: [u32; 3]) {
        let old = self.faces[face as usize];
        if old != DEAD {
            for corner in old {
                self.vertex_faces[corner as usize].retain(|&other| other != face);
            }
        }
        self.faces[face as usize] = corners;
        if corners != DEAD {
            for corner in corners {
                self.vertex_faces[corner as usize].push(face);
            }
        }
    }

    fn split_long(&mut self, length: &impl Fn(&Vec3) -> f64) {
        let mut edges: Vec<(f64, [u32; 2])> = self
            .edges()
            .into_iter()
            .map(|[a, b]| {
                let middle = 0.5 * (self.at(a) + self.at(b));
                ((self.at(a) - self.at(b)).norm() / length(&middle), [a, b])
            })
            .filter(|&(ratio, _)| ratio > 4.0 / 3.0)
            .collect();
        edges.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, [a, b]) in edges {
            let faces = self.edge_faces(a, b);
            if faces.is_empty() {
                continue;
            }
            let middle = self.positions.len() as u32;
            self.positions.push(0.5 * (self.at(a) + self.at(b)));
            self.is_middle.push(faces.len() == 1);
            self.vertex_faces.push(Vec::new());
            for face in faces {
                let corners = self.faces[face as usize];
                let replaced =
                    |from: u32| corners.map(|corner| if corner == from { middle } else { corner });
                let second = replaced(a);
                self.set_face(face, replaced(b));
                self.faces.push(DEAD);
                self.set_face(self.faces.len() as u32 - 1, second);
            }
        }
    }

    /// Collapses edges below `share` of their length; the vertex that goes is the one that may.
    fn collapse_short(&mut self, length: &impl Fn(&Vec3) -> f64, share: f64, keeps_places: bool) {
        let mut edges: Vec<(f64, [u32; 2])> = self
            .edges()
            .into_iter()
            .map(|[a, b]| {
                let middle = 0.5 * (self.at(a) + self.at(b));
                ((self.at(a) - self.at(b)).norm() / length(&middle), [a, b])
            })
            .filter(|&(ratio, _)| ratio < share)
            .collect();
        edges.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, [a, b]) in edges {
            for [gone, kept] in [[a, b], [b, a]] {
                if self.may_collapse(gone, kept, length, keeps_places) {
                    self.collapse(gone, kept, keeps_places);
                    break;
                }
            }
        }
    }

    fn may_collapse(
        &self,
        gone: u32,
        kept: u32,
        length: &impl Fn(&Vec3) -> f64,
        keeps_places: bool,
    ) -> bool {
        let shared = self.edge_faces(gone, kept);
        let is_border = shared.len() == 1;
        let [gone_middle, kept_middle] = [gone, kept].map(|vertex| self.is_middle[vertex as usize]);
        if shared.is_empty() || gone_middle && !kept_middle || gone_middle && !is_border {
            return false;
        }
        let [around_gone, around_kept] = [self.neighbors(gone), self.neighbors(kept)];
        let common = around_gone
            .iter()
            .filter(|vertex| around_kept.contains(vertex))
            .count();
        if common != shared.len() {
            return false;
        }
        let target = self.collapsed_place(gone, kept, keeps_places);
        if around_gone.iter().any(|&vertex| {
            let middle = 0.5 * (self.at(vertex) + target);
            (self.at(vertex) - target).norm() > 1.45 * length(&middle)
        }) {
            return false;
        }
        for (vertex, other) in [(gone, kept), (kept, gone)] {
            for &face in &self.vertex_faces[vertex as usize] {
                let corners = self.faces[face as usize];
                if corners.contains(&other) {
                    continue;
                }
                let moved = corners.map(|corner| {
                    if corner == vertex {
                        target
                    } else {
                        self.at(corner)
                    }
                });
                let before = normal(corners.map(|corner| self.at(corner)));
                let after = normal(moved);
                let cosine = before.dot(&after) / (before.norm() * after.norm()).max(1e-30);
                if cosine < 0.5 || smallest_angle(moved) < 0.26 {
                    return false;
                }
            }
        }
        true
    }

    fn collapsed_place(&self, gone: u32, kept: u32, keeps_places: bool) -> Vec3 {
        let both = self.is_middle[gone as usize] == self.is_middle[kept as usize];
        if both && !keeps_places {
            0.5 * (self.at(gone) + self.at(kept))
        } else {
            self.at(kept)
        }
    }

    fn collapse(&mut self, gone: u32, kept: u32, keeps_places: bool) {
        self.positions[kept as usize] = self.collapsed_place(gone, kept, keeps_places);
        for face in self.vertex_faces[gone as usize].clone() {
            let corners = self.faces[face as usize];
            if corners.contains(&kept) {
                self.set_face(face, DEAD);
            } else {
                let moved = corners.map(|corner| if corner == gone { kept } else { corner });
                self.set_face(face, moved);
            }
        }
    }

    fn valence_excess(&self, vertex: u32, change: i32) -> i32 {
        let ideal = if self.is_middle[vertex as usize] {
            4
        } else {
            6
        };
        (i32::try_from(self.neighbors(vertex).len()).unwrap_or(i32::MAX) + change - ideal).pow(2)
    }

    /// Flips edges where that brings valences closer to 6 (4 on the border) or, at equal valences,
    /// opens the smallest angle.
    fn flip_to_valence(&mut self) {
        for [a, b] in self.edges() {
            let faces = self.edge_faces(a, b);
            let &[first, second] = faces.as_slice() else {
                continue;
            };
            let corners = self.faces[first as usize];
            let place = corners
                .iter()
                .position(|&corner| corner == a)
                .expect("the face has the edge");
            // The face that runs from a to b comes first.
            let [first, second] = if corners[(place + 1) % 3] == b {
                [first, second]
            } else {
                [second, first]
            };
            let (c, d) = (self.opposite(first, a, b), self.opposite(second, a, b));
            if !self.edge_faces(c, d).is_empty() {
                continue;
            }
            let excess = |change: i32| {
                [(a, -change), (b, -change), (c, change), (d, change)]
                    .map(|(vertex, change)| self.valence_excess(vertex, change))
                    .iter()
                    .sum::<i32>()
            };
            let (before, after) = (excess(0), excess(1));
            let p = |vertices: [u32; 3]| vertices.map(|vertex| self.at(vertex));
            let old = [p([a, b, c]), p([b, a, d])];
            let new = [p([a, d, c]), p([d, b, c])];
            let smallest =
                |faces: [[Vec3; 3]; 2]| smallest_angle(faces[0]).min(smallest_angle(faces[1]));
            let is_better = match after.cmp(&before) {
                std::cmp::Ordering::Less => smallest(new) > 0.9 * smallest(old).min(0.5),
                std::cmp::Ordering::Equal => smallest(new) > 1.05 * smallest(old),
                std::cmp::Ordering::Greater => {
                    smallest(old) < 0.35 && smallest(new) > 1.3 * smallest(old)
                }
            };
            let normals = [old[0], old[1], new[0], new[1]].map(|face| normal(face).normalize());
            let sum = normals[0] + normals[1];
            let is_smooth = normals[2].dot(&sum) > 1.2 && normals[3].dot(&sum) > 1.2;
            let is_flat = normals[0].dot(&normals[1]) > 0.6;
            if is_better && is_smooth && is_flat {
                self.set_face(first, [a, d, c]);
                self.set_face(second, [d, b, c]);
            }
        }
    }

    /// Moves vertices along the surface to the middle of their neighbors, weighted by the areas
    /// around these, which evens out density.
    fn smooth(&mut self) {
        let areas: Vec<f64> = (0..self.positions.len())
            .map(|vertex| {
                let faces = self.vertex_faces[vertex].iter();
                faces
                    .map(|&face| {
                        normal(self.faces[face as usize].map(|corner| self.at(corner))).norm()
                    })
                    .sum()
            })
            .collect();
        let moved: Vec<Vec3> = (0..self.positions.len() as u32)
            .map(|vertex| {
                let here = self.at(vertex);
                let is_middle = self.is_middle[vertex as usize];
                let mut sum = Vec3::zeros();
                let mut total = 0.0;
                for neighbor in self.neighbors(vertex) {
                    if is_middle
                        && !(self.is_middle[neighbor as usize]
                            && self.edge_faces(vertex, neighbor).len() == 1)
                    {
                        continue;
                    }
                    // Larger meshes are where they should be: weigh by area over its own length.
                    let weight = areas[neighbor as usize].sqrt();
                    sum += weight * self.at(neighbor);
                    total += weight;
                }
                if total == 0.0 {
                    return here;
                }
                let faces = self.vertex_faces[vertex as usize].iter();
                let up: Vec3 = faces
                    .map(|&face| normal(self.faces[face as usize].map(|corner| self.at(corner))))
                    .sum();
                let mut up = up.normalize();
                if is_middle {
                    up.x = 0.0;
                    up = up.normalize();
                }
                let step = sum / total - here;
                here + 0.7 * (step - up * up.dot(&step))
            })
            .collect();
        self.positions = moved;
    }

    fn project(&mut self, surface: &BodySurface) {
        for (position, &is_middle) in self.positions.iter_mut().zip(&self.is_middle) {
            for _ in 0..3 {
                if is_middle {
                    position.x = 0.0;
                }
                let (distance, gradient) = surface.distance_and_gradient((*position).into());
                let mut gradient = Vec3::from(gradient);
                if is_middle {
                    gradient.x = 0.0;
                }
                let step = distance * gradient / gradient.norm_squared().max(0.1);
                *position -= step.cap_magnitude(0.01);
            }
        }
    }

    /// The same mesh without dead faces and unused vertices; those in the middle come first.
    pub(crate) fn compacted(&self) -> Self {
        let used =
            (0..self.positions.len()).filter(|&vertex| !self.vertex_faces[vertex].is_empty());
        let mut order: Vec<usize> = used.collect();
        order.sort_by_key(|&vertex| !self.is_middle[vertex]);
        let mut number = vec![u32::MAX; self.positions.len()];
        for (new, &old) in order.iter().enumerate() {
            number[old] = new as u32;
        }
        let faces = self.faces.iter().filter(|&&face| face != DEAD);
        Self::new(Half {
            positions: order.iter().map(|&vertex| self.positions[vertex]).collect(),
            is_middle: order.iter().map(|&vertex| self.is_middle[vertex]).collect(),
            faces: faces
                .map(|face| face.map(|corner| number[corner as usize]))
                .collect(),
        })
    }

    /// A mesh with edges of `length` whose vertices are some of this one's.
    pub(crate) fn coarsened(&self, length: impl Fn(&Vec3) -> f64) -> Coarse {
        let mut coarse = self.clone();
        for share in [0.35, 0.45, 0.55, 0.65, 0.75, 0.8, 0.8] {
            coarse.collapse_short(&length, share, true);
            coarse.flip_to_valence();
        }
        let vertices: Vec<u32> = (0..self.positions.len() as u32)
            .filter(|&vertex| !coarse.vertex_faces[vertex as usize].is_empty())
            .collect();
        let mut number = vec![u32::MAX; self.positions.len()];
        for (new, &old) in vertices.iter().enumerate() {
            number[old as usize] = new as u32;
        }
        let faces = coarse.faces.iter().filter(|&&face| face != DEAD);
        Coarse {
            faces: faces
                .map(|face| face.map(|corner| number[corner as usize]))
                .collect(),
            vertices,
        }
    }
}

/// The normal of a face, as long as twice its area.
fn normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(&(c - a))
}

/// The smallest angle of a triangle, in radians.
fn smallest_angle(corners: [Vec3; 3]) -> f64 {
    let angle = |i: usize| {
        let (u, v) = (
            corners[(i + 1) % 3] - corners[i],
            corners[(i + 2) % 3] - corners[i],
        );
        u.cross(&v).norm().atan2(u.dot(&v))
    };
    angle(0).min(angle(1)).min(angle(2))
}
