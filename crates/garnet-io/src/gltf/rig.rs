//! A rig out of the skins of a glTF file.

use std::path::Path;

use garnet_body::motion::{Figure, Role, joint_named};
use garnet_mesh::{Bounds, Point3, TriMesh};
use garnet_skin::{Rig, Skeleton, SkinWeights, skin_linear};
use gltf::json::{Index, Root, accessor::Type};
use nalgebra::{Matrix4, Point3 as NaPoint3};

use super::{
    GltfProblem,
    accessor::{self, Fractions, Rows},
    container, extensions, modes,
    nodes::{self, Nodes},
    parts::{Candidate, LeftOut, RigPart, left_out},
    rest::{Placed, Shown},
    skeletons::{Bind, Instance, JointNodes, by_skeleton, instances},
    vertices::{Influences, Source},
    vrm,
};
use crate::{FileError, FileProblem, ReadRig, RigOptions, json};

/// Extensions that hide the geometry.
const COMPRESSIONS: [&str; 3] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
];

/// Reads the body of a GLB, glTF 2.0 or VRM file: all meshes with a skin on one skeleton.
///
/// The body is the one that the file shows: with the turns and scales of the nodes above it and the
/// default weights of its morph targets. Where joints stand in a frame of an animation, the rest
/// mesh is the bind pose and [`Rig::rest_pose`] what is shown. Of several skeletons the one of a
/// human figure with the largest body is read. Joints are in the order of its skins. glTF is in
/// metres, with Y up.
///
/// # Errors
///
/// [`FileError`]: no mesh with a skin, a container or buffer that is cut off, an accessor out of
/// range, nodes in a circle, compressed geometry or another extension that is needed and not known,
/// or an impossible mesh, skeleton or weight.
pub fn read_rig_gltf(path: impl AsRef<Path>) -> Result<Rig, FileError> {
    Ok(read_gltf(path.as_ref(), &RigOptions::default())?.rig)
}

/// The same with a choice of meshes, and what was joined and left out.
pub(crate) fn read_gltf(path: &Path, options: &RigOptions) -> Result<ReadRig, FileError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    json::read_with(path, |bytes| parse(bytes, folder, options))
}

/// A file with its buffers.
pub(super) struct Reader<'a> {
    pub(super) root: &'a Root,
    pub(super) buffers: Vec<Vec<u8>>,
}

impl Reader<'_> {
    pub(super) fn read(&self, index: usize, expected: Type) -> Result<Rows, GltfProblem> {
        accessor::read(
            self.root,
            &self.buffers,
            index,
            expected,
            Fractions::AsDeclared,
        )
    }
}

fn parse(bytes: &[u8], folder: &Path, options: &RigOptions) -> Result<ReadRig, FileProblem> {
    opened(bytes, |root, text, binary| {
        read(root, text, binary, folder, options)
    })
}

/// What `read` makes of the JSON of a file, its text, and the binary chunk beside it.
pub(super) fn opened<T>(
    bytes: &[u8],
    read: impl FnOnce(&Root, &[u8], Option<&[u8]>) -> Result<T, FileProblem>,
) -> Result<T, FileProblem> {
    let (text, binary) = container::split(bytes)?;
    let root: Root = json::parse(text)?;
    if !root.asset.version.starts_with("2.") {
        return Err(GltfProblem::Version {
            found: root.asset.version,
        }
        .into());
    }
    let is_compression = |name: &&String| COMPRESSIONS.contains(&name.as_str());
    if let Some(name) = root.extensions_required.iter().find(is_compression) {
        return Err(GltfProblem::Extension { name: name.clone() }.into());
    }
    if let Some(name) = (root.extensions_required.iter()).find(|name| !extensions::is_known(name)) {
        return Err(GltfProblem::UnknownExtension { name: name.clone() }.into());
    }
    let read = read(&root, text, binary);
    // A file may name a compression without needing it, and have nothing else.
    match (read, root.extensions_used.iter().find(is_compression)) {
        (
            Err(FileProblem::Gltf(
                GltfProblem::Accessor { .. }
                | GltfProblem::Buffer { .. }
                | GltfProblem::Primitive { .. },
            )),
            Some(name),
        ) => Err(GltfProblem::Extension { name: name.clone() }.into()),
        (read, _) => read,
    }
}

