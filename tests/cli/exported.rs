//! What a network is told and says, for other implementations.

use std::path::Path;

use garnet::{Point3, io::ObjFile};
use serde_json::Value;

use crate::fixtures::{Fixture, refused_with_hint as refused};
use crate::train::done;

/// A file of safetensors: what its head says, and its bytes after that.
struct Arrays {
    head: Value,
    bytes: Vec<u8>,
}

impl Arrays {
    fn read(fixture: &Fixture, name: &str) -> Self {
        let bytes = fixture.read(name);
        let (length, rest) = bytes.split_first_chunk::<8>().unwrap();
        let (head, bytes) = rest.split_at(u64::from_le_bytes(*length) as usize);
        Self {
            head: serde_json::from_slice(head).unwrap(),
            bytes: bytes.to_vec(),
        }
    }

    fn points(&self, name: &str) -> Vec<Point3> {
        let array = &self.head[name];
        assert_eq!(
            (&array["dtype"], &array["shape"][1]),
            (&"F32".into(), &3.into())
        );
        let place = |end: usize| array["data_offsets"][end].as_u64().unwrap() as usize;
        let numbers = self.bytes[place(0)..place(1)].as_chunks().0.iter();
        let numbers: Vec<f32> = numbers.map(|&bytes| f32::from_le_bytes(bytes)).collect();
        let rows = numbers.as_chunks::<3>().0.iter();
        rows.map(|&row| Point3::from(row)).collect()
    }

    fn text(&self) -> Value {
        let text = self.head["__metadata__"]["garnet"].as_str().unwrap();
        serde_json::from_str(text).unwrap()
    }
}

fn with_models() -> Fixture {
    let fixture = Fixture::new();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    std::os::unix::fs::symlink(models, fixture.path("models")).unwrap();
    fixture
}

const DRAPE: &str = "drape models/tshirt models/demo/reach.obj --no-untangle -q";

fn largest(fixture: &Fixture, obj: &str, found: &[Point3]) -> f32 {
    let expected = ObjFile::read(fixture.path(obj)).unwrap();
    assert_eq!(expected.num_vertices(), found.len());
    let pairs = expected.positions().iter().zip(found);
    pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f32::max)
}

#[test]
fn exported_arrays_are_the_warp_and_what_the_network_makes_of_it() {
    let fixture = with_models();
    done(&fixture, &format!("{DRAPE} --method warp -o warp.obj"));
    let export = "--settle 0 --export-inputs in.safetensors";
    done(
        &fixture,
        &format!("{DRAPE} --method fast -o fast.obj {export}"),
    );
    let arrays = Arrays::read(&fixture, "in.safetensors");
    let text = arrays.text();
    assert_eq!(text["schema"], "garnet.inputs/1");
    assert_eq!(
        (&text["variant"], &text["moment"]),
        (&"fast".into(), &"falling".into())
    );
    assert!(largest(&fixture, "warp.obj", &arrays.points("input.warped")) < 1e-6);
    assert!(largest(&fixture, "fast.obj", &arrays.points("output.positions")) < 1e-6);
    assert!(largest(&fixture, "warp.obj", &arrays.points("output.positions")) > 0.01);
    // A network of layers has those of its inputs, too.
    done(
        &fixture,
        &format!("{DRAPE} --method local -o local.obj {export}"),
    );
    let arrays = Arrays::read(&fixture, "in.safetensors");
    assert!(largest(&fixture, "local.obj", &arrays.points("output.positions")) < 1e-6);
    assert_eq!(
        arrays.points("translations").len(),
        arrays.points("vertices").len()
    );
}

#[test]
fn inputs_of_no_network_are_refused() {
    let fixture = with_models();
    for (arguments, expected) in [
        (
            "--method warp -o out.obj --export-inputs in.safetensors",
            "no network drapes",
        ),
        (
            "--method fast -o out.obj --export-inputs in.npz",
            "written as safetensors",
        ),
    ] {
        refused(&fixture, &format!("{DRAPE} {arguments}"), &[expected]);
    }
    let several = "drape models/tshirt --pose models/demo/walk.bvh:0:8:4 -o out";
    let several = format!("{several} --export-inputs in.safetensors");
    refused(&fixture, &several, &["for one drape"]);
}
