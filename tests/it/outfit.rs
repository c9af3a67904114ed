//! Garments over each other on bodies of the population: nothing of one through the other.

use garnet::{
    Draper, Garment,
    body::{
        poses::{Poser, SelfContact, SeparationOptions, key_pose},
        shape::{ParametricBody, Population},
    },
    data::usual_package,
    drape::Outfit,
    pattern::GarmentKind,
};

/// No more of the faces of one garment cross the other.
const MAX_CROSSING: f64 = 0.01;

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
            let mut outfit = Outfit::default();
            for garment in [inner, outer] {
                let draper = Draper::new(garment.clone());
                outfit.drape(draper, posed.clone()).unwrap();
            }
            let crossing = |outfit: &Outfit| {
                let [pair] = outfit.layers().unwrap()[..] else {
                    panic!("two garments have one pair");
                };
                assert_eq!((pair.inner, pair.outer), (0, 1));
                pair.count.crossing_share()
            };
            let parted = crossing(&outfit);
            assert!(parted < MAX_CROSSING, "{number} {parted}");
            // What was pushed into arms for it is freed again.
            outfit.free().unwrap();
            let freed = crossing(&outfit);
            assert!(freed < MAX_CROSSING, "{number} {freed}");
            for drape in outfit.into_drapes() {
                assert_eq!(drape.report.unwrap().inside, 0, "{number}");
            }
        }
    }
}
