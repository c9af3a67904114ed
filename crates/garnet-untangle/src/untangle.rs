//! From the warp to cloth that lies outside the skin.

use garnet_knn::Traps;
use garnet_mesh::Point3;
use garnet_skin::{BoundGarment, PosedBody};

use crate::cloth::{Cloth, Scene};
use crate::contact::ContactFinder;
use crate::crossing::Crossing;
use crate::passes;
use crate::skin_normals::SkinNormals;
use crate::sweep::Sweeper;
use crate::{Binding, UntangleError, UntangleOptions, UntangleReport};

/// A garment that was untangled, and the report.
#[derive(Debug, Clone)]
pub struct Untangled {
    /// Positions `[node]`, in metres.
    pub positions_nodes: Vec<Point3>,
    /// Whether each node is caught where the body runs through itself `[node]`.
    pub is_trapped: Vec<bool>,
    /// What was found and what is left.
    pub report: UntangleReport,
}

/// Frees a warped garment of penetrations, in passes:
///
/// 1. *relax* brings edges that the warp has stretched or compressed back towards their length.
/// 2. *push* moves nodes in front of the skin and draws the cloth around them along, so that the
///    displacement is smooth.
/// 3. *mend* starts again where pushes have torn the cloth, with neighbours on one side of a limb.
/// 4. *unfold* smooths cloth with layers where it runs through itself, and once more after the
///    next pass.
/// 5. *lift* raises triangles that still cross the skin between corners that do not. Where that
///    tears the cloth, it is mended and lifted once more.
/// 6. *rescue* looks for free places for the single nodes that are still inside or too near.
/// 7. *ease* lets the neighbours of nodes that are far from them follow, from free place to free
///    place.
/// 8. *give in* lets cloth that goes round a contact of the body with itself into the contact.
/// 9. *follow* moves layers that lie on the moved cloth along with it.
/// 10. *retreat* draws cloth back that still goes round a part of the body.
/// 11. *flatten* brings layers that are inside the body nearer to the cloth that they follow; those
///     of their nodes that are left are rescued.
/// 12. *verify* tests every node and face exactly and counts what is left.
///
/// `warped_nodes` are positions `[node]` in metres, as of [`BoundGarment::warped_nodes`].
///
/// # Errors
///
/// [`UntangleError::BodyFaces`] or [`UntangleError::PositionCount`] if the parts do not belong
/// together.
pub fn untangle(
    garment: &BoundGarment,
    binding: &Binding,
    body: &PosedBody,
    warped_nodes: &[Point3],
    options: &UntangleOptions,
) -> Result<Untangled, UntangleError> {
    let (found, expected) = (body.skin().faces().len(), garment.rest_skin().faces().len());
    if found != expected {
        return Err(UntangleError::BodyFaces { found, expected });
    }
    let (found, expected) = (warped_nodes.len(), garment.rest_nodes().len());
    if found != expected {
        return Err(UntangleError::PositionCount { found, expected });
    }
    // Inside the pool, parallel loops need no hand-over of their own.
    rayon::scope(|_| untangled(garment, binding, body, warped_nodes, options))
}

/// What contacts with a body are looked for with.
struct Ground {
    traps: Traps,
    normals: SkinNormals,
}

impl Ground {
    fn of(body: &PosedBody, binding: &Binding, nodes: &[Point3]) -> Result<Self, UntangleError> {
        Ok(Self {
            traps: Traps::near(body.skin(), nodes, binding.scale)?,
            normals: SkinNormals::new(body.skin()),
        })
    }

    fn finder<'a>(
        &'a self,
        body: &'a PosedBody,
        binding: &'a Binding,
        options: &UntangleOptions,
    ) -> ContactFinder<'a> {
        ContactFinder {
            binding,
            skin: body.skin(),
            traps: &self.traps,
            normals: &self.normals,
            keeps_sides: options.keeps_sides,
            clearance: options.clearance,
        }
    }
}

