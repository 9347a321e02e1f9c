//! Dense elimination of the first columns of a symmetric matrix, which is stored as its lower triangle.
//!
//! The pivots have given signs S, 1 or −1: A = L S Lᵀ. If all signs of a block of columns are 1, S is left out of the
//! block's products.

use crate::vectorized::vectorized;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Number of columns that are eliminated as a block before the later columns are updated.
const BLOCK: usize = 64;
/// Number of columns that a thread updates at a time. It is fixed, so that results are the same to the last bit for any
/// number of threads.
pub(super) const TILE: usize = 128;
/// Number of rows below a diagonal block for which a thread does the triangular solve at a time.
const ROWS: usize = 256;
/// Number of columns of L in one matrix product of an update.
const DEPTH: usize = 256;
/// Smallest number of rows below a tile of columns for which the tile's rows of L are copied to contiguous memory.
/// Without the copy, neighbours in a row are pages apart, and the product reads each row many times.
const TALL: usize = 512;

/// Allocates the workspace of the dense elimination; `None` if there is not enough memory.
pub(super) fn scratch() -> Option<MemBuffer> {
    MemBuffer::try_new(cholesky_in_place_scratch::<f64>(BLOCK, Par::Seq, Default::default())).ok()
}

/// Overwrites the lower trapezoid of `panel`, a column-major array (height, width), with L.
///
/// Returns the first column whose pivot does not have the sign given in `signs`, as an error.
pub(super) fn eliminate(panel: &mut [f64], height: usize, signs: &[f64], scratch: &mut MemBuffer) -> Result<(), usize> {
    let width = panel.len() / height;
    for first in (0..width).step_by(BLOCK) {
        let count = BLOCK.min(width - first);
        let signs = &signs[first..first + count];
        let signed = has_negative(signs);
        let (done, rest) = panel[first * height..].split_at_mut(count * height);
        if signed {
            eliminate_signed(&mut done[first..], height, signs).map_err(|index| first + index)?;
        }
        let block = MatMut::from_column_major_slice_mut(&mut *done, height, count);
        let (mut head, tail) = block.split_at_row_mut(first).1.split_at_row_mut(count);
        if !signed {
            let memory = MemStack::new(scratch);
            cholesky_in_place(head.as_mut(), Default::default(), Par::Seq, memory, Default::default())
                .map_err(|LltError::NonPositivePivot { index }| first + index)?;
        }
        if tail.nrows() == 0 {
            continue;
        }
        let head = head.as_ref();
        tail.par_row_chunks_mut(ROWS)
            .for_each(|rows| solve_lower_triangular_in_place(head, rows.transpose_mut(), Par::Seq));
        if signed {
            // The triangular solve gives L₂S. Changing signs of its columns gives L₂.
            for (column, _) in done.chunks_exact_mut(height).zip(signs).filter(|&(_, &sign)| sign < 0.0) {
                column[first + count..].iter_mut().for_each(|value| *value = -*value);
            }
        }
        let done = &*done;
        rest.par_chunks_mut(TILE * height).enumerate().for_each(|(tile, columns)| {
            subtract_square(done, height, signs, first + count + tile * TILE, columns, 0, Accum::Add);
        });
    }
    Ok(())
}

fn has_negative(signs: &[f64]) -> bool {
    signs.iter().any(|&sign| sign < 0.0)
}

/// Overwrites the lower triangle of a square block with L, column by column. Columns of the block are `height` numbers
/// apart.
///
/// Returns the first column whose pivot does not have the sign given in `signs`, as an error.
fn eliminate_signed(block: &mut [f64], height: usize, signs: &[f64]) -> Result<(), usize> {
    let count = signs.len();
    vectorized(
        #[inline(always)]
        || {
            for j in 0..count {
                let (before, rest) = block.split_at_mut(j * height);
                let own = &mut rest[j..count];
                for (column, sign) in before.chunks_exact(height).zip(signs) {
                    let l = sign * column[j];
                    own.iter_mut().zip(&column[j..count]).for_each(|(value, other)| *value -= l * other);
                }
                let pivot = signs[j] * own[0];
                if !(pivot > 0.0 && pivot.is_finite()) {
                    return Err(j);
                }
                own[0] = pivot.sqrt();
                let scale = signs[j] * own[0];
                own[1..].iter_mut().for_each(|value| *value /= scale);
            }
            Ok(())
        },
    )
}

/// Overwrites `rest` with the update matrix −L₂SL₂ᵀ, stored by tiles as in `merge::triangle`. L₂ has the rows of L
/// below the first `width` rows, `width` being the number of columns of L.
pub(super) fn write_update(panel: &[f64], height: usize, signs: &[f64], mut rest: &mut [f64]) {
    let width = panel.len() / height;
    let mut tiles = Vec::new();
    for from in (width..height).step_by(TILE) {
        let (tile, after) = rest.split_at_mut(TILE.min(height - from) * (height - from));
        tiles.push((from, tile));
        rest = after;
    }
    tiles
        .into_par_iter()
        .for_each(|(from, tile)| subtract_square(panel, height, signs, from, tile, from, Accum::Replace));
}

