//! Whether a garment lies on its rest body, and what looks wrong if it does not.
//!
//! There is one set of limits, all of them relative to the body: [`check_sizes`] needs the boxes
//! alone and tells units and axes that were mistaken; [`check_offsets`] takes the skin nearest to
//! each vertex of the cloth, once that is known.

use garnet_mesh::{Bounds, Point3, Topology, TriMesh, Unit, UpAxis, Vector3};

use crate::Frame;

/// Largest extents of garments, over that of the body, which are taken for what they are: a sock to
/// a dress with a train. Raise the second one for larger things.
const USUAL_SIZES: [f32; 2] = [0.08, 2.0];

/// Smaller things are in another unit, over the extent of the body: a ring is a little larger.
const LEAST_SIZE: f32 = 0.01;

/// Largest distance of the garment's nearest part to the body, over the diagonal of the body's box.
/// Raise it for garments that nowhere come near the skin.
const MAX_GAP: f32 = 0.15;

/// Half of the cloth may lie as far as this to one side of the skin, over the diagonal of the
/// body's box. Clothes go around the body, and their offsets cancel; a cape has less than half of
/// this, and a shirt beside the body more. Raise it for things that are carried on one side; from
/// 0.06 on, a tunic is accepted that lies 0.7 m too high.
const MAX_OFFSET: f32 = 0.05;

/// A garment is attached through its uppermost part, of this share of its height: cloth below it
/// may hang as far to one side as it likes, as capes do. A lower one may be a collar alone, a
/// higher one has what hangs in it.
const ATTACHED_SHARE: f32 = 1.0 / 3.0;

/// What is nearer to the skin than this touches it, over the diagonal of the body's box.
const TOUCH: f32 = 0.025;

/// A garment of which this share touches the body lies on it, whatever hangs off to one side: a
/// dress with a train.
const TOUCHING_SHARE: f32 = 0.1;

/// Cloth that is deeper than this in the body goes through it, over the diagonal of the body's box:
/// 3 cm of a human figure. Raise it for garments that were fitted to a smaller body.
const MAX_DEPTH: f32 = 0.015;

/// A garment of which more than this share is so deep lies around another part of the body: the
/// shoulders of a shirt that hangs too low are in the thighs. Raise it with [`MAX_DEPTH`].
const DEEP_SHARE: f32 = 0.01;

/// Why a garment does not lie on its body.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Misplaced {
    /// It would lie on the body in another unit.
    #[error(
        "the garment looks like {}{}, the body like {}",
        garment.name(),
        or.map(|unit| format!(" or {}", unit.name())).unwrap_or_default(),
        taken.name()
    )]
    Unit {
        /// The unit in which it would lie on the body.
        garment: Unit,
        /// Another one in which it may lie there.
        or: Option<Unit>,
        /// The unit that was taken.
        taken: Unit,
    },
    /// It would lie on the body with another axis up.
    #[error("the garment looks as if {garment} were up, the body as if {body} were")]
    Axis {
        /// The axis with which it would lie on the body.
        garment: UpAxis,
        /// The axis that was taken.
        body: UpAxis,
    },
    /// It is much larger or smaller than the body.
    #[error(
        "the garment is {garment_size:.3} m in size and the body {body_size:.3} m: the {} may be in \
         centimetres",
        if garment_size < body_size { "body" } else { "garment" }
    )]
    Size {
        /// Largest extent of the garment, in metres.
        garment_size: f32,
        /// Largest extent of the body, in metres.
        body_size: f32,
    },
    /// Loose pieces lie far from the rest of it, which would be in place.
    #[error(
        "{faces} of its faces are loose pieces that make it {size:.1} m in size, without which it \
         is {rest:.2} m"
    )]
    Strays {
        /// How many faces.
        faces: usize,
        /// The largest extent of the garment, in metres.
        size: f32,
        /// The same without them.
        rest: f32,
    },
    /// It is nowhere near the body.
    #[error("they are {gap:.2} m apart, if both are in {}", unit.name())]
    Apart {
        /// The distance, in metres.
        gap: f32,
        /// The unit that was taken.
        unit: Unit,
    },
    /// It lies beside the body.
    #[error("half of the cloth is {offset:.2} m or more to one side of the skin nearest to it")]
    Aside {
        /// The median offset of the cloth from the skin, in metres.
        offset: f32,
    },
    /// The body runs through it, as where it lies too high or too low.
    #[error("{:.1} % of the cloth is deep in the body, up to {:.0} mm", 1e2 * share, 1e3 * depth)]
    Through {
        /// The share of the vertices.
        share: f32,
        /// The largest depth, in metres.
        depth: f32,
    },
}

