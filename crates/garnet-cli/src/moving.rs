//! A mesh in one frame or several.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs, io,
    path::{Path, PathBuf},
};

use anyhow::{Context, ensure};
use garnet::{
    Point3, TriMesh,
    io::{
        ArrayProblem, FileProblem, Frame, LeftOut, MeshFrames, NpzFile, ObjFile, PartsNote,
        RigOptions, RigPart, is_rig, read_mesh_frames, read_shown_mesh,
    },
    mesh::{Unit, UpAxis},
};

use crate::{console::Console, failure::refused};

/// A mesh, and where its vertices are in the frames after the first, as the files have them.
#[derive(Debug)]
pub(crate) struct Moving {
    path: PathBuf,
    file: ObjFile,
    later: Vec<Vec<Point3>>,
    names: Vec<String>,
    fps: Option<f64>,
    frame: Frame,
    note: Option<PartsNote>,
    /// Faces of the meshes that a file without a skin was joined from.
    parts: Vec<usize>,
    /// Whether the last of them is the body of a drape.
    has_body: bool,
}

impl Moving {
    /// Reads a mesh, a folder of OBJ files, an npz with the positions of all frames, or a GLB whose
    /// meshes change their shapes.
    pub(crate) fn read(path: &Path, options: &RigOptions, up: UpAxis) -> anyhow::Result<Self> {
        if path.is_dir() {
            return Self::in_folder(path, up);
        }
        if let Some(moving) = Self::in_npz(path, up)? {
            return Ok(moving);
        }
        // Rigs have y up, whatever the OBJ files have.
        let up = if is_rig(path) { UpAxis::Y } else { up };
        let shown = read_shown_mesh(path, options)?;
        let joined = shown.note.as_ref().filter(|_| shown.rig_note.is_none());
        let parts = joined.map_or(&[][..], |note| &note.parts).iter();
        let parts = parts.filter(|part| part.left_out.is_none());
        let parts = parts.map(|part| part.num_faces).collect();
        let has_body = shown.is_drape;
        let mut note = shown.note.or(shown.rig_note);
        let mut moving = Self {
            parts,
            has_body,
            ..Self::still(path, shown.file, up)
        };
        let is_later = |part: &RigPart| part.left_out == Some(LeftOut::LaterShapes);
        if let Some(note) = note.as_mut().filter(|note| note.parts.iter().any(is_later)) {
            // What cannot be played is shown as it is at first, which the note tells.
            let played = read_mesh_frames(path).ok().flatten();
            if let Some(frames) = played.filter(|frames| frames.positions.len() > 1) {
                let is_played = |part: &RigPart| frames.nodes.contains(&part.name);
                note.parts
                    .retain(|part| !is_later(part) || !is_played(part));
                moving.play(path, frames)?;
            }
        }
        moving.note = note.filter(PartsNote::leaves_out);
        Ok(moving)
    }

    /// Takes the frames of an animation that changes the shapes of the meshes of a GLB.
    fn play(&mut self, path: &Path, frames: MeshFrames) -> anyhow::Result<()> {
        let mut positions = frames.positions.into_iter();
        let first = positions.next().unwrap_or_default();
        let first = self.file.mesh()?.with_positions(first);
        let first = first.with_context(|| format!("cannot read `{}`", path.display()))?;
        self.file = ObjFile::of_mesh(&first, path)?;
        self.later = positions.collect();
        self.fps = frames.fps;
        let count = 1 + self.later.len();
        self.names = (0..count).map(|frame| format!("frame {frame}")).collect();
        Ok(())
    }

    fn still(path: &Path, file: ObjFile, up: UpAxis) -> Self {
        Self {
            path: path.to_path_buf(),
            file,
            later: Vec::new(),
            names: Vec::new(),
            fps: None,
            frame: Frame {
                unit: Unit::Metre,
                up,
            },
            note: None,
            parts: Vec::new(),
            has_body: false,
        }
    }

    /// A garment and its body, as drapes are written into a GLB, apart from each other; any other
    /// file as it is.
    pub(crate) fn apart(self) -> anyhow::Result<Vec<Self>> {
        let faces = self.file.triangles();
        let &[garment, body] = &self.parts[..] else {
            return Ok(vec![self]);
        };
        if garment + body != faces.len() || !self.has_body {
            return Ok(vec![self]);
        }
        let cannot = || format!("cannot read `{}`", self.path.display());
        let (garment, body) = faces.split_at(garment);
        let part = |faces: &[[u32; 3]]| -> anyhow::Result<Self> {
            let named: BTreeSet<u32> = faces.iter().flatten().copied().collect();
            let number: BTreeMap<u32, u32> = named.iter().copied().zip(0..).collect();
            let of_part = |positions: &[Point3]| -> Vec<Point3> {
                let vertices = named.iter();
                vertices.map(|&vertex| positions[vertex as usize]).collect()
            };
            let faces = faces.iter().map(|face| face.map(|vertex| number[&vertex]));
            let mesh = TriMesh::new(of_part(self.file.positions()), faces.collect());
            let file = ObjFile::of_mesh(&mesh.with_context(cannot)?, &self.path)?;
            Ok(Self {
                later: self.later.iter().map(|frame| of_part(frame)).collect(),
                names: self.names.clone(),
                fps: self.fps,
                ..Self::still(&self.path, file, self.frame.up)
            })
        };
        let (mut garment, body) = (part(garment)?, part(body)?);
        garment.note = self.note;
        Ok(vec![garment, body])
    }