fn read(
    root: &Root,
    text: &[u8],
    binary: Option<&[u8]>,
    folder: &Path,
    options: &RigOptions,
) -> Result<ReadRig, FileProblem> {
    let all = instances(root)?;
    let file = Reader {
        root,
        buffers: container::buffers(root, binary, folder)?,
    };
    let nodes = Nodes::new(root)?;
    let humanoid = vrm::humanoid(text);
    let groups = by_skeleton(root, &nodes, &all);
    let mut bodies = Vec::with_capacity(groups.len());
    for group in &groups {
        bodies.push(file.group(group, &nodes, &humanoid, options));
    }
    let num_bodies = bodies.len();
    let mut best: Option<(bool, ReadRig)> = None;
    let mut first_error = None;
    let mut others = Vec::new();
    for (group, body) in groups.iter().zip(bodies) {
        let is_shown = |instance: &Instance| nodes.is_shown(root, instance.node);
        let is_shown = group.iter().any(is_shown);
        let body = match body {
            Ok(body) => (is_shown, body),
            Err(error) => {
                first_error = first_error.or(Some(error));
                continue;
            }
        };
        let is_better = best.as_ref().is_none_or(|best| rank(&body) > rank(best));
        let (kept, other) = if is_better {
            (Some(body), best)
        } else {
            (best, Some(body))
        };
        best = kept;
        others.extend(other.into_iter().flat_map(|(_, other)| other.parts));
    }
    let mut best = match (best, first_error) {
        (Some((_, best)), _) => best,
        (None, Some(error)) => return Err(error),
        (None, None) => return Err(GltfProblem::NoSkin.into()),
    };
    if num_bodies > 1 {
        best.parts.extend(others.into_iter().map(|part| RigPart {
            left_out: Some(LeftOut::OtherSkeleton),
            ..part
        }));
    }
    let is_bare = |node: &gltf::json::Node| node.mesh.is_some() && node.skin.is_none();
    for (node, content) in root
        .nodes
        .iter()
        .enumerate()
        .filter(|(_, node)| is_bare(node))
    {
        let mesh = content.mesh.and_then(|mesh| root.meshes.get(mesh.value()));
        let primitives = mesh.iter().flat_map(|mesh| &mesh.primitives);
        let num_faces = primitives.map(|primitive| modes::most_faces(root, primitive));
        best.parts.push(RigPart {
            name: nodes::name(root, node),
            num_faces: num_faces.sum(),
            left_out: Some(LeftOut::OtherSkeleton),
        });
    }
    Ok(best)
}

/// A human figure comes before other skeletons, then what is in the scene that the file shows, then
/// the larger body.
fn rank((is_shown, read): &(bool, ReadRig)) -> (bool, bool, u32) {
    let rest = read.rig.rest.as_ref();
    let bounds = rest.and_then(|mesh| Bounds::of_faces(mesh.positions(), mesh.faces()));
    let size = bounds.map_or(0.0, |bounds| bounds.diagonal());
    let is_figure = Figure::new(&read.rig.skeleton, "the body").is_ok();
    // Lengths are positive, so that their bits are in their order.
    (is_figure, *is_shown, size.to_bits())
}

/// Vertices, and faces, that are read at most: primitives may be named again and again. Bodies of
/// films have a million.
pub(super) const MOST_ELEMENTS: usize = 1 << 22;

/// A primitive that has been read.
struct Piece {
    instance: usize,
    source: usize,
    faces: Vec<[u32; 3]>,
    names: [Vec<String>; 2],
}

/// The vertices of all pieces.
#[derive(Default)]
struct Pool {
    positions: Vec<NaPoint3<f64>>,
    influences: Vec<Influences>,
    /// The skin of each vertex.
    skins: Vec<usize>,
    num_faces: usize,
    /// Points and lines, which are left out.
    faceless: Vec<RigPart>,
    /// What was read, of which skin, from which vertex on.
    sources: Vec<(Source, usize, usize)>,
}

