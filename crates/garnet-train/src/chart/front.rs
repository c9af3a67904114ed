//! Which methods are worth their cost.

/// The numbers of the points that no other point beats in both values, by the first value.
///
/// A point is beaten by one that is nowhere greater and somewhere less; of equal ones the first
/// stays. Points that are not finite are left out.
///
/// ```
/// let front = garnet_train::chart::pareto_front(&[[1.0, 9.0], [2.0, 9.5], [3.0, 1.0]]);
/// assert_eq!(front, [0, 2]);
/// ```
pub fn pareto_front(points: &[[f64; 2]]) -> Vec<usize> {
    let is_finite = |point: &[f64; 2]| point.iter().all(|value| value.is_finite());
    let mut order: Vec<usize> = (0..points.len())
        .filter(|&number| is_finite(&points[number]))
        .collect();
    order.sort_by(|&a, &b| {
        let [a, b] = [points[a], points[b]];
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
    });
    let mut least = f64::INFINITY;
    order.retain(|&number| {
        let is_better = points[number][1] < least;
        least = least.min(points[number][1]);
        is_better
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beaten_points_are_left_out() {
        let points = [
            [5.0, 1.0],
            [1.0, 5.0],
            [3.0, 3.0],
            [3.0, 4.0],
            [4.0, 3.0],
            [3.0, 3.0],
            [f64::NAN, 0.0],
        ];
        assert_eq!(pareto_front(&points), [1, 2, 0]);
        assert!(pareto_front(&[]).is_empty());
    }

    #[test]
    fn a_point_better_in_both_stands_alone() {
        assert_eq!(pareto_front(&[[2.0, 2.0], [1.0, 1.0], [1.0, 3.0]]), [1]);
    }
}
