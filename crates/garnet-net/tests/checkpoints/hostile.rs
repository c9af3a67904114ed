//! Files that are damaged, or made to do harm, are refused; none panics or takes much memory.

use std::path::Path;

use burn::tensor::Device;
use garnet_mesh::Fingerprint;
use garnet_net::{Checkpoint, CheckpointError, NetError, Precision};
use serde_json::{Map, Value, json};

const PATH: &str = "hostile.safetensors";

/// The parts of a file: what stands before the numbers, and the numbers.
struct File {
    header: Map<String, Value>,
    numbers: Vec<u8>,
}

impl File {
    fn sound() -> Self {
        let bytes = bytes(Precision::F32);
        let (header, numbers) = bytes[8..].split_at(header_len(&bytes));
        Self {
            header: serde_json::from_slice(header).unwrap(),
            numbers: numbers.to_vec(),
        }
    }

    /// With other tensors, and a checksum that agrees with them.
    fn with(mut self, edit: impl FnOnce(&mut Self)) -> Vec<u8> {
        edit(&mut self);
        self.edit_metadata(|metadata| metadata["checksum"] = json!(""));
        let text = self.header["__metadata__"]["garnet"].as_str();
        let mut sums = text.unwrap().to_owned();
        let mut tensors: Vec<(&String, &Value)> = self.header.iter().collect();
        tensors.sort_by_key(|(name, _)| *name);
        for (name, tensor) in tensors {
            let offset = |end: usize| tensor["data_offsets"][end].as_u64();
            let range = || Some(offset(0)? as usize..offset(1)? as usize);
            if let Some(numbers) = range().and_then(|range| self.numbers.get(range)) {
                sums += name;
                sums += &Fingerprint::of_bytes(numbers).to_string();
            }
        }
        let checksum = Fingerprint::of_bytes(sums.as_bytes()).to_string();
        self.edit_metadata(|metadata| metadata["checksum"] = json!(checksum));
        let header = Value::Object(self.header).to_string();
        file(&header, &self.numbers)
    }

    fn edit_metadata(&mut self, edit: impl FnOnce(&mut Value)) {
        let text = &mut self.header["__metadata__"]["garnet"];
        let mut metadata = serde_json::from_str(text.as_str().unwrap()).unwrap();
        edit(&mut metadata);
        *text = json!(metadata.to_string());
    }
}

fn bytes(precision: Precision) -> Vec<u8> {
    let bytes = super::checkpoint().0.to_bytes(Path::new(PATH), precision);
    bytes.unwrap()
}

fn header_len(bytes: &[u8]) -> usize {
    usize::from_le_bytes(bytes[..8].try_into().unwrap())
}

fn file(header: &str, numbers: &[u8]) -> Vec<u8> {
    let len = header.len().to_le_bytes();
    [&len[..], header.as_bytes(), numbers].concat()
}

fn load(bytes: Vec<u8>) -> Result<Checkpoint, CheckpointError> {
    Checkpoint::from_bytes(Path::new(PATH), bytes, &Device::flex())
}

/// What is said of a file that names a tensor.
fn said(bytes: Vec<u8>) -> String {
    match load(bytes).unwrap_err() {
        error @ CheckpointError::Tensor { .. } => error.to_string(),
        error => panic!("{error:?}"),
    }
}

const BIAS: &str = "fusion.translation.bias";

#[test]
fn the_helpers_make_sound_files() {
    load(File::sound().with(|_| ())).unwrap();
}

#[test]
fn every_cut_is_refused() {
    let bytes = bytes(Precision::F16);
    let header = 8 + header_len(&bytes);
    for len in (0..header)
        .step_by(7)
        .chain((header..bytes.len()).step_by(997))
    {
        let error = load(bytes[..len].to_vec()).unwrap_err();
        let is_named = matches!(error, CheckpointError::NotSafetensors { .. });
        assert!(is_named, "{len}: {error:?}");
    }
}

