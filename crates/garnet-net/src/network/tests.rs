use burn::tensor::Device;
use garnet_mesh::primitives::{icosphere, tube};
use garnet_mesh::{Point3, TriMesh, Vector3, vertex_normals};
use nalgebra::{Isometry3, UnitQuaternion};

use crate::{
    BodySampling, Frame, GarNet, GarNetConfig, GarmentGraph, NetError, PRESET_NAMES, PoolingConfig,
    Predictor, Scene, SceneInput, Variant,
};

/// A garment over a body, with all that networks may ask for.
struct Stage {
    template: TriMesh,
    warped: Vec<Point3>,
    body: TriMesh,
    rotations: Vec<UnitQuaternion<f32>>,
    parameters: Vec<f32>,
    world_from_root: Isometry3<f32>,
}

impl Stage {
    fn new() -> Self {
        let template = tube(0.2, 0.4, 14, 9);
        let turn = |place: &Point3| UnitQuaternion::from_euler_angles(0.2, place.y, 0.1);
        let rotations: Vec<_> = template.positions().iter().map(turn).collect();
        let warped = template.positions().iter().zip(&rotations);
        Self {
            warped: warped.map(|(place, turn)| turn * place * 1.1).collect(),
            body: lumpy(&icosphere(3, 0.19)),
            rotations,
            parameters: vec![0.3, -0.2, 0.9],
            world_from_root: Isometry3::new(
                Vector3::new(0.1, 0.9, 0.2),
                Vector3::new(0.1, 0.4, 0.0),
            ),
            template,
        }
    }

    fn draped(&self, config: &GarNetConfig) -> Vec<Point3> {
        let garment = GarmentGraph::new(&self.template, &[]).unwrap();
        self.draped_by(awake(&garment.configured(config.clone())))
    }

    fn draped_by(&self, model: GarNet) -> Vec<Point3> {
        let garment = GarmentGraph::new(&self.template, &[]).unwrap();
        let pooling = &model.config().pooling;
        let sampling = BodySampling::new(self.body.positions(), None, pooling).unwrap();
        let predictor = Predictor::new(model, garment, sampling).unwrap();
        let normals = vertex_normals(self.body.positions(), self.body.faces());
        predictor.predict(&self.input(&normals)).unwrap()
    }

    fn input<'a>(&'a self, normals: &'a [Vector3]) -> SceneInput<'a> {
        SceneInput {
            warped: &self.warped,
            body: self.body.positions(),
            body_normals: normals,
            world_from_root: self.world_from_root,
            rotations: &self.rotations,
            parameters: &self.parameters,
        }
    }
}

/// A body without symmetry: on a regular one several points are equally near, and which of them
/// counts is decided by their order or by rounding.
fn lumpy(body: &TriMesh) -> TriMesh {
    let lump = |place: &Point3| {
        let wave = (40.0 * place.x).sin() * (31.0 * place.y + 0.3).sin() + (23.0 * place.z).cos();
        place * (1.0 + 0.03 * wave)
    };
    body.with_positions(body.positions().iter().map(lump).collect())
        .unwrap()
}

/// A network whose last layer is not silent.
fn awake(config: &GarNetConfig) -> GarNet {
    awake_on(config, &Device::flex())
}

fn awake_on(config: &GarNetConfig, device: &Device) -> GarNet {
    let mut net = config.init(5, device).unwrap();
    net.fusion = net.fusion.awake(&mut super::WeightSource::new(6, device));
    net
}

fn variants() -> Vec<GarNetConfig> {
    let tiny = GarNetConfig::preset("tiny").unwrap();
    let mut root = tiny.clone();
    root.frame = Frame::Root;
    root.garment.inputs.clear();
    root.body.normals = false;
    vec![
        tiny.clone().with_variant(Variant::Naive, 0),
        tiny.clone().with_variant(Variant::Global, 0),
        tiny.clone().with_variant(Variant::GlobalParams, 3),
        tiny.clone(),
        root,
        tiny.with_variant(Variant::LocalParams, 3),
    ]
}

fn greatest_distance(a: &[Point3], b: &[Point3]) -> f32 {
    assert_eq!(a.len(), b.len());
    let distances = a.iter().zip(b).map(|(a, b)| (a - b).norm());
    distances.fold(0.0, f32::max)
}

#[test]
fn an_untrained_network_leaves_the_warp() {
    let stage = Stage::new();
    for config in variants() {
        let garment = GarmentGraph::new(&stage.template, &[]).unwrap();
        let model = garment
            .configured(config.clone())
            .init(1, &Device::flex())
            .unwrap();
        let sampling = BodySampling::new(stage.body.positions(), None, &config.pooling).unwrap();
        let predictor = Predictor::new(model, garment, sampling).unwrap();
        let normals = vertex_normals(stage.body.positions(), stage.body.faces());
        let draped = predictor.predict(&stage.input(&normals)).unwrap();
        assert!(greatest_distance(&draped, &stage.warped) < 1e-6);
    }
}

