//! Dense elimination: the first columns of a symmetric matrix, of which only the lower triangle is there.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Columns that are eliminated before the others hear of them.
const BLOCK: usize = 64;
/// Columns that one thread brings up to date: always the same ones, so that the bits are.
pub(super) const TILE: usize = 128;

/// Room that the dense elimination works in.
pub(super) fn scratch() -> Option<MemBuffer> {
    MemBuffer::try_new(cholesky_in_place_scratch::<f64>(BLOCK, Par::Seq, Default::default())).ok()
}

/// Overwrites the lower part of `panel`, (height, width) by columns, with that of L.
///
/// Fails with the column whose pivot is not positive.
pub(super) fn eliminate(panel: &mut [f64], height: usize, scratch: &mut MemBuffer) -> Result<(), usize> {
    let width = panel.len() / height;
    for first in (0..width).step_by(BLOCK) {
        let count = BLOCK.min(width - first);
        let (done, rest) = panel[first * height..].split_at_mut(count * height);
        let block = MatMut::from_column_major_slice_mut(done, height, count);
        let (mut head, tail) = block.split_at_row_mut(first).1.split_at_row_mut(count);
        let memory = MemStack::new(scratch);
        cholesky_in_place(head.as_mut(), Default::default(), Par::Seq, memory, Default::default())
            .map_err(|LltError::NonPositivePivot { index }| first + index)?;
        if tail.nrows() == 0 {
            continue;
        }
        solve_lower_triangular_in_place(head.as_ref(), tail.transpose_mut(), Par::Seq);
        let done = MatRef::from_column_major_slice(done, height, count);
        rest.par_chunks_mut(TILE * height).enumerate().for_each(|(tile, columns)| {
            subtract_square(done, first + count + tile * TILE, columns, 0, Accum::Add);
        });
    }
    Ok(())
}

/// Overwrites `rest` with −L₂L₂ᵀ for the rows of L below its first `width`, as `merge` reads it.
pub(super) fn leave(panel: &[f64], height: usize, mut rest: &mut [f64]) {
    let width = panel.len() / height;
    let l = MatRef::from_column_major_slice(panel, height, width);
    let mut tiles = Vec::new();
    for from in (width..height).step_by(TILE) {
        let (tile, after) = rest.split_at_mut(TILE.min(height - from) * (height - from));
        tiles.push((from, tile));
        rest = after;
    }
    tiles.into_par_iter().for_each(|(from, tile)| subtract_square(l, from, tile, from, Accum::Replace));
}

/// Takes L Lᵀ off columns of a symmetric matrix from `from` on, whose first `skipped` rows are left out.
fn subtract_square(l: MatRef<'_, f64>, from: usize, columns: &mut [f64], skipped: usize, accum: Accum) {
    let height = l.nrows() - skipped;
    let count = columns.len() / height;
    let columns = MatMut::from_column_major_slice_mut(columns, height, count);
    let (head, tail) = columns.split_at_row_mut(from - skipped).1.split_at_row_mut(count);
    let (l, below) = l.split_at_row(from).1.split_at_row(count);
    let whole = BlockStructure::Rectangular;
    let lower = BlockStructure::TriangularLower;
    triangular::matmul(head, lower, accum, l, whole, l.transpose(), whole, -1.0, Par::Seq);
    if tail.nrows() > 0 {
        matmul(tail, accum, below, l.transpose(), -1.0, Par::Seq);
    }
}
