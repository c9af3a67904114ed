//! Whether two triangles intersect, decided without rounding.
//!
//! Triangles are closed sets, so touching is intersecting. Two of them intersect if and only if an
//! edge of one meets the other, which needs nothing but signs of determinants (as in Guigue and
//! Devillers 2003); those are exact (Shewchuk 1997).

use std::array;

use robust::{Coord, Coord3D, orient2d, orient3d};

/// More than the roundings of a sum of three products of differences, relative to its terms.
const ROUNDING: f32 = 1e-6;
/// More than what underflow can lose.
pub(crate) const UNDERFLOW: f32 = 1e-36;

pub(crate) type Corner = [f32; 3];
pub(crate) type Triangle = [Corner; 3];

/// Whether two triangles have a point in common; either may have no area.
pub(crate) fn triangles_intersect(a: &Triangle, b: &Triangle) -> bool {
    let sides_of_a = b.map(|corner| side(a, &corner));
    if all_on_one_side(&sides_of_a) {
        return false;
    }
    let sides_of_b = a.map(|corner| side(b, &corner));
    if all_on_one_side(&sides_of_b) {
        return false;
    }
    let edges = [[0, 1], [1, 2], [2, 0]];
    let is_flat = |sides: &[f64; 3]| sides.iter().all(|&side| side == 0.0);
    let (a_has_area, b_has_area) = (
        !is_flat(&sides_of_a) || has_area(a),
        !is_flat(&sides_of_b) || has_area(b),
    );
    if !a_has_area && !b_has_area {
        return edges.iter().any(|&[i, j]| {
            let mut others = edges.iter();
            others.any(|&[k, l]| segments_intersect([&a[i], &a[j]], [&b[k], &b[l]]))
        });
    }
    let b_meets_a = || {
        let hits =
            |&[i, j]: &[usize; 2]| segment_meets([&b[i], &b[j]], [sides_of_a[i], sides_of_a[j]], a);
        edges.iter().any(hits)
    };
    let a_meets_b = || {
        let hits =
            |&[i, j]: &[usize; 2]| segment_meets([&a[i], &a[j]], [sides_of_b[i], sides_of_b[j]], b);
        edges.iter().any(hits)
    };
    (a_has_area && b_meets_a()) || (b_has_area && a_meets_b())
}

/// Whether two triangles of one mesh intersect apart from what they share.
///
/// Corners at the same place are shared. With one shared corner, the opposite edge of one must meet
/// the other; with two, they must be coplanar and folded onto each other; with three, they always
/// intersect. Triangles without area count as never intersecting: their edges are those of their
/// neighbors.
pub(crate) fn neighbors_intersect(a: &Triangle, b: &Triangle) -> bool {
    let mut shared = [(0, 0); 3];
    let mut num_shared = 0;
    for (i, corner) in a.iter().enumerate() {
        if let Some(j) = b.iter().position(|other| is_same_place(corner, other)) {
            shared[num_shared] = (i, j);
            num_shared += 1;
        }
    }
    let intersect = match shared[..num_shared] {
        [] => triangles_intersect(a, b),
        [(i, j)] => fans_intersect(a, i, b, j),
        // Two corners of `a` at one place: it has no area.
        [(_, k), (_, l)] if k == l => false,
        [(i, k), (j, l)] => {
            let apexes = [&a[3 - i - j], &b[(3 - k).abs_diff(l)]];
            is_folded(&a[i], &a[j], apexes)
        }
        _ => true,
    };
    intersect && has_area(a) && has_area(b)
}

#[expect(clippy::float_cmp, reason = "equal coordinates are one place")]
fn is_same_place(a: &Corner, b: &Corner) -> bool {
    a == b
}

/// Whether triangles that share corner `i` of `a` and corner `j` of `b` meet beyond it.
fn fans_intersect(a: &Triangle, i: usize, b: &Triangle, j: usize) -> bool {
    let opposite_a = [&a[(i + 1) % 3], &a[(i + 2) % 3]];
    let opposite_b = [&b[(j + 1) % 3], &b[(j + 2) % 3]];
    if fans_are_apart(&a[i], opposite_a, opposite_b) {
        return false;
    }
    let sides_of_b = opposite_a.map(|end| side(b, end));
    if all_on_one_side(&sides_of_b) {
        return false;
    }
    let sides_of_a = opposite_b.map(|end| side(a, end));
    if all_on_one_side(&sides_of_a) {
        return false;
    }
    segment_meets(opposite_a, sides_of_b, b) || segment_meets(opposite_b, sides_of_a, a)
}

/// A fast look at two triangles that share a corner: whether a plane through it lies between them
/// for certain, as it does where they are on different sides of a fan.
fn fans_are_apart(shared: &Corner, a: [&Corner; 2], b: [&Corner; 2]) -> bool {
    let offset = |end: &Corner| -> Corner { array::from_fn(|axis| end[axis] - shared[axis]) };
    let (a, b) = (a.map(offset), b.map(offset));
    let across: Corner =
        array::from_fn(|axis| (a[0][axis] + a[1][axis]) - (b[0][axis] + b[1][axis]));
    // What `across` is does not matter, so that only the products round.
    let height = |offset: &Corner, sign: f32| {
        let terms: Corner = array::from_fn(|axis| offset[axis] * across[axis]);
        let size = terms[0].abs() + terms[1].abs() + terms[2].abs();
        sign * (terms[0] + terms[1] + terms[2]) > size * ROUNDING + UNDERFLOW
    };
    a.iter().all(|end| height(end, 1.0)) && b.iter().all(|end| height(end, -1.0))
}

