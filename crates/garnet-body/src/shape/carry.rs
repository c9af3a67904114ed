//! Carries the template to the surface of another body.

use rayon::prelude::*;

use super::field::Field;
use super::guide::{Guide, NUM_PARTS, part_of_joint};
use super::primitives::Vec3;
use super::surface::BodySurface;
use super::template::Template;

/// Steps onto the surface along one line.
const SECANT_STEPS: usize = 4;

/// A vertex this close lies on the surface, in metres.
const CLOSE_ENOUGH: f64 = 4e-6;

/// From here one more step leads onto the surface, in metres.
const NEXT_TO: f64 = 1e-4;

/// A step goes no farther than this, in metres.
const MAX_STEP: f64 = 0.02;

/// Rounds of smoothing that take out what the projection has sheared; each group is projected
/// again.
const SMOOTHING_ROUNDS: [usize; 2] = [12, 10];

/// Rounds that spread folded vertices out, and how often each moves them to the mean of their
/// neighbors before they are projected.
const UNFOLDING_ROUNDS: usize = 16;
const RELAXING_SWEEPS: usize = 5;

/// And how often at last, without being projected.
const OFF_SURFACE_SWEEPS: usize = 12;

/// A vertex of the template has no more neighbors than this.
const MAX_VALENCE: usize = 32;

/// Vertices that are projected as one task.
const CHUNK: usize = 128;

/// What one part says of a vertex: its weight, and the coordinates there.
#[derive(Debug, Clone, Copy)]
struct Hold {
    part: usize,
    weight: f64,
    coordinates: [f64; 3],
}

/// The line on which a vertex is moved onto the surface: its direction, and the change of distance
/// along it.
#[derive(Debug, Clone, Copy)]
struct Slope {
    direction: Vec3,
    rise: f64,
}

impl Slope {
    const NONE: Self = Self {
        direction: Vec3::new(0.0, 0.0, 0.0),
        rise: 1.0,
    };
}

/// The left half on the surface of a body.
///
/// It can follow a change of the body: every vertex goes with the guide and then along its line.
#[derive(Debug, Clone)]
pub(crate) struct Carried {
    pub(crate) positions: Vec<Vec3>,
    guessed: Vec<Vec3>,
    slopes: Vec<Slope>,
}

/// The template, ready to be carried.
#[derive(Debug, Clone)]
pub(crate) struct Carrier {
    holds: Vec<Vec<Hold>>,
    num_middle: usize,
    starts: Vec<u32>,
    neighbors: Vec<u32>,
    /// Weights of the neighbors that make each vertex their mean at rest, as nearly as positive
    /// weights can.
    weights: Vec<f64>,
}

impl Carrier {
    pub(crate) fn new(template: &Template, rest: &BodySurface) -> Self {
        let holds = template
            .half
            .iter()
            .zip(&template.half_influences)
            .map(|(position, influences)| {
                let mut weights = [0.0; NUM_PARTS];
                for &(joint, weight) in influences {
                    weights[part_of_joint(joint)] += f64::from(weight);
                }
                let parts = weights
                    .into_iter()
                    .enumerate()
                    .filter(|&(_, weight)| weight > 0.0);
                parts
                    .map(|(part, weight)| Hold {
                        part,
                        weight,
                        coordinates: rest.guide.coordinates(part, &Vec3::from(*position)),
                    })
                    .collect()
            })
            .collect();
        let (starts, neighbors) = neighbors(template);
        let weights = mean_weights(template, &starts, &neighbors);
        Self {
            holds,
            num_middle: template.num_middle,
            starts,
            neighbors,
            weights,
        }
    }

    /// Where the guide of another body takes the left half.
    fn guessed(&self, guide: &Guide) -> Vec<Vec3> {
        let place = |holds: &Vec<Hold>| {
            let parts = holds.iter();
            parts
                .map(|hold| hold.weight * guide.point(hold.part, hold.coordinates))
                .sum()
        };
        let mut positions: Vec<Vec3> = self
            .holds
            .par_iter()
            .with_min_len(CHUNK)
            .map(place)
            .collect();
        for position in &mut positions[..self.num_middle] {
            position.x = 0.0;
        }
        positions
    }

    /// The left half on the surface of another body, as the guide takes it there: uneven, but near
    /// enough for the first rounds of fitting.
    pub(crate) fn start(&self, body: &BodySurface) -> Carried {
        let guessed = self.guessed(&body.guide);
        let mut carried = Carried {
            positions: guessed.clone(),
            slopes: vec![Slope::NONE; guessed.len()],
            guessed,
        };
        self.project(&body.field, &mut carried);
        carried
    }

    /// Moves a half that lies on one body to a body that differs a little.
    pub(crate) fn follow(&self, carried: &mut Carried, body: &BodySurface) {
        let guessed = self.guessed(&body.guide);
        let moved = carried.positions.par_iter_mut().zip(&carried.slopes);
        moved
            .zip(guessed.par_iter().zip(&carried.guessed))
            .enumerate()
            .with_min_len(CHUNK)
            .for_each(|(vertex, ((position, slope), (new, old)))| {
                *position += new - old;
                let start = *position;
                if !descend(&body.field, position, slope) {
                    *position = start;
                    let is_middle = vertex < self.num_middle;
                    project_one(&body.field, position, is_middle);
                }
            });
        carried.guessed = guessed;
    }