    /// The OBJ files of a folder, in the order of their names.
    fn in_folder(folder: &Path, up: UpAxis) -> anyhow::Result<Self> {
        let cannot = || format!("cannot read the folder `{}`", folder.display());
        let entries = fs::read_dir(folder).with_context(cannot)?;
        let paths: io::Result<Vec<PathBuf>> = entries.map(|entry| Ok(entry?.path())).collect();
        let mut paths = paths.with_context(cannot)?;
        paths.retain(|path| {
            path.extension()
                .is_some_and(|kind| kind.eq_ignore_ascii_case("obj"))
        });
        paths.sort();
        let Some((first, others)) = paths.split_first() else {
            return Err(refused(
                cannot(),
                "it has no OBJ",
                "name a mesh, or a folder with an OBJ for each frame",
            ));
        };
        let mut moving = Self::still(folder, ObjFile::read_regular(first)?, up);
        if others.is_empty() {
            return Ok(moving);
        }
        let faces = moving.file.triangles();
        for path in others {
            let file = ObjFile::read_regular(path)?;
            if file.num_vertices() != moving.file.num_vertices() || file.triangles() != faces {
                return Err(refused(
                    format!("`{}` is no motion", folder.display()),
                    format!(
                        "`{}` and `{}` are not the same mesh in two frames",
                        first.display(),
                        path.display()
                    ),
                    "name a folder with the frames of one mesh alone",
                ));
            }
            moving.later.push(file.positions().to_vec());
        }
        let stems = paths.iter().filter_map(|path| path.file_stem());
        moving.names = stems
            .map(|stem| stem.to_string_lossy().into_owned())
            .collect();
        Ok(moving)
    }

    /// The frames of an npz, if it has any: `vertices [frames, n, 3]`, `faces`, `fps`.
    fn in_npz(path: &Path, up: UpAxis) -> anyhow::Result<Option<Self>> {
        let extension = path.extension();
        if !extension.is_some_and(|kind| kind.eq_ignore_ascii_case("npz")) {
            return Ok(None);
        }
        let mut archive = NpzFile::open(path)?;
        let Some(vertices) = archive.array("vertices")? else {
            return Ok(None);
        };
        let &[num_frames, num_vertices, 3] = &vertices.shape[..] else {
            return Ok(None);
        };
        archive.require(&["vertices", "faces"])?;
        let faces = archive.array("faces")?.context("`faces` is there")?;
        let wrong = |key: &str, problem: ArrayProblem| archive.wrong(key, problem);
        let shape = |key: &str, found: &[usize], expected: &str| {
            let (found, expected) = (found.to_vec(), expected.to_owned());
            wrong(key, ArrayProblem::Shape { found, expected })
        };
        if num_frames == 0 {
            return Err(shape("vertices", &vertices.shape, "one frame or more").into());
        }
        if faces.shape.len() != 2 || faces.shape[1] != 3 {
            return Err(shape("faces", &faces.shape, "[m, 3]").into());
        }
        let floats = vertices
            .floats()
            .map_err(|problem| wrong("vertices", problem))?;
        let corners = faces
            .integers()
            .map_err(|problem| wrong("faces", problem))?;
        let cannot = || format!("cannot read `{}`", path.display());
        let corners = corners.iter().map(|&corner| {
            let is_vertex = usize::try_from(corner).is_ok_and(|corner| corner < num_vertices);
            ensure!(
                is_vertex,
                "a face has the vertex {corner}, of {num_vertices}"
            );
            Ok(corner as u32)
        });
        let corners: Vec<u32> = corners
            .collect::<anyhow::Result<_>>()
            .with_context(cannot)?;
        let (faces, _) = corners.as_chunks::<3>();
        let (points, _) = floats.as_chunks::<3>();
        let points: Vec<Point3> = (points.iter())
            .map(|point| point.map(|coordinate| coordinate as f32).into())
            .collect();
        let mut frames = points.chunks(num_vertices.max(1)).map(<[Point3]>::to_vec);
        let first = TriMesh::new(frames.next().unwrap_or_default(), faces.to_vec());
        let first = first.with_context(cannot)?;
        let mut moving = Self::still(path, ObjFile::of_mesh(&first, path)?, up);
        for positions in frames {
            let moved = first.with_positions(positions).with_context(cannot)?;
            moving.later.push(moved.into_parts().0);
        }
        moving.fps = fps_in(&mut archive).with_context(cannot)?;
        if num_frames > 1 {
            moving.names = (0..num_frames)
                .map(|frame| format!("frame {frame}"))
                .collect();
        }
        Ok(Some(moving))
    }