/// Whether the triangles on an edge lie in one plane and on the same side of the edge.
fn is_folded(start: &Corner, end: &Corner, apexes: [&Corner; 2]) -> bool {
    side(&[*start, *end, *apexes[0]], apexes[1]) == 0.0
        && (0..3).any(|axis| {
            let [first, second] = apexes.map(|apex| turn(axis, start, end, apex));
            (first > 0.0 && second > 0.0) || (first < 0.0 && second < 0.0)
        })
}

/// Whether a triangle has an area, exactly.
fn has_area(triangle: &Triangle) -> bool {
    let [a, b, c] = triangle;
    (0..3).any(|axis| turn(axis, a, b, c) != 0.0)
}

/// On which side of the plane of a triangle a point lies; 0 on it.
fn side(triangle: &Triangle, point: &Corner) -> f64 {
    let [a, b, c] = triangle;
    signed_volume(a, b, c, point)
}

fn signed_volume(a: &Corner, b: &Corner, c: &Corner, d: &Corner) -> f64 {
    let [a, b, c, d] = [a, b, c, d].map(|&[x, y, z]| Coord3D { x, y, z });
    orient3d(a, b, c, d)
}

/// Which way three points turn, seen along an axis.
fn turn(axis: usize, a: &Corner, b: &Corner, c: &Corner) -> f64 {
    let flat = |point: &Corner| Coord {
        x: point[(axis + 1) % 3],
        y: point[(axis + 2) % 3],
    };
    orient2d(flat(a), flat(b), flat(c))
}

fn all_on_one_side(sides: &[f64]) -> bool {
    sides.iter().all(|&side| side > 0.0) || sides.iter().all(|&side| side < 0.0)
}

/// Whether a segment, whose ends lie on the given sides of a triangle, meets it. False for a
/// triangle without area.
fn segment_meets(ends: [&Corner; 2], sides: [f64; 2], triangle: &Triangle) -> bool {
    let [p, q] = ends;
    if all_on_one_side(&sides) {
        return false;
    }
    if sides == [0.0, 0.0] {
        return has_area(triangle) && coplanar_segment_meets(ends, triangle);
    }
    let [a, b, c] = triangle;
    let turns = [(a, b), (b, c), (c, a)].map(|(start, end)| signed_volume(p, q, start, end));
    !(turns.iter().any(|&turn| turn > 0.0) && turns.iter().any(|&turn| turn < 0.0))
}

/// Whether a segment in the plane of a triangle meets it. At least one of the views along the axes
/// shows the plane without folding it, so they meet if and only if they do in all three.
fn coplanar_segment_meets(ends: [&Corner; 2], triangle: &Triangle) -> bool {
    let [a, b, c] = triangle;
    (0..3).all(|axis| {
        let sides = [(a, b), (b, c), (c, a)];
        let crosses =
            |&(start, end): &(&Corner, &Corner)| segments_meet_in_view(axis, ends, [start, end]);
        sides.iter().any(crosses) || {
            let turns = sides.map(|(start, end)| turn(axis, start, end, ends[0]));
            turns.iter().all(|&turn| turn > 0.0) || turns.iter().all(|&turn| turn < 0.0)
        }
    })
}

/// Whether two segments in space have a point in common; either may be a point.
fn segments_intersect(first: [&Corner; 2], second: [&Corner; 2]) -> bool {
    signed_volume(first[0], first[1], second[0], second[1]) == 0.0
        && (0..3).all(|axis| segments_meet_in_view(axis, first, second))
}

