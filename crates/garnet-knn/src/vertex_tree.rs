//! Nearest points of a fixed set of points.

use crate::error::{KnnError, check_finite};
use garnet_mesh::Point3;
use kiddo::{ImmutableKdTree, QueryResultItem, SquaredEuclidean};
use rayon::prelude::*;
use std::num::NonZero;

/// Points that one task of a batch looks up.
const POINTS_PER_TASK: usize = 256;
/// Up to this size squares of coordinates stay well inside `f32`.
const MAX_COORDINATE: f32 = 1e18;

type Tree = ImmutableKdTree<f32, 3>;

/// A point found by a [`VertexTree`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbor {
    /// Its number in the slice that the tree was made of.
    pub index: u32,
    /// Its squared distance from the query, m².
    pub distance_squared: f32,
}

/// The nearest points of many queries, `[query][neighbor]` in one list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NeighborTable {
    indices: Vec<u32>,
    num_neighbors: usize,
}

impl NeighborTable {
    /// Neighbors of each query: `k`, or the number of points if that is less.
    pub fn num_neighbors(&self) -> usize {
        self.num_neighbors
    }

    /// The neighbors of one query, nearest first; empty for a query that does not exist.
    pub fn row(&self, query: usize) -> &[u32] {
        let start = query.saturating_mul(self.num_neighbors);
        let row = start..start.saturating_add(self.num_neighbors);
        self.indices.get(row).unwrap_or_default()
    }

    /// Point numbers `[query][neighbor]`, row after row.
    pub fn indices(&self) -> &[u32] {
        &self.indices
    }

    /// Gives back the point numbers `[query][neighbor]`, row after row.
    pub fn into_indices(self) -> Vec<u32> {
        self.indices
    }
}

/// A k-d tree over points: the nearest one, the `k` nearest, all within a radius.
///
/// Points may coincide. At equal distance the smaller number comes first, and it alone decides
/// which of several points at the distance of the last neighbor are taken.
///
/// # Examples
///
/// ```
/// use garnet_knn::VertexTree;
/// use garnet_mesh::Point3;
///
/// let points = [0.0, 1.0, 3.0].map(|x| Point3::new(x, 0.0, 0.0));
/// let tree = VertexTree::new(&points)?;
/// let two = tree.k_nearest(Point3::new(2.0, 0.0, 0.0), 2);
/// assert_eq!(two.iter().map(|neighbor| neighbor.index).collect::<Vec<_>>(), [1, 2]);
/// # Ok::<(), garnet_knn::KnnError>(())
/// ```
#[derive(Debug)]
pub struct VertexTree {
    points: Vec<[f32; 3]>,
    /// Absent where squares of coordinates may overflow: then every point is looked at.
    tree: Option<Tree>,
}

impl VertexTree {
    /// Makes a tree of `points`, in metres; there may be none.
    ///
    /// # Errors
    ///
    /// [`KnnError::CoordinateOutOfRange`] or [`KnnError::TooManyPoints`].
    pub fn new(points: &[Point3]) -> Result<Self, KnnError> {
        let count = points.len();
        if count >= u32::MAX as usize {
            return Err(KnnError::TooManyPoints { count });
        }
        check_finite(points)?;
        let points: Vec<[f32; 3]> = points.iter().map(|point| point.coords.into()).collect();
        let tree = if !points.is_empty() && points.iter().all(is_moderate) {
            ImmutableKdTree::new_from_slice(&points).ok()
        } else {
            None
        };
        Ok(Self { points, tree })
    }

    /// How many points there are.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The nearest point; `None` if there are no points or `point` is not finite.
    pub fn nearest(&self, point: Point3) -> Option<Neighbor> {
        self.k_nearest(point, 1).first().copied()
    }

