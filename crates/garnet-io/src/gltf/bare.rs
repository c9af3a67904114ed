//! Meshes of glTF files that have no skin.

use std::path::Path;

use garnet_mesh::{Point3, TriMesh};
use gltf::json::{Index, Root, mesh::Primitive};
use nalgebra::Matrix4;

use super::{
    GltfProblem, LeftOut, RigPart, container, modes,
    nodes::{self, Nodes},
    rig::{MOST_ELEMENTS, Reader, opened},
    shapes::{self, MeshFrames, Shapes},
};
use crate::{FileError, FileProblem, json};

/// The meshes of a file without skins.
pub(crate) struct Bare {
    /// All as one, where the nodes have them.
    pub(crate) mesh: TriMesh,
    /// Which were read, in the order of their faces, and which were not.
    pub(crate) parts: Vec<RigPart>,
    /// Whether it is a drape that this library wrote.
    pub(crate) is_drape: bool,
}

/// Reads all meshes of a file without skins.
///
/// # Errors
///
/// [`FileError`]: no mesh at all, and those of [`super::read_rig_gltf`].
pub(crate) fn read_bare(path: &Path) -> Result<Bare, FileError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    json::read_with(path, |bytes| {
        opened(bytes, |root, _, binary| joined(root, binary, folder))
    })
}

/// Reads the frames of an animation that changes the shapes of meshes without a skin: positions
/// `[vertex]` of the mesh of [`read_bare`] at each key; none if nothing does.
///
/// # Errors
///
/// Those of [`read_bare`], and keys that make no sense.
pub(crate) fn read_frames(path: &Path) -> Result<Option<MeshFrames>, FileError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    json::read_with(path, |bytes| {
        opened(bytes, |root, _, binary| frames(root, binary, folder))
    })
}

fn frames(
    root: &Root,
    binary: Option<&[u8]>,
    folder: &Path,
) -> Result<Option<MeshFrames>, FileProblem> {
    let file = Reader {
        root,
        buffers: container::buffers(root, binary, folder)?,
    };
    let Some(shapes) = Shapes::read(&file)? else {
        return Ok(None);
    };
    let nodes = Nodes::new(root)?;
    let mut positions: Vec<Vec<Point3>> = Vec::with_capacity(shapes.times().len());
    for &time in shapes.times() {
        let mut frame = Vec::new();
        for (node, content) in root.nodes.iter().enumerate() {
            let mesh = content.mesh.and_then(|mesh| root.meshes.get(mesh.value()));
            let Some(mesh) = mesh else { continue };
            let moved = shapes.weights(node, time);
            let still = content.weights.as_ref().or(mesh.weights.as_ref());
            let morph = moved.as_deref().or(still.map(Vec::as_slice));
            let world = &nodes.world_from_node[node];
            let shown = mesh.primitives.iter().enumerate();
            for (place, primitive) in shown.filter(|(_, primitive)| !modes::is_faceless(primitive))
            {
                frame.extend(placed(&file, (place, primitive), morph, world)?);
            }
            // All frames have as many.
            if frame.len().saturating_mul(shapes.times().len()) > shapes::MOST_POINTS {
                return Err(GltfProblem::TooLarge {
                    most: shapes::MOST_POINTS,
                }
                .into());
            }
        }
        positions.push(frame);
    }
    Ok(Some(MeshFrames {
        positions,
        fps: shapes.fps(),
        nodes: shapes.nodes().map(|node| nodes::name(root, node)).collect(),
    }))
}

/// The vertices of a primitive in the world, with these weights of its morph targets.
fn placed(
    file: &Reader<'_>,
    (place, primitive): (usize, &Primitive),
    morph: Option<&[f32]>,
    world: &Matrix4<f64>,
) -> Result<Vec<Point3>, FileProblem> {
    let source = Reader::bare_source(place, primitive, morph.unwrap_or_default())?;
    let vertices = file.vertices(place, &source)?.positions;
    let placed = vertices.iter().map(|point| world.transform_point(point));
    Ok(placed.map(|point| -> Point3 { point.cast() }).collect())
}

fn joined(root: &Root, binary: Option<&[u8]>, folder: &Path) -> Result<Bare, FileProblem> {
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
        let morph = morph.map(Vec::as_slice);
        let name = nodes::name(root, node);
        let num_before = faces.len();
        if shapes::changes_shape(root, node) {
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
            let vertices = placed(&file, (place, primitive), morph, world)?;
            let first = positions.len() as u32;
            for [a, b, c] in file.faces(place, primitive, vertices.len())? {
                let face = if is_mirrored { [a, c, b] } else { [a, b, c] };
                faces.push(face.map(|corner| first + corner));
            }
            positions.extend(vertices);
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
    let generator = root.asset.generator.as_deref().unwrap_or_default();
    Ok(Bare {
        mesh: TriMesh::new(positions, faces)?,
        parts,
        is_drape: generator.starts_with("garnet "),
    })
}
