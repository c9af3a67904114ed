//! One garment over one body, as the network sees it.

use std::sync::Arc;

use garnet_kernel::NeighborTable;
use garnet_knn::VertexTree;
use garnet_mesh::{MAX_COORDINATE, Point3, Vector3};
use nalgebra::{Matrix3, UnitQuaternion};

use crate::{
    BodySampling, Frame, GarNetConfig, GarmentGraph, InputScaling, NetError, ReferenceCase,
    SceneInput, UNIT, VertexInput,
};

/// The arrays of a scene, in the root frame and in units of 0.1 m.
///
/// Buffers are kept between scenes.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// Vertices `[vertex][3]`.
    pub(crate) vertices: Vec<f32>,
    /// What vertices bring along `[vertex][feature]`.
    pub(crate) features: Vec<f32>,
    /// Used body points `[point][3]`; none without a body stream.
    pub(crate) body_points: Vec<f32>,
    /// Their normals `[point][3]`; none where the configuration does not ask for them.
    pub(crate) body_normals: Vec<f32>,
    /// The kept body points nearest to each vertex; local pooling only.
    pub(crate) nearest: Option<Arc<NeighborTable>>,
    /// The used body point nearest to each vertex, where it is asked for.
    closest: Vec<u32>,
    /// Parameters of shape and pose.
    pub(crate) parameters: Vec<f32>,
    /// From the frame of prediction to the world: one for all vertices, or one each.
    frames: Vec<Matrix3<f32>>,
    /// M, in metres.
    warped: Vec<Point3>,
}

/// The body points near each vertex of a scene: what takes longest to find out about it.
///
/// Two bytes a number: 90 kB for a garment of 5,000 vertices that pools over 8 points.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneNeighbors {
    pooled: Vec<u16>,
    closest: Vec<u16>,
}

impl SceneNeighbors {
    fn check(found: usize, expected: usize) -> Result<(), NetError> {
        NetError::check_count("neighbors", found, expected)
    }
}

impl Scene {
    /// Prepares a scene; see [`Scene::prepare`].
    ///
    /// # Errors
    ///
    /// As [`Scene::prepare`].
    pub fn new(
        config: &GarNetConfig,
        garment: &GarmentGraph,
        sampling: &BodySampling,
        input: &SceneInput<'_>,
    ) -> Result<Self, NetError> {
        let mut scene = Self::default();
        scene.prepare(config, garment, sampling, input)?;
        Ok(scene)
    }

    /// Prepares a scene that was prepared before, by the neighbors that were found then.
    ///
    /// # Errors
    ///
    /// As [`Scene::prepare`], and [`NetError::Count`] for neighbors of another scene.
    pub fn of_neighbors(
        config: &GarNetConfig,
        garment: &GarmentGraph,
        sampling: &BodySampling,
        input: &SceneInput<'_>,
        neighbors: &SceneNeighbors,
    ) -> Result<Self, NetError> {
        let mut scene = Self::default();
        scene.fill(config, garment, sampling, input, Some(neighbors))?;
        Ok(scene)
    }

    /// Fills the arrays for a scene, reusing the buffers.
    ///
    /// # Errors
    ///
    /// [`NetError::Count`] or [`NetError::Missing`] where an array has the wrong length,
    /// [`NetError::NotFinite`] for a coordinate that is not usable.
    pub fn prepare(
        &mut self,
        config: &GarNetConfig,
        garment: &GarmentGraph,
        sampling: &BodySampling,
        input: &SceneInput<'_>,
    ) -> Result<(), NetError> {
        self.fill(config, garment, sampling, input, None)
    }