/// Refuses a garment whose box is not of the size of a garment for the body, or away from it.
///
/// Both boxes are in metres with y up; `frame` is what was taken for the file of the garment,
/// [`Frame::OURS`] if it comes from none. A small thing on the body, such as a ring, is accepted.
///
/// # Errors
///
/// [`Misplaced`].
pub fn check_sizes(garment: &Bounds, body: &Bounds, frame: Frame) -> Result<(), Misplaced> {
    let sits = |bounds: &Bounds| has_usual_size(bounds, body) && is_near(bounds, body);
    if sits(garment) {
        return Ok(());
    }
    let is_usual = has_usual_size(garment, body);
    let other_unit = |unit: &Unit| {
        let factor = unit.in_metres() / frame.unit.in_metres();
        !is_usual && *unit != frame.unit && sits(&moved(garment, |point| point * factor))
    };
    let mut units = Unit::ALL.into_iter().filter(other_unit);
    if let Some(unit) = units.next() {
        return Err(Misplaced::Unit {
            garment: unit,
            // Garments in feet are none that are sewn.
            or: units.find(|unit| *unit == Unit::Inch),
            taken: frame.unit,
        });
    }
    let (other_up, turned) = match frame.up {
        UpAxis::Y => (UpAxis::Z, moved(garment, |p| Point3::new(p.x, p.z, -p.y))),
        UpAxis::Z => (UpAxis::Y, moved(garment, |p| Point3::new(p.x, -p.z, p.y))),
    };
    if sits(&turned) {
        return Err(Misplaced::Axis {
            garment: other_up,
            body: frame.up,
        });
    }
    let (garment_size, body_size) = (size(garment), size(body));
    let is_small = (LEAST_SIZE * body_size..body_size).contains(&garment_size);
    if is_small && is_near(garment, body) {
        return Ok(());
    }
    Err(if is_usual {
        Misplaced::Apart {
            gap: garment.gap(body),
            unit: frame.unit,
        }
    } else {
        Misplaced::Size {
            garment_size,
            body_size,
        }
    })
}

/// The same of a mesh, in metres with y up: what is wrong with its loose pieces alone is told so.
///
/// # Errors
///
/// [`Misplaced`].
pub fn check_pieces(garment: &TriMesh, body: &Bounds, frame: Frame) -> Result<(), Misplaced> {
    let bounds = |faces: &[[u32; 3]]| Bounds::of_faces(garment.positions(), faces);
    let Some(all) = bounds(garment.faces()) else {
        return Ok(());
    };
    let Err(problem) = check_sizes(&all, body, frame) else {
        return Ok(());
    };
    let topology = Topology::new(garment.num_vertices(), garment.faces());
    let (pieces, num_pieces) = topology.face_components();
    let mut sizes = vec![0_usize; num_pieces];
    for &piece in &pieces {
        sizes[piece as usize] += 1;
    }
    let Some(largest) = sizes.iter().copied().max() else {
        return Err(problem);
    };
    let is_main = |piece: u32| sizes[piece as usize] == largest;
    let faces = garment.faces().iter().zip(&pieces);
    let main: Vec<[u32; 3]> = faces
        .filter(|(_, piece)| is_main(**piece))
        .map(|(face, _)| *face)
        .collect();
    match bounds(&main) {
        Some(main_bounds) if check_sizes(&main_bounds, body, frame).is_ok() => {
            Err(Misplaced::Strays {
                faces: garment.num_faces() - main.len(),
                size: size(&all),
                rest: size(&main_bounds),
            })
        }
        _ => Err(problem),
    }
}

/// Refuses a garment that lies beside the body, or that the body runs through: its vertices
/// `[vertex]` and their offsets `[vertex]` from the skin nearest to each, in metres, and normals
/// `[vertex]` of the skin there, of any length.
///
/// # Errors
///
/// [`Misplaced::Apart`], [`Misplaced::Aside`] or [`Misplaced::Through`].
pub fn check_offsets(
    positions: &[Point3],
    offsets: &[Vector3],
    normals: &[Vector3],
    body: &Bounds,
) -> Result<(), Misplaced> {
    let scale = body.diagonal();
    let distances = || offsets.iter().map(Vector3::norm);
    let gap = distances().fold(f32::INFINITY, f32::min);
    if gap > MAX_GAP * scale && gap.is_finite() {
        let unit = Unit::Metre;
        return Err(Misplaced::Apart { gap, unit });
    }
    let offset = median(offsets).norm();
    let num_touching = distances()
        .filter(|&distance| distance <= TOUCH * scale)
        .count();
    let is_off = |offset: f32| offset > MAX_OFFSET * scale;
    if is_off(offset)
        && (num_touching as f32) < TOUCHING_SHARE * offsets.len() as f32
        && is_off(median(&attached(positions, offsets)).norm())
    {
        return Err(Misplaced::Aside { offset });
    }
    let is_deep = |(offset, normal): &(&Vector3, &Vector3)| {
        offset.dot(normal) < 0.0 && offset.norm() > MAX_DEPTH * scale
    };
    let pairs = offsets.iter().zip(normals).filter(is_deep);
    let depths: Vec<f32> = pairs.map(|(offset, _)| offset.norm()).collect();
    let share = depths.len() as f32 / offsets.len().max(1) as f32;
    if share > DEEP_SHARE {
        let depth = depths.into_iter().fold(0.0, f32::max);
        return Err(Misplaced::Through { share, depth });
    }
    Ok(())
}

