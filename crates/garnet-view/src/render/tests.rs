//! Pictures as a whole.

use std::f32::consts::PI;

use garnet_mesh::{MAX_COORDINATE, Point3, TriMesh};
use proptest::prelude::*;

use super::render;
use crate::{
    BackSide, Camera, ColorMap, FaceMaterials, Heat, Image, Layer, Material, Paint, Picture,
    Projection, Rgb, Shading, Texture, View, ViewError, palette, shapes,
};

const RED: Rgb = Rgb::new(200, 30, 30);
const BLUE: Rgb = Rgb::new(30, 30, 200);

fn painted(mesh: &TriMesh, color: Rgb) -> Layer<'_> {
    Layer {
        paint: Paint::Plain(color),
        ..Layer::new(mesh)
    }
}

fn picture(layers: Vec<Layer<'_>>, camera: Camera) -> Picture<'_> {
    Picture {
        layers,
        views: vec![View::new(camera)],
        ..Picture::new(64, 64)
    }
}

fn center(image: &Image) -> Rgb {
    image.pixel(image.width() / 2, image.height() / 2).unwrap()
}

/// How much of the picture is not background, in pixels.
fn covered(image: &Image) -> usize {
    let background = palette::BACKGROUND.channels();
    let pixels = image.pixels().chunks_exact(3);
    pixels.filter(|pixel| **pixel != background).count()
}

#[test]
fn the_silhouette_of_a_sphere_is_a_disk() {
    const AREA_TOLERANCE: f64 = 0.01;
    let sphere = shapes::sphere(48, 96);
    let size = 400;
    // With one sample a pixel, a pixel is covered if its center is.
    let picture = Picture {
        supersampling: 1,
        layers: vec![Layer::new(&sphere)],
        ..Picture::new(size, size)
    };
    let radius = 0.5 * f64::from(size) * (1.0 - 2.0 * crate::lens::MARGIN);
    let expected = std::f64::consts::PI * radius * radius;
    let found = covered(&render(&picture).unwrap()) as f64;
    let error = (found / expected - 1.0).abs();
    assert!(error < AREA_TOLERANCE, "{found} of {expected}");
}

#[test]
fn the_nearer_surface_hides_the_farther_from_either_side() {
    let (near, far) = (shapes::square(0.5), shapes::square(-0.5));
    for projection in [
        Projection::Orthographic,
        Projection::Perspective { field_of_view: 0.7 },
    ] {
        for (camera, is_red) in [(Camera::front(), true), (Camera::back(), false)] {
            let camera = Camera {
                projection,
                ..camera
            };
            for flip in [false, true] {
                let mut layers = vec![painted(&near, RED), painted(&far, BLUE)];
                if flip {
                    layers.reverse();
                }
                let color = center(&render(&picture(layers, camera)).unwrap());
                assert_eq!(color.red > color.blue, is_red, "{color:?} {camera:?}");
            }
        }
    }
}

#[test]
fn the_left_of_a_body_is_seen_from_the_left() {
    let marked = shapes::sphere(12, 24);
    let values: Vec<f32> = marked.positions().iter().map(|point| point.x).collect();
    let heat = Heat {
        map: ColorMap::CoolWarm,
        ..Heat::new(&values, "x")
    };
    let layer = || Layer {
        paint: Paint::Heat(heat.clone()),
        ..Layer::new(&marked)
    };
    let left = center(&render(&picture(vec![layer()], Camera::left())).unwrap());
    let right = center(&render(&picture(vec![layer()], Camera::right())).unwrap());
    assert!(left.red > left.blue && right.blue > right.red);
}

#[test]
fn back_sides_look_as_they_are_told() {
    let square = shapes::square(0.0);
    let seen = |back, camera| {
        let layer = Layer {
            back,
            ..painted(&square, RED)
        };
        center(&render(&picture(vec![layer], camera)).unwrap())
    };
    let front = seen(BackSide::Darker, Camera::front());
    assert!(seen(BackSide::Darker, Camera::back()).red < front.red);
    assert_eq!(seen(BackSide::Same, Camera::back()), front);
    let blue = seen(BackSide::Plain(BLUE), Camera::back());
    assert!(blue.blue > blue.red);
    assert_eq!(seen(BackSide::Hidden, Camera::back()), palette::BACKGROUND);
    assert_eq!(seen(BackSide::Hidden, Camera::front()), front);
}

#[test]
fn one_looks_through_a_layer_that_is_not_opaque() {
    let (near, far) = (shapes::square(0.5), shapes::square(-0.5));
    let seen = |opacity| {
        let glass = Layer {
            opacity,
            ..painted(&near, RED)
        };
        let layers = vec![glass, painted(&far, BLUE)];
        center(&render(&picture(layers, Camera::front())).unwrap())
    };
    assert!(seen(0.0).blue > seen(0.5).blue && seen(0.5).blue > seen(1.0).blue);
    assert!(seen(0.0).red < seen(0.5).red && seen(0.5).red < seen(1.0).red);
    assert_eq!(seen(f32::NAN), seen(1.0));
}

#[test]
fn what_is_no_number_is_magenta() {
    let square = shapes::square(0.0);
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let values = [0.0, value, 1.0, value];
        let layer = Layer {
            paint: Paint::Heat(Heat::new(&values, "")),
            ..Layer::new(&square)
        };
        let color = center(&render(&picture(vec![layer], Camera::front())).unwrap());
        let (strong, weak) = (color.red.min(color.blue), color.green);
        assert!(strong > 150 && weak == 0, "{color:?}");
    }
}

