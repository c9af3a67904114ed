//! Small meshes for the tests.

use crate::surface::Surface;
use garnet_mesh::{Point3, TriMesh};
use std::f32::consts::{PI, TAU};

pub(crate) type Shape = (Vec<Point3>, Vec<[u32; 3]>);

pub(crate) fn surface((positions, faces): Shape) -> Surface {
    Surface::new(&TriMesh::new(positions, faces).unwrap())
}

/// A closed sphere of rings and slices, with one vertex at each pole on the z axis.
pub(crate) fn sphere(center: [f32; 3], radius: f32, rings: u32, slices: u32) -> Shape {
    let point =
        |x: f32, y: f32, z: f32| Point3::from(center) + radius * nalgebra::Vector3::new(x, y, z);
    let mut positions = vec![point(0.0, 0.0, 1.0)];
    let mut faces = Vec::new();
    for ring in 1..rings {
        let (sin, cos) = (PI * ring as f32 / rings as f32).sin_cos();
        for slice in 0..slices {
            let angle = TAU * slice as f32 / slices as f32;
            positions.push(point(sin * angle.cos(), sin * angle.sin(), cos));
        }
    }
    let south = positions.len() as u32;
    positions.push(point(0.0, 0.0, -1.0));
    let at = |ring: u32, slice: u32| 1 + (ring - 1) * slices + slice % slices;
    for slice in 0..slices {
        faces.push([0, at(1, slice), at(1, slice + 1)]);
        for ring in 1..rings - 1 {
            let (a, b) = (at(ring, slice), at(ring, slice + 1));
            let (c, d) = (at(ring + 1, slice), at(ring + 1, slice + 1));
            faces.push([a, c, d]);
            faces.push([a, d, b]);
        }
        faces.push([south, at(rings - 1, slice + 1), at(rings - 1, slice)]);
    }
    (positions, faces)
}

/// A closed torus around the z axis, of radius 1 and tube radius 0.4.
pub(crate) fn torus(rings: u32, slices: u32) -> Shape {
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for ring in 0..rings {
        let (ring_sin, ring_cos) = (TAU * ring as f32 / rings as f32).sin_cos();
        for slice in 0..slices {
            let (sin, cos) = (TAU * slice as f32 / slices as f32).sin_cos();
            let from_axis = 1.0 + 0.4 * cos;
            positions.push(Point3::new(
                from_axis * ring_cos,
                from_axis * ring_sin,
                0.4 * sin,
            ));
            let at = |r: u32, s: u32| (r % rings) * slices + s % slices;
            let (a, b) = (at(ring, slice), at(ring + 1, slice));
            let (c, d) = (at(ring, slice + 1), at(ring + 1, slice + 1));
            faces.push([a, b, d]);
            faces.push([a, d, c]);
        }
    }
    (positions, faces)
}

/// A closed axis-aligned box whose sides are grids of `n` by `n` squares.
pub(crate) fn cube(min: f32, max: f32, n: u32) -> Shape {
    let mut positions: Vec<Point3> = Vec::new();
    let mut faces = Vec::new();
    let place = |i: u32| min + (max - min) * i as f32 / n as f32;
    let mut vertex = |axis: usize, [u, v, w]: [u32; 3]| {
        let mut point = Point3::origin();
        point[(axis + 1) % 3] = place(u);
        point[(axis + 2) % 3] = place(v);
        point[axis] = place(w);
        let known = positions.iter().position(|&other| other == point);
        known.unwrap_or_else(|| {
            positions.push(point);
            positions.len() - 1
        }) as u32
    };
    for axis in 0..3 {
        for (u, v) in (0..n).flat_map(|u| (0..n).map(move |v| (u, v))) {
            for side in [0, n] {
                let corners = [(u, v), (u + 1, v), (u + 1, v + 1), (u, v + 1)];
                let [a, b, c, d] = corners.map(|(u, v)| vertex(axis, [u, v, side]));
                let (b, d) = if side == 0 { (d, b) } else { (b, d) };
                faces.push([a, b, c]);
                faces.push([a, c, d]);
            }
        }
    }
    (positions, faces)
}

/// An open grid of `n` by `n` unit squares in the plane z = 0, facing +z.
pub(crate) fn grid(n: u32) -> Shape {
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for y in 0..=n {
        for x in 0..=n {
            positions.push(Point3::new(x as f32, y as f32, 0.0));
        }
    }
    for (x, y) in (0..n).flat_map(|x| (0..n).map(move |y| (x, y))) {
        let corner = y * (n + 1) + x;
        faces.push([corner, corner + 1, corner + n + 2]);
        faces.push([corner, corner + n + 2, corner + n + 1]);
    }
    (positions, faces)
}

/// Two shapes as one mesh.
pub(crate) fn both((mut positions, mut faces): Shape, (more, more_faces): Shape) -> Shape {
    let start = positions.len() as u32;
    positions.extend(more);
    faces.extend(
        more_faces
            .iter()
            .map(|face| face.map(|vertex| vertex + start)),
    );
    (positions, faces)
}

/// Triangles without shared corners, from corner positions.
pub(crate) fn soup(corners: &[[f32; 3]]) -> Shape {
    let num_faces = corners.len() as u32 / 3;
    let faces = (0..num_faces).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]);
    (
        corners.iter().map(|&corner| corner.into()).collect(),
        faces.collect(),
    )
}
