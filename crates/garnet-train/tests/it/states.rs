//! Saved states: the same of the same runs, and refused by name where they are damaged.

use std::collections::HashMap;
use std::fs;
use std::sync::atomic::AtomicBool;

use garnet_train::{Begin, TrainError, TrainJob, train};
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};

use crate::invented::{Invented, run, tiny};

const STATE: &str = "training/local/state.safetensors";

/// A training that was stopped after its first step.
fn stopped(invented: &Invented) -> TrainJob {
    let mut job = invented.job("local", tiny(2));
    let error = train(&job, &mut |_| {}, &AtomicBool::new(true)).unwrap_err();
    assert!(matches!(error, TrainError::Stopped), "{error}");
    job.begin = Begin::WhereSaved;
    job
}

#[test]
fn identical_runs_have_identical_states() {
    let states = [(); 2].map(|()| {
        let invented = Invented::new();
        stopped(&invented);
        let halfway = invented.bytes(STATE);
        run(&TrainJob {
            begin: Begin::WhereSaved,
            ..invented.job("local", tiny(2))
        })
        .unwrap();
        run(&invented.job("local-rq", tiny(1))).unwrap();
        let tuned = invented.bytes("training/local-rq/state.safetensors");
        (halfway, invented.bytes(STATE), tuned)
    });
    let [one, two] = &states;
    assert!(one.0 == two.0, "halfway");
    assert!(one.1 == two.1, "at the end");
    assert!(one.2 == two.2, "of a fine-tuning, in another folder");

    let straight = Invented::new();
    run(&straight.job("local", tiny(2))).unwrap();
    assert!(straight.bytes(STATE) == one.1, "an interruption shows");
}

/// The state of a run without its checksum, as earlier versions wrote it, with what `change` makes
/// of a part.
fn before(bytes: &[u8], part: &str, change: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    let (_, metadata) = SafeTensors::read_metadata(bytes).unwrap();
    let text = &metadata.metadata().as_ref().unwrap()["garnet"];
    let start = text.find(r#""checksum":"#).unwrap();
    let end = start + text[start..].find(',').unwrap() + 1;
    let text = text[..start].to_owned() + &text[end..];
    let tensors = SafeTensors::deserialize(bytes).unwrap();
    let parts = ["adam", "best", "model"].map(|name| {
        let mut bytes = tensors.tensor(name).unwrap().data().to_vec();
        if name == part {
            change(&mut bytes);
        }
        (name, bytes)
    });
    let views = parts.iter().map(|(name, bytes)| {
        let view = TensorView::new(Dtype::U8, vec![bytes.len()], bytes).unwrap();
        (*name, view)
    });
    safetensors::serialize(views, Some(HashMap::from([("garnet".to_owned(), text)]))).unwrap()
}

/// Replaces all of a text by one as long.
fn replaced(bytes: &mut [u8], from: &[u8], to: &[u8]) -> usize {
    assert_eq!(from.len(), to.len());
    let mut count = 0;
    for at in 0..bytes.len().saturating_sub(from.len()) {
        if &bytes[at..at + from.len()] == from {
            bytes[at..at + from.len()].copy_from_slice(to);
            count += 1;
        }
    }
    count
}

#[test]
fn a_damaged_state_is_refused_by_name() {
    let invented = Invented::new();
    let job = stopped(&invented);
    let path = invented.package().join(STATE);
    let whole = fs::read(&path).unwrap();
    let refused = |bytes: &[u8], what: &str| {
        fs::write(&path, bytes).unwrap();
        match run(&job) {
            Err(error @ TrainError::State { .. }) => {
                let text = error.to_string();
                assert!(text.contains("state.safetensors"), "{what}: {text}");
            }
            other => panic!("{what}: {other:?}"),
        }
    };
    let bits = (0..8 * 400).step_by(13);
    for bit in bits.chain((8 * 400..8 * whole.len()).step_by(8 * whole.len() / 150)) {
        let mut damaged = whole.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        refused(&damaged, &format!("bit {bit}"));
    }
    for length in (0..whole.len()).step_by(whole.len() / 20) {
        refused(&whole[..length], &format!("{length} bytes"));
    }
    for name in ["adam", "best", "model", "garnet", "checksum", "epoch"] {
        let mut renamed = whole.clone();
        let other: String = name.chars().rev().collect();
        let from = format!("\"{name}").into_bytes();
        let is_quoted = replaced(&mut renamed, &from, format!("\"{other}").as_bytes()) > 0;
        // In the text quotes are escaped.
        if is_quoted {
            refused(&renamed, name);
        }
    }
    fs::write(&path, &whole).unwrap();
    run(&job).unwrap();
}

#[test]
fn states_of_earlier_versions_are_gone_on_with_if_they_are_whole() {
    let invented = Invented::new();
    let job = stopped(&invented);
    let path = invented.package().join(STATE);
    let whole = fs::read(&path).unwrap();
    for (from, to) in [
        ("param_id", "param_xx"),
        ("moment", "tnemom"),
        ("__rank", "__knar"),
        ("1.__rank", "9.__rank"),
        ("data_offsets", "data_xxxxxxx"),
    ] {
        let renamed = before(&whole, "adam", |bytes| {
            assert!(
                replaced(bytes, from.as_bytes(), to.as_bytes()) > 0,
                "{from}"
            );
        });
        fs::write(&path, renamed).unwrap();
        let error = run(&job).expect_err(from);
        assert!(matches!(error, TrainError::State { .. }), "{from}: {error}");
    }
    fs::write(&path, before(&whole, "", |_| {})).unwrap();
    run(&job).unwrap();
    let other = Invented::new();
    run(&other.job("local", tiny(2))).unwrap();
    assert!(other.bytes("local.safetensors") == invented.bytes("local.safetensors"));
}
