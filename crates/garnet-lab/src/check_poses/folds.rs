//! Where posing turns skin over and lets it cross itself.

use std::collections::BTreeMap;

use garnet_body::poses::{
    Part, PoseSampler, Poser, SelfContact, SeparationOptions, key_poses, parts_of_vertices,
    skin_folds,
};
use garnet_body::shape::{BodyParameters, Measure, ParametricBody, Population};
use garnet_skin::{Body, Method, Pose, SkinError};

use crate::Outcome;

/// Sex, stature in metres and body mass index of the bodies that take the key poses.
const BODIES: [(f64, f64, f64); 4] = [
    (0.0, 1.76, 24.0),
    (1.0, 1.64, 22.0),
    (1.0, 1.62, 32.0),
    (0.0, 1.80, 34.0),
];

/// How many of the worst poses are named.
const NUM_WORST: usize = 12;

/// Where on the body a face lies: by the joint that is nearest at rest.
const REGIONS: [(&str, &[&str]); 5] = [
    ("shoulder", &["collar", "shoulder", "spine3"]),
    ("neck", &["neck", "head"]),
    ("elbow, hand", &["elbow", "wrist"]),
    ("hip", &["hip", "pelvis", "spine1", "spine2"]),
    ("knee, foot", &["knee", "ankle", "foot"]),
];

/// A body and what of it lies where.
struct Subject {
    body: Body,
    poser: Poser,
    contact: SelfContact,
    parts: Vec<Part>,
    region_of_face: Vec<usize>,
}

impl Subject {
    fn new(body: Body) -> Result<Self, Box<dyn std::error::Error>> {
        let joints = body.skeleton().joints();
        let region_of_face = body.rest().faces().iter().map(|corners| {
            let corners = corners.map(|corner| body.rest().positions()[corner as usize].coords);
            let middle = corners.iter().sum::<nalgebra::Vector3<f32>>() / 3.0;
            let nearest = joints.iter().min_by(|a, b| {
                let [a, b] = [a, b].map(|joint| (joint.rest_position.coords - middle).norm());
                a.total_cmp(&b)
            });
            let name = nearest.map_or("", |joint| joint.name.as_str());
            let named =
                |(_, joints): &(&str, &[&str])| joints.iter().any(|joint| name.ends_with(joint));
            REGIONS.iter().position(named).unwrap_or(0)
        });
        Ok(Self {
            region_of_face: region_of_face.collect(),
            poser: Poser::new(body.skeleton())?,
            contact: SelfContact::new(&body)?,
            parts: parts_of_vertices(&body)?,
            body,
        })
    }
}

/// What was found in many poses.
#[derive(Default)]
struct Tally {
    num_poses: usize,
    /// Per region: poses with turned faces, turned area in cm² of all poses.
    turned: [(usize, f64); REGIONS.len()],
    least_area_ratio: Vec<f64>,
    /// Crossing pairs of faces by the parts that they are on.
    crossings: BTreeMap<[Part; 2], (usize, usize)>,
    /// How deep upper arm and trunk are in each other, in mm, armpits included.
    arm_depths: Vec<f64>,
    /// Turned area at the shoulder in cm², crossing pairs there, name.
    worst: Vec<(f64, usize, String)>,
}

impl Tally {
    fn add(&mut self, subject: &Subject, pose: &Pose, name: String) -> Result<(), SkinError> {
        let body = &subject.body;
        let folds = skin_folds(body, pose)?;
        self.num_poses += 1;
        self.least_area_ratio.push(folds.least_area_ratio);
        let positions = body.rest().positions();
        let mut areas = [0.0; REGIONS.len()];
        for &face in &folds.turned {
            let [a, b, c] = body.rest().faces()[face as usize].map(|v| positions[v as usize]);
            let area = 0.5 * f64::from((b - a).cross(&(c - a)).norm());
            areas[subject.region_of_face[face as usize]] += 1e4 * area;
        }
        for (sum, area) in self.turned.iter_mut().zip(areas) {
            sum.0 += usize::from(area > 0.0);
            sum.1 += area;
        }
        let posed = body.posed_positions(pose, Method::DualQuaternion)?;
        let skin = body.skin().moved(posed)?;
        let mut at_shoulder = 0;
        let mut counts: BTreeMap<[Part; 2], usize> = BTreeMap::new();
        for pair in skin.self_intersections() {
            let mut parts = pair.map(|face| {
                let corner = body.rest().faces()[face as usize][0];
                subject.parts[corner as usize]
            });
            parts.sort_unstable();
            *counts.entry(parts).or_default() += 1;
            at_shoulder += usize::from(
                pair.iter()
                    .all(|&face| subject.region_of_face[face as usize] <= 1),
            );
        }
        for (parts, count) in counts {
            let sum = self.crossings.entry(parts).or_default();
            sum.0 += 1;
            sum.1 += count;
        }
        self.worst.push((areas[0], at_shoulder, name));
        let contacts = subject.contact.report(pose)?.contacts;
        let of_arm = contacts.iter().filter(|contact| {
            let parts = contact.parts;
            parts.contains(&Part::Trunk) && parts.iter().any(|p| matches!(p, Part::UpperArm(_)))
        });
        let depth = of_arm.map(|contact| contact.depth).fold(0.0, f32::max);
        self.arm_depths.push(1e3 * f64::from(depth));
        Ok(())
    }

