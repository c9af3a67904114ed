//! The stored form of the template; how it is laid out stands in the crate's `template` module.

use super::remesh::{Coarse, Mesh};

pub(crate) fn bytes(fine: &Mesh, coarse: &Coarse, weights: &[Vec<(usize, f64)>]) -> Vec<u8> {
    let mut bytes = b"GBT1".to_vec();
    let counts = [
        fine.positions.len(),
        fine.num_middle(),
        fine.faces.len(),
        coarse.vertices.len(),
        coarse.faces.len(),
    ];
    for count in counts {
        bytes.extend((count as u32).to_le_bytes());
    }
    for position in &fine.positions {
        for coordinate in position.iter() {
            bytes.extend((*coordinate as f32).to_le_bytes());
        }
    }
    let short = |bytes: &mut Vec<u8>, value: u32| bytes.extend((value as u16).to_le_bytes());
    for corner in fine.faces.iter().flatten() {
        short(&mut bytes, *corner);
    }
    bytes.extend(weights.iter().map(|row| row.len() as u8));
    for &(joint, weight) in weights.iter().flatten() {
        bytes.push(joint as u8);
        short(&mut bytes, (weight * f64::from(u16::MAX)).round() as u32);
    }
    for &vertex in &coarse.vertices {
        short(&mut bytes, vertex);
    }
    for corner in coarse.faces.iter().flatten() {
        short(&mut bytes, *corner);
    }
    bytes
}