impl Reader<'_> {
    fn group(
        &self,
        group: &[Instance],
        nodes: &Nodes,
        humanoid: &[(String, usize)],
        options: &RigOptions,
    ) -> Result<ReadRig, FileProblem> {
        let mut skins: Vec<usize> = Vec::new();
        for instance in group {
            if !skins.contains(&instance.skin) {
                skins.push(instance.skin);
            }
        }
        let binds = skins
            .iter()
            .map(|&skin| self.bind(skin))
            .collect::<Result<Vec<Bind>, _>>()?;
        let joints = JointNodes::of(binds.iter());
        let mut pool = Pool::default();
        let mut pieces = Vec::new();
        for (number, instance) in group.iter().enumerate() {
            let skin = skins
                .iter()
                .position(|&skin| skin == instance.skin)
                .unwrap_or(0);
            self.add_mesh((number, instance), skin, &mut pool, &mut pieces)?;
        }
        if pieces.is_empty() && !pool.faceless.is_empty() {
            return Err(GltfProblem::NoTriangles.into());
        }
        let mesh_nodes = skins.iter().map(|skin| {
            let node = group.iter().find(|instance| instance.skin == *skin);
            node.map_or(0, |instance| instance.node)
        });
        let rows = pool.influences.iter().zip(&pool.skins);
        let rows = rows.map(|(row, &skin)| named(row, &binds[skin], &joints));
        let weights = SkinWeights::from_influences(joints.nodes.len(), rows)?;
        let placed = Shown {
            nodes,
            joints: &joints,
            names: joints
                .nodes
                .iter()
                .map(|&node| nodes::name(self.root, node))
                .collect(),
            binds: &binds,
            mesh_nodes: mesh_nodes.collect(),
            positions: &pool.positions,
            skin_of_vertex: &pool.skins,
            weights: &weights,
            labels: (humanoid.iter())
                .filter_map(|(name, node)| Some((name.clone(), *joints.joint_of_node.get(node)?)))
                .collect(),
        }
        .placed()?;
        let shown = shown(&placed, &weights)?;
        let (reasons, mut parts) = Self::chosen(&pieces, &pool, &shown, options)?;
        let kept: Vec<&Piece> = (pieces.iter().zip(&reasons))
            .filter_map(|(piece, reason)| reason.is_none().then_some(piece))
            .collect();
        parts.append(&mut pool.faceless);
        let is_mirrored = is_mirrored(&binds[0], nodes);
        let rig = joined(placed, &weights, &pool, &kept)?;
        let skeleton = if is_mirrored && calls_left_right(&rig.skeleton) {
            swapped(rig.skeleton)
        } else {
            rig.skeleton
        };
        Ok(ReadRig {
            rig: Rig { skeleton, ..rig },
            parts,
        })
    }

    fn add_mesh(
        &self,
        (number, instance): (usize, &Instance),
        skin: usize,
        pool: &mut Pool,
        pieces: &mut Vec<Piece>,
    ) -> Result<(), FileProblem> {
        let mesh = &self.root.meshes[instance.mesh];
        let of_node = self.root.nodes[instance.node].weights.as_ref();
        let morph = of_node
            .or(mesh.weights.as_ref())
            .map_or(&[][..], Vec::as_slice);
        for (place, primitive) in mesh.primitives.iter().enumerate() {
            let object = [&self.root.nodes[instance.node].name, &mesh.name];
            let object: Vec<String> = object.into_iter().flatten().cloned().collect();
            if modes::is_faceless(primitive) {
                RigPart::add_faceless(&mut pool.faceless, object.first());
                continue;
            }
            let source = Self::source(place, primitive, morph)?;
            if pool.positions.len().max(pool.num_faces) > MOST_ELEMENTS {
                return Err(GltfProblem::TooLarge {
                    most: MOST_ELEMENTS,
                }
                .into());
            }
            let known = pool.sources.iter();
            let mut known = known.map(|(other, skin, _)| (other, *skin));
            let known = known.position(|other| other == (&source, skin));
            let source = if let Some(known) = known {
                known
            } else {
                let vertices = self.vertices(place, &source)?;
                let first = pool.positions.len();
                pool.skins.extend(vec![skin; vertices.positions.len()]);
                pool.positions.extend(vertices.positions);
                pool.influences.extend(vertices.influences);
                pool.sources.push((source, skin, first));
                pool.sources.len() - 1
            };
            let first = pool.sources[source].2;
            let end = pool
                .sources
                .get(source + 1)
                .map_or(pool.positions.len(), |next| next.2);
            let faces = self.faces(place, primitive, end - first)?;
            pool.num_faces += faces.len();
            let material = primitive.material.as_ref().map(Index::value);
            let material = material.and_then(|material| self.root.materials.get(material));
            pieces.push(Piece {
                instance: number,
                source,
                faces: faces
                    .iter()
                    .map(|face| face.map(|corner| first as u32 + corner))
                    .collect(),
                names: [
                    object,
                    material
                        .and_then(|material| material.name.clone())
                        .into_iter()
                        .collect(),
                ],
            });
        }
        Ok(())
    }

    /// Why each piece is left out, if it is, and what to say of it.
    fn chosen(
        pieces: &[Piece],
        pool: &Pool,
        shown: &[Point3],
        options: &RigOptions,
    ) -> Result<(Vec<Option<LeftOut>>, Vec<RigPart>), FileProblem> {
        let candidates: Vec<Candidate<'_>> = pieces
            .iter()
            .map(|piece| Candidate {
                names: [0, 1].map(|kind| piece.names[kind].iter().map(String::as_str).collect()),
                faces: &piece.faces,
            })
            .collect();
        debug_assert_eq!(shown.len(), pool.positions.len());
        let reasons = if options.meshes.is_empty() {
            left_out(&candidates, shown)
        } else {
            let is_named = |piece: &Piece, name: &str| {
                let mut names = piece.names.iter().flatten();
                names.any(|other| other.eq_ignore_ascii_case(name))
            };
            for name in &options.meshes {
                if !pieces.iter().any(|piece| is_named(piece, name)) {
                    let mut found: Vec<String> = pieces.iter().map(Piece::name).collect();
                    found.dedup();
                    return Err(GltfProblem::NoMesh {
                        name: name.clone(),
                        found,
                    }
                    .into());
                }
            }
            let reason = |piece: &Piece| {
                let is_chosen = options.meshes.iter().any(|name| is_named(piece, name));
                (!is_chosen).then_some(LeftOut::NotChosen)
            };
            pieces.iter().map(reason).collect()
        };
        let mut parts: Vec<(usize, RigPart)> = Vec::new();
        for (piece, &left_out) in pieces.iter().zip(&reasons) {
            let num_faces = piece.faces.len();
            // The primitives of a mesh that share a fate are one part.
            let same = parts
                .iter_mut()
                .find(|(instance, part)| *instance == piece.instance && part.left_out == left_out);
            match same {
                Some((_, part)) => part.num_faces += num_faces,
                None => parts.push((
                    piece.instance,
                    RigPart {
                        name: piece.name(),
                        num_faces,
                        left_out,
                    },
                )),
            }
        }
        // What is joined and what is not are told apart by their materials.
        for index in 0..parts.len() {
            let (instance, reason) = (parts[index].0, parts[index].1.left_out);
            if parts.iter().filter(|(other, _)| *other == instance).count() > 1 {
                let mut pieces = pieces.iter().zip(&reasons);
                let own =
                    pieces.find(|(piece, other)| piece.instance == instance && **other == reason);
                if let Some(material) = own.and_then(|(piece, _)| piece.names[1].first()) {
                    parts[index].1.name.push('/');
                    parts[index].1.name.push_str(material);
                }
            }
        }
        Ok((reasons, parts.into_iter().map(|(_, part)| part).collect()))
    }
}

