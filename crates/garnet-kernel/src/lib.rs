//! Fused CPU kernels of the network, forward and backward: mesh convolution, linear layers,
//! pooling.
//!
//! All matrices are row-major slices of `f32`, `[rows, channels]`, in memory of the caller.
//! Temporary memory comes from a [`Workspace`] that is made once. Kernels choose their instructions
//! when they run (AVX-512, AVX2 with FMA, or whatever the compiler makes of plain loops), split
//! rows into tiles of fixed size over the threads of rayon, and sum in a fixed order: the result
//! never depends on the number of threads.
//!
//! ```
//! use garnet_kernel::{
//!     Activation, Adjacency, FeastInput, FeastLayer, Features, Workspace, feast_forward,
//! };
//!
//! let adjacency = Adjacency::from_faces(3, &[[0, 1, 2]])?;
//! let positions = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
//! let layer = FeastLayer {
//!     num_heads: 1, // One head takes the same of all neighbors: their average.
//!     out_channels: 1,
//!     u: &[0.0; 3],
//!     c: &[0.0],
//!     w: &[3.0, 6.0, 0.0],
//!     b: &[0.5],
//!     activation: Activation::LeakyRelu,
//! };
//! let input = FeastInput {
//!     adjacency: &adjacency,
//!     features: &[Features::new(&positions, 3)],
//!     residual: None,
//! };
//! let mut y = [0.0; 3];
//! feast_forward(&layer, &input, &mut y, &Workspace::new());
//! assert!(y.iter().all(|y| (y - 3.5).abs() < 1e-5));
//! # Ok::<(), garnet_kernel::KernelError>(())
//! ```

#![warn(clippy::undocumented_unsafe_blocks)]
#![allow(
    clippy::inline_always,
    reason = "loops must be compiled inside functions for given instructions"
)]
#![allow(clippy::doc_markdown, reason = "FeaStNet is a name")]
#![allow(
    clippy::needless_for_each,
    reason = "one statement on each value reads best on one line"
)]
#![allow(
    clippy::needless_range_loop,
    reason = "heads index several arrays of registers"
)]

mod activation;
mod adjacency;
mod adjacency_tiles;
mod check;
mod error;
mod feast;
mod feast_aggregate;
mod feast_attention;
mod feast_backward;
mod feast_collect;
mod feast_columns;
mod features;
mod global_max;
mod instructions;
mod lanes;
#[cfg(target_arch = "x86_64")]
mod lanes_avx2;
#[cfg(target_arch = "x86_64")]
mod lanes_avx512;
mod lanes_portable;
mod linear;
mod linear_backward;
mod matmul;
mod neighbor_max;
mod neighbor_mean;
mod neighbor_table;
mod reduce;
mod residual;
mod workspace;

pub use activation::{Activation, LEAKY_SLOPE};
pub use adjacency::Adjacency;
pub use error::KernelError;
pub use feast::{FeastInput, FeastLayer, feast_forward};
pub use feast_backward::{FeastGradients, feast_backward};
pub use features::Features;
pub use global_max::{global_max_backward, global_max_forward};
pub use instructions::InstructionSet;
pub use linear::{LinearInput, LinearLayer, linear_forward};
pub use linear_backward::{LinearGradients, linear_backward};
pub use neighbor_max::{neighbor_max_backward, neighbor_max_forward};
pub use neighbor_mean::{neighbor_mean_backward, neighbor_mean_forward};
pub use neighbor_table::NeighborTable;
pub use residual::{add_backward, add_forward};
pub use workspace::Workspace;
