//! The collider at a time: its hierarchy, normals and velocities.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use rayon::prelude::*;

use crate::collider::Adjacency;

use crate::contact::triangle::project_origin;
use crate::{Collider, Point3, SimError, Vector3};
use garnet_knn::{Feature, KnnError, Surface};

/// The skin that cloth lies on, between one refresh of the contacts and the next.
#[derive(Debug)]
pub(crate) struct Skin {
    surface: Surface,
    adjacency: Arc<Adjacency>,
    parts: Option<Vec<u8>>,
    face_normals: Vec<Vector3>,
    vertex_normals: Vec<Vector3>,
    /// Whether a face is turned over in a fold of the skin.
    is_turned: Vec<bool>,
    burial: Burial,
    /// Velocity of each vertex, m/s; empty while all stand still.
    velocities: Vec<Vector3>,
    /// Sum of the farthest moves of any vertex since the start, m.
    travel: f32,
}

/// Which vertices are inside another part of the body, found out when somebody wants to know.
#[derive(Debug, Default)]
struct Burial {
    /// Of each vertex [`UNKNOWN`], or whether it is; empty if none can be.
    answers: Vec<AtomicU8>,
    /// The skin that is meant and its normals, if it has moved on since.
    before: Option<(Surface, Vec<Vector3>)>,
}

/// A place on the skin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Foot {
    pub(crate) face: u32,
    pub(crate) barycentric: [f32; 3],
    pub(crate) feature: Feature,
    pub(crate) point: Point3,
    /// From the place to the point that was asked for.
    pub(crate) offset: Vector3,
    pub(crate) distance_squared: f32,
}

/// No answer yet.
const UNKNOWN: u8 = u8::MAX;

/// Vertices whose normals one thread works on at a time.
const CHUNK: usize = 2048;

/// A vertex of the skin is buried if the point so far before it is inside the body, m.
const BURIED_PROBE: f32 = 1e-3;

/// How often the normals are averaged that tell which faces are turned over.
const NORMAL_SMOOTHING: usize = 4;

/// A walk over the skin ends after so many steps.
const MAX_STEPS: usize = 24;

impl Skin {
    pub(crate) fn new(collider: &Collider, positions: Vec<Point3>) -> Result<Self, SimError> {
        let mut skin = Self {
            surface: collider.surface(positions)?,
            adjacency: Arc::clone(collider.adjacency()),
            parts: collider.part_of_face().map(<[u8]>::to_vec),
            face_normals: Vec::new(),
            vertex_normals: Vec::new(),
            is_turned: vec![false; collider.faces().len()],
            burial: Burial::default(),
            velocities: Vec::new(),
            travel: 0.0,
        };
        skin.measure_normals();
        skin.find_folds();
        Ok(skin)
    }

    pub(crate) fn surface(&self) -> &Surface {
        &self.surface
    }

    /// How far any part of the skin can have come since the start, m.
    pub(crate) fn travel(&self) -> f32 {
        self.travel
    }

    /// Moves all vertices to `positions`.
    pub(crate) fn move_to(&mut self, positions: &[Point3]) -> Result<(), KnnError> {
        let pairs = self.surface.positions().iter().zip(positions);
        let farthest = pairs
            .map(|(a, b)| (b - a).norm_squared())
            .fold(0.0, f32::max);
        if farthest > 0.0 || positions.len() != self.surface.positions().len() {
            (self.burial).stay_behind(&self.surface, &self.vertex_normals);
            self.surface.refit(positions)?;
            self.travel += farthest.sqrt();
            self.measure_normals();
        }
        Ok(())
    }

    /// Lets all vertices move towards `targets`, to be there after some seconds.
    pub(crate) fn head_for(&mut self, targets: &[Point3], seconds: f32) {
        self.velocities.clear();
        let pairs = self.surface.positions().iter().zip(targets);
        self.velocities
            .extend(pairs.map(|(from, to)| (to - from) / seconds));
    }

    /// Lets all vertices stand still.
    pub(crate) fn stand(&mut self) {
        self.velocities.clear();
    }

