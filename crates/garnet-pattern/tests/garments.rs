//! What every garment promises, over parameters, sizes and vertex counts.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

use std::sync::LazyLock;

use garnet_mesh::{Topology, diagnose};
use garnet_pattern::{GarmentKind, PatternError, SewnGarment, Size, Template, Wearer};

const REFERENCE: Wearer = Wearer::reference();

static TEMPLATES: LazyLock<Vec<Template>> = LazyLock::new(|| {
    let template = |kind| Template::new(kind, 2500).unwrap();
    GarmentKind::ALL.map(template).into()
});

fn mean(template: &Template) -> SewnGarment {
    let parameters = template.garment().parameters();
    template.made_to_measure(&parameters, &REFERENCE).unwrap()
}

/// A generator of shares that is the same on every machine.
struct Shares(u64);

impl Shares {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1_u64 << 24) as f64
    }
}

fn side(flat: &[[f32; 2]; 3], from: usize) -> f64 {
    let [p, q] = [flat[from], flat[(from + 1) % 3]];
    f64::from(p[0] - q[0]).hypot(f64::from(p[1] - q[1]))
}

/// Ratio of the inscribed to the circumscribed circle's radius, doubled: 1 if equilateral.
fn quality(flat: &[[f32; 2]; 3]) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|corner| side(flat, corner));
    (b + c - a) * (c + a - b) * (a + b - c) / (a * b * c)
}

