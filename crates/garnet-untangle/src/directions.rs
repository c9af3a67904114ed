//! Directions to look in.

use garnet_mesh::Vector3;

/// The 26 directions from the middle of a cube to its faces, edges and corners.
pub(crate) fn all_round() -> impl Iterator<Item = Vector3> {
    let steps = [-1.0_f32, 0.0, 1.0];
    let grid = steps.into_iter().flat_map(move |x| {
        let plane = move |y| steps.into_iter().map(move |z| Vector3::new(x, y, z));
        steps.into_iter().flat_map(plane)
    });
    grid.filter_map(|direction| direction.try_normalize(0.5))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_direction_has_its_opposite() {
        let directions: Vec<Vector3> = all_round().collect();
        assert_eq!(directions.len(), 26);
        for direction in &directions {
            assert!(directions.contains(&-direction));
        }
    }
}
