//! Arrays in npz archives, written for tests.

use std::io::Write as _;

use zip::{ZipWriter, write::SimpleFileOptions};

/// The bytes of an npz archive of `f8` arrays.
pub(crate) fn npz(arrays: &[(&str, &[usize], &[f64])]) -> Vec<u8> {
    let mut archive = ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, shape, values) in arrays {
        archive
            .start_file(format!("{name}.npy"), SimpleFileOptions::default())
            .unwrap();
        let axes: Vec<String> = shape.iter().map(|axis| format!("{axis},")).collect();
        let axes = axes.concat();
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({axes}), }}");
        let header = format!("{header:<117}\n");
        archive.write_all(b"\x93NUMPY\x01\x00").unwrap();
        archive
            .write_all(&(header.len() as u16).to_le_bytes())
            .unwrap();
        archive.write_all(header.as_bytes()).unwrap();
        for value in *values {
            archive.write_all(&value.to_le_bytes()).unwrap();
        }
    }
    archive.finish().unwrap().into_inner()
}
