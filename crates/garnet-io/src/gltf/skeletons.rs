//! Which skins are of one skeleton, and its joints.

use std::collections::BTreeMap;

use gltf::json::{Index, Node, Root, Skin, accessor::Type};
use nalgebra::Matrix4;

use super::{GltfProblem, nodes::Nodes, rig::Reader};

/// A node with a mesh and a skin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Instance {
    pub node: usize,
    pub mesh: usize,
    pub skin: usize,
}

/// A skin: the nodes of its joints, and the way from its mesh to each of them at rest.
#[derive(Debug)]
pub(super) struct Bind {
    pub nodes: Vec<usize>,
    pub bone_from_mesh: Vec<Matrix4<f64>>,
}

/// The nodes that have a mesh and a skin; a mesh that stands twice on one skin is one.
pub(super) fn instances(root: &Root) -> Result<Vec<Instance>, GltfProblem> {
    let mut found: Vec<Instance> = Vec::new();
    for (node, content) in root.nodes.iter().enumerate() {
        let both = |node: &Node| node.mesh.zip(node.skin);
        let Some((mesh, skin)) = both(content) else {
            continue;
        };
        let (mesh, skin) = (mesh.value(), skin.value());
        for (part, index, count) in [
            ("mesh", mesh, root.meshes.len()),
            ("skin", skin, root.skins.len()),
        ] {
            if index >= count {
                return Err(GltfProblem::OutOfRange {
                    user: format!("node {node}"),
                    part,
                    index,
                    count,
                });
            }
        }
        let is_known = |other: &Instance| other.mesh == mesh && other.skin == skin;
        if !found.iter().any(is_known) {
            found.push(Instance { node, mesh, skin });
        }
    }
    if found.is_empty() {
        return Err(GltfProblem::NoSkin);
    }
    Ok(found)
}

/// Instances by their skeletons: skins that share a joint, or one of which hangs on another's.
pub(super) fn by_skeleton(
    root: &Root,
    nodes: &Nodes,
    instances: &[Instance],
) -> Vec<Vec<Instance>> {
    let mut groups: Vec<(Vec<usize>, Vec<Instance>)> = Vec::new();
    for &instance in instances {
        let joints = root.skins.get(instance.skin).map(joints_of);
        let joints = joints.unwrap_or_default();
        let is_kin = |others: &[usize]| {
            let hangs = |node: usize, on: &[usize]| {
                let own = on.contains(&node).then_some(());
                let above =
                    || nodes.nearest_ancestor(node, |node| on.contains(&node).then_some(()));
                own.or_else(above).is_some()
            };
            let below = joints
                .iter()
                .any(|&joint| joint < nodes.parents.len() && hangs(joint, others));
            let above = others
                .iter()
                .any(|&joint| joint < nodes.parents.len() && hangs(joint, &joints));
            below || above
        };
        let (kin, mut rest): (Vec<_>, Vec<_>) =
            groups.into_iter().partition(|(others, _)| is_kin(others));
        let mut merged = (Vec::new(), Vec::new());
        for (joints, instances) in kin {
            merged.0.extend(joints);
            merged.1.extend(instances);
        }
        merged.0.extend(&joints);
        merged.1.push(instance);
        rest.push(merged);
        groups = rest;
    }
    let mut groups: Vec<Vec<Instance>> = groups.into_iter().map(|(_, group)| group).collect();
    groups.sort_by_key(|group| group.iter().map(|instance| instance.node).min());
    groups
}

fn joints_of(skin: &Skin) -> Vec<usize> {
    skin.joints.iter().map(Index::value).collect()
}

/// The nodes that are the joints of a skin.
///
/// # Errors
///
/// [`GltfProblem::OutOfRange`] if the file does not have one of them.
pub(super) fn checked_joints(root: &Root, skin: &Skin) -> Result<Vec<usize>, GltfProblem> {
    let nodes = joints_of(skin);
    let count = root.nodes.len();
    match nodes.iter().find(|&&node| node >= count) {
        None => Ok(nodes),
        Some(&index) => Err(GltfProblem::OutOfRange {
            user: "the skin".to_owned(),
            part: "node",
            index,
            count,
        }),
    }
}

impl Reader<'_> {
    /// Reads a skin.
    pub(super) fn bind(&self, skin: usize) -> Result<Bind, GltfProblem> {
        let skin = self.root.skins.get(skin).ok_or(GltfProblem::NoSkin)?;
        let nodes = checked_joints(self.root, skin)?;
        let matrices = skin.inverse_bind_matrices.ok_or(GltfProblem::Skin {
            what: "it has no inverse bind matrices, which tell where the joints rest",
        })?;
        let matrices = self.read(matrices.value(), Type::Mat4)?;
        if matrices.num_rows() < nodes.len() {
            return Err(GltfProblem::Skin {
                what: "it has fewer inverse bind matrices than joints",
            });
        }
        let bone_from_mesh = matrices.rows().take(nodes.len());
        Ok(Bind {
            bone_from_mesh: bone_from_mesh.map(Matrix4::from_column_slice).collect(),
            nodes,
        })
    }
}

/// The joints of several skins, each node once, in the order in which they come.
#[derive(Debug)]
pub(super) struct JointNodes {
    pub nodes: Vec<usize>,
    pub joint_of_node: BTreeMap<usize, usize>,
}

impl JointNodes {
    pub(super) fn of<'a>(binds: impl Iterator<Item = &'a Bind>) -> Self {
        let mut joints = Self {
            nodes: Vec::new(),
            joint_of_node: BTreeMap::new(),
        };
        for bind in binds {
            for &node in &bind.nodes {
                // A skin that names a node twice keeps the numbers of its own list.
                let number = joints.nodes.len();
                if joints.joint_of_node.contains_key(&node) {
                    continue;
                }
                joints.nodes.push(node);
                joints.joint_of_node.insert(node, number);
            }
        }
        joints
    }

    /// The parent of each joint: the nearest joint above it.
    pub(super) fn parents(&self, nodes: &Nodes) -> Vec<Option<usize>> {
        let joint = |node: usize| self.joint_of_node.get(&node).copied();
        let of = |&node: &usize| nodes.nearest_ancestor(node, joint);
        self.nodes.iter().map(of).collect()
    }
}
