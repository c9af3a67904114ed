//! What a model costs.

#[cfg(feature = "burn")]
mod of_network;

/// Size and work of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Cost {
    /// Weights.
    pub parameters: u64,
    /// Multiplications and additions of one forward pass.
    ///
    /// Features that all vertices share are counted once, as they are computed.
    pub flops: u64,
}
