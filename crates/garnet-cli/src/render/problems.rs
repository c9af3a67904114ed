//! What is wrong with a drape, vertex by vertex.

use anyhow::Context;
use garnet::{
    Point3, TriMesh,
    knn::{Surface, Traps},
    skin::scale_of,
    untangle::free_crossing_faces,
};
use garnet_view::Problem;

/// The problem of each vertex of a garment on a skin, both in metres, as
/// [`ColorMap::Problems`](garnet_view::ColorMap::Problems) shows it; of several the worst. Lengths
/// go by the thickness of the limbs below, as those of drapes do.
pub(crate) fn problems(
    positions: &[Point3],
    faces: &[[u32; 3]],
    skin: &Surface,
) -> anyhow::Result<Vec<f32>> {
    let mesh = TriMesh::new(positions.to_vec(), faces.to_vec())?;
    let cloth = Surface::new(&mesh);
    let mut found = vec![Problem::None; positions.len()];
    let mut mark = |vertex: u32, problem: Problem| {
        let found = &mut found[vertex as usize];
        *found = problem.max(*found);
    };
    for face in cloth.self_intersections().into_flattened() {
        for vertex in faces[face as usize] {
            mark(vertex, Problem::ThroughCloth);
        }
    }
    let is_inside = skin.contains_all(positions);
    let closest = skin.closest_all(positions);
    let traps = Traps::near(skin, positions, scale_of(skin, &closest));
    let traps = traps.context("cannot look for trapped cloth")?;
    for (vertex, (closest, is_inside)) in (0..).zip(closest.iter().zip(is_inside)) {
        if traps.holds(closest) {
            mark(vertex, Problem::Trapped);
        } else if is_inside {
            mark(vertex, Problem::ThroughSkin);
        }
    }
    for face in free_crossing_faces(&cloth, skin) {
        for vertex in faces[face as usize] {
            mark(vertex, Problem::ThroughSkin);
        }
    }
    Ok(found.into_iter().map(Problem::value).collect())
}

#[cfg(test)]
mod tests {
    use garnet::mesh::primitives::{icosphere, tube};

    use super::*;

    /// How many vertices have each problem.
    fn counts(cloth: &TriMesh, skin: &TriMesh) -> [usize; 4] {
        let found = problems(cloth.positions(), cloth.faces(), &Surface::new(skin)).unwrap();
        let count = |problem: Problem| {
            let value = problem.value().to_bits();
            found
                .iter()
                .filter(|found| found.to_bits() == value)
                .count()
        };
        Problem::ALL.map(count)
    }

    #[test]
    fn a_belt_is_sound_around_a_ball_and_wrong_within() {
        let ball = icosphere(4, 0.2);
        let around = tube(0.21, 0.02, 32, 2);
        assert_eq!(counts(&around, &ball), [around.num_vertices(), 0, 0, 0]);
        let within = tube(0.19, 0.02, 32, 2);
        assert_eq!(counts(&within, &ball), [0, 0, 0, within.num_vertices()]);
    }

    #[test]
    fn faces_that_cross_the_skin_are_marked_though_their_corners_are_outside() {
        let ball = icosphere(4, 0.2);
        // The corners of a square round the ball are outside, its sides run through it.
        let square = tube(0.25, 0.02, 4, 1);
        assert_eq!(counts(&square, &ball), [0, 0, 0, square.num_vertices()]);
    }

    #[test]
    fn a_doll_traps_about_where_a_person_does() {
        let trapped = |scale: f32| {
            let ball = icosphere(4, 0.2 * scale);
            let (mut places, mut faces) = ball.clone().into_parts();
            let count = places.len() as u32;
            let beside = ball.positions().iter();
            places.extend(beside.map(|p| Point3::new(p.x + 0.3 * scale, p.y, p.z)));
            faces.extend(ball.faces().iter().map(|face| face.map(|v| v + count)));
            let belt = tube(0.205 * scale, 0.01 * scale, 200, 1);
            counts(&belt, &TriMesh::new(places, faces).unwrap())[2]
        };
        let [person, doll] = [1.0, 0.05].map(trapped);
        assert!(person > 40, "{person}");
        assert!(doll < person + person / 2, "{doll} of {person}");
    }

    #[test]
    fn cloth_through_cloth_is_marked() {
        let ball = icosphere(3, 0.05);
        let [a, b] = [tube(0.2, 0.3, 24, 6), tube(0.2, 0.3, 24, 6)];
        let moved = b
            .positions()
            .iter()
            .map(|p| Point3::new(p.x + 0.3, p.y, p.z));
        let positions: Vec<Point3> = a.positions().iter().copied().chain(moved).collect();
        let count = a.num_vertices() as u32;
        let others = b
            .faces()
            .iter()
            .map(|face| face.map(|vertex| vertex + count));
        let faces = a.faces().iter().copied().chain(others).collect();
        let found = counts(&TriMesh::new(positions, faces).unwrap(), &ball);
        assert!(found[1] > 10 && found[0] > 10, "{found:?}");
        assert_eq!(found[2..], [0, 0]);
    }
}