#[test]
fn tensors_and_slices_give_the_same() {
    let stage = Stage::new();
    let device = Device::flex();
    for config in variants() {
        let garment = GarmentGraph::new(&stage.template, &[]).unwrap();
        let config = garment.configured(config);
        let model = awake(&config);
        let sampling = BodySampling::new(stage.body.positions(), None, &config.pooling).unwrap();
        let normals = vertex_normals(stage.body.positions(), stage.body.faces());
        let scene = Scene::new(&config, &garment, &sampling, &stage.input(&normals)).unwrap();
        let by_tensors = model.forward(&garment, &sampling, &scene, &device);
        let by_tensors = crate::ops::numbers(by_tensors);
        let mut predictor = Predictor::new(model, garment, sampling).unwrap();
        predictor.prepare(&stage.input(&normals)).unwrap();
        for _ in 0..2 {
            assert_eq!(predictor.translations(), by_tensors, "{:?}", config.variant);
        }
        assert!(by_tensors.iter().any(|value| value.abs() > 1e-3));
    }
}

#[test]
fn a_scene_of_known_neighbors_is_the_same() {
    let stage = Stage::new();
    let normals = vertex_normals(stage.body.positions(), stage.body.faces());
    let input = stage.input(&normals);
    for config in variants() {
        let garment = GarmentGraph::new(&stage.template, &[]).unwrap();
        let rest = stage.body.positions();
        let sampling = BodySampling::new(rest, None, &config.pooling).unwrap();
        let scene = Scene::new(&config, &garment, &sampling, &input).unwrap();
        let known = scene.neighbors().unwrap();
        let again = Scene::of_neighbors(&config, &garment, &sampling, &input, &known).unwrap();
        assert_eq!(format!("{scene:?}"), format!("{again:?}"));
        if config.has_local_pooling() {
            let other = GarNetConfig {
                pooling: PoolingConfig {
                    neighbors: 3,
                    ..config.pooling.clone()
                },
                ..config.clone()
            };
            let wrong = Scene::of_neighbors(&other, &garment, &sampling, &input, &known);
            assert!(matches!(wrong, Err(NetError::Count { .. })));
        }
    }
}

#[test]
fn the_order_of_body_points_does_not_count() {
    let mut stage = Stage::new();
    let before: Vec<_> = variants()
        .iter()
        .map(|config| stage.draped(config))
        .collect();
    let count = stage.body.num_vertices() as u32;
    let moved = |vertex: u32| (vertex * 11 + 3) % count; // 11 has no common factor with 642.
    let mut positions = stage.body.positions().to_vec();
    for (vertex, place) in (0..count).zip(stage.body.positions()) {
        positions[moved(vertex) as usize] = *place;
    }
    let faces = stage
        .body
        .faces()
        .iter()
        .map(|face| face.map(moved))
        .collect();
    stage.body = TriMesh::new(positions, faces).unwrap();
    for (config, before) in variants().iter().zip(before) {
        assert!(greatest_distance(&stage.draped(config), &before) < 1e-4);
    }
}

#[test]
fn the_order_of_garment_vertices_moves_with_the_result() {
    let mut stage = Stage::new();
    let before: Vec<_> = variants()
        .iter()
        .map(|config| stage.draped(config))
        .collect();
    let count = stage.template.num_vertices() as u32;
    let moved = |vertex: u32| (vertex * 9 + 4) % count; // 9 has no common factor with 140.
    let permuted = |points: &[Point3]| {
        let mut places = points.to_vec();
        for (vertex, place) in (0..count).zip(points) {
            places[moved(vertex) as usize] = *place;
        }
        places
    };
    let faces = stage
        .template
        .faces()
        .iter()
        .map(|face| face.map(moved))
        .collect();
    stage.template = TriMesh::new(permuted(stage.template.positions()), faces).unwrap();
    stage.warped = permuted(&stage.warped);
    let mut rotations = stage.rotations.clone();
    for (vertex, turn) in (0..count).zip(&stage.rotations) {
        rotations[moved(vertex) as usize] = *turn;
    }
    stage.rotations = rotations;
    for (config, before) in variants().iter().zip(before) {
        assert!(greatest_distance(&stage.draped(config), &permuted(&before)) < 1e-4);
    }
}

