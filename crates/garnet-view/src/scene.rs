//! The layers of a view, as its camera sees them.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::{
    BackSide, FaceMaterials, Rgb, Shading,
    clip::{Piece, project},
    lens::Lens,
    prepared::{Coat, Prepared},
    rgb::Light,
};

/// How much of the light of a color its darker back side gives back.
const BACK_SHARE: f32 = 0.42;

/// Half the width of a line of a wireframe, pixels.
const WIRE_HALF_WIDTH: f64 = 0.45;

/// How much of the color of a wireframe covers the surface.
const WIRE_COVER: f32 = 0.75;

/// Layers in the coordinates of a view.
#[derive(Debug)]
pub(crate) struct Scene<'a> {
    pub(crate) lens: Lens,
    parts: Vec<Part<'a>>,
}

#[derive(Debug)]
struct Part<'a> {
    prepared: &'a Prepared<'a>,
    /// Points of the view `[vertex]`.
    positions: Vec<Vector3<f64>>,
    /// The number of the first triangle among those of all parts.
    first_triangle: u32,
}

/// Triangles among which the nearest alone is seen.
#[derive(Debug)]
pub(crate) struct Group {
    pub(crate) opacity: f32,
    pub(crate) pieces: Vec<Piece>,
}

/// What is seen at one place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surface {
    /// Unit normal on the side that is seen, in the coordinates of the view.
    pub(crate) normal: Vector3<f32>,
    /// Unit vector, likewise.
    pub(crate) to_viewer: Vector3<f32>,
    pub(crate) color: Light,
    /// Whether the color stands for a value and must stay readable.
    pub(crate) is_heat: bool,
}

impl<'a> Scene<'a> {
    /// Moves the layers named by `shown` before the lens.
    pub(crate) fn new(lens: Lens, layers: &'a [Prepared<'a>], shown: &[usize]) -> Self {
        let mut first_triangle = 0;
        let mut parts = Vec::with_capacity(shown.len());
        for (index, prepared) in layers.iter().enumerate() {
            if !shown.contains(&index) || prepared.opacity <= 0.0 {
                continue;
            }
            let mesh = prepared.layer.mesh;
            parts.push(Part {
                prepared,
                positions: mesh
                    .positions()
                    .par_iter()
                    .map(|point| lens.view(point))
                    .collect(),
                first_triangle,
            });
            first_triangle += mesh.num_faces() as u32;
        }
        Self { lens, parts }
    }

    /// All opaque layers as the first group, then each of the others as one.
    pub(crate) fn groups(&self) -> Vec<Group> {
        let mut groups = vec![Group {
            opacity: 1.0,
            pieces: Vec::new(),
        }];
        for part in &self.parts {
            let opacity = part.prepared.opacity;
            if opacity < 1.0 {
                let pieces = Vec::new();
                groups.push(Group { opacity, pieces });
            }
            let group = if opacity < 1.0 { groups.len() - 1 } else { 0 };
            self.append_pieces(part, &mut groups[group].pieces);
        }
        groups
    }

    fn append_pieces(&self, part: &Part<'_>, pieces: &mut Vec<Piece>) {
        let is_hidden = part.prepared.layer.back == BackSide::Hidden;
        for (face, triangle) in (0..part.prepared.layer.mesh.num_faces()).zip(part.first_triangle..)
        {
            project(&self.lens, &part.corners(face), triangle, |piece| {
                if !(is_hidden && piece.is_clockwise()) {
                    pieces.push(piece);
                }
            });
        }
    }

    fn find(&self, triangle: u32) -> (&Part<'a>, usize) {
        let after = self
            .parts
            .partition_point(|part| part.first_triangle <= triangle);
        let part = &self.parts[after - 1];
        (part, (triangle - part.first_triangle) as usize)
    }

    /// The unit normal of a triangle where it is seen at a pixel.
    pub(crate) fn normal(&self, triangle: u32, pixel: [f64; 2]) -> Vector3<f32> {
        let (part, face) = self.find(triangle);
        let meeting = Meeting::new(&self.lens, pixel, part.corners(face));
        meeting.normal(&self.lens, part.prepared, face)
    }

    /// The surface of a triangle where it is seen at a pixel.
    pub(crate) fn surface(&self, triangle: u32, pixel: [f64; 2]) -> Surface {
        let (part, face) = self.find(triangle);
        let meeting = Meeting::new(&self.lens, pixel, part.corners(face));
        let layer = part.prepared.layer;
        let front = match &part.prepared.coat {
            Coat::Plain(light) => *light,
            Coat::Heat(scale) => {
                let values = layer.mesh.faces()[face].map(|vertex| scale.values[vertex as usize]);
                scale.light(if scale.has_kinds() {
                    meeting.nearest(values)
                } else {
                    meeting.mix(values)
                })
            }
            Coat::Materials(materials) => meeting.painted(&self.lens, materials, face),
        };
        let mut color = match layer.back {
            BackSide::Darker if !meeting.is_front => front * BACK_SHARE,
            BackSide::Plain(color) if !meeting.is_front => color.to_light(),
            _ => front,
        };
        if let Some(wire) = layer.wireframe {
            let cover = WIRE_COVER * meeting.wire_cover(&self.lens, pixel);
            color = color.lerp(&Rgb::to_light(wire), cover);
        }
        Surface {
            normal: meeting.normal(&self.lens, part.prepared, face),
            to_viewer: self.lens.to_viewer(&meeting.point).cast(),
            color,
            is_heat: matches!(part.prepared.coat, Coat::Heat(_)),
        }
    }
}

