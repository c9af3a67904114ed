//! Bodies: a rest mesh on a skeleton.

use std::sync::{Arc, OnceLock};

use garnet_knn::Surface;
use garnet_mesh::{Bounds, TriMesh, Vector3, is_inside_out, outward_faces, vertex_normals};
use nalgebra::{Isometry3, UnitQuaternion};

use crate::caps::Caps;
use crate::shape::reshaped_joints;
use crate::{
    Joint, Method, Point3, Pose, Skeleton, SkinError, SkinWeights, Weld, skin_dual_quaternion,
    skin_linear,
};

/// What a rig file holds: a skeleton and weights, and the rest mesh if the file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// The rest mesh, if the file has it.
    pub rest: Option<TriMesh>,
    /// The skeleton, at rest in the rest mesh.
    pub skeleton: Skeleton,
    /// The weights of the rest mesh's vertices.
    pub weights: SkinWeights,
    /// The pose that garments of this body are modelled on, where it is not the pose of the rest
    /// mesh.
    pub rest_pose: Option<Pose>,
}

impl Rig {
    /// Makes a body of the rig and its own rest mesh.
    ///
    /// # Errors
    ///
    /// [`SkinError::NoRestMesh`] and those of [`Body::new`].
    pub fn into_body(self) -> Result<Body, SkinError> {
        let rest = self.rest.ok_or(SkinError::NoRestMesh)?;
        Body::new(rest, self.skeleton, self.weights)
    }

    /// Makes a body of the rig and a rest mesh from elsewhere, which must have the vertices that
    /// the weights are for.
    ///
    /// # Errors
    ///
    /// Those of [`Body::new`].
    pub fn into_body_with(self, rest: TriMesh) -> Result<Body, SkinError> {
        Body::new(rest, self.skeleton, self.weights)
    }
}

impl From<Body> for Rig {
    fn from(body: Body) -> Self {
        Self {
            rest: Some(body.rest),
            skeleton: body.skeleton,
            weights: body.weights,
            rest_pose: None,
        }
    }
}

/// A rest mesh whose vertices follow the joints of a skeleton.
#[derive(Debug, Clone)]
pub struct Body {
    rest: TriMesh,
    skin: Surface,
    num_rims: usize,
    skeleton: Skeleton,
    weights: SkinWeights,
    was_inside_out: bool,
    num_turned: usize,
    num_doubles: usize,
    /// Whether a face names each vertex `[vertex]`; empty if all are named.
    is_named: Vec<bool>,
    /// Unit normals at rest, once they were asked for.
    rest_normals: OnceLock<Vec<Vector3>>,
    /// The body without vertices that no face names, once it was asked for.
    without_strays: OnceLock<Option<Arc<Self>>>,
}

/// The surface of a mesh, and how many holes it has. Of one that is open, seams are closed, as
/// files of graphics split vertices along the seams of their textures, and then the holes are.
fn skin_of(rest: &TriMesh, doubles: &[u32], weights: &SkinWeights) -> (Surface, usize) {
    let skin = Surface::new(rest);
    if skin.is_closed() && doubles.is_empty() {
        return (skin, 0);
    }
    let mut faces = sewn_faces(rest, weights);
    for &double in doubles {
        // Without area it goes round nothing, and no other face changes its number.
        let corner = faces[double as usize][0];
        faces[double as usize] = [corner; 3];
    }
    let caps = Caps::of(rest.positions(), &faces);
    let num_caps = caps.faces.len();
    faces.extend(caps.faces);
    let closed = TriMesh::new(rest.positions().to_vec(), faces);
    let skin = closed.map_or(skin, |mesh| Surface::with_caps(&mesh, num_caps));
    (skin, caps.num_rims)
}

/// Vertices on rims of a body that are as near as this share of its height are one. Less leaves
/// seams open between meshes that were rounded apart; more sews lips and lids, which part.
const SAME_PLACE: f32 = 1e-5;

/// The largest sum of the differences of their weights with which vertices at a place move alike:
/// meshes of one body are rounded apart. More sews parts that come apart where joints bend; less
/// leaves seams of rounded weights open.
const SAME_WEIGHTS: f32 = 0.01;

