//! Numbers as bytes that deflate well.

use std::io::Write;

use flate2::{Compression, write::DeflateEncoder};
use garnet_mesh::Point3;

/// The largest code of a number.
const LAST: f64 = 65_535.0;

/// The code of a value that is infinite or not a number.
const NOT_FINITE: u16 = u16::MAX;

/// Blocks of numbers, one after the other.
#[derive(Debug, Default)]
pub(super) struct Packer {
    bytes: Vec<u8>,
}

/// How positions were rounded: `origin + step * code`.
#[derive(Debug)]
pub(super) struct Rounding {
    pub(super) step: f64,
    /// `[frame]`.
    pub(super) origins: Vec<[f64; 3]>,
}

/// How values were rounded: `low + step * code`.
#[derive(Debug)]
pub(super) struct ValueRounding {
    pub(super) low: f64,
    pub(super) step: f64,
}

impl Packer {
    /// Corners of triangles: first each first corner, told from that of the triangle before, then
    /// the second ones, told from the first ones, then the third ones.
    pub(super) fn faces(&mut self, faces: &[[u32; 3]]) {
        for corner in 0..3 {
            let mut last = 0;
            let codes = faces.iter().map(|face| {
                let before = if corner > 0 { face[corner - 1] } else { last };
                last = face[corner];
                zigzag(last.wrapping_sub(before).cast_signed())
            });
            let codes: Vec<u32> = codes.collect();
            self.planes(&codes, 4);
        }
    }

    /// Positions `[frame][vertex]`.
    pub(super) fn positions(&mut self, frames: &[&[Point3]]) -> Rounding {
        let boxes = frames.iter().map(|positions| box_of(positions));
        let boxes: Vec<[[f64; 3]; 2]> = boxes.collect();
        let sides = boxes
            .iter()
            .flat_map(|[low, high]| [0, 1, 2].map(|k| high[k] - low[k]));
        let longest = sides.fold(0.0, f64::max);
        let step = if longest > 0.0 { longest / LAST } else { 1.0 };
        let origins: Vec<[f64; 3]> = boxes.iter().map(|[low, _]| *low).collect();
        let code = |frame: usize, vertex: usize, axis: usize| {
            let coordinate = f64::from(frames[frame][vertex][axis]);
            ((coordinate - origins[frame][axis]) / step).round() as u16
        };
        self.codes(frames.len(), frames[0].len(), 3, code);
        Rounding { step, origins }
    }

    /// Values `[frame][vertex]`.
    pub(super) fn values(&mut self, frames: &[Vec<f32>]) -> ValueRounding {
        let finite = frames.iter().flatten().filter(|value| value.is_finite());
        let ends = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &value| {
            let value = f64::from(value);
            [low.min(value), high.max(value)]
        });
        let [low, high] = if ends[0] <= ends[1] { ends } else { [0.0; 2] };
        let step = if low < high {
            (high - low) / (LAST - 1.0)
        } else {
            1.0
        };
        let code = |frame: usize, vertex: usize, _: usize| {
            let value = frames[frame][vertex];
            if value.is_finite() {
                ((f64::from(value) - low) / step).round() as u16
            } else {
                NOT_FINITE
            }
        };
        self.codes(frames.len(), frames[0].len(), 1, code);
        ValueRounding { low, step }
    }

    /// Codes of items. They are taken to go on as in the two frames before; how far they are off is
    /// told from how far the item before was.
    fn codes(
        &mut self,
        num_frames: usize,
        num_items: usize,
        num_components: usize,
        code: impl Fn(usize, usize, usize) -> u16,
    ) {
        for frame in 0..num_frames {
            for component in 0..num_components {
                let mut last_off = 0_u16;
                let deltas = (0..num_items).map(|item| {
                    let at = |frame| code(frame, item, component);
                    let guess = match frame {
                        0 => 0,
                        1 => at(0),
                        _ => at(frame - 1).wrapping_mul(2).wrapping_sub(at(frame - 2)),
                    };
                    let off = at(frame).wrapping_sub(guess);
                    let delta = off.wrapping_sub(last_off).cast_signed();
                    last_off = off;
                    // No more than 16 bits, as the delta.
                    zigzag(i32::from(delta))
                });
                let deltas: Vec<u32> = deltas.collect();
                self.planes(&deltas, 2);
            }
        }
    }

    /// The lowest bytes of all codes, then the next ones.
    fn planes(&mut self, codes: &[u32], num_planes: usize) {
        for plane in 0..num_planes {
            self.bytes
                .extend(codes.iter().map(|code| code.to_le_bytes()[plane]));
        }
    }

    /// All blocks, deflated.
    pub(super) fn finish(self) -> Vec<u8> {
        let mut deflated = DeflateEncoder::new(Vec::new(), Compression::best());
        let written = deflated.write_all(&self.bytes);
        written
            .and_then(|()| deflated.finish())
            .expect("a vector takes every byte")
    }
}

/// 0, -1, 1, -2 … as 0, 1, 2, 3 …
fn zigzag(delta: i32) -> u32 {
    ((delta << 1) ^ (delta >> 31)).cast_unsigned()
}

/// The least and the greatest coordinates; of no position, zeros.
fn box_of(positions: &[Point3]) -> [[f64; 3]; 2] {
    let Some(first) = positions.first() else {
        return [[0.0; 3]; 2];
    };
    let coordinates = |point: &Point3| [0, 1, 2].map(|axis| f64::from(point[axis]));
    let first = [coordinates(first); 2];
    positions
        .iter()
        .map(coordinates)
        .fold(first, |[low, high], point| {
            let low = [0, 1, 2].map(|axis| low[axis].min(point[axis]));
            let high = [0, 1, 2].map(|axis| high[axis].max(point[axis]));
            [low, high]
        })
}

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Bytes as text (RFC 4648).
pub(super) fn base64(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |place: usize| u32::from(*chunk.get(place).unwrap_or(&0));
        let bits = (byte(0) << 16) | (byte(1) << 8) | byte(2);
        for digit in 0..4 {
            let value = (bits >> (18 - 6 * digit)) & 63;
            let is_padding = digit > chunk.len();
            text.push(if is_padding {
                '='
            } else {
                DIGITS[value as usize].into()
            });
        }
    }
    text
}