    /// Evens out what was sheared on the way, along the surface.
    pub(crate) fn even_out(&self, carried: &mut Carried, body: &BodySurface) {
        for rounds in SMOOTHING_ROUNDS {
            for _ in 0..rounds {
                let normals = self.normals(&carried.positions);
                self.smooth(&mut carried.positions, &normals);
            }
            self.project(&body.field, carried);
        }
    }

    /// Spreads folded vertices, in rising order, out between the others: on the surface, or at last
    /// off it too.
    pub(crate) fn unfold(
        &self,
        carried: &mut Carried,
        body: &BodySurface,
        folded: &[usize],
        off_surface: bool,
    ) {
        for _ in 0..UNFOLDING_ROUNDS {
            for _ in 0..RELAXING_SWEEPS {
                self.relax(&mut carried.positions, folded);
            }
            let moved: Vec<(Vec3, Slope)> = folded
                .par_iter()
                .with_min_len(CHUNK / 4)
                .map(|&vertex| {
                    let mut position = carried.positions[vertex];
                    let slope = project_one(&body.field, &mut position, vertex < self.num_middle);
                    (position, slope)
                })
                .collect();
            for (&vertex, (position, slope)) in folded.iter().zip(moved) {
                carried.positions[vertex] = position;
                carried.slopes[vertex] = slope;
            }
        }
        if off_surface {
            self.lift_off(carried, folded);
        }
    }

    /// Spreads folded vertices out between the others without keeping them on the surface.
    pub(crate) fn lift_off(&self, carried: &mut Carried, folded: &[usize]) {
        for _ in 0..OFF_SURFACE_SWEEPS {
            self.relax(&mut carried.positions, folded);
        }
    }

    /// Moves every vertex onto the surface, wherever it is.
    fn project(&self, field: &Field, carried: &mut Carried) {
        let moved = carried.positions.par_iter_mut().zip(&mut carried.slopes);
        moved
            .enumerate()
            .with_min_len(CHUNK)
            .for_each(|(vertex, (position, slope))| {
                *slope = project_one(field, position, vertex < self.num_middle);
            });
    }

    /// Vertices of the half within `rings` edges of the faces of these vertices of the whole.
    pub(crate) fn surroundings(&self, vertices: &[u32], rings: usize) -> Vec<usize> {
        let num_half = self.holds.len();
        let of_half = |vertex: u32| {
            let vertex = vertex as usize;
            if vertex < num_half {
                vertex
            } else {
                vertex - num_half + self.num_middle
            }
        };
        let mut is_near = vec![false; num_half];
        for &vertex in vertices {
            is_near[of_half(vertex)] = true;
        }
        for _ in 0..rings {
            let inner: Vec<usize> = (0..num_half).filter(|&vertex| is_near[vertex]).collect();
            for vertex in inner {
                let range = self.starts[vertex] as usize..self.starts[vertex + 1] as usize;
                for &neighbor in &self.neighbors[range] {
                    is_near[of_half(neighbor)] = true;
                }
            }
        }
        (0..num_half).filter(|&vertex| is_near[vertex]).collect()
    }

    /// Moves some vertices to the mean of their neighbors, off the surface too.
    fn relax(&self, positions: &mut [Vec3], relaxed: &[usize]) {
        for &vertex in relaxed {
            let range = self.starts[vertex] as usize..self.starts[vertex + 1] as usize;
            let share = 1.0 / range.len() as f64;
            let neighbors = range.map(|entry| self.neighbor(positions, entry));
            let mut mean = share * neighbors.sum::<Vec3>();
            if vertex < self.num_middle {
                mean.x = 0.0;
            }
            positions[vertex] = mean;
        }
    }