    /// Whether a face may be touched by cloth that the parts of a bit mask may touch. Faces that
    /// are turned over touch nothing.
    #[inline]
    pub(crate) fn is_allowed(&self, face: u32, mask: u32) -> bool {
        if self.is_turned[face as usize] {
            return false;
        }
        match &self.parts {
            Some(parts) => mask >> parts[face as usize] & 1 == 1,
            None => true,
        }
    }

    /// Whether a face is inside another part of the body, so that nothing can lie on it.
    #[inline]
    pub(crate) fn is_buried(&self, face: u32) -> bool {
        let corners = self.surface.faces()[face as usize];
        let buried = corners.map(|vertex| {
            self.burial
                .is_buried(vertex, &self.surface, &self.vertex_normals)
        });
        buried.into_iter().filter(|&is_buried| is_buried).count() >= 2
    }

    /// Finds the faces that are turned over in folds, and the vertices that are inside another part
    /// of the body. Open skins have no inside.
    pub(crate) fn find_folds(&mut self) {
        let mut smooth = self.vertex_normals.clone();
        for _ in 0..NORMAL_SMOOTHING {
            let sum = |vertex: usize| -> Vector3 {
                let neighbors = self.adjacency.topology.neighbors(vertex).iter();
                neighbors.map(|&neighbor| smooth[neighbor as usize]).sum()
            };
            let vertices = (0..smooth.len()).into_par_iter();
            smooth = vertices
                .with_min_len(CHUNK)
                .map(|vertex| unit(smooth[vertex] + sum(vertex)))
                .collect();
        }
        let faces = self.surface.faces().iter().zip(&self.face_normals);
        self.is_turned.clear();
        self.is_turned.extend(faces.map(|(face, normal)| {
            let around: Vector3 = face.iter().map(|&vertex| smooth[vertex as usize]).sum();
            normal.dot(&around) < 0.0
        }));
        if self.surface.is_closed() {
            self.burial = Burial::unknown(self.vertex_normals.len());
        }
    }

    /// The place on a face nearest to `point`.
    #[inline]
    pub(crate) fn foot_on(&self, face: u32, point: Point3) -> Foot {
        let corners = self.surface.faces()[face as usize];
        let relative = corners.map(|vertex| self.surface.positions()[vertex as usize] - point);
        let projection = project_origin(relative);
        let [u, v, w] = projection.barycentric;
        let towards = u * relative[0] + v * relative[1] + w * relative[2];
        Foot {
            face,
            barycentric: projection.barycentric,
            feature: projection.feature,
            point: point + towards,
            offset: -towards,
            distance_squared: towards.norm_squared(),
        }
    }

    /// The nearest place that can be reached from `start_face` by always coming nearer, over faces
    /// that are allowed.
    pub(crate) fn walk(&self, point: Point3, start_face: u32, mask: u32) -> Foot {
        let mut best = self.foot_on(start_face, point);
        for _ in 0..MAX_STEPS {
            let from = best;
            match from.feature {
                Feature::Face => break,
                Feature::Edge(side) => {
                    let face = self.adjacency.across[from.face as usize][usize::from(side)];
                    self.step(point, face, mask, &mut best);
                }
                Feature::Vertex(corner) => {
                    let corners = self.surface.faces()[from.face as usize];
                    let vertex = corners[usize::from(corner)] as usize;
                    for &face in self.adjacency.topology.vertex_faces(vertex) {
                        self.step(point, face, mask, &mut best);
                    }
                }
            }
            if best.face == from.face {
                break;
            }
        }
        best
    }

    #[inline]
    fn step(&self, point: Point3, face: u32, mask: u32, best: &mut Foot) {
        if face != best.face && self.is_allowed(face, mask) {
            let foot = self.foot_on(face, point);
            if foot.distance_squared < best.distance_squared {
                *best = foot;
            }
        }
    }

    /// The unit normal of a face; zero if it has no area.
    #[inline]
    pub(crate) fn face_normal(&self, face: u32) -> Vector3 {
        self.face_normals[face as usize]
    }

    /// The pseudonormal where a place lies: on its face, edge or vertex. Not of unit length.
    pub(crate) fn pseudonormal(&self, foot: &Foot) -> Vector3 {
        let face = foot.face as usize;
        match foot.feature {
            Feature::Face => self.face_normals[face],
            Feature::Edge(side) => {
                let other = self.adjacency.across[face][usize::from(side)];
                self.face_normals[face] + self.face_normals[other as usize]
            }
            Feature::Vertex(corner) => {
                let vertex = self.surface.faces()[face][usize::from(corner)];
                self.vertex_normals[vertex as usize]
            }
        }
    }