    fn fill(
        &mut self,
        config: &GarNetConfig,
        garment: &GarmentGraph,
        sampling: &BodySampling,
        input: &SceneInput<'_>,
        known: Option<&SceneNeighbors>,
    ) -> Result<(), NetError> {
        check(config, garment, sampling, input)?;
        let root_from_world = input.world_from_root.inverse();
        let root = input.world_from_root.rotation.to_rotation_matrix();
        self.warped.clear();
        self.warped.extend_from_slice(input.warped);
        self.vertices.clear();
        for point in input.warped {
            let place = (root_from_world * point).coords / UNIT;
            self.vertices.extend_from_slice(place.as_slice());
        }
        self.frames.clear();
        match config.frame {
            Frame::Root => self.frames.push(root.into_inner()),
            Frame::Skin => {
                let frames = input.rotations.iter().map(rotation);
                self.frames.extend(frames);
            }
        }
        self.parameters.clear();
        if config.has_body_parameters() {
            self.parameters.extend_from_slice(input.parameters);
            if let Some(scaling) = &config.scaling {
                InputScaling::apply(&scaling.parameters, &mut self.parameters);
            }
        }
        self.body_points.clear();
        self.body_normals.clear();
        let used: Vec<Point3> = (sampling.used().iter())
            .map(|&index| input.body[index as usize])
            .collect();
        if config.has_body_stream() {
            for (&index, point) in sampling.used().iter().zip(&used) {
                let place = (root_from_world * point).coords / UNIT;
                self.body_points.extend_from_slice(place.as_slice());
                if config.body.normals {
                    let normal = root_from_world * input.body_normals[index as usize];
                    self.body_normals.extend_from_slice(normal.as_slice());
                }
            }
        }
        self.find_neighbors(config, sampling, input, &used, known)?;
        self.fill_features(config, garment, sampling, input, &used);
        Ok(())
    }

    /// Finds the body points near each vertex, or takes those that are known.
    fn find_neighbors(
        &mut self,
        config: &GarNetConfig,
        sampling: &BodySampling,
        input: &SceneInput<'_>,
        used: &[Point3],
        known: Option<&SceneNeighbors>,
    ) -> Result<(), NetError> {
        self.nearest = None;
        self.closest.clear();
        let num_vertices = input.warped.len();
        let wide = |numbers: &[u16]| numbers.iter().map(|&number| u32::from(number)).collect();
        if config.has_local_pooling() {
            let num_kept = sampling.kept().len();
            let num_neighbors = config.pooling.neighbors.min(num_kept);
            let indices = if let Some(known) = known {
                SceneNeighbors::check(known.pooled.len(), num_neighbors * num_vertices)?;
                wide(&known.pooled)
            } else {
                let kept: Vec<Point3> = (sampling.kept().iter())
                    .map(|&index| used[index as usize])
                    .collect();
                let nearest = VertexTree::new(&kept)?;
                let nearest = nearest.k_nearest_all(input.warped, num_neighbors);
                nearest.into_indices()
            };
            let table = NeighborTable::new(num_kept, num_neighbors, indices)?;
            self.nearest = Some(Arc::new(table));
        }
        if config.needs_nearest() {
            self.closest = if let Some(known) = known {
                SceneNeighbors::check(known.closest.len(), num_vertices)?;
                wide(&known.closest)
            } else {
                let nearest = VertexTree::new(used)?;
                nearest.k_nearest_all(input.warped, 1).into_indices()
            };
        }
        Ok(())
    }

    /// The neighbors that were found, to prepare the same scene sooner the next time; none for a
    /// body of more points than 16 bits can number.
    pub fn neighbors(&self) -> Option<SceneNeighbors> {
        let narrow = |numbers: &[u32]| {
            let numbers = numbers.iter().map(|&number| u16::try_from(number).ok());
            numbers.collect::<Option<Vec<u16>>>()
        };
        let pooled = self.nearest.as_ref().map_or(&[][..], |table| table.all());
        Some(SceneNeighbors {
            pooled: narrow(pooled)?,
            closest: narrow(&self.closest)?,
        })
    }