    /// Unit normals of the left half.
    fn normals(&self, positions: &[Vec3]) -> Vec<Vec3> {
        let normal = |vertex: usize| {
            let here = positions[vertex];
            let range = self.starts[vertex] as usize..self.starts[vertex + 1] as usize;
            let corners = range.map(|entry| self.neighbor(positions, entry) - here);
            let mut sum = Vec3::zeros();
            let mut previous = None;
            let mut first = None;
            for corner in corners {
                if let Some(before) = previous {
                    let before: Vec3 = before;
                    sum += before.cross(&corner);
                } else {
                    first = Some(corner);
                }
                previous = Some(corner);
            }
            if let (Some(last), Some(first)) = (previous, first) {
                sum += last.cross(&first);
            }
            if vertex < self.num_middle {
                sum.x = 0.0;
            }
            sum.normalize()
        };
        (0..positions.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(normal)
            .collect()
    }

    /// Moves every vertex along the surface towards the mean of its neighbors, weighted as at rest.
    fn smooth(&self, positions: &mut [Vec3], normals: &[Vec3]) {
        let moved: Vec<Vec3> = (0..positions.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|vertex| {
                let range = self.starts[vertex] as usize..self.starts[vertex + 1] as usize;
                let mut mean = Vec3::zeros();
                for entry in range {
                    mean += self.weights[entry] * self.neighbor(positions, entry);
                }
                let here = positions[vertex];
                let up = normals[vertex];
                let step = mean - here;
                let mut along = here + 0.8 * (step - up * up.dot(&step));
                if vertex < self.num_middle {
                    along.x = 0.0;
                }
                along
            })
            .collect();
        positions.copy_from_slice(&moved);
    }

    /// A neighbor's position; numbers beyond the half are mirror images.
    fn neighbor(&self, positions: &[Vec3], entry: usize) -> Vec3 {
        let vertex = self.neighbors[entry] as usize;
        if let Some(&position) = positions.get(vertex) {
            return position;
        }
        let mirrored = positions[vertex - positions.len() + self.num_middle];
        Vec3::new(-mirrored.x, mirrored.y, mirrored.z)
    }
}

/// Moves a position onto the surface; in the middle plane it stays there.
fn project_one(field: &Field, position: &mut Vec3, is_middle: bool) -> Slope {
    let (distance, mut gradient) = field.distance_and_gradient(position);
    if is_middle {
        gradient.x = 0.0;
    }
    let rise = gradient.norm().max(0.3);
    let slope = Slope {
        direction: gradient / rise,
        rise,
    };
    *position += (-distance / rise).clamp(-MAX_STEP, MAX_STEP) * slope.direction;
    descend(field, position, &slope);
    slope
}

/// Moves a point along a line onto the surface, by secants; tells whether it got there or next to.
fn descend(field: &Field, position: &mut Vec3, slope: &Slope) -> bool {
    let Slope {
        direction,
        mut rise,
    } = *slope;
    let mut before: Option<(f64, f64)> = None;
    for _ in 0..SECANT_STEPS {
        let distance = field.distance(position);
        if distance.abs() < CLOSE_ENOUGH {
            return true;
        }
        if let Some((step, old)) = before {
            let measured = (distance - old) / step;
            if (0.2..3.0).contains(&measured) {
                rise = measured;
            }
        }
        let step = (-distance / rise).clamp(-MAX_STEP, MAX_STEP);
        *position += step * direction;
        before = Some((step, distance));
    }
    before.is_some_and(|(_, distance)| distance.abs() < NEXT_TO)
}

/// Neighbors of the vertices of the left half, in order around each, in numbers of the whole.
fn neighbors(template: &Template) -> (Vec<u32>, Vec<u32>) {
    let num_half = template.half.len();
    let mut next = std::collections::HashMap::new();
    let mut some = vec![0; template.num_vertices()];
    for &[a, b, c] in &template.faces {
        for [here, from, to] in [[a, b, c], [b, c, a], [c, a, b]] {
            next.insert([here, from], to);
            some[here as usize] = from;
        }
    }
    let mut starts = vec![0];
    let mut neighbors = Vec::new();
    for vertex in 0..num_half as u32 {
        let start = some[vertex as usize];
        let mut neighbor = start;
        for _ in 0..MAX_VALENCE {
            neighbors.push(neighbor);
            neighbor = next[&[vertex, neighbor]];
            if neighbor == start {
                break;
            }
        }
        starts.push(neighbors.len() as u32);
    }
    (starts, neighbors)
}

/// Mean-value weights (Floater 2003) of the neighbors of each vertex at rest, in its tangent plane.
fn mean_weights(template: &Template, starts: &[u32], neighbors: &[u32]) -> Vec<f64> {
    let whole = template.whole(&template.half, |&[x, y, z]| [-x, y, z]);
    let at = |vertex: u32| Vec3::from(whole[vertex as usize]);
    let mut opposite = std::collections::HashMap::new();
    for &[a, b, c] in &template.faces {
        for [from, to, across] in [[a, b, c], [b, c, a], [c, a, b]] {
            opposite.insert([from, to], across);
        }
    }
    let mut weights = Vec::with_capacity(neighbors.len());
    for vertex in 0..template.half.len() as u32 {
        let range = starts[vertex as usize] as usize..starts[vertex as usize + 1] as usize;
        let first = weights.len();
        for &neighbor in &neighbors[range] {
            let here = at(vertex);
            let edge = at(neighbor) - here;
            let half_tangent = |across: Option<&u32>| {
                across.map_or(0.0, |&across| {
                    (0.5 * (at(across) - here).angle(&edge)).tan()
                })
            };
            let sides = [
                opposite.get(&[vertex, neighbor]),
                opposite.get(&[neighbor, vertex]),
            ];
            let tangents: f64 = sides.into_iter().map(half_tangent).sum();
            weights.push(tangents / edge.norm().max(1e-9));
        }
        let sum: f64 = weights[first..].iter().sum();
        for weight in &mut weights[first..] {
            *weight /= sum;
        }
    }
    weights
}