/// Subtracts L S Lᵀ from `columns` of a symmetric matrix, or replaces them by −L S Lᵀ (`accum`). The first of them is
/// column `from` of the matrix; the first `skipped` rows are not stored.
fn subtract_square(
    l: &[f64],
    height: usize,
    signs: &[f64],
    from: usize,
    columns: &mut [f64],
    skipped: usize,
    accum: Accum,
) {
    let count = columns.len() / (height - skipped);
    let columns = MatMut::from_column_major_slice_mut(columns, height - skipped, count);
    let (mut head, mut tail) = columns.split_at_row_mut(from - skipped).1.split_at_row_mut(count);
    let mut rows = Vec::new();
    for (at, (l, signs)) in l.chunks(DEPTH * height).zip(signs.chunks(DEPTH)).enumerate() {
        let accum = if at == 0 { accum } else { Accum::Add };
        let width = l.len() / height;
        let (own, below) = MatRef::from_column_major_slice(l, height, width).split_at_row(from).1.split_at_row(count);
        let mut transposed = own.transpose();
        rows.clear();
        let signed = has_negative(signs);
        if signed || (tail.nrows() >= TALL && rows.try_reserve_exact(width * count).is_ok()) {
            copy_rows(l, height, from, count, &mut rows);
            if signed {
                for row in rows.chunks_exact_mut(width) {
                    row.iter_mut().zip(signs).for_each(|(value, sign)| *value *= sign);
                }
            }
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

/// Overwrites `rows` with `count` rows of a column-major matrix with `height` rows, from row `from` on. Each copied row
/// is contiguous.
fn copy_rows(columns: &[f64], height: usize, from: usize, count: usize, rows: &mut Vec<f64>) {
    /// Number of columns that are copied together: one row of them fills a cache line.
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

    const WIDTH: usize = DEPTH + 20;
    const HEIGHT: usize = WIDTH + TALL + 2 * TILE + 5;

    fn entry(row: usize, column: usize, signs: &[f64]) -> f64 {
        let value = ((row * 7 + column * 13) as f64).sin();
        if row == column { signs.get(row).unwrap_or(&1.0) * 2.0 * HEIGHT as f64 } else { value }
    }

    fn eliminated(signs: &[f64]) -> Vec<f64> {
        let mut l: Vec<f64> = (0..WIDTH * HEIGHT).map(|at| entry(at % HEIGHT, at / HEIGHT, signs)).collect();
        eliminate(&mut l, HEIGHT, signs, &mut scratch().unwrap()).unwrap();
        l
    }

    fn signs(is_negative: impl Fn(usize) -> bool) -> Vec<f64> {
        (0..WIDTH).map(|k| if is_negative(k) { -1.0 } else { 1.0 }).collect()
    }

    /// The matrix is large: some tiles are tall enough for copied rows, and an update takes two products of `DEPTH`
    /// columns.
    #[test]
    fn a_large_front_is_that_of_its_products() {
        for signs in [signs(|_| false), signs(|k| k % 3 == 1), signs(|k| k == 2 * BLOCK), signs(|_| true)] {
            let l = eliminated(&signs);
            let mut rest = vec![f64::NAN; triangle(HEIGHT - WIDTH)];
            write_update(&l, HEIGHT, &signs, &mut rest);
            let product = |i: usize, j: usize| -> f64 {
                (0..WIDTH.min(j + 1)).map(|k| signs[k] * l[k * HEIGHT + i] * l[k * HEIGHT + j]).sum()
            };
            for j in (0..WIDTH).step_by(7) {
                for i in (j..HEIGHT).step_by(11) {
                    assert!((product(i, j) - entry(i, j, &signs)).abs() < 1e-10 * HEIGHT as f64);
                }
            }
            let mut at = 0;
            for first in (WIDTH..HEIGHT).step_by(TILE) {
                for j in first..HEIGHT.min(first + TILE) {
                    for i in (j..HEIGHT).step_by(11) {
                        let left = rest[at + i - first];
                        assert!((product(i, j) + left).abs() < 1e-12 * HEIGHT as f64);
                    }
                    at += HEIGHT - first;
                }
            }
        }
    }

    #[test]
    fn columns_have_the_bits_of_positive_pivots_up_to_the_block_of_the_first_negative_one() {
        let positive = eliminated(&signs(|_| false));
        let signed = eliminated(&signs(|k| k > 2 * BLOCK));
        for k in 0..2 * BLOCK {
            let column = k * HEIGHT + k..(k + 1) * HEIGHT;
            assert!(positive[column.clone()] == signed[column]);
        }
    }

    #[test]
    fn a_pivot_of_the_wrong_sign_is_named() {
        let right = signs(|k| k % 3 == 1);
        for wrong in [0, 1, BLOCK - 1, BLOCK, 3 * BLOCK + 1, WIDTH - 1] {
            let mut l: Vec<f64> = (0..WIDTH * HEIGHT).map(|at| entry(at % HEIGHT, at / HEIGHT, &right)).collect();
            let mut signs = right.clone();
            signs[wrong] = -signs[wrong];
            assert_eq!(eliminate(&mut l, HEIGHT, &signs, &mut scratch().unwrap()), Err(wrong));
        }
    }
}
