//! Which body points the network sees, and how they are thinned.

use std::sync::Arc;

use garnet_kernel::NeighborTable;
use garnet_knn::VertexTree;
use garnet_mesh::Point3;

use crate::{GarNetConfig, NetError, PoolingConfig};

/// The used points of a body, those kept for local pooling, and the points averaged into each.
///
/// Made once of the rest body, it serves every pose and shape of the same topology. The paper
/// keeps one point in ten and averages the features of sixteen neighbors into it (section 3.5);
/// it does not say which points: ours are spread evenly, each the farthest from those before.
#[derive(Debug, Clone)]
pub struct BodySampling {
    used: Vec<u32>,
    kept: Vec<u32>,
    averaged: Arc<NeighborTable>,
    num_points: usize,
}

impl BodySampling {
    /// The points that a network looks at: those near the template, spread evenly.
    ///
    /// Hands, feet and head never touch a T-shirt, and body points are nearer to each other than
    /// the features of a body (`body.reach` and `body.points` of the configuration).
    ///
    /// # Errors
    ///
    /// As [`BodySampling::new`]; [`NetError::Missing`] also if no point is near the template.
    pub fn for_garment(
        rest_body: &[Point3],
        template: &[Point3],
        config: &GarNetConfig,
    ) -> Result<Self, NetError> {
        let mut used: Vec<u32> = (0..rest_body.len() as u32).collect();
        let reach = config.body.reach;
        if reach > 0.0 {
            let nearest = VertexTree::new(template)?.k_nearest_all(rest_body, 1);
            used.retain(|&point| {
                let near = nearest.row(point as usize).first();
                near.is_some_and(|&vertex| {
                    (rest_body[point as usize] - template[vertex as usize]).norm() <= reach
                })
            });
        }
        if (1..used.len()).contains(&config.body.points) {
            let points: Vec<Point3> = used
                .iter()
                .map(|&point| rest_body[point as usize])
                .collect();
            let mut chosen = farthest_points(&points, config.body.points);
            chosen.sort_unstable();
            used = chosen.iter().map(|&number| used[number as usize]).collect();
        }
        Self::new(rest_body, Some(&used), &config.pooling)
    }

    /// Of all points of a body, or of those numbered in `used`: a crop, a thinning.
    ///
    /// # Errors
    ///
    /// [`NetError::Missing`] without points, [`NetError::BodyPoint`] for a number beyond the body,
    /// [`NetError::Knn`] for a coordinate that is not finite.
    pub fn new(
        rest_body: &[Point3],
        used: Option<&[u32]>,
        pooling: &PoolingConfig,
    ) -> Result<Self, NetError> {
        let num_points = rest_body.len();
        let used: Vec<u32> = match used {
            Some(used) => used.to_vec(),
            None => (0..num_points as u32).collect(),
        };
        if let Some(&index) = used.iter().find(|&&index| index as usize >= num_points) {
            return Err(NetError::BodyPoint { index, num_points });
        }
        if used.is_empty() {
            return Err(NetError::Missing {
                what: "body points are",
                needed_by: "the network looks at",
            });
        }
        let points: Vec<Point3> = (used.iter())
            .map(|&index| rest_body[index as usize])
            .collect();
        let tree = VertexTree::new(&points)?;
        let kept = farthest_points(&points, points.len().div_ceil(pooling.downscale.max(1)));
        let centers: Vec<Point3> = kept.iter().map(|&index| points[index as usize]).collect();
        let neighbors = tree.k_nearest_all(&centers, pooling.averaged);
        let num_neighbors = neighbors.num_neighbors();
        let averaged = NeighborTable::new(points.len(), num_neighbors, neighbors.into_indices())?;
        Ok(Self {
            used,
            kept,
            averaged: Arc::new(averaged),
            num_points,
        })
    }

    /// Numbers of the used points among the points of the body.
    pub fn used(&self) -> &[u32] {
        &self.used
    }

    /// Numbers of the kept points among the used ones.
    pub fn kept(&self) -> &[u32] {
        &self.kept
    }

