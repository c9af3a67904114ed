//! A rig out of a glTF skin.

use std::path::Path;

use garnet_mesh::TriMesh;
use garnet_skin::{Joint, Rig, Skeleton, SkinWeights};
use gltf::json::{
    Index, Mesh, Root, Skin,
    accessor::Type,
    mesh::{Mode, Primitive, Semantic},
    validation::Checked,
};
use nalgebra::{Matrix4, Point3 as NaPoint3};

use super::{
    GltfProblem,
    accessor::{self, Fractions, Rows},
    container, nodes,
    nodes::Nodes,
};
use crate::{FileError, FileProblem, json};

/// Extensions that hide the geometry; all others that a file may need do not change it.
const COMPRESSIONS: [&str; 2] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression"];

/// How far the transforms of two joints may differ and still be one transform of the whole rig,
/// relative to their largest entry.
const SAME_TRANSFORM: f64 = 1e-4;

/// Reads the first mesh with a skin out of a GLB or glTF 2.0 file.
///
/// The primitives of the mesh are joined one after the other. Joints stand where the inverse bind
/// matrices put them, in the order of the skin. If the file shows the mesh in its bind pose, then
/// it is read as shown, in world space; if it shows it in another pose, then the bind pose is
/// read, in the mesh's own axes and the size that is shown. glTF is in metres, with Y up.
///
/// # Errors
///
/// [`FileError`]: no mesh with a skin, a container or buffer that is cut off, an accessor out of
/// range, nodes in a circle, compressed geometry, or an impossible mesh, skeleton or weight.
pub fn read_rig_gltf(path: impl AsRef<Path>) -> Result<Rig, FileError> {
    let path = path.as_ref();
    let folder = path.parent().unwrap_or(Path::new(""));
    json::read_with(path, |bytes| parse(bytes, folder))
}

fn parse(bytes: &[u8], folder: &Path) -> Result<Rig, FileProblem> {
    let (text, binary) = container::split(bytes)?;
    let root: Root = json::parse(text)?;
    if !root.asset.version.starts_with("2.") {
        return Err(GltfProblem::Version {
            found: root.asset.version,
        }
        .into());
    }
    let required = &root.extensions_required;
    if let Some(name) = required
        .iter()
        .find(|name| COMPRESSIONS.contains(&name.as_str()))
    {
        return Err(GltfProblem::Extension { name: name.clone() }.into());
    }
    let (mesh, skin) = skinned_mesh(&root)?;
    let buffers = container::buffers(&root, binary, folder)?;
    let file = Reader {
        root: &root,
        buffers,
    };
    let (shown_from_mesh, joints) = file.joints(skin)?;
    let skeleton = Skeleton::new(joints)?;

    let mut vertices = Vertices::default();
    for (number, primitive) in mesh.primitives.iter().enumerate() {
        file.add_primitive(number, primitive, &mut vertices)?;
    }
    let points = vertices.positions.iter();
    let positions = points.map(|point| shown_from_mesh.transform_point(point).cast());
    Ok(Rig {
        rest: Some(TriMesh::new(positions.collect(), vertices.faces)?),
        weights: SkinWeights::from_influences(skeleton.num_joints(), vertices.influences)?,
        skeleton,
        rest_pose: None,
    })
}

fn skinned_mesh(root: &Root) -> Result<(&Mesh, &Skin), GltfProblem> {
    let has_both = |node: &gltf::json::Node| node.mesh.zip(node.skin);
    let found = root
        .nodes
        .iter()
        .enumerate()
        .find_map(|(index, node)| has_both(node).map(|both| (index, both)));
    let (node, (mesh, skin)) = found.ok_or(GltfProblem::NoSkin)?;
    let missing = |part, index, count| GltfProblem::OutOfRange {
        user: format!("node {node}"),
        part,
        index,
        count,
    };
    let (mesh, skin) = (mesh.value(), skin.value());
    Ok((
        root.meshes
            .get(mesh)
            .ok_or_else(|| missing("mesh", mesh, root.meshes.len()))?,
        root.skins
            .get(skin)
            .ok_or_else(|| missing("skin", skin, root.skins.len()))?,
    ))
}