/// The faces with one vertex for all that lie at a place, or on rims as near to each other as
/// rounding leaves them, and move alike.
fn sewn_faces(rest: &TriMesh, weights: &SkinWeights) -> Vec<[u32; 3]> {
    let weld = Weld::sewn_within(rest, SAME_PLACE);
    let mut at_node: Vec<Vec<u32>> = vec![Vec::new(); weld.num_nodes()];
    let same: Vec<u32> = (0_u32..)
        .zip(weld.node_of_vertex())
        .map(|(vertex, &node)| {
            let others = &mut at_node[node as usize];
            let row = |vertex: u32| weights.vertex(vertex as usize);
            let more = |a: u32, b: u32| -> f32 {
                let of_b = |joint| row(b).find(|(other, _)| *other == joint);
                let more =
                    row(a).map(|(joint, weight)| weight - of_b(joint).map_or(0.0, |it| it.1));
                more.filter(|more| *more > 0.0).sum()
            };
            let moves_alike =
                |&&other: &&u32| more(vertex, other) + more(other, vertex) <= SAME_WEIGHTS;
            let first = others.iter().find(moves_alike).copied();
            first.unwrap_or_else(|| {
                others.push(vertex);
                vertex
            })
        })
        .collect();
    let faces = rest.faces().iter();
    faces
        .map(|face| face.map(|vertex| same[vertex as usize]))
        .collect()
}

/// Whether a face names each vertex `[vertex]`; empty if all are named.
fn named_vertices(mesh: &TriMesh) -> Vec<bool> {
    let mut is_named = vec![false; mesh.num_vertices()];
    for &vertex in mesh.faces().as_flattened() {
        is_named[vertex as usize] = true;
    }
    if is_named.iter().all(|&is_named| is_named) {
        is_named.clear();
    }
    is_named
}

/// Joints that move skin are no farther from the middle of the body than this, over the diagonal of
/// its box: coordinates in another unit, or damaged ones, are.
const FAR_JOINT: f32 = 20.0;

/// Refuses joints that move the skin from far away.
fn check_near(rest: &TriMesh, skeleton: &Skeleton, weights: &SkinWeights) -> Result<(), SkinError> {
    let Some(Bounds { min, max }) = Bounds::of(rest.positions()) else {
        return Ok(());
    };
    let (middle, size) = (nalgebra::center(&min, &max), (max - min).norm());
    let joints = skeleton.joints().iter().enumerate();
    let distance = |joint: &Joint| (joint.rest_position - middle).norm();
    let far: Vec<usize> = joints
        .filter(|(_, joint)| distance(joint) > FAR_JOINT * size)
        .map(|(number, _)| number)
        .collect();
    if far.is_empty() {
        return Ok(());
    }
    let moves = |joint: usize| {
        let mut vertices = 0..weights.num_vertices();
        vertices.any(|vertex| {
            weights
                .vertex(vertex)
                .any(|(of, weight)| of == joint && weight > 0.0)
        })
    };
    match far.into_iter().find(|&joint| moves(joint)) {
        None => Ok(()),
        Some(number) => {
            let joint = &skeleton.joints()[number];
            Err(SkinError::FarJoint {
                joint: number,
                name: joint.name.clone(),
                distance: distance(joint),
                size,
            })
        }
    }
}