/// Offsets of what a garment is attached through.
fn attached(positions: &[Point3], offsets: &[Vector3]) -> Vec<Vector3> {
    let Bounds { min, max } = Bounds::of(positions).unwrap_or_default();
    let lowest = max.y - ATTACHED_SHARE * (max.y - min.y);
    let pairs = positions.iter().zip(offsets);
    let above = pairs.filter(|(place, _)| place.y >= lowest);
    above.map(|(_, offset)| *offset).collect()
}

/// The median of each coordinate; zero without vectors.
fn median(vectors: &[Vector3]) -> Vector3 {
    Vector3::from_fn(|axis, _| {
        let mut values: Vec<f32> = vectors.iter().map(|vector| vector[axis]).collect();
        let middle = values.len() / 2;
        if values.is_empty() {
            return 0.0;
        }
        *values.select_nth_unstable_by(middle, f32::total_cmp).1
    })
}

/// The box of a box whose corners are moved along the axes.
fn moved(bounds: &Bounds, way: impl Fn(&Point3) -> Point3) -> Bounds {
    Bounds::of(&[way(&bounds.min), way(&bounds.max)]).unwrap_or_default()
}

fn size(bounds: &Bounds) -> f32 {
    bounds.extent().max()
}

fn has_usual_size(garment: &Bounds, body: &Bounds) -> bool {
    let ratio = size(garment) / size(body).max(f32::MIN_POSITIVE);
    (USUAL_SIZES[0]..=USUAL_SIZES[1]).contains(&ratio)
}

fn is_near(garment: &Bounds, body: &Bounds) -> bool {
    garment.gap(body) <= MAX_GAP * body.diagonal()
}

#[cfg(test)]
mod tests {
    use garnet_knn::Surface;
    use garnet_mesh::primitives::{capsule, grid, tube};

    use super::*;

    fn body() -> TriMesh {
        capsule(0.15, 1.4, 32, 16)
    }

    fn bounds(mesh: &TriMesh) -> Bounds {
        Bounds::of_faces(mesh.positions(), mesh.faces()).unwrap()
    }

    fn changed(mesh: &TriMesh, way: impl Fn(&Point3) -> Point3) -> TriMesh {
        let positions = mesh.positions().iter().map(way);
        mesh.with_positions(positions.collect()).unwrap()
    }

    fn sized(garment: &TriMesh, frame: Frame) -> Result<(), Misplaced> {
        check_sizes(&bounds(garment), &bounds(&body()), frame)
    }

    fn checked(garment: &TriMesh) -> Result<(), Misplaced> {
        sized(garment, Frame::OURS)?;
        let body = body();
        let skin = Surface::new(&body);
        let corner = |corner: u32| body.positions()[corner as usize];
        let offset = |point: &Point3| {
            let nearest = skin.closest(*point);
            let [a, b, c] = body.faces()[nearest.face as usize].map(corner);
            (point - nearest.point, (b - a).cross(&(c - a)))
        };
        let (offsets, normals): (Vec<_>, Vec<_>) = garment.positions().iter().map(offset).unzip();
        check_offsets(garment.positions(), &offsets, &normals, &bounds(&body))
    }

    #[test]
    fn a_garment_on_its_body_is_accepted() {
        assert_eq!(checked(&tube(0.2, 0.6, 16, 8)), Ok(()));
        // A wide skirt.
        assert_eq!(checked(&tube(0.35, 0.6, 16, 8)), Ok(()));
    }

    #[test]
    fn a_small_thing_on_the_body_is_accepted() {
        let ring = tube(0.01, 0.01, 16, 2);
        let on_skin = changed(&ring, |point| point + Vector3::new(0.15, 0.3, 0.0));
        assert_eq!(checked(&on_skin), Ok(()));
        let dust = changed(&ring, |point| point * 0.1);
        assert!(matches!(checked(&dust), Err(Misplaced::Size { .. })));
    }

