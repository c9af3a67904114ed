//! Drapes of generated garments on generated bodies.

use std::sync::atomic::AtomicBool;

use garnet::io::ObjFile;
use garnet::package::{Moment, Settling, Simulator};
use garnet::sim::{Fabric, RestShape};
use garnet::{Body, Garment, Joint, Point3, Pose, Skeleton, TriMesh, Warp, mesh::primitives};
use garnet_tests::capsules::{
    arm, bent, figure, joined, lowered, moved, shirt, skirt, sleeve, step,
};
use garnet_tests::{Judge, mannequin, reach, stride, tunic};

use crate::held::{Bars, Held, draped, held};

/// A tube around the [`arm`].
fn arm_sleeve(radius: f32) -> TriMesh {
    primitives::tube(radius, 0.4, 32, 30)
}

#[test]
fn a_sleeve_on_a_bent_arm_holds() {
    let garment = arm_sleeve(0.06);
    for (angle, stretch_p99) in [(0.5, 1.25), (1.2, 1.35), (2.0, 1.35)] {
        let bars = Bars {
            stretch_p99,
            ..Bars::default()
        };
        draped("sleeve", &garment, &arm(), &bent(angle), bars);
    }
}

#[test]
fn a_garment_that_starts_inside_the_body_comes_out() {
    const TRUNK: f32 = 0.15;
    for depth in [0.01, 0.02, 0.03] {
        let radius = TRUNK - depth;
        let tube = primitives::tube(radius, 0.36, 48, 20);
        let garment = moved(&tube, [0.0, 1.02, 0.0]);
        // Round the trunk with its clearance the cloth must be this much wider.
        let widened = (TRUNK + 0.002) / radius;
        let bars = Bars {
            stretch_p99: 1.05 * widened,
            ..Bars::default()
        };
        let Held { report, .. } = draped("inside", &garment, &figure(), &step(0.3), bars);
        assert_eq!(report.inside_before, garment.num_vertices());
    }
}

#[test]
fn shirt_skirt_and_sleeve_hold_on_a_figure_that_runs_through_itself() {
    let body = figure();
    let garments = [("shirt", shirt()), ("skirt", skirt()), ("sleeve", sleeve())];
    for (name, garment) in &garments {
        for (pose_name, pose) in [("lowered", lowered(0.8)), ("step", step(0.5))] {
            let name = format!("{name}, {pose_name}");
            draped(&name, garment, &body, &pose, Bars::default());
        }
    }
}

/// A body, a garment and a pose, all so many times as large.
fn sized(body: &Body, garment: &TriMesh, pose: &Pose, size: f32) -> (Body, TriMesh, Pose) {
    let of_mesh = |mesh: &TriMesh| {
        let places = mesh.positions().iter().map(|place| place * size);
        mesh.with_positions(places.collect()).unwrap()
    };
    let joints = body.skeleton().joints().iter().map(|joint| Joint {
        rest_position: joint.rest_position * size,
        ..joint.clone()
    });
    let skeleton = Skeleton::new(joints.collect()).unwrap();
    let body = Body::new(of_mesh(body.rest()), skeleton, body.weights().clone()).unwrap();
    let mut pose = pose.clone();
    pose.root_translation *= size;
    (body, of_mesh(garment), pose)
}

#[test]
fn dolls_and_giants_are_simulated_as_people() {
    let (body, garment) = (mannequin(0.03), tunic(1_000).mesh);
    let settled = |size: f32| {
        let (body, garment, pose) = sized(&body, &garment, &reach(), size);
        let bound = Garment::new(garment).bind(&body).unwrap();
        let worn = RestShape::Worn(bound.mesh().positions().to_vec());
        let cloth = bound.shared_cloth().clone();
        let simulator = Simulator::of_garment(cloth, &body, &worn, &Fabric::cotton()).unwrap();
        let posed = body.posed(&pose).unwrap();
        let home = posed.at_home(&body).unwrap();
        let from = bound.warped(home.body(), Warp::Shape).unwrap();
        let settling = Settling {
            frames: 12,
            ..Settling::of(Moment::Rest)
        };
        let never = AtomicBool::new(false);
        let places = simulator.settled(&body, home.body(), &from, settling, &never);
        let places = places.unwrap().into_iter().map(|place| place / size);
        (simulator.size(), places.collect::<Vec<Point3>>())
    };
    let (one, person) = settled(1.0);
    assert!((one - 1.0).abs() < f32::EPSILON, "{one}");
    for size in [0.1, 10.0] {
        let (found, places) = settled(size);
        assert!((found / size - 1.0).abs() < 0.1, "{found}");
        let apart = places.iter().zip(&person).map(|(a, b)| (a - b).norm());
        let mean = apart.sum::<f32>() / person.len() as f32;
        // The height of a mannequin is not quite that of a person.
        assert!(mean < 2e-3, "{size}: {mean}");
    }
}