impl Body {
    /// Checks that mesh, skeleton and weights fit together. The faces of a mesh that is inside out
    /// are [turned](Body::was_inside_out).
    ///
    /// # Errors
    ///
    /// [`SkinError::VertexCount`], [`SkinError::JointCount`] or [`SkinError::FarJoint`].
    ///
    /// # Panics
    ///
    /// Never: a mesh stays one when its faces are turned.
    pub fn new(rest: TriMesh, skeleton: Skeleton, weights: SkinWeights) -> Result<Self, SkinError> {
        if weights.num_vertices() != rest.num_vertices() {
            return Err(SkinError::VertexCount {
                weights: weights.num_vertices(),
                mesh: rest.num_vertices(),
            });
        }
        weights.check_joints(&skeleton)?;
        check_near(&rest, &skeleton, &weights)?;
        let was_inside_out = is_inside_out(rest.positions(), rest.faces());
        let rest = if was_inside_out { turned(rest) } else { rest };
        let outward = outward_faces(rest.positions(), rest.faces());
        let rest = match outward.num_turned + outward.doubles.len() {
            0 => rest,
            _ => with_faces(rest, outward.faces),
        };
        let (skin, num_rims) = skin_of(&rest, &outward.doubles, &weights);
        let weights = weights.on(&skeleton);
        Ok(Self {
            skin,
            num_rims,
            is_named: named_vertices(&rest),
            rest_normals: OnceLock::new(),
            without_strays: OnceLock::new(),
            rest,
            skeleton,
            weights,
            was_inside_out,
            num_turned: outward.num_turned,
            num_doubles: outward.doubles.len(),
        })
    }

    /// The same body in the shape of other positions `[vertex]`, in about the same pose: each joint
    /// goes along with the skin round it, moved and grown as that was.
    ///
    /// # Errors
    ///
    /// [`SkinError::TargetCount`] or [`SkinError::NonFiniteTarget`].
    ///
    /// # Panics
    ///
    /// Never: the positions were checked.
    pub fn reshaped(&self, positions: &[Point3]) -> Result<Self, SkinError> {
        self.check_positions(positions)?;
        let places = reshaped_joints(
            &self.skeleton,
            &self.weights,
            self.rest.positions(),
            positions,
            None,
        );
        let skeleton = self.skeleton.placed(|joint, _| places[joint])?;
        let rest = self.rest.with_positions(positions.to_vec());
        let rest = rest.expect("positions are as many as vertices, and finite");
        Self::new(rest, skeleton, self.weights.clone())
    }

    fn check_positions(&self, positions: &[Point3]) -> Result<(), SkinError> {
        let expected = self.rest.num_vertices();
        if positions.len() != expected {
            return Err(SkinError::TargetCount {
                found: positions.len(),
                expected,
            });
        }
        if let Some(vertex) = positions
            .iter()
            .position(|place| !place.coords.iter().all(|value| value.is_finite()))
        {
            return Err(SkinError::NonFiniteTarget { vertex });
        }
        Ok(())
    }

    /// The body in this body's pose that is at `positions` `[vertex]`, in another shape and with
    /// its joints turned by `turns` from rest `[joint]`; and the transforms that carry it there
    /// `[joint]`. Its bones are as long as they are there.
    ///
    /// # Errors
    ///
    /// [`SkinError::TargetCount`], [`SkinError::TransformCount`] or [`SkinError::NonFiniteTarget`].
    ///
    /// # Panics
    ///
    /// Never: the positions were checked.
    pub fn unposed(
        &self,
        positions: &[Point3],
        turns: &[UnitQuaternion<f32>],
    ) -> Result<(Self, Vec<Isometry3<f32>>), SkinError> {
        let joints = self.skeleton.joints();
        self.check_positions(positions)?;
        if turns.len() != joints.len() {
            return Err(SkinError::TransformCount {
                found: turns.len(),
                expected: joints.len(),
            });
        }
        let rest = self.rest.positions();
        let there = reshaped_joints(&self.skeleton, &self.weights, rest, positions, Some(turns));
        let mut here: Vec<Point3> = joints.iter().map(|joint| joint.rest_position).collect();
        for &joint in self.skeleton.parents_first() {
            if let Some(parent) = joints[joint].parent {
                let bone = turns[parent].inverse() * (there[joint] - there[parent]);
                here[joint] = here[parent] + bone;
            }
        }
        let carried = |(joint, &turn): (usize, &UnitQuaternion<f32>)| {
            let shift = there[joint] - turn * here[joint];
            Isometry3::from_parts(shift.into(), turn)
        };
        let transforms: Vec<Isometry3<f32>> = turns.iter().enumerate().map(carried).collect();
        let skeleton = self.skeleton.placed(|joint, _| here[joint])?;
        let plain = Self::new(self.rest.clone(), skeleton.clone(), self.weights.clone())?;
        let fitted = plain.fitted_by(positions, transforms.clone())?;
        let Some(offsets) = fitted.shape_offsets() else {
            return Ok((plain, transforms));
        };
        let shaped = rest
            .iter()
            .zip(offsets)
            .map(|(place, offset)| place + offset);
        let mesh = self.rest.with_positions(shaped.collect());
        let mesh = mesh.expect("positions are as many as vertices, and finite");
        Ok((Self::new(mesh, skeleton, self.weights.clone())?, transforms))
    }