    /// For each kept point the used ones whose features are averaged.
    pub(crate) fn averaged(&self) -> &Arc<NeighborTable> {
        &self.averaged
    }

    /// Points of the body it was made for.
    pub fn num_points(&self) -> usize {
        self.num_points
    }
}

/// `count` points, each the farthest from all before; the first is the farthest from the middle.
fn farthest_points(points: &[Point3], count: usize) -> Vec<u32> {
    let wide = |index: usize| points[index].coords.cast::<f64>();
    let sum: nalgebra::Vector3<f64> = (0..points.len()).map(wide).sum();
    let middle = sum / points.len() as f64;
    let mut distance: Vec<f64> = (0..points.len())
        .map(|index| (wide(index) - middle).norm_squared())
        .collect();
    let mut chosen = Vec::with_capacity(count);
    while chosen.len() < count {
        let mut farthest = 0;
        for index in 1..points.len() {
            if distance[index] > distance[farthest] {
                farthest = index;
            }
        }
        if chosen.is_empty() {
            distance.fill(f64::INFINITY);
        }
        chosen.push(farthest as u32);
        let place = wide(farthest);
        for (index, distance) in distance.iter_mut().enumerate() {
            *distance = distance.min((wide(index) - place).norm_squared());
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use garnet_mesh::primitives::icosphere;

    const POOLING: PoolingConfig = PoolingConfig {
        neighbors: 15,
        averaged: 16,
        downscale: 10,
    };

    #[test]
    fn kept_points_are_spread() {
        let sphere = icosphere(3, 1.0);
        let sampling = BodySampling::new(sphere.positions(), None, &POOLING).unwrap();
        assert_eq!(sampling.kept().len(), 65);
        assert_eq!(sampling.averaged().num_rows(), 65);
        for (row, &kept) in sampling.kept().iter().enumerate() {
            assert_eq!(sampling.averaged().neighbors(row)[0], kept);
            for &other in &sampling.kept()[..row] {
                let points = [kept, other].map(|index| sphere.positions()[index as usize]);
                assert!((points[0] - points[1]).norm() > 0.2);
            }
        }
    }

    #[test]
    fn a_garment_sees_the_body_near_it_evenly() {
        let sphere = icosphere(4, 1.0);
        let cap: Vec<Point3> = (sphere.positions().iter())
            .filter(|point| point.y > 0.9)
            .copied()
            .collect();
        let mut config = GarNetConfig::preset("tiny").unwrap();
        (config.body.reach, config.body.points) = (0.3, 0);
        let near = BodySampling::for_garment(sphere.positions(), &cap, &config).unwrap();
        let height = |index: &u32| sphere.positions()[*index as usize].y;
        let lowest = near.used().iter().map(height).fold(1.0, f32::min);
        assert!((0.6..0.9).contains(&lowest), "{lowest}");
        config.body.points = 100;
        let few = BodySampling::for_garment(sphere.positions(), &cap, &config).unwrap();
        assert_eq!(few.used().len(), 100);
        assert!(
            few.used().is_sorted() && few.used().iter().all(|index| near.used().contains(index))
        );
        config.body.reach = 1e-3;
        let far = [Point3::new(0.0, 9.0, 0.0)];
        assert!(BodySampling::for_garment(sphere.positions(), &far, &config).is_err());
    }

    #[test]
    fn a_body_of_few_points_has_short_rows() {
        let body = [0.0, 1.0, 2.0].map(|x| Point3::new(x, 0.0, 0.0));
        let sampling = BodySampling::new(&body, Some(&[2, 0]), &POOLING).unwrap();
        assert_eq!(sampling.kept().len(), 1);
        assert_eq!(sampling.averaged().neighbors_per_row(), 2);
    }

    #[test]
    fn wrong_numbers_are_errors() {
        let body = [Point3::origin()];
        assert!(matches!(
            BodySampling::new(&body, Some(&[1]), &POOLING),
            Err(NetError::BodyPoint { index: 1, .. })
        ));
        assert!(BodySampling::new(&body, Some(&[]), &POOLING).is_err());
    }
}