/// The passes of [`untangle`], whose arguments fit together.
fn untangled(
    garment: &BoundGarment,
    binding: &Binding,
    body: &PosedBody,
    warped: &[Point3],
    options: &UntangleOptions,
) -> Result<Untangled, UntangleError> {
    let options = &UntangleOptions {
        push_length: binding.scale * options.push_length,
        ..*options
    };
    let mut anchors = passes::relax(garment, binding, warped, options);
    (binding.layers).place(garment.faces(), &mut anchors);

    let ground = Ground::of(body, binding, warped)?;
    let finder = ground.finder(body, binding, options);
    let sweeper = Sweeper::new(garment.graph(), &anchors, options);
    let mut cloth = Cloth::new(Scene {
        garment,
        finder: &finder,
        sweeper: &sweeper,
        options,
    });
    let cloth = &mut cloth;

    passes::push(cloth);
    let torn = passes::mend(cloth);
    passes::unfold(cloth)?;
    let mut crossing = passes::lift(cloth)?;
    if cloth.tears().excess > torn {
        passes::mend(cloth);
        crossing = passes::lift(cloth)?;
    }
    if passes::unfold(cloth)? {
        crossing = passes::lift(cloth)?;
    }
    let layers = &binding.layers;
    let mut moved = passes::rescue(cloth, &crossing, |node| !layers.is_follower(node));
    moved.extend(passes::ease(cloth));
    moved.extend(passes::give_in(cloth));
    if !moved.is_empty() {
        moved.extend(passes::follow(cloth, &moved));
        crossing.refresh(cloth, &moved)?;
    }
    crossing = passes::retreat(cloth, crossing)?;
    if !layers.is_single() {
        let flattened = passes::flatten(cloth, &crossing);
        crossing.refresh(cloth, &flattened)?;
        let moved = passes::rescue(cloth, &crossing, |node| layers.is_follower(node));
        crossing.refresh(cloth, &moved)?;
    }
    let (report, is_trapped) = passes::verify(cloth, warped, &crossing);

    Ok(Untangled {
        positions_nodes: std::mem::take(&mut cloth.positions),
        is_trapped,
        report,
    })
}

