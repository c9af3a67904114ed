//! Bodies: a rest mesh, a skeleton and weights; and bodies in a pose.

use std::{path::PathBuf, sync::Arc, time::Instant};

use garnet::{
    Joint, Pose, Skeleton, SkinWeights, UnitQuaternion, Vector3,
    body::{
        poses::key_poses,
        shape::{BodyParameters, Measure, ParametricBody},
    },
    io::{MotionOptions, PoseSource, read_body},
};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::{
    exceptions::PyValueError,
    prelude::*,
    types::{PyDict, PyType},
};

use crate::{
    arrays,
    errors::{failed, refused},
};

/// Body(vertices, faces, joints, parents, weights, *, names=None)
///
/// A body at rest, with its skeleton and weights.
///
/// vertices: [n, 3], metres, y up. faces: [m, 3], counter-clockwise from outside. joints: [j, 3],
/// places at rest. parents: [j], the number of each joint's parent, below zero for a root.
/// weights: [n, j], how much each joint moves each vertex. names: of the joints; a body whose
/// joints have the names of a human figure can take the poses of the library.
#[pyclass(frozen, module = "garnet")]
pub(crate) struct Body {
    pub(crate) inner: Arc<garnet::Body>,
}

/// A body in a pose, and perhaps another shape: what garments are draped on.
///
/// Made by Body.posed and Body.fitted.
#[pyclass(frozen, module = "garnet")]
pub(crate) struct PosedBody {
    pub(crate) inner: garnet::PosedBody,
    /// The body that it is a pose of.
    pub(crate) body: Arc<garnet::Body>,
}

#[pymethods]
impl Body {
    #[new]
    #[pyo3(signature = (vertices, faces, joints, parents, weights, *, names=None))]
    fn new(
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        joints: &Bound<'_, PyAny>,
        parents: &Bound<'_, PyAny>,
        weights: &Bound<'_, PyAny>,
        names: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let mesh = arrays::mesh(vertices, faces)?;
        let joints = arrays::points("joints", joints)?;
        let parents = parents_of(parents, joints.len())?;
        let names = match names {
            None => (0..joints.len())
                .map(|joint| format!("joint_{joint}"))
                .collect(),
            Some(names) if names.len() == joints.len() => names,
            Some(names) => {
                return Err(PyValueError::new_err(format!(
                    "there are {} names of {} joints",
                    names.len(),
                    joints.len()
                )));
            }
        };
        let (weights, shape) = arrays::numbers("weights", weights)?;
        let expected = [mesh.num_vertices(), joints.len()];
        if shape != expected {
            return Err(PyValueError::new_err(format!(
                "weights must have a row a vertex and a column a joint, {expected:?}, found {shape:?}"
            )));
        }
        let num_joints = joints.len();
        let joints = names.into_iter().zip(parents).zip(joints);
        let joints = joints.map(|((name, parent), rest_position)| Joint {
            name,
            parent,
            rest_position,
        });
        let skeleton = Skeleton::new(joints.collect()).map_err(|error| refused("joints", error))?;
        let weights = SkinWeights::from_dense(num_joints, &weights)
            .map_err(|error| refused("weights", error))?;
        let body = vertices
            .py()
            .detach(|| garnet::Body::new(mesh, skeleton, weights));
        Ok(Self::of(body.map_err(failed)?))
    }

    /// Reads a rig that has its rest mesh: `*.rig.npz`, GLB, glTF or VRM.
    ///
    /// Raises GarnetError for a file that cannot be read or has no rest mesh.
    #[classmethod]
    fn read(_class: &Bound<'_, PyType>, py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let body = py.detach(|| read_body(path));
        Ok(Self::of(body.map_err(failed)?))
    }

