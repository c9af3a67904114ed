//! The stored form of the template; how it is laid out stands in the crate's `template` module.

use super::Vec3;
use super::remesh::{Coarse, Half, Mesh};
use super::weights::Influences;

const MAGIC: &[u8] = b"GBT2";

/// What a vertex belongs to, `[vertex of the half]`.
pub(crate) struct Weights {
    pub(crate) arm_shares: Vec<f64>,
    pub(crate) influences: Vec<Influences>,
}

pub(crate) fn bytes(fine: &Mesh, coarse: &Coarse, weights: &Weights) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
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
    for corner in fine.faces.iter().flatten() {
        short(&mut bytes, *corner);
    }
    push_weights(&mut bytes, weights);
    for &vertex in &coarse.vertices {
        short(&mut bytes, vertex);
    }
    for corner in coarse.faces.iter().flatten() {
        short(&mut bytes, *corner);
    }
    bytes
}

/// A stored template with other weights.
pub(crate) fn reweighted(stored: &Stored, weights: &Weights) -> Vec<u8> {
    let mut bytes = stored.before_weights.to_vec();
    push_weights(&mut bytes, weights);
    bytes.extend(stored.after_weights);
    bytes
}

fn push_weights(bytes: &mut Vec<u8>, weights: &Weights) {
    let share = |bytes: &mut Vec<u8>, share: f64| {
        short(bytes, (share * f64::from(u16::MAX)).round() as u32);
    };
    for &arm_share in &weights.arm_shares {
        share(bytes, arm_share);
    }
    bytes.extend(weights.influences.iter().map(|row| row.len() as u8));
    for &(joint, weight) in weights.influences.iter().flatten() {
        bytes.push(joint as u8);
        share(bytes, weight);
    }
}

fn short(bytes: &mut Vec<u8>, value: u32) {
    bytes.extend((value as u16).to_le_bytes());
}

/// A stored template, taken apart around its weights.
pub(crate) struct Stored<'a> {
    pub(crate) half: Half,
    before_weights: &'a [u8],
    after_weights: &'a [u8],
}

impl<'a> Stored<'a> {
    /// None if `bytes` are of another form or end too soon.
    pub(crate) fn new(bytes: &'a [u8]) -> Option<Self> {
        if !bytes.starts_with(MAGIC) {
            return None;
        }
        let count = |place: usize| {
            let word = bytes.get(4 * place..)?.first_chunk()?;
            Some(u32::from_le_bytes(*word) as usize)
        };
        let (vertices, num_middle, faces) = (count(1)?, count(2)?, count(3)?);
        let positions_at = 24;
        let faces_at = positions_at + 12 * vertices;
        let weights_at = faces_at + 6 * faces;
        let coordinates = bytes.get(positions_at..faces_at)?.chunks_exact(4);
        let coordinates: Vec<f64> = coordinates
            .map(|word| f64::from(f32::from_le_bytes(word.try_into().expect("4 bytes"))))
            .collect();
        let corners = bytes.get(faces_at..weights_at)?.chunks_exact(2);
        let corners: Vec<u32> = corners
            .map(|word| u16::from_le_bytes([word[0], word[1]]).into())
            .collect();
        let counts_at = weights_at + 2 * vertices;
        let influences = bytes.get(counts_at..counts_at + vertices)?;
        let influences: usize = influences.iter().map(|&count| usize::from(count)).sum();
        Some(Self {
            half: Half {
                positions: coordinates
                    .chunks_exact(3)
                    .map(Vec3::from_column_slice)
                    .collect(),
                is_middle: (0..vertices).map(|vertex| vertex < num_middle).collect(),
                faces: corners
                    .chunks_exact(3)
                    .map(|face| [face[0], face[1], face[2]])
                    .collect(),
            },
            before_weights: bytes.get(..weights_at)?,
            after_weights: bytes.get(counts_at + vertices + 3 * influences..)?,
        })
    }
}
