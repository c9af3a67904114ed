//! The array format of `NumPy`, versions 1 to 3 (NEP 1).
//!
//! Hand-written, because a header may come from anywhere: sizes are checked against the bytes that
//! are there before anything is allocated.

mod element;
mod header;
mod problem;

use element::{element_type, text_of_bytes};
use header::{quoted_after, shape, split_header, value_after};
pub use problem::ArrayProblem;
use problem::not_an_array;

/// Elements of an array, in C order.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum NpyValues {
    /// `f2`, `f4`, `f8`.
    Floats(Vec<f64>),
    /// `i1` to `i8`, `u1` to `u8` (those above `i64::MAX` wrap), `b1`.
    Integers(Vec<i64>),
    /// `U` and `S`, without the zeros at their ends.
    Texts(Vec<String>),
}

/// An array out of an npz archive.
#[derive(Debug, Clone, PartialEq)]
pub struct NpyArray {
    /// Length of each axis, the slowest first.
    pub shape: Vec<usize>,
    /// The elements, in C order.
    pub values: NpyValues,
    /// What -1 becomes where the element type is unsigned.
    pub(super) wrapped_minus_one: Option<i64>,
    is_boolean: bool,
}

impl NpyArray {
    /// Reads the bytes of an `.npy` file.
    ///
    /// # Errors
    ///
    /// [`ArrayProblem`] if they are no array of numbers or text, or too few.
    pub fn parse(bytes: &[u8]) -> Result<Self, ArrayProblem> {
        let (header, data) = split_header(bytes)?;
        let descr = quoted_after(header, "descr").ok_or(not_an_array("there is no `descr`"))?;
        let element = element_type(descr)?;
        let is_fortran = value_after(header, "fortran_order")
            .ok_or(not_an_array("there is no `fortran_order`"))?
            .starts_with("True");
        let shape = shape(header)?;
        let num_elements = shape
            .iter()
            .try_fold(1_usize, |product, &axis| product.checked_mul(axis));
        let num_bytes = num_elements.and_then(|count| count.checked_mul(element.size));
        let num_bytes = num_bytes.ok_or(not_an_array("its shape is too large"))?;
        let Some(data) = data.get(..num_bytes) else {
            return Err(ArrayProblem::Truncated {
                shape,
                expected: num_bytes,
                found: data.len(),
            });
        };
        let items = data.chunks_exact(element.size.max(1));
        let values = match element.kind {
            b'f' => NpyValues::Floats(items.map(|item| element.float(item)).collect()),
            b'U' => NpyValues::Texts(
                items
                    .map(|item| element.text_of_code_points(item))
                    .collect(),
            ),
            b'S' => NpyValues::Texts(items.map(text_of_bytes).collect()),
            _ => NpyValues::Integers(items.map(|item| element.integer(item)).collect()),
        };
        let values = if is_fortran && shape.len() > 1 {
            values.in_c_order(&shape)
        } else {
            values
        };
        let is_unsigned = element.kind == b'u';
        let is_boolean = element.kind == b'b';
        Ok(Self {
            shape,
            values,
            wrapped_minus_one: is_unsigned.then(|| element.integer(&[0xff; 8][..element.size])),
            is_boolean,
        })
    }

    /// Whether the elements are `b1`, which are read as integers.
    pub fn is_boolean(&self) -> bool {
        self.is_boolean
    }

    /// The elements as floats, in C order; integers are converted.
    ///
    /// # Errors
    ///
    /// [`ArrayProblem::Kind`] for text.
    pub fn floats(&self) -> Result<Vec<f64>, ArrayProblem> {
        match &self.values {
            NpyValues::Floats(values) => Ok(values.clone()),
            NpyValues::Integers(values) => Ok(values.iter().map(|&value| value as f64).collect()),
            NpyValues::Texts(_) => Err(ArrayProblem::Kind {
                found: "text",
                expected: "numbers",
            }),
        }
    }