    /// The built-in body of a sex (0 male, 1 female, between is between) and some measures.
    ///
    /// Measures are metres by name: stature=1.68, waist=0.72, shoulder_breadth=0.36. What is not
    /// given follows from the rest. bmi is in kg/m^2. Raises ValueError for measures that nobody
    /// has.
    #[classmethod]
    #[pyo3(signature = (sex=0.5, *, bmi=None, **measures))]
    fn built_in(
        _class: &Bound<'_, PyType>,
        py: Python<'_>,
        sex: f64,
        bmi: Option<f64>,
        measures: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut parameters = BodyParameters::new(sex);
        if let Some(bmi) = bmi {
            parameters = parameters.with_bmi(bmi);
        }
        for (name, value) in measures.into_iter().flatten() {
            let name: String = name.extract()?;
            parameters = parameters.with(measure_of(&name)?, value.extract()?);
        }
        let built = py.detach(|| ParametricBody::build(&parameters));
        let built = built.map_err(|error| refused("measures", error))?;
        Ok(Self::of(built.into_body()))
    }

    /// This body in a pose.
    ///
    /// pose: a name of the library (garnet.poses()); a file of a pose, or of a motion with a frame
    /// as the command takes it ("walk.bvh:12"); or turns as axis-angles in radians, of each joint
    /// [j, 3] or of some by their names, against the parent, in the axes of the body at rest.
    /// translation: where all is moved to, metres.
    #[pyo3(signature = (pose, *, translation=None))]
    fn posed(
        &self,
        py: Python<'_>,
        pose: &Bound<'_, PyAny>,
        translation: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PosedBody> {
        let mut pose = pose_of(&self.inner, pose)?;
        if let Some(translation) = translation {
            pose.root_translation += arrays::vector("translation", translation)?;
        }
        let posed = py.detach(|| self.inner.posed(&pose));
        Ok(PosedBody {
            inner: posed.map_err(failed)?,
            body: Arc::clone(&self.inner),
        })
    }

    /// The pose and shape in which this body has its vertices at given places [n, 3], metres.
    fn fitted(&self, py: Python<'_>, vertices: &Bound<'_, PyAny>) -> PyResult<PosedBody> {
        let (fitted, _) = fitted(py, &self.inner, "vertices", vertices)?;
        Ok(fitted)
    }

    /// Vertices at rest [n, 3], metres.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::of_points(py, self.inner.rest().positions())
    }

    /// Faces [m, 3].
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        arrays::of_faces(py, self.inner.rest().faces())
    }

    /// Places of the joints at rest [j, 3], metres.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let joints = self.inner.skeleton().joints().iter();
        let places: Vec<_> = joints.map(|joint| joint.rest_position).collect();
        arrays::of_points(py, &places)
    }

    /// The number of each joint's parent, -1 for a root.
    #[getter]
    fn parents(&self) -> Vec<i64> {
        let joints = self.inner.skeleton().joints().iter();
        let parents = joints.map(|joint| joint.parent.map_or(-1, |parent| parent as i64));
        parents.collect()
    }

    /// The names of the joints.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        let joints = self.inner.skeleton().joints().iter();
        joints.map(|joint| joint.name.clone()).collect()
    }

    /// How much each joint moves each vertex [n, j].
    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let weights = self.inner.weights();
        let dense = weights.to_dense().into_iter().map(f64::from);
        arrays::of_numbers(py, dense.collect(), weights.num_joints())
    }

    fn __repr__(&self) -> String {
        let (vertices, joints) = (
            self.inner.rest().num_vertices(),
            self.inner.skeleton().num_joints(),
        );
        format!("Body({vertices} vertices, {joints} joints)")
    }
}

impl Body {
    pub(crate) fn of(body: garnet::Body) -> Self {
        Self {
            inner: Arc::new(body),
        }
    }
}

#[pymethods]
impl PosedBody {
    /// Vertices [n, 3], metres.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::of_points(py, self.inner.skin().positions())
    }

    /// What takes each joint from rest to the pose, as matrices [j, 4, 4].
    #[getter]
    fn transforms<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let transforms = self.inner.posed_from_rest();
        // Row after row.
        let numbers = transforms.iter().flat_map(|transform| {
            let rows = transform.cast::<f64>().to_homogeneous().transpose();
            rows.data.0.into_iter().flatten()
        });
        PyArray1::from_vec(py, numbers.collect()).reshape([transforms.len(), 4, 4])
    }

    /// The body that this is a pose of.
    #[getter]
    fn body(&self) -> Body {
        Body {
            inner: Arc::clone(&self.body),
        }
    }

    fn __repr__(&self) -> String {
        let vertices = self.inner.skin().positions().len();
        format!("PosedBody({vertices} vertices)")
    }
}

