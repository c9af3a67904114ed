//! Garments worn over each other on one body: the inner first, the outer over body and inner.
//!
//! The outer garment is draped on the body with the inner one on: where that covers the skin, the
//! skin is moved out to it ([`dressed`]). The result is a body of the same topology in another
//! shape, which all ways to drape know how to deal with. Cloth has finer folds than a body has
//! vertices; so the layers are brought in order at last ([`part_layers`]), and what is left is
//! counted ([`LayerCount`]). [`Outfit`] takes these steps in their order.

mod dressing;
mod layers;
mod sheet;

use garnet_knn::VertexTree;
use garnet_mesh::{Point3, Vector3};
use garnet_skin::{Body, PosedBody};
use rayon::prelude::*;

use crate::{BoundGarment, Error};
pub use dressing::{LayerPair, Outfit};
pub use layers::LayerCount;
use layers::{LayerOptions, count_layers, part_layers};
use sheet::Sheet;

/// Cloth that stands farther off than this does not lie on the skin in front of which it is, in
/// metres: it hangs, and gives way. Larger ones make a body of what hangs between the legs.
const LYING: f32 = 0.05;

/// The body is made thicker by this at most, in metres: cloth that stands farther off is loose, and
/// gives way to what is worn over it. Larger ones stretch the outer garment, smaller ones leave
/// thick cloth in it. Tried: 12 to 50 mm.
const THICKEST: f32 = 0.012;

/// Cloth lies on skin if it faces the same way: the cosine between their normals is at least this.
/// Lower ones take the sleeve beside a trunk for what lies on it.
const SAME_WAY: f32 = 0.3;

/// Skin is dressed if it is this near to the skin that the outer garment lies on at rest, in
/// metres. Larger ones dress skin that the outer garment never reaches, to no use.
const NEAR_OUTER: f32 = 0.08;

/// How often the thickness of the inner cloth is evened out between neighbouring vertices of the
/// body, upwards only. More make a thicker, smoother body.
const EVENINGS: usize = 2;

/// A garment as it is worn: bound, and where its vertices are.
#[derive(Debug, Clone)]
struct WornGarment<'a> {
    /// The garment.
    pub garment: &'a BoundGarment,
    /// Positions `[vertex]` of its mesh, in metres.
    pub positions: Vec<Point3>,
}

/// The body as the outer garment meets it: its skin moved out to the inner garments where these
/// cover it.
///
/// `posed` is of the body that `outer` is bound to.
///
/// # Errors
///
/// [`Error::Skin`] if `posed` is not of `body`; [`Error::Knn`] or [`Error::Mesh`] for garments that
/// are out of any range.
fn dressed(
    posed: &PosedBody,
    inner: &[WornGarment<'_>],
    outer: &BoundGarment,
) -> Result<PosedBody, Error> {
    let body = outer.body();
    let sheets = inner.iter().map(Sheet::new);
    let sheets = sheets.collect::<Result<Vec<_>, _>>()?;
    let normals = posed.vertex_normals();
    let skin = posed.skin().positions();
    let is_near = near_outer(body, outer)?;
    let thickness = |vertex: usize| {
        if !is_near[vertex] {
            return 0.0;
        }
        let of_sheet = |sheet: &Sheet<'_>| farthest(sheet, skin[vertex], normals[vertex]);
        sheets.iter().map(of_sheet).fold(0.0, f32::max)
    };
    let vertices = 0..body.rest().num_vertices();
    let mut thickness: Vec<f32> = vertices.into_par_iter().map(thickness).collect();
    for _ in 0..EVENINGS {
        thickness = evened(body, &thickness);
    }
    let places = skin.iter().zip(&normals).zip(&thickness);
    let places = places.map(|((place, normal), &thickness)| place + thickness * normal);
    let transforms = posed.posed_from_rest().to_vec();
    Ok(body.fitted_by(&places.collect::<Vec<_>>(), transforms)?)
}

/// How thick the cloth on the skin makes the body: as far as cloth lies out that faces the same
/// way, up to [`THICKEST`]; 0 if there is none.
fn farthest(sheet: &Sheet<'_>, place: Point3, normal: Vector3) -> f32 {
    let passages = sheet.surface.passages(place, normal, LYING).into_iter();
    let lying = passages.filter(|found| {
        let outward = sheet.sign * sheet.surface.face_normal(found.face);
        outward.dot(&normal) > SAME_WAY
    });
    lying
        .map(|found| found.length)
        .fold(0.0, f32::max)
        .min(THICKEST)
}

/// Whether each vertex of the body is near the skin that a garment lies on at rest `[vertex]`.
fn near_outer(body: &Body, outer: &BoundGarment) -> Result<Vec<bool>, Error> {
    let below = outer.cloth().skin().iter().map(|skin| skin.point);
    let tree = VertexTree::new(&below.collect::<Vec<_>>())?;
    let is_near = |place: &Point3| {
        let nearest = tree.nearest(*place);
        nearest.is_some_and(|found| found.distance_squared < NEAR_OUTER * NEAR_OUTER)
    };
    Ok(body.rest().positions().par_iter().map(is_near).collect())
}

/// Each value, or the mean of it and the largest of its neighbours, if that is more.
fn evened(body: &Body, values: &[f32]) -> Vec<f32> {
    let mut largest = values.to_vec();
    for face in body.rest().faces() {
        let most = face.map(|vertex| values[vertex as usize]);
        let most = most.into_iter().fold(0.0, f32::max);
        for &vertex in face {
            let value = &mut largest[vertex as usize];
            *value = value.max(most);
        }
    }
    let pairs = values.iter().zip(largest);
    pairs
        .map(|(&value, largest)| value.max(0.5 * (value + largest)))
        .collect()
}
