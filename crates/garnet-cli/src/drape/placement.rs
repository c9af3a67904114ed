//! Whether a garment lies on its rest body, and what looks wrong if it does not.

use std::path::Path;

use garnet::{Bounds, Point3, TriMesh, Unit, UpAxis};

use super::frame::{Frame, name};
use crate::failure::refused;

/// Largest extent of a garment over that of the body: a sock to a dress with a train.
const SIZES: [f32; 2] = [0.08, 2.0];

/// Distance between the two boxes, over the size of the body's.
const MAX_GAP: f32 = 0.15;

/// Refuses a garment that is of another size than the body or away from it.
///
/// `garment` is in the unit of its file, which is taken for `frame`; the body is in metres. A small
/// thing on the body, such as a ring, is accepted.
pub(crate) fn check(
    paths: [&Path; 2],
    garment: &TriMesh,
    frame: Frame,
    body: (&TriMesh, Unit),
) -> anyhow::Result<()> {
    let (body, body_unit) = body;
    let Some(body_box) = used_bounds(body, Frame::OURS) else {
        return Ok(());
    };
    let with = |unit, up| used_bounds(garment, Frame { unit, up });
    let sits = |bounds: Option<Bounds>| {
        bounds.is_some_and(|found| has_size(&found, &body_box) && is_near(&found, &body_box))
    };
    let taken = with(frame.unit, frame.up);
    let Some(found) = taken.filter(|_| !sits(taken)) else {
        return Ok(());
    };
    let has_size = has_size(&found, &body_box);
    let [garment_path, body_path] = paths.map(Path::display);
    let error = format!("`{garment_path}` does not lie on the rest body `{body_path}`");
    let better = Unit::ALL
        .into_iter()
        .find(|&unit| !has_size && sits(with(unit, frame.up)));
    if let Some(unit) = better {
        let (garment_name, body_name) = (name(unit), name(body_unit));
        return Err(refused(
            error,
            format!("the garment looks like {garment_name}, the body like {body_name}"),
            format!(
                "if so, `--units {unit},{body_unit}` reads the garment in {garment_name} and the \
                 bodies in {body_name}"
            ),
        ));
    }
    let other_up = match frame.up {
        UpAxis::Y => UpAxis::Z,
        UpAxis::Z => UpAxis::Y,
    };
    if sits(with(frame.unit, other_up)) {
        return Err(refused(
            error,
            format!(
                "the garment looks as if {other_up} were up, the body as if {} were",
                frame.up
            ),
            "export both with the same axis up; `--up` overrides what was detected for both",
        ));
    }
    let (size, body_size) = (found.extent().max(), body_box.extent().max());
    if size < body_size && is_near(&found, &body_box) {
        return Ok(());
    }
    let cause = if has_size {
        let gap = found.gap(&body_box);
        format!(
            "they are {gap:.2} m apart, if both are in {}",
            name(body_unit)
        )
    } else {
        let smaller = if size < body_size { "body" } else { "garment" };
        format!(
            "the garment is {size:.3} m in size and the body {body_size:.3} m: the {smaller} may \
             be in centimetres"
        )
    };
    Err(refused(
        error,
        cause,
        "`garnet info` shows the boxes of both; `--units GARMENT,BODY` and `--up` override what \
         was detected",
    ))
}

/// Bounds of the vertices that faces name, in metres.
fn used_bounds(mesh: &TriMesh, frame: Frame) -> Option<Bounds> {
    let used = Bounds::of_faces(mesh.positions(), mesh.faces())?;
    Bounds::of(&[used.min, used.max].map(|corner: Point3| frame.point_to_metres(&corner)))
}

fn has_size(garment: &Bounds, body: &Bounds) -> bool {
    let ratio = garment.extent().max() / body.extent().max().max(f32::MIN_POSITIVE);
    (SIZES[0]..=SIZES[1]).contains(&ratio)
}

fn is_near(garment: &Bounds, body: &Bounds) -> bool {
    garment.gap(body) <= MAX_GAP * body.diagonal()
}

#[cfg(test)]
mod tests {
    use garnet::primitives::{capsule, tube};

    use super::*;

    fn scaled(mesh: &TriMesh, factor: f32) -> TriMesh {
        let positions = mesh.positions().iter().map(|point| point * factor);
        mesh.with_positions(positions.collect()).unwrap()
    }

    fn checked(garment: &TriMesh) -> anyhow::Result<()> {
        let body = capsule(0.15, 1.4, 16, 8);
        let paths = ["skirt.obj", "body.obj"].map(Path::new);
        check(paths, garment, Frame::OURS, (&body, Unit::Metre))
    }

    #[test]
    fn a_garment_on_its_body_is_accepted() {
        assert!(checked(&tube(0.2, 0.6, 16, 8)).is_ok());
    }

    #[test]
    fn a_small_thing_on_the_body_is_accepted() {
        assert!(checked(&tube(0.01, 0.01, 16, 2)).is_ok());
    }

    #[test]
    fn the_unit_that_fits_is_named() {
        let garment = scaled(&tube(0.2, 0.6, 16, 8), 100.0);
        let error = checked(&garment).unwrap_err();
        let cause = format!("{:#}", error.root_cause());
        assert_eq!(
            cause,
            "the garment looks like centimetres, the body like metres"
        );
    }

    #[test]
    fn a_garment_elsewhere_is_told_how_far() {
        let garment = tube(0.2, 0.6, 16, 8);
        let away = garment
            .positions()
            .iter()
            .map(|p| p + garnet::Vector3::x() * 3.0);
        let garment = garment.with_positions(away.collect()).unwrap();
        let cause = format!("{:#}", checked(&garment).unwrap_err().root_cause());
        assert_eq!(cause, "they are 2.65 m apart, if both are in metres");
    }
}