/// The names of the poses of the library, which Body.posed takes.
#[pyfunction]
pub(crate) fn poses() -> Vec<&'static str> {
    key_poses().map(|pose| pose.name).collect()
}

/// A body that has its vertices where an array says, and how long it took to find, in seconds.
pub(crate) fn fitted(
    py: Python<'_>,
    body: &Arc<garnet::Body>,
    name: &str,
    vertices: &Bound<'_, PyAny>,
) -> PyResult<(PosedBody, f64)> {
    let target = arrays::points(name, vertices)?;
    let expected = body.rest().num_vertices();
    if target.len() != expected {
        return Err(PyValueError::new_err(format!(
            "{name} has {} vertices; the body has {expected}, and a target is that body in another \
             pose or shape",
            target.len()
        )));
    }
    let (posed, seconds) = py.detach(|| {
        let start = Instant::now();
        let posed = body.fitted(&target);
        (posed, start.elapsed().as_secs_f64())
    });
    let posed = PosedBody {
        inner: posed.map_err(|error| refused(name, error))?,
        body: Arc::clone(body),
    };
    Ok((posed, seconds))
}

/// Parents by their numbers; below zero is none.
fn parents_of(parents: &Bound<'_, PyAny>, num_joints: usize) -> PyResult<Vec<Option<usize>>> {
    let (parents, shape) = arrays::integers("parents", parents)?;
    if shape != [num_joints] {
        return Err(PyValueError::new_err(format!(
            "parents must have the shape [{num_joints}], one a joint, found {shape:?}"
        )));
    }
    Ok(parents
        .into_iter()
        .map(|parent| usize::try_from(parent).ok())
        .collect())
}

/// A measure by its name, words joined by underscores.
fn measure_of(name: &str) -> PyResult<Measure> {
    let of = |measure: Measure| measure.name().replace([' ', '-'], "_");
    let found = Measure::ALL
        .into_iter()
        .find(|&measure| of(measure) == name);
    found.ok_or_else(|| {
        let names: Vec<String> = Measure::ALL.into_iter().map(of).collect();
        PyValueError::new_err(format!(
            "there is no measure `{name}`; there are {}",
            names.join(", ")
        ))
    })
}

/// A pose of the library, or a frame of a file.
fn named(body: &garnet::Body, name: &str) -> PyResult<Pose> {
    let source = PoseSource::from(name);
    source.check().map_err(|error| refused("pose", error))?;
    let posing = source.read(body, &MotionOptions::default());
    let mut poses = posing.map_err(failed)?.poses;
    match (poses.pop(), poses.len()) {
        (Some(pose), 0) => Ok(pose.pose),
        (_, others) => Err(PyValueError::new_err(format!(
            "pose: `{name}` stands for {} poses, not one",
            others + 1
        ))),
    }
}

/// A pose: a name, axis-angles of some joints by name, or of all `[joints, 3]`.
fn pose_of(body: &garnet::Body, pose: &Bound<'_, PyAny>) -> PyResult<Pose> {
    let skeleton = body.skeleton();
    if let Ok(name) = pose.extract::<String>() {
        return named(body, &name);
    }
    let mut of_joints = Pose::rest(skeleton.num_joints());
    if let Ok(turns) = pose.cast::<PyDict>() {
        for (name, turn) in turns {
            let name: String = name.extract()?;
            let joint = skeleton
                .find(&name)
                .ok_or_else(|| PyValueError::new_err(format!("the body has no joint `{name}`")))?;
            let turn = arrays::vector(&format!("pose[{name:?}]"), &turn)?;
            of_joints.rotations[joint] = UnitQuaternion::from_scaled_axis(turn);
        }
        return Ok(of_joints);
    }
    let turns = arrays::floats::<3>("pose", pose)?;
    if turns.len() != skeleton.num_joints() {
        return Err(PyValueError::new_err(format!(
            "pose has {} rows; the body has {} joints",
            turns.len(),
            skeleton.num_joints()
        )));
    }
    for (rotation, turn) in of_joints.rotations.iter_mut().zip(turns) {
        *rotation = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
    }
    Ok(of_joints)
}