    #[test]
    fn the_unit_that_fits_is_named() {
        let garment = changed(&tube(0.2, 0.6, 16, 8), |point| point * 100.0);
        let error = checked(&garment).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the garment looks like centimetres or inches, the body like metres"
        );
        let smaller = changed(&tube(0.2, 0.6, 16, 8), |point| point * 0.1);
        let decimetres = Frame {
            unit: Unit::Decimetre,
            up: UpAxis::Y,
        };
        let expected = Misplaced::Unit {
            garment: Unit::Metre,
            or: None,
            taken: Unit::Decimetre,
        };
        assert_eq!(sized(&smaller, decimetres), Err(expected));
    }

    #[test]
    fn a_loose_piece_far_away_is_told() {
        let (mut positions, mut faces) = tube(0.2, 0.6, 16, 8).into_parts();
        let first = positions.len() as u32;
        let far = |x: f32| Point3::new(70.0 + x, 0.0, 0.1 * x);
        positions.extend([far(0.0), far(0.1), far(0.2) + Vector3::y()]);
        faces.push([first, first + 1, first + 2]);
        let garment = TriMesh::new(positions, faces).unwrap();
        let found = check_pieces(&garment, &bounds(&body()), Frame::OURS);
        assert!(
            matches!(found, Err(Misplaced::Strays { faces: 1, .. })),
            "{found:?}"
        );
    }

    #[test]
    fn a_turned_garment_is_told_its_axis() {
        let on_ground = |mesh: &TriMesh, height| changed(mesh, |p| p + Vector3::y() * height);
        let body = bounds(&on_ground(&body(), 0.85));
        let high = on_ground(&tube(0.2, 0.5, 16, 8), 1.2);
        assert_eq!(check_sizes(&bounds(&high), &body, Frame::OURS), Ok(()));
        let lying = changed(&high, |p| Point3::new(p.x, -p.z, p.y));
        let expected = Misplaced::Axis {
            garment: UpAxis::Z,
            body: UpAxis::Y,
        };
        let found = check_sizes(&bounds(&lying), &body, Frame::OURS);
        assert_eq!(found, Err(expected));
    }

    #[test]
    fn a_garment_elsewhere_is_told_how_far() {
        let away = changed(&tube(0.2, 0.6, 16, 8), |p| p + Vector3::x() * 3.0);
        assert_eq!(
            checked(&away).unwrap_err().to_string(),
            "they are 2.65 m apart, if both are in metres"
        );
    }

    #[test]
    fn a_garment_beside_the_body_is_refused() {
        let skirt = tube(0.2, 0.6, 16, 8);
        for way in [Vector3::x(), -Vector3::x(), Vector3::z(), -Vector3::z()] {
            let aside = changed(&skirt, |point| point + way * 0.45);
            assert!(
                matches!(checked(&aside), Err(Misplaced::Aside { .. })),
                "{way}"
            );
        }
    }

    #[test]
    fn a_train_on_one_side_is_accepted() {
        // An eighth of the vertices lies on the body, the others trail behind it.
        let near = vec![Vector3::new(0.0, 0.0, 0.01); 1];
        let behind = vec![Vector3::new(0.0, 0.0, -0.5); 7];
        let offsets = [near, behind].concat();
        let normals = [[Vector3::z(); 1].as_slice(), &[-Vector3::z(); 7]].concat();
        let places = [Point3::origin(); 8];
        let checked = |from: usize| {
            let (places, normals) = (&places[from..], &normals[from..]);
            check_offsets(places, &offsets[from..], normals, &bounds(&body()))
        };
        assert_eq!(checked(0), Ok(()));
        assert!(checked(1).is_err());
        assert_eq!(checked(8), Ok(()));
    }

    #[test]
    fn a_cape_whose_hem_stands_off_is_accepted_and_refused_beside_the_body() {
        // From the shoulders down it stands off by up to 0.3 m, behind the body alone.
        let cape = changed(&grid(12, 16, [1.0, 1.0]), |p| {
            let (angle, down) = (2.0 * p.x, 0.5 - p.y);
            let radius = 0.18 + 0.27 * down;
            Point3::new(
                radius * angle.sin(),
                0.6 - 1.1 * down,
                -radius * angle.cos(),
            )
        });
        assert_eq!(checked(&cape), Ok(()));
        let behind = changed(&cape, |point| point - Vector3::z() * 0.2);
        let found = checked(&behind);
        assert!(matches!(found, Err(Misplaced::Aside { .. })), "{found:?}");
    }

    #[test]
    fn a_body_that_runs_through_its_garment_is_told() {
        // A tube half as wide as the body is in it.
        let found = checked(&tube(0.075, 0.6, 16, 8));
        assert!(matches!(found, Err(Misplaced::Through { .. })), "{found:?}");
        // As tight as this it is mended.
        assert_eq!(checked(&tube(0.14, 0.6, 16, 8)), Ok(()));
    }
}
