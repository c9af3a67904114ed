//! Element types: floats, integers, booleans and text, in either byte order.

use super::ArrayProblem;

/// The type of the elements of an array.
#[derive(Debug, Clone, Copy)]
pub(super) struct ElementType {
    /// The letter that `NumPy` gives it.
    pub kind: u8,
    /// Size, in bytes.
    pub size: usize,
    is_big_endian: bool,
}

impl ElementType {
    /// The bytes of a number as little-endian, filled up with zeros.
    fn little_endian(self, item: &[u8]) -> [u8; 8] {
        let mut bytes = [0; 8];
        for (position, &byte) in item.iter().enumerate() {
            let target = if self.is_big_endian {
                item.len() - 1 - position
            } else {
                position
            };
            bytes[target] = byte;
        }
        bytes
    }

    pub(super) fn integer(self, item: &[u8]) -> i64 {
        let value = i64::from_le_bytes(self.little_endian(item));
        let unused_bits = 64 - 8 * self.size as u32;
        match self.kind {
            b'i' => value << unused_bits >> unused_bits,
            _ => value,
        }
    }

    pub(super) fn float(self, item: &[u8]) -> f64 {
        let bits = u64::from_le_bytes(self.little_endian(item));
        match self.size {
            2 => half(bits as u16),
            4 => f64::from(f32::from_bits(bits as u32)),
            _ => f64::from_bits(bits),
        }
    }

    pub(super) fn text_of_code_points(self, item: &[u8]) -> String {
        let code_points = item.chunks_exact(4).map(|code| self.little_endian(code));
        let chars = code_points.map(|bytes| {
            let [a, b, c, d, ..] = bytes;
            char::from_u32(u32::from_le_bytes([a, b, c, d])).unwrap_or(char::REPLACEMENT_CHARACTER)
        });
        chars.collect::<String>().trim_end_matches('\0').to_owned()
    }
}

pub(super) fn text_of_bytes(item: &[u8]) -> String {
    let text = String::from_utf8_lossy(item);
    text.trim_end_matches('\0').to_owned()
}

/// A half-precision float (IEEE 754 binary16).
fn half(bits: u16) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let exponent = i32::from(bits >> 10 & 0x1f);
    let fraction = f64::from(bits & 0x3ff) / 1024.0;
    sign * match exponent {
        0 => fraction * 2.0_f64.powi(-14),
        31 if fraction > 0.0 => f64::NAN,
        31 => f64::INFINITY,
        _ => (1.0 + fraction) * 2.0_f64.powi(exponent - 15),
    }
}

/// Reads a type as `NumPy` writes it: `<f4`.
pub(super) fn element_type(descr: &str) -> Result<ElementType, ArrayProblem> {
    let refused = || ArrayProblem::ElementType {
        descr: descr.chars().take(80).collect(),
    };
    let (order, rest) = match descr.as_bytes() {
        [order @ (b'<' | b'>' | b'|' | b'='), rest @ ..] => (*order, rest),
        rest => (b'=', rest),
    };
    let [kind, digits @ ..] = rest else {
        return Err(refused());
    };
    let digits = str::from_utf8(digits).map_err(|_invalid| refused())?;
    let size: usize = digits.parse().map_err(|_invalid| refused())?;
    let is_big_endian = match order {
        b'>' => true,
        b'=' => cfg!(target_endian = "big"),
        _ => false,
    };
    let size = match (*kind, size) {
        (b'f', 2 | 4 | 8) | (b'i' | b'u', 1 | 2 | 4 | 8) | (b'b', 1) | (b'S', 1..) => size,
        (b'U', 1..) => size.checked_mul(4).ok_or_else(refused)?,
        _ => return Err(refused()),
    };
    Ok(ElementType {
        kind: *kind,
        size,
        is_big_endian,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_floats_cover_small_and_special_values() {
        let bits = [0x0001, 0x7bff, 0xfc00].map(|bits| half(bits).to_bits());
        let expected = [2.0_f64.powi(-24), 65504.0, f64::NEG_INFINITY];
        assert_eq!(bits, expected.map(f64::to_bits));
        assert!(half(0x7e00).is_nan());
    }
}
