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
/// Rows that one thread solves below a block.
const ROWS: usize = 256;
/// Columns of L that are taken off others at a time.
const DEPTH: usize = 256;
/// Rows below a tile from which its own rows of L are copied one after the other: where they lie, neighbours in a row are
/// pages apart, and the product reads each row many times.
const TALL: usize = 512;

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
        let head = head.as_ref();
        tail.par_row_chunks_mut(ROWS)
            .for_each(|rows| solve_lower_triangular_in_place(head, rows.transpose_mut(), Par::Seq));
        let done = &*done;
        rest.par_chunks_mut(TILE * height).enumerate().for_each(|(tile, columns)| {
            subtract_square(done, height, first + count + tile * TILE, columns, 0, Accum::Add);
        });
    }
    Ok(())
}

/// Overwrites `rest` with −L₂L₂ᵀ for the rows of L below its first `width`, as `merge` reads it.
pub(super) fn leave(panel: &[f64], height: usize, mut rest: &mut [f64]) {
    let width = panel.len() / height;
    let mut tiles = Vec::new();
    for from in (width..height).step_by(TILE) {
        let (tile, after) = rest.split_at_mut(TILE.min(height - from) * (height - from));
        tiles.push((from, tile));
        rest = after;
    }
    tiles.into_par_iter().for_each(|(from, tile)| subtract_square(panel, height, from, tile, from, Accum::Replace));
}

/// Takes L Lᵀ off columns of a symmetric matrix from `from` on, whose first `skipped` rows are left out.
fn subtract_square(l: &[f64], height: usize, from: usize, columns: &mut [f64], skipped: usize, accum: Accum) {
    let count = columns.len() / (height - skipped);
    let columns = MatMut::from_column_major_slice_mut(columns, height - skipped, count);
    let (mut head, mut tail) = columns.split_at_row_mut(from - skipped).1.split_at_row_mut(count);
    let mut rows = Vec::new();
    for (at, l) in l.chunks(DEPTH * height).enumerate() {
        let accum = if at == 0 { accum } else { Accum::Add };
        let width = l.len() / height;
        let (own, below) = MatRef::from_column_major_slice(l, height, width).split_at_row(from).1.split_at_row(count);
        let mut transposed = own.transpose();
        rows.clear();
        if tail.nrows() >= TALL && rows.try_reserve_exact(width * count).is_ok() {
            copy_rows(l, height, from, count, &mut rows);
            transposed = MatRef::from_column_major_slice(&rows, width, count);
        }
        let whole = BlockStructure::Rectangular;
        let lower = BlockStructure::TriangularLower;
        triangular::matmul(head.as_mut(), lower, accum, own, whole, transposed, whole, -1.0, Par::Seq);
        if tail.nrows() > 0 {
            matmul(tail.as_mut(), accum, below, transposed, -1.0, Par::Seq);
        }
    }
}

/// Overwrites `rows` with `count` rows of columns that are `height` long, one row after the other.
fn copy_rows(columns: &[f64], height: usize, from: usize, count: usize, rows: &mut Vec<f64>) {
    /// Columns at a time: those of a line of the cache.
    const FEW: usize = 8;
    let width = columns.len() / height;
    rows.resize(width * count, 0.0);
    for first in (0..width).step_by(FEW) {
        let last = width.min(first + FEW) - 1;
        let few: [&[f64]; FEW] = std::array::from_fn(|k| &columns[last.min(first + k) * height + from..][..count]);
        for (i, row) in rows.chunks_exact_mut(width).enumerate() {
            for (value, column) in row[first..=last].iter_mut().zip(few) {
                *value = column[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cholesky::merge::triangle;

    /// Some tiles are tall, some not, and the columns are taken off in two steps.
    #[test]
    fn a_large_front_is_that_of_its_products() {
        let (width, height) = (DEPTH + 20, DEPTH + 20 + TALL + 2 * TILE + 5);
        let entry = |row: usize, column: usize| {
            let value = ((row * 7 + column * 13) as f64).sin();
            if row == column { 2.0 * height as f64 } else { value }
        };
        let mut l: Vec<f64> = (0..width * height).map(|at| entry(at % height, at / height)).collect();
        eliminate(&mut l, height, &mut scratch().unwrap()).unwrap();
        let mut rest = vec![f64::NAN; triangle(height - width)];
        leave(&l, height, &mut rest);
        let product =
            |i: usize, j: usize| -> f64 { (0..width.min(j + 1)).map(|k| l[k * height + i] * l[k * height + j]).sum() };
        for j in (0..width).step_by(7) {
            for i in (j..height).step_by(11) {
                assert!((product(i, j) - entry(i, j)).abs() < 1e-10 * height as f64);
            }
        }
        let mut at = 0;
        for first in (width..height).step_by(TILE) {
            for j in first..height.min(first + TILE) {
                for i in (j..height).step_by(11) {
                    let left = rest[at + i - first];
                    assert!((product(i, j) + left).abs() < 1e-12 * height as f64);
                }
                at += height - first;
            }
        }
    }
}
