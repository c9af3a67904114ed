//! Files of moving meshes, read back byte by byte.

#![allow(
    clippy::float_cmp,
    clippy::too_many_lines,
    clippy::unnecessary_wraps,
    reason = "numbers are copied, a file is read to its end"
)]
#![expect(
    clippy::unwrap_used,
    reason = "in a test that is a failure as good as any other"
)]

use std::{fs, path::Path};

use garnet_io::{CacheError, CacheKind, CachePart, CacheWriter, Frame, NpzFile, ObjFile};
use garnet_mesh::{Point3, TriMesh, Unit, UpAxis, Vector3, primitives::icosphere};

/// A square with a seam of the texture along its diagonal, of two materials.
const SQUARE: &str = "mtllib square.mtl\no flag\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
                      vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.5 0.25\n\
                      usemtl red\nf 1/1 2/2 3/3\nusemtl blue\nf 1/1 3/5 4/4\n";
const MATERIALS: &str = "newmtl red\nKd 1 0.5 0.25\nmap_Kd red.png\nnewmtl blue\nd 0.5\n";
/// Told by its first bytes.
const PICTURE: &[u8] = b"\x89PNG\r\n\x1a\npicture";

const FPS: f64 = 25.0;

fn square(folder: &Path) -> ObjFile {
    fs::write(folder.join("square.obj"), SQUARE).unwrap();
    fs::write(folder.join("square.mtl"), MATERIALS).unwrap();
    fs::write(folder.join("red.png"), PICTURE).unwrap();
    ObjFile::read(folder.join("square.obj")).unwrap()
}

/// Frame `k` of positions that rise and turn over.
fn moved(positions: &[Point3], k: usize) -> Vec<Point3> {
    let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), 0.7 * k as f32);
    let up = Vector3::new(0.0, 0.25 * k as f32, 0.0);
    positions.iter().map(|point| turn * point + up).collect()
}

/// Writes some frames, and gives the positions of all.
fn written(
    path: &Path,
    parts: Vec<CachePart>,
    rests: &[&[Point3]],
    frames: usize,
) -> Vec<Vec<Vec<Point3>>> {
    let kind = CacheKind::of(path).unwrap();
    let mut cache = CacheWriter::create(path, kind, parts, frames, FPS).unwrap();
    let all = (0..frames).map(|k| {
        let positions: Vec<Vec<Point3>> = rests.iter().map(|rest| moved(rest, k)).collect();
        let slices: Vec<&[Point3]> = positions.iter().map(Vec::as_slice).collect();
        cache.push(&slices).unwrap();
        assert!(!path.exists());
        positions
    });
    let all = all.collect();
    cache.finish().unwrap();
    all
}

fn words(bytes: &[u8]) -> Vec<[u8; 4]> {
    let (words, rest) = bytes.as_chunks::<4>();
    assert!(rest.is_empty());
    words.to_vec()
}

#[test]
fn pc2_is_what_blender_reads() {
    let folder = tempfile::tempdir().unwrap();
    let (file, path) = (square(folder.path()), folder.path().join("flag.pc2"));
    // Positions stay in the unit and axes of the garment's file.
    let frame = Frame {
        unit: Unit::Centimetre,
        up: UpAxis::Z,
    };
    let part = CachePart::of_obj(&file, frame);
    let frames = written(&path, vec![part], &[file.positions()], 3);
    let bytes = fs::read(&path).unwrap();
    assert_eq!(&bytes[..12], b"POINTCACHE2\0");
    let header = words(&bytes[12..32]);
    assert_eq!(i32::from_le_bytes(header[0]), 1);
    assert_eq!(i32::from_le_bytes(header[1]), 4);
    assert_eq!(f32::from_le_bytes(header[2]).to_bits(), 0.0_f32.to_bits());
    assert_eq!(f32::from_le_bytes(header[3]).to_bits(), 1.0_f32.to_bits());
    assert_eq!(i32::from_le_bytes(header[4]), 3);
    let floats: Vec<f32> = words(&bytes[32..])
        .into_iter()
        .map(f32::from_le_bytes)
        .collect();
    let expected = frames
        .iter()
        .flat_map(|parts| frame.to_file(parts[0].clone()));
    let expected: Vec<f32> = expected
        .flat_map(|point| [point.x, point.y, point.z])
        .collect();
    assert_eq!(floats, expected);
}

