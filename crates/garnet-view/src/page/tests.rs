//! Pages, read as `page/decode.js` reads them.

use std::io::Read;

use flate2::read::DeflateDecoder;
use garnet_mesh::{Point3, TriMesh};
use proptest::prelude::*;
use serde_json::Value;

use super::{Coloring, Page, PageMesh, PagePane, PagePart, pack::base64};
use crate::{ColorMap, ViewError, palette, shapes};

/// What a page says of its numbers, and the numbers.
struct Decoded {
    scene: Value,
    /// Corners of triangles `[topology]`.
    faces: Vec<Vec<[u32; 3]>>,
    /// `[mesh][frame][vertex]`.
    positions: Vec<Vec<Vec<[f64; 3]>>>,
    /// `[mesh][coloring][frame][vertex]`.
    values: Vec<Vec<Vec<Vec<f64>>>>,
}

fn element<'a>(html: &'a str, name: &str) -> &'a str {
    let (_, after) = html.split_once(&format!("id=\"{name}\">")).unwrap();
    after.split_once("</script>").unwrap().0
}

fn from_base64(text: &str) -> Vec<u8> {
    let digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut bytes = Vec::new();
    let (mut bits, mut count) = (0_u32, 0);
    for letter in text.trim_end_matches('=').chars() {
        bits = (bits << 6) | digits.find(letter).unwrap() as u32;
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    bytes
}

/// Takes blocks of bytes from the front.
struct Reader {
    bytes: Vec<u8>,
    at: usize,
}

impl Reader {
    fn planes(&mut self, num_planes: usize, count: usize) -> Vec<u32> {
        let block = &self.bytes[self.at..self.at + num_planes * count];
        self.at += num_planes * count;
        let code = |item: usize| {
            let byte = |plane: usize| u32::from(block[plane * count + item]) << (8 * plane);
            (0..num_planes).map(byte).sum()
        };
        (0..count).map(code).collect()
    }

    fn faces(&mut self, count: usize) -> Vec<[u32; 3]> {
        let mut faces = vec![[0_u32; 3]; count];
        for corner in 0..3 {
            let mut last = 0;
            for (face, code) in self.planes(4, count).into_iter().enumerate() {
                let before = if corner > 0 {
                    faces[face][corner - 1]
                } else {
                    last
                };
                last = before.wrapping_add_signed(signed(code));
                faces[face][corner] = last;
            }
        }
        faces
    }

    /// Codes `[frame][item][component]`.
    fn codes(&mut self, frames: usize, items: usize, components: usize) -> Vec<Vec<Vec<u16>>> {
        let mut all = vec![vec![vec![0_u16; components]; items]; frames];
        for (frame, component) in pairs(frames, components) {
            let mut off = 0_u16;
            for (item, code) in self.planes(2, items).into_iter().enumerate() {
                let before = |frames: usize| all[frame - frames][item][component];
                let guess = match frame {
                    0 => 0,
                    1 => before(1),
                    _ => before(1).wrapping_mul(2).wrapping_sub(before(2)),
                };
                off = off.wrapping_add_signed(signed(code) as i16);
                all[frame][item][component] = guess.wrapping_add(off);
            }
        }
        all
    }
}

/// Each of some numbers with each of others.
fn pairs(first: usize, second: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..first).flat_map(move |a| (0..second).map(move |b| (a, b)))
}

fn signed(code: u32) -> i32 {
    (code >> 1).cast_signed() ^ -((code & 1).cast_signed())
}

fn decoded(html: &str) -> Decoded {
    let scene: Value = serde_json::from_str(element(html, "scene")).unwrap();
    let packed = from_base64(element(html, "numbers"));
    let mut bytes = Vec::new();
    DeflateDecoder::new(&packed[..])
        .read_to_end(&mut bytes)
        .unwrap();
    let mut reader = Reader { bytes, at: 0 };
    let count = |value: &Value| value.as_u64().unwrap() as usize;
    let list = |value: &Value| value.as_array().unwrap().clone();
    let faces = list(&scene["topologies"])
        .into_iter()
        .map(|topology| reader.faces(count(&topology["faces"])));
    let faces = faces.collect();
    let (mut positions, mut values) = (Vec::new(), Vec::new());
    for mesh in list(&scene["meshes"]) {
        let (num_vertices, origins) = (count(&mesh["vertices"]), list(&mesh["origins"]));
        let codes = reader.codes(origins.len(), num_vertices, 3);
        let step = mesh["step"].as_f64().unwrap();
        let place = |(frame, vertices): (usize, Vec<Vec<u16>>)| {
            let origin = |axis: usize| origins[frame][axis].as_f64().unwrap();
            let point = |codes: Vec<u16>| [0, 1, 2].map(|k| origin(k) + step * f64::from(codes[k]));
            vertices.into_iter().map(point).collect::<Vec<_>>()
        };
        positions.push(codes.into_iter().enumerate().map(place).collect());
        let of_mesh = list(&mesh["values"]).into_iter().map(|found| {
            let codes = reader.codes(count(&found["frames"]), num_vertices, 1);
            let (low, step) = (
                found["low"].as_f64().unwrap(),
                found["step"].as_f64().unwrap(),
            );
            let value = |code: Vec<u16>| match code[0] {
                u16::MAX => f64::NAN,
                code => low + step * f64::from(code),
            };
            let frame = |frame: Vec<Vec<u16>>| frame.into_iter().map(value).collect::<Vec<_>>();
            codes.into_iter().map(frame).collect::<Vec<_>>()
        });
        values.push(of_mesh.collect());
    }
    assert_eq!(reader.at, reader.bytes.len(), "nothing is left over");
    Decoded {
        scene,
        faces,
        positions,
        values,
    }
}

