//! Garments hung around bodies of the built-in population: nothing crosses.

use garnet::{
    body::shape::{ParametricBody, Population},
    data::wearer_of,
    io::ObjFile,
};
use garnet_knn::Surface;
use garnet_pattern::{GarmentKind, Measures, Size, Template, Wearer};

const BODIES: u64 = 30;

#[test]
fn garments_start_around_every_body_without_a_crossing() {
    let population = Population::new(11);
    let templates = GarmentKind::ALL.map(|kind| Template::new(kind, 2500).unwrap());
    let (mut made, mut sized) = (0, 0);
    for index in 0..BODIES {
        let body = ParametricBody::build(&population.sample(index)).unwrap();
        let wearer = wearer_of(body.body()).unwrap().unwrap();
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
                check(&templates[0], &cut, &size.to_string());
                sized += 1;
            }
        }
    }
    println!("{made} garments made to measure and {sized} T-shirts of a size");
    assert!(sized > BODIES);
}

#[test]
fn the_obj_of_a_pattern_reads_back_with_every_vertex_once() {
    for kind in GarmentKind::ALL {
        let template = Template::new(kind, 2500).unwrap();
        let parameters = template.garment().parameters();
        let garment = template.made_to_measure(&parameters, &Wearer::reference());
        let garment = garment.unwrap();
        let text = garment.obj(&garment.start);
        let file = ObjFile::parse(text.into_bytes(), "garment.obj").unwrap();
        assert_eq!(file.positions(), garment.start);
        assert_eq!(file.triangles(), garment.faces);
        assert_eq!(file.num_groups(), garment.panels.len());
        assert!(file.num_texture_vertices() >= garment.num_vertices());
    }
}