    /// The `k` nearest points, nearest first; all of them if there are fewer, none if `point` is
    /// not finite.
    pub fn k_nearest(&self, point: Point3, k: usize) -> Vec<Neighbor> {
        let query: [f32; 3] = point.coords.into();
        let count = k.min(self.len());
        if !query.iter().all(|value| value.is_finite()) {
            return Vec::new();
        }
        // One more than asked shows whether the last place is tied.
        let asked = NonZero::new((count + 1).min(self.len()));
        let (Some(tree), Some(asked), true) = (&self.tree, asked, is_moderate(&query)) else {
            return self.brute_force(query, count);
        };
        let nearest = tree.query(&query).nearest_n::<SquaredEuclidean<f32>>(asked);
        let mut neighbors = sorted(nearest.execute());
        if let Some([last, next]) = neighbors.get(count.saturating_sub(1)..=count)
            && last.distance_squared >= next.distance_squared
        {
            neighbors = within_squared(tree, query, last.distance_squared);
        }
        neighbors.truncate(count);
        neighbors
    }

    /// The `k` nearest points of every query, on all threads.
    ///
    /// Rows have `k` entries, or as many as there are points if that is less. The row of a query
    /// that is not finite holds the points with the smallest numbers.
    pub fn k_nearest_all(&self, queries: &[Point3], k: usize) -> NeighborTable {
        let num_neighbors = k.min(self.len());
        let rows = queries
            .par_chunks(POINTS_PER_TASK)
            .flat_map_iter(|queries| {
                let mut rows = Vec::with_capacity(queries.len() * num_neighbors);
                for &query in queries {
                    let neighbors = self.k_nearest(query, num_neighbors);
                    if neighbors.len() == num_neighbors {
                        rows.extend(neighbors.iter().map(|neighbor| neighbor.index));
                    } else {
                        rows.extend(0..num_neighbors as u32);
                    }
                }
                rows
            });
        NeighborTable {
            indices: rows.collect(),
            num_neighbors,
        }
    }

    /// All points no farther than `radius` (metres), nearest first; none if `radius` is negative
    /// or NaN or `point` is not finite.
    pub fn within(&self, point: Point3, radius: f32) -> Vec<Neighbor> {
        let query: [f32; 3] = point.coords.into();
        if !(radius >= 0.0 && query.iter().all(|value| value.is_finite())) {
            return Vec::new();
        }
        match &self.tree {
            Some(tree) if is_moderate(&query) && radius <= MAX_COORDINATE => {
                within_squared(tree, query, radius * radius)
            }
            _ => {
                let mut neighbors = self.brute_force(query, self.len());
                let reach = f64::from(radius);
                neighbors.retain(|neighbor| {
                    f64_distance_squared(query, self.points[neighbor.index as usize])
                        <= reach * reach
                });
                neighbors
            }
        }
    }

    /// Looks at every point, in double precision.
    fn brute_force(&self, query: [f32; 3], count: usize) -> Vec<Neighbor> {
        let distances = self
            .points
            .iter()
            .map(|&point| f64_distance_squared(query, point));
        let mut order: Vec<(f64, u32)> = distances.zip(0..).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let nearest = order.into_iter().take(count);
        nearest
            .map(|(distance_squared, index)| Neighbor {
                index,
                distance_squared: distance_squared as f32,
            })
            .collect()
    }
}

/// All points up to a squared distance, sorted.
fn within_squared(tree: &Tree, query: [f32; 3], distance_squared: f32) -> Vec<Neighbor> {
    let found = tree
        .query(&query)
        .within::<SquaredEuclidean<f32>>(distance_squared);
    sorted(found.unsorted().execute())
}

/// Sorts by distance, then by number.
fn sorted(found: Vec<QueryResultItem<(), u32, f32>>) -> Vec<Neighbor> {
    let neighbors = found.into_iter().map(|item| Neighbor {
        index: item.item,
        distance_squared: item.distance,
    });
    let mut neighbors: Vec<Neighbor> = neighbors.collect();
    neighbors.sort_unstable_by(|a, b| {
        (a.distance_squared.total_cmp(&b.distance_squared)).then(a.index.cmp(&b.index))
    });
    neighbors
}

fn is_moderate(point: &[f32; 3]) -> bool {
    point.iter().all(|value| value.abs() < MAX_COORDINATE)
}

