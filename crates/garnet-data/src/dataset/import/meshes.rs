//! The meshes of scenes made elsewhere, checked against the package.

use std::path::Path;

use garnet_mesh::{Bounds, ObjFile, Point3, Unit, check_range};
use garnet_skin::{ArrayProblem, FileError, NpyArray, NpyValues, NpzFile};

use super::{ImportScene, Posed, SceneRecord};
use crate::{DataError, GarmentPackage};

/// How many times larger or smaller than at rest a posed body or a draped garment may be: a body that is curled up
/// is less than that, another unit is more.
const MAX_EXTENT_RATIO: f32 = 5.0;

pub(super) struct Reader<'a> {
    pub(super) package: &'a GarmentPackage,
    /// The folder that paths start in.
    pub(super) base: &'a Path,
    pub(super) unit: Unit,
}

impl Reader<'_> {
    pub(super) fn scene(
        &self,
        scene: &ImportScene,
        body: u32,
        pose: u32,
    ) -> Result<SceneRecord, DataError> {
        let rest = self.package.body.rest().positions();
        let template = self.package.mesh.positions();
        Ok(SceneRecord {
            body,
            pose,
            sequence: scene.sequence.clone(),
            posed: Posed::Mesh(self.points(&scene.body_mesh, rest, "rest body")?),
            garment: self.points(&scene.garment_mesh, template, "template")?,
            arrived: None,
            midway: None,
            report: None,
        })
    }

    /// The vertices of a mesh that is `like` one of the package, in metres.
    fn points(
        &self,
        path: &Path,
        like: &[Point3],
        of: &'static str,
    ) -> Result<Vec<Point3>, DataError> {
        let path = self.base.join(path);
        let mut points = self.read(&path)?;
        if points.len() != like.len() {
            let what = format!(
                "it has {} vertices, the {of} of the package has {}",
                points.len(),
                like.len()
            );
            return Err(DataError::foreign(&path, what));
        }
        for point in &mut points {
            *point *= self.unit.in_metres();
        }
        check_range(&points).map_err(|error| DataError::foreign(&path, error.to_string()))?;
        let (found, expected) = (extent(&points), extent(like));
        if found * MAX_EXTENT_RATIO < expected || found > expected * MAX_EXTENT_RATIO {
            return Err(DataError::Extent {
                path,
                found,
                of,
                expected,
            });
        }
        Ok(points)
    }

    fn read(&self, path: &Path) -> Result<Vec<Point3>, DataError> {
        let is_npz = path.extension().is_some_and(|extension| extension == "npz");
        if !is_npz {
            return Ok(ObjFile::read(path)?.positions().to_vec());
        }
        Ok(self.read_npz(path)?)
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

/// The largest size along an axis; zero without points.
fn extent(points: &[Point3]) -> f32 {
    Bounds::of(points).map_or(0.0, |bounds| bounds.extent().max())
}
