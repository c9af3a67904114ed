//! The bind pose of skins in the world, and the pose that a file shows.
//!
//! A vertex `p` of a skinned mesh is shown at `Σ w_j S_j p`, with `S_j = world_j ·
//! bone_from_mesh_j`. Where all `S_j` are one transform, the file shows the bind pose. Where they
//! are not, some node stands in a frame of an animation: the bind pose is the mesh moved by the one
//! transform for which all joints have moved rigidly since, and the body stands upright if it can.

use garnet_skin::{Joint, Pose, Skeleton, SkinWeights, skin_linear};
use nalgebra::{
    Isometry3, Matrix3, Matrix4, Point3 as NaPoint3, Rotation3, Translation3, UnitQuaternion,
};

use super::{
    nodes::Nodes,
    skeletons::{Bind, JointNodes},
};

/// How far two transforms may differ and still be one, relative to their largest entry.
const SAME_TRANSFORM: f64 = 1e-4;

/// How far a transform may be from a rigid one: rounding of files and of programs.
const RIGID: f64 = 2e-3;

/// How far the rebuilt pose may be from what is shown, over the size of the body.
const REBUILT: f32 = 2e-3;

/// A body that is moved by less than this in the mean, over the size of its skeleton, stands about
/// where it stood: it breathes, leans or steps. More takes a body that was put elsewhere for one
/// that moved.
const ABOUT: f64 = 0.12;

/// Where a body of skinned meshes is.
#[derive(Debug)]
pub(super) struct Placed {
    /// Joints of the rest mesh.
    pub skeleton: Skeleton,
    /// The rest mesh `[vertex]`.
    pub rest: Vec<garnet_skin::Point3>,
    /// The pose that is shown, if that is not the rest pose.
    pub pose: Option<Pose>,
}

/// All that the place of a body is found from.
#[derive(Debug)]
pub(super) struct Shown<'a> {
    pub nodes: &'a Nodes,
    pub joints: &'a JointNodes,
    pub names: Vec<String>,
    /// Of each skin.
    pub binds: &'a [Bind],
    /// Of each skin: the node of its mesh.
    pub mesh_nodes: Vec<usize>,
    /// Positions `[vertex]` in the space of their mesh.
    pub positions: &'a [NaPoint3<f64>],
    /// The skin of each vertex.
    pub skin_of_vertex: &'a [usize],
    /// Of the joints of the skeleton.
    pub weights: &'a SkinWeights,
    /// What the joints are, as far as a file says.
    pub labels: Vec<(String, usize)>,
}