    /// What was left out of the file.
    pub(crate) fn note(&self) -> Option<&PartsNote> {
        self.note.as_ref()
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// The mesh in the first frame.
    pub(crate) fn file(&self) -> &ObjFile {
        &self.file
    }

    /// The same.
    pub(crate) fn into_file(self) -> ObjFile {
        self.file
    }

    pub(crate) fn num_frames(&self) -> usize {
        1 + self.later.len()
    }

    /// Names of the frames; none of a mesh that keeps still.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// Frames a second, if the file tells.
    pub(crate) fn fps(&self) -> Option<f64> {
        self.fps
    }

    /// Positions `[vertex]` in a frame, as the file has them; of what keeps still, in any.
    pub(crate) fn positions(&self, frame: usize) -> &[Point3] {
        match frame.min(self.later.len()) {
            0 => self.file.positions(),
            frame => &self.later[frame - 1],
        }
    }

    /// The mesh in the first frame, with y up.
    pub(crate) fn upright(&self) -> anyhow::Result<TriMesh> {
        let mesh = self.file.mesh();
        let mesh = mesh.with_context(|| format!("cannot read `{}`", self.path.display()))?;
        let (positions, faces) = mesh.into_parts();
        Ok(TriMesh::new(self.frame.to_metres(positions), faces)?)
    }

    /// The mesh in a frame, with y up; of what keeps still, in any.
    pub(crate) fn upright_in(&self, frame: usize) -> anyhow::Result<TriMesh> {
        let first = self.upright()?;
        let positions = self.frame.to_metres(self.positions(frame).to_vec());
        first
            .with_positions(positions)
            .with_context(|| format!("cannot read `{}`", self.path.display()))
    }

    /// Positions `[vertex]` in the frames after the first, with y up.
    pub(crate) fn later_upright(&self) -> Vec<Vec<Point3>> {
        let frames = self.later.iter();
        frames
            .map(|positions| self.frame.to_metres(positions.clone()))
            .collect()
    }
}

/// What was left out of the files, for the user to read; it is told, too.
pub(crate) fn told_notes(moving: &[Moving], console: &Console) -> Vec<String> {
    let notes = moving.iter().filter_map(|mesh| mesh.note.as_ref());
    let mut notes: Vec<String> = notes.map(ToString::to_string).collect();
    notes.dedup();
    for note in &notes {
        console.summary(&format_args!("note: {note}"));
    }
    notes
}

/// Names of the frames, which all that moves shares.
pub(crate) fn frames_of(moving: &[Moving]) -> anyhow::Result<Vec<String>> {
    let mut moves = moving.iter().filter(|mesh| mesh.num_frames() > 1);
    let Some(first) = moves.next() else {
        return Ok(Vec::new());
    };
    let count = first.num_frames();
    if let Some(other) = moves.find(|mesh| mesh.num_frames() != count) {
        return Err(refused(
            "the meshes do not move together",
            format!(
                "`{}` has {count} frames, `{}` has {}",
                first.path().display(),
                other.path().display(),
                other.num_frames()
            ),
            "give the same frames of each, or one",
        ));
    }
    Ok(first.names().to_vec())
}

/// Frames a second, if an archive tells.
fn fps_in(archive: &mut NpzFile) -> anyhow::Result<Option<f64>> {
    let Some(array) = archive.array("fps")? else {
        return Ok(None);
    };
    let values = array.floats();
    let values = values.map_err(|problem| archive.wrong("fps", problem))?;
    let fps = values.first().copied();
    match fps.filter(|fps| (1e-3..=1e3).contains(fps)) {
        Some(fps) => Ok(Some(fps)),
        None => Err(FileProblem::Field {
            field: "fps".to_owned(),
            found: format!("{values:?}"),
            expected: "frames a second from 0.001 to 1000",
        }
        .into()),
    }
}

/// Frames a second, as an argument.
pub(crate) fn frames_per_second(text: &str) -> Result<f64, String> {
    let fps = text.parse().ok();
    fps.filter(|fps| (1e-3..=1e3).contains(fps))
        .ok_or_else(|| "expected frames a second from 0.001 to 1000".to_owned())
}
