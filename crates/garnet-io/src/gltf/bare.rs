//! Meshes of glTF files that have no skin.

use std::path::Path;

use garnet_mesh::{Point3, TriMesh};
use gltf::json::animation::Property;
use gltf::json::validation::Checked;
use gltf::json::{Index, Root};

use super::{
    GltfProblem, LeftOut, RigPart, container, modes,
    nodes::{self, Nodes},
    rig::{MOST_ELEMENTS, Reader, opened},
};
use crate::{FileError, FileProblem, json};

/// Reads all meshes of a file without skins as one, where its nodes have them, and tells which were
/// read, in the order of their faces, and which were not.
///
/// # Errors
///
/// [`FileError`]: no mesh at all, and those of [`super::read_rig_gltf`].
pub(crate) fn read_bare(path: &Path) -> Result<(TriMesh, Vec<RigPart>), FileError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    json::read_with(path, |bytes| {
        opened(bytes, |root, _, binary| joined(root, binary, folder))
    })
}

/// Whether an animation changes the shape of the mesh of a node.
fn changes_shape(root: &Root, node: usize) -> bool {
    let channels = root.animations.iter().flat_map(|clip| &clip.channels);
    let mut targets = channels.map(|channel| &channel.target);
    targets.any(|target| {
        let is_shape = matches!(target.path, Checked::Valid(Property::MorphTargetWeights));
        is_shape && target.node.value() == node
    })
}

fn joined(
    root: &Root,
    binary: Option<&[u8]>,
    folder: &Path,
) -> Result<(TriMesh, Vec<RigPart>), FileProblem> {
    let file = Reader {
        root,
        buffers: container::buffers(root, binary, folder)?,
    };
    let nodes = Nodes::new(root)?;
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    let (mut parts, mut faceless) = (Vec::new(), Vec::new());
    for (node, content) in root.nodes.iter().enumerate() {
        let Some(index) = content.mesh.as_ref().map(Index::value) else {
            continue;
        };
        let Some(mesh) = root.meshes.get(index) else {
            return Err(GltfProblem::OutOfRange {
                user: format!("node {node}"),
                part: "mesh",
                index,
                count: root.meshes.len(),
            }
            .into());
        };
        let world = &nodes.world_from_node[node];
        let is_mirrored = world.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
        let morph = content.weights.as_ref().or(mesh.weights.as_ref());
        let morph = morph.map_or(&[][..], Vec::as_slice);
        let name = nodes::name(root, node);
        let num_before = faces.len();
        if changes_shape(root, node) {
            RigPart::add_left_out(&mut faceless, Some(&name), LeftOut::LaterShapes);
        }
        for (place, primitive) in mesh.primitives.iter().enumerate() {
            if positions.len().max(faces.len()) > MOST_ELEMENTS {
                return Err(GltfProblem::TooLarge {
                    most: MOST_ELEMENTS,
                }
                .into());
            }
            if modes::is_faceless(primitive) {
                RigPart::add_faceless(&mut faceless, Some(&name));
                continue;
            }
            let source = Reader::bare_source(place, primitive, morph)?;
            let vertices = file.vertices(place, &source)?.positions;
            let first = positions.len() as u32;
            for [a, b, c] in file.faces(place, primitive, vertices.len())? {
                let face = if is_mirrored { [a, c, b] } else { [a, b, c] };
                faces.push(face.map(|corner| first + corner));
            }
            let placed = vertices.iter().map(|point| world.transform_point(point));
            positions.extend(placed.map(|point| -> Point3 { point.cast() }));
        }
        if faces.len() > num_before {
            parts.push(RigPart {
                name,
                num_faces: faces.len() - num_before,
                left_out: None,
            });
        }
    }
    if faces.is_empty() && !faceless.is_empty() {
        return Err(GltfProblem::NoTriangles.into());
    }
    if faces.is_empty() {
        return Err(GltfProblem::NoSkin.into());
    }
    parts.append(&mut faceless);
    Ok((TriMesh::new(positions, faces)?, parts))
}
