//! The node hierarchy: who is whose parent, and where each node stands.

use gltf::json::{Index, Node, Root};
use nalgebra::{Matrix4, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::GltfProblem;

/// Parents and world transforms of all nodes.
#[derive(Debug)]
pub(super) struct Nodes {
    pub parents: Vec<Option<usize>>,
    pub world_from_node: Vec<Matrix4<f64>>,
}

impl Nodes {
    /// Reads the hierarchy; every node has at most one parent, and none is its own ancestor.
    pub(super) fn new(root: &Root) -> Result<Self, GltfProblem> {
        let count = root.nodes.len();
        let mut parents = vec![None; count];
        for (index, node) in root.nodes.iter().enumerate() {
            for child in node.children.iter().flatten() {
                let child = child.value();
                let parent = parents
                    .get_mut(child)
                    .ok_or_else(|| GltfProblem::OutOfRange {
                        user: format!("node {index}"),
                        part: "node",
                        index: child,
                        count,
                    })?;
                if parent.replace(index).is_some() {
                    return Err(cyclic(root, child));
                }
            }
        }
        let roots = (0..count).filter(|&node| parents[node].is_none());
        let mut order: Vec<usize> = roots.collect();
        let mut world_from_node = vec![Matrix4::identity(); count];
        let mut next = 0;
        while let Some(&index) = order.get(next) {
            let node = &root.nodes[index];
            let local = local_transform(node);
            world_from_node[index] = match parents[index] {
                Some(parent) => world_from_node[parent] * local,
                None => local,
            };
            order.extend(node.children.iter().flatten().map(Index::value));
            next += 1;
        }
        if order.len() < count {
            let mut is_reached = vec![false; count];
            for &node in &order {
                is_reached[node] = true;
            }
            let lost = is_reached.iter().position(|&is_reached| !is_reached);
            return Err(cyclic(root, lost.unwrap_or(0)));
        }
        Ok(Self {
            parents,
            world_from_node,
        })
    }

    /// Whether a node is in the scene that the file shows, which is the first where it does not
    /// say.
    pub(super) fn is_shown(&self, root: &Root, node: usize) -> bool {
        let shown = root.scene.as_ref().map_or(0, Index::value);
        let mut top = node;
        while let Some(parent) = self.parents[top] {
            top = parent;
        }
        let scene = root.scenes.get(shown);
        scene.is_none_or(|scene| scene.nodes.iter().any(|node| node.value() == top))
    }

    /// The nearest ancestor that `wanted` maps to something.
    pub(super) fn nearest_ancestor<T>(
        &self,
        node: usize,
        wanted: impl Fn(usize) -> Option<T>,
    ) -> Option<T> {
        let mut node = self.parents[node];
        while let Some(ancestor) = node {
            if let Some(found) = wanted(ancestor) {
                return Some(found);
            }
            node = self.parents[ancestor];
        }
        None
    }
}

fn cyclic(root: &Root, node: usize) -> GltfProblem {
    GltfProblem::CyclicNodes {
        node,
        name: name(root, node),
    }
}

/// The name of a node, or `node_7`.
pub(super) fn name(root: &Root, node: usize) -> String {
    let name = root.nodes.get(node).and_then(|node| node.name.clone());
    name.unwrap_or_else(|| format!("node_{node}"))
}

/// The transform of a node in its parent.
pub(super) fn local_transform(node: &Node) -> Matrix4<f64> {
    if let Some(matrix) = node.matrix {
        return Matrix4::from_column_slice(&matrix.map(f64::from));
    }
    let translation = Vector3::from(node.translation.unwrap_or_default().map(f64::from));
    let [x, y, z, w] = node.rotation.unwrap_or_default().0.map(f64::from);
    let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    let scale = Vector3::from(node.scale.unwrap_or([1.0; 3]).map(f64::from));
    let translation = Translation3::from(translation).to_homogeneous();
    translation * rotation.to_homogeneous() * Matrix4::new_nonuniform_scaling(&scale)
}
