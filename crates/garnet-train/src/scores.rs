//! What is measured of drapes (definitions: docs/reference/metrics.md).

use garnet_knn::Surface;
use garnet_mesh::{Point3, StretchSummary, TriMesh, normal_angles, vertex_distances};
use garnet_net::losses::{LossReport, Term};
use serde::{Deserialize, Serialize};

use crate::TrainError;

/// How near drapes are to those of the teacher, and how sound they are: over all scenes of a split.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Scores {
    /// Scenes.
    pub scenes: usize,
    /// `E_dist`, the mean distance of vertices, in metres (*Gundogdu et al. 2020, Eq. 17*).
    pub distance: f64,
    /// Its standard deviation over vertices.
    pub distance_std: f64,
    /// `E_norm`, the mean angle of face normals, in radians (*Eq. 18*).
    pub normal: f64,
    /// Its standard deviation over faces.
    pub normal_std: f64,
    /// L_MC, the mean over scenes of Eq. 14.
    pub mean_curvature: f64,
    /// L_UMC, the mean over scenes of Eq. 19.
    pub uniform_curvature: f64,
    /// L_RQ, the mean over scenes of Eq. 13, summed over 8, 16 and 32 neighbors.
    pub rayleigh: f64,
    /// L_RQ of 8, 16 and 32 neighbors.
    pub rayleigh_of: [f64; 3],
    /// Share of vertices with a winding number above 0.5, that is inside the body.
    pub inside: f64,
    /// The deepest of them, in metres below the nearest skin.
    pub deepest: f64,
    /// Intersecting pairs of the garment's triangles, the mean over scenes.
    pub self_intersections: f64,
    /// Length over rest length that 1 % of the edges exceed, the mean over scenes.
    pub stretch_p99: f64,
    /// The largest length over rest length.
    pub stretch_max: f64,
}

/// A drape beside that of the teacher.
#[derive(Debug)]
pub(crate) struct Compared<'a> {
    pub(crate) predicted: &'a [Point3],
    pub(crate) draped: &'a [Point3],
    pub(crate) faces: &'a [[u32; 3]],
    /// Length over rest length of the edges.
    pub(crate) stretches: Vec<f32>,
    pub(crate) skin: &'a Surface,
    pub(crate) losses: &'a LossReport,
}

/// The distances and angles of one drape.
#[derive(Debug)]
pub(crate) struct Errors {
    /// `[vertex]`, in metres.
    pub(crate) distances: Vec<f32>,
    /// `[face]`, in radians.
    pub(crate) angles: Vec<f32>,
}

/// Sums over scenes, of which [`Scores`] are the means.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Tally {
    scenes: usize,
    distances: Sums,
    angles: Sums,
    terms: [f64; 5],
    vertices: usize,
    inside: usize,
    deepest: f64,
    self_intersections: usize,
    stretch_p99: f64,
    stretch_max: f64,
}

/// Sums of values and of their squares.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Sums {
    count: usize,
    sum: f64,
    squares: f64,
}

impl Sums {
    pub(crate) fn add(&mut self, values: &[f32]) {
        self.count += values.len();
        for &value in values {
            self.sum += f64::from(value);
            self.squares += f64::from(value).powi(2);
        }
    }

    /// The mean, if there are values.
    pub(crate) fn mean(self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }

    fn merge(&mut self, other: Self) {
        self.count += other.count;
        self.sum += other.sum;
        self.squares += other.squares;
    }

    fn mean_and_std(self) -> [f64; 2] {
        let count = self.count.max(1) as f64;
        let mean = self.sum / count;
        [mean, (self.squares / count - mean * mean).max(0.0).sqrt()]
    }
}

/// The terms of the losses that are scores.
const TERMS: [Term; 5] = [
    Term::MeanCurvature,
    Term::UniformCurvature,
    Term::Rayleigh8,
    Term::Rayleigh16,
    Term::Rayleigh32,
];