    /// The elements as integers, in C order; whole floats are converted.
    ///
    /// # Errors
    ///
    /// [`ArrayProblem::Kind`] for text and [`ArrayProblem::Value`] for fractions.
    pub fn integers(&self) -> Result<Vec<i64>, ArrayProblem> {
        if let NpyValues::Integers(values) = &self.values {
            return Ok(values.clone());
        }
        let mut integers = Vec::new();
        for (index, value) in self.floats()?.into_iter().enumerate() {
            if value.fract() != 0.0 || !value.is_finite() {
                return Err(ArrayProblem::Value {
                    index,
                    value,
                    expected: "a whole number",
                });
            }
            integers.push(value as i64);
        }
        Ok(integers)
    }

    /// The elements as text.
    ///
    /// # Errors
    ///
    /// [`ArrayProblem::Kind`] for numbers.
    pub fn texts(&self) -> Result<Vec<String>, ArrayProblem> {
        match &self.values {
            NpyValues::Texts(values) => Ok(values.clone()),
            NpyValues::Floats(_) | NpyValues::Integers(_) => Err(ArrayProblem::Kind {
                found: "numbers",
                expected: "text",
            }),
        }
    }
}

impl NpyValues {
    /// Moves elements from Fortran order, in which the first axis runs fastest.
    fn in_c_order(self, shape: &[usize]) -> Self {
        match self {
            Self::Floats(values) => Self::Floats(in_c_order(&values, shape)),
            Self::Integers(values) => Self::Integers(in_c_order(&values, shape)),
            Self::Texts(values) => Self::Texts(in_c_order(&values, shape)),
        }
    }
}

fn in_c_order<T: Clone>(values: &[T], shape: &[usize]) -> Vec<T> {
    let mut index = vec![0; shape.len()];
    let mut moved = Vec::with_capacity(values.len());
    for _ in 0..values.len() {
        let (mut source, mut stride) = (0, 1);
        for (&position, &length) in index.iter().zip(shape) {
            source += position * stride;
            stride *= length;
        }
        moved.push(values[source].clone());
        for axis in (0..shape.len()).rev() {
            index[axis] += 1;
            if index[axis] < shape[axis] {
                break;
            }
            index[axis] = 0;
        }
    }
    moved
}

/// The bytes of an `.npy` file, version 1, of little-endian `data` in C order.
pub(super) fn encode(descr: &str, shape: &[usize], data: &[u8]) -> Vec<u8> {
    let mut bytes = header(descr, shape);
    bytes.extend(data);
    bytes
}

