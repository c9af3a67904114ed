//! Bodies and garments as people have them: skin that is missing, meshes finer and coarser,
//! garments that lie elsewhere or whose faces look anywhere.

use std::sync::Arc;

use garnet::io::aligned;
use garnet::mesh::vertex_distances;
use garnet::package::Simulator;
use garnet::sim::{Fabric, RestShape};
use garnet::{
    Body, Drape, DrapeOptions, Draper, Garment, Point3, Pose, SkinWeights, TriMesh, Vector3,
};
use garnet_tests::{mannequin, reach, stride, tunic, without};
use nalgebra::UnitQuaternion;

/// The mean distance of vertices of the same number, in metres.
fn mean_distance(a: &[Point3], b: &[Point3]) -> f32 {
    let distances = vertex_distances(a, b).unwrap();
    distances.iter().sum::<f32>() / distances.len() as f32
}

/// Each face as four.
fn finer(body: &Body) -> Body {
    let rest = body.rest();
    let mut positions = rest.positions().to_vec();
    let mut rows: Vec<Vec<(usize, f32)>> = (0..rest.num_vertices())
        .map(|vertex| body.weights().vertex(vertex).collect())
        .collect();
    let mut middles = std::collections::BTreeMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let [at_a, at_b] = [a, b].map(|vertex| positions[vertex as usize]);
            positions.push(nalgebra::center(&at_a, &at_b));
            let row = [a, b]
                .into_iter()
                .flat_map(|vertex| rows[vertex as usize].clone());
            let row = row.map(|(joint, weight)| (joint, 0.5 * weight)).collect();
            rows.push(row);
            positions.len() as u32 - 1
        })
    };
    let mut faces = Vec::new();
    for &[a, b, c] in rest.faces() {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        faces.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    let weights = SkinWeights::from_influences(body.weights().num_joints(), rows).unwrap();
    let mesh = TriMesh::new(positions, faces).unwrap();
    Body::new(mesh, body.skeleton().clone(), weights).unwrap()
}

fn draped_on(body: &Body, pose: &Pose, garment: &TriMesh) -> Drape {
    let bound = Garment::new(garment.clone()).bind(body).unwrap();
    Draper::new(bound)
        .drape(&body.posed(pose).unwrap())
        .unwrap()
}

#[test]
fn cloth_over_skin_that_was_deleted_lies_as_over_whole_skin() {
    let whole = mannequin(0.022);
    let tunic = tunic(2_000).mesh;
    let is_trunk = |vertex: usize| {
        let name = &whole.skeleton().joints()[whole.weights().heaviest(vertex)].name;
        matches!(name.as_str(), "pelvis" | "spine" | "chest")
    };
    let open = without(&whole, |vertex| {
        let height = whole.rest().positions()[vertex].y;
        is_trunk(vertex) && (0.93..1.42).contains(&height)
    });
    assert!(open.num_rims() >= 2, "{}", open.num_rims());
    assert!(open.skin().is_closed());
    let bound = Garment::new(tunic.clone()).bind(&open).unwrap();
    let nodes = 0..bound.cloth().rest_nodes().len();
    let over = nodes
        .clone()
        .filter(|&node| bound.cloth().is_over_hole(node))
        .count();
    let share = over as f64 / nodes.len() as f64;
    assert!((0.3..0.9).contains(&share), "{share}");
    // Where nothing has moved, nothing is freed from what closes the holes.
    let at_rest = draped_on(&open, &Pose::rest(whole.skeleton().num_joints()), &tunic);
    assert_eq!(at_rest.report.unwrap().inside_before, 0);
    assert!(mean_distance(&at_rest.positions, tunic.positions()) < 1e-4);
    for pose in [reach(), stride()] {
        let right = draped_on(&whole, &pose, &tunic);
        let found = draped_on(&open, &pose, &tunic);
        let apart = mean_distance(&right.positions, &found.positions);
        assert!(apart < 0.012, "{apart}");
        assert_eq!(found.report.unwrap().inside, 0);
    }
    // Nothing would hold it in a simulation.
    let rest = RestShape::Worn(tunic.positions().to_vec());
    let fabric = Fabric::cotton();
    let error = Simulator::of_garment(bound.cloth().clone(), &open, &rest, &fabric).unwrap_err();
    assert!(error.to_string().contains("over holes"), "{error}");
}