fn pane(name: &str, meshes: &[usize]) -> PagePane {
    PagePane {
        name: name.to_owned(),
        meshes: meshes.to_vec(),
    }
}

fn garment(mesh: &TriMesh) -> PageMesh<'_> {
    PageMesh::new("cloth", PagePart::Garment, palette::GARMENT, mesh)
}

/// Half a step, and what adding in `f64` may lose.
fn is_within(found: f64, expected: f32, step: f64) -> bool {
    (found - f64::from(expected)).abs() <= 0.5 * step * (1.0 + 1e-6)
}

#[test]
fn a_page_gives_its_meshes_back_within_half_a_step() {
    let (sphere, square) = (shapes::sphere(12, 24), shapes::square(0.5));
    let moved = |by: f32| {
        sphere
            .positions()
            .iter()
            .map(|p| p * (1.0 + by) + nalgebra::Vector3::x() * (30.0 * by))
            .collect::<Vec<Point3>>()
    };
    let later = vec![moved(0.1), moved(0.3)];
    let page = Page {
        meshes: vec![
            PageMesh {
                later: later.clone(),
                ..garment(&sphere)
            },
            PageMesh::new("skin", PagePart::Body, palette::SKIN, &square),
            garment(&sphere),
        ],
        panes: vec![pane("one", &[0, 1]), pane("two", &[2, 1])],
        frames: ["a", "b", "c"].map(str::to_owned).to_vec(),
        fps: 24.0,
        ..Page::new("Three frames")
    };
    let found = decoded(&page.to_html().unwrap());
    assert_eq!(
        found.faces,
        [sphere.faces(), square.faces()],
        "each topology once"
    );
    assert_eq!(found.scene["meshes"][2]["topology"], 0);
    assert_eq!(found.scene["panes"][1]["meshes"], serde_json::json!([2, 1]));
    assert_eq!(found.scene["frames"], serde_json::json!(["a", "b", "c"]));
    let all = [
        vec![sphere.positions(), &later[0], &later[1]],
        vec![square.positions()],
        vec![sphere.positions()],
    ];
    for (mesh, frames) in all.into_iter().enumerate() {
        let step = found.scene["meshes"][mesh]["step"].as_f64().unwrap();
        assert!(
            step <= 2.61 / 65_535.0,
            "the way of a mesh costs no precision"
        );
        assert_eq!(found.positions[mesh].len(), frames.len());
        for (frame, positions) in frames.into_iter().enumerate() {
            assert_eq!(found.positions[mesh][frame].len(), positions.len());
            for (point, expected) in found.positions[mesh][frame].iter().zip(positions) {
                assert!((0..3).all(|axis| is_within(point[axis], expected[axis], step)));
            }
        }
    }
}

proptest! {
    #[test]
    fn any_positions_and_values_come_back(
        points in proptest::collection::vec([-1e4_f32..1e4, -1.0..1.0_f32, -1e-3..1e-3_f32], 3..40),
        seeds in proptest::collection::vec(any::<f32>(), 80),
    ) {
        let positions: Vec<Point3> = points.iter().copied().map(Point3::from).collect();
        let last = positions.len() as u32 - 1;
        let mesh = TriMesh::new(positions.clone(), vec![[0, 1, last], [last, last - 1, 0]]).unwrap();
        let values: Vec<Vec<f32>> = seeds.chunks(40).map(|frame| frame[..positions.len()].to_vec()).collect();
        let coloring = Coloring {
            label: "any".to_owned(),
            map: ColorMap::CoolWarm,
            range: None,
            values: values.clone(),
        };
        let page = Page {
            meshes: vec![PageMesh { later: vec![positions.clone()], colorings: vec![coloring], ..garment(&mesh) }],
            panes: vec![pane("", &[0])],
            frames: vec![String::new(); 2],
            ..Page::new("")
        };
        let found = decoded(&page.to_html().unwrap());
        let step = found.scene["meshes"][0]["step"].as_f64().unwrap();
        prop_assert_eq!(&found.faces[0], mesh.faces());
        prop_assert_eq!(&found.positions[0][0], &found.positions[0][1]);
        for (point, expected) in found.positions[0][0].iter().zip(&positions) {
            prop_assert!((0..3).all(|axis| is_within(point[axis], expected[axis], step)));
        }
        let step = found.scene["meshes"][0]["values"][0]["step"].as_f64().unwrap();
        for (found, expected) in found.values[0][0].iter().flatten().zip(values.iter().flatten()) {
            prop_assert!(found.is_nan() != expected.is_finite());
            prop_assert!(found.is_nan() || is_within(*found, *expected, step));
        }
    }
}