#[test]
fn a_tunic_on_a_mannequin_holds() {
    let body = mannequin(0.022);
    let tunic = tunic(2_500);
    let bound = Garment::new(tunic.mesh.clone()).bind(&body).unwrap();
    let judge = Judge::new(&tunic.mesh);
    for (name, pose) in [("reach", reach()), ("stride", stride())] {
        held(
            name,
            &judge,
            &bound,
            &body.posed(&pose).unwrap(),
            Bars::default(),
        );
    }
}

#[test]
fn a_button_stays_on_its_shirt() {
    let button = moved(&primitives::uv_sphere(10, 6, 0.008), [0.0, 1.05, 0.177]);
    let garment = joined(&shirt(), &button);
    let first = shirt().num_vertices();
    let Held { positions, .. } = draped("button", &garment, &figure(), &step(0.6), Bars::default());
    // A button is no cloth: it keeps its shape.
    let rest = garment.positions();
    for a in first..positions.len() {
        for b in first..a {
            let lengths = [rest, &positions].map(|p| (p[a] - p[b]).norm());
            assert!((lengths[0] - lengths[1]).abs() < 0.003, "{lengths:?}");
        }
    }
}

#[test]
fn duplicated_vertices_of_a_seam_stay_together() {
    let garment = with_seam(&arm_sleeve(0.058), 32);
    let Held { positions, .. } = draped("seam", &garment, &arm(), &bent(1.4), Bars::default());
    let num_seam = garment.num_vertices() - arm_sleeve(0.058).num_vertices();
    assert_eq!(num_seam, 31);
    for copy in 0..num_seam {
        let original = copy * 32;
        assert_eq!(
            positions[original],
            positions[positions.len() - num_seam + copy]
        );
    }
}

/// The tube with the vertices of one seam, every `segments`, doubled: the faces on one side use the
/// copies.
fn with_seam(tube: &TriMesh, segments: u32) -> TriMesh {
    let mut positions = tube.positions().to_vec();
    let originals = positions.iter().step_by(segments as usize);
    let copies: Vec<Point3> = originals.copied().collect();
    let first = positions.len() as u32;
    positions.extend(copies);
    let faces = tube.faces().iter().map(|face| {
        let is_last = face.iter().any(|corner| corner % segments == segments - 1);
        face.map(|corner| match corner % segments {
            0 if is_last => first + corner / segments,
            _ => corner,
        })
    });
    TriMesh::new(positions, faces.collect()).unwrap()
}

#[test]
fn polygons_groups_and_texture_survive_a_drape() {
    let text = tunic(1_200).to_obj();
    let middle = text.find("\nf ").unwrap();
    let (vertices, faces) = text.split_at(middle + 1);
    let text = format!("# made for a test\r\n{vertices}g front\nusemtl red\n{faces}g none\n");
    let file = ObjFile::parse(text.clone().into_bytes(), "tunic.obj").unwrap();
    assert_eq!(
        file.bytes_with_positions(file.positions()).unwrap(),
        text.as_bytes()
    );

    let mesh = file.mesh().unwrap();
    let body = mannequin(0.03);
    let bound = Garment::new(mesh.clone()).bind(&body).unwrap();
    let judge = Judge::new(&mesh).with_edges(file.polygon_edges());
    let target = body.posed(&stride()).unwrap();
    let Held { positions, .. } = held("obj", &judge, &bound, &target, Bars::default());
    let bytes = file.bytes_with_positions(&positions).unwrap();
    let written = ObjFile::parse(bytes, "draped.obj").unwrap();
    assert_eq!(written.positions(), positions);
    let others = |file: &ObjFile| {
        let text = String::from_utf8(file.source().to_vec()).unwrap();
        let lines = text.split('\n').filter(|line| !line.starts_with("v "));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(others(&written), others(&file));
}

#[test]
fn a_target_of_another_shape_is_fitted() {
    let body = mannequin(0.022);
    let posed = body.posed(&stride()).unwrap();
    // Stouter by 4 % about the middle plane, after posing: pose recovery must see through it.
    let wider = |p: &Point3| Point3::new(1.04 * p.x, p.y, p.z);
    let target: Vec<Point3> = posed.skin().positions().iter().map(wider).collect();
    let tunic = tunic(2_500);
    let bound = Garment::new(tunic.mesh.clone()).bind(&body).unwrap();
    let fitted = body.fitted(&target).unwrap();
    assert!(fitted.shape_offsets().is_some());
    held(
        "shape",
        &Judge::new(&tunic.mesh),
        &bound,
        &fitted,
        Bars::default(),
    );
}

#[test]
fn a_garment_that_is_already_clear_does_not_move() {
    let body = mannequin(0.022);
    let tunic = tunic(2_500);
    let pose = Pose::rest(body.skeleton().num_joints());
    let Held {
        positions, report, ..
    } = draped("rest", &tunic.mesh, &body, &pose, Bars::default());
    assert_eq!(report.inside_before, 0);
    for (rest, draped) in tunic.mesh.positions().iter().zip(&positions) {
        assert!(
            (rest - draped).norm() <= crate::held::ROUNDING,
            "{rest} {draped}"
        );
    }
}