/// Counts again what is left of cloth that was moved after it was untangled: `moved_nodes` are its
/// positions `[node]` now.
///
/// # Errors
///
/// Those of [`untangle`].
pub fn counted_again(
    garment: &BoundGarment,
    binding: &Binding,
    body: &PosedBody,
    (warped_nodes, moved_nodes): (&[Point3], Vec<Point3>),
    (before, options): (&UntangleReport, &UntangleOptions),
) -> Result<Untangled, UntangleError> {
    let ground = Ground::of(body, binding, warped_nodes)?;
    let finder = ground.finder(body, binding, options);
    let sweeper = Sweeper::new(garment.graph(), &moved_nodes, options);
    let mut cloth = Cloth::new(Scene {
        garment,
        finder: &finder,
        sweeper: &sweeper,
        options,
    });
    cloth.report = UntangleReport {
        inside_before: before.inside_before,
        deepest_before: before.deepest_before,
        contact_rounds: before.contact_rounds,
        crossing_rounds: before.crossing_rounds,
        ..UntangleReport::default()
    };
    let crossing = Crossing::of(&cloth)?;
    let (report, is_trapped) = passes::verify(&cloth, warped_nodes, &crossing);
    drop(cloth);
    Ok(Untangled {
        positions_nodes: moved_nodes,
        is_trapped,
        report,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use garnet_knn::Surface;
    use garnet_mesh::primitives::icosphere;
    use garnet_mesh::{TriMesh, Vector3};
    use garnet_skin::{Body, Garment, Joint, Pose, Skeleton, SkinWeights, Warp};

    const RADIUS: f32 = 0.2;

    /// A body that follows one joint.
    fn one_joint_body(mesh: TriMesh) -> Body {
        let joint = Joint {
            name: "root".to_owned(),
            parent: None,
            rest_position: Point3::origin(),
        };
        let skeleton = Skeleton::new(vec![joint]).unwrap();
        let weights = SkinWeights::from_dense(1, &vec![1.0; mesh.num_vertices()]).unwrap();
        Body::new(mesh, skeleton, weights).unwrap()
    }

    /// Several meshes as one.
    fn joined(meshes: &[TriMesh]) -> TriMesh {
        let mut positions = Vec::new();
        let mut faces = Vec::new();
        for mesh in meshes {
            let first = positions.len() as u32;
            positions.extend_from_slice(mesh.positions());
            faces.extend(mesh.faces().iter().map(|face| face.map(|v| v + first)));
        }
        TriMesh::new(positions, faces).unwrap()
    }

    fn shifted(mesh: &TriMesh, offset: Vector3) -> TriMesh {
        let positions = mesh.positions().iter().map(|p| p + offset).collect();
        mesh.with_positions(positions).unwrap()
    }

    fn untangled_at_rest(garment: TriMesh, body: &Body) -> (Vec<Point3>, Untangled) {
        untangled_by(garment, body, &UntangleOptions::default())
    }

    fn untangled_by(
        garment: TriMesh,
        body: &Body,
        options: &UntangleOptions,
    ) -> (Vec<Point3>, Untangled) {
        let bound = Garment::new(garment).bind(body).unwrap();
        let binding = Binding::new(&bound).unwrap();
        let posed = body.posed(&Pose::rest(1)).unwrap();
        let warped = bound.warped_nodes(&posed, Warp::Shape).unwrap();
        let result = untangle(&bound, &binding, &posed, &warped, options).unwrap();
        (warped, result)
    }

    fn smallest_distance(skin: &Surface, positions: &[Point3]) -> f32 {
        let signed = skin.signed_distance_all(positions);
        signed
            .iter()
            .map(|s| s.distance)
            .fold(f32::INFINITY, f32::min)
    }

    #[test]
    fn cloth_clear_of_the_body_stays_where_it_is() {
        let body = one_joint_body(icosphere(3, RADIUS));
        let (warped, result) = untangled_at_rest(icosphere(3, RADIUS + 0.01), &body);
        assert_eq!(result.positions_nodes, warped);
        assert_eq!(result.report.moved, 0);
    }

    #[test]
    fn cloth_inside_the_body_ends_at_the_clearance() {
        let body = one_joint_body(icosphere(4, RADIUS));
        let (warped, result) = untangled_at_rest(icosphere(3, RADIUS - 0.01), &body);
        let clearance = UntangleOptions::default().clearance;
        assert_eq!(result.report.inside_before, warped.len());
        assert_eq!(result.report.inside, 0);
        assert_eq!(result.report.below_clearance, 0);
        assert_eq!(result.report.crossing_faces, 0);
        assert!(smallest_distance(body.skin(), &result.positions_nodes) >= clearance);
        let farthest = result.positions_nodes.iter().map(|p| p.coords.norm());
        assert!(farthest.fold(0.0, f32::max) < RADIUS + 4.0 * clearance);
    }

    #[test]
    fn a_dent_is_pushed_out_with_the_cloth_around_it() {
        let body = one_joint_body(icosphere(4, RADIUS));
        let sphere = icosphere(4, RADIUS + 0.006);
        let top = Point3::new(0.0, RADIUS, 0.0);
        let dented = |point: &Point3| {
            let dent = 0.02 * (1.0 - (point - top).norm() / 0.06).max(0.0);
            point * (1.0 - dent / RADIUS)
        };
        let dent = sphere.with_positions(sphere.positions().iter().map(dented).collect());
        let (warped, result) = untangled_at_rest(dent.unwrap(), &body);
        assert!(result.report.inside_before > 0);
        assert_eq!(result.report.inside, 0);
        let is_drawn_along = |(before, after): (&Point3, &Point3)| {
            before.coords.norm() > RADIUS + 0.003 && (after - before).norm() > 1e-4
        };
        assert!(
            warped
                .iter()
                .zip(&result.positions_nodes)
                .any(is_drawn_along)
        );
    }

    #[test]
    fn cloth_between_two_spheres_that_overlap_is_trapped_and_the_rest_is_outside() {
        let sphere = icosphere(4, RADIUS);
        let apart = 1.6 * RADIUS;
        let other = shifted(&sphere, Vector3::new(apart, 0.0, 0.0));
        let body = one_joint_body(joined(&[sphere, other]));
        let (_, result) = untangled_at_rest(icosphere(4, RADIUS + 0.004), &body);
        assert!(result.report.trapped > 0);
        assert_eq!(result.report.inside, 0);
        assert_eq!(result.report.below_clearance, 0);
    }

    #[test]
    fn simulated_cloth_stays_where_it_is_caught_and_keeps_the_clearance_elsewhere() {
        let sphere = icosphere(4, RADIUS);
        let other = shifted(&sphere, Vector3::new(1.6 * RADIUS, 0.0, 0.0));
        let body = one_joint_body(joined(&[sphere, other]));
        let options = UntangleOptions::default().for_simulated();
        let (warped, result) = untangled_by(icosphere(4, RADIUS + 0.001), &body, &options);
        let mut caught = 0;
        for ((before, after), is_trapped) in
            (warped.iter().zip(&result.positions_nodes)).zip(&result.is_trapped)
        {
            if *is_trapped {
                assert_eq!(before, after);
                caught += 1;
            } else {
                assert!((after.coords.norm() - RADIUS) >= options.clearance - 1e-5);
            }
        }
        assert!(caught > 0);
        assert!(result.report.trapped_inside > 0);
        assert!(result.report.inside_before >= result.report.trapped_inside);
        assert_eq!((result.report.inside, result.report.crossing_faces), (0, 0));
    }

    #[test]
    fn simulated_cloth_between_two_walls_goes_to_the_middle_and_not_along_them() {
        let sphere = icosphere(5, RADIUS);
        let gap = 0.003;
        let other = shifted(&sphere, Vector3::new(2.0 * RADIUS + gap, 0.0, 0.0));
        let body = one_joint_body(joined(&[sphere, other]));
        let options = UntangleOptions::default().for_simulated();
        let (warped, result) = untangled_by(icosphere(4, RADIUS + 0.0005), &body, &options);
        assert_eq!((result.report.inside, result.report.crossing_faces), (0, 0));
        assert!(result.report.squeezed > 0);
        let middle = RADIUS + 0.5 * gap;
        let mut squeezed = 0;
        for (before, after) in warped.iter().zip(&result.positions_nodes) {
            let from_axis = before.y.hypot(before.z);
            if before.x > 0.0 && from_axis < 0.008 {
                squeezed += 1;
                assert!((after.x - middle).abs() < 4e-4, "{after}");
                assert!(
                    (after.y.hypot(after.z) - from_axis).abs() < 1e-3,
                    "{before} {after}"
                );
            }
        }
        assert!(squeezed > 0);
    }

    #[test]
    fn cloth_on_skin_that_another_part_is_pressed_into_stays_on_it_and_whole() {
        let sphere = icosphere(4, RADIUS);
        let apart = 1.9 * RADIUS;
        let other = shifted(&sphere, Vector3::new(apart, 0.0, 0.0));
        let body = one_joint_body(joined(&[sphere, other]));
        let garment = icosphere(4, RADIUS + 0.004);
        let faces = garment.faces().to_vec();
        let (warped, result) = untangled_at_rest(garment, &body);
        assert_eq!(result.report.inside, 0);
        assert!(result.report.trapped_inside > 0);
        for (place, is_trapped) in result.positions_nodes.iter().zip(&result.is_trapped) {
            let height = place.coords.norm() - RADIUS;
            assert!(!is_trapped || (0.0..0.01).contains(&height), "{height}");
        }
        for [a, b, _] in faces.iter().map(|face| face.map(|node| node as usize)) {
            let length = |places: &[Point3]| (places[a] - places[b]).norm();
            assert!(length(&result.positions_nodes) < 1.5 * length(&warped));
        }
    }

    #[test]
    fn what_is_inside_is_caught_where_it_is_and_not_where_its_contacts_were_found() {
        let sphere = icosphere(4, RADIUS);
        let other = shifted(&sphere, Vector3::new(1.6 * RADIUS, 0.0, 0.0));
        let body = one_joint_body(joined(&[sphere, other]));
        let garment = Garment::new(icosphere(3, RADIUS + 0.01))
            .bind(&body)
            .unwrap();
        let binding = Binding::new(&garment).unwrap();
        let options = UntangleOptions::default();
        let (skin, warped) = (body.skin(), garment.rest_nodes());
        let finder = ContactFinder {
            binding: &binding,
            skin,
            traps: &Traps::near(skin, warped, binding.scale).unwrap(),
            normals: &SkinNormals::new(skin),
            keeps_sides: false,
            clearance: options.clearance,
        };
        let sweeper = Sweeper::new(garment.graph(), warped, &options);
        let mut cloth = Cloth::new(Scene {
            garment: &garment,
            finder: &finder,
            sweeper: &sweeper,
            options: &options,
        });
        let from_left = |&a: &usize, &b: &usize| warped[a].x.total_cmp(&warped[b].x);
        let node = (0..warped.len()).min_by(from_left).unwrap();
        // In both spheres, and as far as its contacts tell far from any skin.
        cloth.positions[node] = Point3::new(0.95 * RADIUS, 0.0, 0.0);
        cloth.contacts[node].distance = 1.0;
        let mut crossing = Crossing::of(&cloth).unwrap();
        crossing.faces = garment.topology().vertex_faces(node).to_vec();
        let (report, is_trapped) = passes::verify(&cloth, warped, &crossing);
        assert!(is_trapped[node]);
        assert_eq!(report.crossing_faces, 0);
    }

    #[test]
    fn one_and_two_threads_give_the_same_bits() {
        let body = one_joint_body(icosphere(4, RADIUS));
        let run = |num_threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(num_threads);
            let garment = icosphere(4, RADIUS - 0.004);
            pool.build()
                .unwrap()
                .install(|| untangled_at_rest(garment, &body).1.positions_nodes)
        };
        assert_eq!(run(1), run(2));
    }

    #[test]
    fn a_body_of_another_topology_is_refused() {
        let body = one_joint_body(icosphere(2, RADIUS));
        let other = one_joint_body(icosphere(3, RADIUS));
        let bound = Garment::new(icosphere(2, 0.21)).bind(&body).unwrap();
        let binding = Binding::new(&bound).unwrap();
        let posed = other.posed(&Pose::rest(1)).unwrap();
        let options = UntangleOptions::default();
        let error = untangle(&bound, &binding, &posed, bound.rest_nodes(), &options).unwrap_err();
        assert!(matches!(error, UntangleError::BodyFaces { .. }));
    }
}