/// What stands before the data of an `.npy` file.
pub(super) fn header(descr: &str, shape: &[usize]) -> Vec<u8> {
    let axes: Vec<String> = shape.iter().map(|axis| format!("{axis},")).collect();
    let axes = axes.join(" ");
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({axes}), }}");
    // Data starts at a multiple of 64 bytes, behind 10 bytes of magic, version and length.
    let padding = (64 - (10 + header.len() + 1) % 64) % 64;
    header.push_str(&" ".repeat(padding));
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn every_element_type_and_byte_order_reads_the_same_numbers() {
        let little: [(&str, Vec<u8>); 12] = [
            (
                "f2",
                [0x3c00_u16, 0xc000, 0x4200]
                    .iter()
                    .flat_map(|v| v.to_le_bytes())
                    .collect(),
            ),
            (
                "f4",
                [1.0_f32, -2.0, 3.0]
                    .iter()
                    .flat_map(|v| v.to_le_bytes())
                    .collect(),
            ),
            (
                "f8",
                [1.0_f64, -2.0, 3.0]
                    .iter()
                    .flat_map(|v| v.to_le_bytes())
                    .collect(),
            ),
            (
                "i1",
                [1_i8, -2, 3].iter().flat_map(|v| v.to_le_bytes()).collect(),
            ),
            (
                "i2",
                [1_i16, -2, 3]
                    .iter()
                    .flat_map(|v| v.to_le_bytes())
                    .collect(),
            ),
            (
                "i4",
                [1_i32, -2, 3]
                    .iter()
                    .flat_map(|v| v.to_le_bytes())
                    .collect(),
            ),
            (
                "i8",
                [1_i64, -2, 3]
                    .iter()
                    .flat_map(|v| v.to_le_bytes())
                    .collect(),
            ),
            ("u1", vec![1, 2, 3]),
            (
                "u2",
                [1_u16, 2, 3].iter().flat_map(|v| v.to_le_bytes()).collect(),
            ),
            (
                "u4",
                [1_u32, 2, 3].iter().flat_map(|v| v.to_le_bytes()).collect(),
            ),
            (
                "u8",
                [1_u64, 2, 3].iter().flat_map(|v| v.to_le_bytes()).collect(),
            ),
            ("b1", vec![1, 0, 1]),
        ];
        for (kind, bytes) in little {
            let size = bytes.len() / 3;
            let expected = match kind.as_bytes()[0] {
                b'u' => [1.0, 2.0, 3.0],
                b'b' => [1.0, 0.0, 1.0],
                _ => [1.0, -2.0, 3.0],
            };
            let big: Vec<u8> = bytes
                .chunks(size)
                .flat_map(|item| item.iter().rev().copied())
                .collect();
            for (order, data) in [('<', &bytes), ('>', &big)] {
                let array =
                    NpyArray::parse(&encode(&format!("{order}{kind}"), &[3], data)).unwrap();
                assert_eq!(array.floats().unwrap(), expected, "{order}{kind}");
                assert_eq!(array.is_boolean(), kind == "b1");
            }
        }
    }

    #[test]
    fn fortran_order_is_turned_into_c_order() {
        let mut bytes = encode("|u1", &[2, 3], &[1, 4, 2, 5, 3, 6]);
        let start = bytes.windows(5).position(|window| window == b"False");
        let start = start.unwrap();
        bytes[start..start + 5].copy_from_slice(b"True ");
        let array = NpyArray::parse(&bytes).unwrap();
        assert_eq!(array.integers().unwrap(), [1, 2, 3, 4, 5, 6]);
    }

    #[test]
    fn texts_of_both_kinds_are_read() {
        let codes: Vec<u8> = "hip\0knee"
            .chars()
            .flat_map(|c| (c as u32).to_le_bytes())
            .collect();
        let array = NpyArray::parse(&encode("<U4", &[2], &codes)).unwrap();
        assert_eq!(array.texts().unwrap(), ["hip", "knee"]);
        let array = NpyArray::parse(&encode("|S4", &[2], b"hip\0knee")).unwrap();
        assert_eq!(array.texts().unwrap(), ["hip", "knee"]);
        assert!(array.floats().is_err());
    }

    #[test]
    fn shapes_beyond_the_data_records_and_pickles_are_refused() {
        let error = NpyArray::parse(&encode("<f8", &[1 << 40, 1 << 40], &[0; 8])).unwrap_err();
        assert!(matches!(error, ArrayProblem::NotAnArray { .. }));
        let error = NpyArray::parse(&encode("<f8", &[3], &[0; 23])).unwrap_err();
        assert!(matches!(
            error,
            ArrayProblem::Truncated {
                expected: 24,
                found: 23,
                ..
            }
        ));
        for descr in ["|O", "<c16", "<f16", "", "<f", "<M8[ns]"] {
            let error = NpyArray::parse(&encode(descr, &[1], &[0; 32])).unwrap_err();
            assert!(
                matches!(error, ArrayProblem::ElementType { .. }),
                "{descr}: {error}"
            );
        }
    }

    proptest! {
        #[test]
        fn no_bytes_make_the_reader_panic(mut bytes in prop::collection::vec(any::<u8>(), 0..200), at in 0_usize..100, value in any::<u8>()) {
            let _ = NpyArray::parse(&bytes);
            bytes.splice(0..0, *b"\x93NUMPY\x01\x00");
            let _ = NpyArray::parse(&bytes);
            let mut mutated = encode("<f4", &[2, 2], &[0; 16]);
            let position = at % mutated.len();
            mutated[position] = value;
            let _ = NpyArray::parse(&mutated);
        }
    }
}