#[test]
fn the_number_of_threads_does_not_show() {
    let sphere = shapes::sphere(16, 32);
    let values: Vec<f32> = sphere.positions().iter().map(|point| point.y).collect();
    let square = shapes::square(0.2);
    let heat = Layer {
        paint: Paint::Heat(Heat::new(&values, "height (m)")),
        wireframe: Some(palette::WIRE),
        shading: Shading::Flat,
        ..Layer::new(&sphere)
    };
    let glass = Layer {
        opacity: 0.4,
        ..painted(&square, RED)
    };
    let picture = Picture {
        layers: vec![heat, glass],
        views: vec![View::new(Camera::three_quarter()), View::new(Camera::top())],
        ..Picture::new(240, 120)
    };
    let with_threads = |num_threads| {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(num_threads);
        builder
            .build()
            .unwrap()
            .install(|| render(&picture).unwrap())
    };
    let one = with_threads(1);
    assert!(with_threads(2) == one && with_threads(5) == one);
}

#[test]
fn a_crease_is_darker_than_a_plane() {
    let folded = |height: f32| {
        let corners = [[-1.0, height], [0.0, 0.0], [1.0, height]];
        let positions = corners
            .iter()
            .flat_map(|&[x, z]| [Point3::new(x, -1.0, z), Point3::new(x, 1.0, z)]);
        let faces = vec![[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]];
        let mesh = TriMesh::new(positions.collect(), faces).unwrap();
        center(&render(&picture(vec![Layer::new(&mesh)], Camera::front())).unwrap())
    };
    assert!(folded(1.0).red < folded(0.0).red);
}

