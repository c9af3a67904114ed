//! Memory that kernels need for a while, kept from call to call.
//!
//! Fresh pages cost more than the arithmetic on them, so buffers are handed out from a pool and
//! given back on drop. Their content is whatever was there before: who takes a buffer writes it
//! first.

#![allow(unsafe_code, reason = "64-byte blocks are seen as numbers")]

use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, PoisonError};

use crate::InstructionSet;

/// Scratch memory and the choice of instructions, made once and given to every kernel.
///
/// It may be shared by threads; one for a whole network is right. It grows to the largest need and
/// never shrinks.
#[derive(Debug, Default)]
pub struct Workspace {
    instructions: InstructionSet,
    free: Mutex<Vec<Vec<Block>>>,
}

/// One cache line, so that vectors of 16 numbers never straddle two.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
struct Block([f32; BLOCK]);

const BLOCK: usize = 16;

/// A buffer of the pool, as long as it is held.
#[derive(Debug)]
pub(crate) struct Scratch<'a> {
    blocks: Vec<Block>,
    len: usize,
    owner: &'a Workspace,
}

impl Workspace {
    /// An empty workspace that uses the best instructions ([`InstructionSet::usual`]).
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty workspace that uses the given instructions, or the best below them that this
    /// machine has.
    pub fn with_instructions(instructions: InstructionSet) -> Self {
        Self {
            instructions: instructions.min(InstructionSet::detected()),
            free: Mutex::default(),
        }
    }

    /// The instructions that kernels use with this workspace.
    pub fn instructions(&self) -> InstructionSet {
        self.instructions
    }

    /// Memory kept at the moment, in bytes.
    pub fn num_bytes(&self) -> usize {
        let free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        free.iter()
            .map(|blocks| blocks.capacity() * size_of::<Block>())
            .sum()
    }

    /// A buffer of `len` numbers with arbitrary finite or infinite content.
    pub(crate) fn scratch(&self, len: usize) -> Scratch<'_> {
        let num_blocks = len.div_ceil(BLOCK);
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        // The smallest that is large enough; else the largest, which then grows.
        let fitting = (0..free.len())
            .filter(|&i| free[i].capacity() >= num_blocks)
            .min_by_key(|&i| free[i].capacity())
            .or_else(|| (0..free.len()).max_by_key(|&i| free[i].capacity()));
        let mut blocks = fitting.map(|i| free.swap_remove(i)).unwrap_or_default();
        drop(free);
        if blocks.len() < num_blocks {
            if blocks.capacity() < num_blocks {
                blocks = Vec::with_capacity(num_blocks); // Old content need not be moved.
            }
            blocks.resize(num_blocks, Block([0.0; BLOCK]));
        }
        Scratch {
            blocks,
            len,
            owner: self,
        }
    }

    /// A buffer of zeros.
    pub(crate) fn zeros(&self, len: usize) -> Scratch<'_> {
        let mut scratch = self.scratch(len);
        scratch.fill(0.0);
        scratch
    }
}

impl Drop for Scratch<'_> {
    fn drop(&mut self) {
        let blocks = std::mem::take(&mut self.blocks);
        self.owner
            .free
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(blocks);
    }
}

impl Deref for Scratch<'_> {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        // SAFETY: `Block` is `repr(C)` around 16 numbers with no padding (64 bytes, aligned to 64),
        // and `scratch` made at least `len / 16` of them, rounded up.
        unsafe { std::slice::from_raw_parts(self.blocks.as_ptr().cast(), self.len) }
    }
}

impl DerefMut for Scratch<'_> {
    fn deref_mut(&mut self) -> &mut [f32] {
        // SAFETY: as in `deref`; the borrow of `self` is exclusive.
        unsafe { std::slice::from_raw_parts_mut(self.blocks.as_mut_ptr().cast(), self.len) }
    }
}