#[test]
fn no_altered_bit_panics_or_changes_a_weight() {
    for precision in [Precision::F32, Precision::F16] {
        let sound = bytes(precision);
        let header = 8 + header_len(&sound);
        let numbers = load(sound.clone()).unwrap();
        let numbers = numbers.to_bytes(Path::new(PATH), precision).unwrap();
        let of_all = (0..header)
            .step_by(3)
            .chain((header..sound.len()).step_by(1009));
        for (turn, at) in of_all.enumerate() {
            let mut bytes = sound.clone();
            bytes[at] ^= 1 << (turn % 8);
            // Scores and the like are not summed: such a file is loaded with all its weights.
            if let Ok(loaded) = load(bytes) {
                let found = loaded.to_bytes(Path::new(PATH), precision).unwrap();
                let tail = |bytes: &[u8]| bytes[8 + header_len(bytes)..].to_vec();
                assert!(at < header && tail(&found) == tail(&numbers), "byte {at}");
            }
        }
    }
}

#[test]
fn tensors_that_do_not_fit_are_named() {
    let missing = |file: &mut File| {
        let bias = file.header.remove(BIAS).unwrap();
        file.header.insert("fusion.other".to_owned(), bias);
    };
    let text = said(File::sound().with(missing));
    assert!(
        text.contains("tensor `fusion.translation.bias` is missing"),
        "{text}"
    );

    let unknown = |file: &mut File| {
        let len = file.numbers.len();
        let tensor = json!({"dtype": "F32", "shape": [], "data_offsets": [len, len + 4]});
        file.header.insert("stowaway".to_owned(), tensor);
        file.numbers.extend([0; 4]);
    };
    let text = said(File::sound().with(unknown));
    assert!(text.contains("tensor `stowaway` is there"), "{text}");

    for shape in [
        json!([1, 3]),
        json!([3, 1, 1]),
        json!([3, 1, 1, 1, 1, 1, 1, 1, 1]),
    ] {
        let expected = format!("tensor `{BIAS}` is {shape}, but the configuration asks for [3]");
        let text = said(File::sound().with(|file| file.header[BIAS]["shape"] = shape));
        assert!(
            text.replace(", ", ",")
                .contains(&expected.replace(", ", ",")),
            "{text}"
        );
    }
}

#[test]
fn other_types_of_numbers_are_not_taken_for_weights() {
    // As many bytes as the three numbers of single precision have.
    for (dtype, shape) in [
        ("I32", json!([3])),
        ("U32", json!([3])),
        ("F16", json!([6])),
        ("BF16", json!([6])),
        ("I16", json!([6])),
        ("U16", json!([6])),
        ("BOOL", json!([12])),
        ("U8", json!([12])),
        ("F8_E4M3", json!([12])),
        ("F4", json!([24])),
        ("F64", json!([1])),
        ("C64", json!([1])),
        ("I256", json!([1])),
    ] {
        let edit = |file: &mut File| {
            file.header[BIAS]["dtype"] = json!(dtype);
            file.header[BIAS]["shape"] = shape;
        };
        let error = load(File::sound().with(edit)).unwrap_err();
        let is_named = matches!(
            error,
            CheckpointError::Tensor { .. } | CheckpointError::NotSafetensors { .. }
        );
        assert!(is_named, "{dtype}: {error:?}");
    }
}

#[test]
fn shapes_and_places_that_cannot_be_are_refused() {
    const HUGE: u64 = u64::MAX;
    for shape in [
        json!([]),
        json!([0]),
        json!([HUGE]),
        json!([HUGE, HUGE]),
        json!([1_u64 << 63, 2, 0]),
        json!([0, HUGE, HUGE]),
        json!([-3]),
        json!([3.5]),
        json!("3"),
        json!(vec![1; 5000]),
    ] {
        let edit = |file: &mut File| file.header[BIAS]["shape"] = shape.clone();
        assert!(load(File::sound().with(edit)).is_err(), "{shape}");
    }
    for place in [
        json!([HUGE, HUGE]),
        json!([0, HUGE]),
        json!([12, 0]),
        json!([0, 12]),
        json!([1]),
        json!([]),
        json!([-1, 3]),
    ] {
        let edit = |file: &mut File| file.header[BIAS]["data_offsets"] = place.clone();
        assert!(load(File::sound().with(edit)).is_err(), "{place}");
    }
}