    /// The body `times` as large, about the origin.
    ///
    /// # Errors
    ///
    /// [`SkinError::NonFiniteTarget`], or those of [`Body::new`].
    ///
    /// # Panics
    ///
    /// Never: the positions were checked.
    pub fn scaled(&self, times: f32) -> Result<Self, SkinError> {
        let places = self.rest.positions().iter().map(|place| place * times);
        let places: Vec<Point3> = places.collect();
        self.check_positions(&places)?;
        let mesh = self.rest.with_positions(places);
        let mesh = mesh.expect("positions are as many as vertices, and finite");
        let skeleton = (self.skeleton).placed(|_, joint| joint.rest_position * times)?;
        Self::new(mesh, skeleton, self.weights.clone())
    }

    /// Those of `values` `[vertex]` whose vertices are named by a face: the others are no part of
    /// the skin.
    pub fn of_skin<'a, T>(&'a self, values: &'a [T]) -> impl Iterator<Item = &'a T> {
        let values = values.iter().enumerate();
        let is_named = |vertex: usize| self.is_named.get(vertex).is_none_or(|&named| named);
        values.filter_map(move |(vertex, value)| is_named(vertex).then_some(value))
    }

    /// The same body without vertices that no face names; none if there are none.
    pub(crate) fn without_strays(&self) -> Option<&Self> {
        let made = self
            .without_strays
            .get_or_init(|| self.cleaned().map(Arc::new));
        made.as_deref()
    }

    /// The work of [`Body::without_strays`].
    fn cleaned(&self) -> Option<Self> {
        if self.is_named.is_empty() {
            return None;
        }
        let mut place = vec![0_u32; self.is_named.len()];
        let mut kept = Vec::with_capacity(self.is_named.len());
        for (vertex, _) in self
            .is_named
            .iter()
            .enumerate()
            .filter(|&(_, &named)| named)
        {
            place[vertex] = kept.len() as u32;
            kept.push(vertex);
        }
        let faces = self.rest.faces().iter();
        let faces = faces.map(|face| face.map(|vertex| place[vertex as usize]));
        let positions = self.of_skin(self.rest.positions()).copied().collect();
        let rest = TriMesh::new(positions, faces.collect()).ok()?;
        let rows = kept.into_iter().map(|vertex| self.weights.vertex(vertex));
        let weights = SkinWeights::from_influences(self.skeleton.num_joints(), rows).ok()?;
        Self::new(rest, self.skeleton.clone(), weights).ok()
    }

    /// Whether the faces of the mesh looked inwards, and were turned.
    pub fn was_inside_out(&self) -> bool {
        self.was_inside_out
    }

    /// How many other faces looked inwards, and were turned: parts of a mesh, inner walls of thick
    /// skin, hulls that are drawn as outlines.
    pub fn num_turned_faces(&self) -> usize {
        self.num_turned
    }

    /// How many faces have the corners of another one, and are no part of the
    /// [skin](Body::skin): those of two-sided exports.
    pub fn num_double_faces(&self) -> usize {
        self.num_doubles
    }

    /// The mesh at rest.
    pub fn rest(&self) -> &TriMesh {
        &self.rest
    }

    /// Unit normals of the mesh at rest `[vertex]`.
    pub(crate) fn rest_normals(&self) -> &[Vector3] {
        let (positions, faces) = (self.rest.positions(), self.rest.faces());
        (self.rest_normals).get_or_init(|| vertex_normals(positions, faces))
    }