#[test]
fn what_cannot_be_drawn_is_named() {
    let square = shapes::square(0.0);
    let good = || picture(vec![Layer::new(&square)], Camera::front());
    let error = |picture: Picture<'_>| render(&picture).unwrap_err();
    for (width, height) in [(0, 5), (5, 0), (16_385, 5), (5, u32::MAX)] {
        let picture = Picture {
            width,
            height,
            ..good()
        };
        assert!(matches!(error(picture), ViewError::PictureSize { .. }));
    }
    let no_layers = picture(Vec::new(), Camera::front());
    assert!(matches!(error(no_layers), ViewError::NoLayers));
    let no_views = Picture {
        views: Vec::new(),
        ..good()
    };
    assert!(matches!(error(no_views), ViewError::NoViews));
    let crowded = Picture {
        views: vec![View::new(Camera::front()); 65],
        ..good()
    };
    assert!(matches!(error(crowded), ViewError::NoRoom { .. }));
    let mut astray = good();
    astray.views[0].shown = Some(vec![1]);
    assert!(matches!(
        error(astray),
        ViewError::LayerIndexOutOfRange { index: 1, .. }
    ));
    let sideways = picture(vec![Layer::new(&square)], Camera::new(f32::NAN, 0.0));
    assert!(matches!(error(sideways), ViewError::Camera { .. }));
    let heat = |values, range| {
        let heat = Heat {
            range,
            ..Heat::new(values, "")
        };
        let paint = Paint::Heat(heat);
        let mesh = &square;
        let layer = Layer {
            paint,
            ..Layer::new(mesh)
        };
        error(picture(vec![layer], Camera::front()))
    };
    assert!(matches!(
        heat(&[0.0; 3], None),
        ViewError::ValueCount { expected: 4, .. }
    ));
    assert!(matches!(
        heat(&[0.0; 4], Some([1.0, 1.0])),
        ViewError::ValueRange { .. }
    ));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn any_size_camera_and_mesh_gives_a_picture_or_an_error(
        size in (0_u32..90, 0_u32..90, 0_u32..5),
        angles in (-9.0_f32..9.0, -9.0_f32..9.0, 0.0_f32..PI),
        zoom in 0.0_f32..50.0,
        exponents in prop::collection::vec(-45_i32..39, 9),
        num_views in 1_usize..6,
        columns in 0_u32..4,
    ) {
        let numbers: Vec<f32> =
            exponents.iter().enumerate().map(|(index, &exponent)| {
                let sign = if index % 2 == 0 { 1.0 } else { -1.0 };
                sign * 10.0_f32.powi(exponent)
            }).collect();
        let in_range = |value: f32| value.clamp(-MAX_COORDINATE, MAX_COORDINATE);
        let positions = numbers.chunks(3).map(|p| Point3::from_slice(p).map(in_range)).collect();
        let mesh = TriMesh::new(positions, vec![[0, 1, 2], [2, 1, 1]]);
        let mesh = mesh.unwrap();
        let small = shapes::sphere(4, 5);
        let projection = Projection::Perspective { field_of_view: angles.2 };
        let camera = Camera { projection, zoom, ..Camera::new(angles.0, angles.1) };
        let mut views = vec![View::new(camera); num_views];
        // The other mesh may lie around and behind this camera.
        views[0].framed = Some(vec![1]);
        views[0].caption = "äöü".to_owned();
        views[num_views - 1].framed = Some(Vec::new());
        let heat = Layer {
            paint: Paint::Heat(Heat::new(&numbers[..3], "label")),
            wireframe: Some(RED),
            ..Layer::new(&mesh)
        };
        let picture = Picture {
            views,
            columns: Some(columns),
            supersampling: size.2,
            layers: vec![heat, Layer { opacity: 0.5, ..Layer::new(&small) }],
            ..Picture::new(size.0, size.1)
        };
        if let Ok(image) = render(&picture) {
            prop_assert_eq!(image.pixels().len(), 3 * (size.0 * size.1) as usize);
        }
    }
}

#[test]
fn a_texture_lies_as_its_coordinates_say() {
    let halves = Picture::new(2, 1);
    let mut picture_of = vec![0; 6];
    picture_of[..3].copy_from_slice(&RED.channels());
    picture_of[3..].copy_from_slice(&BLUE.channels());
    let mut png = Vec::new();
    image::ImageEncoder::write_image(
        image::codecs::png::PngEncoder::new(&mut png),
        &picture_of,
        halves.width,
        halves.height,
        image::ExtendedColorType::Rgb8,
    )
    .unwrap();
    let square = shapes::square(0.0);
    let of_vertex = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let corners = square.faces().iter();
    let corners = corners.map(|face| face.map(|vertex| of_vertex[vertex as usize]));
    let mut materials = FaceMaterials {
        materials: vec![Material {
            color: Rgb::new(255, 255, 255),
            texture: Some(Texture::decode(&png).unwrap()),
        }],
        of_face: vec![0; 2],
        corners: corners.collect(),
    };
    let drawn = |materials: &FaceMaterials| {
        let layer = Layer {
            paint: Paint::Materials(materials),
            ..Layer::new(&square)
        };
        render(&picture(vec![layer], Camera::front()))
    };
    let image = drawn(&materials).unwrap();
    let [left, right] = [20, 44].map(|x| image.pixel(x, 32).unwrap());
    assert!(left.red > 2 * left.blue, "{left:?}");
    assert!(right.blue > 2 * right.red, "{right:?}");
    materials.of_face[1] = 1;
    let refused = drawn(&materials).unwrap_err();
    assert!(
        matches!(refused, ViewError::FaceMaterials { layer: 0, .. }),
        "{refused}"
    );
}