#[test]
fn mdd_is_big_endian_with_the_times_first() {
    let folder = tempfile::tempdir().unwrap();
    let (file, path) = (square(folder.path()), folder.path().join("flag.mdd"));
    let part = CachePart::of_obj(&file, Frame::OURS);
    let frames = written(&path, vec![part], &[file.positions()], 3);
    let bytes = words(&fs::read(&path).unwrap());
    assert_eq!([bytes[0], bytes[1]].map(u32::from_be_bytes), [3, 4]);
    let floats: Vec<f32> = bytes[2..].iter().copied().map(f32::from_be_bytes).collect();
    assert_eq!(floats[..3], [0.0, 0.04, 0.08]);
    let expected = frames.iter().flat_map(|parts| &parts[0]);
    let expected: Vec<f32> = expected
        .flat_map(|point| [point.x, point.y, point.z])
        .collect();
    assert_eq!(floats[3..], expected);
}

#[test]
fn npz_holds_vertices_faces_and_frames_a_second() {
    let folder = tempfile::tempdir().unwrap();
    let (file, path) = (square(folder.path()), folder.path().join("flag.npz"));
    let part = CachePart::of_obj(&file, Frame::OURS);
    let frames = written(&path, vec![part], &[file.positions()], 2);
    let mut npz = NpzFile::open(&path).unwrap();
    let vertices = npz.array("vertices").unwrap().unwrap();
    assert_eq!(vertices.shape, [2, 4, 3]);
    let expected = frames.iter().flat_map(|parts| &parts[0]);
    let expected: Vec<f64> = expected
        .flat_map(|point| [point.x, point.y, point.z].map(f64::from))
        .collect();
    assert_eq!(vertices.floats().unwrap(), expected);
    let faces = npz.array("faces").unwrap().unwrap();
    assert_eq!(faces.shape, [2, 3]);
    assert_eq!(faces.integers().unwrap(), [0, 1, 2, 0, 2, 3]);
    let fps = npz.array("fps").unwrap().unwrap();
    assert!(fps.shape.is_empty());
    assert_eq!(fps.floats().unwrap(), [FPS]);
}

/// A GLB as another reader sees it.
struct Seen {
    document: gltf::Document,
    binary: Vec<u8>,
}

impl Seen {
    fn read(path: &Path) -> Self {
        let bytes = fs::read(path).unwrap();
        // With all that the specification asks for.
        let gltf = gltf::Gltf::from_slice(&bytes).unwrap();
        Self {
            document: gltf.document,
            binary: gltf.blob.unwrap(),
        }
    }

    fn buffer(&self, buffer: &gltf::Buffer<'_>) -> Option<&[u8]> {
        assert_eq!(buffer.length(), self.binary.len());
        Some(&self.binary)
    }

    /// Positions of a part at the time of a frame, from target weights of the animation.
    fn frame(&self, part: usize, frame: usize) -> Vec<[f32; 3]> {
        let mesh = self.document.meshes().nth(part).unwrap();
        let primitive = mesh.primitives().next().unwrap();
        let reader = primitive.reader(|buffer| self.buffer(&buffer));
        let mut positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
        let Some(animation) = self.document.animations().next() else {
            return positions;
        };
        let channel = animation
            .channels()
            .find(|channel| channel.target().node().mesh().unwrap().index() == part);
        let channel = channel.unwrap();
        let reader_of_channel = channel.reader(|buffer| self.buffer(&buffer));
        let times: Vec<f32> = reader_of_channel.read_inputs().unwrap().collect();
        assert!((times[frame] - frame as f32 / FPS as f32).abs() < 1e-6);
        let outputs = match reader_of_channel.read_outputs().unwrap() {
            gltf::animation::util::ReadOutputs::MorphTargetWeights(weights) => {
                weights.into_f32().collect::<Vec<f32>>()
            }
            _ => panic!("weights are animated"),
        };
        let num_targets = times.len() - 1;
        let weights = &outputs[frame * num_targets..][..num_targets];
        for ((moves, _, _), weight) in reader.read_morph_targets().zip(weights) {
            for (position, moved) in positions.iter_mut().zip(moves.unwrap()) {
                for axis in 0..3 {
                    position[axis] += weight * moved[axis];
                }
            }
        }
        positions
    }
}

fn near(found: &[f32; 3], expected: &Point3) -> bool {
    (Point3::from(*found) - expected).norm() < 1e-6
}