impl Piece {
    fn name(&self) -> String {
        let name = self.names[0].first().or(self.names[1].first());
        name.cloned().unwrap_or_else(|| "unnamed".to_owned())
    }
}

/// Influences on joints of a skin as those on joints of the skeleton.
fn named(row: &Influences, bind: &Bind, joints: &JointNodes) -> Influences {
    let of = |&(slot, weight): &(usize, f32)| match bind.nodes.get(slot) {
        Some(node) => Some((joints.joint_of_node[node], weight)),
        // Unused slots may name anything.
        None => (weight != 0.0).then_some((joints.nodes.len() + slot, weight)),
    };
    let mut merged: Influences = Vec::with_capacity(row.len());
    for (joint, weight) in row.iter().filter_map(of) {
        match merged.iter_mut().find(|(other, _)| *other == joint) {
            Some((_, sum)) => *sum += weight,
            None => merged.push((joint, weight)),
        }
    }
    merged
}

/// Where vertices are as the file shows them.
fn shown(placed: &Placed, weights: &SkinWeights) -> Result<Vec<Point3>, FileProblem> {
    let Some(pose) = &placed.pose else {
        return Ok(placed.rest.clone());
    };
    let transforms = placed.skeleton.transforms(pose)?;
    Ok(skin_linear(&placed.rest, weights, &transforms))
}