#[test]
fn base64_is_that_of_the_standard() {
    for (bytes, text) in [
        ("", ""),
        ("f", "Zg=="),
        ("fo", "Zm8="),
        ("foo", "Zm9v"),
        ("foobar", "Zm9vYmFy"),
    ] {
        assert_eq!(base64(bytes.as_bytes()), text);
        assert_eq!(from_base64(text), bytes.as_bytes());
    }
}

#[test]
fn meshes_under_one_label_share_a_bar() {
    let square = shapes::square(0.0);
    let coloring = |values: [f32; 4], range| Coloring {
        label: "strain (%)".to_owned(),
        map: ColorMap::Viridis,
        range,
        values: vec![values.to_vec()],
    };
    let page = |range| Page {
        meshes: vec![
            PageMesh {
                colorings: vec![coloring([1.0, 2.0, f32::NAN, 3.0], None)],
                ..garment(&square)
            },
            PageMesh {
                colorings: vec![coloring([-4.0, 0.0, 0.0, 0.0], range)],
                ..garment(&square)
            },
        ],
        panes: vec![pane("", &[0, 1])],
        ..Page::new("")
    };
    let ends = |range| {
        let scene = decoded(&page(range).to_html().unwrap()).scene;
        assert_eq!(scene["colorings"].as_array().unwrap().len(), 1);
        assert_eq!(scene["colorings"][0]["colors"][0], "#440154");
        ["low", "high"].map(|end| scene["colorings"][0][end].as_f64().unwrap())
    };
    assert_eq!(ends(None).map(f64::to_bits), [-4.0, 3.0].map(f64::to_bits));
    assert_eq!(
        ends(Some([-9.0, 9.0])).map(f64::to_bits),
        [-9.0, 9.0].map(f64::to_bits)
    );
}

#[test]
fn nothing_of_a_page_comes_from_elsewhere() {
    let square = shapes::square(0.0);
    let page = Page {
        meshes: vec![garment(&square)],
        panes: vec![pane("</script><b>&", &[0])],
        ..Page::new("<i>\"T-shirt\" & body</i>")
    };
    let html = page.to_html().unwrap();
    for word in [
        "http:",
        "https:",
        "//cdn",
        "@import",
        "url(",
        "src=",
        "fetch(",
        "XMLHttpRequest",
        "import(",
    ] {
        assert!(!html.contains(word), "`{word}`");
    }
    let links = html.matches("href=").count();
    assert_eq!(links, html.matches("href=\"data:,\"").count());
    assert!(html.contains("default-src 'none'"), "browsers hold it, too");
    assert!(html.contains("<title>&lt;i&gt;&quot;T-shirt&quot; &amp; body&lt;/i&gt;</title>"));
    assert_eq!(html.matches("</script>").count(), 3, "names end no element");
    assert!(!html.contains("{{"), "every field is filled");
    assert_eq!(decoded(&html).scene["panes"][0]["name"], "</script><b>&");
    assert!(html == page.to_html().unwrap(), "the same bytes again");
}

#[test]
fn what_does_not_fit_together_is_refused() {
    let square = shapes::square(0.0);
    let usual = || Page {
        meshes: vec![garment(&square)],
        panes: vec![pane("", &[0])],
        ..Page::new("")
    };
    let refused = |page: Page<'_>| page.to_html().unwrap_err();
    assert!(matches!(
        refused(Page {
            meshes: Vec::new(),
            ..usual()
        }),
        ViewError::NoLayers
    ));
    assert!(matches!(
        refused(Page {
            panes: Vec::new(),
            ..usual()
        }),
        ViewError::NoViews
    ));
    let page = Page {
        panes: vec![pane("", &[1])],
        ..usual()
    };
    assert_eq!(
        refused(page).to_string(),
        "pane 0 names mesh 1, but there are 1 meshes"
    );
    let mut page = usual();
    page.meshes[0].later = vec![square.positions().to_vec()];
    assert_eq!(
        refused(page).to_string(),
        "mesh 0 of the page has 2 frames, expected 1"
    );
    let coloring = |values, range| Coloring {
        label: "x".to_owned(),
        map: ColorMap::Viridis,
        range,
        values: vec![values],
    };
    let mut page = usual();
    page.meshes[0].colorings = vec![coloring(vec![0.0; 3], None)];
    assert_eq!(
        refused(page).to_string(),
        "mesh 0 of the page has 3 values in a frame, expected 4"
    );
    let mut page = usual();
    page.meshes[0].colorings = vec![coloring(vec![0.0; 4], Some([1.0, 1.0]))];
    assert!(matches!(refused(page), ViewError::ValueRange { .. }));
}