#[test]
fn a_scene_may_lie_anywhere_and_look_anywhere() {
    let mut stage = Stage::new();
    let before: Vec<_> = variants()
        .iter()
        .map(|config| stage.draped(config))
        .collect();
    // Down stays down. By some other angles rounding chooses another of two points that are equally
    // near.
    let moved = Isometry3::new(Vector3::new(1.0, -2.0, 0.5), Vector3::new(0.0, 2.0, 0.0));
    stage.warped = stage.warped.iter().map(|place| moved * place).collect();
    let body = stage.body.positions().iter().map(|place| moved * place);
    stage.body = stage.body.with_positions(body.collect()).unwrap();
    stage.rotations = stage
        .rotations
        .iter()
        .map(|turn| moved.rotation * turn)
        .collect();
    stage.world_from_root = moved * stage.world_from_root;
    for (config, before) in variants().iter().zip(before) {
        let expected: Vec<Point3> = before.iter().map(|place| moved * place).collect();
        let found = greatest_distance(&stage.draped(config), &expected);
        assert!(found < 1e-3, "{:?}: {found}", config.variant);
    }
}

#[test]
fn a_body_may_have_fewer_points_than_neighbors() {
    let mut stage = Stage::new();
    stage.body = garnet_mesh::primitives::cuboid([0.2, 0.3, 0.2]);
    for config in variants() {
        assert_eq!(stage.draped(&config).len(), stage.warped.len());
    }
}

#[test]
fn lonely_vertices_are_draped_too() {
    let mut stage = Stage::new();
    let mut positions = stage.template.positions().to_vec();
    positions.push(Point3::new(0.3, 0.3, 0.3));
    stage.template = TriMesh::new(positions, stage.template.faces().to_vec()).unwrap();
    stage.warped.push(Point3::new(0.4, 0.3, 0.3));
    stage.rotations.push(UnitQuaternion::identity());
    for config in variants() {
        assert_eq!(stage.draped(&config).len(), 141);
    }
}

#[test]
fn sides_of_a_seam_stay_together() {
    let mut stage = Stage::new();
    // A copy of every vertex, used by every other face.
    let count = stage.template.num_vertices() as u32;
    let mut positions = stage.template.positions().to_vec();
    positions.extend_from_within(..);
    let faces = stage.template.faces().iter().enumerate();
    let faces = faces.map(|(number, face)| face.map(|vertex| vertex + count * (number as u32 % 2)));
    stage.template = TriMesh::new(positions, faces.collect()).unwrap();
    stage.warped.extend_from_within(..);
    stage.rotations.extend_from_within(..);
    for config in variants() {
        let draped = stage.draped(&config);
        let (left, right) = draped.split_at(count as usize);
        assert_eq!(left, right);
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let stage = Stage::new();
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(count)
            .build()
            .unwrap();
        pool.install(|| {
            variants()
                .iter()
                .map(|config| stage.draped(config))
                .collect::<Vec<_>>()
        })
    };
    assert_eq!(with_threads(1), with_threads(2));
}

#[test]
fn wrong_scenes_are_refused() {
    let stage = Stage::new();
    let config = GarNetConfig::preset("tiny").unwrap();
    let garment = GarmentGraph::new(&stage.template, &[]).unwrap();
    let sampling = BodySampling::new(stage.body.positions(), None, &config.pooling).unwrap();
    let normals = vertex_normals(stage.body.positions(), stage.body.faces());
    let input = stage.input(&normals);
    let refused = |input: &SceneInput<'_>| {
        Scene::new(&config, &garment, &sampling, input)
            .unwrap_err()
            .to_string()
    };
    let short = SceneInput {
        warped: &stage.warped[1..],
        ..input
    };
    assert_eq!(refused(&short), "garment vertices: 139 given, 140 expected");
    let without = SceneInput {
        body_normals: &[],
        ..input
    };
    assert!(refused(&without).contains("normals of the body are missing"));
    let without = SceneInput {
        rotations: &[],
        ..input
    };
    assert!(refused(&without).contains("skinning rotations are missing"));
    let mut stray = stage.warped.clone();
    stray[17].z = f32::NAN;
    let stray = SceneInput {
        warped: &stray,
        ..input
    };
    assert_eq!(
        refused(&stray),
        "garment vertex 17 is not finite or out of range"
    );
}

#[test]
fn presets_can_be_made_and_counted() {
    for name in PRESET_NAMES {
        let config = GarNetConfig::preset(name).unwrap();
        config.validate().unwrap();
        let text = serde_json::to_string(&config).unwrap();
        assert_eq!(serde_json::from_str::<GarNetConfig>(&text).unwrap(), config);
    }
    let flops = |name: &str, num_vertices| {
        let config = GarNetConfig::preset(name).unwrap();
        config.cost(num_vertices, 6890).unwrap().flops as f64 / 1e9
    };
    let sizes = [
        flops("paper", 10_000),
        flops("small", 10_000),
        flops("light", 5_000),
    ];
    assert!((30.0..45.0).contains(&sizes[0]), "{sizes:?}");
    assert!(sizes[1] < 5.0 && sizes[2] < 1.5, "{sizes:?}");
}
