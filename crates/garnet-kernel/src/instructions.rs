//! Which instructions kernels use, found out when the program runs.

#![allow(
    unsafe_code,
    reason = "functions compiled for instructions that were detected"
)]

use std::sync::{
    OnceLock,
    atomic::{AtomicU8, Ordering},
};

use crate::lanes::Lanes;
use crate::lanes_portable::Portable;
#[cfg(target_arch = "x86_64")]
use crate::{lanes_avx2::Avx2, lanes_avx512::Avx512};

/// A level of vector instructions; a later one is faster.
///
/// Results of two levels differ by rounding. (Matrix products choose for themselves, always the
/// best.)
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum InstructionSet {
    /// Whatever the compiler makes of plain arithmetic, eight numbers at a time: SSE2 on x86-64,
    /// NEON on Arm.
    Portable,
    /// AVX2 and FMA: eight numbers.
    Avx2,
    /// AVX-512 (F, VL, BW, DQ): sixteen numbers.
    Avx512,
}

/// A computation that is compiled once for each level.
pub(crate) trait Kernel {
    /// Runs with vectors of the type `V`. Implementations are `#[inline(always)]`, so that their
    /// loops are compiled with the instructions of `V`.
    fn run<V: Lanes>(self);
}

/// The position in [`InstructionSet::ALL`] of the latest level that may be used.
static LATEST: AtomicU8 = AtomicU8::new(u8::MAX);

impl InstructionSet {
    /// All levels, the plainest first.
    const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The level that new workspaces use: the best of this machine that was not switched off.
    pub fn usual() -> Self {
        let latest = Self::ALL.get(usize::from(LATEST.load(Ordering::Relaxed)));
        latest.map_or_else(Self::detected, |latest| Self::detected().min(*latest))
    }

    /// Switches all later levels off, for workspaces that this process makes from now on.
    pub fn limit(self) {
        LATEST.store(self as u8, Ordering::Relaxed);
    }

    /// The best level of this machine.
    pub fn detected() -> Self {
        static DETECTED: OnceLock<InstructionSet> = OnceLock::new();
        *DETECTED.get_or_init(detect)
    }

    /// All levels that this machine has, the plainest first.
    pub fn available() -> Vec<Self> {
        let mut levels = Self::ALL.to_vec();
        levels.retain(|level| *level <= Self::detected());
        levels
    }

    /// Numbers a vector.
    pub(crate) fn lanes(self) -> usize {
        if self == Self::Avx512 { 16 } else { 8 }
    }

    /// Runs a kernel compiled for this level.
    #[inline]
    pub(crate) fn run<K: Kernel>(self, kernel: K) {
        match self {
            // SAFETY: `Workspace` lowers what it is given to what was detected, and nobody else
            // makes calls.
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => unsafe { run_avx512(kernel) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => unsafe { run_avx2(kernel) },
            _ => kernel.run::<Portable>(),
        }
    }
}

impl Default for InstructionSet {
    fn default() -> Self {
        Self::usual()
    }
}

#[cfg(target_arch = "x86_64")]
fn detect() -> InstructionSet {
    let has_avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
    let has_avx512 = is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq");
    match (has_avx2, has_avx512) {
        (true, true) => InstructionSet::Avx512,
        (true, false) => InstructionSet::Avx2,
        _ => InstructionSet::Portable,
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn detect() -> InstructionSet {
    InstructionSet::Portable
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq,avx2,fma")]
fn run_avx512<K: Kernel>(kernel: K) {
    kernel.run::<Avx512>();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2<K: Kernel>(kernel: K) {
    kernel.run::<Avx2>();
}