    /// The normals of the corners interpolated at a place. Not of unit length.
    pub(crate) fn smooth_normal(&self, foot: &Foot) -> Vector3 {
        self.interpolated(foot, &self.vertex_normals)
    }

    pub(crate) fn is_moving(&self) -> bool {
        !self.velocities.is_empty()
    }

    /// How fast the skin moves at a place, m/s.
    pub(crate) fn velocity(&self, foot: &Foot) -> Vector3 {
        if self.velocities.is_empty() {
            return Vector3::zeros();
        }
        self.interpolated(foot, &self.velocities)
    }

    fn interpolated(&self, foot: &Foot, values: &[Vector3]) -> Vector3 {
        let [a, b, c] = self.surface.faces()[foot.face as usize];
        let [u, v, w] = foot.barycentric;
        u * values[a as usize] + v * values[b as usize] + w * values[c as usize]
    }

    fn measure_normals(&mut self) {
        let positions = self.surface.positions();
        let faces = self.surface.faces();
        let measured = faces.par_iter().with_min_len(CHUNK).map(|face| {
            let corners = face.map(|vertex| positions[vertex as usize]);
            let sides = [0, 1, 2].map(|k| unit(corners[(k + 1) % 3] - corners[k]));
            // The chord of the angle stands for the angle: it grows with it, up to half a turn.
            let chords = [0, 1, 2].map(|corner| (sides[corner] + sides[(corner + 2) % 3]).norm());
            (unit(sides[0].cross(&-sides[2])), chords)
        });
        let measured: Vec<(Vector3, [f32; 3])> = measured.collect();
        let topology = &self.adjacency.topology;
        let of_vertex = |vertex: usize| {
            let mut sum = Vector3::zeros();
            for &face in topology.vertex_faces(vertex) {
                let (normal, chords) = measured[face as usize];
                let corners = faces[face as usize].into_iter().zip(chords);
                for (_, chord) in corners.filter(|&(corner, _)| corner as usize == vertex) {
                    sum += normal * chord;
                }
            }
            unit(sum)
        };
        let vertices = (0..positions.len()).into_par_iter().with_min_len(CHUNK);
        vertices
            .map(of_vertex)
            .collect_into_vec(&mut self.vertex_normals);
        self.face_normals.clear();
        self.face_normals
            .extend(measured.into_iter().map(|(normal, _)| normal));
    }
}

impl Burial {
    fn unknown(num_vertices: usize) -> Self {
        let mut answers = Vec::new();
        answers.resize_with(num_vertices, || AtomicU8::new(UNKNOWN));
        Self {
            answers,
            before: None,
        }
    }

    /// Keeps the skin as it is, which is about to move.
    fn stay_behind(&mut self, surface: &Surface, normals: &[Vector3]) {
        if !self.answers.is_empty() && self.before.is_none() {
            self.before = Some((surface.clone(), normals.to_vec()));
        }
    }

    /// `surface` and `normals` are those of now.
    fn is_buried(&self, vertex: u32, surface: &Surface, normals: &[Vector3]) -> bool {
        let vertex = vertex as usize;
        let Some(answer) = self.answers.get(vertex) else {
            return false;
        };
        // Whoever finds it out finds the same.
        match answer.load(Ordering::Relaxed) {
            UNKNOWN => {
                let now = (surface, normals);
                let before = self.before.as_ref();
                let (surface, normals) =
                    before.map_or(now, |(surface, normals)| (surface, normals));
                let probe = surface.positions()[vertex] + BURIED_PROBE * normals[vertex];
                let is_buried = surface.contains(probe);
                answer.store(is_buried.into(), Ordering::Relaxed);
                is_buried
            }
            known => known != 0,
        }
    }
}

/// The direction of a vector; zero for zero.
#[inline]
pub(crate) fn unit(vector: Vector3) -> Vector3 {
    let squared = vector.norm_squared();
    if squared > 0.0 {
        vector / squared.sqrt()
    } else {
        Vector3::zeros()
    }
}