impl Shown<'_> {
    /// `S_j` of the joints of a skin.
    fn shown_from_mesh(&self, bind: &Bind) -> Vec<Matrix4<f64>> {
        let pairs = bind.nodes.iter().zip(&bind.bone_from_mesh);
        pairs
            .map(|(&node, matrix)| self.nodes.world_from_node[node] * matrix)
            .collect()
    }

    /// Positions `[vertex]` as the file shows them.
    fn shown(&self) -> Vec<NaPoint3<f64>> {
        let of_skin: Vec<Vec<Matrix4<f64>>> = self
            .binds
            .iter()
            .map(|bind| self.shown_from_mesh(bind))
            .collect();
        // The matrix of a joint of the skeleton in each skin.
        let of_joint: Vec<Vec<Option<Matrix4<f64>>>> = (self.binds.iter().zip(&of_skin))
            .map(|(bind, shown)| {
                let mut all = vec![None; self.joints.nodes.len()];
                for (node, matrix) in bind.nodes.iter().zip(shown) {
                    all[self.joints.joint_of_node[node]] = Some(*matrix);
                }
                all
            })
            .collect();
        let vertex = |(vertex, position): (usize, &NaPoint3<f64>)| {
            let matrices = &of_joint[self.skin_of_vertex[vertex]];
            let mut sum = nalgebra::Vector3::zeros();
            for (joint, weight) in self.weights.vertex(vertex) {
                if let Some(matrix) = matrices[joint] {
                    sum += f64::from(weight) * matrix.transform_point(position).coords;
                }
            }
            NaPoint3::from(sum)
        };
        self.positions.iter().enumerate().map(vertex).collect()
    }

    /// Finds rest mesh and pose; `None` if a bind matrix of a joint that is needed has no inverse.
    pub(super) fn placed(&self) -> Result<Placed, garnet_skin::SkinError> {
        let main = &self.binds[0];
        let shown_from_mesh = self.shown_from_mesh(main);
        let shown = self.shown();
        for candidate in self.candidates(main, &shown_from_mesh) {
            if let Some(placed) = self.rest_by(&candidate, &shown)? {
                return Ok(placed);
            }
        }
        // Joints stretch: what is shown is the rest pose.
        let world = |node: usize| self.nodes.world_from_node[node];
        let origins = self.joints.nodes.iter();
        let origins = origins.map(|&node| world(node).transform_point(&NaPoint3::origin()));
        Ok(Placed {
            skeleton: self.skeleton(&origins.collect::<Vec<_>>())?,
            rest: shown.iter().map(|point| point.cast()).collect(),
            pose: None,
        })
    }

    fn skeleton(&self, places: &[NaPoint3<f64>]) -> Result<Skeleton, garnet_skin::SkinError> {
        let parents = self.joints.parents(self.nodes);
        let joints = self.names.iter().zip(parents).zip(places);
        let joints = joints.map(|((name, parent), place)| Joint {
            name: name.clone(),
            parent,
            rest_position: place.cast(),
        });
        Ok(Skeleton::new(joints.collect())?.with_labels(self.labels.iter().cloned()))
    }

    /// Transforms from the mesh of the first skin to the world in which it may have been bound, the
    /// likeliest first: the one of all joints; else that of the node above the joints, if it leaves
    /// the body about where most joints are, as in the first frame of who breathes; else those that
    /// leave most joints where they are.
    fn candidates(&self, main: &Bind, shown: &[Matrix4<f64>]) -> Vec<Matrix4<f64>> {
        let Some(first) = shown.first() else {
            return vec![Matrix4::identity()];
        };
        if shown.iter().all(|other| is_same(other, first)) {
            return vec![*first];
        }
        let num_alike =
            |matrix: &Matrix4<f64>| shown.iter().filter(|other| is_same(other, matrix)).count();
        let root = main.nodes.iter().copied().find(|&node| {
            let is_joint =
                |node: usize| self.joints.joint_of_node.contains_key(&node).then_some(());
            self.nodes.nearest_ancestor(node, is_joint).is_none()
        });
        let above = root.and_then(|root| self.nodes.parents[root]);
        let above = above.map_or_else(Matrix4::identity, |node| self.nodes.world_from_node[node]);
        let mut all = vec![
            above,
            self.nodes.world_from_node[self.mesh_nodes[0]],
            Matrix4::identity(),
        ];
        let most = shown.iter().max_by_key(|matrix| num_alike(matrix));
        all.extend(most);
        all.extend(first.is_finite().then_some(*first));
        let is_about = most.is_some_and(|most| self.is_about(main, &above, most));
        let key = |matrix: &Matrix4<f64>| {
            (
                !self.is_upright(main, matrix),
                !(is_about && is_same(matrix, &above)),
                usize::MAX - num_alike(matrix),
            )
        };
        all.sort_by_key(key);
        all
    }

    /// Whether two transforms of the mesh leave its joints about where they are, in the mean.
    fn is_about(&self, main: &Bind, a: &Matrix4<f64>, b: &Matrix4<f64>) -> bool {
        let places = [a, b].map(|matrix| self.bind_places(main, matrix));
        let [Some(a), Some(b)] = places else {
            return false;
        };
        let (low, high) = b.iter().fold((b[0], b[0]), |(low, high), place| {
            (low.inf(place), high.sup(place))
        });
        let apart = a.iter().zip(&b).map(|(a, b)| (a - b).norm()).sum::<f64>();
        apart < ABOUT * (high - low).norm() * a.len() as f64
    }

    /// Whether the joints of a figure stand with their head up, or are of no figure.
    fn is_upright(&self, main: &Bind, world_from_mesh: &Matrix4<f64>) -> bool {
        let Some(places) = self.bind_places(main, world_from_mesh) else {
            return false;
        };
        let Ok(skeleton) = self.skeleton(&places) else {
            return false;
        };
        let Ok(figure) = garnet_body::motion::Figure::new(&skeleton, "the body") else {
            return true;
        };
        let at = |joint: usize| places[joint];
        let across = at(figure.chest()) - at(figure.pelvis());
        across.y > 0.7 * across.norm()
    }

    /// The joints at rest, where the first skin tells or else another one does.
    fn bind_places(
        &self,
        main: &Bind,
        world_from_mesh: &Matrix4<f64>,
    ) -> Option<Vec<NaPoint3<f64>>> {
        let binds = self.bind_matrices(main, world_from_mesh)?;
        let places = binds
            .iter()
            .map(|(world_from_bone, _)| world_from_bone.transform_point(&NaPoint3::origin()));
        Some(places.collect())
    }

    /// `world_from_bone` of each joint at rest, and how it moved from there to what is shown.
    fn bind_matrices(
        &self,
        main: &Bind,
        world_from_mesh: &Matrix4<f64>,
    ) -> Option<Vec<(Matrix4<f64>, Matrix4<f64>)>> {
        let mut found = vec![None; self.joints.nodes.len()];
        let mut add = |bind: &Bind, world_from_mesh: &Matrix4<f64>| -> Option<()> {
            for (node, bone_from_mesh) in bind.nodes.iter().zip(&bind.bone_from_mesh) {
                let joint = self.joints.joint_of_node[node];
                if found[joint].is_none() {
                    found[joint] = Some(world_from_mesh * bone_from_mesh.try_inverse()?);
                }
            }
            Some(())
        };
        add(main, world_from_mesh)?;
        for (bind, world_from_mesh) in self
            .binds
            .iter()
            .zip(self.mesh_transforms(main, world_from_mesh)?)
        {
            add(bind, &world_from_mesh)?;
        }
        let pairs = self.joints.nodes.iter().zip(found);
        pairs
            .map(|(&node, world_from_bone)| {
                let world_from_bone = world_from_bone?;
                let moved = self.nodes.world_from_node[node] * world_from_bone.try_inverse()?;
                Some((world_from_bone, moved))
            })
            .collect()
    }

    /// The way from the mesh of each skin to the world at rest.
    fn mesh_transforms(
        &self,
        main: &Bind,
        world_from_mesh: &Matrix4<f64>,
    ) -> Option<Vec<Matrix4<f64>>> {
        let of = |bind: &Bind| {
            let shared = bind
                .nodes
                .iter()
                .zip(&bind.bone_from_mesh)
                .find_map(|(node, own)| {
                    let place = main.nodes.iter().position(|other| other == node)?;
                    Some((place, own))
                });
            match shared {
                Some((place, own)) => {
                    let world_from_bone =
                        world_from_mesh * main.bone_from_mesh[place].try_inverse()?;
                    Some(world_from_bone * own)
                }
                None => self.shown_from_mesh(bind).first().copied(),
            }
        };
        self.binds.iter().map(of).collect()
    }

    /// The rest by a transform of the mesh, if all joints that carry skin have moved rigidly from
    /// it to what is shown.
    fn rest_by(
        &self,
        world_from_mesh: &Matrix4<f64>,
        shown: &[NaPoint3<f64>],
    ) -> Result<Option<Placed>, garnet_skin::SkinError> {
        let main = &self.binds[0];
        let (Some(binds), Some(transforms)) = (
            self.bind_matrices(main, world_from_mesh),
            self.mesh_transforms(main, world_from_mesh),
        ) else {
            return Ok(None);
        };
        let places: Vec<NaPoint3<f64>> = binds
            .iter()
            .map(|(world_from_bone, _)| world_from_bone.transform_point(&NaPoint3::origin()))
            .collect();
        let skeleton = self.skeleton(&places)?;
        let rest: Vec<garnet_skin::Point3> = (self.positions.iter().zip(self.skin_of_vertex))
            .map(|(position, &skin)| transforms[skin].transform_point(position).cast())
            .collect();
        let size = garnet_mesh::Bounds::of(&rest)
            .unwrap_or_default()
            .diagonal();
        let off = |positions: &[garnet_skin::Point3]| {
            let pairs = positions.iter().zip(shown);
            let distances = pairs.map(|(a, b)| (a - b.cast::<f32>()).norm());
            distances.fold(0.0, f32::max)
        };
        if off(&rest) <= 1e-5 * size {
            return Ok(Some(Placed {
                skeleton,
                rest,
                pose: None,
            }));
        }
        let mut moved = vec![Isometry3::<f32>::identity(); binds.len()];
        let mut is_weighted = vec![false; binds.len()];
        for vertex in 0..self.weights.num_vertices() {
            for (joint, weight) in self.weights.vertex(vertex) {
                is_weighted[joint] |= weight > 0.0;
            }
        }
        for &joint in skeleton.parents_first() {
            let parent = skeleton.joints()[joint].parent;
            moved[joint] = match (rigid(&binds[joint].1), parent) {
                (Some(transform), _) => transform,
                (None, _) if is_weighted[joint] => return Ok(None),
                (None, Some(parent)) => moved[parent],
                (None, None) => Isometry3::identity(),
            };
        }
        let pose = Pose::from_transforms(&skeleton, &moved)?.pose;
        let rebuilt = skin_linear(&rest, self.weights, &skeleton.transforms(&pose)?);
        if off(&rebuilt) > REBUILT * size {
            return Ok(None);
        }
        Ok(Some(Placed {
            skeleton,
            rest,
            pose: Some(pose),
        }))
    }
}

trait Finite {
    fn is_finite(&self) -> bool;
}

impl Finite for Matrix4<f64> {
    fn is_finite(&self) -> bool {
        self.iter().all(|value| value.is_finite())
    }
}

fn is_same(a: &Matrix4<f64>, b: &Matrix4<f64>) -> bool {
    (a - b).abs().max() <= SAME_TRANSFORM * b.abs().max()
}

/// The rigid transform that a matrix is.
fn rigid(matrix: &Matrix4<f64>) -> Option<Isometry3<f32>> {
    let turn: Matrix3<f64> = matrix.fixed_view::<3, 3>(0, 0).into_owned();
    let off = (turn.transpose() * turn - Matrix3::identity()).abs().max();
    let shift = matrix.fixed_view::<3, 1>(0, 3).into_owned();
    let is_rigid =
        off <= RIGID && turn.determinant() > 0.0 && shift.iter().all(|value| value.is_finite());
    is_rigid.then(|| {
        let rotation =
            Rotation3::from_matrix_eps(&turn, 1e-12, 50, Rotation3::from_matrix_unchecked(turn));
        let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
        Isometry3::from_parts(Translation3::from(shift), rotation).cast()
    })
}
