//! Which mesh a file belongs to.

use std::{fmt, hash::Hasher, str::FromStr};

use fnv::FnvHasher;

use crate::{Point3, TriMesh};

/// A hash that tells meshes apart: 64 bits, written as 16 hexadecimal digits.
///
/// It depends on the values alone, not on the machine, so that files can hold it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Fingerprint(u64);

/// A text that is no fingerprint.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is no fingerprint: 16 hexadecimal digits")]
pub struct FingerprintError {
    /// The text.
    pub text: String,
}

impl Fingerprint {
    /// That of a topology: the faces and the number of vertices. Sizes of one pattern share it.
    ///
    /// ```
    /// use garnet_mesh::{Fingerprint, primitives::grid};
    ///
    /// let (small, large) = (grid(4, 3, [1.0, 1.0]), grid(4, 3, [2.0, 1.0]));
    /// assert_eq!(Fingerprint::of_topology(&small), Fingerprint::of_topology(&large));
    /// assert_ne!(Fingerprint::of_topology(&small), Fingerprint::of_topology(&grid(3, 4, [1.0, 1.0])));
    /// ```
    pub fn of_topology(mesh: &TriMesh) -> Self {
        let mut hasher = FnvHasher::default();
        hasher.write(&(mesh.num_vertices() as u64).to_le_bytes());
        for vertex in mesh.faces().as_flattened() {
            hasher.write(&vertex.to_le_bytes());
        }
        Self(hasher.finish())
    }

    /// That of positions, to the last bit.
    pub fn of_positions(positions: &[Point3]) -> Self {
        let mut hasher = FnvHasher::default();
        for value in positions.iter().flat_map(|point| point.iter()) {
            hasher.write(&value.to_bits().to_le_bytes());
        }
        Self(hasher.finish())
    }

    /// That of any bytes.
    pub fn of_bytes(bytes: &[u8]) -> Self {
        let mut hasher = FnvHasher::default();
        hasher.write(bytes);
        Self(hasher.finish())
    }
}

impl fmt::Display for Fingerprint {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{:016x}", self.0)
    }
}

impl FromStr for Fingerprint {
    type Err = FingerprintError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let is_hexadecimal = text.len() == 16 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        let value = is_hexadecimal.then(|| u64::from_str_radix(text, 16).ok());
        value.flatten().map(Self).ok_or_else(|| FingerprintError {
            text: text.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values_of_fnv_1a() {
        // Fowler, Noll, Vo: the reference vectors of the 64-bit hash.
        assert_eq!(Fingerprint::of_bytes(b"").to_string(), "cbf29ce484222325");
        assert_eq!(
            Fingerprint::of_bytes(b"foobar").to_string(),
            "85944171f73967e8"
        );
    }

    #[test]
    fn texts_come_back() {
        let print = Fingerprint::of_positions(&[Point3::new(1.0, 2.0, 3.0)]);
        assert_eq!(print.to_string().parse(), Ok(print));
        for text in ["", "12", "+5944171f73967e8", "85944171f73967eg"] {
            assert!(text.parse::<Fingerprint>().is_err(), "{text}");
        }
    }
}