    fn print(mut self, title: &str) {
        println!("{title}: {} poses", self.num_poses);
        println!("  turned over, by the nearest joint: poses, mean area of all poses");
        for ((name, _), (count, area)) in REGIONS.iter().zip(self.turned) {
            let mean = area / self.num_poses as f64;
            println!("    {name:<12} {count:>4}  {mean:>7.2} cm²");
        }
        self.least_area_ratio.sort_by(f64::total_cmp);
        let median = self.least_area_ratio[self.num_poses / 2];
        println!(
            "  smallest area of a face, median over poses: {:.1} % of rest",
            100.0 * median
        );
        self.arm_depths.sort_by(f64::total_cmp);
        let [median, p95, most] =
            [50, 95, 100].map(|percent| self.arm_depths[(self.num_poses - 1) * percent / 100]);
        println!(
            "  upper arm and trunk in each other: median {median:.0}, p95 {p95:.0}, most {most:.0} mm"
        );
        println!("  crossing pairs of faces by part: poses, pairs of all poses");
        for (parts, (poses, pairs)) in &self.crossings {
            println!("    {:<40} {poses:>4} {pairs:>6}", format!("{parts:?}"));
        }
        let total: usize = self.worst.iter().map(|(_, pairs, _)| pairs).sum();
        let poses = self.worst.iter().filter(|(_, pairs, _)| *pairs > 0).count();
        println!(
            "  crossing pairs between shoulder, neck and head: {poses} poses, {total} pairs; the worst:"
        );
        self.worst
            .sort_by(|a, b| (b.1, b.0).partial_cmp(&(a.1, a.0)).expect("numbers"));
        for (area, pairs, name) in self.worst.iter().take(NUM_WORST) {
            println!("    {area:>7.2} cm² {pairs:>5} pairs  {name}");
        }
    }
}

/// Folds over drawn poses, and over the key poses on four bodies.
pub(crate) fn folds(num_poses: u64, poses_per_body: u64, seed: u64) -> Outcome {
    let mut tally = Tally::default();
    for (sex, stature, bmi) in BODIES {
        let parameters = BodyParameters::new(sex)
            .with(Measure::Stature, stature)
            .with_bmi(bmi);
        let subject = Subject::new(ParametricBody::build(&parameters)?.into_body())?;
        for key in key_poses() {
            let pose = subject.poser.pose(&key.angles);
            let separated = subject
                .contact
                .separated(&pose, &SeparationOptions::default())?;
            let (pose, mark) = match separated {
                Some(separated) => (separated.pose, ""),
                None => (pose, " (rejected)"),
            };
            let name = format!("{} sex {sex:.0} bmi {bmi:.0}{mark}", key.name);
            tally.add(&subject, &pose, name)?;
        }
    }
    tally.print("key poses");
    let mut tally = Tally::default();
    let (population, sampler) = (Population::new(seed), PoseSampler::new(seed));
    for number in 0..num_poses.div_ceil(poses_per_body) {
        let Ok(built) = ParametricBody::build(&population.sample(number)) else {
            continue;
        };
        let subject = Subject::new(built.into_body())?;
        for index in number * poses_per_body..(number + 1) * poses_per_body {
            let sound = sampler.sample_for(&subject.poser, &subject.contact, index)?;
            let name = format!("body {number} pose {index} {}", sound.sequence);
            tally.add(&subject, &sound.pose, name)?;
        }
    }
    tally.print("drawn poses");
    Ok(())
}