/// The pieces of the body as one mesh, without vertices that only others name.
fn joined(
    placed: Placed,
    weights: &SkinWeights,
    pool: &Pool,
    pieces: &[&Piece],
) -> Result<Rig, FileProblem> {
    let mut is_kept = vec![false; pool.sources.len()];
    for piece in pieces {
        is_kept[piece.source] = true;
    }
    let mut number = vec![0_u32; pool.positions.len()];
    let mut kept = Vec::with_capacity(pool.positions.len());
    for (source, (_, _, first)) in pool
        .sources
        .iter()
        .enumerate()
        .filter(|&(source, _)| is_kept[source])
    {
        let end = pool
            .sources
            .get(source + 1)
            .map_or(pool.positions.len(), |next| next.2);
        for (vertex, number) in number.iter_mut().enumerate().take(end).skip(*first) {
            *number = kept.len() as u32;
            kept.push(vertex);
        }
    }
    let faces = pieces.iter().flat_map(|piece| &piece.faces);
    let faces = faces.map(|face| face.map(|corner| number[corner as usize]));
    let positions = kept.iter().map(|&vertex| placed.rest[vertex]).collect();
    let rows = kept.iter().map(|&vertex| weights.vertex(vertex));
    Ok(Rig {
        rest: Some(TriMesh::new(positions, faces.collect())?),
        weights: SkinWeights::from_influences(placed.skeleton.num_joints(), rows)?,
        skeleton: placed.skeleton,
        rest_pose: placed.pose,
    })
}

/// Whether a file shows the mirror image of what was modelled.
fn is_mirrored(bind: &Bind, nodes: &Nodes) -> bool {
    let first = bind.nodes.first().zip(bind.bone_from_mesh.first());
    let determinant = |matrix: Matrix4<f64>| matrix.fixed_view::<3, 3>(0, 0).determinant();
    first.is_some_and(|(&node, matrix)| determinant(nodes.world_from_node[node] * matrix) < 0.0)
}

/// Whether the joints that are called left are on the right of a body without toes, where y points
/// up and it looks along z. A model may be turned into its mirror image with names that are right
/// before that, or after it. Toes tell the sides of a [figure](garnet_body::motion::Figure)
/// themselves.
fn calls_left_right(skeleton: &Skeleton) -> bool {
    let named = |name: &str| joint_named(skeleton, name);
    let has_toes = ["left_foot", "right_foot"].map(|name| named(name).is_some()) == [true; 2];
    let x = |name: &str| Some(skeleton.joints()[named(name)?].rest_position.x);
    let pairs = ["hip", "shoulder", "elbow", "knee"];
    let pairs = pairs.map(|part| Some(x(&format!("left_{part}"))? - x(&format!("right_{part}"))?));
    let across: f32 = pairs.iter().flatten().sum();
    !has_toes && across < 0.0
}

/// A skeleton whose left is called right: each joint is told to be that of its other side.
fn swapped(skeleton: Skeleton) -> Skeleton {
    let other = |name: &str| match name.split_once('_') {
        Some(("left", rest)) => format!("right_{rest}"),
        Some(("right", rest)) => format!("left_{rest}"),
        _ => name.to_owned(),
    };
    let roles = Role::ALL.into_iter();
    let labels: Vec<(String, usize)> = roles
        .filter_map(|role| Some((other(role.name()), joint_named(&skeleton, role.name())?)))
        .collect();
    skeleton.with_labels(labels)
}

#[cfg(test)]
mod tests {
    use garnet_skin::Joint;

    use super::*;
    use crate::motion::smpl_skeleton;

    #[test]
    fn names_are_of_the_other_side_of_a_mirrored_body_without_toes() {
        let skeleton = smpl_skeleton().unwrap();
        let mirrored = |toes: &str| {
            let joints = skeleton.joints().iter().map(|joint| Joint {
                name: joint.name.replace("foot", toes),
                rest_position: Point3::new(
                    -joint.rest_position.x,
                    joint.rest_position.y,
                    joint.rest_position.z,
                ),
                ..joint.clone()
            });
            Skeleton::new(joints.collect()).unwrap()
        };
        assert!(!calls_left_right(&skeleton));
        assert!(calls_left_right(&mirrored("tip")));
        // Of these the figure knows.
        assert!(!calls_left_right(&mirrored("foot")));
        let figure = Figure::new(&mirrored("foot"), "the body").unwrap();
        assert!(figure.has_other_sides());
    }
}