    /// How many holes the mesh has, other than seams: open necks, missing hands, skin that was
    /// deleted under clothes.
    pub fn num_rims(&self) -> usize {
        self.num_rims
    }

    /// Whether a face of the skin closes a hole, and is none of the mesh.
    pub fn is_cap(&self, face: u32) -> bool {
        face as usize >= self.rest.num_faces()
    }

    /// The mesh at rest, ready for proximity queries. Its faces are those of the mesh, with seams
    /// sewn up, and then those that close [holes](Body::num_rims).
    pub fn skin(&self) -> &Surface {
        &self.skin
    }

    /// The skeleton at rest.
    pub fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    /// The weights of the vertices.
    pub fn weights(&self) -> &SkinWeights {
        &self.weights
    }

    /// Positions `[vertex]` in a pose, in metres.
    ///
    /// # Errors
    ///
    /// Those of [`Skeleton::transforms`].
    pub fn posed_positions(&self, pose: &Pose, method: Method) -> Result<Vec<Point3>, SkinError> {
        let posed_from_rest = self.skeleton.transforms(pose)?;
        Ok(self.transformed_positions(&posed_from_rest, method))
    }

    /// Positions `[vertex]` moved by one rigid transform a joint, in metres.
    ///
    /// # Panics
    ///
    /// If there is another number of transforms than joints.
    pub fn transformed_positions(
        &self,
        posed_from_rest: &[Isometry3<f32>],
        method: Method,
    ) -> Vec<Point3> {
        let positions = self.rest.positions();
        match method {
            Method::DualQuaternion => {
                skin_dual_quaternion(positions, &self.weights, posed_from_rest)
            }
            Method::Linear => skin_linear(positions, &self.weights, posed_from_rest),
        }
    }
}

/// A mesh whose faces look to the other side.
fn turned(mesh: TriMesh) -> TriMesh {
    let faces = mesh.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    with_faces(mesh, faces)
}

/// The mesh with some faces turned.
fn with_faces(mesh: TriMesh, faces: Vec<[u32; 3]>) -> TriMesh {
    let (positions, _) = mesh.into_parts();
    TriMesh::new(positions, faces).expect("a mesh stays one when its faces are turned")
}

