//! Weight files come back as they were, or are refused by name.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod hostile;
mod learning_on;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use burn::tensor::{Device, f16};
use garnet_mesh::primitives::{grid, tube};
use garnet_net::{Checkpoint, CheckpointError, GarNetConfig, GarmentGraph, NetError, Precision};
use safetensors::{Dtype, SafeTensors};

fn checkpoint() -> (Checkpoint, GarmentGraph) {
    let garment = GarmentGraph::new(&tube(0.2, 0.4, 12, 8), &[]).unwrap();
    let config = garment.configured(GarNetConfig::preset("tiny").unwrap());
    let checkpoint = Checkpoint {
        model: config.init(3, &Device::flex()).unwrap(),
        garment: garment.fingerprint(),
        range: None,
        pose_space: None,
        record: serde_json::json!({"epochs": 3, "seed": 11}),
        scores: BTreeMap::from([("distance".to_owned(), 0.0056)]),
    };
    (checkpoint, garment)
}

fn load(path: &Path) -> Result<Checkpoint, CheckpointError> {
    Checkpoint::load(path, &Device::flex())
}

#[test]
fn a_checkpoint_comes_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["a.safetensors", "b.safetensors"].map(|name| folder.path().join(name));
    let (checkpoint, garment) = checkpoint();
    checkpoint.save(&first, Precision::F32).unwrap();
    let loaded = load(&first).unwrap();
    loaded.accepts(&garment).unwrap();
    assert_eq!(loaded.record, checkpoint.record);
    assert_eq!(loaded.scores, checkpoint.scores);
    assert_eq!(loaded.model.config(), checkpoint.model.config());
    loaded.save(&second, Precision::F32).unwrap();
    assert_eq!(fs::read(&first).unwrap(), fs::read(&second).unwrap());
    let header = Checkpoint::header(&first).unwrap();
    assert_eq!(header.garment, garment.fingerprint().to_string());
}

#[test]
fn half_precision_halves_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, half] = ["a.safetensors", "b.safetensors"].map(|name| folder.path().join(name));
    let (checkpoint, _) = checkpoint();
    checkpoint.save(&whole, Precision::F32).unwrap();
    checkpoint.save(&half, Precision::F16).unwrap();
    let size = |path: &Path| fs::metadata(path).unwrap().len();
    assert!(size(&half) < size(&whole) * 7 / 10);
    let again = folder.path().join("c.safetensors");
    load(&half).unwrap().save(&again, Precision::F16).unwrap();
    assert_eq!(fs::read(&half).unwrap(), fs::read(&again).unwrap());
}

#[test]
fn halves_are_loaded_as_single_precision_and_lose_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let [half, whole] = ["a.safetensors", "b.safetensors"].map(|name| folder.path().join(name));
    checkpoint().0.save(&half, Precision::F16).unwrap();
    load(&half).unwrap().save(&whole, Precision::F32).unwrap();
    let [half, whole] = [half, whole].map(|path| fs::read(path).unwrap());
    let [half, whole] = [&half, &whole].map(|bytes| SafeTensors::deserialize(bytes).unwrap());
    assert_eq!(half.len(), whole.len());
    for (name, half) in half.iter() {
        let whole = whole.tensor(name).unwrap();
        assert_eq!((half.dtype(), whole.dtype()), (Dtype::F16, Dtype::F32));
        assert_eq!(half.shape(), whole.shape());
        let halves = half.data().as_chunks::<2>().0.iter();
        let wholes = whole.data().as_chunks::<4>().0.iter();
        for (&half, &whole) in halves.zip(wholes) {
            let half = f16::from_le_bytes(half).to_f32();
            assert_eq!(half.to_bits(), u32::from_le_bytes(whole), "{name}");
        }
    }
}

#[test]
fn another_garment_is_not_accepted() {
    let (checkpoint, _) = checkpoint();
    let other = GarmentGraph::new(&grid(3, 3, [1.0, 1.0]), &[]).unwrap();
    assert!(matches!(
        checkpoint.accepts(&other),
        Err(NetError::OtherGarment { .. })
    ));
}

#[test]
fn a_file_cut_short_anywhere_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.safetensors");
    let (checkpoint, _) = checkpoint();
    checkpoint.save(&path, Precision::F32).unwrap();
    let bytes = fs::read(&path).unwrap();
    for len in [0, 5, 100, bytes.len() / 2, bytes.len() - 1] {
        fs::write(&path, &bytes[..len]).unwrap();
        let error = load(&path).unwrap_err();
        assert!(
            matches!(error, CheckpointError::NotSafetensors { .. }),
            "{error}"
        );
        assert!(error.to_string().contains("cut.safetensors"));
    }
}

#[test]
fn an_altered_number_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("altered.safetensors");
    let (checkpoint, _) = checkpoint();
    checkpoint.save(&path, Precision::F32).unwrap();
    let mut bytes = fs::read(&path).unwrap();
    let last = bytes.len() - 3;
    bytes[last] ^= 0x10;
    fs::write(&path, &bytes).unwrap();
    assert!(matches!(load(&path), Err(CheckpointError::Altered { .. })));
}

#[test]
fn foreign_files_and_other_versions_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("foreign.safetensors");
    fs::write(&path, b"\x02\0\0\0\0\0\0\0{}").unwrap();
    assert!(matches!(load(&path), Err(CheckpointError::Foreign { .. })));
    fs::write(&path, b"# an OBJ file\nv 0 0 0\n").unwrap();
    assert!(matches!(
        load(&path),
        Err(CheckpointError::NotSafetensors { .. })
    ));

    let (checkpoint, _) = checkpoint();
    checkpoint.save(&path, Precision::F32).unwrap();
    let bytes = fs::read(&path).unwrap();
    let text = b"garnet-weights/1";
    let at = bytes
        .windows(text.len())
        .position(|window| window == text)
        .unwrap();
    let mut newer = bytes.clone();
    newer[at + text.len() - 1] = b'9';
    fs::write(&path, &newer).unwrap();
    let error = load(&path).unwrap_err();
    assert!(matches!(error, CheckpointError::Schema { .. }), "{error}");
    assert!(error.to_string().contains("`garnet-weights/9`"));

    // Another configuration than the one it was written with.
    let text = br#"\"heads\":4"#;
    let at = bytes
        .windows(text.len())
        .position(|window| window == text)
        .unwrap();
    let mut wider = bytes.clone();
    wider[at + text.len() - 1] = b'5';
    fs::write(&path, &wider).unwrap();
    assert!(matches!(load(&path), Err(CheckpointError::Altered { .. })));
    assert!(matches!(
        load(&folder.path().join("none")),
        Err(CheckpointError::Io { .. })
    ));
}
