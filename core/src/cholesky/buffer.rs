//! Room for numbers, which is there or is refused, and which nothing writes before its user does.

use super::error::FactorError;
use memmap2::MmapMut;
use std::ops::{Deref, DerefMut};

/// Bytes from which room is taken from the system itself, which hands out zeros on first touch; below, the allocator
/// uses again what was freed (160×160 `mitc9`, factored again: 0.78 s instead of 0.94).
///
/// Huge pages were tried: where a virtual machine gives free ones back to its host they are slower to come by.
const LARGE: usize = 1 << 25;

/// Zeros to begin with.
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