fn doubled_area(flat: &[[f32; 2]; 3]) -> f64 {
    let [a, b, c] = flat.map(|p| p.map(f64::from));
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[test]
fn vertex_counts_are_met_within_two_per_cent() {
    for kind in GarmentKind::ALL {
        for wanted in [1000, 2500, 5000, 10_000, 20_000] {
            let found = Template::new(kind, wanted).unwrap().num_vertices();
            let miss = found as f64 / wanted as f64 - 1.0;
            assert!(miss.abs() < 0.02, "{kind}: {found} instead of {wanted}");
        }
    }
    let refused = Template::new(GarmentKind::Jeans, 7);
    assert_eq!(refused.unwrap_err(), PatternError::VertexCount { asked: 7 });
}

#[test]
fn triangles_of_the_mean_pattern_are_well_shaped() {
    for (num_vertices, expected) in [(1000, 0.70), (2500, 0.72), (5000, 0.74), (10_000, 0.75)] {
        for kind in GarmentKind::ALL {
            let garment = mean(&Template::new(kind, num_vertices).unwrap());
            let mut qualities: Vec<f64> = garment.flat.iter().map(quality).collect();
            qualities.sort_by(f64::total_cmp);
            let low = qualities[qualities.len() / 100];
            assert!(low > expected, "{kind} {num_vertices}: 1 % quantile {low}");
            assert!(
                qualities[0] > 0.5,
                "{kind} {num_vertices}: least {}",
                qualities[0]
            );
            assert!(garment.flat.iter().all(|flat| doubled_area(flat) > 0.0));
        }
    }
}

#[test]
fn rims_are_those_of_the_garment_and_the_mesh_is_clean() {
    // Neck, cuffs and hem; neck, armholes and hem; waist and legs.
    for (template, rims) in TEMPLATES.iter().zip([4, 4, 4, 3]) {
        let garment = mean(template);
        let found = diagnose(&garment.start_mesh());
        assert!(found.is_clean(), "{}: {found:?}", template.garment());
        assert_eq!(found.boundary_loops.len(), rims, "{}", template.garment());
        assert_eq!(found.num_components, 1);
        let topology = Topology::new(garment.num_vertices(), &garment.faces);
        let on_rims: usize = found.boundary_loops.iter().map(Vec::len).sum();
        let named: std::collections::BTreeSet<u32> = garment
            .rims
            .iter()
            .flat_map(|rim| rim.vertices.iter().copied())
            .collect();
        assert_eq!(named.len(), on_rims);
        for vertex in 0..garment.num_vertices() {
            assert!(
                topology.vertex_faces(vertex).len() > 1,
                "vertex {vertex} has one face"
            );
        }
    }
}

#[test]
fn panels_cover_all_faces() {
    for template in TEMPLATES.iter() {
        let garment = mean(template);
        let mut next = 0;
        for panel in &garment.panels {
            assert_eq!(panel.faces.start, next, "{}", panel.name);
            next = panel.faces.end;
        }
        assert_eq!(next, garment.faces.len());
    }
}

#[test]
fn both_sides_of_a_seam_are_of_one_length() {
    for template in TEMPLATES.iter() {
        let garment = mean(template);
        for seam in &garment.seams {
            for pair in seam.vertices.windows(2) {
                let mut lengths = Vec::new();
                for (face, flat) in garment.faces.iter().zip(&garment.flat) {
                    for corner in 0..3 {
                        let ends = [face[corner], face[(corner + 1) % 3]];
                        if ends == [pair[0], pair[1]] || ends == [pair[1], pair[0]] {
                            lengths.push(side(flat, corner));
                        }
                    }
                }
                let &[a, b] = lengths.as_slice() else {
                    panic!("{}: {} faces at a seam", seam.name, lengths.len());
                };
                assert!((a / b - 1.0).abs() < 0.03, "{}: {a} and {b}", seam.name);
            }
        }
    }
}

#[test]
fn garments_are_mirror_images_of_themselves() {
    for template in TEMPLATES.iter() {
        let garment = mean(template);
        for (vertex, &other) in garment.mirror.iter().enumerate() {
            let (p, q) = (garment.start[vertex], garment.start[other as usize]);
            assert_eq!((p.x, p.y, p.z), (-q.x, q.y, q.z));
            assert_eq!(garment.mirror[other as usize] as usize, vertex);
        }
        let turned = |face: &[u32; 3]| {
            let mut face = face.map(|vertex| garment.mirror[vertex as usize]);
            face.sort_unstable();
            face
        };
        let mut mirrored: Vec<_> = garment.faces.iter().map(turned).collect();
        let mut faces: Vec<_> = garment.faces.clone();
        for face in &mut faces {
            face.sort_unstable();
        }
        faces.sort_unstable();
        mirrored.sort_unstable();
        assert_eq!(faces, mirrored);
    }
}

#[test]
fn random_parameters_and_sizes_fold_nothing() {
    let mut shares = Shares(7);
    for template in TEMPLATES.iter() {
        let kind = template.garment();
        let (mut made, mut refused) = (0, 0);
        for trial in 0..60 {
            let mut parameters = kind.parameters();
            for spec in kind.specs() {
                let [low, high] = spec.range;
                let value = low + shares.next() * (high - low);
                parameters.set(spec.name, value).unwrap();
            }
            let cut = Size::ALL[trial % Size::ALL.len()].measures();
            match template.sewn(&parameters, &cut, &REFERENCE) {
                Ok(garment) => {
                    made += 1;
                    assert_eq!(garment.faces, template.faces());
                    assert!(garment.flat.iter().all(|flat| doubled_area(flat) > 0.0));
                    assert!(
                        garment
                            .start
                            .iter()
                            .all(|p| p.coords.iter().all(|x| x.is_finite()))
                    );
                }
                Err(error @ (PatternError::Impossible { .. } | PatternError::Folded { .. })) => {
                    println!("{kind}: {error}");
                    refused += 1;
                }
                Err(error) => panic!("{kind}: {error}"),
            }
        }
        assert!(
            refused * 5 < made,
            "{kind}: {refused} of {} refused",
            made + refused
        );
    }
}

#[test]
fn each_parameter_alone_reaches_both_ends_of_its_range() {
    for template in TEMPLATES.iter() {
        let kind = template.garment();
        for spec in kind.specs() {
            for value in spec.range {
                let mut parameters = kind.parameters();
                parameters.set(spec.name, value).unwrap();
                let made = template.made_to_measure(&parameters, &REFERENCE);
                assert!(made.is_ok(), "{kind} {}: {}", spec.name, made.unwrap_err());
            }
        }
    }
}

#[test]
fn wrong_parameters_are_refused_by_name() {
    let mut tshirt = GarmentKind::Tshirt.parameters();
    let text = |result: Result<(), PatternError>| result.unwrap_err().to_string();
    assert!(text(tshirt.set("sleeve", f64::NAN)).starts_with("sleeve of `NaN cm`"));
    assert!(text(tshirt.set("inseam", 0.7)).contains("no parameter `inseam`"));
    let jeans = GarmentKind::Jeans.parameters();
    let refused = TEMPLATES[0].made_to_measure(&jeans, &REFERENCE);
    assert!(matches!(refused, Err(PatternError::WrongGarment { .. })));
    let mut nobody = REFERENCE;
    nobody.measures.waist = f64::NAN;
    let refused = TEMPLATES[0].made_to_measure(&tshirt, &nobody);
    assert!(matches!(
        refused,
        Err(PatternError::BadWearer { what: "waist", .. })
    ));
}

#[test]
fn the_same_template_twice_is_the_same() {
    let again = Template::new(GarmentKind::Tshirt, 2500).unwrap();
    assert_eq!(mean(&TEMPLATES[0]), mean(&again));
}