impl Part<'_> {
    fn corners(&self, face: usize) -> [Vector3<f64>; 3] {
        self.prepared.layer.mesh.faces()[face].map(|vertex| self.positions[vertex as usize])
    }
}

/// Where a line of sight meets a triangle.
struct Meeting {
    corners: [Vector3<f64>; 3],
    /// Barycentric weights of the corners, none negative.
    weights: Vector3<f64>,
    point: Vector3<f64>,
    is_front: bool,
}

impl Meeting {
    fn new(lens: &Lens, pixel: [f64; 2], corners: [Vector3<f64>; 3]) -> Self {
        let weights = lens.weights(pixel, &corners);
        let sum = weights.sum();
        let weights = (weights / sum).map(|weight| weight.max(0.0));
        let weights = weights / weights.sum();
        let weights = if weights.iter().all(|weight| weight.is_finite()) {
            weights
        } else {
            Vector3::repeat(1.0 / 3.0)
        };
        let [a, b, c] = corners;
        Self {
            corners,
            weights,
            point: a * weights.x + b * weights.y + c * weights.z,
            is_front: sum >= 0.0,
        }
    }

    /// The value here of what has these values at the corners.
    fn mix(&self, values: [f32; 3]) -> f64 {
        let [a, b, c] = values.map(f64::from);
        // A corner that does not count must not spoil the others by being infinite.
        [a, b, c]
            .iter()
            .zip(self.weights.iter())
            .filter(|&(_, &weight)| weight > 0.0)
            .map(|(value, weight)| value * weight)
            .sum()
    }

    /// The value of the nearest corner.
    fn nearest(&self, values: [f32; 3]) -> f64 {
        f64::from(values[self.weights.imax()])
    }

    /// The color of the material of a face.
    fn painted(&self, lens: &Lens, materials: &FaceMaterials, face: usize) -> Light {
        let material = &materials.materials[materials.of_face[face] as usize];
        let color = material.color.to_light();
        let Some(texture) = &material.texture else {
            return color;
        };
        let corners = materials.corners[face].map(|corner| corner.map(f64::from));
        let place = [0, 1].map(|axis| {
            let weighted = corners.iter().zip(self.weights.iter());
            weighted.map(|(corner, weight)| corner[axis] * weight).sum()
        });
        let seen = self.corners.map(|corner| lens.screen(&corner));
        let [width, height] = texture.size().map(f64::from);
        let texels = width * height * doubled_area(corners);
        let pixels = doubled_area(seen.map(|[x, y, _]| [x, y]));
        color.component_mul(&texture.light(place, texels / pixels))
    }

    fn normal(&self, lens: &Lens, prepared: &Prepared<'_>, face: usize) -> Vector3<f32> {
        let [a, b, c] = self.corners;
        let flat = (b - a)
            .cross(&(c - a))
            .try_normalize(0.0)
            .unwrap_or_else(Vector3::z);
        let smooth = match prepared.layer.shading {
            Shading::Flat => None,
            Shading::Smooth => {
                let [a, b, c] = prepared.layer.mesh.faces()[face]
                    .map(|vertex| prepared.normals[vertex as usize]);
                let weights = self.weights.cast::<f32>();
                let sum = a * weights.x + b * weights.y + c * weights.z;
                sum.try_normalize(1e-3)
                    .map(|world| lens.direction(&world).cast::<f64>())
            }
        };
        let normal = smooth.unwrap_or(flat) * if self.is_front { 1.0 } else { -1.0 };
        let to_viewer = lens.to_viewer(&self.point);
        // An interpolated normal may turn away at a silhouette; what is seen cannot.
        let away = normal.dot(&to_viewer).min(0.0);
        (normal - to_viewer * away)
            .try_normalize(1e-6)
            .unwrap_or(to_viewer)
            .cast()
    }

    /// How much of a pixel the nearest edge covers.
    fn wire_cover(&self, lens: &Lens, pixel: [f64; 2]) -> f32 {
        let is_cut = |near| self.corners.iter().any(|corner| corner.z > near);
        if lens.near().is_some_and(is_cut) {
            return 0.0;
        }
        let corners = self.corners.map(|corner| lens.screen(&corner));
        let mut nearest = f64::INFINITY;
        for corner in 0..3 {
            let ([ax, ay, _], [bx, by, _]) = (corners[corner], corners[(corner + 1) % 3]);
            let (dx, dy) = (bx - ax, by - ay);
            let area = dx * (pixel[1] - ay) - dy * (pixel[0] - ax);
            nearest = nearest.min(area.abs() / dx.hypot(dy));
        }
        (WIRE_HALF_WIDTH + 0.5 - nearest).clamp(0.0, 1.0) as f32
    }
}

/// Twice the area of a triangle.
fn doubled_area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
}