impl Tally {
    /// Counts a scene.
    pub(crate) fn add(&mut self, compared: Compared<'_>) -> Result<Errors, TrainError> {
        let Compared {
            predicted,
            draped,
            faces,
            stretches,
            skin,
            losses,
        } = compared;
        let distances = vertex_distances(draped, predicted)?;
        let angles = normal_angles(faces, draped, predicted)?;
        self.scenes += 1;
        self.distances.add(&distances);
        self.angles.add(&angles);
        for (sum, term) in self.terms.iter_mut().zip(TERMS) {
            *sum += losses.value(term).unwrap_or(0.0);
        }
        let stretch = StretchSummary::of(stretches);
        self.stretch_p99 += f64::from(stretch.p99);
        self.stretch_max = self.stretch_max.max(f64::from(stretch.max));
        let is_inside = skin.contains_all(predicted);
        let pairs = predicted.iter().zip(&is_inside);
        let inside: Vec<Point3> = pairs
            .filter(|(_, inside)| **inside)
            .map(|(p, _)| *p)
            .collect();
        self.vertices += predicted.len();
        self.inside += inside.len();
        for closest in skin.closest_all(&inside) {
            self.deepest = self.deepest.max(f64::from(closest.distance_squared.sqrt()));
        }
        let cloth = TriMesh::new(predicted.to_vec(), faces.to_vec())?;
        self.self_intersections += Surface::new(&cloth).self_intersections().len();
        Ok(Errors { distances, angles })
    }

    /// Counts the scenes of another tally, too.
    pub fn merge(&mut self, other: &Self) {
        self.scenes += other.scenes;
        self.distances.merge(other.distances);
        self.angles.merge(other.angles);
        for (sum, other) in self.terms.iter_mut().zip(other.terms) {
            *sum += other;
        }
        self.vertices += other.vertices;
        self.inside += other.inside;
        self.deepest = self.deepest.max(other.deepest);
        self.self_intersections += other.self_intersections;
        self.stretch_p99 += other.stretch_p99;
        self.stretch_max = self.stretch_max.max(other.stretch_max);
    }

    /// The means of what was added.
    pub fn scores(&self) -> Scores {
        let scenes = self.scenes.max(1) as f64;
        let [distance, distance_std] = self.distances.mean_and_std();
        let [normal, normal_std] = self.angles.mean_and_std();
        let [mean_curvature, uniform_curvature, rayleigh_of @ ..] =
            self.terms.map(|sum| sum / scenes);
        Scores {
            scenes: self.scenes,
            distance,
            distance_std,
            normal,
            normal_std,
            mean_curvature,
            uniform_curvature,
            rayleigh: rayleigh_of.iter().sum(),
            rayleigh_of,
            inside: self.inside as f64 / self.vertices.max(1) as f64,
            deepest: self.deepest,
            self_intersections: self.self_intersections as f64 / scenes,
            stretch_p99: self.stretch_p99 / scenes,
            stretch_max: self.stretch_max,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn merged_tallies_are_those_of_all_scenes() {
        let tally = |distance: f32, stretch: f64| {
            let mut tally = Tally {
                scenes: 1,
                stretch_p99: stretch,
                stretch_max: stretch,
                ..Tally::default()
            };
            tally.distances.add(&[distance]);
            tally
        };
        let mut both = tally(1.0, 1.25);
        both.merge(&tally(3.0, 1.75));
        let scores = both.scores();
        assert_eq!(scores.scenes, 2);
        assert!((scores.distance - 2.0).abs() < 1e-12);
        assert!((scores.distance_std - 1.0).abs() < 1e-12);
        assert!((scores.stretch_p99 - 1.5).abs() < 1e-12);
        assert!((scores.stretch_max - 1.75).abs() < 1e-12);
    }

    #[test]
    fn sums_give_mean_and_deviation_of_the_whole() {
        let mut sums = Sums::default();
        sums.add(&[1.0, 3.0]);
        sums.add(&[5.0]);
        let [mean, std] = sums.mean_and_std();
        assert!((mean - 3.0).abs() < 1e-12 && (std - (8.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        let of_nothing = Sums::default().mean_and_std();
        assert!(of_nothing.iter().all(|value| value.abs() < 1e-12));
    }
}