#[test]
fn open_necks_and_missing_hands_change_nothing_under_the_cloth() {
    let whole = mannequin(0.022);
    let tunic = tunic(2_000).mesh;
    let open = without(&whole, |vertex| {
        let place = whole.rest().positions()[vertex];
        place.y > 1.6 || place.x.abs() > 0.6
    });
    assert_eq!(open.num_rims(), 3);
    let bound = Garment::new(tunic.clone()).bind(&open).unwrap();
    let nodes = 0..bound.cloth().rest_nodes().len();
    assert_eq!(
        nodes
            .filter(|&node| bound.cloth().is_over_hole(node))
            .count(),
        0
    );
    let [right, found] = [&whole, &open].map(|body| draped_on(body, &reach(), &tunic));
    let apart = mean_distance(&right.positions, &found.positions);
    assert!(apart < 1e-3, "{apart}");
}

#[test]
fn finer_bodies_give_the_drape_of_the_body_that_they_are_of() {
    let body = mannequin(0.022);
    let tunic = tunic(2_000).mesh;
    let [right, found] = [&body, &finer(&body)].map(|body| draped_on(body, &stride(), &tunic));
    let apart = mean_distance(&right.positions, &found.positions);
    assert!(apart < 2e-3, "{apart}");
    assert_eq!(found.report.unwrap().inside, 0);
}

/// What is done to a garment before it is brought back.
type Way<'a> = &'a dyn Fn(Point3) -> Point3;

#[test]
fn garments_that_lie_elsewhere_are_brought_to_the_body() {
    let body = mannequin(0.022);
    let tunic = tunic(2_000).mesh;
    let changed = |way: &dyn Fn(Point3) -> Point3| {
        let moved = tunic.positions().iter().map(|point| way(*point));
        tunic.with_positions(moved.collect()).unwrap()
    };
    let middle = Point3::new(0.0, 1.1, 0.0);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.5);
    let cases: [(&str, f32, Way<'_>); 6] = [
        ("as it is", 1e-6, &|p| p),
        ("in centimetres", 0.03, &|p| p * 100.0),
        ("at the origin", 0.03, &|p| p - middle.coords),
        ("z up", 0.03, &|p| Point3::new(p.x, -p.z, p.y)),
        ("turned", 0.03, &|p| middle + turn * (p - middle)),
        ("beside", 0.03, &|p| p + Vector3::new(0.8, -0.2, 0.1)),
    ];
    for (name, most, way) in cases {
        let garment = changed(way);
        let (placed, done) = aligned(&garment, &body).unwrap().unwrap();
        let apart = mean_distance(placed.positions(), tunic.positions());
        println!("{name}: {apart:.4} m, {done}");
        assert!(apart < most, "{name}: {apart}, {done}");
        assert_eq!(done.openings, [4, 4], "{name}: {done}");
        Garment::new(placed).bind(&body).unwrap();
    }
    let (same, done) = aligned(&tunic, &body).unwrap().unwrap();
    assert_eq!(&same, &tunic);
    assert!(done.to_string().starts_with("nothing to do"), "{done}");
}

/// The tunic with every fifth face turned, one face there twice, and one without area.
fn careless(tunic: &TriMesh) -> TriMesh {
    let mut faces = tunic.faces().to_vec();
    for face in faces.iter_mut().step_by(5) {
        face.swap(1, 2);
    }
    let [a, b, c] = faces[7];
    faces.extend([[a, c, b], [a, b, b]]);
    TriMesh::new(tunic.positions().to_vec(), faces).unwrap()
}

#[test]
fn any_garment_settles_and_is_none_the_worse_for_it() {
    let body = mannequin(0.022);
    let tunic = tunic(2_000).mesh;
    for (name, garment) in [("tunic", tunic.clone()), ("careless", careless(&tunic))] {
        for pose in [reach(), stride()] {
            let bound = Arc::new(Garment::new(garment.clone()).bind(&body).unwrap());
            let rest = RestShape::Worn(garment.positions().to_vec());
            let cloth = Arc::clone(bound.shared_cloth());
            let simulator =
                Simulator::of_any_garment(cloth, &body, &rest, &Fabric::cotton()).unwrap();
            let options = DrapeOptions::default().with_relax_frames(20);
            let settling = Draper::new(Arc::clone(&bound))
                .with_options(options)
                .with_simulator(simulator);
            let posed = body.posed(&pose).unwrap();
            let before = Draper::new(bound).drape(&posed).unwrap();
            let after = settling.drape(&posed).unwrap();
            assert!(after.provenance.unrelaxed.is_none(), "{name}");
            let [was, is] = [&before, &after].map(|drape| drape.report.clone().unwrap());
            assert!(is.inside <= was.inside && is.crossing_faces <= was.crossing_faces);
            match after.provenance.worsened {
                Some(told) => {
                    assert!(told.after.is_worse_than(&told.before), "{name}: {told}");
                    assert_eq!(after.positions, before.positions);
                }
                None => assert!(after.positions != before.positions, "{name}"),
            }
        }
    }
}
