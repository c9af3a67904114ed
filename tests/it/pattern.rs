//! Garments hung around bodies of the built-in population: nothing crosses.

use garnet::shape::{Measure, ParametricBody, Population};
use garnet_knn::Surface;
use garnet_pattern::{GarmentKind, Landmarks, Measures, Size, Template, Wearer};

const BODIES: u64 = 30;

/// What a tailor knows of a built-in body.
fn wearer(body: &ParametricBody) -> Wearer {
    let tape = body.measures();
    let joints = body.body().skeleton().joints();
    let landmarks = Landmarks::from_joints(|name| {
        let joint = joints.iter().find(|joint| joint.name == name)?;
        Some(joint.rest_position.coords.map(f64::from).into())
    })
    .unwrap();
    let measures = Measures {
        stature: tape[Measure::Stature],
        chest: tape[Measure::Chest],
        waist: tape[Measure::Waist],
        hip: tape[Measure::Hip],
        thigh: tape[Measure::Thigh],
        knee: tape[Measure::Knee],
        calf: tape[Measure::Calf],
        ankle: tape[Measure::Ankle],
        upper_arm: tape[Measure::UpperArm],
        forearm: tape[Measure::Forearm],
        wrist: tape[Measure::Wrist],
        neck: tape[Measure::Neck],
        shoulder_breadth: tape[Measure::ShoulderBreadth],
        arm_length: tape[Measure::ArmLength],
        inseam: tape[Measure::Inseam],
        shoulder_height: tape[Measure::ShoulderHeight],
        neck_height: landmarks.neck[1],
        chest_height: tape[Measure::ChestHeight],
        waist_height: tape[Measure::WaistHeight],
        hip_height: tape[Measure::HipHeight],
        knee_height: tape[Measure::KneeHeight],
    };
    Wearer {
        measures,
        landmarks,
    }
}

#[test]
fn garments_start_around_every_body_without_a_crossing() {
    let population = Population::new(11);
    let templates = GarmentKind::ALL.map(|kind| Template::new(kind, 2500).unwrap());
    let (mut made, mut sized) = (0, 0);
    for index in 0..BODIES {
        let body = ParametricBody::build(&population.sample(index)).unwrap();
        let wearer = wearer(&body);
        let skin = Surface::new(body.body().rest());
        let check = |template: &Template, cut: &Measures, what: &str| {
            let parameters = template.garment().parameters();
            let garment = template.sewn(&parameters, cut, &wearer).unwrap();
            let cloth = Surface::new(&garment.start_mesh());
            let what = format!("{what} {} on body {index}", template.garment());
            let crossings = cloth.intersections(&skin).len();
            assert_eq!(crossings, 0, "{what} crosses the body");
            let crossings = cloth.self_intersections().len();
            assert_eq!(crossings, 0, "{what} crosses itself");
        };
        for template in &templates {
            check(template, &wearer.measures, "made-to-measure");
            made += 1;
        }
        let tshirt = GarmentKind::Tshirt.parameters();
        for size in Size::ALL {
            let cut = size.measures();
            if tshirt.fit(&cut, &wearer.measures).fits() {
                check(&templates[0], &cut, size.name());
                sized += 1;
            }
        }
    }
    println!("{made} garments made to measure and {sized} T-shirts of a size");
    assert!(sized > BODIES);
}
