//! A small body with a rig, a garment on it, and files that are wrong, made anew for each test.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    thread,
    time::Duration,
};

use garnet::{
    Body, Joint, Point3, Pose, Rig, Skeleton, SkinWeights, TriMesh, UnitQuaternion, Vector3,
    io::{write_obj, write_rig_npz},
    mesh::primitives::{capsule, tube},
};

/// A folder with the files of a small scene.
#[derive(Debug)]
pub(crate) struct Fixture {
    folder: tempfile::TempDir,
}

/// How often, and how many times, it is looked whether a command has begun that is to be stopped.
const BETWEEN_LOOKS: Duration = Duration::from_millis(25);
const LOOKS: usize = 2400;

/// What a pose file says: the elbow bent by 60 degrees.
const BEND: &str = r#"{"schema": "garnet.pose/1", "joints": {"elbow": [0.5, 0, 0, 0.866025]}}"#;

/// What an import takes: drapes on the straight body and on bent ones.
const SCENES: &str = r#"{"schema": "garnet.import/1", "units": "m", "scenes": [
  {"split": "train", "body": "a", "sequence": "bend", "body_mesh": "body.obj", "garment_mesh": "md_straight.obj"},
  {"split": "train", "body": "a", "sequence": "bend", "body_mesh": "bent.obj", "garment_mesh": "md_bent.obj"},
  {"split": "valid", "body": "b", "sequence": "turn", "body_mesh": "more.obj", "garment_mesh": "md_more.obj"},
  {"split": "test", "body": "c", "sequence": "walk", "body_mesh": "most.obj", "garment_mesh": "md_most.obj"}]}"#;

impl Fixture {
    /// `body.obj` with `body.rig.npz`, `bent.obj`, and more bent `more.obj` and `most.obj`;
    /// `bend.json`, `scenes.json` and `sleeve.obj`.
    pub(crate) fn new() -> Self {
        let fixture = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        let body = body();
        fixture.mesh("body.obj", body.rest());
        for (name, angle) in [("bent.obj", 1.0), ("more.obj", 1.05), ("most.obj", 1.1)] {
            let mut pose = Pose::rest(2);
            pose.rotations[1] = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
            let bent = body.posed(&pose).unwrap().skin().positions().to_vec();
            fixture.mesh(name, &body.rest().with_positions(bent).unwrap());
        }
        write_rig_npz(fixture.path("body.rig.npz"), &Rig::from(body)).unwrap();
        fixture.mesh("sleeve.obj", &tube(0.13, 0.8, 40, 30));
        fixture.text("bend.json", BEND);
        fixture.text("scenes.json", SCENES);
        fixture
    }

    pub(crate) fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder().join(name)
    }

    pub(crate) fn mesh(&self, name: &str, mesh: &TriMesh) {
        write_obj(self.path(name), mesh).unwrap();
    }

    pub(crate) fn text(&self, name: &str, text: &str) {
        self.bytes(name, text.as_bytes());
    }

    pub(crate) fn bytes(&self, name: &str, bytes: &[u8]) {
        fs::write(self.path(name), bytes).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    /// A copy of a file in a new folder.
    pub(crate) fn folder_with(&self, folder: &str, name: &str, copy: &str) {
        fs::create_dir(self.path(folder)).unwrap();
        fs::copy(self.path(name), self.path(folder).join(copy)).unwrap();
    }

    /// A copy of a file with its first half alone.
    pub(crate) fn half(&self, name: &str, copy: &str) {
        let bytes = self.read(name);
        self.bytes(copy, &bytes[..bytes.len() / 2]);
    }

    /// A copy of a mesh with other positions.
    pub(crate) fn moved(&self, name: &str, copy: &str, by: impl Fn(&Point3) -> Point3) {
        let file = garnet::io::ObjFile::read(self.path(name)).unwrap();
        let positions: Vec<Point3> = file.positions().iter().map(by).collect();
        file.write_with_positions(self.path(copy), &positions)
            .unwrap();
    }

    /// A rig JSON of `body.obj` with these joints and with these weights of every vertex.
    pub(crate) fn rig_json(&self, name: &str, joints: &str, weights: [f32; 2]) {
        let [a, b] = weights;
        let num_vertices = body().rest().num_vertices();
        let rows = |row: &str| vec![row; num_vertices].join(",");
        let file = format!("{name}.weights.json");
        let text = format!(
            r#"{{"joints": 2, "influences_per_vertex": 2,
                "joint_index": [{}], "weight": [{}]}}"#,
            rows("[0, 1]"),
            rows(&format!("[{a}, {b}]"))
        );
        self.text(&file, &text);
        let text = format!(r#"{{"mesh": "body.obj", "joints": {joints}, "weights": "{file}"}}"#);
        self.text(name, &text);
    }

    /// Runs the command in the folder; words are split at spaces.
    pub(crate) fn garnet(&self, arguments: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_garnet"))
            .args(arguments.split_whitespace())
            .current_dir(self.folder())
            .env_remove("NO_COLOR")
            .output()
            .unwrap()
    }

    /// Runs the command in the folder, and interrupts it as soon as it has begun.
    #[cfg(unix)]
    pub(crate) fn interrupted(&self, arguments: &str, has_begun: impl Fn() -> bool) -> Output {
        let child = Command::new(env!("CARGO_BIN_EXE_garnet"))
            .args(arguments.split_whitespace())
            .current_dir(self.folder())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        for _ in 0..LOOKS {
            if has_begun() {
                break;
            }
            thread::sleep(BETWEEN_LOOKS);
        }
        let pid = child.id().to_string();
        let told = Command::new("kill").args(["-INT", &pid]).status();
        assert!(told.unwrap().success());
        child.wait_with_output().unwrap()
    }

    /// Names of all files and folders, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder()).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }
}

/// An arm along y with a shoulder and an elbow, as tall as a person.
fn body() -> Body {
    let mesh = capsule(0.1, 1.4, 24, 16);
    let joint = |name: &str, parent, y| Joint {
        name: name.to_owned(),
        parent,
        rest_position: Point3::new(0.0, y, 0.0),
    };
    let joints = vec![joint("shoulder", None, -0.7), joint("elbow", Some(0), 0.0)];
    let forearm = |p: &Point3| (0.5 + p.y / 0.2).clamp(0.0, 1.0);
    let positions = mesh.positions().iter();
    let rows = positions.map(|p| [(0, 1.0 - forearm(p)), (1, forearm(p))]);
    let weights = SkinWeights::from_influences(2, rows).unwrap();
    Body::new(mesh, Skeleton::new(joints).unwrap(), weights).unwrap()
}

/// Runs a command that must be refused with all of `expected`, without leaving anything behind, and
/// gives its stderr.
pub(crate) fn refused(fixture: &Fixture, arguments: &str, expected: &[&str]) -> String {
    let before = fixture.names();
    let output = fixture.garnet(arguments);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments}: {text}");
    for words in expected {
        assert!(
            text.contains(words),
            "{arguments}: `{words}` is not in {text}"
        );
    }
    assert_eq!(stdout(&output), "", "{arguments}");
    assert_eq!(fixture.names(), before, "{arguments}");
    text
}

/// The same, with one error and one hint.
pub(crate) fn refused_with_hint(fixture: &Fixture, arguments: &str, expected: &[&str]) {
    let text = refused(fixture, arguments, expected);
    assert_eq!(text.matches("error: ").count(), 1, "{arguments}: {text}");
    assert_eq!(text.matches("hint: ").count(), 1, "{arguments}: {text}");
}

/// Stderr as text.
pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Stdout as text.
pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}