/// Vertices and faces of the primitives so far.
#[derive(Debug, Default)]
struct Vertices {
    positions: Vec<NaPoint3<f64>>,
    influences: Vec<Vec<(usize, f32)>>,
    faces: Vec<[u32; 3]>,
    /// Accessors of positions, joints and weights that have been read, and their first vertex.
    sources: Vec<(Vec<usize>, usize)>,
}

struct Reader<'a> {
    root: &'a Root,
    buffers: Vec<Vec<u8>>,
}

impl Reader<'_> {
    fn read(&self, index: usize, expected: Type) -> Result<Rows, GltfProblem> {
        accessor::read(
            self.root,
            &self.buffers,
            index,
            expected,
            Fractions::AsDeclared,
        )
    }

    /// The transform from the mesh's space to the rig's, and the joints in the rig's space.
    fn joints(&self, skin: &Skin) -> Result<(Matrix4<f64>, Vec<Joint>), FileProblem> {
        let nodes = Nodes::new(self.root)?;
        let numbers: Vec<usize> = skin.joints.iter().map(Index::value).collect();
        let count = self.root.nodes.len();
        if let Some(&index) = numbers.iter().find(|&&node| node >= count) {
            return Err(GltfProblem::OutOfRange {
                user: "the skin".to_owned(),
                part: "node",
                index,
                count,
            }
            .into());
        }
        let matrices = skin.inverse_bind_matrices.ok_or(GltfProblem::Skin {
            what: "it has no inverse bind matrices, which tell where the joints rest",
        })?;
        let matrices = self.read(matrices.value(), Type::Mat4)?;
        if matrices.num_rows() < numbers.len() {
            return Err(GltfProblem::Skin {
                what: "it has fewer inverse bind matrices than joints",
            }
            .into());
        }
        let bone_from_mesh: Vec<Matrix4<f64>> =
            matrices.rows().map(Matrix4::from_column_slice).collect();
        let pairs = numbers.iter().zip(&bone_from_mesh);
        let shown: Vec<Matrix4<f64>> = pairs
            .map(|(&node, matrix)| nodes.world_from_node[node] * matrix)
            .collect();
        let shown_from_mesh = common_transform(&shown);

        let mut joint_of_node = vec![None; count];
        for (joint, &node) in numbers.iter().enumerate().rev() {
            joint_of_node[node] = Some(joint);
        }
        let mut joints = Vec::with_capacity(numbers.len());
        for (&node, matrix) in numbers.iter().zip(&bone_from_mesh) {
            let name = nodes::name(self.root, node);
            let mesh_from_bone =
                matrix
                    .try_inverse()
                    .ok_or_else(|| GltfProblem::SingularBindMatrix {
                        joint: name.clone(),
                    })?;
            let in_mesh = mesh_from_bone.transform_point(&NaPoint3::origin());
            joints.push(Joint {
                name,
                parent: nodes.nearest_ancestor(node, |node| joint_of_node[node]),
                rest_position: shown_from_mesh.transform_point(&in_mesh).cast(),
            });
        }
        Ok((shown_from_mesh, joints))
    }

    fn add_primitive(
        &self,
        number: usize,
        primitive: &Primitive,
        vertices: &mut Vertices,
    ) -> Result<(), FileProblem> {
        let wrong = |what| GltfProblem::Primitive {
            primitive: number,
            what,
        };
        if primitive.mode != Checked::Valid(Mode::Triangles) {
            return Err(wrong("it is not made of triangles").into());
        }
        let attribute = |semantic| {
            let index: Option<&Index<_>> = primitive.attributes.get(&Checked::Valid(semantic));
            index.map(Index::value)
        };
        let positions = attribute(Semantic::Positions).ok_or(wrong("it has no positions"))?;
        let sets: Vec<(usize, usize)> = (0..)
            .map_while(|set| {
                attribute(Semantic::Joints(set)).zip(attribute(Semantic::Weights(set)))
            })
            .collect();
        if sets.is_empty() {
            return Err(wrong("it has no joints or weights").into());
        }
        let mut source = vec![positions];
        source.extend(sets.iter().flat_map(|&(joints, weights)| [joints, weights]));
        let known = vertices.sources.iter().find(|(known, _)| *known == source);
        let first = if let Some(&(_, first)) = known {
            first
        } else {
            let first = vertices.positions.len();
            self.add_vertices(positions, &sets, vertices, wrong)?;
            vertices.sources.push((source, first));
            first
        };
        let positions = self.root.accessors.get(positions);
        let num_vertices = positions.map_or(0, |accessor| accessor.count.0 as usize);
        let corners: Vec<usize> = match primitive.indices {
            Some(indices) => {
                let values = self.read(indices.value(), Type::Scalar)?.values;
                let numbers = values.into_iter().map(accessor::whole);
                let numbers: Option<Vec<usize>> = numbers.collect();
                numbers.ok_or(wrong("an index is no whole number"))?
            }
            None => (0..num_vertices).collect(),
        };
        if !corners.len().is_multiple_of(3) {
            return Err(wrong("its indices do not divide into triangles").into());
        }
        if let Some(&index) = corners.iter().find(|&&corner| corner >= num_vertices) {
            return Err(GltfProblem::OutOfRange {
                user: format!("primitive {number}"),
                part: "vertex",
                index,
                count: num_vertices,
            }
            .into());
        }
        let corner = |corner: usize| (first + corner) as u32;
        let triangles = corners.chunks_exact(3);
        vertices
            .faces
            .extend(triangles.map(|face| [corner(face[0]), corner(face[1]), corner(face[2])]));
        Ok(())
    }

    fn add_vertices(
        &self,
        positions: usize,
        sets: &[(usize, usize)],
        vertices: &mut Vertices,
        wrong: impl Fn(&'static str) -> GltfProblem,
    ) -> Result<(), FileProblem> {
        let points = self.read(positions, Type::Vec3)?;
        let rows = points
            .rows()
            .map(|row| NaPoint3::new(row[0], row[1], row[2]));
        vertices.positions.extend(rows);
        let mut influences = vec![Vec::with_capacity(4); points.num_rows()];
        for &(joints, weights) in sets {
            let joints = self.read(joints, Type::Vec4)?;
            let weights = accessor::read(
                self.root,
                &self.buffers,
                weights,
                Type::Vec4,
                Fractions::Always,
            )?;
            if joints.num_rows() != points.num_rows() || weights.num_rows() != points.num_rows() {
                return Err(
                    wrong("it has another number of joints or weights than of positions").into(),
                );
            }
            let rows = joints.rows().zip(weights.rows()).zip(&mut influences);
            for ((joints, weights), influences) in rows {
                for (&joint, &weight) in joints.iter().zip(weights) {
                    let joint = accessor::whole(joint);
                    let joint = joint.ok_or_else(|| wrong("a joint is no whole number"))?;
                    influences.push((joint, weight as f32));
                }
            }
        }
        vertices.influences.extend(influences);
        Ok(())
    }
}

/// The one transform that all joints give the mesh as shown, or else its size alone.
fn common_transform(shown_from_mesh: &[Matrix4<f64>]) -> Matrix4<f64> {
    let Some(first) = shown_from_mesh.first() else {
        return Matrix4::identity();
    };
    let tolerance = SAME_TRANSFORM * first.abs().max();
    let is_same = |other: &Matrix4<f64>| (other - first).abs().max() <= tolerance;
    if shown_from_mesh.iter().all(is_same) {
        return *first;
    }
    let volume: f64 = first.fixed_view::<3, 3>(0, 0).determinant();
    Matrix4::new_scaling(volume.abs().cbrt())
}
