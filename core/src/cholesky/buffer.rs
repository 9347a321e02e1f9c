//! Arrays of f64 numbers that are zeroed when they are allocated; a failed allocation is an error, not a panic.

use super::error::FactorError;
use memmap2::MmapMut;
use std::ops::{Deref, DerefMut};

/// Smallest buffer, in bytes, that is allocated by the operating system, which zeros pages at first access. Smaller
/// buffers come from the allocator, which reuses freed memory (second factorization of 160×160 `mitc9`: 0.78 s instead
/// of 0.94 s).
///
/// Huge pages are not used: on a virtual machine that returns free pages to its host, they take longer to obtain.
const LARGE: usize = 1 << 25;

/// An array of numbers, initially zeros.
pub(super) enum Buffer {
    Small(Vec<f64>),
    Large { pages: MmapMut, len: usize },
}

impl Buffer {
    pub(super) fn new(len: usize) -> Result<Self, FactorError> {
        let bytes = len.checked_mul(size_of::<f64>()).ok_or(FactorError::OutOfMemory)?;
        if bytes < LARGE {
            let mut values = Vec::new();
            values.try_reserve_exact(len).map_err(|_| FactorError::OutOfMemory)?;
            values.resize(len, 0.0);
            return Ok(Self::Small(values));
        }
        let pages = MmapMut::map_anon(bytes).map_err(|_| FactorError::OutOfMemory)?;
        Ok(Self::Large { pages, len })
    }
}

impl Deref for Buffer {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        match self {
            Self::Small(values) => values,
            Self::Large { pages, len } => &bytemuck::cast_slice(pages)[..*len],
        }
    }
}

impl DerefMut for Buffer {
    fn deref_mut(&mut self) -> &mut [f64] {
        match self {
            Self::Small(values) => values,
            Self::Large { pages, len } => &mut bytemuck::cast_slice_mut(pages)[..*len],
        }
    }
}