    /// What each vertex brings along: one after the other in the order of the configuration.
    fn fill_features(
        &mut self,
        config: &GarNetConfig,
        garment: &GarmentGraph,
        sampling: &BodySampling,
        input: &SceneInput<'_>,
        used: &[Point3],
    ) {
        let root_from_world = input.world_from_root.rotation.inverse();
        self.features.clear();
        for vertex in 0..garment.num_vertices() {
            let frame_from_world = self.frame(vertex).transpose();
            let near = self.closest.get(vertex).map_or(0, |&index| index as usize);
            for feature in &config.garment.inputs {
                match feature {
                    VertexInput::Template => {
                        let place = &garment.template()[3 * vertex..3 * vertex + 3];
                        self.features.extend_from_slice(place);
                    }
                    VertexInput::BodyOffset => {
                        let point = used[near];
                        let offset = frame_from_world * (input.warped[vertex] - point) / UNIT;
                        self.features.extend_from_slice(offset.as_slice());
                    }
                    VertexInput::BodyNormal => {
                        let index = sampling.used()[near] as usize;
                        let normal = frame_from_world * input.body_normals[index];
                        self.features.extend_from_slice(normal.as_slice());
                    }
                    VertexInput::Rotation => {
                        let turned = rotation(&(root_from_world * input.rotations[vertex]));
                        self.features.extend_from_slice(&turned.as_slice()[..6]);
                    }
                    VertexInput::Down => {
                        let down = frame_from_world * -Vector3::y();
                        self.features.extend_from_slice(down.as_slice());
                    }
                }
            }
            self.features.extend_from_slice(garment.sewing_parameters());
        }
        if let Some(scaling) = &config.scaling {
            InputScaling::apply(&scaling.vertices, &mut self.features);
        }
    }

    /// A scene of zeros that has the right extents, for counting.
    pub(crate) fn of_extent(
        config: &GarNetConfig,
        garment: &GarmentGraph,
        sampling: &BodySampling,
    ) -> Result<Self, NetError> {
        let num_vertices = garment.num_vertices();
        let has_points = usize::from(config.has_body_stream());
        let num_coordinates = 3 * sampling.used().len() * has_points;
        let mut scene = Self {
            vertices: vec![0.0; 3 * num_vertices],
            features: vec![0.0; config.num_vertex_features() * num_vertices],
            body_points: vec![0.0; num_coordinates],
            body_normals: vec![0.0; num_coordinates * usize::from(config.body.normals)],
            parameters: vec![0.0; config.num_body_parameters],
            ..Self::default()
        };
        if config.has_local_pooling() {
            let num_kept = sampling.kept().len();
            let columns = config.pooling.neighbors.min(num_kept);
            let table = vec![0; columns * num_vertices];
            scene.nearest = Some(Arc::new(NeighborTable::new(num_kept, columns, table)?));
        }
        Ok(scene)
    }

    /// How many vertices the garment has.
    pub fn num_vertices(&self) -> usize {
        self.warped.len()
    }

    /// M, the warped garment, in metres.
    pub fn warped(&self) -> &[Point3] {
        &self.warped
    }

    /// World from the frame of prediction at a vertex.
    fn frame(&self, vertex: usize) -> &Matrix3<f32> {
        &self.frames[vertex.min(self.frames.len() - 1)]
    }

    /// G_P = M + f(M, B): the vertices moved by translations `[vertex][3]` as the network gives
    /// them, in metres.
    ///
    /// # Errors
    ///
    /// [`NetError::Diverged`] for a translation that is not finite, [`NetError::Count`] for the
    /// wrong number of them.
    pub fn moved(&self, translations: &[f32]) -> Result<Vec<Point3>, NetError> {
        let (rows, _) = translations.as_chunks::<3>();
        let expected = 3 * self.num_vertices();
        NetError::check_count("numbers of translations", translations.len(), expected)?;
        let mut moved = Vec::with_capacity(rows.len());
        for (vertex, (&row, point)) in rows.iter().zip(&self.warped).enumerate() {
            let place = point + self.frame(vertex) * Vector3::from(row) * UNIT;
            if !place.iter().all(|value| value.abs() < MAX_COORDINATE) {
                return Err(NetError::Diverged { vertex });
            }
            moved.push(place);
        }
        Ok(moved)
    }