fn f64_distance_squared(a: [f32; 3], b: [f32; 3]) -> f64 {
    let square = |axis: usize| (f64::from(a[axis]) - f64::from(b[axis])).powi(2);
    square(0) + square(1) + square(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn grid_points() -> Vec<Point3> {
        let axis = |i: usize| (i % 9) as f32;
        (0..729)
            .map(|i| Point3::new(axis(i), axis(i / 9), axis(i / 81)))
            .collect()
    }

    fn indices(neighbors: &[Neighbor]) -> Vec<u32> {
        neighbors.iter().map(|neighbor| neighbor.index).collect()
    }

    #[test]
    fn a_hundred_identical_points_come_in_the_order_of_their_numbers() {
        let tree = VertexTree::new(&[Point3::new(1.0, 2.0, 3.0); 100]).unwrap();
        assert_eq!(
            indices(&tree.k_nearest(Point3::origin(), 7)),
            [0, 1, 2, 3, 4, 5, 6]
        );
        assert_eq!(tree.nearest(Point3::origin()).unwrap().index, 0);
    }

    #[test]
    fn more_neighbors_than_points_gives_all_points() {
        let tree = VertexTree::new(&grid_points()[..3]).unwrap();
        assert_eq!(indices(&tree.k_nearest(Point3::origin(), 15)), [0, 1, 2]);
        let table = tree.k_nearest_all(&[Point3::origin(); 2], 15);
        assert_eq!(table.num_neighbors(), 3);
        assert_eq!(table.row(1), [0, 1, 2]);
        assert_eq!(table.row(2), [0_u32; 0]);
        assert_eq!(tree.k_nearest(Point3::origin(), 0), []);
    }

    #[test]
    fn an_empty_tree_finds_nothing() {
        let tree = VertexTree::new(&[]).unwrap();
        assert_eq!(tree.nearest(Point3::origin()), None);
        assert_eq!(tree.k_nearest(Point3::origin(), 3), []);
        assert_eq!(tree.within(Point3::origin(), 1.0), []);
        assert_eq!(
            tree.k_nearest_all(&[Point3::origin()], 3).indices(),
            [0_u32; 0]
        );
    }

    #[test]
    fn coordinates_that_are_not_numbers_are_refused() {
        let points = [Point3::origin(), Point3::new(0.0, f32::INFINITY, 0.0)];
        let error = VertexTree::new(&points).unwrap_err();
        let expected = KnnError::CoordinateOutOfRange {
            index: 1,
            value: f32::INFINITY,
        };
        assert_eq!(error, expected);
    }

    #[test]
    fn a_query_that_is_not_finite_finds_nothing() {
        let tree = VertexTree::new(&grid_points()).unwrap();
        let query = Point3::new(f32::NAN, 0.0, 0.0);
        assert_eq!(tree.nearest(query), None);
        assert_eq!(tree.within(query, 1.0), []);
        assert_eq!(tree.k_nearest_all(&[query], 2).indices(), [0, 1]);
    }

    #[test]
    fn huge_coordinates_are_ordered_in_double_precision() {
        let points = [3e38, -3e38, 1e30, 0.0].map(|x| Point3::new(x, 0.0, 0.0));
        let tree = VertexTree::new(&points).unwrap();
        assert_eq!(indices(&tree.k_nearest(Point3::origin(), 4)), [3, 2, 0, 1]);
        assert_eq!(indices(&tree.within(Point3::origin(), 2e30)), [3, 2]);
    }

    proptest! {
        #[test]
        fn neighbors_are_those_of_brute_force(
            coordinates in prop::collection::vec(-4_i8..5, 3..300),
            query in prop::array::uniform3(-5_i8..6),
            k in 0_usize..40,
        ) {
            // Small whole numbers: many ties, and distances without rounding.
            let points: Vec<Point3> = coordinates
                .chunks_exact(3)
                .map(|c| Point3::new(c[0].into(), c[1].into(), c[2].into()))
                .collect();
            let query = Point3::from(query.map(f32::from));
            let tree = VertexTree::new(&points).unwrap();
            let all = tree.brute_force(query.coords.into(), points.len());
            prop_assert_eq!(&tree.k_nearest(query, k)[..], &all[..k.min(points.len())]);
            let near: Vec<Neighbor> =
                all.into_iter().filter(|neighbor| neighbor.distance_squared <= 9.0).collect();
            prop_assert_eq!(tree.within(query, 3.0), near);
        }
    }
}
