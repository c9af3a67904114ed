//! Garments over each other on bodies of the population: nothing of one through the other.

use garnet::{
    BoundGarment, Draper, Garment, Point3, PosedBody,
    body::{
        poses::{Poser, SelfContact, SeparationOptions, key_pose},
        shape::{ParametricBody, Population},
    },
    data::usual_package,
    drape::{LayerOptions, Placed, PlacedBy, WornGarment, count_layers, dressed, part_layers},
    pattern::GarmentKind,
};

/// No more of the faces of one garment cross the other.
const MAX_CROSSING: f64 = 0.01;

fn draped(garment: &BoundGarment, body: &PosedBody) -> Vec<Point3> {
    let drape = Draper::new(garment.clone()).drape(body).unwrap();
    drape.positions
}

#[test]
fn tops_over_jeans_and_a_sweater_over_a_dress_keep_their_order() {
    let packages = GarmentKind::ALL.map(|kind| usual_package(kind, 1500).unwrap());
    let rest = &packages[0].body;
    let bound = packages.each_ref().map(|package| {
        let garment = Garment::new(package.mesh.clone());
        garment.bind(&package.body).unwrap()
    });
    let [tshirt, sweater, dress, jeans] = &bound;
    let population = Population::new(21);
    for (number, pose) in [(0, "stand"), (1, "wave"), (2, "hands_on_hips"), (3, "sit")] {
        let person = ParametricBody::build(&population.sample(number)).unwrap();
        let poser = Poser::new(person.body().skeleton()).unwrap();
        let pose = poser.pose(&key_pose(pose).unwrap().angles);
        let contact = SelfContact::new(person.body()).unwrap();
        let apart = contact.separated(&pose, &SeparationOptions::default());
        let pose = apart.unwrap().map_or(pose, |apart| apart.pose);
        let posed = person.body().posed(&pose).unwrap();
        let posed = rest.fitted(posed.skin().positions()).unwrap();
        for (inner, outer) in [(jeans, tshirt), (jeans, sweater), (dress, sweater)] {
            let mut under = WornGarment {
                garment: inner,
                positions: draped(inner, &posed),
            };
            let body = dressed(&posed, std::slice::from_ref(&under), outer).unwrap();
            let mut over = WornGarment {
                garment: outer,
                positions: draped(outer, &body),
            };
            let before = count_layers(&under, &over).unwrap();
            part_layers(&mut under, &mut over, &posed, LayerOptions::default()).unwrap();
            let after = count_layers(&under, &over).unwrap();
            println!("{number}: {before:?}, {after:?}");
            assert!(after.crossing_share() < MAX_CROSSING, "{number} {after:?}");
            // What was pushed into arms for it is freed again.
            let by = PlacedBy::Simulation;
            let placed = Placed::at(outer, &posed, &over.positions, by).unwrap();
            let freed = Draper::new(outer.clone()).untangle(placed).unwrap();
            assert_eq!(freed.report.unwrap().inside, 0, "{number}");
            over.positions = freed.positions;
            let freed = count_layers(&under, &over).unwrap();
            assert!(freed.crossing_share() < MAX_CROSSING, "{number} {freed:?}");
        }
    }
}