/// Checks that weights are for as many joints as the skeleton has.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Joint, Pose};
    use garnet_mesh::primitives::icosphere;

    /// Of one joint.
    fn body_of(positions: Vec<Point3>, faces: Vec<[u32; 3]>) -> Body {
        let root = Joint {
            name: "root".to_owned(),
            parent: None,
            rest_position: Point3::origin(),
        };
        let rows = positions.iter().map(|_| [(0, 1.0)]);
        let weights = SkinWeights::from_influences(1, rows).unwrap();
        let rest = TriMesh::new(positions, faces).unwrap();
        Body::new(rest, Skeleton::new(vec![root]).unwrap(), weights).unwrap()
    }

    #[test]
    fn a_longer_arm_that_is_bent_is_straight_again_and_as_long() {
        let arm = |length: f32| {
            let mesh = garnet_mesh::primitives::capsule(0.05, length, 16, 48);
            let joint = |name: &str, parent, share: f32| Joint {
                name: name.to_owned(),
                parent,
                rest_position: Point3::new(0.0, share * length, 0.0),
            };
            let joints = vec![joint("shoulder", None, -0.5), joint("elbow", Some(0), 0.0)];
            let forearm = |point: &Point3| (0.5 + point.y / 0.1).clamp(0.0, 1.0);
            let rows = (mesh.positions().iter()).map(|p| [(0, 1.0 - forearm(p)), (1, forearm(p))]);
            let weights = SkinWeights::from_influences(2, rows).unwrap();
            Body::new(mesh, Skeleton::new(joints).unwrap(), weights).unwrap()
        };
        let (short, long) = (arm(0.5), arm(0.6));
        let turns = [
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.2),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.9),
        ];
        let mut pose = Pose::rest(2);
        pose.rotations = vec![turns[0], turns[0].inverse() * turns[1]];
        let bent = long.posed(&pose).unwrap();
        let (found, transforms) = short.unposed(bent.skin().positions(), &turns).unwrap();
        let bone = |body: &Body| {
            let [a, b] = [0, 1].map(|joint| body.skeleton().joints()[joint].rest_position);
            b - a
        };
        assert!(
            (bone(&found) - bone(&long)).norm() < 0.01,
            "{:?}",
            bone(&found)
        );
        assert!((bone(&found) - bone(&short)).norm() > 0.04);
        let again = found
            .fitted_by(bent.skin().positions(), transforms)
            .unwrap();
        assert!(again.max_residual() < 1e-3, "{}", again.max_residual());
    }

    #[test]
    fn what_is_inside_does_not_hang_on_single_faces() {
        let ball = icosphere(3, 0.5);
        let turned = |faces: &[[u32; 3]]| faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let half = |face: &[u32; 3]| {
            let [a, b, c] = *face;
            let is_left = ball.positions()[a as usize].x > 0.0;
            if is_left { [a, c, b] } else { [a, b, c] }
        };
        let halves: Vec<[u32; 3]> = ball.faces().iter().map(half).collect();
        let other: Vec<[u32; 3]> = turned(ball.faces());
        let both: Vec<[u32; 3]> = ball.faces().iter().chain(&other).copied().collect();
        // The inner wall of a thick skin.
        let count = ball.num_vertices() as u32;
        let wall = other.iter().map(|face| face.map(|corner| corner + count));
        let thick: Vec<[u32; 3]> = ball.faces().iter().copied().chain(wall).collect();
        let inner = ball.positions().iter().map(|place| place * 0.95);
        let thick_places = ball.positions().iter().copied().chain(inner).collect();
        let bodies = [
            (body_of(ball.positions().to_vec(), halves), 0),
            (body_of(ball.positions().to_vec(), both), ball.num_faces()),
            (body_of(thick_places, thick), 0),
        ];
        for (body, doubles) in bodies {
            for (distance, is_inside) in [(0.0, true), (0.4, true), (0.49, true), (0.51, false)] {
                let place = Point3::new(0.6 * distance, 0.8 * distance, 0.0);
                assert_eq!(
                    body.skin().contains_all(&[place]),
                    [is_inside],
                    "{distance}"
                );
            }
            assert_eq!(body.num_double_faces(), doubles);
            assert!(doubles > 0 || body.num_turned_faces() > 0);
        }
    }

    fn rig(num_vertices: usize, num_weight_joints: usize) -> Rig {
        let joint = Joint {
            name: "root".to_owned(),
            parent: None,
            rest_position: Point3::origin(),
        };
        let mesh = TriMesh::new(vec![Point3::origin(); 3], vec![[0, 1, 2]]).unwrap();
        Rig {
            rest: Some(mesh),
            skeleton: Skeleton::new(vec![joint]).unwrap(),
            weights: SkinWeights::from_dense(
                num_weight_joints,
                &vec![1.0; num_vertices * num_weight_joints],
            )
            .unwrap(),
            rest_pose: None,
        }
    }

    #[test]
    fn seams_of_a_mesh_are_closed_where_both_sides_move_alike() {
        let ball = icosphere(2, 0.5);
        let corners = ball.faces().as_flattened().iter();
        let positions: Vec<Point3> = corners
            .map(|&vertex| ball.positions()[vertex as usize])
            .collect();
        let faces = (0..ball.num_faces() as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]);
        let split = TriMesh::new(positions.clone(), faces.collect()).unwrap();
        assert!(!Surface::new(&split).is_closed());
        let joint = Joint {
            name: "root".to_owned(),
            parent: None,
            rest_position: Point3::origin(),
        };
        let other = Joint {
            name: "other".to_owned(),
            parent: Some(0),
            ..joint.clone()
        };
        let skeleton = Skeleton::new(vec![joint, other]).unwrap();
        let alike = vec![vec![(0, 1.0)]; positions.len()];
        let mut unlike = alike.clone();
        unlike[0] = vec![(1, 1.0)];
        for (rows, is_alike) in [(alike, true), (unlike, false)] {
            let weights = SkinWeights::from_influences(2, rows).unwrap();
            let body = Body::new(split.clone(), skeleton.clone(), weights).unwrap();
            // Where they move apart, the slit is capped.
            assert!(body.skin().is_closed());
            let is_whole = body.skin().faces().len() == ball.num_faces();
            assert_eq!(is_whole, is_alike);
            assert_eq!(body.rest(), &split);
        }
    }

    #[test]
    fn seams_between_meshes_are_closed_within_rounding() {
        let ball = icosphere(3, 0.5);
        let is_upper = |face: &&[u32; 3]| {
            let places = face
                .iter()
                .map(|&corner| ball.positions()[corner as usize].y);
            places.sum::<f32>() > 0.0
        };
        let (upper, lower): (Vec<[u32; 3]>, Vec<[u32; 3]>) =
            ball.faces().iter().partition(is_upper);
        let count = ball.num_vertices() as u32;
        let off = ball.positions().iter();
        let off = off.map(|p| p + Vector3::new(3e-7, -4e-7, 2e-7));
        let positions: Vec<Point3> = ball.positions().iter().copied().chain(off).collect();
        let shifted = lower.iter().map(|face| face.map(|corner| corner + count));
        let faces: Vec<[u32; 3]> = upper.iter().copied().chain(shifted).collect();
        let rows = (0..positions.len()).map(|vertex| {
            let more = if vertex < ball.num_vertices() {
                0.0
            } else {
                1e-3
            };
            vec![(0, 0.6 + more), (1, 0.4 - more)]
        });
        let weights = SkinWeights::from_influences(2, rows).unwrap();
        let joint = |parent| Joint {
            name: format!("joint {parent:?}"),
            parent,
            rest_position: Point3::origin(),
        };
        let skeleton = Skeleton::new(vec![joint(None), joint(Some(0))]).unwrap();
        let mesh = TriMesh::new(positions, faces).unwrap();
        let body = Body::new(mesh, skeleton, weights).unwrap();
        assert_eq!(
            (body.num_rims(), body.skin().faces().len()),
            (0, ball.num_faces())
        );
    }

    #[test]
    fn faces_that_look_inwards_are_turned() {
        let ball = icosphere(2, 0.3);
        let shifted = ball
            .positions()
            .iter()
            .map(|p| p + Vector3::new(4.0, 0.0, 0.0));
        let ball = ball.with_positions(shifted.collect()).unwrap();
        // A hole leaves no doubt.
        let open = TriMesh::new(ball.positions().to_vec(), ball.faces()[20..].to_vec()).unwrap();
        for mesh in [ball, open] {
            let of = |mesh: TriMesh| rig(mesh.num_vertices(), 1).into_body_with(mesh).unwrap();
            let body = of(mesh.clone());
            assert!(!body.was_inside_out());
            let inside_out = of(turned(mesh.clone()));
            assert!(inside_out.was_inside_out());
            assert_eq!(inside_out.rest().faces(), mesh.faces());
        }
    }

    #[test]
    fn counts_that_do_not_fit_are_told_both() {
        let error = rig(4, 1).into_body().unwrap_err();
        assert_eq!(
            error,
            SkinError::VertexCount {
                weights: 4,
                mesh: 3
            }
        );
        let error = rig(3, 2).into_body().unwrap_err();
        assert_eq!(
            error,
            SkinError::JointCount {
                weights: 2,
                skeleton: 1
            }
        );
        let mut without_mesh = rig(3, 1);
        without_mesh.rest = None;
        assert_eq!(without_mesh.into_body().unwrap_err(), SkinError::NoRestMesh);
    }

    #[test]
    fn a_shifted_root_moves_every_vertex() {
        let body = rig(3, 1).into_body().unwrap();
        let mut pose = Pose::rest(1);
        pose.root_translation.y = 2.0;
        for method in [Method::DualQuaternion, Method::Linear] {
            let moved = body.posed_positions(&pose, method).unwrap();
            assert!(moved.iter().all(|point| (point.y - 2.0).abs() < 1e-6));
        }
    }
}
