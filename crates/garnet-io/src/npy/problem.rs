//! What can be wrong with an array.

/// What is wrong with an array.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArrayProblem {
    /// The entry does not start as an npy array does, or its header makes no sense.
    #[error("it is no npy array: {what}")]
    NotAnArray {
        /// What does not fit.
        what: &'static str,
    },
    /// The element type is not a number or text.
    #[error("it has the element type `{descr}`, expected floats, integers, booleans or text")]
    ElementType {
        /// The type as `NumPy` writes it.
        descr: String,
    },
    /// The elements are of the wrong kind, such as text instead of numbers.
    #[error("it holds {found}, expected {expected}")]
    Kind {
        /// What it holds.
        found: &'static str,
        /// What it should hold.
        expected: &'static str,
    },
    /// The file ends within the array.
    #[error("its shape {shape:?} needs {expected} bytes, but there are {found}")]
    Truncated {
        /// Its shape.
        shape: Vec<usize>,
        /// Bytes needed.
        expected: usize,
        /// Bytes there.
        found: usize,
    },
    /// The array is larger than is sensible.
    #[error("it has more than {limit} bytes")]
    TooLarge {
        /// The largest size that is read.
        limit: u64,
    },
    /// The shape is another one than the key has.
    #[error("it has the shape {found:?}, expected {expected}")]
    Shape {
        /// Its shape.
        found: Vec<usize>,
        /// The shape that the key has.
        expected: String,
    },
    /// A value that should be a number of something is not whole or out of range.
    #[error("its element {index} is `{value}`, expected {expected}")]
    Value {
        /// Position in the array, in C order.
        index: usize,
        /// The value.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
    /// Two entries are alike that have to differ.
    #[error("it has `{name}` twice")]
    Twice {
        /// The entry.
        name: String,
    },
    /// The archive entry cannot be unpacked.
    #[error("it cannot be unpacked: {reason}")]
    Unpack {
        /// What the unpacker says.
        reason: String,
    },
}

/// The problem that bytes are no array.
pub(super) const fn not_an_array(what: &'static str) -> ArrayProblem {
    ArrayProblem::NotAnArray { what }
}