    /// Adds what the network is told to a case.
    pub(crate) fn add_to(&self, case: &mut ReferenceCase) {
        let columns = |values: &[f32], rows: usize| values.len() / rows.max(1);
        case.numbers("vertices", &self.vertices, 3);
        let num_features = columns(&self.features, self.num_vertices());
        case.numbers("features", &self.features, num_features);
        case.numbers("body_points", &self.body_points, 3);
        case.numbers("body_normals", &self.body_normals, 3);
        case.row("parameters", &self.parameters);
        if let Some(nearest) = &self.nearest {
            case.indices("nearest", nearest.all(), nearest.neighbors_per_row());
        }
        // Row after row, as the others are.
        let frames = self
            .frames
            .iter()
            .flat_map(|frame| frame.transpose().data.0);
        case.numbers("frames", &frames.flatten().collect::<Vec<f32>>(), 9);
        case.points("start", &self.warped);
    }

    /// Turns gradients by places `[vertex]` into gradients by translations `[vertex][3]`, both
    /// in units: the adjoint of [`Scene::moved`].
    ///
    /// # Panics
    ///
    /// If there are more gradients than vertices.
    pub fn pulled_back(&self, gradients: &[Vector3]) -> Vec<f32> {
        let turned = gradients.iter().enumerate();
        let turned = turned.map(|(vertex, gradient)| self.frame(vertex).transpose() * gradient);
        turned.flat_map(|gradient| gradient.data.0[0]).collect()
    }
}

fn rotation(turn: &UnitQuaternion<f32>) -> Matrix3<f32> {
    turn.to_rotation_matrix().into_inner()
}

/// Compares all lengths with what the configuration asks for, and looks for stray numbers.
fn check(
    config: &GarNetConfig,
    garment: &GarmentGraph,
    sampling: &BodySampling,
    input: &SceneInput<'_>,
) -> Result<(), NetError> {
    let num_vertices = garment.num_vertices();
    let (normals, rotations) = (input.body_normals, input.rotations);
    let needs_normals = config.needs_body_normals();
    if needs_normals && normals.is_empty() {
        return Err(NetError::Missing {
            what: "normals of the body are",
            needed_by: "the network is fed with",
        });
    }
    if config.needs_rotations() && rotations.is_empty() {
        return Err(NetError::Missing {
            what: "skinning rotations are",
            needed_by: "the network predicts in",
        });
    }
    let or_none = |is_needed: bool, count| if is_needed { count } else { 0 };
    let expected_parameters = or_none(config.has_body_parameters(), config.num_body_parameters);
    let num_normals = or_none(needs_normals, sampling.num_points());
    let num_rotations = or_none(config.needs_rotations(), num_vertices);
    let sewing = garment.sewing_parameters().len();
    let counts = [
        ("garment vertices", input.warped.len(), num_vertices),
        ("body points", input.body.len(), sampling.num_points()),
        ("normals of the body", normals.len(), num_normals),
        ("skinning rotations", rotations.len(), num_rotations),
        ("parameters", input.parameters.len(), expected_parameters),
        ("sewing parameters", sewing, config.num_sewing_parameters),
    ];
    for (what, found, expected) in counts {
        // More than is asked for is harmless; it is just not looked at.
        let is_optional = matches!(
            what,
            "normals of the body" | "skinning rotations" | "parameters"
        );
        if !(expected == 0 && is_optional) {
            NetError::check_count(what, found, expected)?;
        }
    }
    let points = |what, points: &[Point3]| {
        first_stray(what, points.iter().map(|point| point.coords.as_slice()))
    };
    points("garment vertex", input.warped)?;
    points("body point", input.body)?;
    first_stray("body normal", normals.iter().map(Vector3::as_slice))?;
    let turns = rotations.iter().map(|turn| turn.coords.as_slice());
    first_stray("skinning rotation", turns)?;
    first_stray(
        "parameter",
        input.parameters.iter().map(std::slice::from_ref),
    )?;
    let root = input.world_from_root;
    let root = [
        root.translation.vector.as_slice(),
        root.rotation.coords.as_slice(),
    ];
    first_stray("root transform", root)
}

fn first_stray<'a>(
    what: &'static str,
    rows: impl IntoIterator<Item = &'a [f32]>,
) -> Result<(), NetError> {
    let is_stray = |row: &[f32]| !row.iter().all(|value| value.abs() < MAX_COORDINATE);
    match rows.into_iter().position(is_stray) {
        Some(index) => Err(NetError::NotFinite { what, index }),
        None => Ok(()),
    }
}