/// Whether two segments have a point in common, seen along an axis.
fn segments_meet_in_view(axis: usize, [a, b]: [&Corner; 2], [c, d]: [&Corner; 2]) -> bool {
    let of_second = [turn(axis, a, b, c), turn(axis, a, b, d)];
    let of_first = [turn(axis, c, d, a), turn(axis, c, d, b)];
    if of_second == [0.0, 0.0] && of_first == [0.0, 0.0] {
        // On one line: their extents must overlap.
        return [(axis + 1) % 3, (axis + 2) % 3]
            .iter()
            .all(|&u| a[u].min(b[u]) <= c[u].max(d[u]) && c[u].min(d[u]) <= a[u].max(b[u]));
    }
    let opposed = |[x, y]: [f64; 2]| (x <= 0.0 && y >= 0.0) || (x >= 0.0 && y <= 0.0);
    opposed(of_second) && opposed(of_first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FLAT: Triangle = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    /// The reference: by separating axes in whole numbers, where nothing rounds. Convex sets with
    /// corners on a lattice are apart if and only if a normal, a cross product of two edges, or an
    /// in-plane edge normal separates them; segments and points need products with the axes too.
    fn intersect_by_axes(a: [[i64; 3]; 3], b: [[i64; 3]; 3]) -> bool {
        let sub = |p: [i64; 3], q: [i64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        let cross = |p: [i64; 3], q: [i64; 3]| {
            [
                p[1] * q[2] - p[2] * q[1],
                p[2] * q[0] - p[0] * q[2],
                p[0] * q[1] - p[1] * q[0],
            ]
        };
        let dot = |p: [i64; 3], q: [i64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
        let mut directions = vec![[1, 0, 0], [0, 1, 0], [0, 0, 1]];
        for t in [a, b] {
            let edges = [sub(t[1], t[0]), sub(t[2], t[1]), sub(t[0], t[2])];
            directions.extend(edges);
            directions.push(cross(edges[0], edges[1]));
        }
        for p in a {
            directions.extend(b.map(|q| sub(p, q)));
        }
        let num_single = directions.len();
        for i in 0..num_single {
            for j in 0..i {
                let product = cross(directions[i], directions[j]);
                directions.push(product);
            }
        }
        !directions.iter().any(|&direction| {
            let [a, b] = [a, b].map(|t| t.map(|corner| dot(direction, corner)));
            a.iter().max() < b.iter().min() || b.iter().max() < a.iter().min()
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]
        #[test]
        fn lattice_triangles_intersect_as_separating_axes_say(
            a in prop::array::uniform3(prop::array::uniform3(-2_i8..3)),
            b in prop::array::uniform3(prop::array::uniform3(-2_i8..3)),
        ) {
            let float = |t: [[i8; 3]; 3]| t.map(|corner| corner.map(f32::from));
            let whole = |t: [[i8; 3]; 3]| t.map(|corner| corner.map(i64::from));
            let expected = intersect_by_axes(whole(a), whole(b));
            prop_assert_eq!(triangles_intersect(&float(a), &float(b)), expected);
            prop_assert_eq!(triangles_intersect(&float(b), &float(a)), expected);
        }
    }

    #[test]
    fn touching_is_intersecting_and_a_hair_apart_is_not() {
        let above = |z: f32| [[1.0, 1.0, z], [1.0, 2.0, 5.0], [2.0, 1.0, 5.0]];
        assert!(triangles_intersect(&FLAT, &above(0.0)));
        assert!(!triangles_intersect(&FLAT, &above(f32::MIN_POSITIVE)));
        assert!(triangles_intersect(&FLAT, &above(-f32::MIN_POSITIVE)));
    }

    #[test]
    fn coplanar_triangles_intersect_where_they_overlap() {
        let inside = [[1.0, 1.0, 0.0], [1.5, 1.0, 0.0], [1.0, 1.5, 0.0]];
        let beside = [[3.0, 3.0, 0.0], [4.0, 3.0, 0.0], [3.0, 4.0, 0.0]];
        let touching = [[2.0, 2.0, 0.0], [4.0, 3.0, 0.0], [3.0, 4.0, 0.0]];
        assert!(triangles_intersect(&FLAT, &inside));
        assert!(triangles_intersect(&inside, &FLAT));
        assert!(!triangles_intersect(&FLAT, &beside));
        assert!(triangles_intersect(&FLAT, &touching));
    }

    #[test]
    fn neighbors_on_an_edge_intersect_only_when_folded() {
        let with_apex = |apex: Corner| [FLAT[1], FLAT[0], apex];
        assert!(!neighbors_intersect(&FLAT, &with_apex([1.0, -3.0, 0.0])));
        assert!(!neighbors_intersect(&FLAT, &with_apex([1.0, 3.0, 1e-6])));
        assert!(neighbors_intersect(&FLAT, &with_apex([1.0, 3.0, 0.0])));
        assert!(neighbors_intersect(&FLAT, &with_apex(FLAT[2])));
        let flat = [FLAT[0], FLAT[1], [2.0, 0.0, 0.0]];
        assert!(!neighbors_intersect(&FLAT, &flat));
    }

    #[test]
    fn triangles_with_corners_at_one_place_never_intersect() {
        for shared in FLAT {
            for place in 0..3 {
                let mut needle = [shared; 3];
                needle[place] = [1.0, 2.0, 3.0];
                assert!(!neighbors_intersect(&needle, &FLAT));
                assert!(!neighbors_intersect(&FLAT, &needle));
            }
            assert!(!neighbors_intersect(&[shared; 3], &FLAT));
            assert!(!neighbors_intersect(&FLAT, &[shared; 3]));
        }
    }

    #[test]
    fn neighbors_at_a_vertex_intersect_only_beyond_it() {
        let apart = [FLAT[0], [-1.0, -1.0, 0.0], [-1.0, 0.0, 0.0]];
        let through = [FLAT[0], [1.0, 1.0, 1.0], [1.0, 1.0, -1.0]];
        let overlapping = [FLAT[0], [1.0, 1.0, 0.0], [9.0, 1.0, 0.0]];
        assert!(!neighbors_intersect(&FLAT, &apart));
        assert!(neighbors_intersect(&FLAT, &through));
        assert!(neighbors_intersect(&FLAT, &overlapping));
    }
}
