//! The meshes of scenes made elsewhere, checked against the package.

use std::path::{Path, PathBuf};

use garnet_drape::GarmentPackage;
use garnet_io::{ArrayProblem, FileError, NpyArray, NpyValues, NpzFile, ObjFile};
use garnet_mesh::{Bounds, KnownMesh, MeshDifference, Point3, Unit, check_range};

use super::{ImportScene, Posed, SceneRecord};
use crate::DataError;

/// How many times larger or smaller than at rest a posed body or a draped garment may be: a body
/// that is curled up is less than that, another unit is more.
const MAX_EXTENT_RATIO: f32 = 5.0;

/// How far the box of a garment may be from that of its body, in metres: cloth that hangs on a body
/// overlaps it.
const MAX_GAP: f32 = 0.5;

pub(super) struct Reader<'a> {
    /// The rest body of the package.
    body: KnownMesh<'a>,
    template: KnownMesh<'a>,
    /// The folder that paths start in.
    base: &'a Path,
    unit: Unit,
}

/// What a mesh is to be like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Like {
    Body,
    Template,
}

impl Like {
    /// The name in messages.
    const fn name(self) -> &'static str {
        match self {
            Self::Body => "rest body",
            Self::Template => "template",
        }
    }
}

impl<'a> Reader<'a> {
    pub(super) fn new(package: &'a GarmentPackage, base: &'a Path, unit: Unit) -> Self {
        Self {
            body: KnownMesh::of(package.body.rest()),
            template: KnownMesh::of(&package.mesh),
            base,
            unit,
        }
    }

    pub(super) fn scene(
        &self,
        scene: &ImportScene,
        body: u32,
        pose: u32,
    ) -> Result<SceneRecord, DataError> {
        let [body_path, garment_path] = self.paths(scene);
        let posed = self.points(&body_path, Like::Body)?;
        let garment = self.points(&garment_path, Like::Template)?;
        let boxes = (bounds(&posed, &self.body), bounds(&garment, &self.template));
        if let (Some(of_body), Some(of_garment)) = boxes {
            let gap = of_body.gap(&of_garment);
            if gap > MAX_GAP {
                return Err(DataError::Apart {
                    garment: garment_path,
                    body: body_path,
                    gap,
                });
            }
        }
        Ok(SceneRecord {
            body,
            pose,
            sequence: scene.sequence.clone(),
            posed: Posed::Mesh(posed),
            garment,
            arrived: None,
            midway: None,
            report: None,
        })
    }

    /// The error of a scene whose meshes were others at first.
    pub(super) fn changed(&self, scene: &ImportScene) -> DataError {
        let [body, garment] = self.paths(scene);
        DataError::Changed { garment, body }
    }

    /// The files of body and garment.
    fn paths(&self, scene: &ImportScene) -> [PathBuf; 2] {
        [&scene.body_mesh, &scene.garment_mesh].map(|path| self.base.join(path))
    }

    /// The vertices of a mesh that is `like` one of the package, in metres.
    fn points(&self, path: &Path, like: Like) -> Result<Vec<Point3>, DataError> {
        let known = match like {
            Like::Body => &self.body,
            Like::Template => &self.template,
        };
        let other = |difference| DataError::OtherMesh {
            path: path.to_path_buf(),
            of: like.name(),
            difference,
        };
        let (mut points, edges) = self.read(path)?;
        known.check_count(points.len()).map_err(other)?;
        for point in &mut points {
            *point *= self.unit.in_metres();
        }
        let checked = check_range(&points);
        checked.map_err(|error| DataError::foreign(path, error.to_string()))?;
        let (found, expected) = (
            extent(&points, known),
            extent(known.mesh().positions(), known),
        );
        if found * MAX_EXTENT_RATIO < expected || found > expected * MAX_EXTENT_RATIO {
            return Err(DataError::Extent {
                path: path.to_path_buf(),
                found,
                of: like.name(),
                expected,
            });
        }
        let checked = match like {
            Like::Body => known.check(&points, &edges),
            // Cloth encloses nothing that would tell its sides.
            Like::Template => known.check_order(&points, &edges),
        };
        // All are in metres.
        if checked.map_err(other)? != 0 {
            return Err(other(MeshDifference::Order));
        }
        Ok(points)
    }

    /// The vertices of a file, and the edges of its polygons; an archive has none.
    fn read(&self, path: &Path) -> Result<(Vec<Point3>, Vec<[u32; 2]>), DataError> {
        let is_npz = path.extension().is_some_and(|extension| extension == "npz");
        if is_npz {
            return Ok((self.read_npz(path)?, Vec::new()));
        }
        let file = ObjFile::read_regular(path)?;
        Ok((file.positions().to_vec(), file.polygon_edges()))
    }

    fn read_npz(&self, path: &Path) -> Result<Vec<Point3>, FileError> {
        const KEY: &str = "vertices";
        let mut file = NpzFile::open(path)?;
        file.require(&[KEY])?;
        let Some(array) = file.array(KEY)? else {
            return Ok(Vec::new());
        };
        let values = self.floats(&array);
        let values = values.map_err(|problem| file.wrong(KEY, problem))?;
        let points = values.chunks_exact(3);
        Ok(points
            .map(|p| Point3::new(p[0] as f32, p[1] as f32, p[2] as f32))
            .collect())
    }

    /// The values of an array of points.
    fn floats(&self, array: &NpyArray) -> Result<Vec<f64>, ArrayProblem> {
        if !matches!(array.shape[..], [_, 3]) {
            return Err(ArrayProblem::Shape {
                found: array.shape.clone(),
                expected: "(N, 3)".to_owned(),
            });
        }
        let is_integers = matches!(array.values, NpyValues::Integers(_));
        let refused = |found, expected| Err(ArrayProblem::Kind { found, expected });
        if array.is_boolean() {
            return refused("booleans", "floats");
        }
        if is_integers && self.unit != Unit::Millimetre {
            return refused("integers", "floats, or integers where `units` is `mm`");
        }
        array.floats()
    }
}

/// Bounds of the vertices that faces of the known mesh name.
fn bounds(points: &[Point3], known: &KnownMesh<'_>) -> Option<Bounds> {
    Bounds::of_faces(points, known.mesh().faces())
}

/// The largest size along an axis; zero without points.
fn extent(points: &[Point3], known: &KnownMesh<'_>) -> f32 {
    bounds(points, known).map_or(0.0, |bounds| bounds.extent().max())
}