#[test]
fn headers_that_are_no_headers_are_refused() {
    for header in [
        "",
        "{",
        "[]",
        "null",
        r#"{"__metadata__":{"garnet":"{}"}}"#,
        r#"{"__metadata__":{"garnet":"[[[[[[[["}}"#,
        r#"{"__metadata__":{"garnet":7}}"#,
        r#"{"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]},"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}}"#,
    ] {
        assert!(load(file(header, &[0; 4])).is_err(), "{header}");
    }
    assert!(load(u64::MAX.to_le_bytes().to_vec()).is_err());
    assert!(load([&u64::MAX.to_le_bytes()[..], b"{}"].concat()).is_err());
}

#[test]
fn a_tensor_twice_is_refused_or_one_of_them() {
    let sound = File::sound();
    let tensor = sound.header[BIAS].clone();
    let bytes = sound.with(|_| ());
    let (header, numbers) = bytes[8..].split_at(header_len(&bytes));
    let header = str::from_utf8(header).unwrap();
    for shape in ["[3]", "[]", "[1,3]", "[99999999]"] {
        let mut other = tensor.clone();
        other["shape"] = serde_json::from_str(shape).unwrap();
        let twice = format!(r#"{{"{BIAS}":{other},{}"#, &header[1..]);
        let last = format!(r#"{},"{BIAS}":{other}}}"#, &header[..header.len() - 1]);
        for header in [twice, last] {
            if let Ok(loaded) = load(file(&header, numbers)) {
                let found = loaded.to_bytes(Path::new(PATH), Precision::F32).unwrap();
                assert_eq!(&found[8 + header_len(&found)..], numbers);
            }
        }
    }
}

#[test]
fn an_altered_configuration_is_refused() {
    let heads = |file: &mut File, heads: u64| {
        file.edit_metadata(|metadata| metadata["config"]["garment"]["heads"] = json!(heads));
    };
    let mut altered = File::sound();
    heads(&mut altered, 5);
    let header = Value::Object(altered.header).to_string();
    let error = load(file(&header, &altered.numbers)).unwrap_err();
    assert!(matches!(error, CheckpointError::Altered { .. }), "{error}");

    // With a checksum that agrees: the weights have another width.
    let error = load(File::sound().with(|file| heads(file, 5))).unwrap_err();
    assert!(matches!(error, CheckpointError::Tensor { .. }), "{error}");
}

#[test]
fn a_file_that_claims_to_be_huge_takes_no_memory() {
    // Weights of half a terabyte.
    let claim = |file: &mut File| {
        file.edit_metadata(|metadata| {
            let garment = &mut metadata["config"]["garment"];
            garment["blocks"] = json!(vec![4096; 8]);
            garment["convolutions"] = json!(8);
            garment["heads"] = json!(32);
        });
    };
    let error = load(File::sound().with(claim)).unwrap_err();
    let CheckpointError::Config { source, .. } = error else {
        panic!("{error:?}");
    };
    assert!(
        matches!(
            source,
            NetError::Config {
                field: "weights",
                ..
            }
        ),
        "{source:?}"
    );
}

#[test]
fn weights_that_are_no_numbers_are_refused() {
    for number in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let edit = |file: &mut File| {
            let at = file.header[BIAS]["data_offsets"][0].as_u64().unwrap() as usize;
            file.numbers[at..at + 4].copy_from_slice(&number.to_le_bytes());
        };
        let error = load(File::sound().with(edit)).unwrap_err();
        let CheckpointError::NotFinite { name } = error else {
            panic!("{error:?}");
        };
        assert_eq!(name, BIAS);
    }
}