#[test]
fn glb_holds_garment_and_body_in_every_frame() {
    let folder = tempfile::tempdir().unwrap();
    let (file, path) = (square(folder.path()), folder.path().join("flag.glb"));
    let ball = icosphere(1, 0.5);
    // Whatever the unit of the file, a GLB is in metres with y up.
    let frame = Frame {
        unit: Unit::Centimetre,
        up: UpAxis::Z,
    };
    let parts = vec![
        CachePart::of_obj(&file, frame),
        CachePart::of_mesh("ball", &ball, Frame::OURS),
    ];
    let frames = written(&path, parts, &[file.positions(), ball.positions()], 4);
    let seen = Seen::read(&path);
    let names: Vec<_> = seen
        .document
        .nodes()
        .map(|node| node.name().unwrap().to_owned())
        .collect();
    assert_eq!(names, ["flag", "ball"]);
    // The first vertex is at one texture coordinate, the third at two, on either side of the seam.
    let source = [0, 1, 2, 2, 3];
    for (number, parts) in frames.iter().enumerate() {
        let flag = seen.frame(0, number);
        assert_eq!(flag.len(), source.len());
        assert!(
            flag.iter()
                .zip(source)
                .all(|(found, vertex)| near(found, &parts[0][vertex]))
        );
        let ball = seen.frame(1, number);
        assert_eq!(ball.len(), parts[1].len());
        assert!(
            ball.iter()
                .zip(&parts[1])
                .all(|(found, expected)| near(found, expected))
        );
    }
    let mesh = seen.document.meshes().next().unwrap();
    let mut corners = Vec::new();
    for primitive in mesh.primitives() {
        let reader = primitive.reader(|buffer| seen.buffer(&buffer));
        let texture: Vec<[f32; 2]> = reader.read_tex_coords(0).unwrap().into_f32().collect();
        let material = primitive.material();
        let faces = reader.read_indices().unwrap().into_u32();
        corners.extend(faces.map(|vertex| {
            let [u, v] = texture[vertex as usize];
            (
                material.name().unwrap().to_owned(),
                source[vertex as usize],
                [u, 1.0 - v],
            )
        }));
        for normal in reader.read_normals().unwrap() {
            assert_eq!(normal, [0.0, 0.0, 1.0]);
        }
    }
    let expected = [
        ("red", 0, [0.0, 0.0]),
        ("red", 1, [1.0, 0.0]),
        ("red", 2, [1.0, 1.0]),
        ("blue", 0, [0.0, 0.0]),
        ("blue", 2, [0.5, 0.25]),
        ("blue", 3, [0.0, 1.0]),
    ];
    let expected = expected.map(|(name, vertex, uv)| (name.to_owned(), vertex, uv));
    assert_eq!(corners, expected);
    let [red, blue] = [0, 1].map(|number| seen.document.materials().nth(number).unwrap());
    let look = red.pbr_metallic_roughness();
    assert_eq!(look.base_color_factor(), [1.0, 0.5, 0.25, 1.0]);
    let image = look
        .base_color_texture()
        .unwrap()
        .texture()
        .source()
        .source();
    match image {
        gltf::image::Source::View { view, mime_type } => {
            assert_eq!(mime_type, "image/png");
            assert_eq!(&seen.binary[view.offset()..][..view.length()], PICTURE);
        }
        gltf::image::Source::Uri { .. } => panic!("the picture is in the file"),
    }
    assert_eq!(
        blue.pbr_metallic_roughness().base_color_factor(),
        [1.0, 1.0, 1.0, 0.5]
    );
}

#[test]
fn a_glb_of_one_frame_stands_still() {
    let folder = tempfile::tempdir().unwrap();
    let (ball, path) = (icosphere(1, 0.5), folder.path().join("ball.glb"));
    let part = CachePart::of_mesh("ball", &ball, Frame::OURS);
    let frames = written(&path, vec![part], &[ball.positions()], 1);
    let seen = Seen::read(&path);
    assert_eq!(seen.document.animations().count(), 0);
    let found = seen.frame(0, 0);
    assert!(
        found
            .iter()
            .zip(&frames[0][0])
            .all(|(found, expected)| near(found, expected))
    );
    let faces: Vec<u32> = {
        let mesh = seen.document.meshes().next().unwrap();
        let primitive = mesh.primitives().next().unwrap();
        let reader = primitive.reader(|buffer| seen.buffer(&buffer));
        reader.read_indices().unwrap().into_u32().collect()
    };
    assert_eq!(faces, ball.faces().as_flattened());
}

#[test]
fn what_is_not_finished_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let ball = icosphere(0, 0.5);
    for name in ["ball.pc2", "ball.mdd", "ball.npz", "ball.glb"] {
        let path = folder.path().join(name);
        fs::write(&path, "old").unwrap();
        let part = CachePart::of_mesh("ball", &ball, Frame::OURS);
        let kind = CacheKind::of(&path).unwrap();
        let mut cache = CacheWriter::create(&path, kind, vec![part], 2, FPS).unwrap();
        cache.push(&[ball.positions()]).unwrap();
        drop(cache);
        assert_eq!(fs::read(&path).unwrap(), b"old");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 4);
}

#[test]
fn more_than_a_glb_can_hold_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.glb");
    let mesh = TriMesh::new(icosphere(5, 1.0).positions().to_vec(), vec![[0, 1, 2]]).unwrap();
    let part = CachePart::of_mesh("ball", &mesh, Frame::OURS);
    let created = CacheWriter::create(&path, CacheKind::Glb, vec![part], 20_000, FPS);
    assert!(matches!(created, Err(CacheError::TooLarge { .. })));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
